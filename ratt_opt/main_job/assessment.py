"""One plan under attack: the team after its worst attack, and after other attacks worth seeing."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from ratt_opt._validation import readonly
from ratt_opt.attack.exact import worst_case_attack
from ratt_opt.attack.heuristics import heuristic_result
from ratt_opt.attack.task import PlanValues
from ratt_opt.main_job.params import SHARES
from ratt_opt.main_job.result import PlanAssessment
from ratt_opt.problem import Attack, Plan, Problem
from ratt_opt.setfunctions.information import InformationObjective

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

    from ratt_opt.attack.params import AttackParams
    from ratt_opt.attack.task import AttackResult
    from ratt_opt.budget import Budget

__all__ = ["assess", "recommended", "views_of"]


def recommended(plans: Iterable[PlanAssessment]) -> PlanAssessment:
    """Return the plan with the best proved worst case; the first among equals."""
    return max(plans, key=lambda plan: plan.worst_case.lower)


def assess(
    problem: Problem,
    planner: str,
    plan: Plan,
    budget: Budget,
    *,
    known: AttackResult | None = None,
    params: AttackParams | None = None,
) -> PlanAssessment:
    """Attack one plan in the worst way, unless that is ``known``, and describe the team after it."""
    elements, brief = plan.elements, math.isinf(budget.seconds_left)
    worst = known or worst_case_attack(problem, elements, budget=budget, brief=brief, params=params)
    seeing, f = problem.best_group(elements, worst.attack), problem.objective
    posterior = None
    if isinstance(f, InformationObjective):
        posterior = readonly(np.linalg.inv(f.posterior_information(elements[sorted(seeing)])))
    return PlanAssessment(
        planner=planner,
        elements=elements,
        controls=tuple(int(np.searchsorted(own, e)) for own, e in zip(problem.choices, elements, strict=True)),
        bait=plan.bait,
        worst_case=worst,
        evaluations=plan.evaluations,
        groups=problem.communication.groups(worst.attack.links),
        best_group=seeing,
        posterior=posterior,
    )


def views_of(
    problem: Problem, worst: PlanAssessment, budget: Budget, params: AttackParams | None = None
) -> dict[str, PlanAssessment]:
    """Return a plan under its worst attack, the worst found that spares part of it (if there is time), and no attack.

    The bracket of each is still of the plan's worst case: its upper end is the value under the attack shown.
    """
    plan = Plan(elements=worst.elements, evaluations=worst.evaluations, bait=worst.bait)

    def under(attack: Attack) -> PlanAssessment:
        found = heuristic_result(problem, PlanValues(problem, plan.elements), attack)
        return assess(problem, worst.planner, plan, budget, known=replace(found, lower=worst.worst_case.lower))

    attacks = []
    for spared in _spared(problem, worst.worst_case.attack):
        if budget.is_over:
            break
        attacks.append(worst_case_attack(spared, plan.elements, budget=budget, brief=True, params=params).attack)
    nexts = sorted((under(attack) for attack in attacks), key=lambda view: view.worst_case.upper)
    return {"worst": worst, **({"next worst": nexts[0]} if nexts else {}), "none": under(Attack())}


def _spared(problem: Problem, attack: Attack) -> Iterator[Problem]:
    """The problem with one blinded robot (or cut link, if none is blinded) protected, each in turn."""
    if attack.sensing:
        for i in sorted(attack.sensing)[: SHARES.spared]:
            yield replace(problem, protected_robots=problem.protected_robots | {i})
    else:
        for link in sorted(attack.links)[: SHARES.spared]:
            yield replace(problem, protected_links=problem.protected_links | {link})
