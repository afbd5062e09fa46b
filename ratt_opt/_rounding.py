"""Numbers as text, rounded outward: what is printed of a bracket holds the bracket, of a gap is not less than it.

The one place where ends of brackets, shares, gaps and guarantees become text. Exact: a float or fraction is rounded
once, in decimal arithmetic, in the direction that is asked for.
"""

from __future__ import annotations

import math
from decimal import MAX_EMAX, MIN_EMIN, ROUND_CEILING, ROUND_FLOOR, Context, Decimal
from fractions import Fraction

__all__ = ["bracket_text", "down", "gap_text", "up"]


def down(value: float | Fraction, digits: int) -> str:
    """The largest decimal of so many significant digits that is at most ``value``."""
    return _text(value, digits, ROUND_FLOOR)


def up(value: float | Fraction, digits: int) -> str:
    """The smallest decimal of so many significant digits that is at least ``value``."""
    return _text(value, digits, ROUND_CEILING)


def bracket_text(lower: float, upper: float, *, digits: int = 10) -> str:
    """The bracket as text: the value to ``digits`` digits where both ends are one float, else both ends, outward."""
    if lower == upper:
        return f"{upper:.{digits}g}"
    return f"[{down(lower, digits)}, {up(upper, digits)}]"


def gap_text(lower: float, upper: float, digits: int) -> str:
    """``(upper - lower) / upper``, rounded up once; ``0`` where ``upper`` is 0."""
    if not (math.isfinite(lower) and math.isfinite(upper)):
        return str(math.inf)
    return up((Fraction(upper) - Fraction(lower)) / Fraction(upper) if upper > 0 else 0.0, digits)


def _text(value: float | Fraction, digits: int, rounding: str) -> str:
    if isinstance(value, float) and not math.isfinite(value):
        return str(value)
    context = Context(prec=digits, rounding=rounding, Emin=MIN_EMIN, Emax=MAX_EMAX)
    exact = Fraction(value)
    rounded = context.divide(Decimal(exact.numerator), Decimal(exact.denominator)).normalize()
    exponent = rounded.adjusted()
    if -5 < exponent < digits:
        return f"{rounded:f}"
    mantissa = rounded.scaleb(-exponent, context).normalize()
    return f"{mantissa:f}e{exponent:+03d}"
