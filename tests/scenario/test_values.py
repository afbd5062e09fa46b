"""The values that input accepts are those that work; the others are refused by the field's name."""

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import ratt_opt as ro
from ratt_opt import InputError
from ratt_opt.cli import run
from ratt_opt.scenario import files, problem_record

SCENARIO = ro.random_scenario(3, 2, alpha_s=1, alpha_c=1, seed=0)
OBJECTIVES = ["trace", "logdet", "maxeig"]


def test_numpy_numbers_are_numbers_and_booleans_are_not() -> None:
    again = SCENARIO.replace(alpha_s=np.int64(1), alpha_c=np.uint8(1), sampling_period=np.float32(1))
    assert again == SCENARIO
    assert type(again.alpha_s) is int
    again = SCENARIO.replace(links=((np.int32(0), np.int64(1)),), protected_robots=(np.int64(2),))
    assert again.links == ((0, 1),)
    for wrong in (True, np.True_, 1.5, np.float64(1.5), "1"):
        with pytest.raises(InputError, match="alpha_s"):
            SCENARIO.replace(alpha_s=wrong)
    for wrong in (True, np.True_, "1"):
        with pytest.raises(InputError, match="sampling_period"):
            SCENARIO.replace(sampling_period=wrong)


@pytest.mark.parametrize(
    ("field", "entries"),
    [
        ("links", ((0, 1), (1, 2), (1, 0))),
        ("protected_robots", (0, 2, 0)),
        ("protected_links", ((0, 1), (1, 2), (0, 1))),
    ],
)
def test_repeated_entries_are_refused_everywhere_alike(field: str, entries: Any) -> None:
    with pytest.raises(InputError, match=rf"{field}\[2\] must not be repeated"):
        SCENARIO.replace(**{field: entries})
    given: dict[str, Any] = {
        "prior": [[[1.0]]], "information": [[[[1.0]]]] * 3, "robot": [0, 1, 2], "alpha_s": 0, "alpha_c": 0,
    }  # fmt: skip
    with pytest.raises(InputError, match=rf"{field}\[2\] must not be repeated"):
        ro.InformationInput(**given, **{field: entries})


def test_teams_that_do_not_fit_are_refused_before_they_are_made(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    budgets = {"alpha_s": 0, "alpha_c": 0, "seed": 0}
    with pytest.raises(InputError, match="n_robots must be at most 2000; got 1000000000"):
        ro.random_scenario(10**9, 1, **budgets)
    with pytest.raises(InputError, match="n_targets must have at most"):
        ro.random_scenario(2000, 10**12, **budgets)
    out = tmp_path / "s.json"
    assert run(["new", "--robots", "3000000", "--targets", "5", "--sensing-attacks", "1", "--link-attacks", "1",
                "--seed", "0", "--out", str(out)]) == 2  # fmt: skip
    assert not out.exists()
    monkeypatch.setattr(problem_record, "MOST_ENTRIES", 3 * 12 * 2 * 4 - 1)
    with pytest.raises(InputError, match="team must have at most 287 entries"):
        SCENARIO.replace(alpha_s=0)


def test_a_file_that_could_not_be_read_back_is_not_written(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = tmp_path / "s.json"
    ro.save_scenario(SCENARIO, path)
    size = path.stat().st_size
    monkeypatch.setattr(files, "LARGEST_FILE", size - 1)
    with pytest.raises(InputError, match="must make a file of at most"):
        ro.save_scenario(SCENARIO, tmp_path / "t.json")
    assert not (tmp_path / "t.json").exists()
    monkeypatch.setattr(files, "LARGEST_FILE", size)
    ro.save_scenario(SCENARIO, tmp_path / "t.json")
    assert ro.load_scenario(tmp_path / "t.json") == SCENARIO


EXTREMES = [1e-12, 1e-6, 1e6, 1e12]


@pytest.mark.parametrize("seed", range(12))
def test_extremes_are_handled_or_refused_by_name(seed: int, tmp_path: Path) -> None:
    """Every field at an end of its range, alone or with others: a bracket, or one line that names what is wrong."""
    rng = np.random.default_rng([seed, 77])
    document = SCENARIO.model_dump(mode="json")
    places: list[tuple[Any, str]] = [(document, "sampling_period")]
    for target in document["targets"]:
        places += [(target, name) for name in ("x", "y", "process_std", "weight", "speed")]
    places += [(robot, "x") for robot in document["robots"]]
    names = ("range_noise", "range_noise_slope", "bearing_noise", "bearing_noise_slope")
    places += [(document["sensor"], name) for name in names]
    for k in rng.permutation(len(places))[: int(rng.integers(1, 5))]:
        record, name = places[k]
        record[name] = float(rng.choice(EXTREMES))
    for target in document["targets"]:
        if rng.random() < 0.5:
            a, b = (float(x) for x in rng.choice(EXTREMES, 2))
            target["covariance"] = [[a, 0.0], [0.0, b]]
    path = tmp_path / "s.json"
    path.write_text(json.dumps(document))
    try:
        scenario = ro.load_scenario(path)
        problems = [scenario.problem(name) for name in OBJECTIVES]
    except InputError:
        return
    report = ro.bound(problems[seed % 3], time_limit=2.0)
    assert 0 <= report.optimum.lower <= report.upper < float("inf")


def test_a_scenario_names_the_sensor_and_the_covariance_that_do_not_fit() -> None:
    sharp = SCENARIO.sensor.replace(range_noise=1e-5, range_noise_slope=0.0)
    far = SCENARIO.targets[1].replace(covariance=((1e10, 0.0), (0.0, 1e10)))
    assert SCENARIO.replace(sensor=sharp).problem()
    with pytest.raises(InputError, match=r"sensor of robots\[0\] for targets\[1\].covariance must be at most 2e\+14"):
        SCENARIO.replace(sensor=sharp, targets=(SCENARIO.targets[0], far))
    thin = SCENARIO.targets[0].replace(covariance=((1e9, 0.0), (0.0, 1e-9)), process_std=0.0)
    with pytest.raises(InputError, match=r"targets\[0\].covariance: prior\[0\] must have a condition below"):
        SCENARIO.replace(targets=(thin,))


def test_matrices_and_limits_take_numbers_of_any_kind_but_no_booleans(tmp_path: Path) -> None:
    given: dict[str, Any] = {"information": [[[[1.0]]], [[[np.int64(2)]]]], "robot": [np.int8(0), 1], "alpha_s": 1}
    team = ro.InformationInput(**given, prior=[[[np.float32(2)]]], weights=[np.uint8(3)], alpha_c=np.int16(0))
    assert team.information[1][0][0][0] == 2.0
    with pytest.raises(InputError, match=r"prior\[0\]\[0\]\[0\] must be a number"):
        ro.InformationInput(**given, prior=[[[True]]], alpha_c=0)
    assert SCENARIO.sensor.replace(field_of_view=np.int64(2)).field_of_view == 2
    problem = team.problem()
    assert ro.solve_maxmin(problem, time_limit=np.int64(9), gap=np.float32(0)).lower > 0
    ro.certify(problem, ro.solve_maxmin(problem), tmp_path / "c.json")
    assert ro.verify_certificate(tmp_path / "c.json", time_limit=np.int64(9)).lower_proved
    for wrong in (True, "1", None):
        with pytest.raises(InputError, match="gap must be a number >= 0"):
            ro.solve_maxmin(problem, gap=wrong)  # type: ignore[arg-type]
    for wrong in (True, "1"):
        with pytest.raises(InputError, match="time_limit must be a number of seconds >= 0"):
            ro.solve_maxmin(problem, time_limit=wrong)  # type: ignore[arg-type]
        with pytest.raises(InputError, match="time_limit must be a positive number"):
            ro.verify_certificate(tmp_path / "c.json", time_limit=wrong)  # type: ignore[arg-type]
        with pytest.raises(InputError, match="value must be a finite number"):
            ro.breaking_budgets(problem, [0, 1], wrong)  # type: ignore[arg-type]
