"""Sequential greedy among neighbours: robots choose in order of their numbers, beside what earlier neighbours chose.

A robot sends its choice to its later neighbours, one after the other, as soon as its earlier ones have. It ignores
attacks, and costs one message a link.

Source: the sequential greedy of Fisher, Nemhauser, Wolsey 1978 with what is heard in one hop, as Gharesifard and Smith
2017 study it.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from analysis.decentralised.radio import RADIO, element_bytes, neighbours, sending

if TYPE_CHECKING:
    from ratt_opt._validation import IntArray
    from ratt_opt.problem import Problem

__all__ = ["neighbour_greedy"]


def neighbour_greedy(problem: Problem) -> tuple[IntArray, float]:
    """Return the plan (N,) and its decision time [s]."""
    near, each = neighbours(problem), sending(element_bytes(problem))
    elements, ready = np.zeros(problem.n_robots, dtype=np.int64), [0.0] * problem.n_robots
    for i, choice in enumerate(problem.choices):
        heard = np.sort(elements[[j for j in near[i] if j < i]])
        elements[i] = choice[np.argmax(problem.objective.extensions(heard, choice))]
        for place, j in enumerate([j for j in near[i] if j > i], start=1):
            ready[j] = max(ready[j], ready[i] + place * each + RADIO.delay[1])
    return elements, max(ready)
