"""Covariances of outputs, and their traces, in C (``native/src/outputs.c``)."""

from __future__ import annotations

from math import prod
from typing import TYPE_CHECKING

import numpy as np

from ratt_opt._blocks import blocks
from ratt_opt.native.library import address, checked
from ratt_opt.native.loops import loops

if TYPE_CHECKING:
    from ratt_opt._validation import FloatArray

__all__ = ["output_covariances", "output_traces"]


def output_traces(matrices: FloatArray, output: FloatArray) -> FloatArray:
    """``tr(C_j L_j^{-1} C_j')`` of (..., M, d, d) positive definite matrices and outputs (M, q, d): (..., M)."""
    return np.asarray(np.einsum("...aa->...", output_covariances(matrices, output)))


def output_covariances(matrices: FloatArray, output: FloatArray) -> FloatArray:
    """``C_j L_j^{-1} C_j'`` likewise: (..., M, q, q).

    Raises ``InputError`` : shapes of matrices and outputs differ, or a type is another.
    """
    targets, q, d = output.shape
    flat = np.ascontiguousarray(matrices).reshape(prod(matrices.shape[:-3]), *matrices.shape[-3:])
    checked("matrices", flat, np.float64, (len(flat), targets, d, d))
    own = checked("output", np.ascontiguousarray(output), np.float64, (targets, q, d))
    found, spare = np.empty((len(flat), targets, q, q)), np.empty((d + q, d))
    given, where, others = address(flat), address(found), (address(own), address(spare))
    for first, last in blocks(len(flat), targets * d**3):
        some, to = given + first * flat.strides[0], where + first * found.strides[0]
        loops.output_covariances(last - first, targets, q, d, some, *others, to)
    return found.reshape(*matrices.shape[:-2], q, q)
