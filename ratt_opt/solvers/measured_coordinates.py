"""Only the coordinates that are measured: a smaller problem of equal values.

If every information matrix of a target is ``U X U'`` with one basis ``U`` (d, r), sensors tell about ``y = U'x`` alone.
``y`` has the prior ``Q = U'PU`` and the information ``X``. What is left of ``x`` is ``x = K y + rest`` with
``K = P U Q^{-1}``, and no measurement changes the rest. Hence, before minus after,

- ``logdet P - logdet P+ = logdet Q - logdet Q+`` (determinant of a block matrix);
- ``tr C (P - P+) C' = tr C K (Q - Q+) (C K)'``: the trace with the output ``C K``, or, with ``T'T = (C K)'C K``, the
  whole trace of ``T y``;
- ``C P+ C' = C K Q+ (C K)'`` if the output is a part of ``y`` (``C = C U U'``): so is its largest eigenvalue. The
  largest eigenvalue of other parts depends on the rest: such problems stay as they are.

**Rounding.** What is left of the information beside ``U X U'`` has, in units of the prior, at most the size ``SLACK``
over a whole plan, or rounds off with its sums. ``(1 + S)^{-1} - (1 + S')^{-1}`` is at most ``|S - S'|``, so no value
moves by more than that share of the prior's criterion (log-det: of d and the weights). Otherwise the problem stays
as it is.

**Proofs.** A tangent at ``L`` of the smaller problem is the one at ``P^{-1} + U (L - Q^{-1}) U'`` of the other one. So
certificates are written and verified in all coordinates, and rely on nothing here.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from ratt_opt._validation import FloatArray, readonly
from ratt_opt.problem import Problem, check_problem
from ratt_opt.setfunctions.criteria.logdet import LogDetObjective
from ratt_opt.setfunctions.criteria.maxeig import MaxEigenvalueObjective
from ratt_opt.setfunctions.criteria.outputs import StateCriterion
from ratt_opt.setfunctions.criteria.trace import TraceObjective
from ratt_opt.setfunctions.information import symmetric_inverse

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from ratt_opt.setfunctions.information import InformationObjective
    from ratt_opt.solvers.result import MaxMinResult

__all__ = ["MeasuredProblem", "measured_coordinates"]

RANK = 1e-9
"""Directions that hold less than this share of an element's information are no measured ones, if ``SLACK`` agrees."""
SLACK = 1e-12
"""Largest information of a plan outside the measured coordinates, in units of the prior's inverse."""
ROUNDINGS = 16 * float(np.finfo(np.float64).eps)
"""The same as a share of the plan's whole information, whose sums round off as much."""
REGULAR = 1e-6
"""Least ratio of the singular values of ``C K``: below it the change of coordinates would cost digits."""
KINDS = (TraceObjective, MaxEigenvalueObjective)
"""Criteria that may have an output."""


@dataclass(frozen=True, eq=False, init=False, repr=False)
class MeasuredProblem(Problem):
    """A problem in coordinates ``basis[j]' x`` of each target: the same elements, plans, attacks and values.

    ``basis`` : (M, d, r), with r = d where nothing could be left out; ``whole`` : the problem in all d coordinates.
    The other fields are those of a :class:`Problem`.
    """

    basis: FloatArray = field(kw_only=True)
    whole: Problem = field(kw_only=True)

    def __init__(self, *, basis: ArrayLike, whole: Problem, **fields: Any) -> None:
        super().__init__(**fields)
        object.__setattr__(self, "basis", readonly(np.asarray(basis, dtype=np.float64)))
        object.__setattr__(self, "whole", whole)

    @property
    def is_smaller(self) -> bool:
        """Whether coordinates were left out."""
        return bool(self.basis.shape[2] < self.basis.shape[1])

    def lifted(self, result: MaxMinResult) -> MaxMinResult:
        """A result of this problem as one of ``whole``: its proof touches at the same information."""
        if not self.is_smaller:
            return result
        before, proof = self.whole.information_objective.prior_criterion, result.proof
        gap = None
        if before is not None and before > result.lower:
            gap = float((result.upper - result.lower) / (before - result.lower))
        if proof is not None:
            proof = proof.moved(self._lifted)
        return replace(result, posterior_gap=gap, proof=proof)

    def lowered(self, result: MaxMinResult) -> MaxMinResult:
        """An earlier result of ``whole``, or of a similar problem, as one of this problem: to start from it."""
        proof, shape = result.proof, self.whole.information_objective.prior.shape
        if not self.is_smaller or proof is None:
            return result
        if any(cut.point.shape != shape for cut in proof.cuts):
            return replace(result, proof=None)
        return replace(result, proof=proof.moved(self._lowered))

    def _lifted(self, point: FloatArray) -> FloatArray:
        added = self.basis @ (point - self.information_objective.prior_information) @ np.swapaxes(self.basis, -1, -2)
        lifted = self.whole.information_objective.prior_information + added
        return np.asarray((lifted + np.swapaxes(lifted, -1, -2)) / 2)

    def _lowered(self, point: FloatArray) -> FloatArray:
        return symmetric_inverse(np.swapaxes(self.basis, -1, -2) @ symmetric_inverse(point) @ self.basis)


def measured_coordinates(problem: Problem) -> MeasuredProblem:
    """Leave out the coordinates of targets that no element measures.

    A sensor of positions tells about two of the four or six coordinates of a track. If targets differ in how many are
    measured, all keep the largest number. Values, best plans and attacks stay the same, up to rounding. Problems that
    cannot be made smaller stay as they are: a sensor that measures velocities too (Doppler), the max-eigenvalue unless
    its output is measured, and criteria of your own.

    Parameters
    ----------
    problem : E elements, whose objective is a criterion of information matrices

    Raises
    ------
    InputError : ``problem`` is no Problem, or its objective is another set function.
    """
    objective = check_problem(problem).information_objective
    measured = _measured(problem)
    smaller = None if measured is None else _smaller(objective, measured)
    if smaller is None:
        smaller = objective, np.broadcast_to(np.eye(objective.dimension), objective.prior.shape)
    return MeasuredProblem(
        objective=smaller[0],
        robot=problem.robot,
        graph=problem.graph,
        alpha_s=problem.alpha_s,
        alpha_c=problem.alpha_c,
        protected_robots=problem.protected_robots,
        protected_links=problem.protected_links,
        basis=smaller[1],
        whole=problem,
    )


@dataclass(frozen=True, slots=True)
class _Coordinates:
    """``y = basis' x`` of every target, and a left inverse: ``inverse @ basis = 1``; (M, d, r) and (M, r, d)."""

    basis: FloatArray
    inverse: FloatArray

    @property
    def turned(self) -> FloatArray:
        """(M, r, d) ``basis'``."""
        return np.asarray(np.swapaxes(self.basis, -1, -2))

    def mapped(self, change: FloatArray) -> _Coordinates:
        """The coordinates ``change @ y``."""
        turned = np.swapaxes(change, -1, -2)
        return _Coordinates(np.asarray(self.basis @ turned), np.asarray(np.linalg.solve(turned, self.inverse)))


def _measured(problem: Problem) -> _Coordinates | None:
    """The measured coordinates, in units of the prior's deviations; ``None`` where these are all."""
    objective = problem.information_objective
    deviations = np.sqrt(np.diagonal(objective.prior, axis1=-2, axis2=-1))
    scaled = objective.information * deviations[:, :, None] * deviations[:, None, :]
    sizes = np.trace(scaled, axis1=-2, axis2=-1)
    shares = (scaled / np.maximum(sizes, SLACK / RANK)[..., None, None]).sum(axis=0)  # less than SLACK is rounding
    values, vectors = np.linalg.eigh(shares)
    rank = max(1, int((values > RANK).sum(axis=-1).max()))
    if rank == objective.dimension:
        return None
    # Directions of least information lie first; a target with fewer measured ones keeps some that are not.
    own = vectors[..., -rank:]
    onto = own @ np.swapaxes(own, -1, -2)
    correlation = objective.prior / (deviations[:, :, None] * deviations[:, None, :])
    rest = np.linalg.norm(scaled - onto @ scaled @ onto, axis=(-1, -2))
    outside, inside = (_most_of_plans(problem, x * np.linalg.eigvalsh(correlation)[:, -1]) for x in (rest, sizes))
    if (outside > np.maximum(SLACK, ROUNDINGS * inside)).any():
        return None
    return _Coordinates(own / deviations[..., None], np.swapaxes(own, -1, -2) * deviations[:, None, :])


def _most_of_plans(problem: Problem, sizes: FloatArray) -> FloatArray:
    """(M,) the largest sums over a plan's elements, of (E, M) ``sizes``."""
    return np.asarray(np.sum([sizes[choice].max(axis=0) for choice in problem.choices], axis=0))


def _smaller(objective: InformationObjective, measured: _Coordinates) -> tuple[InformationObjective, FloatArray] | None:
    """The criterion in the measured coordinates, or in such that it is one of their whole state, and their basis."""
    if type(objective) is LogDetObjective:
        return _in_coordinates(objective, LogDetObjective, measured)
    kind = next((kind for kind in KINDS if type(objective) in (kind, kind.of_part)), None)
    if kind is None or not isinstance(objective, StateCriterion):
        return None
    output = np.eye(objective.dimension) if objective.output is None else objective.output
    mixed = measured.turned @ objective.prior @ measured.basis
    shown = output @ objective.prior @ measured.basis @ np.linalg.inv(mixed)
    if kind is MaxEigenvalueObjective and not _is_measured(objective.prior, output, shown @ measured.turned):
        return None
    _, sizes, axes = np.linalg.svd(shown, full_matrices=False)
    if (sizes[..., -1] <= REGULAR * sizes[..., 0]).any():
        return None
    if shown.shape[-2] < shown.shape[-1]:
        return _in_coordinates(objective, kind, measured, shown)
    return _in_coordinates(objective, kind, measured.mapped(sizes[..., None] * axes))


def _is_measured(prior: FloatArray, output: FloatArray, seen: FloatArray) -> bool:
    """Whether the output's part ``seen``, which is a function of measured coordinates, is all of it."""
    rest, whole = ((x @ prior @ np.swapaxes(x, -1, -2)) for x in (output - seen, output))
    return bool((np.linalg.norm(rest, axis=(-1, -2)) <= SLACK * np.linalg.norm(whole, axis=(-1, -2))).all())


def _in_coordinates(
    objective: InformationObjective, kind: Any, measured: _Coordinates, output: FloatArray | None = None
) -> tuple[InformationObjective, FloatArray]:
    """A criterion of the measured coordinates, whole or of the part ``output``, and their basis."""
    prior = measured.turned @ objective.prior @ measured.basis
    information = measured.inverse @ objective.information @ np.swapaxes(measured.inverse, -1, -2)
    prior, information = ((x + np.swapaxes(x, -1, -2)) / 2 for x in (prior, information))
    part = {} if output is None else {"output": output}
    return kind(prior, information, objective.weights, **part), measured.basis
