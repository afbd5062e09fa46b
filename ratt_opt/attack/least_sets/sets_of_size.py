"""Sets of one size that are worth less than a threshold: found one after the other, listed, or ruled out.

A depth-first search in C (``native/src/sets_of_size.c``), which pauses and goes on.
"""

from __future__ import annotations

from ctypes import byref, c_double, c_int64
from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal

import numpy as np

from ratt_opt.native.library import Answered, address, address_of, checked
from ratt_opt.native.loops import SetQuestionRecord, loops

if TYPE_CHECKING:
    from collections.abc import Iterable

    from numpy.typing import NDArray

    from ratt_opt._validation import BoolArray, FloatArray, IntArray
    from ratt_opt.attack.team import Team
    from ratt_opt.budget import Budget

__all__ = ["BoundedSets", "SetFamily", "SetSearch"]


@dataclass(frozen=True, slots=True)
class SetFamily:
    """All sets of ``size`` of F free robots, beside those already chosen.

    ``start`` : (M, T) prior plus the chosen robots' information; ``information`` : (F, M, T)
    """

    team: Team
    start: FloatArray
    information: FloatArray
    size: int

    @classmethod
    def of(cls, team: Team, robots: IntArray, size: int, chosen: Iterable[int] = ()) -> SetFamily:
        """The sets of ``size`` of the ``robots`` (F,) beside those ``chosen``."""
        return cls(team, team.sums(chosen), team.information[robots], size)


class SetSearch:
    """The sets of ``size`` robots that are worth less than ``threshold``, whose robots cost less than ``limit``.

    ``among`` : (F,) robots that may be in a set; by default all. ``inside`` : (N,) others that are in each set; by
    default none. ``costs`` : (N,) of robots; by default none. ``in_order`` : decide robots in the order of ``among``
    ``nodes`` : partial sets looked at so far
    """

    def __init__(
        self,
        team: Team,
        size: int,
        threshold: float,
        *,
        among: IntArray | None = None,
        inside: BoolArray | None = None,
        costs: FloatArray | None = None,
        limit: float = np.inf,
        in_order: bool = False,
    ) -> None:
        self.pace = team.set_pace
        self._team, self._inside = team, np.zeros(team.robots, dtype=np.bool_) if inside is None else inside
        order = np.arange(team.robots) if among is None else np.ascontiguousarray(among, dtype=np.int64)
        start = team.sums(np.flatnonzero(self._inside))
        self._arrays = start, order, costs  # the record has their addresses only
        self._record = SetQuestionRecord(
            team=address_of(team.record),
            threshold=threshold,
            level=0.0,
            limit=limit,
            size=size,
            start=address(start),
            candidates=len(order),
            in_order=in_order,
            order=address(order),
            costs=None if costs is None else address(checked("costs", costs, np.float64, (team.robots,))),
        )
        self._chosen = np.zeros(team.robots, dtype=np.bool_)
        self.nodes = 0
        self.lower(threshold)
        self._handle = loops.open_sets(self._record)
        if not self._handle:
            raise MemoryError

    def __del__(self) -> None:
        """Free what the search holds."""
        if getattr(self, "_handle", None):
            loops.close_sets(self._handle)
            self._handle = None

    def lower(self, threshold: float, limit: float = np.inf) -> None:
        """Make the threshold and the limit no larger than these."""
        record = self._record
        record.threshold, record.limit = min(record.threshold, threshold), min(record.limit, limit)
        record.level = loops.level_of_threshold(self._team.record, record.threshold)

    def next(self, nodes: int) -> BoolArray | Literal[False] | None:
        """The next set (N,), those inside included; ``None`` after ``nodes`` nodes, ``False`` if there is none."""
        value, progress = c_double(0.0), c_int64(0)
        code = loops.next_set_below(self._handle, nodes, address(self._chosen), byref(value), byref(progress))
        self.nodes = progress.value
        if code != Answered.FOUND:
            return False if code == Answered.FINISHED else None
        return np.asarray(self._chosen | self._inside)

    def fill(self, nodes: int, masks: NDArray[np.uint64], values: FloatArray, count: int) -> tuple[int, bool]:
        """List sets from row ``count`` on for ``nodes`` nodes; the rows filled, and whether there are no others.

        ``masks`` : (C,) bit ``i`` is robot ``i``, at most 63 robots, without those inside; ``values`` : (C,)
        """
        rows, progress = c_int64(count), c_int64(0)
        places = address(self._chosen), address(masks), address(values), byref(rows), byref(progress)
        code = loops.list_sets_below(self._handle, nodes, len(masks), *places)
        self.nodes = progress.value
        return rows.value, code == Answered.FINISHED

    @property
    def least_open(self) -> float:
        """A value that no set still open is below, or the threshold, if that is less; infinite if none is open."""
        return loops.least_open(self._handle)


class BoundedSets:
    """The sets of ``size`` of some ``robots`` (F,) beside those ``inside``, by a search in depth.

    ``scores`` : constant and (F,) of an affine underestimator of the value; by default none;
    then those robots are decided first of whose side it is surest
    """

    def __init__(  # noqa: PLR0917
        self,
        team: Team,
        robots: IntArray,
        inside: Iterable[int],
        size: int,
        threshold: float,
        scores: tuple[float, FloatArray] | None = None,
    ) -> None:
        fixed, self._scale = np.isin(np.arange(team.robots), list(inside)), max(abs(threshold), 1e-300)
        self._constant, costs = -np.inf, None
        if scores is not None:
            self._constant, own = scores
            costs = np.zeros(team.robots)
            costs[robots] = own / self._scale
            if 0 < size < len(robots):  # those first of whose side the underestimator is surest
                middle = np.partition(own, size - 1)[size - 1]
                robots = robots[np.argsort(-np.abs(own - middle), kind="stable")]
        self._search = SetSearch(
            team, size, threshold, among=robots, inside=fixed, costs=costs, in_order=costs is not None
        )
        self._pause = max(team.params.set_search.at_once // (team.record.targets * team.robots), 1)

    @property
    def nodes(self) -> int:
        """Partial sets looked at."""
        return self._search.nodes

    @property
    def least_open(self) -> float:
        """A value that no set still open is below, or the threshold, if that is less; infinite if none is open."""
        return self._search.least_open

    def next(self, threshold: float, most: int, budget: Budget) -> frozenset[int] | Literal[False] | None:
        """The next set below a threshold, which may only fall; ``False`` at the end, ``None`` before.

        ``most`` : nodes in all
        """
        search, before = self._search, self._search.nodes
        search.lower(threshold, (threshold - self._constant) / self._scale)
        found = search.next(0)  # the last steps of a search may need no node
        if found is None:
            end, pace = before + budget.nodes_left(min(self._pause, max(most - before, 1))), search.pace
            while found is None and search.nodes < end and not budget.is_over:
                units = min(pace.units, end - search.nodes)
                with pace.timed(units):
                    found = search.next(units)
        budget.nodes += search.nodes - before
        return found if found is None or found is False else frozenset(np.flatnonzero(found).tolist())
