"""Best-first search over the attacks on the planner and over which groups save the optimal plan.

Elements ``u_i`` are bit ``i`` and ``o_i`` bit ``N + i``. Robots are named so that the bait comes first and the greedy
robots follow in the order in which greedy picks them; nothing is lost, as the threat is the same for all robots.
With this order all ties of Algorithm 1 (lowest element, lowest robot) go to the elements ``u``, so that the
comparisons below are exactly the instances on which the planner returns ``u``.

For a fixed attack on the planner's plan ``u`` and a fixed family of robot groups in which the optimal plan
``o`` reaches value 1, the smallest worst-case value of ``u`` is a linear program. A node without a group
for some outcome branches on that outcome's groups. Every node's bound is proved by rational multipliers.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from fractions import Fraction
from typing import TYPE_CHECKING

import numpy as np

from ratt_opt.budget import Stop
from ratt_opt.errors import ProofError
from ratt_opt.graph.communication import CommunicationGraph
from ratt_opt.graph.outcomes import non_dominated_outcomes
from ratt_opt.graph.threat import Threat
from ratt_opt.search.branch_and_bound import divide_nodes
from ratt_opt.search.open_nodes import OpenNodes
from ratt_opt.worst_ratio.program import (
    ClaimedOptimum,
    Inequality,
    RatioProgram,
    proved_bound,
    rational_points,
)
from ratt_opt.worst_ratio.witness import scaled_values

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator

    from ratt_opt._validation import IntArray
    from ratt_opt.budget import Budget
    from ratt_opt.worst_ratio.class_rows import ClassRows

__all__ = ["RatioSearch", "Skeleton", "skeleton"]

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


@dataclass(frozen=True, slots=True, order=True)
class _RatioNode:
    bound: Fraction
    height: int
    """Minus the depth: among equal bounds the deepest comes first, so that an instance is found early."""
    serial: int
    attack: Groups = field(compare=False)
    saved: frozenset[int] = field(compare=False)
    """Groups, as robot masks, that must reach value 1 under the optimal plan."""


class RatioSearch:
    """Search that closes the bracket of one worst-case ratio.

    ``accept`` checks a table of integers and returns the exact ratio that it attains, or raises ``ProofError``;
    ``floor`` is a proved lower bound on the ratio.
    """

    def __init__(
        self, skeleton: Skeleton, rows: ClassRows, accept: Callable[[IntArray], Fraction], floor: Fraction
    ) -> None:
        self.skeleton, self.rows, self.accept, self.floor = skeleton, rows, accept, floor
        self.upper = Fraction(1)
        self.table: IntArray | None = None
        self.closed = Fraction(1)
        """Smallest bound of the nodes that were left for good."""
        self.nodes = self.programs = 0
        self.program = RatioProgram(rows.n_columns, rows.params)
        self._core = frozenset(mask for pair in skeleton.comparisons for mask in pair)
        column, groups = rows.column, skeleton.groups
        self.program.add(rows.first_rows())
        self.program.add(Inequality({column(a): Fraction(1), column(b): Fraction(-1)}) for a, b in skeleton.comparisons)
        hit = [Inequality({0: Fraction(1), column(group): Fraction(-1)}) for group in groups]
        kept = [Inequality({column(group << skeleton.n_robots): Fraction(1)}, Fraction(1)) for group in groups]
        self._hit = dict(zip(groups, self.program.add(hit), strict=True))
        self._saved = dict(zip(groups, self.program.add(kept), strict=True))
        forced = frozenset(outcome[0] for outcome in skeleton.outcomes if len(outcome) == 1)
        roots = [_RatioNode(floor, 0, k, attack, forced) for k, attack in enumerate(skeleton.attacks)]
        self.open = OpenNodes(roots)
        self._seen = {(node.attack, node.saved) for node in roots}

    def run(self, budget: Budget) -> None:
        """Search to the end, or until the budget is spent (``OutOfBudget``); the bracket is valid either way."""
        self._budget = budget
        divide_nodes(self.open, self)

    @property
    def lower(self) -> Fraction:
        """Proved lower bound on the ratio, at any time."""
        waiting = self.open.bound if self.open else Fraction(1)
        return max(self.floor, min(self.closed, waiting, self.upper))

    def stop(self) -> Stop | None:
        """Stop once no node has a bound below the ratio that a table attains."""
        return Stop.CLOSED if self.open.bound >= self.upper else None

    def bound(self, node: _RatioNode) -> tuple[_RatioNode, Fraction, Groups] | None:
        """Solve a node; its bound, and the groups of an outcome that its plan misses, one of which must reach 1."""
        claimed = self._solve(node, self._budget)
        bound = node.bound if claimed is None else max(node.bound, proved_bound(self.program, claimed, self._budget))
        self.nodes += 1
        if bound >= self.upper:
            return None
        missed = None if claimed is None else self._missed_outcome(node, claimed)
        if missed is None:
            if claimed is not None:
                self._record(node, claimed)
            self.closed = min(self.closed, max(bound, self.floor))
            return None
        return node, bound, missed

    def branch(self, bounded: tuple[_RatioNode, Fraction, Groups]) -> Iterator[_RatioNode]:
        """Branch on the group that reaches value 1."""
        node, bound, missed = bounded
        for group in missed:
            # A group that contains one known to reach 1 reaches 1: only the smallest are kept.
            saved = frozenset(s for s in node.saved if s & group != group) | {group}
            if (node.attack, saved) not in self._seen:
                yield _RatioNode(bound, node.height - 1, len(self._seen) + 1, node.attack, saved)
                self._seen.add((node.attack, saved))

    def _used(self, node: _RatioNode) -> list[int]:
        """Subsets whose values the node's program mentions, ascending."""
        return sorted(self._core | set(node.attack) | {group << self.skeleton.n_robots for group in node.saved})

    def _solve(self, node: _RatioNode, budget: Budget) -> ClaimedOptimum | None:
        """Solve the node's program, adding class rows until none is violated; ``None`` if HiGHS has no answer."""
        for group, row in self._hit.items():
            self.program.switch(row, on=group in node.attack)
        for group, row in self._saved.items():
            self.program.switch(row, on=group in node.saved)
        used = self._used(node)
        while True:
            budget.check()
            claimed = self.program.solve(budget.seconds_left)
            self.programs += 1
            if claimed is None:
                budget.check()
                return None
            rows = self.rows.violated(claimed.x, used)
            if not rows:
                return claimed
            self.program.add(rows)

    def _missed_outcome(self, node: _RatioNode, claimed: ClaimedOptimum) -> Groups | None:
        """Outcome in which no group of the optimal plan reaches 1, the fewest groups first."""
        groups = sorted(self._saved)
        masks = [group << self.skeleton.n_robots for group in groups]
        values = self.rows.optimal_values(claimed.x, self._used(node), masks)
        reached = {
            group for group, value in zip(groups, values, strict=True) if value >= 1 - self.program.params.reached
        }
        missed = [outcome for outcome in self.skeleton.outcomes if not reached.intersection(outcome)]
        return min(missed, key=len) if missed else None

    def _record(self, node: _RatioNode, claimed: ClaimedOptimum) -> None:
        """Turn a solution into a rational instance; keep it when its exact ratio is the smallest so far."""
        used = self._used(node)
        for point in rational_points(self.program, claimed):
            table = scaled_values(self.rows.table(point, used))
            if table is None or not np.any(table):
                continue
            try:
                ratio = self.accept(table)
            except ProofError:
                continue
            if ratio < self.upper:
                self.upper, self.table = ratio, table
            if ratio < claimed.x[0] + self.program.params.behind:
                return
