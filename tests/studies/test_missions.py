"""The studies of missions, small: what must hold whatever the random numbers."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest

import ratt_opt as ro
from ratt_opt.studies import MISSION_METRICS, Case, Seeds, Study, SweepError, mission_study, run
from ratt_opt.studies.cases import Cell
from tests.afternoon import nearest

TEAM = ro.random_scenario(3, 2, alpha_s=1, alpha_c=1, seed=0)


def drawn(seed: int) -> ro.Scenario:
    """Another team of the same size in every trial."""
    return ro.random_scenario(3, 2, alpha_s=1, alpha_c=1, seed=seed)


@pytest.mark.parametrize("teams", [TEAM, drawn])
def test_a_mission_study_is_one_call(teams: Any, tmp_path: Path) -> None:
    """Rows are the figures of missions flown one by one; the same call again flies none; all is saved."""
    asked: dict[str, Any] = {"planners": ["ratt", "random", nearest], "attackers": ["worst", "none"], "steps": 2}
    results = mission_study(teams, **asked, trials=2, metrics=tuple(MISSION_METRICS), folder=tmp_path / "rows")
    seeds = Seeds.of(0, 1)
    team = TEAM if teams is TEAM else drawn(seeds.scenario)
    alone = ro.run_mission(team, steps=2, planner=nearest, attacker="worst", seed=seeds.simulation)
    row = results.rows[1]
    assert float(row["nearest/worst/rmse"]) == pytest.approx(np.sqrt((alone.rmse**2).mean()), rel=1e-12)
    assert float(row["nearest/worst/final"]) == alone.rmse[-1]
    assert len(results.columns) == 3 * 2 * len(MISSION_METRICS)
    assert [mean.planner for mean in results.means(metric="rmse", minus="ratt")][:2] == ["random"] * 2
    again = mission_study(teams, **asked, trials=2, metrics=tuple(MISSION_METRICS), folder=tmp_path / "rows")
    assert again.rows == results.rows
    assert {file.name for file in results.save(tmp_path)} == {"means.csv", "means.tex", "means.png", "means.svg"}


@pytest.mark.parametrize(
    ("change", "text"),
    [
        ({"metrics": ("rmsee",)}, "metrics must be among rmse, final, .*; got rmsee"),
        ({"planners": ["rat"]}, "planners must be among ratt, .* or functions; got rat"),
        ({"attackers": ["nobody"]}, "attackers must be among none, worst, .* or functions; got nobody"),
        ({"steps": 0}, "steps must be"),
        ({"planners": []}, "must not be empty"),
    ],
)
def test_names_are_refused_before_a_step_is_flown(change: dict[str, Any], text: str) -> None:
    with pytest.raises(ro.InputError, match=text):
        mission_study(TEAM, **({"planners": ["ratt"], "steps": 10**6} | change))


def measured_otherwise(study: Study, case: Case, seeds: Seeds) -> dict[str, Cell]:
    """A measure that knows errors only."""
    return {"ratt/worst/rmse": float(case.n_robots + seeds.scenario % 2), "name": study.name}


def test_a_metric_that_a_measure_lacks_is_refused_by_the_first_trial() -> None:
    case = Case(n_robots=2, n_targets=1, alpha_s=0, alpha_c=0)
    asked: dict[str, Any] = {"cases": (case,), "planners": ("ratt",), "attackers": ("worst",), "metrics": ("nees",)}
    with pytest.raises(SweepError, match=r"trial 0 failed .*metrics must be among those measured \(rmse\); got nees"):
        run(Study(name="s", measure=measured_otherwise, **asked), trials=10)
