"""The measure that most studies use: planners under attackers, on one scenario."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ratt_opt.studies.instance import Instance
from ratt_opt.studies.quantities import QUANTITIES

if TYPE_CHECKING:
    from collections.abc import Sequence

    from ratt_opt._validation import IntArray
    from ratt_opt.problem import Attack
    from ratt_opt.studies.cases import Case, Cell, Seeds
    from ratt_opt.studies.study import Study

__all__ = ["DRAWS", "measure"]

DRAWS = 200
"""True states and measurements drawn per trial for the mean squared error, the same for all planners."""


def measure(study: Study, case: Case, seeds: Seeds) -> dict[str, Cell]:
    """Return ``planner/attacker/metric`` for all combinations, and the study's quantities.

    Metrics: ``value`` of the team [unit of the objective], ``proved`` (lower bound of the worst case), ``trace``
    of the posterior covariance and ``mse`` of the estimates, both per target and of the best surviving group [m^2].
    """
    made = None if study.problem is None else study.problem(case, seeds)
    instance = Instance.of(case, seeds, made=made)
    row: dict[str, Cell] = {"scenario": instance.digest}
    for planner, chosen in study.named_planners.items():
        plan = instance.plan(chosen)
        for attacker, striking in study.named_attackers.items():
            found = _outcome(instance, plan, *instance.strike(striking, plan), metrics=study.metrics)
            row |= {f"{planner}/{attacker}/{metric}": found[metric] for metric in study.metrics}
    for quantity in study.quantities:
        row |= QUANTITIES[quantity](instance)
    return row


def _outcome(
    instance: Instance, plan: IntArray, attack: Attack, proved: float | None, *, metrics: Sequence[str]
) -> dict[str, float]:
    value = instance.problem.team_value(plan, attack)
    outcome = {"value": value, "proved": value if proved is None else proved}
    if "trace" in metrics:
        outcome["trace"] = instance.trace(plan, attack)
    if "mse" in metrics:
        outcome["mse"] = instance.track(plan, attack, draws=DRAWS).mse
    return outcome
