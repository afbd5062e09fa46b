"""Numbers as text, rounded outward: what is printed of a bracket holds the bracket, of a gap is not less than it.

The one place where ends of brackets, shares, gaps and guarantees become text. Exact: a float or fraction is rounded
once, in decimal arithmetic, in the direction that the function names.
"""

from __future__ import annotations

import math
import re
from decimal import MAX_EMAX, MIN_EMIN, ROUND_CEILING, ROUND_FLOOR, Context, Decimal
from fractions import Fraction

__all__ = ["bracket_text", "down", "gap_text", "named_text", "relative_gap", "up"]

AND_SO_ON = "\N{HORIZONTAL ELLIPSIS}"
"""Mark after the certain digits of a number: more follow."""
AT_LEAST, AT_MOST = {"lower", "proved", "share", "guarantee"}, {"upper", "gap"}
"""Last words of the names of numbers that are to be read so."""


def down(value: float | Fraction, digits: int) -> str:
    """The largest decimal of that many significant digits that is at most ``value``."""
    return _text(value, digits, ROUND_FLOOR)


def up(value: float | Fraction, digits: int) -> str:
    """The smallest decimal of that many significant digits that is at least ``value``."""
    return _text(value, digits, ROUND_CEILING)


def bracket_text(lower: float, upper: float, *, digits: int = 10) -> str:
    """The bracket as text: both ends, outward, or the digits that both begin with if these are ``digits`` many.

    The value to ``digits`` digits if both ends are one float.
    """
    if lower == upper:
        return f"{upper:.{digits}g}"
    low = down(lower, digits)
    if lower > 0 and low == down(upper, digits) and "e" not in low:
        return f"{low}{AND_SO_ON}"
    return f"[{low}, {up(upper, digits)}]"


def gap_text(lower: float, upper: float, digits: int) -> str:
    """``(upper - lower) / upper``, rounded up once; ``0`` if ``upper`` is 0."""
    return up(_gap(lower, upper), digits)


def relative_gap(lower: float, upper: float) -> float:
    """``(upper - lower) / upper`` as the smallest float that is no smaller; 0 if ``upper`` is 0."""
    exact = _gap(lower, upper)
    try:
        near = float(exact)
    except OverflowError:
        return math.inf
    return near if near >= exact else math.nextafter(near, math.inf)


def named_text(name: str, value: float, digits: int) -> str:
    """A number of a table: by its name's last word an end of a bracket, gap or share, outward; else to the nearest."""
    last = re.split(r"[^a-z]+", name)[-1]
    if last in AT_LEAST:
        return down(value, digits)
    return up(value, digits) if last in AT_MOST else f"{value:.{digits}g}"


def _gap(lower: float, upper: float) -> Fraction | float:
    if not (math.isfinite(lower) and math.isfinite(upper)):
        return math.inf
    return (Fraction(upper) - Fraction(lower)) / Fraction(upper) if upper > 0 else 0.0


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
