"""Branch and bound over elements and winning groups, by outer approximation of concave relaxations.

At a node, tangent cuts of the groups' values and the linear program of :class:`NodeProgram` bound the
relaxed plans that remain. Outcomes enter when a plan or a relaxed plan is attacked. An attack that leaves several
groups bounds a plan by the best of them, which is not concave: groups that never win are closed by bounds of
their own, and where that fails the node branches on which group wins (:mod:`ratt_opt.solvers.maxmin.winners`).
"""

from __future__ import annotations

import heapq
from typing import TYPE_CHECKING

import numpy as np

from ratt_opt.solvers.maxmin.branching import divide_by_scores, divide_elements, mixing_gains, rounding_losses
from ratt_opt.solvers.maxmin.cut_store import CutStore
from ratt_opt.solvers.maxmin.node_program import NodeProgram
from ratt_opt.solvers.maxmin.proof import Leaf, UpperProof
from ratt_opt.solvers.maxmin.search_tree import TreeNode, divide, freeze, representatives, used_cuts, with_choice
from ratt_opt.solvers.maxmin.winners import Winners
from ratt_opt.stopping import Stop

if TYPE_CHECKING:
    from collections.abc import Callable

    from ratt_opt._validation import BoolArray, FloatArray, IntArray
    from ratt_opt.solvers.maxmin.incumbent import Incumbent
    from ratt_opt.solvers.maxmin.node_program import RelaxedPlan
    from ratt_opt.solvers.maxmin.outcome_pool import OutcomePool
    from ratt_opt.solvers.maxmin.pair_outcomes import PairOutcomes
    from ratt_opt.solvers.maxmin.search_tree import Classes

__all__ = ["BranchAndBound"]

CUTS_A_ROUND = 8
TARGETS_A_CUT = 4
STALL = 0.03
"""A round that closes less than this share of the remaining gap counts as a stall; two stalls end the rounds."""
STALLS_ELSEWHERE, STALLS_AT_ROOT = 2, 12
PATIENCE = 8
"""Solves without a multiplier after which a cut leaves the program; it stays stored."""
FLAT = 1e-2
"""Mixtures that cost less than this share of the gap in every cut do not explain it; known outcomes that a rounded plan
falls short in may."""
SHORT_OUTCOMES = 16
NEGLIGIBLE = 1e-12
"""Multipliers below this are left out of a leaf."""


class BranchAndBound:
    """The search; :meth:`run` may be interrupted at any point and leaves a valid bracket and proof."""

    def __init__(
        self, pool: OutcomePool, incumbent: Incumbent, classes: Classes, gap: float, pairs: PairOutcomes | None
    ) -> None:
        self.problem, self.objective = problem, objective = pool.problem, pool.objective
        self.pool, self.incumbent, self.gap, self._pairs = pool, incumbent, gap, pairs
        self.nodes = 0
        self.classes, everything = classes, representatives(classes)
        self._program = NodeProgram(problem.objective.n, everything)
        self._cuts = CutStore(problem, objective, pool)
        self._winners = Winners(objective, self._cuts, incumbent, self.classes, closes=self._closes, close=self._close)
        self._singles = objective.singletons()
        self._queue: list[tuple[float, int, TreeNode]] = []
        self._pushed = 0
        self._closed: list[TreeNode] = []
        self._finished = self._decided = -np.inf
        self._current: TreeNode | None = None
        self._root = self._first_node(everything)
        self._push(self._root)

    # -- the bracket -------------------------------------------------------------------------------------------

    @property
    def upper(self) -> float:
        """Proved upper bound on the optimum: the largest bound of an open or finished node."""
        still = [-self._queue[0][0]] if self._queue else []
        if self._current is not None:
            still.append(self._current.bound)
        return max(self._finished, self._decided, self._winners.finished, self.incumbent.lower, *still)

    def proof(self) -> UpperProof:
        """The proof of :attr:`upper`: winners decided for all plans, then the tree."""
        outcomes = {int(self._cuts.outcomes[k]) for k in used_cuts(self._root)}
        root = self._winners.above(self._root, outcomes)
        return UpperProof(attacks=tuple(self.pool.attacks), cuts=self._cuts.record(), root=freeze(root))

    # -- the search --------------------------------------------------------------------------------------------

    def run(self, max_nodes: int | None, progress: Callable[[int, float, float], None] | None) -> Stop:
        """Search until the gap closes, or the nodes or the incumbent's time are spent; return why it stopped."""
        while True:
            if not self._queue or self._closes(-self._queue[0][0]):
                if not self._reopen():
                    return Stop.GAP
                continue
            if max_nodes is not None and self.nodes >= max_nodes:
                return Stop.NODES
            self._current = self._queue[0][2]  # before it leaves the queue: an interrupt must not lose it
            heapq.heappop(self._queue)
            self.nodes += 1
            if not self._explore(self._current):
                self._push(self._current)
                self._current = None
                return Stop.TIME
            self._current = None
            if progress is not None:
                progress(self.nodes, self.incumbent.lower, self.upper)

    def _explore(self, node: TreeNode) -> bool:
        """Bound one node by rounds of cuts, then close it or divide it; False when time ran out."""
        narrowed = self._narrow(node)
        if narrowed is None:
            return True
        self._current = node = narrowed
        stalls = 0
        allowed_stalls = STALLS_AT_ROOT if self.nodes == 1 else STALLS_ELSEWHERE
        usable = self._cuts.usable(self._winners.at(node))
        self._program.drop(lambda k: not usable[k])
        self._program.drop_idle(PATIENCE)
        self._seed(node)
        while True:
            if self.incumbent.out_of_time:
                return False
            self._program.allow(self._allowed(node))
            relaxed = self._program.solve()
            if relaxed is None:
                return self._divide(node, None)
            before = node.bound
            found = self._tighten(node, relaxed)
            if self._closes(node.bound):
                self._close(node)
                return True
            plan = self._rounded(relaxed)
            if self.incumbent.offer(plan):
                self.incumbent.improve(plan)
            self._current = node = self._eliminate(node, *found)
            remaining = node.bound - self.incumbent.level
            stalls = stalls + 1 if before - node.bound < STALL * remaining else 0
            if not self._separate(node, relaxed) or stalls >= allowed_stalls:
                if self.nodes & (self.nodes - 1) == 0:  # the first nodes, and ever fewer
                    self.incumbent.improve(self._rounded(relaxed))
                return self._divide(node, relaxed)

    def _narrow(self, node: TreeNode) -> TreeNode | None:
        """What remains of a node once elements that are weak in some pair are split off, if anything does."""
        level = self.incumbent.level
        if self._pairs is None or not level > 0:
            return node
        return self._pairs.narrow(node, level / (1 - min(self.gap, 0.5)), self._winners, self.pool)

    def _seed(self, node: TreeNode) -> None:
        """Give a node without a usable cut one on every outcome whose winner is decided there."""
        if self._program.in_use:
            return
        best = np.array([choice[self._singles[choice].argmax()] for choice in node.choices])
        points = self.pool.group_points(self.objective.information[best])
        for outcome, winner in enumerate(self._winners.at(node).tolist()):
            if winner >= 0 and len(self._program.in_use) < CUTS_A_ROUND:
                self._use(self._cuts.tangent(outcome, winner, points[winner]))

    def _closes(self, bound: float) -> bool:
        # Below the incumbent's level, proved or not, no better plan is to be found; ``upper`` keeps the bound.
        return bool(np.isfinite(bound)) and bound <= self.incumbent.level + self.gap * abs(bound)

    def _close(self, node: TreeNode) -> None:
        self._closed.append(node)
        self._finished = max(self._finished, node.bound)

    def _reopen(self) -> bool:
        """Queue nodes that were closed against a better incumbent than there is now; whether there are any."""
        again = [node for node in self._closed if not self._closes(node.bound)]
        if again:
            self._closed = [node for node in self._closed if self._closes(node.bound)]
            self._finished = max((node.bound for node in self._closed), default=-np.inf)
            for node in again:
                self._push(node)
        if not self._closes(self._winners.finished):
            self._winners.reconsider()
        return bool(again)

    def _tighten(self, node: TreeNode, relaxed: RelaxedPlan) -> tuple[Leaf, float, FloatArray]:
        """Derive the node's bound from the multipliers, keeping the old one where it is better.

        Returns the leaf of these multipliers, its bound and its combined scores (E,).
        """
        active = relaxed.duals > NEGLIGIBLE
        if not active.any():
            return node.leaf, *self._cuts.leaf_bound(node.leaf, node.choices)
        leaf = Leaf(cuts=tuple(relaxed.cuts[active].tolist()), weights=tuple(relaxed.duals[active].tolist()))
        bound, combined = self._cuts.leaf_bound(leaf, node.choices)
        if bound < node.bound:
            node.bound, node.leaf = bound, leaf
        return leaf, bound, combined

    def _eliminate(self, node: TreeNode, leaf: Leaf, bound: float, combined: FloatArray) -> TreeNode:
        """Split off elements whose choice would close the node by the same multipliers; return what remains."""
        slack = self.incumbent.level + self.gap * abs(bound) - bound
        for i in range(self.problem.n_robots):
            choice = node.choices[i]
            gone = combined[choice] - combined[choice].max() < slack
            if not gone.any() or gone.all():
                continue
            closed = node.child(with_choice(node.choices, i, choice[gone]))
            closed.leaf, closed.bound = leaf, self._cuts.leaf_bound(leaf, closed.choices)[0]
            if not self._closes(closed.bound):
                continue
            rest = node.child(with_choice(node.choices, i, choice[~gone]))
            divide(node, i, [closed, rest], self.classes)
            self._close(closed)
            node = rest
        return node

    def _divide(self, node: TreeNode, relaxed: RelaxedPlan | None) -> bool:
        """Branch on an undecided winner that would cut the relaxed plan off, else on the most mixed robot."""
        level = np.inf if relaxed is None else relaxed.level - 1e-9 * abs(relaxed.level)
        information = self.objective.information
        of_robot = information[self.incumbent.best] if relaxed is None else self._mixed(relaxed.selection)
        outcome = self._winners.undecided(node, of_robot, level)
        if outcome is not None:
            children = self._winners.divide(node, outcome)
        else:
            i, parts = self._branch(node, relaxed)
            if i is None:
                self._settle(node)
                return True
            children = [node.child(with_choice(node.choices, i, part)) for part in parts]
            divide(node, i, children, self.classes)
        for child in children:
            self._push(child)
        return True

    def _settle(self, node: TreeNode) -> None:
        """Finish a node of a single plan: a tangent at the plan itself is exact there."""
        points = self.pool.group_points(self.objective.information[[choice[0] for choice in node.choices]])
        values, winners = self.objective.value(points), self._winners.at(node)
        decided = np.flatnonzero(winners >= 0)
        if len(decided):
            outcome = int(decided[values[winners[decided]].argmin()])
            group = int(winners[outcome])
            leaf = Leaf(cuts=(self._cuts.tangent(outcome, group, points[group]),), weights=(1.0,))
            bound, _ = self._cuts.leaf_bound(leaf, node.choices)
            if bound < node.bound:
                node.bound, node.leaf = bound, leaf
        self._decided = max(self._decided, node.bound)

    def _branch(self, node: TreeNode, relaxed: RelaxedPlan | None) -> tuple[int | None, tuple[IntArray, ...]]:
        """The robot to branch on and the parts of its elements; any robot with a choice where none is mixed."""
        open_robots = [i for i, choice in enumerate(node.choices) if len(choice) > 1]
        if not open_robots:
            return None, ()
        if relaxed is None:
            choice = node.choices[open_robots[0]]
            return open_robots[0], (choice[:1], choice[1:])
        active = relaxed.duals > NEGLIGIBLE
        scores = self._cuts.scores(relaxed.cuts[active])
        losses = rounding_losses(node.choices, relaxed.selection, scores)
        i = int(losses.argmax())
        if losses[i] > FLAT * (node.bound - self.incumbent.level):
            return i, divide_by_scores(node.choices[i], relaxed.selection, scores, relaxed.duals[active])
        return self._branch_on_short(node, relaxed, open_robots)

    def _branch_on_short(
        self, node: TreeNode, relaxed: RelaxedPlan, open_robots: list[int]
    ) -> tuple[int, tuple[IntArray, ...]]:
        """The robot whose mixture gains most where the rounded plan falls short of the relaxed level."""
        points = self.pool.group_points(self._mixed(relaxed.selection))
        groups, weights = self._short(node, relaxed)
        gains = mixing_gains(
            self.problem,
            self.objective,
            selection=relaxed.selection,
            inside=self.pool.membership()[groups] > 0,
            points=points[groups],
            weights=weights,
            targets=[self.objective.tangent_targets(points[g], -np.inf, 1)[0] for g in groups.tolist()],
        )
        i = max(open_robots, key=lambda r: (gains[r], float(np.ptp(self._singles[node.choices[r]]))))
        heaviest = points[groups[int(weights.argmax())]] if len(weights) else self.objective.prior_information
        return i, divide_elements(self.objective, node.choices[i], relaxed.selection, heaviest)

    def _short(self, node: TreeNode, relaxed: RelaxedPlan) -> tuple[IntArray, FloatArray]:
        """Groups that fall short of the relaxed level once the relaxed plan is rounded, and by how much."""
        plan = np.array([choice[relaxed.selection[choice].argmax()] for choice in node.choices])
        values = self.pool.group_values(self.objective.information[plan])
        teams = self.pool.outcome_values(values)
        worst = np.argsort(teams, kind="stable")[:SHORT_OUTCOMES]
        worst = worst[teams[worst] < relaxed.level]
        best = [max(self.pool.of_outcome[o], key=lambda g: values[g]) for o in worst.tolist()]
        return np.array(best, dtype=np.int64), relaxed.level - teams[worst]

    # -- outcomes, cuts, plans ---------------------------------------------------------------------------------

    def _separate(self, node: TreeNode, relaxed: RelaxedPlan) -> bool:
        """Use cuts that the relaxed plan violates; False when no stored, known or new outcome has one."""
        level = relaxed.level - 1e-10 * abs(relaxed.level)
        of_robot = self._mixed(relaxed.selection)
        values = self.pool.group_values(of_robot)
        if self._use_stored(node, relaxed.selection, values, level):
            return True
        if self._cut_known(node, of_robot, values, level):
            return True
        return self._attack_relaxed(of_robot) and self._cut_known(
            node, of_robot, self.pool.group_values(of_robot), level
        )

    def _use_stored(self, node: TreeNode, selection: FloatArray, values: FloatArray, level: float) -> bool:
        """Bring back stored cuts that the relaxed plan violates by much of what a new cut could."""
        winners = self._winners.at(node)
        lowest = float(values[winners[winners >= 0]].min(initial=np.inf))
        deepest = level - 0.5 * max(level - lowest, 0.0)
        bounds = self._cuts.bounds(selection)
        usable = self._cuts.usable(winners) & (bounds < deepest)
        usable[self._program.in_use] = False
        candidates = np.flatnonzero(usable)
        for k in candidates[np.argsort(bounds[candidates], kind="stable")][:CUTS_A_ROUND].tolist():
            self._use(k)
        return len(candidates) > 0

    def _cut_known(self, node: TreeNode, of_robot: FloatArray, values: FloatArray, level: float) -> bool:
        """Add tangents at the relaxed plan for the known outcomes of smallest value below ``level``."""
        teams = self.pool.outcome_values(values)
        cut_groups: set[int] = set()
        for outcome in np.argsort(teams, kind="stable").tolist():
            if teams[outcome] >= level or len(cut_groups) >= CUTS_A_ROUND:
                break
            winner = self._winners.of(node, outcome)
            if winner is None or winner in cut_groups or values[winner] >= level:
                continue
            members = list(self.pool.groups[winner])
            point = np.asarray(self.objective.prior_information + of_robot[members].sum(axis=0))
            for target in self.objective.tangent_targets(point, level, TARGETS_A_CUT):
                self._use(self._cuts.tangent(outcome, winner, point, target))
            cut_groups.add(winner)
        return bool(cut_groups)

    def _use(self, k: int) -> None:
        self._program.use(k, float(self._cuts.constants[k]), self._cuts.scores(k))

    def _attack_relaxed(self, of_robot: FloatArray) -> bool:
        """Attack the relaxed plan as if it were one; return whether a new outcome was found."""
        known = len(self.pool.attacks)
        self.incumbent.attack_relaxed(of_robot)
        return len(self.pool.attacks) > known

    def _rounded(self, relaxed: RelaxedPlan) -> IntArray:
        return np.array([choice[relaxed.selection[choice].argmax()] for choice in self._root.choices])

    def _mixed(self, selection: FloatArray) -> FloatArray:
        """(N, M, d, d) information of each robot under a relaxed selection."""
        information = self.objective.information
        chosen = np.flatnonzero(selection)
        owner = np.zeros((self.problem.n_robots, len(chosen)))
        owner[self.problem.robot[chosen], np.arange(len(chosen))] = selection[chosen]
        flat = owner @ information[chosen].reshape(len(chosen), -1)
        return np.asarray(flat.reshape(-1, *information.shape[1:]))

    # -- bookkeeping -------------------------------------------------------------------------------------------

    def _first_node(self, choices: tuple[IntArray, ...]) -> TreeNode:
        """The root, bounded by one tangent cut of the incumbent's worst attack where its winner is decided."""
        node = TreeNode(choices=choices, winners={}, bound=np.inf, leaf=Leaf(cuts=(), weights=()))
        points = self.pool.group_points(self.objective.information[self.incumbent.best])
        for outcome in range(len(self.pool.attacks)):
            winner = self._winners.of(node, outcome)
            if winner is None:
                continue
            k = self._cuts.tangent(outcome, winner, points[winner])
            self._use(k)
            leaf = Leaf(cuts=(k,), weights=(1.0,))
            bound, _ = self._cuts.leaf_bound(leaf, choices)
            if bound < node.bound:
                node.bound, node.leaf = bound, leaf
            if len(self._cuts) >= 4 * CUTS_A_ROUND:
                break
        return node

    def _allowed(self, node: TreeNode) -> BoolArray:
        allowed = np.zeros(self.problem.objective.n, dtype=np.bool_)
        allowed[np.concatenate(node.choices)] = True
        return allowed

    def _push(self, node: TreeNode) -> None:
        heapq.heappush(self._queue, (-node.bound, self._pushed, node))
        self._pushed += 1
