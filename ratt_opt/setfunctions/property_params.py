"""Parameters of the searches for witnesses against a property of a set function."""

from __future__ import annotations

from dataclasses import dataclass, fields

from ratt_opt._validation import check_integer, check_number

__all__ = ["DEFAULT", "PropertyParams"]


@dataclass(frozen=True, slots=True, kw_only=True)
class PropertyParams:
    """Numbers of the sets that are looked at; ``replace`` changes some. A witness holds whatever they are.

    ``tolerance`` : by default, a violation must exceed it times the largest absolute value of the function
    ``trials`` : by default, pairs of sets tried; 20,000 take half a second for a criterion of 120 elements, 15 targets
    ``seconds`` : by default; a table of 2**24 values of a function in plain Python takes ten minutes
    ``table_share`` : of the seconds, in which a table has to be complete; of a slower function random sets are tried in
    the rest
    ``tabulated`` : elements up to which all values are looked at; 24 take 128 MiB, each one more doubles that
    ``disjoint``, ``overlapping`` : elements up to which all 3**n disjoint pairs of sets (under a second) and all 4**n
    pairs are looked at
    ``batch`` : pairs valued at once; more take more memory, a membership row a pair
    ``climbs`` : most steps from the worst pair found, each to its best neighbour; fewer find smaller violations
    """

    tolerance: float = 1e-9
    trials: int = 20_000
    seconds: float = 60.0
    table_share: float = 0.5
    tabulated: int = 24
    disjoint: int = 18
    overlapping: int = 12
    batch: int = 2_000
    climbs: int = 50

    def __post_init__(self) -> None:
        """Check what no search could go on with. ``InputError`` : a number is out of its range."""
        for one in fields(self):
            check_number(f"params.{one.name}", getattr(self, one.name), low=0)
        check_integer("params.batch", self.batch, low=1)


DEFAULT = PropertyParams()
"""Parameters of searches that are not given any."""
