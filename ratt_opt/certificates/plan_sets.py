"""Subject of lower proofs: a plan and a threshold, with the plan's robots as the compiled code reads them."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from ratt_opt.attack.team import LARGEST_DIMENSION, Links, Team
from ratt_opt.attack.thresholds.pricing import PricingProblem
from ratt_opt.certificates.params import DEFAULT
from ratt_opt.setfunctions.criteria.registry import CRITERIA
from ratt_opt.setfunctions.information import triangles

if TYPE_CHECKING:
    from ratt_opt._validation import FloatArray, IntArray
    from ratt_opt.certificates.params import CertificateParams
    from ratt_opt.problem import Problem
    from ratt_opt.setfunctions.information import InformationObjective

__all__ = ["COVERING", "NotClosedError", "PlanSets"]

NEGLIGIBLE = np.sqrt(np.finfo(np.float64).eps) / 2
"""Deviation of a coordinate that does not count, beside those that do: less than rounding, as it is squared."""
COVERING = "covering all attacks"
"""Progress message while a cover is built."""


class NotClosedError(Exception):
    """The proof is too large, or one of its cases is worth less than the threshold."""


@dataclass(frozen=True)
class PlanSets:
    """The plan's robots, of which sets are to be worth the threshold."""

    problem: Problem
    elements: IntArray
    threshold: float
    params: CertificateParams = DEFAULT

    @property
    def objective(self) -> InformationObjective:
        """The criterion."""
        return self.problem.information_objective

    @cached_property
    def plan(self) -> PricingProblem:
        """The plan as the compiled loops read it.

        Raises
        ------
        NotClosedError : states have more than ``LARGEST_DIMENSION`` coordinates.
        """
        if self.objective.dimension > LARGEST_DIMENSION:
            raise NotClosedError
        threat = self.problem.threat
        return PricingProblem(_team(self.objective, self.elements), Links.of(threat), threat)


def _team(objective: InformationObjective, elements: IntArray) -> Team:
    """The plan's robots for compiled loops: these have criteria of whole states, in whatever coordinates."""
    prior, information = objective.prior_information, objective.information[elements]
    if objective.output is not None:
        basis = _counted_coordinates(objective.prior, objective.output)
        prior, information = (np.swapaxes(basis, -1, -2) @ part @ basis for part in (prior, information))
        objective = CRITERIA[objective.name](objective.prior, objective.information[elements], objective.weights)
    return Team(objective, triangles(prior), triangles(information))


def _counted_coordinates(prior: FloatArray, output: FloatArray) -> FloatArray:
    """(M, d, d) ``B`` with states ``B y``: of y what counts, ``C B y``, is as large as y up to a negligible rest."""
    _, sizes, axes = np.linalg.svd(output)
    spread, counted = np.einsum("mia,mab,mib->mi", axes, prior, axes), sizes.shape[1]
    whole = (sizes**2 * spread[:, :counted]).sum(axis=1, keepdims=True)
    rest = NEGLIGIBLE * np.sqrt(whole / spread[:, counted:])
    return np.asarray(np.swapaxes(axes, -1, -2) / np.concatenate([sizes, rest], axis=1)[:, None, :])
