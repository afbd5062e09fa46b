"""Smallest and largest marginals of every element: what is known of them, and all of them where sets can be listed."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, overload

import numpy as np

from ratt_opt.errors import InputError
from ratt_opt.setfunctions.table import TableFunction

if TYPE_CHECKING:
    from ratt_opt._validation import FloatArray
    from ratt_opt.curvatures.domains import Domain
    from ratt_opt.stopping import Stop

__all__ = ["Marginals", "MeasuredMarginals", "check_monotone", "enumerate_marginals"]

Context = tuple[int, ...]
FALL = 1e-9
"""A marginal below minus this, relative to the largest one, is no rounding: the function falls."""


@dataclass(frozen=True, slots=True, eq=False)
class Marginals:
    """Per element, brackets ``[lower, upper]`` of its smallest and of its largest marginal, and contexts.

    ``smallest_context`` attains ``smallest_upper`` and ``largest_context`` attains ``largest_lower``.
    """

    smallest_lower: FloatArray
    smallest_upper: FloatArray
    largest_lower: FloatArray
    largest_upper: FloatArray
    smallest_context: Sequence[Context]
    largest_context: Sequence[Context]

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, Marginals):
            return NotImplemented
        ends = ("smallest_lower", "smallest_upper", "largest_lower", "largest_upper")
        return (
            all(np.array_equal(getattr(self, end), getattr(other, end)) for end in ends)
            and list(self.smallest_context) == list(other.smallest_context)
            and list(self.largest_context) == list(other.largest_context)
        )

    __hash__ = None  # type: ignore[assignment]


@dataclass(frozen=True, slots=True, kw_only=True)
class MeasuredMarginals:
    """Marginals, ``how`` they are known, why the search for them stopped, and the ``nodes`` (parts) it bounded."""

    marginals: Marginals
    how: str
    stop: Stop
    nodes: int


def enumerate_marginals(domain: Domain, values: FloatArray | None = None) -> Marginals:
    """Exact smallest and largest marginals, O(n) passes over the domain (``values`` : its table, if known).

    Raises
    ------
    InputError : the function is not non-decreasing; the text shows where.
    """
    alone = len(np.unique(domain.owners)) == domain.restricted.n
    if values is None and alone and isinstance(domain.restricted, TableFunction):
        found = _table_marginals(domain.restricted)
    else:
        found = _all_marginals(domain, domain.values() if values is None else values)
    check_monotone(domain, found)
    return found


def check_monotone(domain: Domain, found: Marginals) -> None:
    """Refuse a function with a negative marginal (beyond rounding), showing it."""
    if len(found.smallest_lower) == 0:
        return
    scale = max(float(np.abs(found.largest_upper).max(initial=0.0)), 1e-300)
    worst = int(found.smallest_lower.argmin())
    if found.smallest_lower[worst] < -FALL * scale:
        context = domain.named(found.smallest_context[worst])
        shown = f"adding {domain.element(worst)} to {list(context)} changes it by {found.smallest_lower[worst]:.6g}"
        raise InputError("f", "must be non-decreasing", shown)


def _all_marginals(domain: Domain, values: FloatArray) -> Marginals:
    n, groups = domain.restricted.n, domain.groups
    ends = np.empty((2, n))
    contexts: tuple[list[Context], list[Context]] = ([()] * n, [()] * n)
    for axis, own in enumerate(groups):
        slices = np.moveaxis(values, axis, 0)
        rest = [g for k, g in enumerate(groups) if k != axis]
        for position, x in enumerate(own.tolist(), start=1):
            marginal = slices[position] - slices[0]
            for side, where in enumerate((int(marginal.argmin()), int(marginal.argmax()))):
                index = np.unravel_index(where, marginal.shape)
                ends[side, x] = marginal[index]
                contexts[side][x] = tuple(int(g[k - 1]) for g, k in zip(rest, index, strict=True) if k > 0)
    return Marginals(ends[0], ends[0], ends[1], ends[1], tuple(contexts[0]), tuple(contexts[1]))


def _table_marginals(f: TableFunction) -> Marginals:
    """The same for a table and all its sets, by one compiled pass an element."""
    from ratt_opt.setfunctions.lattice import marginal_ends

    ends = marginal_ends(f.values, f.n)
    return Marginals(ends[0], ends[0], ends[1], ends[1], _TableContexts(f, 1.0), _TableContexts(f, -1.0))


class _TableContexts(Sequence[Context]):
    """Contexts of the smallest marginals (largest: ``sign`` -1) of a table, looked for when asked for."""

    def __init__(self, f: TableFunction, sign: float) -> None:
        self._f, self._sign = f, sign

    def __len__(self) -> int:
        return self._f.n

    @overload
    def __getitem__(self, x: int) -> Context: ...
    @overload
    def __getitem__(self, x: slice) -> Sequence[Context]: ...
    def __getitem__(self, x: int | slice) -> Context | Sequence[Context]:
        if isinstance(x, slice):
            return [self[k] for k in range(*x.indices(len(self)))]
        x = range(len(self))[x]  # an IndexError past the end, which ends a loop over the contexts
        halves = self._f.values.reshape(-1, 2, 1 << x)
        where = int((self._sign * (halves[:, 1] - halves[:, 0])).argmin())
        low = where & ((1 << x) - 1)
        mask = (where ^ low) << 1 | low
        return tuple(e for e in range(self._f.n) if mask >> e & 1)
