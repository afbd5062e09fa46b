"""Lower bounds on the worst case of a team of any size on a complete graph, at once.

Whoever is not blinded is in some group, so the best group is worth at least the strongest robot that the attacker
cannot afford to blind. And some group keeps ``k`` seeing robots (``graph/survivor_sizes.py``): its information is the
average, over its robots ``i``, of the prior's and ``k`` times that of ``i``, and the value is concave in the
information, so the group is worth at least the average of ``value(k copies of i)``, hence of the ``k`` least of these.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ratt_opt.graph.survivor_sizes import forced_group_size

if TYPE_CHECKING:
    from ratt_opt.attackers.weakest_set.planar_team import PlanarTeam
    from ratt_opt.graph.threat import Threat

__all__ = ["first_bound", "weakest_average"]

ROUNDING = 1e-12
"""Relative: values are sums of a few hundred numbers."""


def first_bound(team: PlanarTeam, threat: Threat) -> float:
    """No attack leaves less than this; relies on a non-decreasing objective. ``-inf`` where all may be blinded."""
    n_robots = len(team.single)
    size = forced_group_size(n_robots, threat.n_blinded, threat.alpha_c)
    if size == 0:
        return -np.inf
    seeing = sorted((i not in threat.protected_robots, -value) for i, value in enumerate(team.single.tolist()))
    protected = len(threat.protected_robots)
    alone = float(-seeing[0][1]) if protected else -np.inf
    if threat.n_blinded < n_robots - protected:
        alone = max(alone, -seeing[protected + threat.n_blinded][1])
    bound = max(alone, weakest_average(team, size))
    return float(bound - ROUNDING * abs(bound))


def weakest_average(team: PlanarTeam, size: int) -> float:
    """No set of ``size >= 1`` robots is worth less."""
    worths = np.array([float(team.values(team.prior + size * one)) for one in team.information])
    return float(np.partition(worths, size - 1)[:size].mean())
