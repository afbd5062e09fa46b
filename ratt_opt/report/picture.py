"""What the map of a scenario shows under one plan and one attack."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ratt_opt.report.map import Picture
from ratt_opt.setfunctions.information import InformationObjective

if TYPE_CHECKING:
    from ratt_opt.main_job import PlanAssessment
    from ratt_opt.problem import Problem
    from ratt_opt.scenario.model import Scenario

__all__ = ["picture_of"]


def picture_of(scenario: Scenario, problem: Problem, plan: PlanAssessment) -> Picture:
    """Put together positions, covariances and the worst attack's groups for :func:`draw_map`."""
    objective = problem.objective
    assert isinstance(objective, InformationObjective)
    attack = plan.worst_case.attack
    groups = problem.communication.groups(attack.links)
    values = [objective(plan.elements[sorted(group - attack.sensing)]) for group in groups]
    best = groups[int(np.argmax(values))]
    survivors = plan.elements[sorted(best - attack.sensing)]
    return Picture(
        before=scenario.poses,
        after=scenario.predicted_poses[plan.elements],
        targets=scenario.predicted_targets,
        prior=objective.prior,
        posterior=np.asarray(np.linalg.inv(objective.posterior_information(survivors)), dtype=np.float64),
        links=problem.communication.links,
        attack=attack,
        groups=groups,
        best=best,
    )
