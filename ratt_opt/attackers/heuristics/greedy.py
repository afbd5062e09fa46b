"""The greedy attacker: the single step that hurts most, again and again."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from ratt_opt.attackers.heuristics.partial_attack import PartialAttack, heuristic_result, team_values
from ratt_opt.attackers.task import PlanValues
from ratt_opt.budget import Budget
from ratt_opt.problem import Attack

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from ratt_opt.attackers.task import AttackResult
    from ratt_opt.problem import Problem

__all__ = ["greedy_attack"]


def greedy_attack(problem: Problem, elements: ArrayLike, *, budget: Budget | None = None) -> AttackResult:
    """Blind robots one by one, then cut robots off one by one, each time leaving the least team value.

    Ties go to the step that cuts the fewest links, then to the lowest robot. A blinded robot may
    be cut off too: it relays. It stops if no step fits the budgets, or if the time of ``budget`` is over, and returns
    the attack so far with the reason.

    Raises
    ------
    InputError : an element is not its robot's, or ``elements`` has the wrong shape.
    """
    values, own = PlanValues(problem, elements), budget or Budget()
    attack = PartialAttack.of(problem)
    for _ in range(problem.threat.n_blinded):
        if own.is_over:
            return _so_far(values, attack, own)
        robots = [i for i in range(problem.n_robots) if i not in attack.blinded | problem.protected_robots]
        attack = _best(values, [attack.blind(i) for i in robots])
    while True:
        longer = [None if own.is_over else attack.cut_off(i) for i in range(problem.n_robots)]
        if own.is_over:
            return _so_far(values, attack, own)
        steps = [step for step in longer if step is not None and len(step.cut) > len(attack.cut)]
        if not steps:
            return heuristic_result(problem, values, Attack(attack.blinded, attack.cut))
        attack = _best(values, steps)


def _so_far(values: PlanValues, attack: PartialAttack, budget: Budget) -> AttackResult:
    result = heuristic_result(attack.problem, values, Attack(attack.blinded, attack.cut))
    return replace(result, stop=budget.stop() or result.stop)


def _best(values: PlanValues, steps: list[PartialAttack]) -> PartialAttack:
    worth = team_values(values, steps)
    return steps[min(range(len(steps)), key=lambda k: (worth[k], len(steps[k].cut), k))]
