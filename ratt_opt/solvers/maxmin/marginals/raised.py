"""Information that exceeds, beyond rounding, all that an element stands for."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ratt_opt.setfunctions.rounding_errors import UNIT

if TYPE_CHECKING:
    from ratt_opt._validation import FloatArray
    from ratt_opt.solvers.maxmin.levels.elements import Elements

__all__ = ["raised_information"]

EIGENVALUES = 8
"""Roundings, of the matrices' sizes and for each dimension, by which computed eigenvalues may be off."""


def raised_information(elements: Elements) -> FloatArray:
    """(E, M, d, d) of each undominated element no less than of any that it stands for, and no less than zero.

    Both hold up to rounding already: what is missing is added to the eigenvalues. Then no set of elements tells more
    than that of the elements they stand for, and gains diminish.
    """
    whole = elements.whole.information_objective.information
    information = elements.problem.information_objective.information
    identity = np.eye(information.shape[-1])
    added = np.empty(information.shape[:2])
    for k, members in enumerate(elements.stands_for):
        others = np.concatenate([whole[list(members)], np.zeros((1, *whole.shape[1:]))])
        apart = information[k] - others
        sizes = np.linalg.norm(information[k], axis=(-2, -1)) + np.linalg.norm(others, axis=(-2, -1))
        missing = EIGENVALUES * len(identity) * UNIT * sizes - np.linalg.eigvalsh(apart)[..., 0]
        missing[~apart.any(axis=(-2, -1))] = 0.0
        added[k] = np.maximum(missing, 0.0).max(axis=0)
    return np.asarray(information + added[..., None, None] * identity)
