"""Planners under attackers over missions of cameras that turn: the main cell, then one factor varied at a time.

``python -m analysis.limited_views --trials 60 --out DIR``; ``--only limited_views_main`` flies the main cell alone.
"""

import numpy as np

from ratt_opt._validation import BoolArray
from ratt_opt.missions.mission import Mission
from ratt_opt.missions.players.planners import MaxMinPlanner
from ratt_opt.missions.run import run_mission
from ratt_opt.scenario.limited_view import SENSORS, limited_view_scenario
from ratt_opt.scenario.model import Scenario
from ratt_opt.scenario.sensor import Sensor, measure
from ratt_opt.studies.cases import Case, Cell, Seeds
from ratt_opt.studies.command import Entry
from ratt_opt.studies.study import Study

__all__ = [
    "COMPLETE",
    "ENTRIES",
    "MAIN",
    "METRICS",
    "PLANNERS",
    "STEPS",
    "STUDIES",
    "UNLIMITED",
    "VARIED",
    "case_of",
    "scenario_of",
    "sighted",
]

STEPS = 20
"""Steps of a mission. Windows are the first and the last half, which share no step."""
PLANNERS = ("greedy", "ratt", "refined", "maxmin", "myopic")
"""Planners by the names of ``run_mission``; all are compared with the first."""
SEARCHED: dict[str, MaxMinPlanner] = {"maxmin": MaxMinPlanner(gap=1e-3, max_nodes=10)}
"""Limited by nodes, not by time, so that missions are the same on every machine."""
METRICS = ("rmse", "rmse_first_half", "rmse_last_half", "largest", "unseen", "longest")
NOISES = {**SENSORS, "coarse": Sensor()}
"""``coarse`` is the sensor of ``random_scenario``, whose noise grows with the distance."""
COMPLETE, UNLIMITED = "complete", "unlimited"


def case_of(
    *,
    n_targets: int = 6,
    view: int = 60,
    reach: str | int = 40,
    noise: str = "camera",
    links: str | int = 45,
    attacks: str = "renewed",
) -> Case:
    """Six robots, two of which may be blinded, and four links that may be cut; the rest is the demo's, or varies.

    ``view`` [degrees], ``reach`` [m], ``links`` : complete, or the range of a disk network [m].
    """
    options: tuple[tuple[str, Cell], ...] = (("view", view), ("reach", reach), ("noise", noise), ("links", links))
    return Case(n_robots=6, n_targets=n_targets, alpha_s=2, alpha_c=4, options=(*options, ("attacks", attacks)))


def scenario_of(case: Case, seeds: Seeds) -> Scenario:
    """The team of one trial; a network with fewer links than may be cut can lose all of them."""
    options = dict(case.options)
    reach, links = options["reach"], options["links"]
    drawn = limited_view_scenario(
        case.n_robots,
        case.n_targets,
        alpha_s=case.alpha_s,
        alpha_c=0,
        seed=seeds.scenario,
        view=float(options["view"]),
        reach=None if reach == UNLIMITED else float(reach),
        communication_range=None if links == COMPLETE else float(links),
        sensor=NOISES[str(options["noise"])],
    )
    return drawn.replace(alpha_c=min(case.alpha_c, len(drawn.problem().communication.links)))


def measured(study: Study, case: Case, seeds: Seeds) -> dict[str, Cell]:
    """One mission for each planner and attacker: ``planner/attacker/metric``."""
    scenario = scenario_of(case, seeds)
    row: dict[str, Cell] = {}
    for planner, chosen in study.named_planners.items():
        for attacker, striking in study.named_attackers.items():
            mission = run_mission(
                scenario,
                steps=STEPS,
                planner=SEARCHED.get(planner, chosen),
                attacker=striking,
                attacks=str(dict(case.options)["attacks"]),
                seed=seeds.simulation,
            )
            found = figures_of(mission)
            row |= {f"{planner}/{attacker}/{metric}": found[metric] for metric in study.metrics}
    return row


def figures_of(mission: Mission) -> dict[str, float]:
    """Errors of the team's estimates, and how long targets go unseen.

    Root mean squared errors over all targets and steps and over each half of the steps [m]; the ``largest`` error [m];
    the share of targets and steps ``unseen`` [%]; the ``longest`` run of steps in which one target is unseen.
    """
    squared, seen = mission.squared_errors, sighted(mission)
    half = len(squared) // 2
    return {
        "rmse": float(np.sqrt(squared.mean())),
        "rmse_first_half": float(np.sqrt(squared[:half].mean())),
        "rmse_last_half": float(np.sqrt(squared[half:].mean())),
        "largest": float(np.sqrt(squared.max())),
        "unseen": 100.0 * float(1.0 - seen.mean()),
        "longest": float(max(map(_longest_gap, seen.T))),
    }


def sighted(mission: Mission) -> BoolArray:
    """(T, M) whether a robot whose measurements reach the team's group measured the target in that step."""
    rows = []
    for step in mission.steps:
        here = step.poses[sorted(step.team.see)]
        distance, bearing = np.moveaxis(measure(here[:, None], step.truth[None, :, :2]), -1, 0)
        rows.append(mission.scenario.sensor.sees(distance, bearing).any(axis=0))
    return np.array(rows)


def _longest_gap(seen: BoolArray) -> int:
    edges = np.flatnonzero(np.concatenate([[True], seen, [True]]))
    return int(np.diff(edges).max()) - 1


def _study(name: str, attackers: tuple[str, ...], cases: tuple[Case, ...]) -> Study:
    return Study(
        name=f"limited_views_{name}",
        cases=cases,
        planners=PLANNERS,
        attackers=attackers,
        metrics=METRICS,
        measure=measured,
    )


MAIN = _study("main", ("worst", "none"), (case_of(),))
"""The kind of team that ``bite.py`` chooses."""
VARIED = _study(
    "varied",
    ("worst",),
    (
        case_of(view=30),
        case_of(view=120),
        case_of(view=360),
        case_of(reach=30),
        case_of(reach=UNLIMITED),
        case_of(links=30),
        case_of(links=COMPLETE),
        case_of(n_targets=3),
        case_of(n_targets=10),
        case_of(noise="radar"),
        case_of(noise="coarse"),
        case_of(attacks="persistent"),
    ),
)
STUDIES = (MAIN, VARIED)
ENTRIES = [Entry(study) for study in STUDIES]
