"""The exact worst-case attack on a plan."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ratt_opt.attackers.result import AttackResult
from ratt_opt.graph.outcomes import non_dominated_outcomes, realise
from ratt_opt.problem import Attack, Problem
from ratt_opt.stopping import Stop

if TYPE_CHECKING:
    from numpy.typing import ArrayLike


__all__ = ["worst_case_attack"]


def worst_case_attack(problem: Problem, elements: ArrayLike) -> AttackResult:
    """Find the attack that hurts one plan most, by evaluating every non-dominated outcome.

    Relies on a non-decreasing objective (not checked).

    Raises
    ------
    InputError : an element is not its robot's, or ``elements`` has the wrong shape.

    Source: ratt.tex, inner problem of eqn:resi_target_prob.
    """
    plan = problem.check_plan(elements)
    values: dict[frozenset[int], float] = {}
    best, worst = float("inf"), None
    for outcome in non_dominated_outcomes(problem.threat):
        for group in outcome:
            if group not in values:
                values[group] = problem.objective(plan[sorted(group)])
        team = max(values[group] for group in outcome)
        if team < best:
            best, worst = team, outcome
    assert worst is not None
    attack = Attack(*realise(problem.threat, worst))
    return AttackResult(attack=attack, lower=best, upper=best, stop=Stop.EXHAUSTED, evaluations=len(values))
