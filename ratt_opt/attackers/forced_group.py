"""A lower bound for large teams on any graph: some group of a known size always survives."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ratt_opt.attack.least_sets.search import LeastSetSearch
from ratt_opt.budget import Stop
from ratt_opt.graph.largest_group.counting import counting_bound
from ratt_opt.graph.largest_group.heuristic_cut import heuristic_cut
from ratt_opt.graph.survivor_sizes import forced_group_size
from ratt_opt.problem import Attack

if TYPE_CHECKING:
    from ratt_opt._validation import FloatArray
    from ratt_opt.attack.least_sets.packed_team import PackedTeam
    from ratt_opt.attackers.task import AttackTask
    from ratt_opt.graph.threat import Threat

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


def forced_group_bound(task: AttackTask, team: PackedTeam | None, least: int = 0) -> Stop:
    """Narrow the bracket where no exact search applies: more incumbents, then the weakest group of the forced size.

    ``least`` : seeing robots that are known to be left in some group

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
        search = LeastSetSearch(team, size, task.bracket.upper, task.bracket.lower)
        for found in search.run(task.budget):
            if found is not None:
                search.threshold = min(search.threshold, team.value(found))
            task.bracket.raise_lower(min(search.lower, search.threshold * (1 - 1e-12)))
        task.bracket.raise_lower(search.threshold * (1 - 1e-12))
    return Stop.CLOSED if task.bracket.is_closed else Stop.HEURISTIC


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
