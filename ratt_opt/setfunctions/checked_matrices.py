"""Rules for the data of information criteria: symmetric, definite, and not so far apart that digits are lost."""

from __future__ import annotations

import warnings
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from ratt_opt._validation import BoolArray, FloatArray, check_finite
from ratt_opt.errors import InputError
from ratt_opt.setfunctions.rounding_errors import is_definite, shrunk_to_semidefinite

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

__all__ = ["LARGEST", "WIDEST", "check_information", "check_output", "check_prior", "check_weights", "positive_parts"]

SYMMETRY_TOLERANCE = 1e-9
"""Largest accepted asymmetry, and most negative accepted eigenvalue, relative to the matrix (rounding)."""
SINGLE_TOLERANCE = 1e-6
"""Largest accepted asymmetry of float32 matrices: eight of their roundings."""
LARGEST = 1e100
"""Entries and weights beyond this, priors and weights below its inverse are refused: products of two stay finite."""
LARGEST_OUTPUT = LARGEST**0.5
"""Largest entry of an output, and inverse of the least: squares have the size that entries of a prior may have."""
WIDEST = 2e14
"""Largest eigenvalue of an element's information times that of the prior. Sums of both hold sixteen digits, of which
searches that exchange elements lose a few: beyond this nothing would be left of the prior."""
DEEPEST = 0.01
"""Largest size of a negative eigenvalue of the information times the prior's: some robots' must not outweigh it."""


@dataclass(frozen=True, slots=True, kw_only=True)
class SignParams:
    """Limits from which a small eigenvalue counts as negative, or as positive.

    Negative ones within ``rounded`` or ``slight`` stay as they are, and every published end accounts for them; those
    beyond both are set to 0. Larger limits change fewer of the given matrices, and leave ends further apart.

    ``rounded`` : share of the largest eigenvalue [1]; ``slight`` : share of the prior's inverse [1]
    ``clear`` : share of the largest from which a prior's eigenvalue is positive [1]; below, exact arithmetic decides
    """

    rounded: float = 1e-13
    slight: float = 1e-9
    clear: float = 1e-12


SIGN = SignParams()


def _check_symmetric(argument: str, matrices: FloatArray, *, single: bool) -> FloatArray:
    """Return the symmetric part of matrices that are symmetric up to rounding, to float32 if they are ``single``."""
    tolerance = SINGLE_TOLERANCE if single else SYMMETRY_TOLERANCE
    if np.abs(matrices).max() > LARGEST:
        raise InputError(argument, f"must have entries of size at most {LARGEST:g}", float(np.abs(matrices).max()))
    transposed = np.swapaxes(matrices, -1, -2)
    defect = np.abs(matrices - transposed).max(axis=(-1, -2))
    bad = np.argwhere(defect > tolerance * np.abs(matrices).max(axis=(-1, -2)))
    if len(bad):
        where = tuple(bad[0].tolist())
        raise InputError(f"{argument}[{', '.join(map(str, where))}]", "must be symmetric", matrices[where].tolist())
    return (matrices + transposed) / 2


def _is_single(value: ArrayLike) -> bool:
    return bool(np.asarray(value).dtype == np.float32)


def check_prior(value: ArrayLike) -> FloatArray:
    """Return (M, d, d) symmetric positive definite matrices."""
    prior = check_finite("prior", value, ndim=3)
    if prior.shape[0] < 1:
        raise InputError("prior", "must hold at least one target", f"shape {prior.shape}")
    if prior.shape[1] != prior.shape[2] or prior.shape[1] < 1:
        raise InputError("prior", "must have shape (M, d, d)", f"shape {prior.shape}")
    prior = _check_symmetric("prior", prior, single=_is_single(value))
    for j, eigenvalues in enumerate(np.linalg.eigvalsh(prior)):
        if eigenvalues[0] <= np.finfo(np.float64).eps * abs(eigenvalues[-1]):
            if np.linalg.eigvalsh(_unit_diagonal(prior[j]))[0] > np.finfo(np.float64).eps:
                rule = "must have a condition below 4.5e15: rescale the states, for instance seconds to nanoseconds"
                shown = f"eigenvalues from {eigenvalues[0]:.6g} to {eigenvalues[-1]:.6g}"
                raise InputError(f"prior[{j}]", rule, shown)
            raise InputError(f"prior[{j}]", "must be positive definite", f"smallest eigenvalue {eigenvalues[0]:.6g}")
        if eigenvalues[0] < SIGN.clear * eigenvalues[-1] and not is_definite(prior[j]):
            shown = f"a negative eigenvalue; the smallest is computed as {eigenvalues[0]:.6g}"
            raise InputError(f"prior[{j}]", "must be positive definite", shown)
        if eigenvalues[0] < 1 / LARGEST:
            rule = f"must have eigenvalues of at least {1 / LARGEST:g}"
            raise InputError(f"prior[{j}]", rule, f"smallest eigenvalue {eigenvalues[0]:.6g}")
    return prior


def _unit_diagonal(matrix: FloatArray) -> FloatArray:
    """The matrix in units in which its diagonal is one: definite as before; as it is if an entry is not positive."""
    diagonal = np.diagonal(matrix)
    if diagonal.min() <= 0:
        return matrix
    scale = 1 / np.sqrt(diagonal)
    return np.asarray(matrix * scale[:, None] * scale)


def check_information(value: ArrayLike, prior: FloatArray) -> tuple[FloatArray, int]:
    """Return (E, M, d, d) matrices, semidefinite up to rounding, that leave the prior its digits, and how many were
    repaired.
    """
    targets, dimension = prior.shape[:2]
    information = check_finite("information", value, ndim=4)
    if information.shape[0] < 1:
        raise InputError("information", "must hold at least one element", f"shape {information.shape}")
    if information.shape[1:] != (targets, dimension, dimension):
        rule = f"must have shape (E, {targets}, {dimension}, {dimension}) to match prior"
        raise InputError("information", rule, f"shape {information.shape}")
    single = _is_single(value)
    information = _check_symmetric("information", information, single=single)
    eigenvalues: FloatArray = np.asarray(np.linalg.eigvalsh(information))
    tolerance = SINGLE_TOLERANCE if single else SYMMETRY_TOLERANCE
    bad = np.argwhere(eigenvalues[..., 0] < -tolerance * np.abs(eigenvalues[..., -1]))
    if len(bad):
        e, j = bad[0].tolist()
        shown = f"eigenvalues from {eigenvalues[e, j, 0]:.6g} to {eigenvalues[e, j, -1]:.6g}"
        raise InputError(f"information[{e}, {j}]", "must be positive semidefinite", shown)
    largest = np.asarray(np.linalg.eigvalsh(prior)[:, -1])
    wrong = is_negative(eigenvalues, SYMMETRY_TOLERANCE) if single else np.zeros(eigenvalues.shape[:2], dtype=np.bool_)
    _check_spread(np.where(wrong[..., None], np.maximum(eigenvalues, 0.0), eigenvalues), largest)
    wrong |= is_negative(eigenvalues) & (-eigenvalues[..., 0] * largest > SIGN.slight)
    if wrong.any():
        _warn_of_repair(eigenvalues[wrong], single=single)
        information = positive_parts(information, wrong)
    return shrunk_to_semidefinite(information), int(wrong.sum())


def is_negative(eigenvalues: FloatArray, share: float = SIGN.rounded) -> BoolArray:
    """Tell whether the smallest of (..., d) ascending eigenvalues is below 0 by more than a share of the largest."""
    return np.asarray(eigenvalues[..., 0] < -share * np.abs(eigenvalues[..., -1]))


def positive_parts(matrices: FloatArray, wrong: BoolArray | None = None) -> FloatArray:
    """Symmetric (..., d, d) matrices, the nearest semidefinite ones instead of those that are ``wrong``.

    By default those with a negative eigenvalue that is more than rounding.
    """
    wrong = is_negative(np.asarray(np.linalg.eigvalsh(matrices))) if wrong is None else wrong
    if not wrong.any():
        return matrices
    values, vectors = np.linalg.eigh(matrices[wrong])
    positive = (vectors * np.maximum(values, 0)[:, None, :]) @ np.swapaxes(vectors, -1, -2)
    repaired = matrices.copy()
    repaired[wrong] = (positive + np.swapaxes(positive, -1, -2)) / 2
    return repaired


def _warn_of_repair(eigenvalues: FloatArray, *, single: bool) -> None:
    share = float((eigenvalues[:, 0] / np.abs(eigenvalues[:, -1])).min())
    kind = "float32 rounding repaired" if single else "negative eigenvalues set to 0"
    text = f"information: {kind} in {len(eigenvalues)} matrices (down to {share:.3g} of the largest eigenvalue)"
    warnings.warn(f"{text}; all values are those of the repaired matrices", UserWarning, stacklevel=4)


def _check_spread(eigenvalues: FloatArray, largest: FloatArray) -> None:
    """Refuse information, of (E, M, d) ``eigenvalues``, beside which a prior of (M,) ``largest`` variance is lost."""
    high, low = eigenvalues[..., -1] * largest, -eigenvalues[..., 0] * largest
    rules = (
        (high, WIDEST, "must be at most {} times the inverse of prior[{}], which would lose its digits beside it"),
        (low, DEEPEST, "must not be negative anywhere by more than {} times the inverse of prior[{}]"),
    )
    for sizes, limit, rule in rules:
        bad = np.argwhere(sizes > limit)
        if len(bad):
            e, j = bad[0].tolist()
            raise InputError(f"information[{e}, {j}]", rule.format(f"{limit:g}", j), f"{sizes[e, j]:.3g} times")


def check_weights(value: ArrayLike | None, targets: int) -> FloatArray:
    """Return (M,) positive numbers; ones by default."""
    if value is None:
        return np.ones(targets)
    weights = check_finite("weights", value, ndim=1)
    if weights.shape != (targets,):
        raise InputError("weights", f"must have shape ({targets},) to match prior", f"shape {weights.shape}")
    if (weights <= 0).any():
        raise InputError("weights", "must be positive", float(weights.min()))
    if weights.min() < 1 / LARGEST or weights.max() > LARGEST:
        shown = f"{weights.min():.6g} to {weights.max():.6g}"
        raise InputError("weights", f"must be in [{1 / LARGEST:g}, {LARGEST:g}]", shown)
    return weights


def check_output(output: ArrayLike | None, prior: FloatArray) -> FloatArray:
    """(M, q, d) matrices of full row rank, from (q, d) for all targets or (M, q, d).

    InputError : another shape, an entry whose square is no float, or rows that depend on each other.
    """
    targets, d = prior.shape[:2]
    matrices = given = check_finite("output", output)
    if matrices.ndim == 2:
        matrices = np.broadcast_to(matrices, (targets, *matrices.shape))
    if matrices.ndim != 3 or matrices.shape[0] != targets or matrices.shape[2] != d or not 1 <= matrices.shape[1] <= d:
        raise InputError("output", f"must have shape (q, {d}) or ({targets}, q, {d}), 1 <= q <= {d}", given.shape)
    sizes = np.abs(matrices).max(axis=-1)
    if sizes.max() > LARGEST_OUTPUT or sizes.min() < 1 / LARGEST_OUTPUT:
        rule = f"must have rows whose largest entry has a size in [{1 / LARGEST_OUTPUT:g}, {LARGEST_OUTPUT:g}]"
        raise InputError("output", rule, float(sizes.max() if sizes.max() > LARGEST_OUTPUT else sizes.min()))
    if (np.linalg.matrix_rank(matrices) < matrices.shape[1]).any():
        raise InputError("output", "must have independent rows", given.shape)
    return matrices
