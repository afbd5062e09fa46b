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

from ratt_opt.attackers.first_bound import rounded_down, weakest_average
from ratt_opt.graph.largest_group.spreading import forced_size, forced_weight

if TYPE_CHECKING:
    from ratt_opt._validation import IntArray
    from ratt_opt.budget import Budget
    from ratt_opt.graph.threat import Threat
    from ratt_opt.setfunctions.information import InformationObjective

__all__ = ["tree_bound"]

LARGEST_WEIGHT = 2**20


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
