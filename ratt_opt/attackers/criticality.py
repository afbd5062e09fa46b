"""Which robots and links a plan hangs on, and what they are worth protecting."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from ratt_opt.attackers.exact import worst_case_attack
from ratt_opt.attackers.heuristics.partial_attack import PartialAttack, team_values
from ratt_opt.attackers.plan_values import PlanValues
from ratt_opt.budget import Budget

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable

    from numpy.typing import ArrayLike

    from ratt_opt.attackers.result import AttackResult
    from ratt_opt.graph.communication import Link
    from ratt_opt.problem import Problem

__all__ = ["Criticality", "criticality_ranking"]


@dataclass(frozen=True, slots=True, kw_only=True)
class Criticality:
    """One robot or link of a plan [values in the unit of the objective].

    ``loss`` : team value lost when it alone is attacked and nothing else is.
    ``gain_lower``, ``gain_upper`` : bracket on the worst-case value gained when it alone is protected
    (equal up to rounding where the exact attacker closes).
    """

    target: int | Link
    loss: float
    gain_lower: float
    gain_upper: float


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
    whole = Budget.inside(budget)

    def attacked(asked: Problem) -> AttackResult:
        return worst_case_attack(asked, values.plan, max_nodes=max_nodes, time_limit=time_limit, budget=whole)

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
