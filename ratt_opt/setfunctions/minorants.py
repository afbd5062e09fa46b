"""Separable lower bounds on one element's marginal over every context: one score for each choice of each other owner.

Element ``x`` has information ``X`` about a target; a context ``S`` gives posterior information ``L``. A bound like

    marginal(x | S)  >=  constant - sum over other owners i of score[its element, or none of them]

is smallest owner by owner, whatever the joint choice. A criterion that has one states it as ``marginal_minorant``, in
its own file with its proof; these are the records it takes and returns.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from ratt_opt._validation import BoolArray, FloatArray, IntArray

__all__ = ["Choices", "SeparableMinorant"]


@dataclass(frozen=True, slots=True, eq=False)
class Choices:
    """The elements of the owners other than ``x``'s: K elements of R owners about M targets, d by d.

    ``elements`` : (K,); ``owners`` : (K,) position of the owner; ``first`` : (R,) where each owner's elements begin.
    ``inverse`` : (K, M, d, d) of their ``information``, zero where it is not ``regular`` (K, M).
    """

    elements: IntArray
    owners: IntArray
    first: IntArray
    information: FloatArray
    inverse: FloatArray
    regular: BoolArray

    def mixed(self, share: FloatArray) -> FloatArray:
        """(M, d, d) information of a relaxed context: ``share`` (K,) sums to at most 1 over each owner's elements."""
        return np.asarray(np.tensordot(share, self.information, axes=1))

    def scores(self, slope: FloatArray) -> FloatArray:
        """(K,) inner products of each element's information with a slope (M, d, d)."""
        return np.asarray(self.information.reshape(len(self.information), -1) @ slope.ravel())


@dataclass(frozen=True, slots=True, eq=False)
class SeparableMinorant:
    """``marginal >= constant - sum of scores``: ``score`` (K,) of each element, ``absent`` (R,) of no element."""

    constant: float
    score: FloatArray
    absent: FloatArray
