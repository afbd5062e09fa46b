"""A lower bound for large teams on any graph: some group of a known size always survives."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ratt_opt.attack.least_sets.exchanges import weak_sets_of_size
from ratt_opt.attack.least_sets.least_set_search import LeastSetSearch
from ratt_opt.attack.params import DEFAULT
from ratt_opt.budget import Stop
from ratt_opt.graph.largest_group.counting import counting_bound
from ratt_opt.graph.largest_group.heuristic_cut import heuristic_cut
from ratt_opt.graph.largest_group.spreading import forced_size, forced_weight
from ratt_opt.graph.survivor_sizes import forced_group_size
from ratt_opt.problem import Attack

if TYPE_CHECKING:
    from ratt_opt._validation import FloatArray, IntArray
    from ratt_opt.attack.params.groups import AttackBoundParams
    from ratt_opt.attack.task import AttackTask
    from ratt_opt.attack.team import Team
    from ratt_opt.budget import Budget
    from ratt_opt.graph.threat import Threat
    from ratt_opt.setfunctions.information import InformationObjective

__all__ = [
    "ROUNDING",
    "bound_by_trees",
    "first_bound",
    "forced_group_bound",
    "forced_survivors",
    "rounded_down",
    "strongest_left",
    "tree_bound",
    "weakest_average",
]


def forced_survivors(threat: Threat) -> int:
    """Robots that some group keeps seeing under any attack.

    On a complete graph the integer partitions decide (``forced_group_size``; protected links only help).
    Any graph is a complete one whose missing links are cut already, and its largest group has at
    least ``counting_bound`` robots, of which ``n_blinded`` may be blinded.
    """
    n_robots, links = threat.graph.n_robots, len(threat.graph.links)
    missing = n_robots * (n_robots - 1) // 2 - links
    by_sizes = forced_group_size(n_robots, threat.n_blinded, threat.alpha_c + missing)
    return max(by_sizes, counting_bound(threat) - threat.n_blinded, 1 if threat.n_blinded < n_robots else 0)


def forced_group_bound(task: AttackTask, team: Team | None, least: int = 0) -> Stop:
    """Narrow the bracket if no exact search applies: more incumbents, then the weakest group of the forced size.

    ``least`` : unblinded robots that are known to be left in some group

    Relies on a non-decreasing objective. A group of k robots is worth at least its strongest robot, so
    at least the k-th smallest individual value; for two-dimensional targets the weakest set of k robots
    is searched for (``attack/least_sets``).
    """
    task.budget.check()
    single = task.values.singletons()
    _offer_cut(task, single)
    size = max(forced_survivors(task.problem.threat), least)
    if size:
        task.bracket.raise_lower(float(np.sort(single)[size - 1]))
    if team is not None and size:
        with task.budget.stage(task.params.bounds.fewer) as part:
            for fewer in range(1, size):
                _bound_by_weakest(task, team, fewer, part)
        _bound_by_weakest(task, team, size, task.budget)
    return Stop.CLOSED if task.bracket.is_closed else Stop.HEURISTIC


def _bound_by_weakest(task: AttackTask, team: Team, size: int, budget: Budget) -> None:
    """Raise the lower end by the weakest set of robots of one size; raises ``OutOfBudget``."""
    bracket, depth = task.bracket, task.params.bounds.in_depth
    weakest = min(map(team.value, weak_sets_of_size(team, size, budget)), default=np.inf)
    search = LeastSetSearch(team, size, min(weakest, bracket.upper), bracket.lower, in_depth=depth)
    for bound in search.rising_bounds(budget):
        bracket.raise_lower(bound * (1 - ROUNDING))


def _offer_cut(task: AttackTask, single: FloatArray) -> None:
    """The cut that shrinks the largest group, with the strongest robots of the best group blinded in turn."""
    problem = task.problem
    cut = heuristic_cut(problem.threat, task.budget)
    groups = problem.communication.groups(cut)
    blinded: set[int] = set()
    for _ in range(problem.threat.n_blinded):
        worth = [problem.objective(task.values.plan[sorted(group - blinded)]) for group in groups]
        best = groups[int(np.argmax(worth))] - blinded - problem.protected_robots
        if not best:
            break
        blinded.add(min(best, key=lambda i: (-single[i], i)))
    task.offer(Attack(frozenset(blinded), cut))


ROUNDING = 1e-12
"""Relative: values are sums of a few hundred numbers."""


def first_bound(objective: InformationObjective, plan: IntArray, threat: Threat, least: int = 0) -> float:
    """No attack on a plan (N,) leaves less; relies on a non-decreasing objective. ``-inf`` if all may be blinded.

    ``least`` : unblinded robots that are known to be left in some group
    """
    size = max(forced_survivors(threat), least)
    if size == 0:
        return -np.inf
    single = objective.extensions(np.array([], dtype=np.int64), plan)
    weakest = max(float(np.sort(single)[size - 1]), weakest_average(objective, plan, size))
    return rounded_down(max(strongest_left(single, threat), weakest), objective)


def rounded_down(bound: float, objective: InformationObjective) -> float:
    """The bound, less what floating-point sums of the objective's values may be off by."""
    return bound - ROUNDING * abs(bound) - objective.rounding


def weakest_average(objective: InformationObjective, plan: IntArray, size: int) -> float:
    """No set of ``size >= 1`` robots of a plan (N,) is worth less, up to rounding."""
    worths = objective.value(objective.prior_information + size * objective.information[plan])
    return float(np.partition(worths, size - 1)[:size].mean())


def strongest_left(single: FloatArray, threat: Threat) -> float:
    """The largest individual value once the strongest robots that may be are blinded."""
    is_protected = np.isin(np.arange(len(single)), list(threat.protected_robots))
    left = np.sort(single[~is_protected])[: len(single) - int(is_protected.sum()) - threat.n_blinded]
    return float(max(left.max(initial=-np.inf), single[is_protected].max(initial=-np.inf)))


def bound_by_trees(task: AttackTask, objective: InformationObjective, *, is_about_values: bool) -> int:
    """Unblinded robots that every attack leaves in a group, by tree inequalities; the bracket has their value.

    ``is_about_values`` : also ask for trees weighted by what robots are worth

    Raises
    ------
    OutOfBudget : the time is up.
    """
    budget, bracket, params = task.budget, task.bracket, task.params.bounds
    plan, threat = task.values.plan, task.problem.threat
    part = budget.part(params.share, at_least=min(params.short_share * budget.seconds_left, params.short))
    size = forced_size(threat, part, threat.graph.n_robots, task.params.trees)
    bracket.raise_lower(first_bound(objective, plan, threat, size))
    if is_about_values:
        bracket.raise_lower(tree_bound(objective, plan, threat, part, bracket.upper, params))
    budget.check()
    return size


def tree_bound(  # noqa: PLR0917
    objective: InformationObjective,
    plan: IntArray,
    threat: Threat,
    budget: Budget,
    enough: float,
    params: AttackBoundParams = DEFAULT.bounds,
) -> float:
    """No attack on a plan (N,) leaves less; relies on a non-decreasing objective. ``-inf`` if nothing is known.

    ``enough`` : no more is needed; ``budget`` : once it is spent, what is known by then
    """
    seeing = threat.graph.n_robots - threat.n_blinded
    low, high, best = forced_size(threat, budget, seeing), seeing, -np.inf
    while 0 < low <= high and best < enough and budget.stop() is None:
        k = (low + high) // 2
        kept = _kept_value(objective, plan, threat, budget, k, params.largest_weight)
        larger = weakest_average(objective, plan, k + 1) if k < seeing else np.inf
        best = max(best, min(kept, larger))
        low, high = (k + 1, high) if larger < kept else (low, k - 1)
    return rounded_down(best, objective) if best > -np.inf else best


def _kept_value(  # noqa: PLR0917
    objective: InformationObjective, plan: IntArray, threat: Threat, budget: Budget, k: int, largest_weight: int
) -> float:
    """Lower bound on the value of a group of at most ``k`` robots that keeps the forced weight."""
    weights = np.maximum(objective.value(objective.prior_information + k * objective.information[plan]) / k, 0.0)
    if not weights.max() > 0:
        return 0.0
    unit = weights.max() / largest_weight
    whole = np.floor(weights / unit).astype(np.int64)
    return float(unit) * forced_weight(threat, whole, budget, int(whole.sum()))
