"""All attackers side by side."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from ratt_opt.attack import params as parameters
from ratt_opt.attack.exact import worst_case_attack
from ratt_opt.attack.heuristics import bounded_rational_attack, greedy_attack, heuristic_result, random_attack
from ratt_opt.attack.task import PlanValues
from ratt_opt.budget import Budget, interruptible
from ratt_opt.errors import InputError
from ratt_opt.problem import Attack
from ratt_opt.vocabulary import ByCurrentName

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from numpy.typing import ArrayLike

    from ratt_opt._validation import IntArray
    from ratt_opt.attack.params import AttackParams
    from ratt_opt.attack.task import AttackResult
    from ratt_opt.problem import Problem

__all__ = ["attack_survey"]


@interruptible
def attack_survey(
    problem: Problem,
    elements: ArrayLike,
    *,
    time_limit: float | None = None,
    seed: int = 0,
    budget: Budget | None = None,
    attackers: Mapping[str, Callable[[Problem, IntArray], Attack | AttackResult]] | None = None,
    params: AttackParams | None = None,
) -> dict[str, AttackResult]:
    """Attack one plan exactly and with every heuristic: name -> result.

    Parameters
    ----------
    time_limit : seconds for all of them, nine tenths for the exact attack; unlimited by default. The heuristics
        compute the value of each robot alone, whatever the limit
    seed : of the random attack
    budget : an outer search's budget: its seconds and interrupts count too
    attackers : attackers of your own by name, ``(problem, elements) -> Attack`` as in missions; what their attacks
        leave is computed here, and they prove nothing
    params : of the exact attack

    Raises
    ------
    InputError : the plan is not one element per robot, or an attacker of yours has a name that is taken or returns no
        attack within the budgets.
    """
    own = Budget.inside(budget, time_limit)
    seconds = None if time_limit is None else (params or parameters.DEFAULT).protection.survey * time_limit
    brief = math.isinf(own.seconds_left)  # without a limit an exact attack may take hours
    results: ByCurrentName[AttackResult] = ByCurrentName(
        {
            "worst": worst_case_attack(problem, elements, time_limit=seconds, budget=own, params=params, brief=brief),
            "bounded_rational": bounded_rational_attack(problem, elements),
            "greedy": greedy_attack(problem, elements, budget=own),
            "random": random_attack(problem, elements, seed=seed),
        }
    )
    plan = problem.check_plan(elements)
    for name, attacker in (attackers or {}).items():
        if name in results:
            raise InputError("attackers", f"must have names that are none of {', '.join(results)}", name)
        found = attacker(problem, plan)
        attack = found if isinstance(found, Attack) else getattr(found, "attack", None)
        if not isinstance(attack, Attack):
            raise InputError(f"attackers[{name!r}]", "must return an Attack", type(found).__name__)
        results[name] = heuristic_result(problem, PlanValues(problem, plan), problem.check_attack(attack))
    return results
