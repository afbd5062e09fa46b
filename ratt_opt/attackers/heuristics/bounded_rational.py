"""The paper's bounded-rational attacker: strongest robots first."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ratt_opt.attackers.heuristics.partial_attack import PartialAttack, heuristic_result
from ratt_opt.attackers.task import PlanValues
from ratt_opt.problem import Attack

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from ratt_opt.attackers.task import AttackResult
    from ratt_opt.problem import Problem

__all__ = ["bounded_rational_attack"]


def bounded_rational_attack(problem: Problem, elements: ArrayLike) -> AttackResult:
    """Blind the strongest robots, then cut off the next strongest while the link budget lasts.

    Strength is the individual value of the chosen element; ties go to the lowest robot. Protected robots are passed
    over when blinding, and robots with a protected link when cutting off. The first robot whose links exceed what is
    left of the budget ends the attack. (The paper cuts off ``alpha_cs`` robots, which can exceed its own link budget.)

    Raises
    ------
    InputError : an element is not its robot's, or ``elements`` has the wrong shape.

    Source: ratt.tex, Section VI-C, large-scale comparison.
    """
    values = PlanValues(problem, elements)
    order = np.argsort(-values.singletons(), kind="stable").tolist()
    free = [i for i in order if i not in problem.protected_robots]
    attack = PartialAttack.of(problem, frozenset(free[: problem.alpha_s]))
    locked = {i for link in problem.protected_links for i in link}
    for robot in order:
        if robot in attack.blinded or robot in locked:
            continue
        longer = attack.cut_off(robot)
        if longer is None:
            break
        attack = longer
    return heuristic_result(problem, values, Attack(attack.blinded, attack.cut))
