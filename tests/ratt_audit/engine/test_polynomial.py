"""Polynomials in one minus the curvature against evaluation."""

from fractions import Fraction

from hypothesis import given
from hypothesis import strategies as st

from ratt_audit.engine.polynomials import ONE, Polynomial, T, constant
from tests.strategies import coefficients, points

polynomials = coefficients.map(Polynomial)


@given(polynomials, polynomials, points)
def test_arithmetic_commutes_with_evaluation(p: Polynomial, q: Polynomial, t: Fraction) -> None:
    assert (p + q)(t) == p(t) + q(t)
    assert (p - q)(t) == p(t) - q(t)
    assert (p * q)(t) == p(t) * q(t)


@given(polynomials, points, st.integers(min_value=0, max_value=3))
def test_a_form_has_the_polynomial_s_values(p: Polynomial, t: Fraction, extra: int) -> None:
    degree = p.degree + extra
    form = p.form(degree)
    assert sum(h * t**a * (1 - t) ** (degree - a) for a, h in enumerate(form)) == p(t)


@given(polynomials)
def test_shifting_divides_by_the_lowest_power(p: Polynomial) -> None:
    power = p.lowest_power()
    back = p.shifted(power)
    for _ in range(power):
        back = back * T
    assert back == p


def test_text_is_readable() -> None:
    assert (T * T * constant(Fraction(1, 2)) + ONE).text("c") == "1/2*(1-c)^2 + 1"
    assert (T - T).text("c") == "0"


def value_of(text: str, c: Fraction) -> Fraction:
    """Evaluate a printed sum of products by hand."""
    base = {"c": c, "(1-c)": 1 - c}
    total = Fraction(0)
    for term in text.replace(" - ", " + -").split(" + "):
        product = Fraction(1)
        for factor in term.removeprefix("-").split("*"):
            name, _, power = factor.partition("^")
            product *= base[name] ** int(power or 1) if name in base else Fraction(factor)
        total += -product if term.startswith("-") else product
    return total


@given(polynomials, points)
def test_both_texts_have_the_polynomial_s_values(p: Polynomial, t: Fraction) -> None:
    assert value_of(p.text("c"), 1 - t) == p(t)
    assert value_of(p.form_text("c"), 1 - t) == p(t)


@given(st.lists(st.fractions(min_value=0, max_value=3, max_denominator=7), max_size=5))
def test_a_form_that_is_not_negative_is_printed_without_a_minus(form: list[Fraction]) -> None:
    degree, one = len(form) - 1, Polynomial((Fraction(1),))
    total = constant(0)
    for a, value in enumerate(form):
        term = constant(value)
        for factor in [T] * a + [one - T] * (degree - a):
            term = term * factor
        total = total + term
    assert "-" not in total.form_text("c").replace("(1-c)", "")
