"""Modular bounds of one part of a sum, by its values.

A part with few elements has all its sets enumerated. The concave envelope at a point is then a linear program, solved
over few sets to which those that violate its answer most are added. The solver only suggests the gains; the constant is
computed again as the largest difference over all sets.

Of a larger part that is submodular and non-decreasing, any *base set* ``S`` gives a bound:

    phi(T) <= phi(S) + sum of phi(S + e) - phi(S) over e in T - S - sum of phi(V) - phi(V - e) over e in S - T,

where ``V`` are all its elements (Nemhauser, Wolsey and Fisher 1978). If a part is the best of its elements, the sets of
all elements below a level give its envelope. From the best of these, elements are exchanged while that lowers it.
"""

from __future__ import annotations

from functools import cache
from typing import TYPE_CHECKING

import numpy as np

from ratt_opt.highs import LinearProgram, Rows, rows_of
from ratt_opt.setfunctions.decomposition import DEFAULT, Overestimator, rounded_up

if TYPE_CHECKING:
    from typing import Protocol

    from ratt_opt._validation import BoolArray, FloatArray, IntArray
    from ratt_opt.setfunctions.decomposition import PartBounds

    class Parts(Protocol):
        """Parts to bound; all are submodular if the function says so."""

        @property
        def is_submodular(self) -> bool: ...

        def touching(self, part: int) -> IntArray: ...

        def part_values(self, part: int, membership: BoolArray) -> FloatArray: ...


__all__ = ["PartBounder"]


class PartBounder:
    """Bounds of the parts of one function; tables of parts and bounds of level sets are kept."""

    def __init__(self, f: Parts) -> None:
        self._f = f
        self._tables: dict[int, FloatArray] = {}
        self._levels: dict[int, FloatArray] = {}
        self._cuts: dict[tuple[int, bytes], Overestimator] = {}
        self._last: dict[int, FloatArray] = {}

    def marginals(self, part: int) -> FloatArray:
        """(k,) no element adds more, whatever set it is added to."""
        f, k = self._f, len(self._f.touching(part))
        if k <= DEFAULT.most_enumerated:
            table = self._table(part)
            steps = [table.reshape(-1, 2, 1 << e) for e in range(k)]
            return rounded_up(np.array([float((step[:, 1] - step[:, 0]).max()) for step in steps]))
        if f.is_submodular:
            return rounded_up(self._alone(part))
        empty, full = self._ends(part)
        return rounded_up(np.full(k, full - empty))

    def overestimator(self, part: int, share: FloatArray, effort: PartBounds) -> Overestimator:
        """A modular bound of all sets that is small at a fractional point (k,)."""
        if len(share) <= effort.most_enumerated:
            return _envelope(self._table(part), share, effort)
        if self._f.is_submodular:
            bases = (self._best_level(part, share), share >= 1 / 2)
            return self._exchanged(part, share, effort, min(bases, key=lambda base: self._from(part, base).at(share)))
        empty, full = self._ends(part)
        known = [Overestimator(empty, self.marginals(part)), Overestimator(full, np.zeros(len(share)))]
        return min(known, key=lambda bound: bound.at(share))

    def _ends(self, part: int) -> tuple[float, float]:
        k = len(self._f.touching(part))
        ends = self._f.part_values(part, np.array([np.zeros(k), np.ones(k)], dtype=np.bool_))
        return float(ends[0]), float(ends[1])

    def _alone(self, part: int) -> FloatArray:
        """(k,) what each element adds to nothing."""
        base = np.zeros(len(self._f.touching(part)), dtype=np.bool_)
        values = self._f.part_values(part, np.concatenate([base[None], np.eye(len(base), dtype=np.bool_)]))
        return np.asarray(values[1:] - values[0])

    # -- base sets -------------------------------------------------------------------------------------------------

    def _best_level(self, part: int, share: FloatArray) -> BoolArray:
        """Search the levels by thirds: the bound is convex in the level if the part is the best of its elements."""
        alone = self._alone(part)
        if part not in self._levels:
            self._levels[part] = np.append(-1.0, np.unique(alone))
        levels = self._levels[part]

        def base(position: int) -> BoolArray:
            return np.asarray(alone <= levels[position])

        low, high = 0, len(levels) - 1
        while high - low > 2:
            third = (high - low) // 3
            left, right = (self._from(part, base(k)).at(share) for k in (low + third, high - third))
            low, high = (low, high - third) if left <= right else (low + third, high)
        return base(min(range(low, high + 1), key=lambda k: self._from(part, base(k)).at(share)))

    def _exchanged(self, part: int, share: FloatArray, effort: PartBounds, base: BoolArray) -> Overestimator:
        """Add an element to the base set, or take one away, while that lowers the bound: the best one each time."""
        bound = self._from(part, base)
        for _ in range(effort.steps):
            others = np.logical_xor(base, np.eye(len(base), dtype=np.bool_))
            bounds = [self._from(part, other) for other in others[share > 0]]
            best = min(bounds, key=lambda one: one.at(share), default=bound)
            if not bounds or best.at(share) >= bound.at(share) - effort.tolerance * abs(bound.at(share)):
                break
            base, bound = others[share > 0][bounds.index(best)], best
        return bound

    def _from(self, part: int, base: BoolArray) -> Overestimator:
        """The bound by one base set."""
        key = part, np.packbits(base).tobytes()
        if key not in self._cuts:
            value, gains = self._gains(part, base)
            self._cuts[key] = Overestimator(value, gains)
        return self._cuts[key]

    def _gains(self, part: int, base: BoolArray) -> tuple[float, FloatArray]:
        """Constant and gains: what each element adds to the base set, and those inside to all others."""
        outside = np.flatnonzero(~base)
        sets = np.tile(base, (len(outside) + 1, 1))
        sets[np.arange(len(outside)), outside] = True
        values, gains = self._f.part_values(part, sets), np.zeros(len(base))
        gains[outside] = rounded_up(values[:-1] - values[-1])
        gains[base] = self._last_gains(part)[base]
        slack = 4 * len(base) * np.finfo(np.float64).eps * abs(values[-1])
        return float(values[-1] - gains[base].sum() + slack), gains

    def _last_gains(self, part: int) -> FloatArray:
        """(k,) what each element adds to all others, rounded down."""
        if part not in self._last:
            k = len(self._f.touching(part))
            sets = ~np.concatenate([np.zeros((1, k), dtype=np.bool_), np.eye(k, dtype=np.bool_)])
            values = self._f.part_values(part, sets)
            gains = values[0] - values[1:]
            self._last[part] = np.where(gains > 0, np.nextafter(gains, -np.inf), 0.0)
        return self._last[part]

    # -- all sets --------------------------------------------------------------------------------------------------

    def _table(self, part: int) -> FloatArray:
        if part not in self._tables:
            sets = _sets(len(self._f.touching(part))).astype(np.bool_)
            self._tables[part] = np.asarray(self._f.part_values(part, sets), dtype=np.float64)
        return self._tables[part]


@cache
def _sets(k: int) -> FloatArray:
    """(2**k, k) memberships by bit masks."""
    return np.asarray((np.arange(2**k)[:, None] >> np.arange(k) & 1).astype(np.float64))


def _envelope(table: FloatArray, share: FloatArray, params: PartBounds) -> Overestimator:
    """The concave envelope of a table (2**k,) at a point (k,): a linear program suggests, all sets prove."""
    k, members = len(share), _sets(len(share))
    in_program = {0, len(table) - 1, *(1 << e for e in range(k))}

    def rows(masks: list[int]) -> Rows:
        return rows_of(
            [([0, *(np.flatnonzero(members[m]) + 1).tolist()], [1.0] * (1 + m.bit_count())) for m in masks],
            table[masks],
        )

    program = LinearProgram(
        np.append(1.0, share), np.append(-np.inf, np.zeros(k)), rows=rows(sorted(in_program)), presolve="off"
    )
    tolerance = params.tolerance * float(np.abs(table).max())
    gains = np.zeros(k)
    for _ in range(params.rounds):
        found = program.solve()
        if len(found.x) != k + 1:
            break
        gains = np.maximum(found.x[1:], 0.0)
        excess = table - members @ gains - found.x[0]
        worst = [
            m for m in np.argsort(-excess)[: params.sets].tolist() if excess[m] > tolerance and m not in in_program
        ]
        if not worst:
            break
        in_program.update(worst)
        program.add_rows(rows(worst))
    # The sum of k gains and its difference from a value round k + 1 times.
    sums = members @ gains
    slack = (k + 1) * np.finfo(np.float64).eps * (sums.max() + np.abs(table).max())
    return Overestimator(float((table - sums).max() + slack), gains)
