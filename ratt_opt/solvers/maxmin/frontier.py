"""The nodes of a search and the bound they leave, and which bounds are low enough."""

from __future__ import annotations

import heapq
from itertools import chain
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Iterator

    from ratt_opt.solvers.maxmin.plans.candidates import Candidates
    from ratt_opt.solvers.maxmin.proof import TreeNode

__all__ = ["ClosingRule", "Frontier"]

WIDEST_GAP = 0.5
"""Relative gaps count as at most this if they say above which level a plan would have to be."""

MARGINS = 8
"""Roundings of a value that a bound may stay above a level it cannot be told from: tangents carry margins for their own
rounding, of some such. Half of what a result counts as closed. With 1 a team whose optimum is 0 was divided on
the winners of dozens of outcomes, without end."""


class ClosingRule:
    """A bound closes a node if no plan below it can be better than the best known, by more than the gap.

    Below that plan's level, proved or not, no better one is to be found. A new outcome may lower the level; then what
    was closed may have to be opened again.

    ``floor`` : only plans above it are looked for, while it is above that level; see ``descent.py``.
    """

    def __init__(self, plans: Candidates, gap: float) -> None:
        self.plans, self.gap, self.floor = plans, gap, -np.inf
        self._rounding = MARGINS * plans.pool.objective.rounding

    @property
    def level(self) -> float:
        """Value of the best plan under the known outcomes, or the floor."""
        return max(self.plans.level, self.floor)

    @property
    def better(self) -> float:
        """The level that a plan has to exceed to be better by more than the gap."""
        return (self.level + self._rounding) / (1 - min(self.gap, WIDEST_GAP))

    def closes(self, bound: float) -> bool:
        """Whether a bound is low enough."""
        return bool(np.isfinite(bound)) and self.missing(bound) >= 0

    def missing(self, bound: float) -> float:
        """What has to be added to a bound until it no longer closes; negative if it does not close."""
        return self.level + self.gap * abs(bound) + self._rounding - bound


class Frontier:
    """Nodes that are open, the one in work, and those that were closed; any interrupt leaves a valid bound.

    ``depth_first`` : whether the latest node is taken, instead of the one of largest bound.
    """

    def __init__(self, rule: ClosingRule, *, depth_first: bool = False) -> None:
        self.rule, self.depth_first = rule, depth_first
        self.current: TreeNode | None = None
        """The node in work, which is part of the bound."""
        self._queue: list[tuple[float, int, TreeNode]] = []
        self._pushed = 0
        self._closed: list[TreeNode] = []
        self.fresh: list[TreeNode] = []
        """Nodes that were closed and not followed up the tree; see ``backjumps.py``."""
        self._settled: list[tuple[TreeNode, int]] = []
        """Nodes of a single plan, and how many outcomes were known when their bounds were found."""
        self._finished = -np.inf

    @property
    def bound(self) -> float:
        """The largest bound of an open or finished node."""
        still = [node.bound for node in self._largest()]
        still.extend(node.bound for node, _ in self._settled if not node.is_dropped)
        if self.current is not None:
            still.append(self.current.bound)
        return max([self._finished, *still])

    @property
    def is_closed(self) -> bool:
        """Whether no open node is left that does not close."""
        return all(self.rule.closes(node.bound) for node in self._largest())

    def _largest(self) -> Iterator[TreeNode]:
        """Queued nodes, one of which has the largest bound of them."""
        while self._queue and self._queue[0][2].is_dropped:
            heapq.heappop(self._queue)
        return (node for _, _, node in (self._queue if self.depth_first else self._queue[:1]) if not node.is_dropped)

    def push(self, node: TreeNode) -> None:
        """Queue an open node."""
        heapq.heappush(self._queue, (-self._pushed if self.depth_first else -node.bound, self._pushed, node))
        self._pushed += 1

    def take(self) -> TreeNode:
        """Make the open node of largest bound, or the latest that does not close, the one in work."""
        while (first := self._queue[0][2]).is_dropped or (self.depth_first and self.rule.closes(first.bound)):
            if not first.is_dropped:
                self.close(first)
            heapq.heappop(self._queue)
        self.current = node = self._queue[0][2]  # before it leaves the queue: an interrupt must not lose it
        heapq.heappop(self._queue)
        return node

    def nodes(self) -> Iterator[TreeNode]:
        """All that are open, in work, closed or settled."""
        queued, settled = (node for _, _, node in self._queue), (node for node, _ in self._settled)
        current = [] if self.current is None else [self.current]
        return chain(queued, current, self._closed, settled)

    def finish(self, node: TreeNode) -> None:
        """Close a node if its bound closes it, else queue it."""
        if self.rule.closes(node.bound):
            self.close(node)
        else:
            self.push(node)

    def close(self, node: TreeNode) -> None:
        """Finish a node whose bound closes it."""
        self.finish_up_to(node.bound)
        self._closed.append(node)
        self.fresh.append(node)

    def finish_up_to(self, bound: float) -> None:
        """Let the bound of what is closed be at least this one."""
        self._finished = max(self._finished, bound)

    def replace(self, node: TreeNode, other: TreeNode) -> None:
        """Let another node be closed in the place of one, with its bound."""
        self._closed.append(other)
        node.is_dropped = True

    def settle(self, node: TreeNode) -> None:
        """Finish a node of a single plan, whose bound is as low as the known outcomes make it."""
        self._settled.append((node, len(self.rule.plans.pool)))

    def reopen(self) -> bool:
        """Queue nodes that were closed against a better level than there is now; whether there are any.

        Also single plans above that level, if outcomes were found since: one of them may be their worst.
        """
        again = [node for node in self._closed if not self.rule.closes(node.bound)]
        if again:
            self._closed = [node for node in self._closed if self.rule.closes(node.bound)]
            self._finished = max((node.bound for node in self._closed), default=-np.inf)
        again = [node for node in again if not node.is_dropped]
        for node in again:
            self.push(node)
            node.open_again()
        self._settled = [(node, known) for node, known in self._settled if not node.is_dropped]
        outdated = [(node, known) for node, known in self._settled if self._is_outdated(node, known)]
        for node, _ in outdated:
            self.push(node)
        if outdated:
            self._settled = [one for one in self._settled if one not in outdated]
        return bool(again or outdated)

    def _is_outdated(self, node: TreeNode, known: int) -> bool:
        return not self.rule.closes(node.bound) and known < len(self.rule.plans.pool)
