"""Times of the baselines' messages, by the radios and the message sizes of the library's own planner."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ratt_opt.decentralised.faults import RadioParams
from ratt_opt.decentralised.messages import HEADER, OFFER

if TYPE_CHECKING:
    from ratt_opt.problem import Problem

__all__ = ["RADIO", "element_bytes", "neighbours", "sending"]

RADIO = RadioParams()


def sending(size: float) -> float:
    """Seconds in which a radio sends a number of bytes [s]."""
    return 8 * size / RADIO.bandwidth


def element_bytes(problem: Problem, elements: int = 1) -> int:
    """Bytes of a packet with the information of some elements: lower triangles, target after target."""
    d = problem.information_objective.dimension
    floats = problem.information_objective.n_targets * d * (d + 1) // 2
    return HEADER.size + elements * (OFFER.size + 8 * floats)


def neighbours(problem: Problem) -> list[list[int]]:
    """Robots in reach of each robot, ascending."""
    return [list(problem.communication.neighbours_of(i)) for i in range(problem.n_robots)]
