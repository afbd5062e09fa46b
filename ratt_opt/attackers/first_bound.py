"""A lower bound on the worst case of a team of any size on any graph, at once.

Whoever is not blinded is in some group, so the best group is worth at least the strongest robot that the attacker
cannot afford to blind. And some group keeps ``k`` seeing robots (``forced_survivors``), so it is worth at least the
k-th smallest individual value. Its information is the average, over its robots ``i``, of the prior's and ``k`` times
that of ``i``, and the value is concave in the information, so the group is also worth at least the average of
``value(k copies of i)``, hence of the ``k`` least of these.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ratt_opt.attackers.forced_group import forced_survivors

if TYPE_CHECKING:
    from ratt_opt._validation import FloatArray, IntArray
    from ratt_opt.graph.threat import Threat
    from ratt_opt.setfunctions.information import InformationObjective

__all__ = ["first_bound", "rounded_down", "strongest_left", "weakest_average"]

ROUNDING = 1e-12
"""Relative: values are sums of a few hundred numbers."""


def first_bound(objective: InformationObjective, plan: IntArray, threat: Threat, least: int = 0) -> float:
    """No attack on a plan (N,) leaves less; relies on a non-decreasing objective. ``-inf`` where all may be blinded.

    ``least`` : seeing robots that are known to be left in some group
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
    """No set of ``size >= 1`` robots of a plan (N,) is worth less, but for rounding."""
    worths = objective.value(objective.prior_information + size * objective.information[plan])
    return float(np.partition(worths, size - 1)[:size].mean())


def strongest_left(single: FloatArray, threat: Threat) -> float:
    """The largest individual value once the strongest robots that may be are blinded."""
    is_protected = np.isin(np.arange(len(single)), list(threat.protected_robots))
    left = np.sort(single[~is_protected])[: len(single) - int(is_protected.sum()) - threat.n_blinded]
    return float(max(left.max(initial=-np.inf), single[is_protected].max(initial=-np.inf)))
