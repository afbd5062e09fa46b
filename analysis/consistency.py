"""Consistency of the filter's covariance: one step at the paper's nine large cases, for each linearisation.

``python -m analysis.consistency --trials 40 --out DIR``
"""

from __future__ import annotations

import re
import sys
from typing import TYPE_CHECKING

import numpy as np

from analysis.paper.large_scale import STUDY as PAPER
from ratt_opt.attack.heuristics import bounded_rational_attack
from ratt_opt.missions.players.attack_models import RenewedAttacks
from ratt_opt.missions.sensing import group_pieces, simulated_readings
from ratt_opt.missions.world import Linearisation, MissionModel, World
from ratt_opt.problem import Attack
from ratt_opt.scenario.generator import random_scenario
from ratt_opt.solvers.ratt import ratt
from ratt_opt.studies.command import Entry, main
from ratt_opt.studies.plots import IN_TURN, new_figure, save
from ratt_opt.studies.statistics import column, estimate, select
from ratt_opt.studies.study import Study

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence
    from pathlib import Path

    from ratt_opt._validation import FloatArray
    from ratt_opt.studies.cases import Case, Cell, Seeds

LINEARISATIONS: tuple[Linearisation, ...] = ("first order", "second order", "iterated")
DRAWS = 40
"""True states and measurements drawn in each trial."""


def measure(study: Study, case: Case, seeds: Seeds) -> dict[str, Cell]:  # noqa: ARG001  (the engine's form)
    """``linearisation/mse``, ``/trace`` [m^2 per target] and ``/nees`` over its expected value.

    RATT's plan for that linearisation, the bounded-rational attack, the best group's update.
    """
    scenario = random_scenario(
        case.n_robots, case.n_targets, alpha_s=case.alpha_s, alpha_c=case.alpha_c, seed=seeds.scenario
    )
    row: dict[str, Cell] = {}
    for linearisation in LINEARISATIONS:
        world = World(scenario, MissionModel(linearisation=linearisation), 1)
        belief, offered = world.motion.initial(scenario), world.sequences(scenario.poses)
        threatened = RenewedAttacks().threatened(0, Attack(), scenario)
        problem = world.problem(world.criterion(belief, offered, 0.0), offered.owner, scenario.poses, threatened)
        plan = ratt(problem).elements
        group = problem.best_group(plan, bounded_rational_attack(problem, plan).attack)
        found = _updates(world, offered.poses[plan, 0], group, seeds.simulation)
        row |= {f"{linearisation}/{name}": value for name, value in found.items()}
    return row


def _updates(world: World, poses: FloatArray, group: frozenset[int], seed: int) -> dict[str, float]:
    predicted = world.motion.initial(world.scenario).predicted(world.motion, world.period, 0.0)
    rng = np.random.default_rng(seed)
    root = np.linalg.cholesky(predicted.covariance)
    squared, trace, nees = [], [], []
    for _ in range(DRAWS):
        truth = predicted.mean + (root @ rng.standard_normal((*predicted.mean.shape, 1)))[..., 0]
        luck = rng.standard_normal((len(poses), *truth.shape))
        readings = dict(enumerate(simulated_readings(world, poses, truth, luck)))
        pieces, _ = group_pieces(world, predicted, dict(enumerate(poses)), readings, group)
        belief = predicted.updated(pieces.information.sum(axis=0), pieces.vector.sum(axis=0))
        squared.append(((belief.mean - truth) ** 2).sum(axis=1).mean())
        trace.append(belief.trace / len(truth))
        nees.append(belief.nees(truth).mean() / 2)
    return {"mse": float(np.mean(squared)), "trace": float(np.mean(trace)), "nees": float(np.mean(nees))}


STUDY = Study(name="consistency", cases=PAPER.cases, measure=measure)


def ratios(rows: Sequence[Mapping[str, str]], linearisation: str) -> dict[str, float]:
    """Mean squared error over mean trace, case by case: both are means over all trials."""
    found = {}
    for case in dict.fromkeys(row["case"] for row in rows):
        kept = select(rows, case=case)
        found[case] = float(column(kept, f"{linearisation}/mse").mean() / column(kept, f"{linearisation}/trace").mean())
    return found


def draw(rows: Sequence[Mapping[str, str]], folder: Path) -> None:
    """Mean squared error over trace in every case, trial by trial, with intervals."""
    figure = new_figure(9, 4)
    axes = figure.subplots()
    names = list(dict.fromkeys(row["case"] for row in rows))
    for k, (linearisation, marker) in enumerate(zip(LINEARISATIONS, "osD", strict=True)):
        kept = [select(rows, case=name) for name in names]
        excess = [estimate(column(r, f"{linearisation}/mse") / column(r, f"{linearisation}/trace")) for r in kept]
        spread = np.array([[e.mean - e.low for e in excess], [e.high - e.mean for e in excess]])
        spread[~np.isfinite(spread)] = 0.0
        at = np.arange(len(names)) + 0.2 * (k - 1)
        axes.errorbar(
            at, [e.mean for e in excess], spread, fmt=marker, color=IN_TURN[k], capsize=2, label=linearisation
        )
    axes.axhspan(0.95, 1.10, color="#dddddd", zorder=0, label="0.95 to 1.10")
    labels = [re.sub(r"alpha_(\w)", r"$\\alpha_\1$", name).replace(" ", "\n") for name in names]
    axes.set_xticks(range(len(names)), labels, fontsize=8)
    axes.set_ylabel("mean squared error /\ntrace of covariance")
    axes.legend(frameon=False, ncols=4, fontsize=8)
    save(figure, folder, STUDY.name)


ENTRY = Entry(STUDY, draw)

if __name__ == "__main__":
    sys.exit(main("Does the filter's covariance tell its error?", [ENTRY], trials=40))
