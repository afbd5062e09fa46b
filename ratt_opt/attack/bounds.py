"""Lower bounds that need no search: some group of a known size always survives, and robots that cannot be blinded."""

from __future__ import annotations

from functools import lru_cache
from typing import TYPE_CHECKING

import numpy as np

from ratt_opt.attack.params import DEFAULT
from ratt_opt.graph.largest_group.counting import counting_bound
from ratt_opt.graph.largest_group.spreading import forced_size, forced_weight
from ratt_opt.graph.survivor_sizes import forced_group_size

if TYPE_CHECKING:
    from ratt_opt._validation import FloatArray, IntArray
    from ratt_opt.attack.params.groups import AttackBoundParams
    from ratt_opt.budget import Budget
    from ratt_opt.graph.threat import Threat
    from ratt_opt.setfunctions.information import InformationObjective

__all__ = [
    "ROUNDING",
    "first_bound",
    "forced_survivors",
    "rounded_down",
    "strongest_left",
    "tree_bound",
    "weakest_average",
]


@lru_cache(maxsize=8)
def forced_survivors(threat: Threat) -> int:
    """Robots that some group keeps seeing under any attack; kept, as every exact attack asks.

    On a complete graph the integer partitions decide (``forced_group_size``; protected links only help).
    Any graph is a complete one whose missing links are cut already, and its largest group has at
    least ``counting_bound`` robots, of which ``n_blinded`` may be blinded.
    """
    n_robots, links = threat.graph.n_robots, len(threat.graph.links)
    missing = n_robots * (n_robots - 1) // 2 - links
    by_sizes = forced_group_size(n_robots, threat.n_blinded, threat.alpha_c + missing)
    return max(by_sizes, counting_bound(threat) - threat.n_blinded, 1 if threat.n_blinded < n_robots else 0)


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
