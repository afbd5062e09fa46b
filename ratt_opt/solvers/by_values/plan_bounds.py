"""Bounds on all plans of a function known by its values. No plan is worth more than

- what the worst attack found leaves of a team in which every robot holds all its elements (monotonicity), or, if
  theory proves the function submodular, of the sum of the robots' largest individual values;
- RATT's plan under any attack, divided by the share of the optimum that RATT keeps (``1 - k`` of a submodular
  function, ``(1 - c)^2`` of one that states a bound on its total curvature).
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from ratt_opt.attack.exact import worst_case_attack_unrounded
from ratt_opt.attack.task import AttackOptions, metered_problem
from ratt_opt.bounds.guarantees import pattern_free_bound
from ratt_opt.setfunctions.metered import unmetered
from ratt_opt.solvers.by_values.plan_tree import Pooled

if TYPE_CHECKING:
    from ratt_opt._validation import FloatArray
    from ratt_opt.budget import Budget
    from ratt_opt.problem import Problem
    from ratt_opt.solvers.by_values.plan_attacks import PlanAttacks

__all__ = ["guarantee_bound", "pooling_bound"]


def pooling_bound(problem: Problem, attacks: PlanAttacks, part: Budget) -> float:
    """Bound by the worst attack found on robots that hold all their elements, within a part of the budget."""
    everyone = np.arange(problem.n_robots)
    team = replace(problem, objective=Pooled(problem, _singles(attacks.problem)), robot=everyone, at_most=None)
    worst = worst_case_attack_unrounded(team, everyone, AttackOptions(budget=part, brief=True)).attack
    team = metered_problem(team, attacks.budget)
    return min(team.team_value(everyone, attack) for attack in [*attacks.known, worst])


def guarantee_bound(metered: Problem, worth: float) -> float:
    """RATT's plan has a guaranteed share of the optimum, so the optimum is at most its value over that share.

    ``worth`` : no less than the worst case of RATT's plan
    """
    f, share = unmetered(metered.objective), 0.0
    if metered.at_most is not None:  # the theorem compares robot by robot; a robot of the best plan may be idle here
        return np.inf
    if (single := _singles(metered)) is not None:
        asked = metered.objective
        top = np.maximum(asked(range(f.n)) - asked.evaluate(~np.eye(f.n, dtype=np.bool_)), 0.0)
        share = float((top[single > 0] / single[single > 0]).min(initial=1.0))
        share = float(pattern_free_bound(k=min(max(1.0 - share, 0.0), 1.0)))
    elif f.most_total_curvature < 1:
        share = float(pattern_free_bound(c=f.most_total_curvature))
    return worth / share if share > 0 else np.inf


def _singles(metered: Problem) -> FloatArray | None:
    """(E,) individual values if theory proves the function submodular."""
    return metered.objective.singletons() if unmetered(metered.objective).is_submodular else None
