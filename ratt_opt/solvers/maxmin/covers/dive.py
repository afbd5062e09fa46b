"""A search in depth (``loops/diving.py``) that runs on and on, the plan that it meets, and its proof."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ratt_opt.solvers.maxmin.covers.loops.tables import Record, Stack
from ratt_opt.solvers.maxmin.levels.level_search import Outcome

if TYPE_CHECKING:
    from ratt_opt._validation import BoolArray, IntArray
    from ratt_opt.solvers.maxmin.covers.separation import Separation
    from ratt_opt.solvers.maxmin.covers.sums import CoverSums

__all__ = ["Dive"]

FIRST_RECORD, MOST_RECORDED = 4096, 4_000_000
"""Nodes of a record: it grows, to 160 MB at most."""
MOST_WAYS = 10
"""Partitions that are tried at a node, those that last led to a dead end first."""


class Dive:
    """A search over all plans."""

    def __init__(self, separation: Separation, sums: CoverSums) -> None:
        from ratt_opt.solvers.maxmin.covers.loops.diving import dive  # compiles
        from ratt_opt.solvers.maxmin.covers.loops.team import bound_robot

        self._dive, self._separation, self._sums = dive, separation, sums
        self.record = Record(np.zeros((FIRST_RECORD, 5), dtype=np.int64), np.zeros(1, dtype=np.int64))
        n, e = separation.problem.n_robots, separation.problem.objective.n
        whole = [np.uint64((1 << len(choice)) - 1) for choice in separation.problem.choices]
        self._stack = Stack(
            start=np.array(whole, dtype=np.uint64),
            allowed=np.zeros((n + 1, n), dtype=np.uint64),
            strongest=np.zeros((n + 1, n, *separation.team.prior.shape)),
            fixed=np.zeros(n + 1, dtype=np.int64),
            first=np.zeros(n + 2, dtype=np.int64),
            kind=np.zeros(e + 1, dtype=np.int64),
            what=np.zeros(e + 1, dtype=np.int64),
            robot=np.zeros(e + 1, dtype=np.int64),
            gone=np.zeros(e + 1, dtype=np.uint64),
            reason=np.zeros((e + 1, n), dtype=np.uint64),
            since=np.full(e, -1, dtype=np.int64),
            touched=np.zeros((n + 1, n), dtype=np.int64),
            activity=np.zeros(n),
            frame=np.zeros(1, dtype=np.int64),
            steps=np.zeros(1, dtype=np.int64),
        )
        self._stack.allowed[0] = self._stack.start
        for i, mask in enumerate(whole):
            bound_robot(separation.team, i, mask, self._stack.strongest[0, i])

    @property
    def frame(self) -> int:
        """The frame that it is in."""
        return int(self._stack.frame[0])

    @property
    def is_long(self) -> bool:
        """Whether its record is as long as memory should hold."""
        return int(self.record.size[0]) >= MOST_RECORDED

    def run(self, level: float, nodes: int) -> Outcome:
        """Search on; how that ended. Makes room in what is full first."""
        pool = self._separation.pool
        if len(pool) == len(pool.covers.left_out):
            pool.grow()
        if int(self.record.size[0]) + len(self._stack.kind) >= len(self.record.nodes):
            more = np.zeros_like(self.record.nodes)
            self.record = self.record._replace(nodes=np.concatenate([self.record.nodes, more]))
        team, ways = self._separation.team, self._separation.ways()
        sums = self._sums.rows()
        outcome = self._dive(team, ways, pool.covers, sums, self._stack, self.record, level, nodes, MOST_WAYS)
        return Outcome(outcome)

    def allowed(self, frame: int) -> BoolArray:
        """(E,) elements that are allowed in a frame."""
        places = self._separation.pool.places
        masks = self._stack.allowed[frame][places.owner]
        return np.asarray(masks >> places.bit.astype(np.uint64) & np.uint64(1), dtype=np.bool_)

    def plan(self) -> IntArray:
        """(N,) the plan that is left."""
        masks, places = self._stack.allowed[self.frame], self._separation.pool.places
        return np.array([places.element[i, int(mask).bit_length() - 1] for i, mask in enumerate(masks)])
