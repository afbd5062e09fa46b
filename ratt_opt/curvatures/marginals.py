"""Smallest and largest marginals of every element over an enumerated domain."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, overload

import numpy as np

from ratt_opt.setfunctions.base import finite_values
from ratt_opt.setfunctions.information import InformationObjective
from ratt_opt.setfunctions.table import TableFunction

if TYPE_CHECKING:
    from ratt_opt._validation import FloatArray, IntArray
    from ratt_opt.curvatures.domains import Domain
    from ratt_opt.setfunctions.base import SetFunction

__all__ = ["Marginals", "domain_values", "enumerate_marginals", "groups_of"]

Context = tuple[int, ...]


@dataclass(frozen=True, slots=True)
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


def groups_of(owners: IntArray) -> list[IntArray]:
    """Elements of each owner."""
    return [np.flatnonzero(owners == i) for i in range(int(owners.max(initial=-1)) + 1)]


def enumerate_marginals(domain: Domain, values: FloatArray | None = None) -> Marginals:
    """Exact smallest and largest marginals, O(n) passes over the domain (``values`` : its table, if known)."""
    alone = len(np.unique(domain.owners)) == domain.restricted.n
    if values is None and alone and isinstance(domain.restricted, TableFunction):
        return _table_marginals(domain.restricted)
    groups = groups_of(domain.owners)
    if values is None:
        values = finite_values(domain_values(domain.restricted, groups))
    n = domain.restricted.n
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
    return Marginals(ends[0], ends[0], ends[1], ends[1], _Attaining(f, 1.0), _Attaining(f, -1.0))


class _Attaining(Sequence[Context]):
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
        halves = self._f.values.reshape(-1, 2, 1 << x)
        where = int((self._sign * (halves[:, 1] - halves[:, 0])).argmin())
        low = where & ((1 << x) - 1)
        mask = (where ^ low) << 1 | low
        return tuple(e for e in range(self._f.n) if mask >> e & 1)


def domain_values(f: SetFunction, groups: list[IntArray]) -> FloatArray:
    """Values of all sets with at most one element of each group: one axis a group, index 0 for none of it."""
    shape = tuple(len(group) + 1 for group in groups)
    if isinstance(f, InformationObjective):
        return _information_values(f, groups).reshape(shape)
    size = int(np.prod(shape))
    values = np.empty(size)
    for start in range(0, size, 2**14):
        index = np.arange(start, min(start + 2**14, size))
        membership = np.zeros((len(index), f.n), dtype=np.bool_)
        for group, picks in zip(groups, np.unravel_index(index, shape), strict=True):
            rows = np.flatnonzero(picks)
            membership[rows, group[picks[rows] - 1]] = True
        values[index] = f.evaluate(membership)
    return values.reshape(shape)


def _information_values(f: InformationObjective, groups: list[IntArray]) -> FloatArray:
    """Flat values in C order; the last groups' sums are shared by all choices of the first ones."""
    shape = [len(group) + 1 for group in groups]
    split = len(groups)
    block = 1
    while split > 0 and block * shape[split - 1] <= 2**14:
        split -= 1
        block *= shape[split]
    low = _sums(f, groups[split:], f.prior_information)
    high = _sums(f, groups[:split], np.zeros_like(f.prior_information))
    return np.concatenate([f.value(low + offset) for offset in high])


def _sums(f: InformationObjective, groups: list[IntArray], start: FloatArray) -> FloatArray:
    """(product of (len + 1), M, d, d) sums of one element or none of each group, in C order, plus ``start``."""
    sums = start[None]
    for group in groups:
        options = np.concatenate([np.zeros((1, *start.shape)), f.information[group]])
        sums = (sums[:, None] + options[None]).reshape(-1, *start.shape)
    return sums
