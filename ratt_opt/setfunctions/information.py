"""What all criteria of the posterior information matrices have in common.

For a set ``S`` of elements, target ``j``'s posterior information is
``Lambda_j(S) = prior[j]^{-1} + sum_{e in S} information[e, j]``. Every criterion
is normalised, non-decreasing in ``S`` and concave in ``Lambda``; each has a file under ``criteria/``.
"""

from __future__ import annotations

from copy import copy
from typing import TYPE_CHECKING, ClassVar, Self

import numpy as np

from ratt_opt._validation import BoolArray, FloatArray, IntArray, readonly
from ratt_opt.setfunctions.base import check_table_size
from ratt_opt.setfunctions.criterion_parts import CriterionParts
from ratt_opt.setfunctions.matrix_input import check_information, check_prior, check_weights

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

__all__ = ["InformationObjective"]


class InformationObjective(CriterionParts):
    """A criterion of the posterior information matrices.

    A criterion of your own subclasses this with :meth:`criterion` (or :meth:`value`, 0 at the prior information) and
    :meth:`gradient`; it must be concave in the information and non-decreasing (relied on, not checked). The
    rest is optional: what a criterion does not state is done by generic bounds, or refused by the name of that part.

    Parameters
    ----------
    prior : (M, d, d) predicted covariances, symmetric positive definite
    information : (E, M, d, d) information of element ``e`` about target ``j``, symmetric
        positive semidefinite; smallest eigenvalue at least ``-1e-9`` times the largest
    weights : (M,) positive importance of each target; ones by default

    Raises
    ------
    InputError : a shape, symmetry, definiteness or sign rule is broken.

    Source: ratt.tex, Section II-A e) and the objective of Section VI.
    """

    __slots__ = ("_baseline", "information", "prior", "prior_information", "weights")

    is_non_decreasing: ClassVar[bool] = True
    """Added information is positive semidefinite, up to the rounding that the input rule admits."""

    def __init__(self, prior: ArrayLike, information: ArrayLike, weights: ArrayLike | None = None) -> None:
        checked = check_prior(prior)
        targets, dimension, _ = checked.shape
        self.prior: FloatArray = readonly(checked)
        self.information: FloatArray = readonly(check_information(information, targets, dimension))
        self.weights: FloatArray = readonly(check_weights(weights, targets))
        inverse = np.linalg.inv(checked)
        self.prior_information: FloatArray = readonly((inverse + np.swapaxes(inverse, -1, -2)) / 2)
        # The baseline is computed by the same formula as the posterior, so that f(empty set) is exactly 0.
        states_value_alone = self.states("value") and not self.states("criterion")
        baseline = np.zeros(targets) if states_value_alone else self.criterion(self.prior_information)
        self._baseline: FloatArray = readonly(baseline)

    def __repr__(self) -> str:
        return f"{type(self).__name__}({self.n} elements, {self.n_targets} targets, d = {self.dimension})"

    @property
    def n(self) -> int:
        """Number of elements E."""
        return int(self.information.shape[0])

    @property
    def n_targets(self) -> int:
        """Number of targets M."""
        return int(self.prior.shape[0])

    @property
    def dimension(self) -> int:
        """Dimension d of a target's state."""
        return int(self.prior.shape[1])

    def restricted_to(self, elements: IntArray) -> Self:
        """The same criterion over some of the elements, in the given order."""
        restricted = copy(self)
        restricted.information = readonly(self.information[elements])
        return restricted

    def with_information(self, information: ArrayLike) -> Self:
        """The same criterion of other elements: (E, M, d, d), checked.

        Raises
        ------
        InputError : as for a criterion made anew.
        """
        other = copy(self)
        other.information = readonly(check_information(information, self.n_targets, self.dimension))
        return other

    def posterior_information(self, subset: IntArray) -> FloatArray:
        """(M, d, d) ``Lambda(S)`` of the given distinct elements, added in ascending order."""
        stacked = np.concatenate([self.prior_information[None], self.information[np.sort(subset)]])
        return np.asarray(np.add.reduce(stacked, axis=0))

    def evaluate(self, membership: BoolArray) -> FloatArray:
        """(K,) values of the subsets in the rows of ``membership`` (K, n)."""
        flat = self.information.reshape(self.n, -1)
        shape = (len(membership), *self.prior.shape)
        if len(membership) == 1:
            return self.value(self.posterior_information(np.flatnonzero(membership[0]))[None])
        # Elements are added one by one so that every batch size rounds alike.
        total = np.broadcast_to(self.prior_information.reshape(1, -1), (len(membership), flat.shape[1])).copy()
        for e in np.flatnonzero(membership.any(axis=0)):
            rows = membership[:, e]
            total[rows] += flat[e]
        return self.value(total.reshape(shape))

    def extensions(self, base: IntArray, candidates: IntArray) -> FloatArray:
        """(C,) values ``f(base + {e})`` for each candidate ``e`` outside ``base``."""
        return self.value(self.posterior_information(base) + self.information[candidates])

    def table(self) -> FloatArray:
        """(2**n,) values of all subsets, target by target, each by doubling over the elements."""
        check_table_size(self.n)
        chunk = min(self.n, 16)  # 2**16 matrices at a time stay in cache
        values = np.empty(2**self.n)
        low = self._lattice(self.prior_information, self.information[:chunk])
        high = self._lattice(np.zeros_like(self.prior_information), self.information[chunk:])
        for block, offset in enumerate(high):
            start = block << chunk
            values[start : start + len(low)] = self.value(low + offset)
        return values

    @staticmethod
    def _lattice(start: FloatArray, steps: FloatArray) -> FloatArray:
        """(2**k, M, d, d) sums of all subsets of the k ``steps``, added to ``start``."""
        sums = np.empty((2 ** len(steps), *start.shape))
        sums[0] = start
        for i, step in enumerate(steps):
            sums[1 << i : 2 << i] = sums[: 1 << i] + step
        return sums
