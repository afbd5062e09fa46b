"""Coordinates in which the prior is the identity, if digits would be lost otherwise.

With ``P = R R'`` and ``y = R^{-1} x`` a target has the prior 1 and the information ``R'XR``. However ill-conditioned
``P`` is, sums ``1 + R'XR`` are as well conditioned as what is measured allows: clock seconds and the bias of a
gyroscope beside metres cost no digits.

- Log-determinants: ``log(det P / det P+)`` is the same in all coordinates.
- Trace and largest eigenvalue of ``C P+ C'``: those of the output ``C R``.

Information is given as ``G G'``: what is negative in it, by rounding, is left out.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from ratt_opt.coordinates.changed import ChangedProblem, change_error, keeps_digits, product_error, sizes_of
from ratt_opt.setfunctions.criteria.logdet import LogDetObjective
from ratt_opt.setfunctions.criteria.maxeig import MaxEigenvalueObjective
from ratt_opt.setfunctions.criteria.trace import TraceObjective
from ratt_opt.setfunctions.information import InformationObjective
from ratt_opt.setfunctions.rounding_errors import UNIT, largest_sizes

if TYPE_CHECKING:
    from ratt_opt._validation import FloatArray
    from ratt_opt.problem import Problem

__all__ = ["with_unit_prior"]

KINDS: tuple[Any, ...] = (TraceObjective, MaxEigenvalueObjective)
"""Criteria that may have an output."""


def with_unit_prior(problem: Problem) -> Problem:
    """The problem in coordinates in which the prior is the identity, if values lose many digits in the given ones."""
    objective = problem.objective
    if not isinstance(objective, InformationObjective) or keeps_digits(problem, objective):
        return problem
    root: FloatArray = np.asarray(np.linalg.cholesky(objective.prior), dtype=np.float64)
    changed = _changed(objective, root)
    basis = np.asarray(np.linalg.inv(np.swapaxes(root, -1, -2)))
    made = ChangedProblem.of(problem, changed, basis, _error(problem, objective, changed, root))
    gains_a_digit = made.evaluation_error <= 0.1 * problem.evaluation_error
    return made if gains_a_digit else problem


def _changed(objective: InformationObjective, root: FloatArray) -> InformationObjective:
    """The criterion in the coordinates ``root^{-1} x``."""
    values, vectors = np.linalg.eigh(objective.information)
    factor = np.swapaxes(root, -1, -2) @ (vectors * np.sqrt(np.maximum(values, 0.0))[..., None, :])
    information = factor @ np.swapaxes(factor, -1, -2)
    prior = np.broadcast_to(np.eye(objective.dimension), objective.prior.shape)
    part: dict[str, FloatArray] = {}
    kind = next((kind for kind in KINDS if isinstance(objective, kind)), LogDetObjective)
    if kind is not LogDetObjective:
        part["output"] = root if objective.output is None else objective.output @ root
    changed: InformationObjective = kind(prior, information, objective.weights, **part)
    return changed


def _error(problem: Problem, objective: InformationObjective, changed: InformationObjective, root: FloatArray) -> float:
    """Bound the changes by rounding the root of the prior, the information and the output."""
    d, turned = objective.dimension, np.swapaxes(root, -1, -2)
    prior = sizes_of(root @ turned - objective.prior) + sizes_of(product_error(root, np.eye(d), turned))
    values = np.linalg.eigvalsh(objective.information)
    negative = np.maximum(0.0, -values[..., 0])
    size = sizes_of(root) ** 2
    rounded = size * (negative * d + (20 * d + 8 * d**2 + 16) * UNIT * sizes_of(objective.information))
    information = largest_sizes(rounded[..., None, None], problem.choices)
    output = np.full(len(size), 4 * d * UNIT * d)
    # The root's error counts in the given coordinates, where the prior is not the identity.
    first = change_error(problem, objective, prior, np.zeros_like(prior), output)
    return first + change_error(problem, changed, np.zeros_like(prior), information, output)
