"""Parameters of missions and of sensors' estimates: passed down, read from TOML, refused by name."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import ratt_opt as ro
from ratt_opt import FitParams, MissionModel, MissionParams
from ratt_opt.cli import run
from tests.extremes import at_extremes, places

REFUSED = {"linearisations", "sequences", "most_periods", "noise_floor", "on_time"}


def mission(params: MissionParams, **options) -> ro.Mission:
    scenario = ro.random_scenario(3, 2, alpha_s=1, alpha_c=1, seed=0)
    model = MissionModel(linearisation="iterated", params=params)
    return ro.run_mission(scenario, steps=2, seed=1, model=model, **options)


@pytest.mark.parametrize("place", places(MissionParams()))
def test_missions_and_trackers_end_at_extremes(place: str) -> None:
    """Beliefs stay covariances, and plans are plans of the team."""
    for _, params in at_extremes(MissionParams(), place, REFUSED):
        try:
            flown = mission(params)
        except ro.InputError:
            assert place == "sequences"
            continue
        assert all(np.linalg.eigvalsh(step.team.belief.covariance).min() > 0 for step in flown.steps)
        tracker = ro.Tracker(ro.random_scenario(3, 2, alpha_s=1, alpha_c=1, seed=0), model=MissionModel(params=params))
        assert len(tracker.step([]).elements) == 3


def test_parameters_that_are_passed_are_used(tmp_path: Path) -> None:
    once, often = (mission(MissionParams(linearisations=k)).rmse for k in (1, 4))
    assert not np.array_equal(once, often)
    with pytest.raises(ro.InputError, match="horizon must give robot 0 at most 3 control sequences; got 12"):
        mission(MissionParams(sequences=3))
    path = tmp_path / "journal.jsonl"
    mission(MissionParams(), journal=path)
    mission(MissionParams(), journal=path)
    with pytest.raises(ro.InputError, match="journal must be of the same mission"):
        mission(MissionParams(on_top=1e-3), journal=path)


@pytest.mark.parametrize("name", ["linearisations", "sequences", "most_periods", "noise_floor"])
def test_what_no_mission_can_go_on_with_is_refused(name: str) -> None:
    with pytest.raises(ro.InputError, match=rf"params.{name} must be .*; got 0"):
        replace(MissionParams(), **{name: 0})
    with pytest.raises(ro.InputError, match="params must be MissionParams; got dict"):
        MissionModel(params={})  # type: ignore[arg-type]


def test_a_file_of_toml_changes_some(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path, scenario = tmp_path / "params.toml", tmp_path / "team.json"
    ro.save_scenario(ro.random_scenario(2, 1, alpha_s=0, alpha_c=0, seed=0), scenario)
    command = ["track", str(scenario), "--steps", "1", "--out", str(tmp_path / "out"), "--params", str(path)]
    path.write_text("sequences = 3\n")
    assert run(command) == 2
    assert "at most 3 control sequences" in capsys.readouterr().err
    path.write_text("linearisation = 3\n")
    assert run(command) == 2
    assert "params must name some of linearisations" in capsys.readouterr().err


@pytest.mark.parametrize("place", places(FitParams()))
def test_fitted_sensors_are_sensors_at_extremes(place: str) -> None:
    rng = np.random.default_rng(0)
    distance, bearing = rng.uniform(1, 9, 60), rng.uniform(-0.6, 0.6, 60)
    errors = rng.standard_normal((2, 60)) * [[0.1], [0.02]]
    for least, params in at_extremes(FitParams(), place, places(FitParams())):
        try:
            found = ro.fit_sensor(distance, bearing, *errors, params=params)
        except ro.InputError:
            assert least or place in {"fewest", "outliers"}
            continue
        assert found.range_noise > 0
        assert 0 <= found.outliers < 1
