"""The two classes of set functions as linear programs over the values that matter.

Elements: ``u_i`` (the planner's choice for robot i) is bit ``i``, ``o_i`` (an optimal plan's)
is bit ``N + i``. Taking them distinct loses nothing. If ``o_i = u_i``, add a twin ``o'`` of ``u``:
``f(S + o') = f(S + u)``, and ``f(S + u + o') = f(S + u) + w`` with ``w = (1-k) f(u)`` (submodular; diminishing
returns hold because every marginal of ``u`` is at least ``w``) or any ``w`` in ``[(1-c) m_u, m_u]`` (total
curvature, ``m_u`` the largest marginal of ``u``). Neither curvature nor any value used below changes.
"""

from __future__ import annotations

from fractions import Fraction
from itertools import product
from typing import TYPE_CHECKING

import numpy as np

from ratt_opt.worst_ratio.params import DEFAULT
from ratt_opt.worst_ratio.program import Inequality

if TYPE_CHECKING:
    from collections.abc import Collection, Sequence

    from ratt_opt._validation import FloatArray, IntArray
    from ratt_opt.worst_ratio.params import WorstRatioParams

__all__ = ["ClassRows", "NonDecreasing", "Submodular"]


class Submodular:
    """Non-decreasing, submodular, curvature at most ``curvature`` over ``domain``; one column per subset."""

    def __init__(self, n_robots: int, curvature: Fraction, domain: str, params: WorstRatioParams = DEFAULT) -> None:
        self.n_robots, self.kept, self.domain, self.params = n_robots, 1 - curvature, domain, params
        self.n = 2 * n_robots
        self.n_columns = 1 << self.n
        self.is_complete = params.many_columns <= self.n_columns <= params.complete_columns

    def column(self, mask: int) -> int:
        """Column ``mask``: the empty set has none, so column 0 is free for the ratio."""
        return mask

    def first_rows(self) -> list[Inequality]:
        """Monotone and curvature rows; with diminishing returns the largest contexts imply all others.

        Diminishing returns come along for five and six robots, else :meth:`violated` finds them.
        """
        everything = self.n_columns - 1
        rows = [Inequality(_terms((everything, 1), (everything & ~(1 << x), -1))) for x in range(self.n)]
        for x in range(self.n):
            for context in self._largest_contexts(x):
                rows.append(Inequality(_terms((context | 1 << x, 1), (context, -1), (1 << x, -self.kept))))
        if self.is_complete:
            rows += [_diminishing(a, b, base) for a, b in self._pairs() for base in self._bases(a, b).tolist()]
        return rows

    def _pairs(self) -> list[tuple[int, int]]:
        return [(a, b) for b in range(self.n) for a in range(b)]

    def _bases(self, a: int, b: int) -> IntArray:
        masks: IntArray = np.arange(self.n_columns)
        return np.asarray(masks[(masks >> a | masks >> b) & 1 == 0])

    def _largest_contexts(self, x: int) -> list[int]:
        if self.domain == "elements":
            return [self.n_columns - 1 & ~(1 << x)]
        others = [i for i in range(self.n_robots) if i != x % self.n_robots]
        picks = product(*((1 << i, 1 << self.n_robots + i) for i in others))
        return [sum(pick) for pick in picks]

    def violated(self, x: FloatArray, used: Collection[int]) -> list[Inequality]:  # noqa: ARG002  (every subset has a column)
        """Diminishing returns ``f(S+a) + f(S+b) >= f(S+a+b) + f(S)`` that fail; empty in the class."""
        if self.is_complete:
            return []
        values = x.copy()
        values[0] = 0.0
        found: list[tuple[float, int, int, int]] = []
        for a, b in self._pairs():
            base = self._bases(a, b)
            slack = values[base | 1 << a] + values[base | 1 << b] - values[base | 1 << a | 1 << b] - values[base]
            found += [(float(slack[i]), a, b, int(base[i])) for i in np.flatnonzero(slack < -self.params.rounding)]
        found.sort()
        return [_diminishing(a, b, base) for _, a, b, base in found[: self.params.rows]]

    def optimal_values(self, x: FloatArray, used: Collection[int], masks: Sequence[int]) -> FloatArray:  # noqa: ARG002
        """Values of subsets: the program's own."""
        return x[np.array(masks, dtype=np.int64)]

    def table(self, point: Sequence[Fraction], used: Collection[int]) -> list[Fraction]:  # noqa: ARG002
        """Values of all ``4**N`` subsets from a rational point of the program."""
        return [Fraction(0), *point[1:]]


class NonDecreasing:
    """Non-decreasing with total curvature at most ``curvature``; columns only for the subsets in use.

    All marginals of ``x`` lie in ``[(1-c) m_x, m_x]`` for some ``m_x``. Given ``m``, values prescribed on a
    family of subsets extend to all subsets if and only if for each pair
    ``f(T) - f(S) <= m(T - S) - (1-c) m(S - T)``: the constraints are differences along the edges of
    the hypercube, and the right side is the length of a shortest path (first remove, then add; removing and
    adding an element again costs ``c m_x >= 0``). ``f(T) = min over S of f(S) + length(S, T)`` extends it.
    A path between two feasible sets stays among feasible sets, so the ratio is the same whether the
    curvature is taken over all elements or over feasible sets.
    """

    def __init__(
        self, n_robots: int, curvature: Fraction, masks: Sequence[int], params: WorstRatioParams = DEFAULT
    ) -> None:
        self.n, self.kept, self.params = 2 * n_robots, 1 - curvature, params
        self._columns = {mask: 1 + self.n + k for k, mask in enumerate(dict.fromkeys(masks))}
        self.n_columns = 1 + self.n + len(self._columns)

    def column(self, mask: int) -> int:
        """Column of a subset; columns 1 to 2N hold the largest marginals."""
        return self._columns[mask]

    def first_rows(self) -> list[Inequality]:
        """Bounds on single elements; :meth:`violated` finds all other rows."""
        rows = []
        for x in range(self.n):
            if 1 << x in self._columns:
                single = self._columns[1 << x]
                rows.append(Inequality({1 + x: Fraction(1), single: Fraction(-1)}))
                rows.append(Inequality({single: Fraction(1), 1 + x: -self.kept}))
        return rows

    def violated(self, x: FloatArray, used: Collection[int]) -> list[Inequality]:
        """Pairs of used subsets whose values no function of the class can have; empty when they extend to it."""
        masks = np.array([0, *used], dtype=np.int64)
        values = np.array([0.0, *(x[self._columns[mask]] for mask in used)])
        slack = values[:, None] + self._length(x[1 : 1 + self.n], masks, masks) - values[None, :]
        pairs = np.argwhere(slack < -self.params.rounding)
        pairs = pairs[np.argsort(slack[tuple(pairs.T)], kind="stable")][: self.params.rows]
        return [self.pair(int(masks[i]), int(masks[j])) for i, j in pairs]

    def _length(self, marginals: FloatArray, starts: IntArray, ends: IntArray) -> FloatArray:
        bits = 1 << np.arange(self.n, dtype=np.int64)
        a, b = (starts[:, None] & bits > 0)[:, None], (ends[:, None] & bits > 0)[None]
        result: FloatArray = (b & ~a) @ marginals - float(self.kept) * ((a & ~b) @ marginals)
        return result

    def pair(self, start: int, end: int) -> Inequality:
        """Yield the rows of the class for two subsets in use (0: the empty one)."""
        terms: dict[int, Fraction] = {}
        if start:
            terms[self._columns[start]] = Fraction(1)
        if end:
            terms[self._columns[end]] = Fraction(-1)
        for x in range(self.n):
            inside = (end >> x & 1) - (start >> x & 1)
            if inside:
                terms[1 + x] = Fraction(1) if inside > 0 else -self.kept
        return Inequality({j: value for j, value in terms.items() if value})

    def optimal_values(self, x: FloatArray, used: Collection[int], masks: Sequence[int]) -> FloatArray:
        """Values, in the largest extension, of subsets that the program need not have used."""
        starts = np.array([0, *used], dtype=np.int64)
        values = np.array([0.0, *(x[self._columns[mask]] for mask in used)])
        length = self._length(x[1 : 1 + self.n], starts, np.array(masks, dtype=np.int64))
        return np.asarray((values[:, None] + length).min(axis=0))

    def table(self, point: Sequence[Fraction], used: Collection[int]) -> list[Fraction]:
        """Values of the largest extension, in rationals."""
        marginals = point[1 : 1 + self.n]
        added, removed = [Fraction(0)], [Fraction(0)]
        for m in marginals:
            added += [value + m for value in added]
            removed += [value + self.kept * m for value in removed]
        known = [(0, Fraction(0)), *((mask, point[self._columns[mask]]) for mask in used)]
        return [min(f + added[t & ~s] - removed[s & ~t] for s, f in known) for t in range(1 << self.n)]


ClassRows = Submodular | NonDecreasing
"""Columns for the values of subsets (column 0 is the ratio), and the rows that put them in the class."""


def _diminishing(a: int, b: int, base: int) -> Inequality:
    return Inequality(_terms((base | 1 << a, 1), (base | 1 << b, 1), (base | 1 << a | 1 << b, -1), (base, -1)))


def _terms(*terms: tuple[int, int | Fraction]) -> dict[int, Fraction]:
    """Column -> coefficient, the empty set (value 0) and zero coefficients left out, repeats added up."""
    total: dict[int, Fraction] = {}
    for mask, value in terms:
        if mask:
            total[mask] = total.get(mask, Fraction(0)) + value
    return {mask: value for mask, value in total.items() if value}
