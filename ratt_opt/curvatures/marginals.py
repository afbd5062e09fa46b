"""Smallest and largest marginals of every element: what is known of them, and how it becomes known.

If the sets can be listed, all of them; elsewhere brackets, the least certain ratio refined first.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass, fields
from typing import TYPE_CHECKING, overload

import numpy as np

from ratt_opt.budget import Stop
from ratt_opt.curvatures.params import DEFAULT, CurvatureParams
from ratt_opt.errors import InputError
from ratt_opt.setfunctions.base import TableFunction
from ratt_opt.setfunctions.lattice import marginal_ends
from ratt_opt.setfunctions.properties import mask_without
from ratt_opt.setfunctions.property_params import DEFAULT as PROPERTY

if TYPE_CHECKING:
    from collections.abc import Iterator

    from ratt_opt._validation import BoolArray, FloatArray, IntArray
    from ratt_opt.budget import Budget
    from ratt_opt.curvatures.domains import Domain
    from ratt_opt.setfunctions.information import InformationObjective

__all__ = [
    "MARGIN",
    "Context",
    "MarginalBrackets",
    "Marginals",
    "MeasuredMarginals",
    "check_monotone",
    "each_marginal",
    "elements_at",
    "enumerate_marginals",
]

Context = tuple[int, ...]
MARGIN = 1e-9
"""Relative safety margin for rounding on every bound; it keeps ratios apart that meet. Inverses of matrices whose
condition is 1e6 lose less."""


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
        return all(list(getattr(self, f.name)) == list(getattr(other, f.name)) for f in fields(self))

    __hash__ = None  # type: ignore[assignment]


@dataclass(frozen=True, slots=True, kw_only=True)
class MeasuredMarginals:
    """Marginals, ``how`` they are known, why the search for them stopped, and the ``nodes`` (parts) it bounded."""

    marginals: Marginals
    how: str
    stop: Stop
    nodes: int


def enumerate_marginals(domain: Domain, budget: Budget, values: FloatArray | None = None) -> Marginals:
    """Exact smallest and largest marginals, O(n) passes over the domain (``values`` : its table, if known).

    Raises ``OutOfBudget``, and ``InputError`` : the function is not non-decreasing; the text shows where.
    """
    alone = len(np.unique(domain.owners)) == domain.restricted.n
    if values is None and alone and isinstance(domain.restricted, TableFunction):
        f = domain.restricted
        budget.check()
        least, most = marginal_ends(f.values, f.n)
        found = Marginals(least, least, most, most, _TableContexts(f, 1.0), _TableContexts(f, -1.0))
    else:
        found = _all_marginals(domain, domain.values(budget) if values is None else values, budget)
    check_monotone(domain, found)
    return found


def check_monotone(domain: Domain, found: Marginals) -> None:
    """Refuse a function with a negative marginal (beyond rounding), showing it."""
    if len(found.smallest_lower) == 0:
        return
    worst = int(found.smallest_lower.argmin())
    # The rule of find_monotonicity_violation: marginals are differences of values, and as exact as those.
    if found.smallest_lower[worst] < -max(PROPERTY.tolerance * domain.largest, domain.noise):
        context = domain.named(found.smallest_context[worst])
        shown = f"adding {domain.element(worst)} to {list(context)} changes it by {found.smallest_lower[worst]:.6g}"
        raise InputError("f", "must be non-decreasing", shown)


def each_marginal(values: FloatArray, groups: list[IntArray]) -> Iterator[tuple[int, FloatArray, list[IntArray]]]:
    """Each element, its marginals on top of all sets of the other groups (one axis a group), and those groups."""
    for axis, own in enumerate(groups):
        slices = np.moveaxis(values, axis, 0)
        for position, x in enumerate(own.tolist(), start=1):
            yield x, slices[position] - slices[0], groups[:axis] + groups[axis + 1 :]


def elements_at(index: tuple[int | np.intp, ...], groups: list[IntArray]) -> Context:
    """Elements of a set, group by group."""
    return tuple(int(group[pick - 1]) for group, pick in zip(groups, index, strict=True) if pick > 0)


def _all_marginals(domain: Domain, values: FloatArray, budget: Budget) -> Marginals:
    n = domain.restricted.n
    ends = np.empty((2, n))
    contexts: tuple[list[Context], list[Context]] = ([()] * n, [()] * n)
    for x, marginal, rest in each_marginal(values, domain.groups):
        budget.check()
        for side, where in enumerate((int(marginal.argmin()), int(marginal.argmax()))):
            index = np.unravel_index(where, marginal.shape)
            ends[side, x] = marginal[index]
            contexts[side][x] = elements_at(index, rest)
    return Marginals(ends[0], ends[0], ends[1], ends[1], tuple(contexts[0]), tuple(contexts[1]))


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
        mask = mask_without(int((self._sign * (halves[:, 1] - halves[:, 0])).argmin()), x)
        return tuple(e for e in range(self._f.n) if mask >> e & 1)


class MarginalBrackets(ABC):
    """(n,) ``least`` <= smallest marginals <= ``seen_least``, ``seen_most`` <= largest marginals <= ``most``.

    The element whose ratio ``least / most`` is the smallest decides the curvature: it is refined until the smallest
    ratio of all is known within the gap, or the budget is spent. Parts bounded count as the budget's nodes.

    ``owners`` : (n,) 0.. without gaps. ``rests_on`` : what the bounds are.
    ``gap`` : the search stops once the smallest ratio seen is at most ``1 + gap`` times the smallest proved.
    ``against_own`` : the ratio that matters is to the value alone, so the largest marginals are left as that.
    """

    rests_on: str

    def __init__(
        self,
        f: InformationObjective,
        owners: IntArray,
        *,
        gap: float,
        budget: Budget,
        against_own: bool,
        params: CurvatureParams = DEFAULT,
    ) -> None:
        single = f.singletons()  # every marginal without context
        self._f, self._owners, self._single = f, owners, single
        self._gap, self._budget, self._against_own, self._params = gap, budget, against_own, params
        self.least = np.zeros(len(single))
        self.most = single.copy() if against_own else np.full(len(single), np.inf)
        self.seen_least, self.seen_most = single.copy(), single.copy()
        self._done: BoolArray = np.zeros(len(single), dtype=np.bool_)
        self._prepare()

    @abstractmethod
    def _prepare(self) -> None:
        """Make what the searches keep."""

    def run(self) -> Stop:
        """Search until the deciding ratio is known within the gap, or the budget is spent."""
        try:
            stop = self._begin()
            while stop is None:
                stop = self._step()
        except KeyboardInterrupt:
            return self._budget.interrupt()
        return stop

    def marginals(self) -> Marginals:
        """Return the bounds on the marginals, with the contexts that attain them."""
        smallest, largest = self._attaining()
        return Marginals(self.least, self.seen_least, self.seen_most, self.most, tuple(smallest), tuple(largest))

    def _begin(self) -> Stop | None:
        """Prepare all elements before the first one is refined; return a reason to stop at once, if any."""
        return None

    @abstractmethod
    def _refine(self, x: int, target: float) -> None:
        """Raise the ratio proved of ``x`` towards a target, or show it to be smaller; record both and the nodes."""

    @abstractmethod
    def _attaining(self) -> tuple[list[tuple[int, ...]], list[tuple[int, ...]]]:
        """Contexts that attain ``seen_least`` and ``seen_most``, once what an interrupt left unrecorded is recorded."""

    def _step(self) -> Stop | None:
        """Refine the least certain ratio; return why to stop instead."""
        safe, shown = _ratios(self.least, self.most), self._shown()
        target = float(shown.min(initial=np.inf)) / (1 + self._gap)
        open_ = np.flatnonzero((safe < target) & ~self._done)
        if not len(open_):
            if (safe >= shown * (1 - MARGIN)).all():
                return Stop.CLOSED
            return Stop.GAP if safe.min() >= target * (1 - MARGIN) else Stop.EXHAUSTED
        if stop := self._budget.stop():
            return stop
        self._refine(int(open_[safe[open_].argmin()]), target)
        return None

    def _shown(self) -> FloatArray:
        """(n,) ratios attained."""
        return _ratios(self.seen_least, self.seen_most)


def _ratios(small: FloatArray, large: FloatArray) -> FloatArray:
    """Infinite if the large one is 0: such elements restrict nothing."""
    useful = large > 0
    return np.where(useful, small / np.where(useful, large, 1.0), np.inf)
