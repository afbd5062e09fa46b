"""Winners of outcomes: the group that bounds the team value, and proofs that the others stay low.

The team value is the best group's, which is not concave; a single group's is. A group that provably stays below the
best plan can be left out: if all but one can, for every plan, the outcome's *winner* is decided for the whole search;
elsewhere a node divides on it (``division.py``).

The proof that a group never exceeds a level is a small depth-first search of its own: tangent cuts at improving
mixtures of the group's elements bound it, and if one cut is not enough the robot whose mixture gains most is divided.
One plan above the level ends it without a proof.
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import IntEnum
from typing import TYPE_CHECKING

import numpy as np

from ratt_opt.bounds.cuts import GroupCut, combined_bound, tangent_cut
from ratt_opt.solvers.maxmin.elements import with_choice
from ratt_opt.solvers.maxmin.mixtures import divide_elements, mixing_gains
from ratt_opt.solvers.maxmin.proof import Leaf, Split, TreeNode, nodes_below

if TYPE_CHECKING:
    from ratt_opt._validation import FloatArray, IntArray
    from ratt_opt.budget import Budget
    from ratt_opt.solvers.maxmin.candidates import Candidates
    from ratt_opt.solvers.maxmin.cut_store import CutStore
    from ratt_opt.solvers.maxmin.elements import Choices, Task
    from ratt_opt.solvers.maxmin.frontier import ClosingRule, Frontier

__all__ = ["ClosedGroup", "GroupProofs", "Winners", "close_group"]


class Undecided(IntEnum):
    """Mark in place of a winner: not asked yet, or not decided for all plans."""

    UNKNOWN = -2
    OPEN = -1


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class ClosedGroup:
    """A node of the proof: closed by ``cut``, or divided into ``parts`` = (elements of ``robot``, node)."""

    bound: float
    cut: GroupCut | None = None
    robot: int = -1
    parts: tuple[tuple[IntArray, ClosedGroup], ...] = ()


class _RefutedError(Exception):
    """The group exceeds the level with some elements, the proof became too large, or the time is up."""


def close_group(
    task: Task, members: tuple[int, ...], choices: Choices, rule: ClosingRule, budget: Budget
) -> ClosedGroup | None:
    """Prove that ``rule`` closes the group's value under every plan within ``choices``, or return ``None``.

    Of hundreds of robots and targets a proof takes seconds, so the budget is asked at each of its nodes.
    """
    search = _ClosingSearch(task, members, rule, budget)
    try:
        return search.close(choices)
    except _RefutedError:
        return None


class _ClosingSearch:
    def __init__(self, task: Task, members: tuple[int, ...], rule: ClosingRule, budget: Budget) -> None:
        self.problem, self.objective, self.params = task.problem, task.objective, task.params.group_proofs
        self.members, self.rule, self.budget = members, rule, budget
        self.inside = np.isin(np.arange(task.problem.n_robots), members)
        self.cuts = 0

    def close(self, choices: Choices) -> ClosedGroup:
        """Close one node of the proof, by a cut or by dividing it."""
        if self.budget.is_over:
            raise _RefutedError
        own = tuple(choices[i] for i in self.members)
        plan = np.array([choice[0] for choice in own], dtype=np.int64)
        selection = np.zeros(self.objective.n)
        for step in range(self.params.steps):
            share = 2 / (step + 2)
            selection *= 1 - share
            selection[plan] += share
            chosen = np.flatnonzero(selection)
            mixed = np.tensordot(selection[chosen], self.objective.information[chosen], axes=1)
            point: FloatArray = self.objective.prior_information + mixed
            cut = tangent_cut(self.problem, self.members, point)
            self.cuts += 1
            bound, scores = combined_bound(
                np.array([cut.constant]), cut.scores[None], np.ones(1), choices, self.problem.choice_limit
            )
            if self.rule.closes(bound):
                return ClosedGroup(bound=bound, cut=cut)
            plan = self._best(scores, choices)
            value = float(self.objective.value(self.objective.posterior_information(plan)[None])[0])
            if not self.rule.closes(value) or self.cuts > self.params.cuts:
                raise _RefutedError
        return self._divide(choices, selection, point, cut.target)

    def _best(self, scores: FloatArray, choices: Choices) -> IntArray:
        """(members,) the elements of largest scores that a plan may have."""
        limit = self.problem.choice_limit
        best = None if limit is None else limit.best_plan(scores, choices)
        if best is not None:
            return best[list(self.members)]
        return np.array([choices[i][scores[choices[i]].argmax()] for i in self.members], dtype=np.int64)

    def _divide(self, choices: Choices, selection: FloatArray, point: FloatArray, target: int | None) -> ClosedGroup:
        inside, points = self.inside[None], point[None]
        gains = mixing_gains(
            self.problem, selection=selection, inside=inside, points=points, weights=np.ones(1), targets=[target]
        )
        divisible = [i for i in self.members if len(choices[i]) > 1]
        if not divisible:
            raise _RefutedError
        robot = max(divisible, key=lambda i: (gains[i], -i))
        parts = tuple(
            (part, self.close(with_choice(choices, robot, part)))
            for part in divide_elements(self.objective, choices[robot], selection, point)
        )
        return ClosedGroup(bound=max(node.bound for _, node in parts), robot=robot, parts=parts)


class GroupProofs:
    """Proofs that close groups of the pool; attempts are remembered until a better plan is known."""

    def __init__(self, cuts: CutStore, rule: ClosingRule, budget: Budget) -> None:
        self.task, self.pool, self.cuts, self.rule, self.budget = cuts.task, cuts.pool, cuts, rule, budget
        self._attempts: dict[tuple[int, bytes], tuple[float, ClosedGroup | None]] = {}
        self._written: dict[tuple[int, ClosedGroup], int] = {}
        """Outcome and proof -> the cut in the store: the same proof is written below many nodes."""

    def find(self, group: int, choices: Choices) -> ClosedGroup | None:
        """A proof that a group stays low enough within ``choices``, if one is found."""
        members = self.pool.groups[group]
        key = (group, b"|".join(choices[i].tobytes() for i in members))
        level, proof = self._attempts.get(key, (-np.inf, None))
        if proof is not None and not self.rule.closes(proof.bound):
            level, proof = -np.inf, None  # of a time when the best plan seemed better
        if proof is None and level < self.rule.level:
            proof = close_group(self.task, members, choices, self.rule, self.budget)
            self._attempts[key] = (self.rule.level, proof)
        return proof

    def graft(self, node: TreeNode, outcome: int, group: int, proof: ClosedGroup) -> list[TreeNode]:
        """Write the proof that a group is closed below ``node`` of the search tree; return its leaves."""
        if proof.cut is not None:
            if (k := self._written.get((outcome, proof))) is None:
                k = self._written[outcome, proof] = self.cuts.add(outcome, group, proof.cut)
            node.leaf = Leaf(cuts=(k,), weights=(1.0,))
            node.bound = proof.bound
            return [node]
        children = [node.child(with_choice(node.choices, proof.robot, part)) for part, _ in proof.parts]
        node.divide(proof.robot, children, self.task)
        return [
            leaf
            for child, (_, below) in zip(children, proof.parts, strict=True)
            for leaf in self.graft(child, outcome, group, below)
        ]


class Winners:
    """Winners of the outcomes in the pool, decided when first asked for.

    ``finished`` : largest bound of a group closed for the whole search; part of its upper bound.
    """

    def __init__(self, proofs: GroupProofs, plans: Candidates) -> None:
        self.task, self.pool, self.proofs, self.plans = proofs.task, proofs.pool, proofs, plans
        self.finished = -np.inf
        self._everything = self.task.choices
        self._winner = np.zeros(0, dtype=np.int64)
        self._closed: dict[int, list[tuple[int, ClosedGroup]]] = {}
        self._reopened: dict[int, tuple[tuple[tuple[int, ...], TreeNode | None], ...]] = {}
        """Outcome -> robots of each group and the node where it wins; ``None`` is all that was searched before."""

    @property
    def decided(self) -> dict[int, int]:
        """Outcome -> winner, if other groups were closed for all plans."""
        return {outcome: int(self._winner[outcome]) for outcome in self._closed}

    def at(self, node: TreeNode) -> IntArray:
        """(O,) winner of each outcome at a node; negative if that is not decided."""
        self._grow()
        winners = self._winner.copy()
        for outcome, group in node.winners.items():
            winners[outcome] = group
        return winners

    def of(self, node: TreeNode, outcome: int) -> int | None:
        """The group that bounds the team value of an outcome at this node, if that is decided."""
        if outcome in node.winners:
            return node.winners[outcome]
        self._grow()
        if self._winner[outcome] == Undecided.UNKNOWN:
            self._decide(outcome)
        winner = int(self._winner[outcome])
        return winner if winner >= 0 else None

    def _grow(self) -> None:
        missing = len(self.pool) - len(self._winner)
        if missing > 0:
            self._winner = np.concatenate([self._winner, np.full(missing, Undecided.UNKNOWN)])

    def _decide(self, outcome: int) -> None:
        """Close all groups of an outcome but the strongest by bounds that hold for every plan, if that works."""
        groups = self.pool.of_outcome[outcome]
        values = {g: self._value(g) for g in groups}
        winner = max(groups, key=lambda g: (values[g], -g))
        closed = []
        for group in groups:
            if group == winner:
                continue
            proof = self.proofs.find(group, self._everything)
            if proof is None:
                self._winner[outcome] = Undecided.OPEN
                return
            closed.append((group, proof))
        if closed:
            self._closed[outcome] = closed
            self.finished = max(self.finished, *(proof.bound for _, proof in closed))
        self._winner[outcome] = winner

    def _value(self, group: int) -> float:
        """Value of one group under the best plan."""
        objective, plan = self.task.objective, self.plans.best[list(self.pool.groups[group])]
        return float(objective.value(objective.posterior_information(plan)[None])[0])

    def reconsider(self) -> list[int]:
        """Close again what no longer closes, as the best plan turned out worse; return the outcomes left open."""
        if self.proofs.rule.closes(self.finished):
            return []
        failed = []
        for outcome, closed in self._closed.items():
            for k, (group, proof) in enumerate(closed):
                if not self.proofs.rule.closes(proof.bound):
                    closed[k] = group, self.proofs.find(group, self._everything) or proof
            if any(not self.proofs.rule.closes(proof.bound) for _, proof in closed):
                failed.append(outcome)
        self._bound_closed()
        return failed

    def _bound_closed(self) -> None:
        self.finished = max((p.bound for closed in self._closed.values() for _, p in closed), default=-np.inf)

    def reopen(self, outcome: int, root: TreeNode, frontier: Frontier) -> None:
        """Divide the whole search on the winner of an outcome that was decided for all plans and no longer is.

        What was searched is the part where that winner wins; parts where others win are bounded by their old proofs
        and go to the frontier. An interrupt on the way leaves bounds and proof as valid as before.
        """
        winner, closed = int(self._winner[outcome]), self._closed[outcome]
        for node in frontier.nodes():
            node.winners.setdefault(outcome, winner)
        parts: list[tuple[tuple[int, ...], TreeNode | None]] = [(self.pool.groups[winner], None)]
        for group, proof in closed:
            node = TreeNode(choices=root.choices, winners={outcome: group}, bound=np.inf, leaf=root.leaf)
            for leaf in self.proofs.graft(node, outcome, group, proof):
                frontier.finish(leaf)
            parts.append((self.pool.groups[group], node))
        self._reopened[outcome] = tuple(parts)
        self._winner[outcome] = Undecided.OPEN
        del self._closed[outcome]
        self._bound_closed()

    def above(self, root: TreeNode) -> TreeNode:
        """The search tree below the branches on winners that were decided for all plans, if they are relied on.

        Those that no longer are come last, the latest above the others: only what was searched before relies on them.
        """
        top = root
        for outcome, parts in self._reopened.items():
            top = self._branch(root, outcome, [(members, top if node is None else node) for members, node in parts])
        used = {k for node in nodes_below(top) if node.split is None for k in node.leaf.cuts}
        outcomes = {int(self.proofs.cuts.outcomes[k]) for k in used}
        for outcome in sorted((outcomes & set(self._closed)) - set(self._reopened)):
            below = [(self.pool.groups[int(self._winner[outcome])], top)]
            for group, proof in self._closed[outcome]:
                node = TreeNode(choices=root.choices, winners={}, bound=-np.inf, leaf=root.leaf)
                self.proofs.graft(node, outcome, group, proof)
                below.append((self.pool.groups[group], node))
            top = self._branch(root, outcome, below)
        return top

    def _branch(self, root: TreeNode, outcome: int, parts: list[tuple[tuple[int, ...], TreeNode]]) -> TreeNode:
        split = Split(by_winner=True, subject=outcome, parts=tuple(parts))
        return TreeNode(choices=root.choices, winners={}, bound=root.bound, leaf=root.leaf, split=split)
