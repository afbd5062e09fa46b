"""Parameters of worst-case ratios: they decide how soon a bracket closes, never whether it holds."""

from __future__ import annotations

from dataclasses import dataclass

from ratt_opt.errors import InputError

__all__ = ["DEFAULT", "WorstRatioParams"]


@dataclass(frozen=True, slots=True, kw_only=True)
class WorstRatioParams:
    """Parameters of one search for a worst-case ratio.

    ``robots`` : of a team, at most: a witness has ``4**N`` values
    ``many_columns`` : from which on an interior-point method with crossover on all rows beats simplex on a growing list
    ``complete_columns`` : up to which all rows of diminishing returns fit in a program from the start (67,584 rows for
    4,096 columns); with more, violated ones are added
    ``rows`` : violated class rows added at once, the worst first: fewer programs against larger ones
    ``rounding`` : violation of a row [1] that counts as the solver's rounding; a smaller one adds rows in vain
    ``behind`` : distance by which a proved bound may stay behind the claimed one before better rationals are tried
    ``denominators`` : tried, in turn, when a float is read as a rational; whatever comes out is checked exactly
    ``nonzero`` : multipliers up to this are the solver's rounding of zero
    ``unknowns`` : of a square rational system that is solved, at most (1,500 take a few seconds)
    ``reached`` : distance from value 1 at which a group counts as having it; nothing rests on this
    """

    robots: int = 7
    many_columns: int = 1000
    complete_columns: int = 1 << 12
    rows: int = 3000
    rounding: float = 1e-9
    behind: float = 1e-9
    denominators: tuple[int, ...] = (60, 10_000, 1_000_000)
    nonzero: float = 1e-9
    unknowns: int = 1_500
    reached: float = 1e-9

    def __post_init__(self) -> None:
        """Check what no search could go on with. ``InputError`` : it is less than 1."""
        for name in ("robots", "rows"):
            if not (value := getattr(self, name)) >= 1:
                raise InputError(f"params.{name}", "must be at least 1", value)
        if not all(one >= 1 for one in self.denominators):
            raise InputError("params.denominators", "must be at least 1", self.denominators)


DEFAULT = WorstRatioParams()
"""Parameters of searches that are not given any."""
