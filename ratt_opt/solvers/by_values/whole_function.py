"""A submodular function that is known by its values alone, as a sum of one part."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ratt_opt.setfunctions.decomposition import Decomposition, Overestimator, rounded_up
from ratt_opt.setfunctions.metered import unmetered
from ratt_opt.solvers.by_values.reliance import refuse_larger_gains

if TYPE_CHECKING:
    from ratt_opt._validation import BoolArray, FloatArray, IntArray
    from ratt_opt.setfunctions.base import SetFunction
    from ratt_opt.setfunctions.decomposition import PartBounds

__all__ = ["WholeFunction", "parts_of"]


class WholeFunction(Decomposition):
    """One part that every element touches; bounded by ``f(S) + sum of gains`` (Nemhauser, Wolsey and Fisher 1978)."""

    __slots__ = ("_alone", "_f")

    def __init__(self, f: SetFunction) -> None:
        self._f = f
        self._alone: FloatArray | None = None

    @property
    def n_parts(self) -> int:
        """One."""
        return 1

    @property
    def weights(self) -> FloatArray:
        """(1,) one."""
        return np.ones(1)

    def touching(self, part: int) -> IntArray:  # noqa: ARG002
        """(n,) all elements."""
        return np.arange(self._f.n)

    def part_values(self, part: int, membership: BoolArray) -> FloatArray:  # noqa: ARG002
        """(K,) values of the function."""
        return self._f.evaluate(membership)

    def marginal_bounds(self, part: int) -> FloatArray:  # noqa: ARG002
        """(n,) the values alone, less that of nothing."""
        return rounded_up(self._f.singletons() - self._f(()))

    def overestimator(
        self,
        part: int,  # noqa: ARG002
        share: FloatArray,
        effort: PartBounds | None = None,  # noqa: ARG002
    ) -> Overestimator:
        """The best of three sets ``S``: nothing, the elements of a half or more, and those of a third or more."""
        bases = [np.array([], dtype=np.int64), *(np.flatnonzero(share >= level) for level in (1 / 2, 1 / 3))]
        return min((self._from(base) for base in bases), key=lambda bound: bound.at(share))

    def _from(self, base: IntArray) -> Overestimator:
        gains = np.zeros(self._f.n)
        others = np.setdiff1d(np.arange(self._f.n), base)
        value = self._f(base.tolist())
        added = self._f.extensions(base, others) - value
        if self._alone is None:
            self._alone = self._f.singletons() - self._f(())
        refuse_larger_gains(unmetered(self._f), base, others, added, self._alone[others])
        gains[others] = rounded_up(added)
        return Overestimator(value, gains)


def parts_of(f: SetFunction, asked: SetFunction) -> Decomposition | None:
    """The parts of ``f``; all of it as one part if it is submodular, valued as ``asked``; ``None`` otherwise."""
    parts = f.decomposition()
    if parts is not None and parts.is_sum:
        return parts
    return WholeFunction(asked) if f.is_submodular else None
