"""Coordinates in which the prior is the identity, if digits would be lost otherwise.

With ``P = R R'`` and ``y = R^{-1} x`` a target has the prior 1 and the information ``R'XR``. However ill-conditioned
``P`` is, sums ``1 + R'XR`` are as well conditioned as what is measured allows: clock seconds and the bias of a
gyroscope beside metres cost no digits.

- Log-determinants: ``log(det P / det P+)`` is the same in all coordinates.
- Trace and largest eigenvalue of ``C P+ C'``: those of the output ``C R``.

Information is given as ``G G'``: what is negative in it, by rounding, is left out.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any, TypeVar
from weakref import WeakKeyDictionary

import numpy as np

from ratt_opt.coordinates.changed import ChangedProblem, change_error, product_error, sizes_of
from ratt_opt.problem import Problem
from ratt_opt.setfunctions.criteria.logdet import LogDetObjective
from ratt_opt.setfunctions.criteria.maxeig import MaxEigenvalueObjective
from ratt_opt.setfunctions.criteria.trace import TraceObjective
from ratt_opt.setfunctions.information import InformationObjective
from ratt_opt.setfunctions.rounding_errors import UNIT, largest_sizes

if TYPE_CHECKING:
    from ratt_opt._validation import FloatArray, IntArray

__all__ = ["with_unit_prior"]

AnyProblem = TypeVar("AnyProblem", bound=Problem)

KEPT = "_with_unit_prior"
TOLERABLE = 1e-9
"""Error of values, as a share of the criterion before any measurement, that is no reason to change coordinates."""
WORTHWHILE = 0.1
"""Largest share of the error that may remain."""
KINDS: tuple[Any, ...] = (TraceObjective, MaxEigenvalueObjective)
"""Criteria that may have an output."""


def with_unit_prior(problem: AnyProblem) -> AnyProblem | ChangedProblem:
    """The problem in coordinates in which the prior is the identity, if values lose many digits in the given ones."""
    kept = vars(problem)  # it is asked for by every attack
    if KEPT not in kept:
        kept[KEPT] = _chosen(problem)
    found: AnyProblem | ChangedProblem = kept[KEPT]
    return found


@dataclass(frozen=True, slots=True, kw_only=True)
class _Change:
    """A criterion in other coordinates ``basis[j]' x`` of targets; the same for all problems with these owners.

    ``before`` : by how much exact values had changed before, ``error`` : by how much they do now
    ``objective`` : ``None`` if the coordinates stay
    """

    robot: IntArray
    before: float
    objective: InformationObjective | None = None
    basis: FloatArray | None = None
    error: float = 0.0

    def is_for(self, problem: Problem) -> bool:
        """Tell whether the change is the one of a problem with the same criterion."""
        return self.before == getattr(problem, "change_error", 0.0) and np.array_equal(self.robot, problem.robot)

    def of(self, problem: Problem) -> Problem:
        """The problem in these coordinates."""
        if self.objective is None or self.basis is None:
            return problem
        if isinstance(problem, ChangedProblem):
            error = problem.change_error + self.error
            return ChangedProblem.of(problem.whole, self.objective, problem.basis @ self.basis, error)
        return ChangedProblem.of(problem, self.objective, self.basis, self.error)


def _chosen(problem: Problem) -> Problem:
    objective = problem.objective
    if not isinstance(objective, InformationObjective):
        return problem
    change = _CHANGES.get(objective)
    if change is None or not change.is_for(problem):
        change = _CHANGES[objective] = _change(problem, objective)
    return change.of(problem)


_CHANGES: WeakKeyDictionary[InformationObjective, _Change] = WeakKeyDictionary()
"""Problems that differ in their threats share a change of coordinates: one of many elements takes a second."""


def _change(problem: Problem, objective: InformationObjective) -> _Change:
    scale = objective.error_scale(sizes_of(objective.prior))
    stay = _Change(robot=problem.robot, before=getattr(problem, "change_error", 0.0))
    if scale is None or problem.evaluation_error <= TOLERABLE * float(objective.combine(scale)):
        return stay
    root: FloatArray = np.asarray(np.linalg.cholesky(objective.prior), dtype=np.float64)
    changed = _changed(objective, root)
    basis = np.asarray(np.linalg.inv(np.swapaxes(root, -1, -2)))
    change = replace(stay, objective=changed, basis=basis, error=_error(problem, objective, changed, root))
    return change if change.of(problem).evaluation_error <= WORTHWHILE * problem.evaluation_error else stay


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
