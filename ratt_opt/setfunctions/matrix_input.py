"""The rules that priors, information and weights obey; each refusal names the entry."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ratt_opt._validation import FloatArray, check_finite
from ratt_opt.errors import InputError

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

__all__ = ["check_information", "check_prior", "check_weights"]

SYMMETRY_TOLERANCE = 1e-9
"""Largest accepted asymmetry, and most negative accepted eigenvalue, relative to the matrix (rounding)."""


def _check_symmetric(argument: str, matrices: FloatArray) -> FloatArray:
    """Return the symmetric part of matrices that are symmetric up to rounding."""
    transposed = np.swapaxes(matrices, -1, -2)
    defect = np.abs(matrices - transposed).max(axis=(-1, -2))
    scale = np.abs(matrices).max(axis=(-1, -2))
    bad = np.argwhere(defect > SYMMETRY_TOLERANCE * scale)
    if len(bad):
        where = tuple(int(i) for i in bad[0])
        name = f"{argument}[{', '.join(map(str, where))}]"
        raise InputError(name, "must be symmetric", matrices[where].tolist())
    return (matrices + transposed) / 2


def check_prior(value: ArrayLike) -> FloatArray:
    """Return (M, d, d) symmetric positive definite matrices."""
    prior = check_finite("prior", value, ndim=3)
    if prior.shape[0] < 1:
        raise InputError("prior", "must hold at least one target", f"shape {prior.shape}")
    if prior.shape[1] != prior.shape[2] or prior.shape[1] < 1:
        raise InputError("prior", "must have shape (M, d, d)", f"shape {prior.shape}")
    prior = _check_symmetric("prior", prior)
    for j, eigenvalues in enumerate(np.linalg.eigvalsh(prior)):
        if eigenvalues[0] <= np.finfo(np.float64).eps * abs(eigenvalues[-1]):
            raise InputError(f"prior[{j}]", "must be positive definite", f"smallest eigenvalue {eigenvalues[0]:.6g}")
    return prior


def check_information(value: ArrayLike, targets: int, dimension: int) -> FloatArray:
    """Return (E, M, d, d) matrices, symmetric positive semidefinite up to rounding."""
    information = check_finite("information", value, ndim=4)
    if information.shape[0] < 1:
        raise InputError("information", "must hold at least one element", f"shape {information.shape}")
    if information.shape[1:] != (targets, dimension, dimension):
        rule = f"must have shape (E, {targets}, {dimension}, {dimension}) to match prior"
        raise InputError("information", rule, f"shape {information.shape}")
    information = _check_symmetric("information", information)
    eigenvalues = np.linalg.eigvalsh(information)
    bad = np.argwhere(eigenvalues[..., 0] < -SYMMETRY_TOLERANCE * np.abs(eigenvalues[..., -1]))
    if len(bad):
        e, j = (int(i) for i in bad[0])
        shown = f"eigenvalues from {eigenvalues[e, j, 0]:.6g} to {eigenvalues[e, j, -1]:.6g}"
        raise InputError(f"information[{e}, {j}]", "must be positive semidefinite", shown)
    return information


def check_weights(value: ArrayLike | None, targets: int) -> FloatArray:
    """Return (M,) positive numbers; ones by default."""
    if value is None:
        return np.ones(targets)
    weights = check_finite("weights", value, ndim=1)
    if weights.shape != (targets,):
        raise InputError("weights", f"must have shape ({targets},) to match prior", f"shape {weights.shape}")
    if (weights <= 0).any():
        raise InputError("weights", "must be positive", float(weights.min()))
    return weights
