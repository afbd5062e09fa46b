"""Which robots and links a plan hangs on, what they are worth protecting, and how much it takes to break the plan."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import partial
from typing import TYPE_CHECKING

from ratt_opt._validation import check_number
from ratt_opt.attackers.exact import worst_case_attack
from ratt_opt.attackers.heuristics.partial_attack import PartialAttack, team_values
from ratt_opt.attackers.task import PlanValues
from ratt_opt.budget import Budget
from ratt_opt.progress import Step

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable

    from numpy.typing import ArrayLike

    from ratt_opt.attackers.task import AttackResult
    from ratt_opt.graph.communication import Link
    from ratt_opt.problem import Attack, Problem

__all__ = ["BreakingBudget", "Criticality", "breaking_budgets", "criticality_ranking"]


@dataclass(frozen=True, slots=True, kw_only=True)
class Criticality:
    """One robot or link of a plan [values in the unit of the objective].

    ``loss`` : team value lost when it alone is attacked and nothing else is. ``gain_lower``, ``gain_upper`` : bracket
    on the worst-case value gained when it alone is protected (equal up to rounding where the exact attacker closes).
    """

    target: int | Link
    loss: float
    gain_lower: float
    gain_upper: float


@Step("what to protect")
def criticality_ranking(
    problem: Problem,
    elements: ArrayLike,
    *,
    links: Iterable[Link] | None = None,
    max_nodes: int | None = None,
    time_limit: float | None = None,
    budget: Budget | None = None,
) -> tuple[Criticality, ...]:
    """Rank robots and links: largest certain gain from protection first, then largest loss, then robots by index.

    Only what the worst attack uses can be worth protecting: otherwise that attack stays possible, so the
    gain is 0 without a search.

    Parameters
    ----------
    links : links to rank; all by default
    max_nodes, time_limit : for each exact attack
    budget : an outer search's budget: its seconds and interrupts count too. Once it is spent, or the user interrupts,
        the attacks left are bounded without a search

    Raises
    ------
    InputError : the plan is not one element per robot, a link does not exist, or a budget is not a number >= 0.
    """
    values = PlanValues(problem, elements)
    plan, whole = values.plan, Budget.inside(budget)
    attacked = partial(worst_case_attack, elements=plan, max_nodes=max_nodes, time_limit=time_limit, budget=whole)
    base = attacked(problem)
    ranked_links = sorted(problem.communication.links if links is None else set(links))
    replace(problem, protected_links=frozenset(ranked_links))  # refuses a link that does not exist
    targets: list[int | Link] = [*range(problem.n_robots), *ranked_links]
    untouched = PartialAttack.of(problem)
    single = [
        untouched.blind(t) if isinstance(t, int) else PartialAttack.of(problem, cut=frozenset([t])) for t in targets
    ]
    worth = team_values(values, [untouched, *single])
    rows = []
    for target, left in zip(targets, worth[1:].tolist(), strict=True):
        after = _protected(problem, target, base, attacked)
        gain_lower, gain_upper = max(after.lower - base.upper, 0.0), max(after.upper - base.lower, 0.0)
        if after is base:
            gain_lower = gain_upper = 0.0
        loss = float(worth[0]) - left
        rows.append(Criticality(target=target, loss=loss, gain_lower=gain_lower, gain_upper=gain_upper))
    order = sorted(range(len(rows)), key=lambda k: (-rows[k].gain_lower, -rows[k].loss, k))
    return tuple(rows[k] for k in order)


def _protected(
    problem: Problem, target: int | Link, base: AttackResult, attacked: Callable[[Problem], AttackResult]
) -> AttackResult:
    """The worst case once ``target`` is protected; ``base`` itself where its attack stays possible."""
    if target not in (base.attack.sensing if isinstance(target, int) else base.attack.links):
        return base
    if isinstance(target, int):
        return attacked(replace(problem, protected_robots=problem.protected_robots | {target}))
    return attacked(replace(problem, protected_links=problem.protected_links | {target}))


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


@Step("the smallest budgets that break the plan")
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
    max_nodes, time_limit, budget : as for :func:`criticality_ranking`

    Raises
    ------
    InputError : the plan is not one element per robot, ``value`` is not finite, or a budget is not a number >= 0.
    """
    plan = problem.check_plan(elements)
    goal = check_number("value", value)
    whole = Budget.inside(budget)
    attacked = partial(worst_case_attack, elements=plan, max_nodes=max_nodes, time_limit=time_limit, budget=whole)
    found: list[BreakingBudget] = []
    most_links = len(problem.communication.links)
    for alpha_s in range(problem.n_robots + 1):
        best = attacked(replace(problem, alpha_s=alpha_s, alpha_c=most_links))
        if best.upper >= goal:
            continue
        low, high, proved, step = 0, most_links, True, 1
        while low < high:
            # From few links upwards: large budgets are slow to attack exactly, and seldom needed.
            middle = min(low + step - 1, (low + high) // 2)
            step *= 2
            result = attacked(replace(problem, alpha_s=alpha_s, alpha_c=middle))
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
