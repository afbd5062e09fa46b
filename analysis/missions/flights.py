"""Planners under attackers over whole missions, under every attack model: one study for each size of team.

``python -m analysis.missions.flights --trials 100 --out DIR``; ``--only flights_5`` flies the teams of five alone.
"""

from __future__ import annotations

import sys
from dataclasses import replace
from functools import partial
from typing import TYPE_CHECKING

import numpy as np

from ratt_opt.missions.players.planners import MaxMinPlanner, RandomPlanner
from ratt_opt.missions.run import run_mission
from ratt_opt.missions.world import MissionModel
from ratt_opt.scenario.generator import random_scenario
from ratt_opt.studies.cases import Case
from ratt_opt.studies.command import Entry, main
from ratt_opt.studies.plots import new_figure, points, save
from ratt_opt.studies.statistics import column, estimate, players, select
from ratt_opt.studies.study import Study

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence
    from pathlib import Path

    from ratt_opt.missions.players.planners import Planner
    from ratt_opt.problem import Problem
    from ratt_opt.solvers.result import MaxMinResult
    from ratt_opt.studies.cases import Cell, Seeds

STEPS = 50
SIZES = ((5, 8), (10, 15), (20, 20))
MODELS = (
    ("renewed", "best group"),
    ("renewed", "all surviving"),
    ("persistent", "all surviving"),
    ("permanent", "all surviving"),
)
MODEL = MissionModel(linearisation="second order")
SETTLED = 10
"""Steps after which the first uncertainty of 3 m is forgotten; means are over the rest of a mission."""
MAXMIN = MaxMinPlanner(gap=1e-3, max_nodes=10)
"""Limited by nodes, not by time, so that missions are the same on every machine."""


def nonrobust(problem: Problem) -> MaxMinResult:
    """The best plan if nobody attacks, searched as :data:`MAXMIN` searches."""
    return MAXMIN(replace(problem, alpha_s=0, alpha_c=0))


def cases(sizes: Sequence[tuple[int, int]], models: Sequence[tuple[str, str]]) -> tuple[Case, ...]:
    """Sizes with the paper's smallest budgets, times attack models."""
    return tuple(
        Case(
            n_robots=n,
            n_targets=m,
            alpha_s=n // 3,
            alpha_c=n * (n - 1) // 8,
            options=(("attacks", attacks), ("sharing", sharing)),
        )
        for n, m in sizes
        for attacks, sharing in models
    )


def measure(study: Study, case: Case, seeds: Seeds) -> dict[str, Cell]:
    """One mission for each planner and attacker: ``planner/attacker/metric``, means over the settled steps.

    ``rmse`` [m], ``trace`` of the position covariance per target [m^2], ``nees`` over its expected value, and ``last``,
    the RMSE of the last step [m].
    """
    options = dict(case.options)
    scenario = random_scenario(
        case.n_robots, case.n_targets, alpha_s=case.alpha_s, alpha_c=case.alpha_c, seed=seeds.scenario
    )
    searched: dict[str, Planner] = {
        "maxmin": MAXMIN,
        "nonrobust_optimum": nonrobust,
        "random": RandomPlanner(seeds.planner),
    }
    row: dict[str, Cell] = {}
    for planner, chosen in study.named_planners.items():
        for attacker, striking in study.named_attackers.items():
            mission = run_mission(
                scenario,
                steps=STEPS,
                planner=searched.get(planner) or chosen,
                attacker=striking,
                attacks=str(options["attacks"]),
                sharing=str(options["sharing"]),
                seed=seeds.simulation,
                model=MODEL,
            )
            found = {
                "rmse": float(np.sqrt(mission.squared_errors[SETTLED:].mean())),
                "trace": float(mission.traces[SETTLED:].mean()),
                "nees": float(mission.nees[SETTLED:].mean()) / mission.dimension,
            }
            row |= {f"{planner}/{attacker}/{metric}": found[metric] for metric in study.metrics}
    return row


def study_of(n_robots: int, n_targets: int) -> Study:
    """Missions of teams of one size under the worst attacks."""
    return Study(
        name=f"flights_{n_robots}",
        cases=cases([(n_robots, n_targets)], MODELS),
        planners=("ratt", "greedy", "myopic", "random"),
        attackers=("worst",),
        metrics=("rmse", "trace", "nees"),
        measure=measure,
    )


STUDIES = tuple(study_of(n, m) for n, m in SIZES)
MILD = Study(
    name="mild_flights",
    cases=cases(SIZES, MODELS[:2]),
    planners=("ratt", "greedy"),
    attackers=("none", "random", "bounded_rational"),
    metrics=("rmse", "trace", "nees"),
    measure=measure,
)
"""Cost of planning for the worst case if nobody attacks, or an attacker who does not see what hurts most."""


def draw_study(study: Study, rows: Sequence[Mapping[str, str]], folder: Path) -> None:
    """RMSE of every planner, by attack model, under every attacker."""
    sizes = list(dict.fromkeys(case.n_robots for case in study.cases))
    figure = new_figure(11, 3.4 * len(sizes))
    met = players(rows, "rmse")
    axes = figure.subplots(len(sizes), len(met), squeeze=False)
    for down, n in enumerate(sizes):
        kept = [(case, select(rows, case=case.name)) for case in study.cases if case.n_robots == n]
        groups = [f"{dict(case.options)['attacks']}\n{dict(case.options)['sharing']}" for case, _ in kept]
        for across, (attacker, planners) in enumerate(met.items()):
            series = {p: [estimate(column(k, f"{p}/{attacker}/rmse")) for _, k in kept] for p in planners}
            points(axes[down, across], groups, series)
            axes[down, across].set_title(f"N={n}, attacker: {attacker}")
        axes[down, 0].set_ylabel("RMSE of target positions [m]")
    handles, labels = axes[0, 0].get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside upper center", ncols=len(labels), frameon=False)
    trials = len(select(rows, case=study.cases[0].name))
    figure.supxlabel(f"{trials} paired missions of {STEPS} steps, means with 95 % interval", fontsize="small")
    save(figure, folder, study.name)


ENTRIES = [Entry(study, partial(draw_study, study)) for study in (*STUDIES, MILD)]

if __name__ == "__main__":
    sys.exit(main("Planners over whole missions.", ENTRIES, trials=100))
