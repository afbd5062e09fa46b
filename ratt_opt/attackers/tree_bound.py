"""A lower bound on the worst case of a team on any graph, from tree inequalities: seconds for hundreds of robots.

The value is concave in the information and 0 without any, so a set of at most ``k`` robots, whose information is the
average over ``k`` places of the prior's and ``k`` times that of the robot in each, or of nobody, is worth at least the
sum over its robots of

    a_k(i) = value(k copies of i) / k.

Some group keeps weight ``P_k`` in these after every attack (``spreading.py``). If it has at most ``k`` robots it is
worth that, else at least the weakest ``k + 1`` robots. The better ``k`` makes the first small and the second large:
the bound is the best of ``min(P_k, weakest k + 1 robots)``.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ratt_opt.attackers.first_bound import first_bound, rounded_down, weakest_average
from ratt_opt.graph.largest_group.spreading import forced_size, forced_weight

if TYPE_CHECKING:
    from ratt_opt._validation import IntArray
    from ratt_opt.attackers.task import AttackTask
    from ratt_opt.budget import Budget
    from ratt_opt.graph.threat import Threat
    from ratt_opt.setfunctions.information import InformationObjective

__all__ = ["bound_by_trees", "tree_bound"]

LARGEST_WEIGHT = 2**20

TREE_SHARE, TREES_SHORT = 0.025, (0.05, 0.5)
"""Of what is left of the budget for tree inequalities, which on dense graphs are not asked: there they used up their
share and proved nothing; of a short search more, up to so many seconds, as the first threshold is half-way up from
what they prove. Measured at 100 robots of disk-6 and of a small world: trees prove 79 and 63 % of the attack in a
minute, prices 75 % in a second. What they say of sizes counts more: on disk-12 of 50 robots, (10, 45), a group that
keeps 18 is known after two seconds, 17 after one, and bounds of sizes say 97.2 instead of 96.6 % with it."""


def bound_by_trees(task: AttackTask, objective: InformationObjective, *, is_about_values: bool) -> int:
    """Unblinded robots that every attack leaves in a group, by tree inequalities; the bracket has their value.

    ``is_about_values`` : also ask for trees weighted by what robots are worth

    Raises
    ------
    OutOfBudget : the time is up.
    """
    budget, bracket, (share, seconds) = task.budget, task.bracket, TREES_SHORT
    plan, threat = task.values.plan, task.problem.threat
    part = budget.part(TREE_SHARE, at_least=min(share * budget.seconds_left, seconds))
    size = forced_size(threat, part, threat.graph.n_robots)
    bracket.raise_lower(first_bound(objective, plan, threat, size))
    if is_about_values:
        bracket.raise_lower(tree_bound(objective, plan, threat, part, bracket.upper))
    budget.check()
    return size


def tree_bound(objective: InformationObjective, plan: IntArray, threat: Threat, budget: Budget, enough: float) -> float:
    """No attack on a plan (N,) leaves less; relies on a non-decreasing objective. ``-inf`` where nothing is known.

    ``enough`` : no more is asked for; ``budget`` : once it is spent, what is known by then
    """
    seeing = threat.graph.n_robots - threat.n_blinded
    low, high, best = forced_size(threat, budget, seeing), seeing, -np.inf
    while 0 < low <= high and best < enough and budget.stop() is None:
        k = (low + high) // 2
        kept = _kept_value(objective, plan, threat, budget, k)
        larger = weakest_average(objective, plan, k + 1) if k < seeing else np.inf
        best = max(best, min(kept, larger))
        low, high = (k + 1, high) if larger < kept else (low, k - 1)
    return rounded_down(best, objective) if best > -np.inf else best


def _kept_value(objective: InformationObjective, plan: IntArray, threat: Threat, budget: Budget, k: int) -> float:
    """What a group of at most ``k`` robots that keeps the forced weight is worth at least."""
    weights = np.maximum(objective.value(objective.prior_information + k * objective.information[plan]) / k, 0.0)
    if not weights.max() > 0:
        return 0.0
    unit = weights.max() / LARGEST_WEIGHT
    whole = np.floor(weights / unit).astype(np.int64)
    return float(unit) * forced_weight(threat, whole, budget, int(whole.sum()))
