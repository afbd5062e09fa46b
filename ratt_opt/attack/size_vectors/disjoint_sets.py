"""Lists of all sets of one size below a threshold, as bit masks, and disjoint sets from such lists.

Sets are found by the search in depth of ``least_sets/sets_of_size.py``. Disjoint ones of given sizes, all below the
threshold, are found by an exact search in C (``native/src/disjoint.c``). Every set has a cost, what it takes off the
room between the threshold and a bound on the whole (``cover_bound.py``); a choice that costs more than the room has no
completion.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from ratt_opt.attack.least_sets.sets_of_size import SetSearch
from ratt_opt.native.library import address, address_of, checked
from ratt_opt.native.loops import ChoiceRecord, DisjointSetsRecord, loops

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from ratt_opt._validation import FloatArray, IntArray
    from ratt_opt.attack.params.sizes import DisjointParams
    from ratt_opt.attack.team import Team
    from ratt_opt.budget import Budget

    MaskArray = NDArray[np.uint64]

__all__ = ["MOST_ROBOTS", "DisjointSets", "Rest", "SetColumns", "SetList", "list_sets"]

MOST_ROBOTS = 63
"""A set is one 64-bit mask."""


@dataclass(frozen=True, slots=True)
class SetList:
    """``masks`` (K,) of the sets of ``size`` robots found, and their ``values`` (K,), lowest first."""

    size: int
    masks: MaskArray
    values: FloatArray

    def below(self, threshold: float) -> SetList:
        """Return the sets worth less than a threshold."""
        count = int(np.searchsorted(self.values, threshold))
        return SetList(self.size, self.masks[:count], self.values[:count])


def list_sets(
    team: Team,
    order: IntArray,
    size: int,
    threshold: float,
    budget: Budget,
    *,
    costs: FloatArray | None = None,
    room: float = np.inf,
) -> SetList | None:
    """Every set of ``size`` robots below a threshold, or ``None`` if they are too many or too long to find.

    Parameters
    ----------
    order : (F,) robots to choose from, F <= 63; bit ``k`` of a mask is ``order[k]``; strongest first is best, as
        the search goes from the last to the first
    costs : (F,) of robots, whose sum has to be below ``room``

    Raises
    ------
    OutOfBudget : the time is up, or too few nodes are left for the next look at the clock.
    """
    search, params = SetSearch(team.among(order), size, threshold, costs=costs, limit=room), team.params.disjoint
    masks, values = np.zeros(4096, np.uint64), np.zeros(4096)
    count, is_finished, pace = 0, False, search.pace
    for _ in range(params.looks):
        before = search.nodes
        stop = before + budget.nodes_left(params.nodes_of_look)
        while search.nodes < stop and not (is_finished or count > params.most_sets or budget.is_over):
            if count == len(masks):
                masks, values = (np.concatenate([array, np.zeros_like(array)]) for array in (masks, values))
            units = min(pace.units, stop - search.nodes)
            with pace.timed(units):
                count, is_finished = search.fill(units, masks, values, count)
        budget.nodes += search.nodes - before
        if is_finished:
            ranked = np.argsort(values[:count], kind="stable")
            return SetList(size, masks[ranked], values[ranked])
        if count > params.most_sets:
            return None
    return None


@dataclass(frozen=True, slots=True, kw_only=True)
class SetColumns:
    """Sets of each size of a vector, by their lowest robot, cheapest first.

    ``masks``, ``values``, ``costs`` : (K,); ``starts`` : (C, N + 1), those of size ``c`` whose lowest bit is ``r`` are
    ``starts[c, r]:starts[c, r + 1]``; ``counts`` : (C,) sets to choose of each size; ``rest_costs`` : (N,) of leaving
    robot ``r`` in the rest; ``room`` : costs have to stay below this
    """

    masks: MaskArray
    values: FloatArray
    costs: FloatArray
    starts: IntArray
    counts: IntArray
    rest_costs: FloatArray
    room: float


@dataclass(frozen=True, slots=True)
class Rest:
    """The robots outside the sets: ``size`` of them, ``n_blinded`` of these blinded, the others left alone.

    ``single`` : (N,) individual values by bit, largest first; ``must`` : mask of the robots that cannot be blinded
    """

    size: int
    n_blinded: int
    single: FloatArray
    must: int = 0

    def alone(self, rest: int) -> float:
        """Largest individual value in a rest (mask) whose strongest robots are blinded; -inf if none is left."""
        blinded = self.n_blinded
        for i, value in enumerate(self.single.tolist()):
            if rest >> i & 1:
                if blinded and not self.must >> i & 1:
                    blinded -= 1
                else:
                    return float(value)
        return -np.inf


class DisjointSets:
    """Search for the disjoint sets whose largest value is least; :meth:`run` continues until all families are decided.

    Parameters
    ----------
    threshold : only families of a smaller largest value count
    """

    def __init__(self, columns: SetColumns, rest: Rest, threshold: float, params: DisjointParams) -> None:
        self._params = params
        robots, classes = len(rest.single), len(columns.counts)
        self._columns = columns
        self._kept = np.ascontiguousarray(columns.rest_costs), np.ascontiguousarray(rest.single)
        self._memory, self._best = np.zeros((params.memory, 2), np.uint64), np.zeros(robots + 1, np.int64)
        self._counts = np.zeros((robots + 2, classes), np.int32)
        self._counts[0] = columns.counts
        self._stack = (ChoiceRecord * (robots + 2))()
        for level, counts in zip(self._stack, self._counts, strict=True):
            level.counts = address(counts)
        first = self._stack[0]
        first.decided, first.option, first.value = 0, -1, -np.inf
        first.places, first.kept = rest.size, rest.size - rest.n_blinded
        self._record = DisjointSetsRecord(
            robots=robots,
            classes=classes,
            rest=rest.size,
            n_blinded=rest.n_blinded,
            masks=address(checked("masks", columns.masks, np.uint64, columns.masks.shape)),
            values=address(checked("values", columns.values, np.float64, columns.masks.shape)),
            costs=address(checked("costs", columns.costs, np.float64, columns.masks.shape)),
            starts=address(checked("starts", columns.starts, np.int64, (classes, robots + 1))),
            rest_costs=address(checked("rest_costs", self._kept[0], np.float64, (robots,))),
            single=address(checked("single", self._kept[1], np.float64, (robots,))),
            must=rest.must,
            threshold=threshold,
            room=columns.room,
            remembered=params.memory,
            depth=0,
            found=0,
            memory=address(self._memory),
            stack=address_of(first),
            best=address(self._best),
        )

    def family(self) -> list[int]:
        """Masks of the best family found; empty if none was."""
        return [int(mask) for mask in self._columns.masks[self._best[: self._record.found]]]

    def run(self, budget: Budget) -> None:
        """Search to the end.

        Raises
        ------
        OutOfBudget : the time is up, or no node is left; :meth:`family` has what was found.
        """
        is_finished = False
        while not is_finished:
            budget.spend(budget.nodes_left(self._params.work_nodes))
            is_finished = bool(loops.search_disjoint(self._record, self._params.work))
