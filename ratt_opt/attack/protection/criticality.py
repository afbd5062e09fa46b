"""Critical robots and links of a plan, the gain from protecting them, and the budgets that break the plan."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import partial
from typing import TYPE_CHECKING, Self

import numpy as np

from ratt_opt._validation import check_number
from ratt_opt.attack import params as parameters
from ratt_opt.attack.bounds import ROUNDING
from ratt_opt.attack.exact import worst_case_attack
from ratt_opt.attack.heuristics import PartialAttack, team_values
from ratt_opt.attack.task import PlanValues
from ratt_opt.budget import Budget, Stop, interruptible
from ratt_opt.errors import InputError
from ratt_opt.running.progress import Step
from ratt_opt.setfunctions.information import InformationObjective

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable

    from numpy.typing import ArrayLike

    from ratt_opt.attack.task import AttackResult
    from ratt_opt.graph.communication import Link
    from ratt_opt.problem import Attack, Problem

__all__ = ["BreakingBudget", "Criticality", "breaking_budgets", "criticality_ranking"]


@dataclass(frozen=True, slots=True, kw_only=True)
class Criticality:
    """One robot or link of a plan [values in the unit of the objective].

    ``loss`` : team value lost under an attack on it alone. ``gain_lower``, ``gain_upper`` : bracket on the worst-case
    value gained by protecting it alone (equal up to rounding if the exact attacker closes).
    """

    target: int | Link
    loss: float
    gain_lower: float
    gain_upper: float


@interruptible
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

    Robots and links that the best known attack does not use need no search: that attack stays possible. So their gain
    is at most the open part of its bracket, and 0 if it is proved worst.

    Parameters
    ----------
    links : links to rank; all by default
    max_nodes : for each exact attack
    time_limit : seconds for all of it; unlimited by default. The value of the team without each robot, and at each
        bridge, is computed whatever the limit
    budget : an outer search's budget: its seconds and interrupts count too. After it, or after an interrupt, the other
        gains are bounded without a search

    Raises
    ------
    InputError : the plan is not one element per robot, a link does not exist, or a budget is not a number >= 0.
    """
    values, own = PlanValues(problem, elements), Budget.inside(budget, time_limit)
    attacked = partial(worst_case_attack, elements=values.plan, max_nodes=max_nodes)
    ranked_links = sorted(problem.communication.links if links is None else set(links))
    replace(problem, protected_links=frozenset(ranked_links))  # refuses a link that does not exist
    base = attacked(problem, budget=own.part(parameters.DEFAULT.protection.base))
    targets: list[int | Link] = [*range(problem.n_robots), *ranked_links]
    used = [t for t in targets if t in (base.attack.sensing if isinstance(t, int) else base.attack.links)]
    whole = max(values(group) for group in problem.communication.groups())
    noise = 2 * problem.objective.rounding + ROUNDING * abs(base.upper)  # smaller gains are none
    losses, rows = _losses(problem, values, targets), []
    after = {}
    for done, target in enumerate(used):
        if own.is_over:
            break
        after[target] = attacked(_protected(problem, target), budget=own.part(1 / (len(used) - done)))
    for target, loss in zip(targets, losses, strict=True):
        gain_lower, gain_upper = 0.0, max(base.upper - base.lower, 0.0)
        if target in after:
            certain = after[target].lower - base.upper
            gain_lower = certain if certain > noise else 0.0
            gain_upper = max(after[target].upper - base.lower, 0.0)
        elif target in set(used):  # no time for it: no attack leaves more than none does
            gain_upper = max(whole - base.lower, 0.0)
        rows.append(Criticality(target=target, loss=loss, gain_lower=gain_lower, gain_upper=gain_upper))
    order = sorted(range(len(rows)), key=lambda k: (-rows[k].gain_lower, -rows[k].loss, k))
    return tuple(rows[k] for k in order)


def _losses(problem: Problem, values: PlanValues, targets: list[int | Link]) -> list[float]:
    """Losses of team value by each target alone; a link has one if its cut leaves more groups."""
    bridges = problem.communication.bridges()
    untouched = PartialAttack.of(problem)
    felt = [t for t in targets if isinstance(t, int) or t in bridges]
    single = [untouched.blind(t) if isinstance(t, int) else PartialAttack.of(problem, cut=frozenset([t])) for t in felt]
    worth = team_values(values, [untouched, *single])
    left = dict(zip(felt, worth[1:].tolist(), strict=True))
    return [float(worth[0]) - left.get(t, float(worth[0])) for t in targets]


def _protected(problem: Problem, target: int | Link) -> Problem:
    if isinstance(target, int):
        return replace(problem, protected_robots=problem.protected_robots | {target})
    return replace(problem, protected_links=problem.protected_links | {target})


@dataclass(frozen=True, slots=True, kw_only=True)
class BreakingBudget:
    """``attack`` blinds ``alpha_s`` robots and cuts ``alpha_c`` links at most and leaves ``value``.

    ``is_proved``: with one link fewer, and the same number of robots, no attack reaches the value. Otherwise the
    attacker did not decide that within its budget.
    """

    alpha_s: int
    alpha_c: int
    attack: Attack
    value: float
    is_proved: bool


class BreakingBudgets(tuple[BreakingBudget, ...]):
    """The budgets found; ``stop`` says why there may be more (``EXHAUSTED``: there are none)."""

    stop: Stop

    def __new__(cls, found: Iterable[BreakingBudget], stop: Stop) -> Self:
        """The tuple with its reason."""
        made = super().__new__(cls, found)
        made.stop = stop
        return made

    def __getnewargs__(self) -> tuple[tuple[BreakingBudget, ...], Stop]:
        """Return the arguments for copies."""
        return tuple(self), self.stop


def _goal(problem: Problem, value: float | None, rms: float | None) -> float:
    """The value below which a plan is broken. InputError : not exactly one is given, or no trace for an ``rms``."""
    if (value is None) == (rms is None):
        raise InputError("value", "must be given, or rms, not both", value)
    if rms is None:
        return check_number("value", value)
    objective = problem.objective
    if not isinstance(objective, InformationObjective) or objective.name != "trace":
        raise InputError("rms", "needs the trace as objective", getattr(objective, "name", type(objective).__name__))
    weights = np.ones(objective.n_targets) if objective.weights is None else objective.weights
    return float(objective.prior_criterion - weights.sum() * check_number("rms", rms, low=0.0) ** 2)


@interruptible
@Step("the smallest budgets that break the plan")
def breaking_budgets(
    problem: Problem,
    elements: ArrayLike | Callable[[Problem], ArrayLike],
    value: float | None = None,
    *,
    rms: float | None = None,
    max_nodes: int | None = None,
    time_limit: float | None = None,
    budget: Budget | None = None,
) -> BreakingBudgets:
    """Smallest attack budgets that push a plan strictly below ``value``; none of them contains another.

    For each number of blinded robots, ascending, the fewest cut links are found by doubling and bisection (a
    larger budget never helps the team); the problem's own budgets are not used. Empty when even blinding all
    unprotected robots and cutting all unprotected links leaves ``value`` or more.

    Parameters
    ----------
    elements : (N,) the plan; or a planner ``f(problem)``, such as :func:`ratt_opt.ratt`: each pair of budgets is then
        asked of the plan that the team makes against it, and ``is_proved`` is about the plan against one link fewer.
        Bisection takes for granted that a team does no worse against fewer attacks, as max-min plans do
    value : [unit of the objective]
    rms : instead of a value, the error that an attack shall exceed: root of the weighted mean over the targets of the
        traces of their posterior covariances [m]; of the trace only
    max_nodes, time_limit, budget : as for :func:`criticality_ranking`; once time is up no further number of robots is
        looked at. ``stop`` of the result says so, or why an attack on some number of robots was left open; if the
        fewest links of a budget are not proved, its ``is_proved`` is False

    Raises
    ------
    InputError : the plan is not one element per robot, ``value`` is not finite, or a budget is not a number >= 0.
    """
    if not callable(elements):
        problem.check_plan(elements)
    goal = _goal(problem, value, rms)
    own = Budget.inside(budget, time_limit)
    found: list[BreakingBudget] = []
    undecided: Stop | None = None
    most_links = len(problem.communication.links)

    def attacked(alpha_s: int, alpha_c: int) -> AttackResult:
        stronger = replace(problem, alpha_s=alpha_s, alpha_c=alpha_c)
        plan = stronger.check_plan(elements(stronger) if callable(elements) else elements)
        return worst_case_attack(
            stronger, plan, max_nodes=max_nodes, budget=own.part(parameters.DEFAULT.protection.bisection), brief=True
        )

    for alpha_s in range(problem.n_robots + 1):
        if own.is_over:
            break
        best = attacked(alpha_s, most_links)
        if best.upper >= goal:
            if best.lower < goal:
                undecided = best.stop
            continue
        low, high, proved, step = 0, most_links, True, 1
        while low < high:
            # From few links upwards: large budgets are slow to attack exactly, and seldom needed.
            middle = min(low + step - 1, (low + high) // 2)
            step *= 2
            if own.is_over:
                proved = False
                break
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
    return BreakingBudgets(found, own.stop() or undecided or Stop.EXHAUSTED)
