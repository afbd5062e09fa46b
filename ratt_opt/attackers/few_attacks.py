"""Every attack of the whole budgets, valued one by one: exact where attacks are few, however large the team is."""

from __future__ import annotations

from itertools import combinations
from typing import TYPE_CHECKING

from ratt_opt.budget import Stop
from ratt_opt.graph.few_cuts import partitions_by_few_cuts
from ratt_opt.problem import Attack

if TYPE_CHECKING:
    from ratt_opt.attackers.task import AttackTask

__all__ = ["try_every_attack"]


def try_every_attack(task: AttackTask) -> Stop:
    """Find the worst attack of a plan by trying all; relies on a non-decreasing objective.

    Then some worst attack uses its whole budgets. A robot blinded in one group leaves the others as they are, so each
    set of robots is valued once.

    Raises
    ------
    OutOfBudget : the time is up, or no node is left; the bracket keeps the worst attack tried.
    """
    threat, worth = task.problem.threat, dict[frozenset[int], float]()
    free = sorted(set(range(task.problem.n_robots)) - threat.protected_robots)
    for cut, groups in partitions_by_few_cuts(threat, task.budget):
        for blinded in map(frozenset, combinations(free, threat.n_blinded)):
            task.budget.check()
            left = [group - blinded for group in groups]
            for group in left:
                if group not in worth:
                    worth[group] = task.values(group)
            task.bracket.offer(Attack(blinded, cut), max(worth[group] for group in left))
    task.bracket.raise_lower(task.bracket.upper)
    return Stop.CLOSED
