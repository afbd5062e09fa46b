"""Polynomials in ``t = 1 - curvature`` without rounding, by python-flint.

Every coefficient of a proof is a polynomial: ``(1-c)^3`` is ``t^3`` and ``1+k`` is ``2-t``. Non-negativity on
``[0, 1]`` is shown by non-negative Bernstein coefficients: with ``s = 1 - t``, a polynomial of degree at most D is
a form ``sum_a h_a t^a s^(D-a)``.
"""

from __future__ import annotations

from functools import cache
from typing import TYPE_CHECKING

import flint

from ratt_opt.worst_ratio.rationals import fraction, rational

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence
    from fractions import Fraction

__all__ = ["LARGEST_FORM", "ONE", "ZERO", "Polynomial", "T", "constant", "signed_sum"]

LARGEST_FORM = 8
"""Degree up to which a form with non-negative coefficients is looked for; the appendix's chains need 3 at most."""


class Polynomial:
    """``sum_j coefficients[j] * t**j``; the last coefficient is not zero.

    flint's own type can be neither hashed nor pickled; claims are compared by their coefficients, so this one can.
    """

    __slots__ = ("_inner",)

    def __init__(self, coefficients: Iterable[Fraction | int] | flint.fmpq_poly = ()) -> None:
        if not isinstance(coefficients, flint.fmpq_poly):
            coefficients = flint.fmpq_poly([rational(value) for value in coefficients])
        self._inner = coefficients

    @property
    def coefficients(self) -> tuple[Fraction, ...]:
        """Coefficients by power of ``t``, ascending; none for zero."""
        return tuple(fraction(value) for value in self._inner.coeffs())

    @property
    def degree(self) -> int:
        """Largest power of ``t``; 0 for constants and for zero."""
        return max(int(self._inner.degree()), 0)

    def __reduce__(self) -> tuple[object, ...]:
        return Polynomial, (self.coefficients,)

    def __repr__(self) -> str:
        return f"Polynomial({self._inner.str(ascending=True)})"

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Polynomial) and bool(self._inner == other._inner)

    def __hash__(self) -> int:
        return hash(tuple(self._inner.coeffs()))

    def __bool__(self) -> bool:
        return bool(self._inner)

    def __add__(self, other: Polynomial) -> Polynomial:
        return Polynomial(self._inner + other._inner)

    def __neg__(self) -> Polynomial:
        return Polynomial(-self._inner)

    def __sub__(self, other: Polynomial) -> Polynomial:
        return Polynomial(self._inner - other._inner)

    def __mul__(self, other: Polynomial) -> Polynomial:
        return Polynomial(self._inner * other._inner)

    def __pow__(self, power: int) -> Polynomial:
        return Polynomial(self._inner**power)

    def __call__(self, t: Fraction) -> Fraction:
        """Value at ``t``."""
        return fraction(self._inner(rational(t)))

    def form(self, degree: int) -> tuple[Fraction, ...]:
        """Coefficients of ``t^a s^(degree-a)``, a = 0..degree, with ``s = 1 - t``.

        Each ``t^j`` is ``t^j (t+s)^(degree-j)``. ``degree`` is at least the polynomial's.
        """
        powers = zip(self._inner.coeffs(), _homogeneous(degree), strict=False)
        total = sum((value * power for value, power in powers), flint.fmpq_poly())
        return tuple(fraction(total[a]) for a in range(degree + 1))

    def lowest_power(self) -> int:
        """Largest ``p`` such that ``t^p`` divides the polynomial (0 for zero)."""
        return next((j for j, value in enumerate(self._inner.coeffs()) if value), 0)

    def shifted(self, power: int) -> Polynomial:
        """The polynomial divided by ``t^power`` (which must divide it)."""
        return Polynomial(self._inner.right_shift(power)) if power else self

    def text(self, symbol: str) -> str:
        """Readable form in ``t``, written ``(1-symbol)``; for example ``1/2*(1-c)^2 + 1``."""
        powers = [_term(a, power_of(f"(1-{symbol})", j)) for j, a in enumerate(self._inner.coeffs()) if a]
        return signed_sum(powers[::-1])

    def form_text(self, symbol: str) -> str:
        """Like ``text``, as a form whose terms show that it is not negative on [0, 1]: ``c*(1-c) + (1-c)^2``.

        Falls back on ``text`` if no form of degree at most ``LARGEST_FORM`` has non-negative coefficients.
        """
        for degree in range(self.degree, max(self.degree, LARGEST_FORM) + 1):
            form = self.form(degree)
            if min(form) >= 0:
                powers = [(power_of(symbol, degree - a), power_of(f"(1-{symbol})", a)) for a in range(degree + 1)]
                bases = ["*".join(filter(None, both)) for both in powers]
                return signed_sum([_term(h, base) for h, base in zip(form, bases, strict=True) if h])
        return self.text(symbol)


@cache
def _homogeneous(degree: int) -> tuple[flint.fmpq_poly, ...]:
    """``t^j (t+s)^(degree-j)`` for j = 0..degree, as polynomials in ``t`` with ``s = 1``."""
    return tuple(flint.fmpq_poly([0, 1]) ** j * flint.fmpq_poly([1, 1]) ** (degree - j) for j in range(degree + 1))


def signed_sum(terms: Sequence[str]) -> str:
    """Terms joined by their signs; ``0`` when there are none."""
    return " + ".join(terms).replace("+ -", "- ") or "0"


def power_of(base: str, power: int) -> str:
    """``base^power``, nothing for the power 0."""
    return f"{base}^{power}" if power > 1 else base * power


def _term(coefficient: object, base: str) -> str:
    if not base:
        return str(coefficient)
    return {"1": base, "-1": f"-{base}"}.get(str(coefficient), f"{coefficient}*{base}")


def constant(value: Fraction | int) -> Polynomial:
    """The constant polynomial."""
    return Polynomial([value])


ZERO = Polynomial()
ONE = constant(1)
T = Polynomial([0, 1])
"""``1 - curvature``."""
