"""Which sets of robots an attack can leave as its largest group of seeing robots, one by one.

Where the weakest sets of the sizes that a largest group may have are few below an attack, each is asked whether it and
some blinded robots can score what the other groups leave to be scored (``graph/link_scores.py``), weakest first. The
best group is worth at least the largest one, so the first that cannot be ruled out bounds every attack. Where the
others together are worth less, it is an attack's, and the bracket closes.
"""

from __future__ import annotations

from operator import itemgetter
from typing import TYPE_CHECKING

import numpy as np

from ratt_opt.attack.families.family_search import SetLists
from ratt_opt.attack.families.set_lists import MOST_ROBOTS
from ratt_opt.graph.link_scores import scoring_group
from ratt_opt.problem import Attack

if TYPE_CHECKING:
    from ratt_opt.attack.least_sets.packed_team import PackedTeam
    from ratt_opt.attackers.task import AttackTask
    from ratt_opt.graph.possible_sizes import PossibleSizes

__all__ = ["WeakSets", "largest_groups_bound", "weak_sets"]

MOST_SETS = 20_000
"""Sets to ask about: a thousand take 2 to 7 seconds at 24 and 30 robots."""

WeakSets = list[tuple[float, frozenset[int]]]


def largest_groups_bound(task: AttackTask, possible: PossibleSizes, sets: WeakSets) -> None:
    """Raise the lower bound by asking each of ``sets``, all that are weak; relies on a non-decreasing objective.

    Raises
    ------
    OutOfBudget : the time is up; the bracket keeps what is proved by then.
    """
    bracket, budget = task.bracket, task.budget
    graph, n_robots = task.problem.threat.graph, task.problem.n_robots
    joining = {size: possible.largest(size) for size in {len(robots) for _, robots in sets}}
    for value, robots in sorted(sets, key=itemgetter(0)):
        bracket.raise_lower(min(value, bracket.goal))
        members = np.isin(np.arange(n_robots), list(robots))
        for inside, needed in joining[len(robots)]:
            group = scoring_group(graph, members, inside, needed, budget)
            if group is not None:
                _offer(task, robots, frozenset(np.flatnonzero(group).tolist()))
                bracket.raise_lower(min(value, bracket.goal))
                return
    bracket.raise_lower(bracket.goal)


def _offer(task: AttackTask, seeing: frozenset[int], group: frozenset[int]) -> None:
    """Offer the attack that separates a group from the others and blinds those in it that are not ``seeing``.

    What is left of the budget blinds the strongest others.
    """
    problem, threat = task.problem, task.problem.threat
    single, blinded = task.values.singletons(), group - seeing
    others = sorted(frozenset(range(problem.n_robots)) - group - threat.protected_robots, key=lambda i: -single[i])
    blinded |= frozenset(others[: threat.n_blinded - len(blinded)])
    cut = problem.communication.links_between([group, frozenset(range(problem.n_robots)) - group])
    if len(cut) <= threat.alpha_c and not (cut & threat.protected_links or blinded & threat.protected_robots):
        task.offer(Attack(blinded, frozenset(cut)))


def weak_sets(task: AttackTask, team: PackedTeam, possible: PossibleSizes) -> WeakSets | None:
    """Every set below the goal of a size that a largest group may have, with its value; ``None`` where too many.

    Larger sets than those of a size of which none is below the goal are not below it either.

    Raises
    ------
    OutOfBudget : the time is up, or no node is left.
    """
    if task.problem.n_robots > MOST_ROBOTS:
        return None
    lists = SetLists(team, np.argsort(-team.single, kind="stable"))
    sets: WeakSets = []
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
