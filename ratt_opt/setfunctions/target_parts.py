"""The criteria of posterior information, target by target, as parts of a set function."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ratt_opt._blocks import blocks
from ratt_opt.setfunctions.decomposition import Decomposition, Overestimator

if TYPE_CHECKING:
    from ratt_opt._validation import BoolArray, FloatArray, IntArray
    from ratt_opt.setfunctions.criterion_parts import CriterionParts
    from ratt_opt.setfunctions.decomposition import PartBounds

__all__ = ["TargetParts"]


class TargetParts(Decomposition):
    """One part for each target; the criterion's own weights are in the parts' values.

    ``top`` : what the criterion of each target is taken from: the target's own before any measurement, or (the least
    part is the value) the worst target's
    """

    __slots__ = ("_is_sum", "_marginals", "_objective", "_top", "_touching")

    def __init__(self, objective: CriterionParts, *, top: FloatArray, is_sum: bool) -> None:
        self._objective, self._top, self._is_sum = objective, top, is_sum
        tells: BoolArray = np.asarray(objective.information.any(axis=(-2, -1)))
        self._touching = [np.flatnonzero(about) for about in tells.T]
        self._marginals: FloatArray | None = None

    @property
    def is_sum(self) -> bool:
        """True if targets add up."""
        return self._is_sum

    @property
    def n_parts(self) -> int:
        """Number of targets M."""
        return len(self._touching)

    @property
    def weights(self) -> FloatArray:
        """(M,) ones."""
        return np.ones(self.n_parts)

    def touching(self, part: int) -> IntArray:
        """(k,) elements that tell anything about a target."""
        return self._touching[part]

    def part_values(self, part: int, membership: BoolArray) -> FloatArray:
        """(K,) what each subset in the rows of ``membership`` (K, k) takes off one target's criterion."""
        objective = self._objective
        information = objective.information[self._touching[part], part]
        values = np.empty(len(membership))
        for first, last in blocks(len(membership), 64 * information[0].size):  # matrices stay in some megabytes
            rows = membership[first:last].astype(np.float64)
            added = np.tensordot(rows, information, axes=1)
            criterion = objective.target_criterion(objective.prior_information[part] + added, part)
            values[first:last] = self._top[part] - criterion
        return values

    def marginal_bounds(self, part: int) -> FloatArray:
        """(k,) no element takes more off one target's criterion, whatever is known of it."""
        if self._marginals is None:
            self._marginals = self._objective.largest_marginals()
        return np.asarray(self._marginals[self._touching[part], part])

    def overestimator(  # its formula takes no effort
        self,
        part: int,
        share: FloatArray,
        effort: PartBounds | None = None,  # noqa: ARG002
    ) -> Overestimator:
        """The tangent of one target's concave value at the information of a fractional point (k,)."""
        objective = self._objective
        information = objective.information[self._touching[part], part]
        point = objective.prior_information.copy()
        point[part] += np.tensordot(share, information, axes=1)
        slope, constant = self._tangent(point, part)
        gains = np.maximum(np.einsum("ekl,kl->e", information, slope), 0.0)
        constant += float((slope * objective.prior_information[part]).sum())
        return Overestimator(constant + objective.rounding, gains)

    def _tangent(self, point: FloatArray, part: int) -> tuple[FloatArray, float]:
        """Slope (d, d) and offset of a linear bound of one target's value by its information."""
        if not self._is_sum:
            tangent = self._objective.tangent(point, part)
            return tangent.slope[part], tangent.offset
        slope = self._objective.gradient(point)[part]
        criterion = float(self._objective.target_criterion(point[part : part + 1], part)[0])
        return slope, float(self._top[part]) - criterion - float((slope * point[part]).sum())
