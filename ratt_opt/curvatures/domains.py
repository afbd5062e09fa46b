"""Domains of a curvature: the sets over which its marginals range, and their values."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from ratt_opt._validation import BoolArray, FloatArray, IntArray, check_subset, integer_array
from ratt_opt.budget import Budget, OutOfBudget, Stop
from ratt_opt.errors import InputError
from ratt_opt.setfunctions.base import SetFunction, TableFunction, finite_values
from ratt_opt.setfunctions.evaluation_error import value_error
from ratt_opt.setfunctions.information import InformationObjective
from ratt_opt.setfunctions.metered import Metered

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

__all__ = ["Domain", "domain_of", "over_subsets", "values_over"]

BLOCK = 2**14
"""Sets whose values are computed at once: their matrices stay in cache, larger blocks are no faster (measured)."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Domain:
    """``restricted`` is the function on the elements that take part; a set holds at most one of each owner's.

    ``owners`` : owner of each of its elements, 0.. without gaps. ``names`` : their indices in the original function.
    ``noise`` : by how much a computed difference of two values may be off; 0 if values are whole numbers
    ``largest`` : size of the values of nothing and of everything, between which those of a non-decreasing function lie
    """

    name: str
    restricted: SetFunction
    owners: IntArray
    names: IntArray
    noise: float
    largest: float

    @property
    def count(self) -> float:
        """Number of sets in the domain; infinite beyond floating point."""
        with np.errstate(over="ignore"):
            return float(np.prod(np.bincount(self.owners) + 1.0))

    @property
    def is_submodular(self) -> bool:
        """Tell whether the function is known to be submodular by theory."""
        f = self.restricted
        return f.f.is_submodular if isinstance(f, Restricted) else f.is_submodular

    @property
    def may_add(self) -> BoolArray:
        """(n,) whether an element may add something although its marginals are computed as 0."""
        f = self.restricted
        return ~silent(f) if isinstance(f, InformationObjective) else np.zeros(f.n, dtype=np.bool_)

    @property
    def groups(self) -> list[IntArray]:
        """Elements of each owner."""
        return [np.flatnonzero(self.owners == i) for i in range(int(self.owners.max(initial=-1)) + 1)]

    def values(self, budget: Budget) -> FloatArray:
        """Values of all sets: one axis an owner, index 0 for none of its elements; raises ``OutOfBudget``."""
        return finite_values(values_over(self.restricted, self.groups, budget))

    def element(self, x: int | np.int64) -> int:
        """The original index of one element."""
        return int(self.names[x])

    def named(self, context: tuple[int, ...]) -> tuple[int, ...]:
        """The original indices of a set."""
        return tuple(sorted(int(self.names[e]) for e in context))


def domain_of(f: SetFunction, owners: ArrayLike | None, plan: ArrayLike | None) -> Domain:
    """Return the domain that the arguments of a curvature describe.

    InputError : owners of the wrong shape, or a plan that repeats or exceeds the elements.
    """
    everything = np.arange(f.n)
    if plan is not None:
        chosen = check_subset("plan", integer_array(plan).tolist(), f.n)
        return _domain("robots", f, _restriction(f, chosen), np.arange(len(chosen)), chosen)
    if owners is None:
        return _domain("elements", f, f, everything, everything)
    given = integer_array(owners)
    if given.shape != (f.n,) or given.dtype.kind not in "iu":
        raise InputError("owners", f"must hold {f.n} integers, one per element", f"shape {given.shape}, {given.dtype}")
    _, numbered = np.unique(given, return_inverse=True)
    return _domain("feasible", f, f, numbered.astype(np.int64), everything)


def _domain(name: str, f: SetFunction, restricted: SetFunction, owners: IntArray, names: IntArray) -> Domain:
    """The domain with what its values may have rounded."""
    largest = float(np.abs(finite_values(np.array([restricted([]), restricted(range(restricted.n))]))).max())
    groups = [names[owners == i] for i in range(int(owners.max(initial=-1)) + 1)]
    noise = 2 * value_error(f, groups, largest)
    return Domain(name=name, restricted=restricted, owners=owners, names=names, noise=noise, largest=largest)


def silent(f: InformationObjective) -> BoolArray:
    """(n,) whether an element surely adds nothing to any set.

    So it is if it has no information, or none that reaches the coordinates that count: the nonzero entries of a
    target's prior and information matrices join its coordinates, and what is not joined is independent, exactly.
    """
    d = f.dimension
    joined = (f.prior != 0) | (f.information != 0).any(axis=0)
    for _ in range(max(d - 1, 0).bit_length()):
        joined = joined | (joined.astype(np.int64) @ joined.astype(np.int64) > 0)
    counts = np.ones((f.n_targets, d), np.bool_) if f.output is None else (f.output != 0).any(axis=-2)
    reached = (joined & np.broadcast_to(counts, (f.n_targets, d))[:, None, :]).any(axis=-1)
    told = (f.information != 0).any(axis=-1) & reached
    return np.asarray(~told.any(axis=(1, 2)))


def values_over(f: SetFunction, groups: list[IntArray], budget: Budget) -> FloatArray:
    """Values of all sets with at most one element of each group: one axis a group, index 0 for none of it.

    Raises ``OutOfBudget``.
    """
    shape = tuple(len(group) + 1 for group in groups)
    if isinstance(f, InformationObjective):
        return _information_values(f, groups, budget).reshape(shape)
    size, f = int(np.prod(shape)), Metered(f, budget)
    if size > budget.evaluations_left:
        raise OutOfBudget(Stop.EVALUATIONS)
    values = np.empty(size)
    for start in range(0, size, BLOCK):
        index = np.arange(start, min(start + BLOCK, size))
        membership = np.zeros((len(index), f.n), dtype=np.bool_)
        for group, picks in zip(groups, np.unravel_index(index, shape) if groups else (), strict=True):
            rows = np.flatnonzero(picks)
            membership[rows, group[picks[rows] - 1]] = True
        values[index] = f.evaluate(membership)
    return values.reshape(shape)


def _information_values(f: InformationObjective, groups: list[IntArray], budget: Budget) -> FloatArray:
    """Flat values in C order; the last groups' sums are shared by all choices of the first ones."""
    shape = [len(group) + 1 for group in groups]
    split = len(groups)
    block = 1
    while split > 0 and block * shape[split - 1] <= BLOCK:
        split -= 1
        block *= shape[split]
    low = _sums(f, groups[split:], f.prior_information)
    high = _sums(f, groups[:split], np.zeros_like(f.prior_information))
    blocks = []
    for offset in high:
        budget.check()
        blocks.append(f.value(low + offset))
    return np.concatenate(blocks)


def _sums(f: InformationObjective, groups: list[IntArray], start: FloatArray) -> FloatArray:
    """(product of (len + 1), M, d, d) sums of one element or none of each group, in C order, plus ``start``."""
    sums = start[None]
    for group in groups:
        options = np.concatenate([np.zeros((1, *start.shape)), f.information[group]])
        sums = (sums[:, None] + options[None]).reshape(-1, *start.shape)
    return sums


def _restriction(f: SetFunction, chosen: IntArray) -> SetFunction:
    if isinstance(f, InformationObjective):
        return f.restricted_to(chosen)
    if isinstance(f, TableFunction):
        values = values_over(f, list(chosen[:, None]), Budget())
        return TableFunction(values.ravel(order="F"))  # the first element is the lowest bit
    return Restricted(f, chosen)


class Restricted(SetFunction):
    """``f`` on some of its elements, in the given order."""

    __slots__ = ("chosen", "f")

    def __init__(self, f: SetFunction, chosen: IntArray) -> None:
        self.f, self.chosen = f, chosen

    @property
    def n(self) -> int:
        """Number of elements that take part."""
        return len(self.chosen)

    @property
    def most_total_curvature(self) -> float:
        """The bound of the whole function: with fewer contexts the curvature is no larger."""
        return self.f.most_total_curvature

    def evaluate(self, membership: BoolArray) -> FloatArray:
        """(K,) values of the subsets in the rows of ``membership`` (K, n)."""
        whole = np.zeros((len(membership), self.f.n), dtype=np.bool_)
        whole[:, self.chosen] = membership
        return self.f.evaluate(whole)


def over_subsets(extreme: np.ufunc, table: FloatArray) -> FloatArray:
    """Smallest (``np.minimum``) or largest (``np.maximum``) entry over all subsets of each set, one axis an owner."""
    found = table.copy()
    for axis in range(table.ndim):
        view = np.moveaxis(found, axis, 0)
        extreme(view[1:], view[:1], out=view[1:])
    return found
