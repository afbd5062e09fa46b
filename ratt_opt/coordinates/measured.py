"""Measured coordinates alone: a smaller problem of equal values.

If every information matrix of a target is ``U X U'`` with one basis ``U`` (d, r), sensors tell about ``y = U'x`` alone.
``y`` has the prior ``Q = U'PU`` and the information ``X``. The rest of ``x`` follows: ``x = K y + rest`` with
``K = P U Q^{-1}``, and no measurement changes the rest. Hence, before minus after,

- ``logdet P - logdet P+ = logdet Q - logdet Q+`` (determinant of a block matrix);
- ``tr C (P - P+) C' = tr C K (Q - Q+) (C K)'``: the trace with the output ``C K``, or, with ``T'T = (C K)'C K``, the
  whole trace of ``T y``;
- ``C P+ C' = C K Q+ (C K)'`` if the output is a part of ``y`` (``C = C U U'``): so is its largest eigenvalue. The
  largest eigenvalue of other parts depends on the rest: such problems stay as they are.

**Rounding.** The rest of the information, beside ``U X U'`` has, in units of the prior, at most the size ``SLACK``
over a whole plan, or rounds off with its sums; if ``U`` selects coordinates, there is none, and ``Q`` and ``X`` are
exact. ``(1 + S)^{-1} - (1 + S')^{-1}`` is at most ``|S - S'|``, so no value moves by more than that share of the
prior's criterion (log-det: of d and the weights). Otherwise the problem stays as it is.

**Proofs.** A tangent at ``L`` of the smaller problem is the one at ``P^{-1} + U (L - Q^{-1}) U'`` of the other one. So
certificates are written and verified in all coordinates, and rely on nothing here.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from ratt_opt.coordinates.changed import ChangedProblem, change_error, keeps_digits, product_error, selects, sizes_of
from ratt_opt.problem import check_problem
from ratt_opt.setfunctions.checked_matrices import positive_parts
from ratt_opt.setfunctions.criteria.logdet import LogDetObjective
from ratt_opt.setfunctions.criteria.maxeig import MaxEigenvalueObjective
from ratt_opt.setfunctions.criteria.trace import TraceObjective
from ratt_opt.setfunctions.information import symmetric_inverse
from ratt_opt.setfunctions.rounding_errors import UNIT, largest_sizes

if TYPE_CHECKING:
    from ratt_opt._validation import FloatArray
    from ratt_opt.problem import Problem
    from ratt_opt.setfunctions.information import InformationObjective

__all__ = ["measured_coordinates"]

SLACK = 1e-12
"""Largest information of a plan outside the measured coordinates, in units of the prior's inverse."""
ROUNDINGS = 16 * float(np.finfo(np.float64).eps)
"""Rounding as a share of the plan's whole information, whose sums round off as much."""
KINDS = (TraceObjective, MaxEigenvalueObjective)
"""Criteria that may have an output."""


def measured_coordinates(problem: Problem) -> ChangedProblem:
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
    objective = check_problem(problem, knows_at_most=True).information_objective
    measured = _measured(problem)
    made = None if measured is None else _made(problem, measured)
    if measured is not None and selects(measured.turned) and (made is None or not keeps_digits(made, objective)):
        ways = made, _made(problem, measured, as_output=True)
        made = min((way for way in ways if way), key=lambda way: way.evaluation_error, default=None)
    if made is None:
        identity = np.broadcast_to(np.eye(objective.dimension), objective.prior.shape)
        return ChangedProblem.of(problem, objective, identity)
    return made


def _made(problem: Problem, measured: _Coordinates, *, as_output: bool = False) -> ChangedProblem | None:
    """The problem in the measured coordinates; ``as_output`` : of the criterion, even if they could be mapped to it."""
    change = _change(problem.information_objective, measured, as_output=as_output)
    if change is None:
        return None
    smaller, coordinates, outputs = change
    return ChangedProblem.of(problem, smaller, coordinates.basis, _error(problem, smaller, coordinates, outputs))


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
    """The measured coordinates, in units of the prior's deviations; ``None`` if these are all."""
    objective = problem.information_objective
    deviations = np.sqrt(np.diagonal(objective.prior, axis1=-2, axis2=-1))
    scaled = objective.information * deviations[:, :, None] * deviations[:, None, :]
    sizes = np.trace(scaled, axis1=-2, axis2=-1)
    least = 1e-9  # share of an element's information in a measured direction, far above rounding; SLACK checks the rest
    shares = (scaled / np.maximum(sizes, SLACK / least)[..., None, None]).sum(axis=0)  # less than SLACK is rounding
    values, vectors = np.linalg.eigh(shares)
    rank = max(1, int((values > least).sum(axis=-1).max()))
    if rank == objective.dimension:
        return None
    axes = np.flatnonzero(objective.information.any(axis=(0, 1, 2)))
    if len(axes) == rank:  # nothing is rounded
        own = np.broadcast_to(np.eye(objective.dimension)[:, axes], (*objective.prior.shape[:-1], rank))
        return _Coordinates(own, np.swapaxes(own, -1, -2))
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


_Change = tuple["InformationObjective", _Coordinates, "FloatArray | None"]
"""A criterion, its coordinates, and (M,) what computing ``C K`` rounds off of the trace; ``None`` for log-det."""


def _change(objective: InformationObjective, measured: _Coordinates, *, as_output: bool) -> _Change | None:
    """The criterion in the measured coordinates, or in such that it is one of their whole state."""
    if type(objective) is LogDetObjective:
        return _in_coordinates(objective, LogDetObjective, measured), measured, None
    kind = type(objective)
    if kind not in KINDS:
        return None
    output = np.eye(objective.dimension) if objective.output is None else objective.output
    shown, rounded = _shown(objective, measured, output)
    if kind is MaxEigenvalueObjective and not _is_measured(objective.prior, output, shown @ measured.turned):
        return None
    _, sizes, axes = np.linalg.svd(shown, full_matrices=False)
    regular = 0.0 if as_output else 1e-6  # least ratio of singular values: below it the change would cost digits
    if (sizes[..., -1] <= regular * sizes[..., 0]).any():
        return None
    if shown.shape[-2] >= shown.shape[-1]:
        square = sizes[..., None] * axes
        mapped = measured if as_output else measured.mapped(square)
        return _in_coordinates(objective, kind, mapped, square if as_output else None), mapped, rounded
    return _in_coordinates(objective, kind, measured, shown), measured, rounded


def _shown(
    objective: InformationObjective, measured: _Coordinates, output: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """``C K``, and (M,) what computing it rounds off of the trace.

    ``K = P U D^{-1} q^{-1} D^{-1}`` with ``Q = D q D`` and ``D`` powers of two near the deviations: no digit is lost.
    """
    across = objective.prior @ measured.basis
    mixed = measured.turned @ across
    units = np.exp2(np.round(np.log2(np.diagonal(mixed, axis1=-2, axis2=-1)) / 2))
    even = mixed / (units[..., :, None] * units[..., None, :])
    followed = across / units[..., None, :] @ np.linalg.inv(even)
    condition = sizes_of(even) * sizes_of(symmetric_inverse(even))
    sizes = (sizes_of(output) * sizes_of(followed)) ** 2 * sizes_of(even)
    return output @ followed / units[..., None, :], 16 * objective.dimension**2 * UNIT * condition * sizes


def _is_measured(prior: FloatArray, output: FloatArray, seen: FloatArray) -> bool:
    """Tell whether the output's part ``seen``, a function of measured coordinates, is all of it."""
    rest, whole = ((x @ prior @ np.swapaxes(x, -1, -2)) for x in (output - seen, output))
    return bool((np.linalg.norm(rest, axis=(-1, -2)) <= SLACK * np.linalg.norm(whole, axis=(-1, -2))).all())


def _in_coordinates(
    objective: InformationObjective, kind: Any, measured: _Coordinates, output: FloatArray | None = None
) -> InformationObjective:
    """A criterion of the measured coordinates, whole or of the part ``output``."""
    prior = measured.turned @ objective.prior @ measured.basis
    information = measured.inverse @ objective.information @ np.swapaxes(measured.inverse, -1, -2)
    prior, information = ((x + np.swapaxes(x, -1, -2)) / 2 for x in (prior, information))
    information = positive_parts(information)
    part = {} if output is None else {"output": output}
    made: InformationObjective = kind(prior, information, objective.weights, **part)
    return made


def _error(
    problem: Problem, smaller: InformationObjective, coordinates: _Coordinates, outputs: FloatArray | None
) -> float:
    """Bound the changes by rounding and by what was left out beside the measured coordinates."""
    objective, (basis, inverse) = problem.information_objective, (coordinates.basis, coordinates.inverse)
    r = basis.shape[-1]
    prior = sizes_of(product_error(coordinates.turned, objective.prior, basis))
    one = sizes_of(inverse @ basis - np.eye(r)) + sizes_of(product_error(inverse, np.eye(basis.shape[-2]), basis))
    rounded = sizes_of(product_error(inverse, objective.information, np.swapaxes(inverse, -1, -2)))
    rounded += 3 * one * sizes_of(smaller.information)
    mapped = inverse @ objective.information @ np.swapaxes(inverse, -1, -2)
    rounded += sizes_of(smaller.information - mapped)  # the symmetric part was taken, and the nearest semidefinite one
    information = _most_of_plans(problem, rounded)
    size = sizes_of(smaller.prior) * largest_sizes(smaller.information, problem.choices)
    share = np.maximum(SLACK, ROUNDINGS * size) * (not selects(coordinates.turned))  # of what lies outside
    scale = smaller.error_scale(sizes_of(smaller.prior))
    if outputs is not None and scale is not None:
        share = share + smaller.weights * outputs / scale
    return change_error(problem, smaller, prior, information, share)
