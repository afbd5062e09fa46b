"""Polynomials in ``t = 1 - curvature`` with rational coefficients.

Every coefficient of the proof is one: ``(1-c)^3`` is ``t^3`` and ``1+k`` is ``2-t``.
Non-negativity on ``[0, 1]`` is shown by non-negative Bernstein coefficients: with
``s = 1 - t``, a polynomial of degree at most D is a form ``sum_a h_a t^a s^(D-a)``.
"""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from itertools import zip_longest
from math import comb
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Sequence

__all__ = ["LARGEST_FORM", "ONE", "ZERO", "Polynomial", "T", "constant", "signed_sum"]

LARGEST_FORM = 8
"""Degree up to which a form with non-negative coefficients is looked for."""


@dataclass(frozen=True, slots=True)
class Polynomial:
    """``sum_j coefficients[j] * t**j``; the last coefficient is not zero."""

    coefficients: tuple[Fraction, ...]

    def __post_init__(self) -> None:
        kept = [Fraction(value) for value in self.coefficients]
        while kept and kept[-1] == 0:
            kept.pop()
        object.__setattr__(self, "coefficients", tuple(kept))

    @property
    def degree(self) -> int:
        """Largest power of ``t``; 0 for constants and for zero."""
        return max(len(self.coefficients) - 1, 0)

    def __bool__(self) -> bool:
        return bool(self.coefficients)

    def __add__(self, other: Polynomial) -> Polynomial:
        pairs = zip_longest(self.coefficients, other.coefficients, fillvalue=Fraction(0))
        return Polynomial(tuple(a + b for a, b in pairs))

    def __neg__(self) -> Polynomial:
        return Polynomial(tuple(-a for a in self.coefficients))

    def __sub__(self, other: Polynomial) -> Polynomial:
        return self + -other

    def __mul__(self, other: Polynomial) -> Polynomial:
        product = [Fraction(0)] * (len(self.coefficients) + len(other.coefficients))
        for i, a in enumerate(self.coefficients):
            for j, b in enumerate(other.coefficients):
                product[i + j] += a * b
        return Polynomial(tuple(product))

    def __call__(self, t: Fraction) -> Fraction:
        """Value at ``t``."""
        value = Fraction(0)
        for coefficient in reversed(self.coefficients):
            value = value * t + coefficient
        return value

    def form(self, degree: int) -> tuple[Fraction, ...]:
        """Coefficients of ``t^a s^(degree-a)``, a = 0..degree, where ``s = 1 - t``.

        ``t^j = t^j (t+s)^(degree-j)``, hence the binomials. ``degree`` is at least the polynomial's.
        """
        out = [Fraction(0)] * (degree + 1)
        for j, coefficient in enumerate(self.coefficients):
            for a in range(j, degree + 1):
                out[a] += coefficient * comb(degree - j, a - j)
        return tuple(out)

    def lowest_power(self) -> int:
        """Largest ``p`` such that ``t^p`` divides the polynomial (0 for zero)."""
        return next((j for j, a in enumerate(self.coefficients) if a), 0)

    def shifted(self, power: int) -> Polynomial:
        """The polynomial divided by ``t^power`` (which must divide it)."""
        return Polynomial(self.coefficients[power:])

    def text(self, symbol: str) -> str:
        """Readable form in ``t``, written ``(1-symbol)``; for example ``1/2*(1-c)^2 + 1``."""
        powers = [(a, _power(f"(1-{symbol})", j)) for j, a in enumerate(self.coefficients) if a]
        return signed_sum([_term(*power) for power in reversed(powers)])

    def form_text(self, symbol: str) -> str:
        """Like ``text``, as a form whose terms show that it is not negative on [0, 1]: ``c*(1-c) + (1-c)^2``.

        Falls back on ``text`` where no form of degree at most ``LARGEST_FORM`` has non-negative coefficients.
        """
        for degree in range(self.degree, max(self.degree, LARGEST_FORM) + 1):
            form = self.form(degree)
            if min(form) >= 0:
                kept, lost = f"(1-{symbol})", symbol
                bases = ["*".join(filter(None, (_power(lost, degree - a), _power(kept, a)))) for a in range(degree + 1)]
                return signed_sum([_term(h, base) for h, base in zip(form, bases, strict=True) if h])
        return self.text(symbol)


def signed_sum(terms: Sequence[str]) -> str:
    """Terms joined by their signs; ``0`` when there are none."""
    return " + ".join(terms).replace("+ -", "- ") or "0"


def _power(base: str, power: int) -> str:
    """``base^power``, nothing for the power 0."""
    return f"{base}^{power}" if power > 1 else base * power


def _term(coefficient: Fraction, base: str) -> str:
    if not base:
        return str(coefficient)
    return {"1": base, "-1": f"-{base}"}.get(str(coefficient), f"{coefficient}*{base}")


def constant(value: Fraction | int) -> Polynomial:
    """The constant polynomial."""
    return Polynomial((Fraction(value),))


ZERO = Polynomial(())
ONE = constant(1)
T = Polynomial((Fraction(0), Fraction(1)))
"""``1 - curvature``."""
