"""The exact worst ratio of the best of RATT, the myopic planner and Greedy, each judged by its own worst attack.

The argument of ``worst_case_ratio`` with more elements: keep of any instance RATT's, the myopic planner's, Greedy's and
an optimal plan's element of each robot. For a fixed order of Greedy's picks and one attack on each plan the smallest
largest value is a linear program. Here no link is cut, so that every set of ``N - alpha_s`` robots must be worth 1
under the optimal plan, and nothing branches. The functions have bounded total curvature.
"""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from itertools import combinations, permutations, product
from typing import TYPE_CHECKING

from ratt_opt.budget import Budget
from ratt_opt.worst_ratio.class_rows import NonDecreasing
from ratt_opt.worst_ratio.program import ClaimedOptimum, Inequality, RatioProgram, proved_bound, rational_points

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

__all__ = ["BestOfThree", "best_of_three"]


@dataclass(frozen=True, slots=True, kw_only=True)
class BestOfThree:
    """Claim: ``lower <= infimum over all instances, and over ties, of the best planner's share <= upper``.

    ``lower`` is proved by rational multipliers of every program, ``upper`` is the exact value of one program's point.
    ``programs`` : how many were solved.
    """

    lower: Fraction
    upper: Fraction
    programs: int


@dataclass(frozen=True, slots=True)
class _Elements:
    """Numbering of a robot's choices by bits: RATT's, the myopic planner's (same for bait), Greedy's, the other's."""

    n_robots: int
    n_bait: int

    def ratt(self, robot: int) -> int:
        return 1 << robot

    def myopic(self, robot: int) -> int:
        return 1 << robot if robot < self.n_bait else 1 << self.n_robots + robot

    def greedy(self, robot: int) -> int:
        return 1 << 2 * self.n_robots + robot

    def other(self, robot: int) -> int:
        return 1 << 3 * self.n_robots + robot

    def of(self, robot: int) -> list[int]:
        kinds = (self.ratt, self.myopic, self.greedy, self.other)
        return list(dict.fromkeys(kind(robot) for kind in kinds))


def best_of_three(n_robots: int, alpha_s: int, curvature: Fraction, *, time_limit: float | None = None) -> BestOfThree:
    """Bracket the worst ratio of the best of the three planners, no link cut, total curvature at most c.

    Four robots take minutes. A spent ``time_limit`` raises ``OutOfBudget``: half the programs prove nothing.
    """
    elements, budget = _Elements(n_robots, alpha_s), Budget(time_limit)
    lower, upper, programs = Fraction(1), Fraction(1), 0
    for order in permutations(range(n_robots)):
        search = _Programs(elements, curvature, order, budget)
        for groups in product(combinations(range(n_robots), n_robots - alpha_s), repeat=3):
            claimed = search.solve(groups)
            programs += 1
            bound = Fraction(0) if claimed is None else search.proved(claimed)
            if bound < upper and claimed is not None:
                upper = min([upper, *search.values(claimed, upper)])
            lower = min(lower, bound)
    return BestOfThree(lower=min(lower, upper), upper=upper, programs=programs)


class _Programs:
    """All attacks for one order of Greedy's picks: rows that stay, and one a plan and group, switched on and off."""

    def __init__(self, elements: _Elements, curvature: Fraction, order: Sequence[int], budget: Budget) -> None:
        self.elements, self.budget = elements, budget
        n, bait = elements.n_robots, elements.n_bait
        compared = list(dict.fromkeys(_choices(elements, order)))
        sizes = list(combinations(range(n), n - bait))
        plans = (elements.ratt, elements.myopic, elements.greedy)
        self.left = {(p, group): sum(map(plan, group)) for p, plan in enumerate(plans) for group in sizes}
        kept = [sum(map(elements.other, group)) for group in sizes]
        self.used = sorted({mask for pair in compared for mask in pair} | set(self.left.values()) | set(kept))
        self.rows = NonDecreasing(2 * n, curvature, self.used)
        column = self.rows.column
        self.program = RatioProgram(self.rows.n_columns)
        self.program.add(self.rows.first_rows())
        self.program.add(Inequality({column(a): Fraction(1), column(b): Fraction(-1)}) for a, b in compared)
        self.program.add(Inequality({column(mask): Fraction(1)}, Fraction(1)) for mask in kept)
        hit = [Inequality({0: Fraction(1), column(mask): Fraction(-1)}) for mask in self.left.values()]
        self.hit = dict(zip(self.left, self.program.add(hit), strict=True))

    def solve(self, groups: Sequence[tuple[int, ...]]) -> ClaimedOptimum | None:
        on = {(p, group) for p, group in enumerate(groups)}
        for key, row in self.hit.items():
            self.program.switch(row, on=key in on)
        while True:
            self.budget.check()
            claimed = self.program.solve(self.budget.seconds_left)
            if claimed is None:
                return None
            broken = self.rows.violated(claimed.x, self.used)
            if not broken:
                return claimed
            self.program.add(broken)

    def proved(self, claimed: ClaimedOptimum) -> Fraction:
        return proved_bound(self.program, claimed, self.budget)

    def values(self, claimed: ClaimedOptimum, below: Fraction) -> Iterator[Fraction]:
        """Values below a given one of rational points that satisfy every row, checked without rounding."""
        for point in rational_points(self.program, claimed):
            if point[0] < below and min(point) >= 0 and all(self._holds(point)):
                yield point[0]

    def _holds(self, point: Sequence[Fraction]) -> Iterator[bool]:
        """The rows that count, and the class on all pairs of sets in use."""
        for row, on in zip(self.program.rows, self.program.on, strict=True):
            yield not on or sum(value * point[j] for j, value in row.terms.items()) >= row.least
        for start, end in permutations([0, *self.used], 2):
            terms = self.rows.pair(start, end).terms
            yield sum(value * point[j] for j, value in terms.items()) >= 0


def _choices(elements: _Elements, order: Sequence[int]) -> Iterator[tuple[int, int]]:
    """Pairs of sets that the three planners' choices order, the larger value first."""
    n, bait = elements.n_robots, elements.n_bait
    for robot in range(n):
        yield from ((elements.myopic(robot), rival) for rival in elements.of(robot) if rival != elements.myopic(robot))
    for b, g in product(range(bait), range(bait, n)):
        yield from ((elements.ratt(b), rival) for rival in elements.of(g))
    for pick, robots in ((elements.ratt, list(range(bait, n))), (elements.greedy, list(order))):
        chosen = 0
        for place, robot in enumerate(robots):
            for rival in (e for later in robots[place:] for e in elements.of(later)):
                if rival != pick(robot):
                    yield chosen | pick(robot), chosen | rival
            chosen |= pick(robot)
