"""Branch and bound over elements and winning groups, by outer approximation of concave relaxations.

At a node, tangent cuts of the groups' values and the linear program of :class:`NodeProgram` bound the
relaxed plans that remain. Outcomes enter when a plan or a relaxed plan is attacked. An attack that leaves several
groups bounds a plan by the best of them, which is not concave: small groups are closed at the root by a bound of
their own, and where that fails the node branches on which group wins.
"""

from __future__ import annotations

import heapq
import time
from typing import TYPE_CHECKING

import numpy as np

from ratt_opt.bounds.cuts import GroupCut, combined_bound, tangent_cut, worst_targets
from ratt_opt.solvers.branching import divide_elements, mixing_gains
from ratt_opt.solvers.node_program import NodeProgram
from ratt_opt.solvers.proof import Cut, Leaf, UpperProof
from ratt_opt.solvers.search_tree import TreeNode, freeze
from ratt_opt.stopping import Stop

if TYPE_CHECKING:
    from collections.abc import Callable

    from ratt_opt._validation import BoolArray, FloatArray, IntArray
    from ratt_opt.problem import Problem
    from ratt_opt.setfunctions.information import InformationObjective
    from ratt_opt.solvers.incumbent import Incumbent
    from ratt_opt.solvers.node_program import RelaxedPlan
    from ratt_opt.solvers.outcome_pool import OutcomePool

__all__ = ["BranchAndBound"]

CUTS_A_ROUND = 8
TARGETS_A_CUT = 4
STALL = 0.03
"""A round that closes less than this share of the remaining gap counts as a stall; two stalls end the rounds."""
PATIENCE = 30
"""Solves without a multiplier after which a cut leaves the program; it stays stored."""
NEGLIGIBLE = 1e-12
"""Multipliers below this are left out of a leaf."""


class BranchAndBound:
    """The search; :meth:`run` may be interrupted at any point and leaves a valid bracket and proof."""

    def __init__(
        self, problem: Problem, objective: InformationObjective, pool: OutcomePool, incumbent: Incumbent, gap: float
    ) -> None:
        self.problem, self.objective = problem, objective
        self.pool, self.incumbent, self.gap = pool, incumbent, gap
        self.nodes = 0
        self.classes = _equal_elements(problem, objective)
        representatives = tuple(np.array(sorted(own), dtype=np.int64) for own in self.classes)
        self._program = NodeProgram(problem.objective.n, representatives)
        self._cuts: list[GroupCut] = []
        self._origin: list[tuple[int, int]] = []
        self._constants = np.zeros(0)
        self._scores = np.zeros((0, problem.objective.n))
        self._singles = objective.singletons()
        self._winner: dict[int, int] = {}
        self._closed_groups: dict[int, list[tuple[int, Leaf]]] = {}
        self._queue: list[tuple[float, int, TreeNode]] = []
        self._pushed = 0
        self._finished = -np.inf
        self._current: TreeNode | None = None
        self._root = self._first_node(representatives)
        self._push(self._root)

    # -- the bracket -------------------------------------------------------------------------------------------

    @property
    def upper(self) -> float:
        """Proved upper bound on the optimum: the largest bound of an open or finished node."""
        still = [node.bound for _, _, node in self._queue]
        if self._current is not None:
            still.append(self._current.bound)
        return max(self._finished, self.incumbent.lower, *still) if still else max(self._finished, self.incumbent.lower)

    def proof(self) -> UpperProof:
        """The proof of :attr:`upper`: winners decided at the root, then the tree."""
        root = self._root
        for outcome, closed in self._closed_groups.items():
            above = TreeNode(choices=root.choices, winners={}, bound=root.bound, leaf=root.leaf)
            winner = self._winner[outcome]
            children = [(self.pool.groups[winner], root)]
            for group, leaf in closed:
                node = TreeNode(choices=root.choices, winners={}, bound=-np.inf, leaf=leaf)
                children.append((self.pool.groups[group], node))
            above.split = ("winner", outcome, children)
            root = above
        cuts = tuple(
            Cut(attack=outcome, group=cut.group, point=cut.point, target=cut.target)
            for (outcome, _), cut in zip(self._origin, self._cuts, strict=True)
        )
        return UpperProof(attacks=tuple(self.pool.attacks), cuts=cuts, root=freeze(root))

    # -- the search --------------------------------------------------------------------------------------------

    def run(
        self, deadline: float | None, max_nodes: int | None, progress: Callable[[int, float, float], None] | None
    ) -> Stop:
        """Search until the gap closes or a budget is spent; return why it stopped."""
        while self._queue:
            if self._closes(-self._queue[0][0]):
                break
            if max_nodes is not None and self.nodes >= max_nodes:
                return Stop.NODES
            self._current = heapq.heappop(self._queue)[2]
            self.nodes += 1
            if not self._explore(self._current, deadline):
                return Stop.TIME
            self._current = None
            if progress is not None:
                progress(self.nodes, self.incumbent.lower, self.upper)
        return Stop.CLOSED if self.upper <= self.incumbent.lower * (1 + 1e-9) else Stop.GAP

    def _explore(self, node: TreeNode, deadline: float | None) -> bool:
        """Bound one node by rounds of cuts, then close it or divide it; False when time ran out."""
        stalls = 0
        self._program.drop(lambda k: not self._is_usable(node, k))
        self._program.drop_idle(PATIENCE)
        self._seed(node)
        while True:
            if deadline is not None and time.monotonic() >= deadline:
                return False
            self._program.allow(self._allowed(node))
            relaxed = self._program.solve()
            if relaxed is None:
                return self._divide(node, None)
            before = node.bound
            found = self._tighten(node, relaxed)
            if self._closes(node.bound):
                self._finished = max(self._finished, node.bound)
                return True
            self._round(relaxed)
            node = self._eliminate(node, *found)
            remaining = node.bound - self.incumbent.lower
            stalls = stalls + 1 if before - node.bound < STALL * remaining else 0
            if not self._separate(node, relaxed) or stalls >= (12 if self.nodes == 1 else 2):
                return self._divide(node, relaxed)

    def _seed(self, node: TreeNode) -> None:
        """Give a node without a usable cut one on every outcome whose winner is decided there."""
        if self._program.in_use:
            return
        best = np.array([choice[self._singles[choice].argmax()] for choice in node.choices])
        of_robot = self.objective.information[best]
        for outcome, winner in {**self._winner, **node.winners}.items():
            if winner >= 0 and len(self._program.in_use) < CUTS_A_ROUND:
                k = self._add_cut(outcome, winner, of_robot)
                self._program.use(k, self._constants[k], self._scores[k])

    def _closes(self, bound: float) -> bool:
        return bool(np.isfinite(bound)) and bound <= self.incumbent.lower + self.gap * abs(bound)

    def _tighten(self, node: TreeNode, relaxed: RelaxedPlan) -> tuple[Leaf, float, FloatArray]:
        """Derive the node's bound from the multipliers, keeping the old one where it is better.

        Returns the leaf of these multipliers, its bound and its combined scores (E,).
        """
        active = relaxed.duals > NEGLIGIBLE
        if not active.any():
            bound, combined = self._leaf_bound(node.leaf, node.choices)
            return node.leaf, bound, combined
        weights = relaxed.duals[active].tolist()
        leaf = Leaf(cuts=tuple(relaxed.cuts[active].tolist()), weights=tuple(weights))
        bound, combined = self._leaf_bound(leaf, node.choices)
        if bound < node.bound:
            node.bound, node.leaf = bound, leaf
        return leaf, bound, combined

    def _eliminate(self, node: TreeNode, leaf: Leaf, bound: float, combined: FloatArray) -> TreeNode:
        """Split off elements whose choice would close the node by the same multipliers; return what remains."""
        slack = self.incumbent.lower + self.gap * abs(bound) - bound
        for i in range(self.problem.n_robots):
            choice = node.choices[i]
            gone = combined[choice] - combined[choice].max() < slack
            if not gone.any() or gone.all():
                continue
            closed = node.child(_with(node.choices, i, choice[gone]))
            closed.leaf, closed.bound = leaf, self._leaf_bound(leaf, closed.choices)[0]
            if not self._closes(closed.bound):
                continue
            rest = node.child(_with(node.choices, i, choice[~gone]))
            self._split(node, "element", i, [closed, rest])
            self._finished = max(self._finished, closed.bound)
            node = rest
            self._current = rest
        return node

    def _divide(self, node: TreeNode, relaxed: RelaxedPlan | None) -> bool:
        """Branch on an undecided winner that would cut the relaxed plan off, else on the most divided robot."""
        outcome = self._undecided(node, relaxed)
        if outcome is not None:
            children = self._divide_by_winner(node, outcome)
        else:
            i, parts = self._branch(node, relaxed)
            if i is None:
                self._finished = max(self._finished, node.bound)
                return True
            children = [node.child(_with(node.choices, i, part)) for part in parts]
            self._split(node, "element", i, children)
        for child in children:
            self._push(child)
        return True

    def _split(self, node: TreeNode, kind: str, robot: int, children: list[TreeNode]) -> None:
        parts = []
        for child in children:
            members = sorted(e for r in child.choices[robot].tolist() for e in self.classes[robot][r])
            parts.append((tuple(members), child))
        node.split = (kind, robot, parts)

    def _branch(self, node: TreeNode, relaxed: RelaxedPlan | None) -> tuple[int | None, tuple[IntArray, ...]]:
        """The robot to branch on and the parts of its elements; any robot with a choice where none is mixed."""
        open_robots = [i for i, choice in enumerate(node.choices) if len(choice) > 1]
        if not open_robots:
            return None, ()
        if relaxed is None:
            choice = node.choices[open_robots[0]]
            return open_robots[0], (choice[:1], choice[1:])
        active = relaxed.duals > NEGLIGIBLE
        cuts, weights = relaxed.cuts[active].tolist(), relaxed.duals[active]
        groups, targets = [self._origin[k][1] for k in cuts], [self._cuts[k].target for k in cuts]
        inside = self.pool.membership()[groups] > 0
        points = self.pool.group_points(self._mixed(relaxed.selection))[groups]
        gains = mixing_gains(
            self.problem,
            self.objective,
            selection=relaxed.selection,
            inside=inside,
            points=points,
            weights=weights,
            targets=targets,
        )
        i = max(open_robots, key=lambda r: (gains[r], float(np.ptp(self._singles[node.choices[r]]))))
        choice = node.choices[i]
        heaviest = points[int(weights.argmax())] if len(weights) else self.objective.prior_information
        return i, divide_elements(self.objective, choice, relaxed.selection, heaviest)

    # -- outcomes, cuts, plans ---------------------------------------------------------------------------------

    def _separate(self, node: TreeNode, relaxed: RelaxedPlan) -> bool:
        """Use cuts that the relaxed plan violates; False when no stored, known or new outcome has one."""
        level = relaxed.level - 1e-10 * abs(relaxed.level)
        if self._use_stored(node, relaxed.selection, level):
            return True
        of_robot = self._mixed(relaxed.selection)
        if self._cut_known(node, of_robot, level):
            return True
        return self._attack_relaxed(of_robot) and self._cut_known(node, of_robot, level)

    def _use_stored(self, node: TreeNode, selection: FloatArray, level: float) -> bool:
        """Bring back stored cuts that the relaxed plan violates by much of what a new cut could."""
        values = self._constants + self._scores @ selection
        deepest = level - 0.5 * max(level - self._lowest(node, selection), 0.0)
        used = 0
        for k in np.argsort(values, kind="stable").tolist():
            if values[k] >= deepest or used >= CUTS_A_ROUND:
                break
            if self._is_usable(node, k) and k not in self._program.in_use:
                self._program.use(k, self._constants[k], self._scores[k])
                used += 1
        return used > 0

    def _lowest(self, node: TreeNode, selection: FloatArray) -> float:
        """The smallest relaxed value of a known outcome whose winner is decided."""
        values = self.pool.group_values(self._mixed(selection))
        winners = [w for w in {**self._winner, **node.winners}.values() if w >= 0]
        return float(values[winners].min()) if winners else np.inf

    def _cut_known(self, node: TreeNode, of_robot: FloatArray, level: float) -> bool:
        values = self.pool.group_values(of_robot)
        teams = self.pool.outcome_values(values)
        cut_groups: set[int] = set()
        for outcome in np.argsort(teams, kind="stable").tolist():
            if teams[outcome] >= level or len(cut_groups) >= CUTS_A_ROUND:
                break
            winner = self._winner_of(node, outcome)
            if winner is None or winner in cut_groups or values[winner] >= level:
                continue
            for target in worst_targets(self.objective, self._point(winner, of_robot), level, TARGETS_A_CUT):
                k = self._add_cut(outcome, winner, of_robot, target)
                self._program.use(k, self._constants[k], self._scores[k])
            cut_groups.add(winner)
        return bool(cut_groups)

    def _point(self, group: int, of_robot: FloatArray) -> FloatArray:
        return np.asarray(self.objective.prior_information + of_robot[list(self.pool.groups[group])].sum(axis=0))

    def _add_cut(self, outcome: int, group: int, of_robot: FloatArray, target: int | None = None) -> int:
        point = self._point(group, of_robot)
        cut = tangent_cut(self.problem, self.objective, self.pool.groups[group], point, target)
        self._cuts.append(cut)
        self._origin.append((outcome, group))
        self._constants = np.append(self._constants, cut.constant)
        self._scores = np.concatenate([self._scores, cut.scores[None]])
        return len(self._cuts) - 1

    def _winner_of(self, node: TreeNode, outcome: int) -> int | None:
        """The group that bounds the team value of an outcome at this node, if that is decided."""
        if outcome in node.winners:
            return node.winners[outcome]
        if outcome not in self._winner:
            self._decide(outcome)
        winner = self._winner[outcome]
        return winner if winner >= 0 else None

    def _decide(self, outcome: int) -> None:
        """Close all groups of an outcome but the strongest by bounds that hold for every plan, if that works now."""
        groups = self.pool.of_outcome[outcome]
        of_robot = self.objective.information[self.incumbent.elements]
        values = self.pool.group_values(of_robot)
        winner = max(groups, key=lambda g: (values[g], -g))
        closed = []
        for group in groups:
            if group == winner:
                continue
            leaf = self._close_group(outcome, group, self._root.choices)
            if leaf is None:
                self._winner[outcome] = -1
                return
            closed.append((group, leaf))
        self._winner[outcome] = winner
        if closed:
            self._closed_groups[outcome] = closed

    def _close_group(self, outcome: int, group: int, choices: tuple[IntArray, ...]) -> Leaf | None:
        """A leaf that bounds one group below the incumbent for all plans within ``choices``, or ``None``."""
        members = self.pool.groups[group]
        best = np.array([choice[self._singles[choice].argmax()] for choice in choices])
        of_robot = self.objective.information[best]
        for step in range(6):
            cut = tangent_cut(self.problem, self.objective, members, self._point(group, of_robot))
            one = np.ones(1)
            bound, combined = combined_bound(np.array([cut.constant]), cut.scores[None], one, choices)
            if self._closes(bound):
                leaf = Leaf(cuts=(self._add_cut(outcome, group, of_robot, cut.target),), weights=(1.0,))
                self._finished = max(self._finished, self._leaf_bound(leaf, choices)[0])
                return leaf
            best = np.array([choice[combined[choice].argmax()] for choice in choices])
            share = 2 / (step + 2)
            of_robot = (1 - share) * of_robot + share * self.objective.information[best]
        return None

    def _divide_by_winner(self, node: TreeNode, outcome: int) -> list[TreeNode]:
        """Children in which the winner of an outcome is decided, or soon will be.

        Groups that a bound closes within the node's choices need no search. A single robot that may win
        with some of its elements only is divided into those and the others, so that the latter close.
        """
        groups = self.pool.of_outcome[outcome]
        sizes = {g: len(self.pool.groups[g]) for g in groups}
        winner = max(groups, key=lambda g: (sizes[g], -g))
        for group in groups:
            robot = self.pool.groups[group][0]
            choice = node.choices[robot]
            weak = self._singles[choice] <= self.incumbent.lower
            if sizes[group] == 1 and group != winner and weak.any() and not weak.all():
                children = [node.child(_with(node.choices, robot, choice[part])) for part in (weak, ~weak)]
                self._split(node, "element", robot, children)
                return children
        parts, open_children = [], []
        for group in groups:
            leaf = None if group == winner else self._close_group(outcome, group, node.choices)
            child = node.child(winner=(outcome, group))
            if leaf is None:
                open_children.append(child)
            else:
                child.leaf, child.bound = leaf, -np.inf
            parts.append((self.pool.groups[group], child))
        node.split = ("winner", outcome, parts)
        return open_children

    def _undecided(self, node: TreeNode, relaxed: RelaxedPlan | None) -> int | None:
        """The outcome of undecided winner with the smallest relaxed value, if that is below the node's level."""
        elements = self.objective.information[self.incumbent.elements]
        of_robot = elements if relaxed is None else self._mixed(relaxed.selection)
        level = np.inf if relaxed is None else relaxed.level - 1e-9 * abs(relaxed.level)
        teams = self.pool.outcome_values(self.pool.group_values(of_robot))
        for outcome in np.argsort(teams, kind="stable").tolist():
            if teams[outcome] >= level:
                return None
            if self._winner_of(node, outcome) is None:
                return int(outcome)
        return None

    def _attack_relaxed(self, of_robot: FloatArray) -> bool:
        """Attack the relaxed plan as if it were one; return whether a new outcome was found."""
        known = len(self.pool.attacks)
        for attack in self.incumbent.attack_relaxed(of_robot):
            self.pool.add(attack)
        return len(self.pool.attacks) > known

    def _round(self, relaxed: RelaxedPlan) -> None:
        plan = np.array([choice[relaxed.selection[choice].argmax()] for choice in self._root.choices])
        if self.incumbent.offer(plan):
            self.incumbent.improve()

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
        self._root = node
        of_robot = self.objective.information[self.incumbent.elements]
        for outcome in range(len(self.pool.attacks)):
            winner = self._winner_of(node, outcome)
            if winner is None:
                continue
            k = self._add_cut(outcome, winner, of_robot)
            self._program.use(k, self._constants[k], self._scores[k])
            leaf = Leaf(cuts=(k,), weights=(1.0,))
            bound, _ = self._leaf_bound(leaf, choices)
            if bound < node.bound:
                node.bound, node.leaf = bound, leaf
            if len(self._cuts) >= 4 * CUTS_A_ROUND:
                break
        return node

    def _leaf_bound(self, leaf: Leaf, choices: tuple[IntArray, ...]) -> tuple[float, FloatArray]:
        cuts = list(leaf.cuts)
        return combined_bound(self._constants[cuts], self._scores[cuts], np.array(leaf.weights), choices)

    def _allowed(self, node: TreeNode) -> BoolArray:
        allowed = np.zeros(self.problem.objective.n, dtype=np.bool_)
        allowed[np.concatenate(node.choices)] = True
        return allowed

    def _is_usable(self, node: TreeNode, cut: int) -> bool:
        outcome, group = self._origin[cut]
        return self._winner_of(node, outcome) == group

    def _push(self, node: TreeNode) -> None:
        heapq.heappush(self._queue, (-node.bound, self._pushed, node))
        self._pushed += 1


def _with(choices: tuple[IntArray, ...], robot: int, elements: IntArray) -> tuple[IntArray, ...]:
    return (*choices[:robot], elements, *choices[robot + 1 :])


def _equal_elements(problem: Problem, objective: InformationObjective) -> list[dict[int, list[int]]]:
    """Per robot, lowest element -> all elements with the same information: one of each is searched."""
    classes = []
    for choice in problem.choices:
        seen: dict[bytes, int] = {}
        own: dict[int, list[int]] = {}
        for e in choice.tolist():
            first = seen.setdefault(objective.information[e].tobytes(), e)
            own.setdefault(first, []).append(e)
        classes.append(own)
    return classes
