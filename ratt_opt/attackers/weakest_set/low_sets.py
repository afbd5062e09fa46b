"""Enumerate the sets of one size whose value is below a threshold, in compiled code."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from ratt_opt.attackers.weakest_set.compiled import FINISHED, FOUND, SearchState, criterion, search

if TYPE_CHECKING:
    from ratt_opt._validation import FloatArray, IntArray
    from ratt_opt.attackers.bracket import Budget
    from ratt_opt.attackers.weakest_set.compact import CompactTeam

__all__ = ["AffineBound", "LowSets"]


@dataclass(frozen=True, slots=True)
class AffineBound:
    """Value of a set >= ``constant`` + sum of its robots' ``scores`` (aligned with the robots searched)."""

    constant: float
    scores: FloatArray


class LowSets:
    """Depth-first search over ``chosen`` plus ``size`` of ``robots``, in the order given; resumable.

    Parameters
    ----------
    robots : (F,) robots to choose from, distinct and not chosen
    affine : minorant of the value; none by default
    """

    def __init__(
        self,
        team: CompactTeam,
        robots: IntArray,
        chosen: frozenset[int],
        size: int,
        affine: AffineBound | None = None,
    ) -> None:
        self._team, self._robots, self._chosen, self._size = team, robots, chosen, size
        affine = affine or AffineBound(-np.inf, np.zeros(len(robots)))
        self._scores = affine.scores
        self._smallest = _smallest_sums(self._scores, size)
        self._state = SearchState(team.sums(chosen), size)
        self._state.linear[0] = affine.constant
        self._baseline = float(criterion(team.kind, team.weights, team.prior))
        self._information = np.ascontiguousarray(team.information[robots])
        self.finished = False

    @classmethod
    def surest_first(
        cls, team: CompactTeam, robots: IntArray, chosen: frozenset[int], size: int, affine: AffineBound
    ) -> LowSets:
        """The same search, those ``robots`` first whose side, inside or outside, the minorant is surest of."""
        if not 0 < size < len(robots):
            return cls(team, robots, chosen, size)
        middle = np.partition(affine.scores, size - 1)[size - 1]
        order = np.argsort(-np.abs(affine.scores - middle), kind="stable")
        return cls(team, robots[order], chosen, size, AffineBound(affine.constant, affine.scores[order]))

    @property
    def work_of_node(self) -> int:
        """Criteria of single targets that bounding a partial choice looks at, at most."""
        n_robots, n_targets, _ = self._information.shape
        return int(max(n_robots * n_targets, 1))

    @property
    def nodes(self) -> int:
        """Partial choices looked at."""
        return int(self._state.counters[1])

    def next_within(self, threshold: float, nodes: int, budget: Budget) -> frozenset[int] | None:
        """Spend up to ``nodes`` more of the budget on :meth:`next_below`; raises ``OutOfBudget`` where none is left."""
        before = self.nodes
        found = self.next_below(threshold, before)  # the last steps of a search may need no node
        if found is None and not self.finished:
            found = self.next_below(threshold, before + budget.nodes_left(nodes))
        budget.nodes += self.nodes - before
        return found

    def next_below(self, threshold: float, limit: int) -> frozenset[int] | None:
        """The next set worth less than ``threshold``; ``None`` once ``finished`` or at ``limit`` nodes in all.

        The threshold may fall from call to call, not rise.
        """
        state, team = self._state, self._team
        if self._size == 0:
            return self._only(threshold)
        answer = search(
            team.kind,
            team.weights,
            self._baseline,
            self._information,
            self._scores,
            self._smallest,
            threshold,
            limit,
            state.position,
            state.sums,
            state.linear,
            state.counters,
        )
        if answer == FOUND:
            depth = int(state.counters[0])
            return self._chosen | frozenset(self._robots[state.position[: depth + 1] - 1].tolist())
        self.finished = answer == FINISHED
        return None

    def _only(self, threshold: float) -> frozenset[int] | None:
        if self.finished:
            return None
        self.finished = True
        return self._chosen if self._team.value(self._chosen) < threshold else None


def _smallest_sums(scores: FloatArray, size: int) -> FloatArray:
    """(F + 1, size + 1) sum of the q smallest scores among positions p.. at [p, q]; infinite where too few."""
    sums = np.full((len(scores) + 1, size + 1), np.inf)
    sums[:, 0] = 0.0
    for p in range(len(scores)):
        ordered = np.sort(scores[p:])[:size]
        sums[p, 1 : len(ordered) + 1] = np.cumsum(ordered)
    return sums
