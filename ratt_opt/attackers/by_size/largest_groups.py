"""Which sets of robots an attack can leave as its largest group of seeing robots, one by one.

Where the weakest sets of the sizes that a largest group may have are few below an attack, each is asked whether it and
some blinded robots can score what the other groups leave to be scored (``graph/link_scores.py``), weakest first. The
best group is worth at least the largest one, so the first that cannot be ruled out bounds every attack.
"""

from __future__ import annotations

from operator import itemgetter
from typing import TYPE_CHECKING

import numpy as np

from ratt_opt.attackers.by_size.low_lists import MOST_ROBOTS
from ratt_opt.attackers.by_size.vector_search import LowLists
from ratt_opt.graph.link_scores import can_score

if TYPE_CHECKING:
    from ratt_opt.attackers.task import AttackTask
    from ratt_opt.attackers.weakest_set.planar_team import PlanarTeam
    from ratt_opt.graph.possible_sizes import PossibleSizes

__all__ = ["largest_groups_bound"]

MOST_SETS = 20_000
"""Sets to ask about: ten thousand take some seconds."""


def largest_groups_bound(task: AttackTask, team: PlanarTeam, possible: PossibleSizes) -> None:
    """Raise the lower bound; relies on a non-decreasing objective.

    Raises
    ------
    OutOfBudget : the time is up; the bracket keeps what is proved by then.
    """
    bracket, budget = task.bracket, task.budget
    graph, n_robots = task.problem.threat.graph, task.problem.n_robots
    sets = _weak_sets(task, team, possible) if n_robots <= MOST_ROBOTS else None
    if sets is None:
        return
    joining = {size: possible.largest(size) for size in {len(robots) for _, robots in sets}}
    for value, robots in sorted(sets, key=itemgetter(0)):
        bracket.raise_lower(min(value, bracket.goal))
        members = np.isin(np.arange(n_robots), list(robots))
        if any(can_score(graph, members, inside, needed, budget) for inside, needed in joining[len(robots)]):
            return
    bracket.raise_lower(bracket.goal)


def _weak_sets(
    task: AttackTask, team: PlanarTeam, possible: PossibleSizes
) -> list[tuple[float, frozenset[int]]] | None:
    """Every set below the goal of a size that a largest group may have, with its value; ``None`` where too many.

    Larger sets than those of a size of which none is below the goal are not below it either.
    """
    lists = LowLists(team, np.argsort(-team.single, kind="stable"))
    sets: list[tuple[float, frozenset[int]]] = []
    for size in range(possible.forced, possible.n_seeing + 1):
        low = lists.of(size, task.bracket.goal, task.budget)
        if low is None:
            return None
        if not len(low.masks):
            break
        if len(sets) + len(low.masks) > MOST_SETS:
            return None
        sets.extend(zip(low.values.tolist(), map(lists.robots, low.masks.tolist()), strict=True))
    return sets
