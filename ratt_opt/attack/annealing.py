"""Attacks by annealing partitions of the team and blinded robots together."""

from __future__ import annotations

from ctypes import byref, c_double, c_int, c_int64, c_uint32, c_uint64, c_void_p
from typing import TYPE_CHECKING

import numpy as np

from ratt_opt.attack.team import Team
from ratt_opt.native.library import address, function

if TYPE_CHECKING:
    from collections.abc import Iterator

    from ratt_opt._validation import FloatArray
    from ratt_opt.attack.groups import GroupList
    from ratt_opt.budget import Budget
    from ratt_opt.graph.threat import Threat

__all__ = ["annealed_attacks"]

STARTS, STEPS, AT_ONCE = 4, 400, 24_000
"""Starts, moves of each for a pair of robots, and moves between two looks at the clock."""
HOT, COLD = 0.02, 2e-5
"""Temperatures at first and at last, as shares of the whole team's value."""


def annealed_attacks(
    source: Team | FloatArray, whole: float, threat: Threat, graph: GroupList, budget: Budget
) -> Iterator[tuple[list[int], int]]:
    """Ever worse attacks: bit masks of their groups, which may be disconnected, and of the blinded robots.

    ``source`` : a team, or the values of all sets; ``whole`` : the whole team's value

    Raises
    ------
    OutOfBudget : the time is up, or the user interrupted.
    """
    n, hot = graph.robots, max(HOT * abs(whole), np.finfo(np.float64).tiny)
    call = function(
        "anneal",
        c_int,
        *[c_void_p] * 2,
        c_int,
        *[c_void_p] * 2,
        c_uint32,
        c_int,
        *[c_void_p] * 2,
        c_int64,
        *[c_double] * 2,
        *[c_void_p] * 4,
    )
    values = (None, source.reference) if isinstance(source, Team) else (address(source), None)
    guarded = sum(1 << i for i in threat.protected_robots)
    links = n, address(graph.neighbours), address(graph.protected), guarded, threat.alpha_c
    free = [i for i in range(n) if i not in threat.protected_robots]
    rng, seed, least = np.random.default_rng(0), c_uint64(1), c_double(np.inf)
    best_label, best_blinded = np.zeros(n, np.uint8), c_uint32(0)
    pieces = max(STEPS * n * n // AT_ONCE, 1)
    cooling = (COLD / HOT) ** (1 / pieces)
    for _ in range(STARTS):
        label, blinded = np.zeros(n, np.uint8), c_uint32(0)
        blinded.value = sum(1 << free[int(k)] for k in rng.permutation(len(free))[: threat.n_blinded])
        temperature = hot
        for _ in range(pieces):
            budget.check()
            steps = STEPS * n * n // pieces
            before, state = least.value, (address(label), byref(blinded), steps, temperature, cooling * temperature)
            kept = byref(seed), byref(least), address(best_label), byref(best_blinded)
            if call(*values, *links, *state, *kept):
                raise MemoryError
            temperature *= cooling
            if least.value < before:
                groups = [sum(1 << int(i) for i in np.flatnonzero(best_label == g)) for g in np.unique(best_label)]
                yield groups, best_blinded.value
