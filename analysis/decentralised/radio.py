"""Times of the baselines' messages, by the radios and the message sizes of the library's own planner."""

from __future__ import annotations

from ratt_opt.decentralised.faults import RadioParams
from ratt_opt.decentralised.messages import HEADER, OFFER
from ratt_opt.problem import Problem

__all__ = ["LONG", "RADIO", "element_bytes", "neighbours", "sending", "with_cuts"]

RADIO = RadioParams()
LONG = 45
"""The longer range of radios [m]."""


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


def with_cuts(problem: Problem, alpha_c: int) -> Problem:
    """The problem for an adversary who may cut links as well, as far as there are any."""
    alpha_c = min(alpha_c, len(problem.communication.links))
    return Problem(problem.objective, problem.robot, problem.graph, problem.alpha_s, alpha_c)
