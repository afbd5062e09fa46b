"""All attackers side by side."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ratt_opt.attackers.exact import worst_case_attack
from ratt_opt.attackers.heuristics.bounded_rational import bounded_rational_attack
from ratt_opt.attackers.heuristics.greedy import greedy_attack
from ratt_opt.attackers.heuristics.random_attack import random_attack
from ratt_opt.budget import Budget

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from ratt_opt.attackers.task import AttackResult
    from ratt_opt.problem import Problem

__all__ = ["attack_survey"]

EXACT_SHARE = 0.9
"""Of the seconds of a survey; the heuristics need little."""


def attack_survey(
    problem: Problem,
    elements: ArrayLike,
    *,
    time_limit: float | None = None,
    seed: int = 0,
    budget: Budget | None = None,
) -> dict[str, AttackResult]:
    """Attack one plan exactly and with every heuristic: name -> result.

    Parameters
    ----------
    time_limit : seconds for all of them, nine tenths for the exact attack; unlimited by default. The heuristics ask for
        the value of each robot alone whatever the limit
    seed : of the random attack
    budget : an outer search's budget: its seconds and interrupts count too

    Raises
    ------
    InputError : the plan is not one element per robot.
    """
    own = Budget.inside(budget, time_limit)
    seconds = None if time_limit is None else EXACT_SHARE * time_limit
    return {
        "exact": worst_case_attack(problem, elements, time_limit=seconds, budget=own),
        "bounded rational": bounded_rational_attack(problem, elements),
        "greedy": greedy_attack(problem, elements, budget=own),
        "random": random_attack(problem, elements, seed=seed),
    }
