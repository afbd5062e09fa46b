"""Who plays which part in a worst case: planner's comparisons, attacks up to symmetry, what the optimum must survive.

Elements ``u_i`` are bit ``i`` and ``o_i`` bit ``N + i``. Robots are named so that the bait comes first and the greedy
robots follow in the order in which greedy picks them; nothing is lost, as the threat is the same for all robots.
With this order all ties of Algorithm 1 (lowest element, lowest robot) go to the elements ``u``, so that the
comparisons below are exactly the instances on which the planner returns ``u``.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from ratt_opt.graph.communication import CommunicationGraph
from ratt_opt.graph.outcomes import non_dominated_outcomes
from ratt_opt.graph.threat import Threat

if TYPE_CHECKING:
    from collections.abc import Iterable

__all__ = ["Skeleton", "skeleton"]

Groups = tuple[int, ...]
"""Disjoint robot groups as bit masks, ascending."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Skeleton:
    """The combinatorial part of a worst-case program.

    ``comparisons`` : pairs of subsets (larger, smaller) that the planner's choices order
    ``outcomes`` : every non-dominated outcome of the threat
    ``attacks`` : one outcome per orbit of the bait robots, which no comparison tells apart
    """

    n_robots: int
    n_bait: int
    comparisons: tuple[tuple[int, int], ...]
    outcomes: tuple[Groups, ...]
    attacks: tuple[Groups, ...]

    @property
    def groups(self) -> list[int]:
        """Every group of an outcome, ascending."""
        return sorted({group for outcome in self.outcomes for group in outcome})


def skeleton(n_robots: int, alpha_s: int, alpha_c: int, n_bait: int) -> Skeleton:
    """Return the skeleton for a team on the complete graph whose planner uses ``n_bait`` bait robots."""
    threat = Threat(CommunicationGraph.complete(n_robots), alpha_s, alpha_c)
    outcomes = tuple(
        tuple(sorted(sum(1 << i for i in group) for group in outcome)) for outcome in non_dominated_outcomes(threat)
    )
    orbits: dict[tuple[tuple[int, int], ...], Groups] = {}
    for outcome in outcomes:
        orbits.setdefault(_orbit(outcome, n_bait), outcome)
    return Skeleton(
        n_robots=n_robots,
        n_bait=n_bait,
        comparisons=tuple(dict.fromkeys(_comparisons(n_robots, n_bait))),
        outcomes=outcomes,
        attacks=tuple(orbits.values()),
    )


def _orbit(outcome: Groups, n_bait: int) -> tuple[tuple[int, int], ...]:
    """Per group its number of bait robots and its greedy robots: equal exactly for outcomes that bait permutes."""
    bait = (1 << n_bait) - 1
    return tuple(sorted(((group & bait).bit_count(), group & ~bait) for group in outcome))


def _comparisons(n_robots: int, n_bait: int) -> Iterable[tuple[int, int]]:
    """Lines 3 to 18 of Algorithm 1: bait beats its own robot's and all greedy robots' elements, then greedy steps."""
    for b in range(n_bait):
        yield 1 << b, 1 << n_robots + b
        for i in range(n_bait, n_robots):
            yield 1 << b, 1 << i
            yield 1 << b, 1 << n_robots + i
    chosen = 0
    for j in range(n_bait, n_robots):
        pick = chosen | 1 << j
        for i in range(j, n_robots):
            yield pick, chosen | 1 << n_robots + i
            if i > j:
                yield pick, chosen | 1 << i
        chosen = pick
