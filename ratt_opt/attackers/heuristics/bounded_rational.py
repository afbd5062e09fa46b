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


def _on_complete_graph(problem: Problem, order: list[int], blinded: frozenset[int]) -> Attack:
    """The same without going through the links: the next robot to be cut off has one link to each robot not yet so."""
    n_robots, left, alone = problem.n_robots, problem.alpha_c, list[int]()
    for robot in order:
        if robot in blinded:
            continue
        left -= n_robots - 1 - len(alone)
        if left < 0:
            break
        alone.append(robot)
    together = set(range(n_robots)).difference(alone)
    return Attack(blinded, problem.communication.links_between([*([i] for i in alone), together]))


def bounded_rational_attack(problem: Problem, elements: ArrayLike) -> AttackResult:
    """Blind the strongest robots, then cut off the next strongest while the link budget lasts.

    Strength is the individual value of the chosen element; ties go to the lowest robot. Protected robots are passed
    over when blinding, and robots with a protected link when cutting off. The attack ends at the first robot whose
    links exceed the remaining budget. (The paper cuts off ``alpha_cs`` robots, which can exceed its own link budget.)

    Raises
    ------
    InputError : an element is not its robot's, or ``elements`` has the wrong shape.

    Source: ratt.tex, Section VI-C, large-scale comparison.
    """
    values = PlanValues(problem, elements)
    order = np.argsort(-values.singletons(), kind="stable").tolist()
    free = [i for i in order if i not in problem.protected_robots]
    if problem.threat.links_alike:
        return heuristic_result(problem, values, _on_complete_graph(problem, order, frozenset(free[: problem.alpha_s])))
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
