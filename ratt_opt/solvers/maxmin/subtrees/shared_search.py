"""The loop that lends open nodes to a crew and takes their proofs back; it keeps the bracket valid at any time."""

from __future__ import annotations

from dataclasses import replace
from math import ceil, inf
from time import monotonic
from typing import TYPE_CHECKING
from uuid import uuid4

from ratt_opt.budget import Stop
from ratt_opt.solvers.maxmin.subtrees.merge import hang_below
from ratt_opt.solvers.maxmin.subtrees.worker import LentNode, Work
from ratt_opt.solvers.maxmin.turns import TurnsUntil

if TYPE_CHECKING:
    from ratt_opt.budget import Budget
    from ratt_opt.solvers.maxmin.proof import TreeNode
    from ratt_opt.solvers.maxmin.search import BranchAndBound, Progress
    from ratt_opt.solvers.maxmin.subtrees.crew import Crew
    from ratt_opt.solvers.maxmin.subtrees.worker import Searched
    from ratt_opt.solvers.maxmin.turns import Turns

__all__ = ["SharedSearch"]

ALONE_SECONDS = 1.0
"""Seconds searched alone before anybody is asked: starting a process takes as long, and most searches end in less."""
NODES_EACH = 4
"""Open nodes for each of the crew before it is asked: fewer leave some of it idle."""
SLICE = 1.0
"""Seconds of work that are given away at a time: what is lost with a worker, and how old the best plan it knows of is,
against the fraction of a second that it takes to begin anew."""
MOST_NODES = 64
"""Nodes given away at a time."""
DEADLINE_SHARE = 0.9
"""Share of the seconds left that work may take, so that it is back and merged by then."""
LEAST = 0.05
"""Seconds of work below which nothing is given away."""
WAIT = 0.2
"""Seconds between two looks at the clock while nobody answers."""
GRACE = 0.3
"""Seconds waited for work that was asked to be back by now. If a tree is given up for its count of nodes, ``SLICE``
more: the next one begins with the outcomes found by then, and its work with a free worker."""


class SharedSearch:
    """The search of one tree whose nodes a crew searches, once there are enough of them."""

    def __init__(self, search: BranchAndBound, crew: Crew) -> None:
        self._search, self._crew = search, crew
        self._frontier = search.frontier
        self._name = uuid4().hex

    def run(self, turns: Turns, progress: Progress) -> Stop:
        """Search until the gap closes, the budget is spent or it is time for a proof; return why it stopped."""
        search, budget = self._search, turns.budget
        stop = search.run(TurnsUntil(turns, self._is_worth_sharing), progress)
        if stop is not Stop.NODES or budget.stop() is not None:
            return stop
        while self._frontier.lent or not search.is_finished():
            if self._crew.is_gone and not self._frontier.lent:
                return search.run(turns, progress)
            reason = budget.stop() or turns.stop() or self._give_away(turns)
            works = not self._crew.has_answered and not self._frontier.is_closed and self._nodes_left(budget) >= 1
            if reason is None and works:  # while processes start
                reason = search.explore_next(turns)
            if reason is not None:
                self._call_back(budget, GRACE + SLICE if reason is Stop.NODES else GRACE)
                return reason
            self._take(0.0 if works else WAIT, budget)
            if progress is not None:
                progress(budget.nodes, search.incumbent.proved.lower, search.upper)
        return Stop.GAP

    def _is_worth_sharing(self) -> bool:
        is_long = monotonic() >= self._crew.since + ALONE_SECONDS
        return is_long and len(self._frontier) >= NODES_EACH * self._crew.size

    def _give_away(self, turns: Turns) -> Stop | None:
        """Give idle workers their shares of the open nodes; the work that they cannot do is done here."""
        seconds = min(SLICE, DEADLINE_SHARE * turns.seconds_left)
        while self._crew.idle > 0 and not self._crew.is_gone and not self._frontier.is_closed:
            granted = self._nodes_left(turns.budget)
            nodes = self._frontier.lend(min(MOST_NODES, ceil(len(self._frontier) / self._crew.size)))
            kept = [node for node in nodes if seconds < LEAST or granted < 1 or node.is_single]
            self._queue_again(kept)
            lent = [node for node in nodes if not any(node is other for other in kept)]
            if lent:
                most = None if granted == inf else turns.budget.nodes + int(granted)
                self._crew.ask(self._work(lent, turns.budget.nodes, most, seconds), lent)
            if kept:
                return None if granted < 1 else self._search.explore_next(turns)
        return None

    def _nodes_left(self, budget: Budget) -> float:
        """Nodes that one of the crew may explore, so that all together keep the limit."""
        if budget.max_nodes is None:
            return inf
        return ceil((budget.max_nodes - budget.nodes - self._crew.promised) / max(self._crew.idle, 1))

    def _work(self, nodes: list[TreeNode], nodes_before: int, max_nodes: int | None, seconds: float) -> Work:
        search, pool = self._search, self._search.pool
        used = sorted({k for node in nodes for k in node.leaf.cuts})
        number = {k: position for position, k in enumerate(used)}
        decided = search.winners.decided
        return Work(
            search=self._crew.search,
            tree=self._name,
            problem=search.task.problem,
            gap=search.rule.gap,
            floor=search.rule.floor,
            plan=search.incumbent.candidates.best,
            outcomes=tuple(pool.origin(outcome) for outcome in range(len(pool))),
            cuts=tuple(search.cuts.record(k) for k in used),
            roots=tuple(
                LentNode(
                    choices=node.choices,
                    winners=tuple((o, pool.groups[g]) for o, g in {**decided, **node.winners}.items()),
                    leaf=replace(node.leaf, cuts=tuple(number[k] for k in node.leaf.cuts)),
                )
                for node in nodes
            ),
            nodes_before=nodes_before,
            max_nodes=max_nodes,
            seconds=seconds,
        )

    def _take(self, seconds: float, budget: Budget) -> None:
        """Take back what is finished within that many seconds; nodes that were lost are queued again."""
        for nodes, found in self._crew.answers(seconds):
            if found is None:
                self._queue_again(nodes)
            else:
                self._merge(nodes, found, budget)

    def _merge(self, nodes: list[TreeNode], found: Searched, budget: Budget) -> None:
        budget.nodes += found.nodes
        for outcome in found.outcomes:
            self._search.pool.add_origin(outcome)
        self._search.incumbent.offer(found.plan)
        for node, proof in zip(nodes, found.proofs, strict=True):
            hang_below(self._search, node, proof)
        self._frontier.take_back(nodes)  # last: an interrupt must not lose them

    def _queue_again(self, nodes: list[TreeNode]) -> None:
        for node in nodes:
            self._frontier.push(node)
        self._frontier.take_back(nodes)

    def _call_back(self, budget: Budget, patience: float) -> None:
        """Take the work that comes back within that many seconds, if there are as many left; queue the rest again."""
        until = monotonic() + min(patience, max(budget.seconds_left, GRACE))
        while self._frontier.lent and (left := until - monotonic()) > 0 and budget.stop() is not Stop.INTERRUPTED:
            self._take(left, budget)
        self._queue_again(self._crew.recall())
