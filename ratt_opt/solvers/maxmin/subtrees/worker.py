"""What a worker does: search some open nodes of one problem for a while, and say how far their proofs have come."""

from __future__ import annotations

from contextlib import suppress
from dataclasses import dataclass, replace
from math import inf
from typing import TYPE_CHECKING

from ratt_opt.budget import Budget, OutOfBudget
from ratt_opt.solvers.maxmin.groups.pair_outcomes import PairOutcomes
from ratt_opt.solvers.maxmin.plans.incumbent import Incumbent
from ratt_opt.solvers.maxmin.plans.outcome_pool import OutcomePool
from ratt_opt.solvers.maxmin.proof import Leaf, TreeNode
from ratt_opt.solvers.maxmin.search import BranchAndBound, Turns
from ratt_opt.solvers.maxmin.task import Task

if TYPE_CHECKING:
    from ratt_opt._validation import IntArray
    from ratt_opt.graph.outcomes import Outcome
    from ratt_opt.problem import Attack, Problem
    from ratt_opt.solvers.maxmin.proof import Cut, UpperProof
    from ratt_opt.solvers.maxmin.task import Choices
    from ratt_opt.stopping import Stop

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

    ``plan`` : (N,) the best one known; ``outcomes`` : all that are known; ``cuts`` : those of the nodes' leaves
    ``nodes_before`` : of the whole search until now; ``max_nodes`` : at which count of the whole to stop
    """

    problem: Problem
    gap: float
    plan: IntArray
    outcomes: tuple[Attack | Outcome, ...]
    cuts: tuple[Cut, ...]
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
    """Search the nodes until they are closed or time is up."""
    budget = Budget(work.seconds, work.max_nodes)
    budget.nodes = work.nodes_before
    pool = OutcomePool(work.problem)
    outcomes = [pool.add_origin(outcome) for outcome in work.outcomes]
    pool.list_all()
    known = len(pool)
    incumbent = Incumbent(work.problem, pool, work.plan, budget)
    incumbent.candidates.meet(work.plan)
    incumbent.candidates.add(work.plan)
    task = Task.of(work.problem)
    search = BranchAndBound(task, incumbent, work.gap, PairOutcomes.of(task), roots=[])
    _place(work, search, outcomes)
    with suppress(OutOfBudget):
        search.run(_OneTurn(budget, incumbent), None)
    return Searched(
        proofs=tuple(search.proof(k) for k in range(len(search.roots))),
        plan=incumbent.candidates.best,
        outcomes=tuple(pool.origin(outcome) for outcome in range(known, len(pool))),
        nodes=budget.nodes - work.nodes_before,
    )


def _place(work: Work, search: BranchAndBound, outcomes: list[int]) -> None:
    """Put the nodes into the search, each bounded by its own cuts, which the first programs hold."""
    number = {group: g for g, group in enumerate(search.pool.groups)}
    cuts = [search.cuts.tangent(outcomes[cut.attack], number[cut.group], cut.point, cut.target) for cut in work.cuts]
    for k in cuts:
        search.rounds.use(k)
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
