"""How much it takes to push a plan below a value."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from ratt_opt._validation import check_finite
from ratt_opt.attackers.exact import worst_case_attack
from ratt_opt.budget import Budget

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from ratt_opt.attackers.result import AttackResult
    from ratt_opt.problem import Attack, Problem

__all__ = ["BreakingBudget", "breaking_budgets"]


@dataclass(frozen=True, slots=True, kw_only=True)
class BreakingBudget:
    """``attack`` blinds ``alpha_s`` robots and cuts ``alpha_c`` links at most and leaves ``value``.

    ``is_proved`` says that with one link fewer (and as many robots) the value demanded cannot be reached;
    otherwise the attacker's bracket did not decide that within its budget.
    """

    alpha_s: int
    alpha_c: int
    attack: Attack
    value: float
    is_proved: bool


def breaking_budgets(
    problem: Problem,
    elements: ArrayLike,
    value: float,
    *,
    max_nodes: int | None = None,
    time_limit: float | None = None,
    budget: Budget | None = None,
) -> tuple[BreakingBudget, ...]:
    """Smallest attack budgets that push a plan strictly below ``value``: none in the list contains another.

    For each number of blinded robots, ascending, the fewest cut links are found by doubling and bisection (a
    larger budget never helps the team); the problem's own budgets are not used. Empty when even blinding all
    unprotected robots and cutting all unprotected links leaves ``value`` or more.

    Parameters
    ----------
    value : [unit of the objective]
    max_nodes, time_limit : for each exact attack
    budget : an outer search's budget: its seconds and interrupts count too. Once it is spent, or the user interrupts,
        the attacks left are bounded without a search

    Raises
    ------
    InputError : the plan is not one element per robot, ``value`` is not finite, or a budget is not a number >= 0.
    """
    plan = problem.check_plan(elements)
    goal = float(check_finite("value", value, ndim=0))
    n_links = len(problem.communication.links)
    whole = Budget.inside(budget)

    def attacked(alpha_s: int, alpha_c: int) -> AttackResult:
        asked = replace(problem, alpha_s=alpha_s, alpha_c=alpha_c)
        return worst_case_attack(asked, plan, max_nodes=max_nodes, time_limit=time_limit, budget=whole)

    found: list[BreakingBudget] = []
    most_links = n_links
    for alpha_s in range(problem.n_robots + 1):
        best = attacked(alpha_s, most_links)
        if best.upper >= goal:
            continue
        low, high, proved, step = 0, most_links, True, 1
        while low < high:
            # From few links upwards: large budgets are slow to attack exactly, and seldom needed.
            middle = min(low + step - 1, (low + high) // 2)
            step *= 2
            result = attacked(alpha_s, middle)
            if result.upper < goal:
                best, high = result, middle
            else:
                low = middle + 1
                proved = proved and result.lower >= goal
        found.append(
            BreakingBudget(alpha_s=alpha_s, alpha_c=high, attack=best.attack, value=best.upper, is_proved=proved)
        )
        if high == 0:
            break
        most_links = high - 1
    return tuple(found)
