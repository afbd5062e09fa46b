"""Studies of missions by one call: planners against attackers; truth and noise, or teams too, differ by trial."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from ratt_opt._validation import check_integer
from ratt_opt.errors import InputError
from ratt_opt.missions.players.attackers import ATTACKERS
from ratt_opt.missions.players.planners import PLANNERS, RandomPlanner
from ratt_opt.missions.run import run_mission
from ratt_opt.missions.world import MissionModel
from ratt_opt.scenario.model import Scenario
from ratt_opt.studies.cases import Case, Seeds
from ratt_opt.studies.engine import run
from ratt_opt.studies.study import Study, check_names

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence
    from pathlib import Path

    from ratt_opt.missions.mission import Mission
    from ratt_opt.missions.players.attackers import OwnAttacker
    from ratt_opt.missions.players.planners import Planner
    from ratt_opt.studies.cases import Cell
    from ratt_opt.studies.results import Results

    Teams = Scenario | Callable[[int], Scenario]

__all__ = ["MISSION_METRICS", "Flights", "mission_study"]

MISSION_METRICS: dict[str, Callable[[Mission], float]] = {
    "rmse": lambda mission: float(np.sqrt(mission.squared_errors.mean())),
    "final": lambda mission: float(mission.rmse[-1]),
    "largest": lambda mission: float(np.sqrt(mission.squared_errors.max())),
    "trace": lambda mission: float(mission.traces.mean()),
    "nees": lambda mission: float(mission.nees.mean()) / mission.dimension,
}
"""Metrics of a mission: root mean squared error over targets and steps, that of the last step, the largest error of any
target [m]; mean trace of the position covariance per target [m^2]; NEES over its expected value."""


@dataclass(frozen=True, slots=True, kw_only=True, repr=False)
class Flights:
    """Measure of a study: one mission for each planner and attacker; the arguments of :func:`mission_study`."""

    teams: Teams
    steps: int
    attacks: str
    sharing: str
    horizon: int
    model: MissionModel

    def __repr__(self) -> str:
        """All that decides the rows, as text: the team by its digest."""
        team = self.teams.digest if isinstance(self.teams, Scenario) else f"{self.teams.__module__}:{self.teams}"
        told = (self.steps, self.attacks, self.sharing, self.horizon, self.model)
        return f"Flights({team.split(' at 0x')[0]}, {', '.join(map(repr, told))})"

    def __call__(self, study: Study, case: Case, seeds: Seeds) -> dict[str, Cell]:
        """Columns ``planner/attacker/metric`` of one trial; all planners meet the same truth and noise."""
        del case
        team = self.team(seeds)
        row: dict[str, Cell] = {}
        for planner, chosen in study.named_planners.items():
            for attacker, striking in study.named_attackers.items():
                mission = run_mission(
                    team,
                    steps=self.steps,
                    planner=RandomPlanner(seeds.planner) if chosen == "random" else chosen,
                    attacker=striking,
                    attacks=self.attacks,
                    sharing=self.sharing,
                    horizon=self.horizon,
                    seed=seeds.simulation,
                    model=self.model,
                )
                row |= {f"{planner}/{attacker}/{name}": MISSION_METRICS[name](mission) for name in study.metrics}
        return row

    def team(self, seeds: Seeds) -> Scenario:
        """The team of a trial. InputError : the function makes none."""
        team = self.teams if isinstance(self.teams, Scenario) else self.teams(seeds.scenario)
        if not isinstance(team, Scenario):
            raise InputError(
                "scenario", "must be a Scenario, or a function of a seed that makes one", type(team).__name__
            )
        return team


def mission_study(
    scenario: Scenario | Callable[[int], Scenario],
    *,
    planners: Sequence[str | Planner] | Mapping[str, str | Planner],
    attackers: Sequence[str | OwnAttacker] | Mapping[str, str | OwnAttacker] = ("worst",),
    steps: int,
    trials: int = 20,
    metrics: Sequence[str] = ("rmse",),
    attacks: str = "renewed",
    sharing: str = "best group",
    horizon: int = 1,
    model: MissionModel | None = None,
    seed: int = 0,
    folder: str | Path | None = None,
    workers: int | None = 1,
    name: str = "missions",
) -> Results:
    """Fly missions with every planner under every attacker, and return means with 95 % intervals, tables and figures.

    Names and metrics are checked before the first step is flown. With a ``folder``, each finished trial is a row there:
    the same call goes on after an interrupt.

    Parameters
    ----------
    scenario : one team, whose truth and noise differ in every trial; or a function ``(seed) -> Scenario`` that draws
        another team for each
    planners, attackers : names as in :func:`ratt_opt.run_mission`, functions at the top of a module, or
        ``{name: planner}``
    trials : missions of each planner and attacker
    metrics : names of ``MISSION_METRICS``: ``rmse``, ``final``, ``largest``, ``trace``, ``nees``
    steps, attacks, sharing, horizon, model : of each mission, as in :func:`ratt_opt.run_mission`
    folder, workers : as in :func:`ratt_opt.studies.run`
    name : of the study, in titles

    Raises
    ------
    InputError : an argument breaks its rule; nothing was flown.
    SweepError : a trial failed; the rows so far are kept in ``folder``.
    """
    check_integer("steps", steps, low=1)
    measure = Flights(
        teams=scenario,
        steps=steps,
        attacks=attacks,
        sharing=sharing,
        horizon=horizon,
        model=model or MissionModel(),
    )
    team = measure.team(Seeds.of(seed, 0))
    usual = {"attacks": "renewed", "sharing": "best group", "horizon": 1}
    told: dict[str, Cell] = {"attacks": attacks, "sharing": sharing, "horizon": horizon}
    options: tuple[tuple[str, Cell], ...] = (
        ("steps", steps),
        *(pair for pair in told.items() if usual[pair[0]] != pair[1]),
    )
    case = Case(
        n_robots=team.n_robots,
        n_targets=team.n_targets,
        alpha_s=team.alpha_s,
        alpha_c=team.alpha_c,
        objective=measure.model.objective,
        options=options,
    )
    study = Study(
        name=name,
        cases=(case,),
        planners=planners,
        attackers=attackers,
        metrics=tuple(metrics),
        measure=measure,
        seed=seed,
    )
    if not (study.planner_names and study.attacker_names and study.metrics):
        raise InputError("planners, attackers and metrics", "must not be empty", name)
    check_names(study, {"planners": PLANNERS, "attackers": ATTACKERS, "metrics": MISSION_METRICS})
    return run(study, folder, trials=trials, workers=workers)
