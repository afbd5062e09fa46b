"""Parameters of bounds before and beside planning: they decide how tight a bound is, never whether it holds."""

from __future__ import annotations

from dataclasses import dataclass

__all__ = ["DEFAULT", "BoundParams"]


@dataclass(frozen=True, slots=True, kw_only=True)
class BoundParams:
    """Parameters of guarantees and relaxations; ``replace`` changes some.

    ``listed_robots`` : up to which all sets are tabulated for the smallest groups on graphs that are not complete: 12
    take 0.4 s, and each two more four times that
    ``annealed_links``, ``annealing_share`` : links up to which a cut is annealed (two or three seconds for 4,000), and
    share of the remaining budget for that. On disks of 30 robots it leaves 5 to 9 together instead of 15 to 21
    ``table_robots``, ``table_share`` : robots whose subsets are all looked at (one table of 2**16 marginals a robot),
    and share of the seconds left for that; a bracket of the marginals gets the rest
    ``tangent_targets`` : of a group, whose tangents enter a relaxation (max-eigenvalue): more can only strengthen it
    ``averaging`` : conditional-gradient steps on a smaller group: more can only strengthen its bound
    ``outcomes`` : that are all evaluated in every round of ``relaxation_bounds``, at most
    ``tolerance``, ``relaxed`` : of gap and feasibility [1] asked of the conic solver, and once it failed: the bound, by
    tangents at its point, is wider than the optimum by about their root, times how curved the criterion is
    """

    listed_robots: int = 12
    annealed_links: int = 4_000
    annealing_share: float = 0.1
    table_robots: int = 16
    table_share: float = 0.5
    tangent_targets: int = 6
    averaging: int = 12
    outcomes: int = 20_000
    tolerance: float = 1e-10
    relaxed: float = 1e-8


DEFAULT = BoundParams()
"""Parameters of bounds that are not given any."""
