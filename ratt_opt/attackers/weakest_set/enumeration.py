"""Enumerate the sets of one size whose value is below a threshold, in compiled code.

Imported only where a large team is attacked: compiling takes seconds, once per machine (cached).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from ratt_opt.running.compiling import numba
from ratt_opt.setfunctions.criteria.compiled import team_criterion

if TYPE_CHECKING:
    from ratt_opt._validation import FloatArray, IntArray
    from ratt_opt.attackers.weakest_set.packed_team import PackedTeam
    from ratt_opt.budget import Budget

__all__ = ["AffineBound", "Enumeration"]


@dataclass(frozen=True, slots=True)
class AffineBound:
    """Value of a set >= ``constant`` + sum of its robots' ``scores`` (aligned with the robots searched)."""

    constant: float
    scores: FloatArray


class Enumeration:
    """Depth-first search over ``chosen`` plus ``size`` of ``robots``, in the order given; resumable.

    ``robots`` : (F,) robots to choose from, distinct and not chosen
    ``affine`` : minorant of the value; none by default
    """

    def __init__(
        self, team: PackedTeam, robots: IntArray, chosen: frozenset[int], size: int, affine: AffineBound | None = None
    ) -> None:
        self._team, self._robots, self._chosen, self._size = team, robots, chosen, size
        affine = affine or AffineBound(-np.inf, np.zeros(len(robots)))
        self._affine = affine.scores, _smallest_sums(affine.scores, size)
        self._position = np.zeros(size + 1, dtype=np.int64)
        """Next robot to try at each depth; the chosen ones are those before, up to the depth reached."""
        self._counters = np.zeros(2, dtype=np.int64)
        """Depth (below 0 once all sets are decided), nodes."""
        sums, linear = np.zeros((size + 1, *team.prior.shape)), np.zeros(size + 1)
        sums[0], linear[0] = team.sums(chosen), affine.constant
        self._state = self._position, sums, linear, self._counters
        self._criterion = team.code, team.weights, team.baseline
        self._information = np.ascontiguousarray(team.information[robots])
        self.finished = False

    @classmethod
    def surest_first(
        cls, team: PackedTeam, robots: IntArray, chosen: frozenset[int], size: int, affine: AffineBound
    ) -> Enumeration:
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
        return int(self._counters[1])

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
        if self._size == 0:
            known, self.finished = self.finished, True
            return None if known or self._team.value(self._chosen) >= threshold else self._chosen
        if _search(self._criterion, self._information, self._affine, threshold, limit, self._state):
            depth = int(self._counters[0])
            return self._chosen | frozenset(self._robots[self._position[: depth + 1] - 1].tolist())
        self.finished = bool(self._counters[0] < 0)
        return None


def _smallest_sums(scores: FloatArray, size: int) -> FloatArray:
    """(F + 1, size + 1) sum of the q smallest scores among positions p.. at [p, q]; infinite where too few."""
    sums = np.full((len(scores) + 1, size + 1), np.inf)
    sums[:, 0] = 0.0
    for p in range(len(scores)):
        ordered = np.sort(scores[p:])[:size]
        sums[p, 1 : len(ordered) + 1] = np.cumsum(ordered)
    return sums


@numba.njit(cache=True)
def _averaged(code: int, weights: Any, sums: Any, information: Any, left: int) -> float:
    """No ``left`` of the robots bring the criterion above this: (M,), (M, T), (F, M, T) -> scalar.

    ``sums`` plus the information of robots ``T`` is the average over ``i`` in ``T`` of ``sums + |T| information[i]``,
    and the criterion is convex: it is at most the average there, so at most that of the ``|T|`` largest.
    """
    n_robots, n_targets = information.shape[0], information.shape[1]
    one, worth = np.empty_like(sums), np.empty(n_robots)
    for i in range(n_robots):
        for j in range(n_targets):
            for t in range(sums.shape[1]):
                one[j, t] = sums[j, t] + left * information[i, j, t]
        worth[i] = team_criterion(code, weights, one)
    return float(np.sort(worth)[n_robots - left :].mean())


@numba.njit(cache=True)
def _search(criterion: Any, information: Any, affine: Any, threshold: float, limit: int, state: Any) -> bool:  # noqa: PLR0917
    """Continue to the next set whose value is below ``threshold``; false at the limit, or at depth -1: at the end.

    Robots are taken or left in the order given. A partial choice is left when the affine minorant ``linear +
    scores`` or the averaged bound (:func:`_averaged`) of every completion reaches the threshold.

    ``criterion`` : code, weights (M,), baseline
    ``information`` : (F, M, T) of the robots to choose from
    ``affine`` : scores (F,), a set's value is at least linear[0] + sum of its scores; and (F + 1, size + 1) the sum of
        the q smallest scores among robots p.. at [p, q]
    ``limit`` : nodes (partial choices looked at) before pausing, counted in ``counters[1]``
    ``state`` : position (size + 1,), sums (size + 1, M, T), linear (size + 1,), counters (2,)
    """
    code, weights, baseline = criterion
    scores, smallest = affine
    position, sums, linear, counters = state
    n_robots, n_targets = information.shape[0], information.shape[1]
    size = position.shape[0] - 1
    depth = counters[0]
    while depth >= 0:
        p = position[depth]
        left = size - depth
        if p > n_robots - left or linear[depth] + smallest[p, left] >= threshold:
            depth -= 1
            continue
        if counters[1] >= limit:
            break
        counters[1] += 1
        if baseline - _averaged(code, weights, sums[depth], information[p:], left) >= threshold:
            depth -= 1
            continue
        position[depth] = p + 1
        bound = linear[depth] + scores[p]
        if bound + smallest[p + 1, left - 1] >= threshold:
            continue
        for j in range(n_targets):
            for t in range(information.shape[2]):
                sums[depth + 1, j, t] = sums[depth, j, t] + information[p, j, t]
        if left == 1:
            if baseline - team_criterion(code, weights, sums[depth + 1]) >= threshold:
                continue
            counters[0] = depth
            return True
        linear[depth + 1] = bound
        position[depth + 1] = p + 1
        depth += 1
    counters[0] = depth
    return False
