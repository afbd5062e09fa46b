"""What the map of a scenario shows under one plan and one attack."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ratt_opt.report.map import Picture

if TYPE_CHECKING:
    from ratt_opt.main_job.result import BoundReport
    from ratt_opt.scenario.model import Scenario

__all__ = ["picture_of"]


def picture_of(scenario: Scenario, report: BoundReport) -> Picture:
    """Put together positions, covariances and the worst attack's groups for :func:`draw_map`."""
    plan = report.recommended
    assert plan.posterior is not None  # a scenario's problem has a criterion of information matrices
    return Picture(
        before=scenario.poses,
        after=scenario.predicted_poses[plan.elements],
        targets=scenario.predicted_targets,
        prior=scenario.prior,
        posterior=plan.posterior,
        links=report.problem.communication.links,
        attack=plan.worst_case.attack,
        groups=plan.groups,
        best=next(group for group in plan.groups if plan.best_group <= group),
    )
