"""A lower bound on the best group of every family of groups of given sizes, and what each set costs against it.

Give every robot a potential ``pi`` and every size ``s`` (``n_s`` groups of it) a weight ``lam_s >= 0`` with
``sum_s n_s lam_s = 1``, and let ``u_s`` be the least ``lam_s value(S) - pi(S)`` over the sets of that size that may be
used. Then the best group of a family is worth at least

    sum_S lam_s value(S) >= sum_S (pi(S) + u_s) = sum of pi over the robots in the sets + sum_s n_s u_s,

and the robots outside the sets, ``y`` of them, take away at most the ``y`` largest potentials. The best multipliers
solve the dual of a linear program over all sets; sets enter it as they are violated. Any multipliers are valid.

If every group of a family is worth less than ``t``, the same sum is below ``t``: what the sets and the robots outside
take off the room between the bound and ``t`` must stay below it.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from ratt_opt.attack.size_vectors.disjoint_sets import SetColumns
from ratt_opt.budget import Stop
from ratt_opt.graph.communication import sums_of_subsets
from ratt_opt.highs import LinearProgram, rows_of

if TYPE_CHECKING:
    from collections.abc import Iterable

    from ratt_opt._validation import FloatArray, IntArray
    from ratt_opt.attack.params.sizes import CoverParams
    from ratt_opt.attack.size_vectors.disjoint_sets import MaskArray, SetList
    from ratt_opt.budget import Budget

__all__ = ["CoverBound", "SetClasses", "cover_bound"]


@dataclass(frozen=True, slots=True)
class SetClasses:
    """``counts[c]`` disjoint sets are to be chosen from ``lists[c]``; the others of N robots are the rest."""

    n_robots: int
    lists: tuple[SetList, ...] = ()
    counts: tuple[int, ...] = ()

    @property
    def rest(self) -> int:
        """Robots outside the sets."""
        chosen = sum(k * low.size for k, low in zip(self.counts, self.lists, strict=True))
        return self.n_robots - chosen

    @property
    def is_empty(self) -> bool:
        """Tell whether some class has fewer sets than it needs."""
        return any(len(low.masks) < k for k, low in zip(self.counts, self.lists, strict=True))

    def and_sets(self, low: SetList, count: int) -> SetClasses:
        """Add a class: ``count`` sets of a list."""
        return replace(self, lists=(*self.lists, low), counts=(*self.counts, count))


@dataclass(frozen=True, slots=True)
class CoverBound:
    """No family is worth less than ``bound``, by these ``potentials`` (N,) and ``weights`` (C,) of the sizes."""

    classes: SetClasses
    bound: float
    potentials: FloatArray
    weights: FloatArray

    @property
    def _theta(self) -> float:
        """The least potential of those that the rest takes at best."""
        pi, rest = self.potentials, self.classes.rest
        return float(np.sort(pi)[len(pi) - rest]) if rest else float(pi.max(initial=0.0))

    @property
    def rest_costs(self) -> FloatArray:
        """(N,) cost of having each robot in the rest."""
        return np.maximum(self._theta - self.potentials, 0.0)

    def room(self, threshold: float) -> float:
        """Return the largest cost of the sets and robots of a family below the threshold, up to rounding in costs."""
        return threshold - self.bound + 1e-9 * abs(threshold)

    def columns(self, threshold: float) -> SetColumns:
        """The sets that a family with all groups below the threshold may use, with their costs."""
        room, kept_potentials = self.room(threshold), np.minimum(self.potentials, self._theta)
        parts = []
        for c, low in enumerate(self.classes.lists):
            least = float((self.weights[c] * low.values - _sums(low.masks, self.potentials)).min())
            costs = self.weights[c] * threshold - least - _sums(low.masks, kept_potentials)
            kept = (costs < room) & (low.values < threshold)
            parts.append((low.masks[kept], low.values[kept], np.maximum(costs[kept], 0.0), np.full(kept.sum(), c)))
        masks, values, costs, classes = (np.concatenate(part) for part in zip(*parts, strict=True))
        n_robots, first = self.classes.n_robots, _first_bits(masks)
        order = np.lexsort((costs, first, classes))
        keys = (classes * (n_robots + 1) + first)[order]
        places = np.arange(len(parts))[:, None] * (n_robots + 1) + np.arange(n_robots + 1)
        return SetColumns(
            masks=masks[order],
            values=values[order],
            costs=costs[order],
            starts=np.searchsorted(keys, places).astype(np.int64),
            counts=np.array(self.classes.counts, dtype=np.int64),
            rest_costs=self.rest_costs,
            room=room,
        )


def cover_bound(classes: SetClasses, threshold: float, budget: Budget, params: CoverParams) -> CoverBound:
    """Bound every family of the classes; none of the lists is empty.

    Parameters
    ----------
    threshold : no better bound is needed

    Raises
    ------
    OutOfBudget : the time is up before any bound is known.
    """
    program = _DualProgram(classes, max(abs(threshold), 1e-300), params)
    best = None
    n_sets = sum(len(low.masks) for low in classes.lists)
    for _ in range(params.rounds):
        budget.spend(1 + n_sets // params.sets_of_node)
        claim = program.solve()
        if claim is None:
            break
        potentials, weights, claimed = claim
        bound = program.bound(potentials, weights)
        if best is None or bound > best.bound:
            best = CoverBound(classes, bound, potentials, weights)
        if best.bound >= threshold or claimed - best.bound <= params.enough * max(threshold - best.bound, 0.0):
            break
        if budget.stop() not in {None, Stop.NODES}:
            break
    if best is None:
        budget.check()
        counts = classes.counts
        return CoverBound(classes, -np.inf, np.zeros(classes.n_robots), np.full(len(counts), 1.0 / sum(counts)))
    return best


class _DualProgram:
    """The dual over the sets that entered; columns: potentials, least reduced values, weights, in units of ``scale``.

    If nobody is in the rest, potentials of all robots may be shifted together; if no family exists, they are unbounded.
    The box keeps both in bounds.
    """

    def __init__(self, classes: SetClasses, scale: float, params: CoverParams) -> None:
        self._params = params
        n, k = classes.n_robots, len(classes.lists)
        self.classes, self.scale = classes, scale
        number = np.array(classes.counts, dtype=np.float64)
        self._cost = np.concatenate([np.ones(n), number, np.zeros(k)])
        box = params.box
        lower = np.concatenate([np.full(n, -box), np.full(k, -box * n), np.zeros(k)])
        upper = np.concatenate([np.full(n, box * (classes.rest == 0)), np.full(k, box * n), np.ones(k)])
        sizes = list(range(n + k, n + 2 * k)), number.tolist()
        self._program = LinearProgram(self._cost, lower, upper, rows=rows_of([sizes], [1.0], [1.0]), maximise=True)
        self._entered: set[tuple[int, int]] = set()
        self._enter(self._seeds())

    def solve(self) -> tuple[FloatArray, FloatArray, float] | None:
        """Potentials, weights, and the value that the program claims for the sets that entered."""
        claim = self._program.solve()
        if not len(claim.x):
            return None
        n, k = self.classes.n_robots, len(self.classes.lists)
        weights = np.maximum(claim.x[n + k :], 0.0)
        total = float(weights @ self.classes.counts)
        if not total > 0:
            return None
        return claim.x[:n] * self.scale, weights / total, float(self._cost @ claim.x) * self.scale

    def bound(self, potentials: FloatArray, weights: FloatArray) -> float:
        """Return the dual bound of these multipliers; the sets that bind enter the program."""
        classes, least = self.classes, []
        fresh: list[tuple[int, int]] = []
        for c, low in enumerate(classes.lists):
            reduced = weights[c] * low.values - _sums(low.masks, potentials)
            few = min(self._params.added, len(reduced))
            fresh.extend((c, int(k)) for k in np.argpartition(reduced, few - 1)[:few])
            least.append(float(reduced.min()))
        self._enter(fresh)
        own = np.sort(potentials)
        inside, sizes = float(own[: len(own) - classes.rest].sum()), np.abs(least) @ classes.counts
        rounding = 1e-14 * float(np.abs(own).sum() + sizes)
        return inside + float(np.array(classes.counts) @ np.array(least)) - rounding

    def _enter(self, sets: Iterable[tuple[int, int]]) -> None:
        fresh = [one for one in dict.fromkeys(sets) if one not in self._entered]
        self._entered.update(fresh)
        rows = [self._row(c, k) for c, k in fresh]
        if rows:
            self._program.add_rows(rows_of(rows, np.full(len(rows), -np.inf), np.zeros(len(rows))))

    def _row(self, c: int, k: int) -> tuple[list[int], list[float]]:
        """``pi(S) + u_c - weight_c value(S) <= 0``."""
        n, low = self.classes.n_robots, self.classes.lists[c]
        mask = int(low.masks[k])
        columns = [*(i for i in range(n) if mask >> i & 1), n + c, n + len(self.classes.lists) + c]
        return columns, [1.0] * (low.size + 1) + [-float(low.values[k]) / self.scale]

    def _seeds(self) -> Iterable[tuple[int, int]]:
        """The lowest sets of each size, and the lowest with each robot."""
        for c, low in enumerate(self.classes.lists):
            yield from ((c, k) for k in range(min(self._params.seeds, len(low.masks))))
            for i in range(self.classes.n_robots):
                having = np.flatnonzero(low.masks >> np.uint64(i) & np.uint64(1))[: self._params.seeds // 4]
                yield from ((c, int(k)) for k in having)


def _sums(masks: MaskArray, amounts: FloatArray) -> FloatArray:
    """(K,) sum of the amounts of the robots in each mask."""
    sums, part = np.zeros(len(masks)), 12  # robots of a table of sums
    for first in range(0, len(amounts), part):
        sums += sums_of_subsets(amounts[first : first + part])[masks >> np.uint64(first) & np.uint64(2**part - 1)]
    return sums


def _first_bits(masks: MaskArray) -> IntArray:
    """(K,) position of the lowest bit of each mask."""
    return np.asarray(np.bitwise_count((masks & (~masks + np.uint64(1))) - np.uint64(1)), dtype=np.int64)
