"""The measure that most studies use: planners under attackers, on one scenario."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from analysis.studies.instance import ATTACKERS, PLANNERS, Instance
from analysis.studies.quantities import QUANTITIES
from analysis.studies.study import name_of
from ratt_opt.problem import Attack

if TYPE_CHECKING:
    from analysis.studies.study import Case, Cell, Seeds, Study
    from ratt_opt._validation import IntArray
    from ratt_opt.attackers.task import AttackResult

__all__ = ["DRAWS", "measure"]

DRAWS = 200
"""True states and measurements drawn per trial for the mean squared error, the same for all planners."""


def measure(study: Study, case: Case, seeds: Seeds) -> dict[str, Cell]:
    """Return ``planner/attacker/metric`` for all combinations, and the study's quantities.

    Metrics: ``value`` of the team [unit of the objective], ``proved`` (lower bound of the worst case), ``trace``
    of the posterior covariance and ``mse`` of the estimates, both per target and of the best surviving group [m^2].
    """
    problem = None if study.problem is None else study.problem(case, seeds)
    instance = Instance.of(case, seeds, problem=problem)
    row: dict[str, Cell] = {"scenario": instance.digest}
    for planner in study.planners:
        plan = np.asarray((PLANNERS[planner] if isinstance(planner, str) else planner)(instance))
        for attacker in study.attackers:
            strike = ATTACKERS[attacker] if isinstance(attacker, str) else attacker
            found = _outcome(instance, plan, strike(instance, plan), study.metrics)
            where = f"{name_of(planner)}/{name_of(attacker)}"
            row |= {f"{where}/{metric}": found[metric] for metric in study.metrics}
    for quantity in study.quantities:
        row |= QUANTITIES[quantity](instance)
    return row


def _outcome(
    instance: Instance, plan: IntArray, result: AttackResult | None, metrics: tuple[str, ...]
) -> dict[str, float]:
    attack = Attack() if result is None else result.attack
    value = instance.problem.team_value(plan, attack)
    outcome = {"value": value, "proved": value if result is None else result.lower}
    if "trace" in metrics:
        outcome["trace"] = instance.trace(plan, attack)
    if "mse" in metrics:
        outcome["mse"] = instance.track(plan, attack, draws=DRAWS).mse
    return outcome
