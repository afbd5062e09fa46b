"""A lower bound for large teams on any graph: some group of a known size always survives."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ratt_opt.graph.largest_group import counting_bound, smallest_largest_group
from ratt_opt.graph.survivor_sizes import forced_group_size
from ratt_opt.problem import Attack
from ratt_opt.stopping import Stop

if TYPE_CHECKING:
    from ratt_opt.attackers.bracket import Bracket, Budget
    from ratt_opt.attackers.plan_values import PlanValues
    from ratt_opt.attackers.weakest_set.compact import CompactTeam
    from ratt_opt.graph.threat import Threat
    from ratt_opt.problem import Problem

__all__ = ["forced_group_bound", "forced_survivors"]


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


def forced_group_bound(
    problem: Problem, values: PlanValues, team: CompactTeam | None, bracket: Bracket, budget: Budget
) -> Stop:
    """Narrow ``bracket`` where no exact search applies: more incumbents, then the weakest group of the forced size.

    Relies on a non-decreasing objective. A group of k robots is worth at least its strongest robot, so
    at least the k-th smallest individual value; for two-dimensional targets the weakest set of k robots
    is searched for (``size_search.py``).
    """
    budget.check_time()
    _offer_cuts(problem, values, bracket)
    size = forced_survivors(problem.threat)
    single = np.sort(values.singletons())
    bracket.raise_lower(float(single[size - 1]) if size else bracket.lower)
    if team is not None and size:
        _weakest_set(team, size, bracket, budget)
    return Stop.CLOSED if bracket.lower >= bracket.upper * (1 - 1e-10) else Stop.HEURISTIC


def _offer_cuts(problem: Problem, values: PlanValues, bracket: Bracket) -> None:
    """The cut that shrinks the largest group, with the strongest robots of the best group blinded in turn."""
    cut = smallest_largest_group(
        problem.communication, problem.alpha_c, method="counting", protected_links=problem.protected_links
    ).cut
    groups = problem.communication.groups(cut)
    single = values.singletons()
    blinded: set[int] = set()
    for _ in range(problem.threat.n_blinded):
        worth = [problem.objective(values.plan[sorted(group - blinded)]) for group in groups]
        best = groups[int(np.argmax(worth))] - blinded - problem.protected_robots
        if not best:
            break
        blinded.add(min(best, key=lambda i: (-single[i], i)))
    attack = Attack(frozenset(blinded), cut)
    bracket.offer(attack, problem.team_value(values.plan, attack))


def _weakest_set(team: CompactTeam, size: int, bracket: Bracket, budget: Budget) -> None:
    from ratt_opt.attackers.weakest_set.size_search import SizeSearch  # compiles

    weakest = bracket.upper

    def note(group: frozenset[int]) -> float:
        nonlocal weakest
        weakest = min(weakest, team.value(group))
        return weakest

    search = SizeSearch(team, size, note, bracket.lower)
    search.run(weakest, budget, lambda undecided: bracket.raise_lower(min(undecided, weakest * (1 - 1e-12))))
    bracket.raise_lower(weakest * (1 - 1e-12))
