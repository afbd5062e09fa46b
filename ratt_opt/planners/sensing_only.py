"""Resilient active target tracking: RATT's predecessor, which knows of lost sensors and not of links."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ratt_opt.problem import Plan, Problem, check_problem
from ratt_opt.solvers.ratt import bait_and_greedy

if TYPE_CHECKING:
    from ratt_opt.budget import Budget

__all__ = ["sensing_only"]


def sensing_only(problem: Problem, *, budget: Budget | None = None) -> Plan:
    """Plan against ``alpha_s`` lost robots: RATT that takes link attacks for nothing.

    On one element per robot it makes the choices of :func:`ratt_opt.planners.resilient_selection`, robot by robot.

    Guarantee: as there; that of :func:`ratt_opt.sensing_only_bound`.

    Source: Zhou, Tzoumas, Pappas, Tokekar, Resilient active target tracking with multiple robots, IEEE Robotics and
    Automation Letters 4(1), 2019. Not read here: the algorithm is Algorithm 1 of ratt.tex for lost sensors alone, which
    cites it.
    """
    return bait_and_greedy(problem, check_problem(problem, knows_at_most=True).alpha_s, budget)
