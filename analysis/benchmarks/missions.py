"""How long one step of a mission takes, by team and horizon.

Run as ``python -m analysis.benchmarks.missions [--steps 20]``: medians over the steps of a mission under random attacks
(building the problem is part of a step), and brackets of the optimum of the first step several steps ahead.
"""

from __future__ import annotations

import argparse
from time import perf_counter
from typing import TYPE_CHECKING

import numpy as np

from analysis.tables import print_table
from ratt_opt import MaxMinPlanner, MissionModel, random_scenario, ratt, run_mission, solve_maxmin
from ratt_opt._rounding import relative_gap
from ratt_opt.missions.beam import best_alone, solve_by_columns
from ratt_opt.missions.planning import offered_sequences
from ratt_opt.missions.players.attack_models import RenewedAttacks
from ratt_opt.missions.world import World
from ratt_opt.problem import Attack

if TYPE_CHECKING:
    from ratt_opt.missions.ahead.horizon import Sequences
    from ratt_opt.missions.players.planners import Planner
    from ratt_opt.problem import Problem

TEAMS = ((10, 15, 3, 11), (30, 25, 10, 108))
BEAM = 24


def first_step(world: World, sequences: Sequences) -> Problem:
    """The problem of a mission's first step over these sequences."""
    scenario = world.scenario
    criterion, kept = world.objective(world.motion.initial(scenario), sequences, 0.0)
    threatened = RenewedAttacks().threatened(0, Attack(), scenario)
    return world.problem(criterion, kept.owner, scenario.poses, threatened)


def flown(steps: int) -> list[dict[str, object]]:
    """Median planning seconds of whole missions."""
    rows = []
    for n, m, alpha_s, alpha_c in TEAMS:
        scenario = random_scenario(n, m, alpha_s=alpha_s, alpha_c=alpha_c, seed=0)
        planners: dict[str, Planner] = {
            "ratt": ratt,
            "maxmin to 1e-3": MaxMinPlanner(gap=1e-3, max_nodes=None, time_limit=60.0),
        }
        for name, planner in planners.items():
            if n > TEAMS[0][0] and name != "ratt":
                continue
            run_mission(scenario, steps=1, planner=planner, attacker="random")  # imports
            mission = run_mission(scenario, steps=steps, planner=planner, attacker="random")
            rows.append(_row(f"N={n} M={m}", 1, name, float(np.median(mission.seconds))))
    return rows


def ahead() -> list[dict[str, object]]:
    """Seconds and gaps of the first step, two and three steps ahead."""
    rows = []
    n, m, alpha_s, alpha_c = TEAMS[0]
    scenario = random_scenario(n, m, alpha_s=alpha_s, alpha_c=alpha_c, seed=0)
    for horizon, motion, beam in (
        (2, "known velocity", None),
        (2, "constant velocity", None),
        (3, "known velocity", BEAM),
    ):
        world = World(scenario, MissionModel(motion=motion, beam=beam), horizon)
        ratt(
            first_step(world, offered_sequences(world, world.motion.initial(scenario), scenario.poses, 0.0))
        )  # imports
        began = perf_counter()
        problem = first_step(world, offered_sequences(world, world.motion.initial(scenario), scenario.poses, 0.0))
        ratt(problem)
        seconds = perf_counter() - began
        label = f"N={n} M={m}, {motion}" + (f", beam of {beam}" if beam else "")
        rows.append(_row(label, horizon, "ratt", seconds))
        began = perf_counter()
        if beam is None:
            found = solve_maxmin(problem, gap=0.01, time_limit=30.0)
        else:
            whole = first_step_of_all(world)
            start = best_alone(whole.objective.singletons(), whole.robot, BEAM)
            found = solve_by_columns(whole, start, gap=0.01, time_limit=60.0)
        spent = perf_counter() - began
        rows.append(_row(label, horizon, "maxmin to 1 %", spent, relative_gap(found.lower, found.upper)))
    return rows


def _row(team: str, horizon: int, planner: str, seconds: float, gap: float | str = "") -> dict[str, object]:
    return {"team": team, "H": horizon, "planner": planner, "seconds": seconds, "gap": gap}


def first_step_of_all(world: World) -> Problem:
    """The problem of the first step over all sequences, dominated ones included."""
    scenario, offered = world.scenario, world.sequences(world.scenario.poses)
    criterion = world.criterion(world.motion.initial(scenario), offered, 0.0)
    threatened = RenewedAttacks().threatened(0, Attack(), scenario)
    return world.problem(criterion, offered.owner, scenario.poses, threatened)


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--steps", type=int, default=20)
    options = parser.parse_args()
    print_table("One step of a mission", [*flown(options.steps), *ahead()])


if __name__ == "__main__":
    main()
