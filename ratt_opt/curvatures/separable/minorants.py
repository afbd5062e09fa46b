"""Separable lower bounds on one element's marginal over every context: one score for each choice of each other robot.

Element ``x`` has information ``X`` about a target; a context ``S`` gives posterior information ``L`` and covariance
``P = L^{-1}``. Both bounds touch the marginal where they are made, and have the form

    marginal(x | S)  >=  constant - sum over other robots i of score[its element, or none of them].

**Log-det.** ``logdet(L + X) - logdet L`` is convex in ``L``: its second derivative along ``D`` is
``tr(P D P D) - tr(B D B D)`` with ``B = (L + X)^{-1} <= P``, and ``tr(ADAD) >= tr(BDBD)`` whenever ``A >= B >= 0``.
So a tangent at any ``L0`` bounds it; its slope ``(L0 + X)^{-1} - P0`` is negative semidefinite, so more information
only lowers it.

**Trace.** ``m(P) = tr P - tr (P^{-1} + X)^{-1}`` is convex in ``P`` (the parallel sum is concave), so
``m(P) >= m(P0) + <G, P - P0>`` with ``G = 1 - (1 + X P0)^{-1} (1 + P0 X)^{-1}``. Split ``G = G+ - sum_k g_k n_k n_k'``
into its parts of each sign.

- ``<G+, L^{-1}> >= 2 <G+, Y> - <Y G+ Y, L>`` for any symmetric ``Y``, since ``L^{-1} >= 2Y - Y L Y``; linear in ``L``.
- ``n' L^{-1} n <= w_0' prior w_0 + sum_i w_i' I_i^{-1} w_i`` for any ``w`` with ``w_0 + sum_i w_i = n`` (the inverse
  of a sum is the smallest such sum: parallel resistors), with equality for the harmonic shares used here. The share of
  a robot that is absent, or whose information is singular, falls to the prior; by convexity of the square,
  ``|w_0 + sum_absent w_i|^2 <= |w_0|^2 / t_0 + sum_absent |w_i|^2 / t_i`` in the prior's norm, ``t_0 + sum t_i = 1``.

An inexact ``P0``, ``Y`` or ``w`` costs strength, never validity.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from ratt_opt.setfunctions.criteria.logdet import LogDetObjective
from ratt_opt.setfunctions.criteria.trace import TraceObjective

if TYPE_CHECKING:
    from ratt_opt._validation import BoolArray, FloatArray, IntArray
    from ratt_opt.setfunctions.information import InformationObjective

__all__ = ["Others", "Separable", "minorant", "others_of"]

WORST_CONDITION = 1e6
"""Information matrices beyond this condition count as singular: their inverse is not trusted to nine digits."""
PRIOR_SHARE = 0.25
"""``t_0`` above; the robots share the rest."""


@dataclass(frozen=True, slots=True)
class Others:
    """The elements of the robots other than ``x``'s: K elements of R robots about M targets, d by d.

    ``elements`` : (K,); ``robot`` : (K,) position of the owner; ``first`` : (R,) where each robot's elements begin.
    ``inverse`` : (K, M, d, d), zero where ``regular`` (K, M) is false.
    """

    elements: IntArray
    robot: IntArray
    first: IntArray
    information: FloatArray
    inverse: FloatArray
    regular: BoolArray


@dataclass(frozen=True, slots=True)
class Separable:
    """``marginal >= constant - sum of scores``: ``score`` (K,) of each element, ``absent`` (R,) of no element."""

    constant: float
    score: FloatArray
    absent: FloatArray


def others_of(f: InformationObjective, owners: IntArray, x: int) -> Others:
    """The other robots' elements, robot by robot."""
    robots = [np.flatnonzero(owners == i) for i in np.unique(owners) if i != owners[x]]
    elements = np.concatenate([*robots, np.array([], dtype=np.int64)])
    sizes = np.array([len(own) for own in robots], dtype=np.int64)
    information = f.information[elements]
    eigenvalues = np.linalg.eigvalsh(information)
    regular = eigenvalues[..., 0] * WORST_CONDITION > eigenvalues[..., -1]
    inverse = np.zeros_like(information)
    inverse[regular] = np.linalg.inv(information[regular])
    first = np.concatenate([[0], np.cumsum(sizes)[:-1]]).astype(np.int64)[: len(sizes)]
    return Others(elements, np.repeat(np.arange(len(sizes)), sizes), first, information, inverse, regular)


def minorant(f: InformationObjective, x: int, others: Others, share: FloatArray) -> Separable:
    """The bound that touches the marginal at a relaxed context: ``share`` (K,) sums to 1 over each robot's elements."""
    posterior = f.prior_information + np.tensordot(share, others.information, axes=1)
    if isinstance(f, LogDetObjective):
        return _log_det(f, f.information[x], others, posterior)
    assert isinstance(f, TraceObjective)
    return _trace(f, f.information[x], others, share, posterior)


def _log_det(f: LogDetObjective, added: FloatArray, others: Others, posterior: FloatArray) -> Separable:
    both = posterior + added
    value = float((f.weights * (np.linalg.slogdet(both)[1] - np.linalg.slogdet(posterior)[1])).sum())
    slope = f.weights[:, None, None] * (np.linalg.inv(posterior) - np.linalg.inv(both))
    score = _inner(others.information, slope)
    constant = value + float((slope * (posterior - f.prior_information)).sum())
    return Separable(constant, np.maximum(score, 0.0), np.zeros(len(others.first)))


def _trace(f: TraceObjective, added: FloatArray, others: Others, share: FloatArray, posterior: FloatArray) -> Separable:
    weights = f.weights[:, None, None]
    covariance = _inverse(posterior)
    after = _inverse(posterior + added)
    # (1 + P X)^{-1} = (L + X)^{-1} L, hence G = 1 - L B B L with B = (L + X)^{-1}.
    shrunk = after @ posterior
    slope = np.eye(f.dimension) - np.swapaxes(shrunk, -1, -2) @ shrunk
    value = np.trace(covariance - after, axis1=-2, axis2=-1)
    gains, axes = np.linalg.eigh(slope)
    rising = (axes * np.clip(gains, 0.0, None)[:, None, :]) @ np.swapaxes(axes, -1, -2)
    falling = np.clip(-gains, 0.0, None) * f.weights[:, None]
    tangent = weights * (covariance @ rising @ covariance)
    constant = (f.weights * (value - _pairs(slope, covariance) + 2 * _pairs(rising, covariance))).sum()
    constant -= float((tangent * f.prior_information).sum())
    score = _inner(others.information, tangent)
    if not falling.any():
        return Separable(float(constant), score, np.zeros(len(others.first)))
    upper = _inverse_majorant(f, others, share, axes, falling)
    return Separable(float(constant) - upper.constant, score + upper.score, upper.absent)


def _inverse_majorant(
    f: TraceObjective, others: Others, share: FloatArray, axes: FloatArray, strength: FloatArray
) -> Separable:
    """``sum_jk strength[j, k] n_jk' L^{-1} n_jk <= constant + sum of scores``, ``n_jk`` the columns of ``axes``."""
    weighted = share[:, None] * others.regular
    mass = np.add.reduceat(weighted, others.first, axis=0)
    mean_inverse = np.add.reduceat(weighted[..., None, None] * others.inverse, others.first, axis=0)
    usable = mass > 0
    harmonic = np.zeros_like(mean_inverse)
    harmonic[usable] = mass[usable][:, None, None] * np.linalg.inv(mean_inverse[usable])
    potential = np.linalg.inv(f.prior_information + harmonic.sum(axis=0)) @ axes
    flow = harmonic @ potential  # (R, M, d, d): w_i of each axis, in columns
    rest = axes - flow.sum(axis=0)  # w_0, so that the shares add up exactly as computed
    cost = np.einsum("rmak,mab,rmbk,mk->rm", flow, f.prior, flow, strength, optimize=True)
    # t_i in proportion to the root of the cost makes the sum of the reserves smallest.
    root = np.sqrt(np.maximum(cost, 0.0))
    reserve = root * root.sum(axis=0) / (1 - PRIOR_SHARE)
    outer = np.einsum("rmak,mk,rmbk->rmab", flow, strength, flow, optimize=True)
    own = (others.inverse * outer[others.robot]).sum(axis=(-1, -2))
    score = np.where(others.regular, np.minimum(own, reserve[others.robot]), reserve[others.robot]).sum(axis=-1)
    constant = float(np.einsum("mak,mab,mbk,mk->", rest, f.prior, rest, strength)) / PRIOR_SHARE
    return Separable(constant, score, reserve.sum(axis=-1))


def _inner(information: FloatArray, slope: FloatArray) -> FloatArray:
    """(K,) inner products over targets."""
    return np.asarray(information.reshape(len(information), -1) @ slope.ravel())


def _pairs(first: FloatArray, second: FloatArray) -> FloatArray:
    """(M,) inner products."""
    return np.asarray((first * second).sum(axis=(-1, -2)))


def _inverse(matrices: FloatArray) -> FloatArray:
    inverse = np.linalg.inv(matrices)
    return np.asarray((inverse + np.swapaxes(inverse, -1, -2)) / 2)
