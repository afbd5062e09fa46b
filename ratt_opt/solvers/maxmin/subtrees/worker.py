"""What a worker does: search some open nodes of one problem for a while, and say how far their proofs have come."""

from __future__ import annotations

import threading
from contextlib import suppress
from dataclasses import dataclass, replace
from math import inf
from typing import TYPE_CHECKING

from ratt_opt.budget import Budget, OutOfBudget
from ratt_opt.solvers.maxmin.groups.pair_outcomes import PairOutcomes
from ratt_opt.solvers.maxmin.plans.incumbent import Incumbent
from ratt_opt.solvers.maxmin.plans.outcome_pool import OutcomePool
from ratt_opt.solvers.maxmin.proof import Leaf, TreeNode
from ratt_opt.solvers.maxmin.search import BranchAndBound, Known
from ratt_opt.solvers.maxmin.task import Task
from ratt_opt.solvers.maxmin.turns import Turns

if TYPE_CHECKING:
    from ratt_opt._validation import IntArray
    from ratt_opt.budget import Stop
    from ratt_opt.graph.outcomes import Outcome
    from ratt_opt.problem import Attack, Problem
    from ratt_opt.solvers.maxmin.proof import TangentCut, UpperProof
    from ratt_opt.solvers.maxmin.task import Choices

__all__ = ["LentNode", "Searched", "Work", "search_nodes"]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class LentNode:
    """An open node: what remains, which groups win, and the cuts that bound it so far.

    ``winners`` : (outcome, robots of the group) pairs, outcomes by index.
    """

    choices: Choices
    winners: tuple[tuple[int, tuple[int, ...]], ...]
    leaf: Leaf


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Work:
    """Nodes to search, what is known of their problem, and for how long.

    ``search``, ``tree`` : names of the whole search and of the tree that the nodes are of; ``floor`` : that tree's
    ``plan`` : (N,) the best one known; ``outcomes`` : all that are known
    ``cuts`` : those of the nodes' leaves
    ``nodes_before`` : of the whole search until now; ``max_nodes`` : at which count of the whole to stop
    """

    search: str
    tree: str
    problem: Problem
    gap: float
    floor: float
    plan: IntArray
    outcomes: tuple[Attack | Outcome, ...]
    cuts: tuple[TangentCut, ...]
    roots: tuple[LentNode, ...]
    nodes_before: int
    max_nodes: int | None
    seconds: float


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Searched:
    """``proofs`` : one a node, in order, whose leaves may still be open; ``plan``, ``outcomes`` : found on the way."""

    proofs: tuple[UpperProof, ...]
    plan: IntArray
    outcomes: tuple[Attack | Outcome, ...]
    nodes: int


def search_nodes(work: Work) -> Searched:
    """Search the nodes until they are closed or time is up; what is learnt helps with the next work of that search."""
    if getattr(_MEMORY, "search", None) != work.search:
        _MEMORY.worker, _MEMORY.search = _Worker(work), work.search
    found: Searched = _MEMORY.worker.search(work)
    return found


_MEMORY = threading.local()
"""The worker of the last search in this process or thread."""


class _Worker:
    """One search's outcomes and cuts, and one tree's winners and programs, kept from work to work; nodes are not."""

    def __init__(self, work: Work) -> None:
        self._budget = Budget(work.seconds)
        pool = OutcomePool(work.problem)
        self._incumbent = Incumbent(work.problem, pool, work.plan, self._budget)
        task = Task.of(work.problem)
        self._known = Known.of(task, self._incumbent, work.gap, PairOutcomes.of(task))
        self._begin(work)

    def _begin(self, work: Work) -> None:
        """Begin another tree: what was decided for all plans above the floor of one is not above that of the next."""
        self._known.rule.floor, self._tree = work.floor, work.tree
        self._search = BranchAndBound(self._known, [])

    def search(self, work: Work) -> Searched:
        """Search the nodes of one piece of work."""
        if work.tree != self._tree:
            self._begin(work)
        search, pool, budget = self._search, self._search.pool, self._budget
        budget.time_limit, budget.max_nodes = budget.elapsed + work.seconds, work.max_nodes
        budget.nodes = work.nodes_before
        outcomes = [pool.add_origin(outcome) for outcome in work.outcomes]
        pool.list_all()
        known = len(pool)
        if self._incumbent.candidates.meet(work.plan):
            self._incumbent.candidates.add(work.plan)
        self._place(work, outcomes)
        with suppress(OutOfBudget):
            search.run(_OneTurn(budget, self._incumbent), None)
        return Searched(
            proofs=tuple(search.proof(k) for k in range(len(search.roots))),
            plan=self._incumbent.candidates.best,
            outcomes=tuple(pool.origin(outcome) for outcome in range(known, len(pool))),
            nodes=budget.nodes - work.nodes_before,
        )

    def _place(self, work: Work, outcomes: list[int]) -> None:
        """Put the nodes into the search, each bounded by its own cuts, which the first programs hold."""
        search = self._search
        number = {group: g for g, group in enumerate(search.pool.groups)}
        cuts = [search.cuts.copied(outcomes[c.attack], number[c.group], c.point, c.target) for c in work.cuts]
        for k in dict.fromkeys(cuts):
            search.rounds.use_again(k)
        search.frontier.empty()
        search.roots.clear()
        for given in work.roots:
            winners = {outcomes[outcome]: number[group] for outcome, group in given.winners}
            leaf = replace(given.leaf, cuts=tuple(cuts[k] for k in given.leaf.cuts))
            bound = search.cuts.leaf_bound(leaf, given.choices)[0] if leaf.cuts else inf
            search.roots.append(TreeNode(choices=given.choices, winners=winners, bound=bound, leaf=leaf))
            search.frontier.push(search.roots[-1])


class _OneTurn(Turns):
    """No plan is attacked exactly here for its own sake: all the time is for searching."""

    def stop(self) -> Stop | None:
        """Why to stop searching now, if at all."""
        return self.budget.stop()
