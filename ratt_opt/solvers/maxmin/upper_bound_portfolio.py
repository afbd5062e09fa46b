"""Portfolio of searches for the upper bound: concave relaxations, and a search in depth if robots see few targets.

Before any of them, monotonicity bounds all plans: no plan gives a group more information than all elements of its
robots together, and the criteria do not decrease with information. As a proof it is one tangent a group, which touches
there: what a plan lacks of that information only lowers it. Several groups are cases; one of them wins.

Concave relaxations are searched tree after tree. A tree that takes too many nodes is given up for one that begins with
the outcomes, cuts and plans found by then: the next tree meets at its root what the one before met in some deep node.
Trees after the first are searched in depth: below a node that is closed, divisions that its proof does not rely on are
taken back (``frontier.py``), which saves the siblings that were not searched yet. The tree of smallest bound is kept.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from ratt_opt.attack.team import LARGEST_DIMENSION
from ratt_opt.budget import Stop
from ratt_opt.setfunctions.criteria.logdet import LogDetObjective
from ratt_opt.setfunctions.criteria.trace import TraceObjective
from ratt_opt.solvers.maxmin.branch_and_bound import BranchAndBound
from ratt_opt.solvers.maxmin.covers.cover_search import CoverSearch
from ratt_opt.solvers.maxmin.elements import Elements
from ratt_opt.solvers.maxmin.marginal_search import MarginalSearch
from ratt_opt.solvers.maxmin.proof import Leaf, TangentCut, UpperProof, WinnerBranch
from ratt_opt.solvers.maxmin.time_slices import TimeSlicesUntil
from ratt_opt.solvers.maxmin.walk import Walk

if TYPE_CHECKING:
    from ratt_opt.problem import Attack, Problem
    from ratt_opt.solvers.maxmin.known import Known, Progress
    from ratt_opt.solvers.maxmin.levels import SearchByLevels
    from ratt_opt.solvers.maxmin.time_slices import TimeSlices

__all__ = ["MonotoneBound", "RestartedSearch", "UpperBoundPortfolio", "monotone_bound"]

FIRST_NODES = 100
"""Nodes of the first tree: most searches end within. With 20, ten robots took a third longer."""
NEARLY, MORE_NODES = 5e-3, 500
"""Relative width at which that tree is nearly done, and then goes on to this many nodes: log-det, (3, 107) and (5,
107), end after 220 and 471 nodes, and not within 15 seconds if they are given up at 100."""
TREE_NODES, TREE_GROWTH = 100, 1.5
"""Nodes of a later tree before it is given up, and how many times as many the next one then has."""
SUMS = frozenset((TraceObjective.native_kernel, LogDetObjective.native_kernel))
"""Criteria that are sums over targets."""
UNSEEN = 0.25
"""Least share of pairs of an element and a target without information for a search in depth."""
SLICE, SLICE_GROWTH = 20, 2.0
"""Nodes of the concave search's second turn, after its root, and how many times as many each later one has."""


@dataclass(frozen=True, slots=True, kw_only=True)
class DepthParams:
    """Nodes that the search in depth has for each of the concave one's.

    ``first`` : if rows are there from the root, at first; ``most`` : without rows, and after a turn that lowered the
    upper end; ``in_vain`` : factor after each other turn beside rows: fast ends of either search against slow ones
    ``walk_kicks``, ``walk_share`` : kicks, and share of the time left, for better plans before rows begin at the root
    """

    first: float = 2.5
    most: float = 10.0
    in_vain: float = 0.25
    walk_kicks: int = 100
    walk_share: float = 0.1


@dataclass(frozen=True, slots=True, kw_only=True)
class MonotoneBound:
    """Claim: ``Phi* <= upper``, as ``proof`` shows."""

    upper: float
    proof: UpperProof


def monotone_bound(problem: Problem, attack: Attack) -> MonotoneBound:
    """Bound the worst-case value of every plan by what all elements of a group are worth under one attack.

    Relies on an information criterion, whose values do not decrease with information.

    Parameters
    ----------
    attack : within the budgets
    """
    objective = problem.information_objective
    groups = tuple(sorted(tuple(sorted(group)) for group in problem.groups_left(attack) if group)) or ((),)
    of_robot = np.array([objective.information[choice].sum(axis=0) for choice in problem.choices])
    points = [np.asarray(objective.prior_information + of_robot[list(group)].sum(axis=0)) for group in groups]
    targets = [objective.tangent_targets(point, -np.inf, 1)[0] for point in points]
    cuts = (
        TangentCut(attack=0, group=group, point=point, target=target)
        for group, point, target in zip(groups, points, targets, strict=True)
    )
    leaves = (Leaf(cuts=(k,), weights=(1.0,)) for k in range(len(groups)))
    above = () if len(groups) == 1 else (WinnerBranch(attack=0, parts=groups),)
    return MonotoneBound(
        upper=float(objective.value(np.array(points)).max()) + objective.rounding,
        proof=UpperProof(attacks=(attack,), cuts=tuple(cuts), tree=(*above, *leaves)),
    )


class RestartedSearch:
    """The search of one problem by such trees; it may be interrupted at any point, as each of them may."""

    def __init__(self, known: Known) -> None:
        self._known = known
        self.first = self._best = self._current = BranchAndBound(known)
        self._tree_nodes, self._until = float(TREE_NODES), FIRST_NODES

    @property
    def upper(self) -> float:
        """Proved upper bound on the optimum: the smaller one of the best tree so far and of the one in work."""
        return self._lowest().upper

    def proof(self) -> UpperProof:
        """The proof of :attr:`upper`."""
        return self._lowest().proof()

    def run(self, slices: TimeSlices, progress: Progress) -> Stop:
        """Search until the gap closes, the budget is spent or it is time for a proof; return why it stopped."""
        while True:
            stop = self._current.run(TimeSlicesUntil(slices, self._is_given_up), self._told(progress))
            if stop is Stop.GAP:
                return stop
            if (reason := slices.budget.stop() or slices.stop()) is not None:
                return reason
            if self._current is self.first and self._until < MORE_NODES and self._is_nearly_done():
                self._until = MORE_NODES
            else:
                self._begin_next()

    def _is_given_up(self) -> bool:
        """True if the current tree has taken too many nodes."""
        if self._known.rows_from == 0:  # rows serve all nodes, so that a new tree would meet nothing new
            return False
        return self._known.incumbent.budget.nodes >= self._until

    def _is_nearly_done(self) -> bool:
        return self.upper - self._known.incumbent.candidates.level <= NEARLY * abs(self.upper)

    def _lowest(self) -> BranchAndBound:
        return min(self._best, self._current, key=lambda tree: tree.upper)

    def _told(self, progress: Progress) -> Progress:
        if progress is None:
            return None
        return lambda nodes, lower, upper: progress(nodes, lower, min(upper, self._best.upper))

    def _begin_next(self) -> None:
        """Put a tree of more nodes in the place of the one in work."""
        if self._current is not self.first:
            self._tree_nodes *= TREE_GROWTH
        self._best = self._lowest()
        self._until = self._known.incumbent.budget.nodes + int(self._tree_nodes)
        self._current = BranchAndBound(self._known, depth_first=True)


class UpperBoundPortfolio:
    """The smallest of all bounds, with its proof; may be interrupted at any point, as all of them may."""

    def __init__(self, known: Known, *, in_depth: bool = True) -> None:
        self._concave = RestartedSearch(known)
        self._known = known
        self._in_depth = _search_in_depth(known) if in_depth else None
        self._slice, self._nodes = float(SLICE), 1.0
        self._params = DepthParams()
        self._in_depth_share = self._params.first if self._beside_rows else self._params.most

    @property
    def upper(self) -> float:
        """Proved upper bound on the optimum."""
        spacing = self._known.rule.spacing
        return self._before_spacing if spacing is None else spacing.below(self._before_spacing)

    @property
    def _before_spacing(self) -> float:
        return min(end.upper for end in self._ends())

    def proof(self) -> UpperProof:
        """The proof of :attr:`upper`, together with the spacing of values."""
        proof = min(self._ends(), key=lambda end: end.upper).proof()
        return replace(proof, spacing=self._known.rule.spacing)

    def run(self, slices: TimeSlices, progress: Progress) -> Stop:
        """Search until the gap closes, the budget is spent or it is time for a proof; return why it stopped."""
        if self._beside_rows and slices.budget.nodes == 0:
            self._walk(slices)
        if self._in_depth is None:
            return self._concave.run(slices, progress)
        while True:
            before = slices.budget.nodes
            stop = self._run_concave(slices, progress, int(self._nodes))
            if stop is Stop.NODES and slices.budget.stop() is None:
                upper = self._before_spacing
                stop = self._in_depth.run(slices, progress, upper, max(int(self._in_depth_share * self._slice), 1))
                self._share_out(lowered=self._in_depth.upper < upper)
            if stop is not Stop.NODES or slices.budget.stop() is not None:
                return stop
            if slices.budget.nodes == before:  # all that is left is what margins for rounding leave
                return Stop.GAP
            self._nodes = self._slice
            self._slice *= SLICE_GROWTH

    def _walk(self, slices: TimeSlices) -> None:
        """Look for a better plan before the root: what closes a node is measured by the best one."""
        walk = Walk(self._known.incumbent, np.random.default_rng(0))
        walk.run(slices.budget.part(self._params.walk_share), self._params.walk_kicks)

    @property
    def _beside_rows(self) -> bool:
        return self._known.rows_from == 0

    def _share_out(self, *, lowered: bool) -> None:
        """Give the search in depth fewer nodes beside rows, unless it has just lowered the upper end."""
        if lowered:
            self._in_depth_share = self._params.most
        elif self._beside_rows:
            self._in_depth_share *= self._params.in_vain

    def _ends(self) -> list[RestartedSearch | SearchByLevels]:
        return [self._concave] if self._in_depth is None else [self._concave, self._in_depth]

    def _run_concave(self, slices: TimeSlices, progress: Progress, nodes: int) -> Stop:
        until = slices.budget.nodes + nodes
        told = progress and (lambda nodes, lower, upper: progress(nodes, lower, min(upper, self.upper)))
        return self._concave.run(TimeSlicesUntil(slices, lambda: slices.budget.nodes >= until), told)


def _search_in_depth(known: Known) -> SearchByLevels | None:
    """The search if robots see few targets and the criterion is trace or log-det, of up to 64 dimensions.

    It knows no limit on how many robots are busy.
    """
    objective = known.task.objective
    if known.task.problem.at_most is not None:
        return None
    if objective.compiled_code not in SUMS or objective.dimension > LARGEST_DIMENSION:
        return None
    seen = np.trace(objective.information, axis1=-2, axis2=-1) > 0
    if seen.mean() > 1 - UNSEEN:
        return None
    elements = Elements(known.task.problem)
    return MarginalSearch.of(known, elements) or CoverSearch.of(known, elements)
