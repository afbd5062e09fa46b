"""Compile before the work what searches compile when they are first used."""

from __future__ import annotations

from time import perf_counter

from ratt_opt.attackers.exact import worst_case_attack
from ratt_opt.main_job.bound import bound
from ratt_opt.missions.run import run_mission
from ratt_opt.running.progress import Step
from ratt_opt.scenario.generator import random_scenario
from ratt_opt.scenario.limited_view import limited_view_scenario
from ratt_opt.scenario.networks import network_scenario
from ratt_opt.setfunctions.criteria.registry import CRITERIA
from ratt_opt.solvers.ratt import ratt
from ratt_opt.solvers.refined import refined

__all__ = ["warm_up"]

SECONDS = 20.0
"""Of each of the small tasks, at most: they take less than one once all is compiled."""


def warm_up() -> float:
    """Do small tasks of every common kind, and return the seconds that took.

    The first search of a kind after an installation compiles its loops, which counts against its time limit: up to ten
    seconds. All kinds take about twenty. Compiled loops are kept on disk, so later processes need nothing. Call this
    once after an installation, or before a measurement of time. A terminal shows what it is at.
    """
    began = perf_counter()
    cameras = limited_view_scenario(6, 6, alpha_s=1, alpha_c=2, seed=0, view=60)
    with Step("warming up"):
        for objective in CRITERIA:
            for scenario in (random_scenario(6, 4, alpha_s=2, alpha_c=4, seed=0), cameras):
                bound(scenario, objective=objective, time_limit=SECONDS, guarantees="full")
            for family, n_robots in (("disk-6", 12), ("hubs", 20), ("dense", 26)):
                team = network_scenario(family, n_robots, 6, alpha_s=3, alpha_c=8, seed=0)
                problem = team.problem(objective)
                worst_case_attack(problem, ratt(problem), time_limit=SECONDS)
        refined(cameras.problem(), time_limit=1.0)
        run_mission(cameras, steps=2)
    return perf_counter() - began
