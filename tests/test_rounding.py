"""Printed brackets hold the brackets, printed gaps are no smaller than the gaps."""

import re
from collections.abc import Sequence
from fractions import Fraction

import pytest
from hypothesis import given
from hypothesis import strategies as st

from analysis.tables import print_table
from ratt_opt import Attack, AttackResult, Stop, Verified
from ratt_opt._rounding import bracket_text, down, gap_text, relative_gap, up
from ratt_opt.report.tables import attack_tables, share_text
from tests.strategies import DIGITS, FLOATS, NEARLY_CLOSED, POSITIVE, close_above

NUMBER = re.compile(r"-?\d+(?:\.\d+)?(?:e[+-]\d+)?")


@given(value=FLOATS, digits=DIGITS)
def test_down_and_up_are_the_nearest_decimals_on_either_side(value: float, digits: int) -> None:
    low, exact, high = Fraction(down(value, digits)), Fraction(value), Fraction(up(value, digits))
    assert low <= exact <= high
    assert low == high == exact or high - low <= abs(exact) * Fraction(10) ** (1 - digits)
    for text in (down(value, digits), up(value, digits)):
        assert len(re.sub(r"e.*|[-.]", "", text).strip("0")) <= digits


@given(lower=st.one_of(FLOATS, NEARLY_CLOSED), other=st.one_of(FLOATS, st.integers(1, 17)), digits=DIGITS)
def test_a_printed_bracket_holds_the_bracket(lower: float, other: float | int, digits: int) -> None:
    upper = close_above(lower, other) if isinstance(other, int) else max(lower, other)
    shown = [Fraction(number) for number in NUMBER.findall(bracket_text(lower, upper, digits=digits))]
    if lower == upper:
        assert len(shown) == 1
    elif len(shown) == 1:
        text = bracket_text(lower, upper, digits=digits)
        assert text.endswith("…")
        last = Fraction(1, 10 ** len(text.rstrip("…").partition(".")[2]))
        assert 0 < shown[0] <= Fraction(lower) <= Fraction(upper) < shown[0] + last
    else:
        assert len(shown) == 2
        assert shown[0] <= Fraction(lower)
        assert shown[1] >= Fraction(upper)


@given(upper=POSITIVE, share=st.floats(0, 1), digits=DIGITS)
def test_a_printed_gap_is_no_smaller_than_the_gap_and_a_share_no_larger(
    upper: float, share: float, digits: int
) -> None:
    lower = upper * share
    exact = 1 - Fraction(lower) / Fraction(upper)
    assert exact <= Fraction(relative_gap(lower, upper)) <= exact * (1 + Fraction(2) ** -52) + Fraction(5e-324)
    assert exact <= Fraction(gap_text(lower, upper, digits)) <= exact * (1 + Fraction(10) ** (1 - digits))
    shown = share_text(lower, upper)
    least = 1 - Fraction("1e-9") if shown == "optimal to 1e-9" else Fraction(shown.removeprefix("at least "))
    assert least <= 1 - exact


def test_what_is_exact_is_printed_as_it_is() -> None:
    assert [down(0.5, 3), up(0.5, 3), up(100.0, 3), up(0.0, 3), down(1e10, 10)] == ["0.5", "0.5", "100", "0", "1e+10"]
    assert bracket_text(1 / 3, 1 / 3) == "0.3333333333"
    assert bracket_text(1 / 3, 2 / 3, digits=3) == "[0.333, 0.667]"
    assert bracket_text(0.3334, 0.3339, digits=3) == "0.333…"
    assert bracket_text(0.3339, 0.3341, digits=3) == "[0.333, 0.335]"
    assert bracket_text(0.0, float("inf")) == "[0, inf]"
    assert gap_text(0.0, 0.0, 3) == "0"
    assert share_text(0.0, 0.0) == "optimal to 1e-9"
    assert share_text(1.0, 4.0) == "at least 0.25"


def _cells(tables: Sequence[object]) -> str:
    return " ".join(str(cell) for table in tables for column in table.columns for cell in column.cells)  # type: ignore[attr-defined]


@given(lower=st.floats(0, 1e6), width=st.floats(0, 1))
def test_tables_and_representations_use_it(lower: float, width: float) -> None:
    """The numbers a person reads of an attack and of a certificate."""
    upper = lower + width
    result = AttackResult(attack=Attack(), lower=lower, upper=upper, stop=Stop.TIME, evaluations=0)
    shown = [Fraction(x) for x in NUMBER.findall(_cells(list(attack_tables({"worst": result}, None, None, ""))))]
    assert max(shown) >= Fraction(upper) or lower == upper
    found = repr(result)
    low, high = (Fraction(x) for x in NUMBER.findall(found)[:2])
    assert low <= Fraction(lower)
    assert high >= Fraction(upper)


def test_tables_of_studies_and_benchmarks_use_it(capsys: pytest.CaptureFixture[str]) -> None:
    """Ends of brackets, gaps and shares by the names of their columns; other numbers to the nearest."""
    value = 0.123449  # to four digits 0.1234; up 0.1235
    names = ["conic_lower", "certified share", "conic_upper", "worst_gap", "proved gap", "seconds", "lower_s"]
    print_table("", [dict.fromkeys(names, value), dict.fromkeys(names, 0.123551)])
    rows = [line.split() for line in capsys.readouterr().out.splitlines()[3:]]
    assert rows == [
        ["0.1234", "0.1234", "0.1235", "0.1235", "0.1235", "0.1234", "0.1234"],
        ["0.1235", "0.1235", "0.1236", "0.1236", "0.1236", "0.1236", "0.1236"],
    ]
    assert relative_gap(-1e308, 5e-324) == float("inf")
    assert relative_gap(0.0, 0.0) == 0.0


@pytest.mark.parametrize(("lower", "upper"), [(1.0, 1.0 + 2**-52), (0.1, 0.3), (0.0, 0.0), (5e-324, 1e-323)])
def test_the_verifier_says_a_gap_no_smaller_than_it_is(lower: float, upper: float) -> None:
    counts = dict.fromkeys(["n_robots", "n_targets", "n_elements", "alpha_s", "alpha_c", "upper_leaves"], 1)
    words = dict.fromkeys(["lower_method", "objective", "arithmetic", "problem_hash"], "")
    about = Verified(
        lower=lower,
        upper=upper,
        lower_proved=True,
        elements=(0,),
        largest_defect=1 / 3,
        lower_leaves=1,
        **counts,
        **words,
    )
    said = "\n".join(about.lines())
    gap = Fraction(re.findall(r"within (\S+) \(relative\)", said)[0])
    assert gap * Fraction(upper) >= Fraction(upper) - Fraction(lower)
    assert Fraction(re.findall(r"up to (\S+),", said)[0]) >= Fraction(1 / 3)
