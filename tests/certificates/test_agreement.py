"""Certificates travel: the same scenario on another machine is the same problem, changed data are not."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import ratt_opt as ro
from ratt_opt.certificates.agreement import same_problem
from ratt_opt.certificates.write import problem_document
from ratt_opt.cli import run
from ratt_opt.scenario.sensor import Sensor

SENSORS = [
    Sensor(),
    Sensor(law="std", range_noise=0.3, bearing_noise=0.02),
    Sensor(max_range=60.0, field_of_view=2.0),
]
ROOT = Path(__file__).resolve().parents[2]


def _drawn(seed: int) -> ro.Scenario:
    """Robots and targets with headings, turns, speeds and periods of all sizes."""
    rng = np.random.default_rng([seed, 5])
    scenario = ro.random_scenario(3, 4, alpha_s=1, alpha_c=1, seed=seed, sensor=SENSORS[seed % 3])
    robots = [robot.replace(heading=float(rng.normal(0, 10.0**k))) for k, robot in enumerate(scenario.robots)]
    targets = [
        target.replace(heading=float(rng.normal(0, 3)), covariance=((4.0, 1.0), (1.0, float(rng.uniform(1, 9)))))
        for target in scenario.targets
    ]
    period = float(10.0 ** rng.uniform(-2, 1))
    return scenario.replace(robots=tuple(robots), targets=tuple(targets), sampling_period=period)


def _shifted(record: dict[str, Any], rng: np.random.Generator, ulps: int) -> dict[str, Any]:
    """Every computed number moved by up to so many ulps."""

    def shift(value: Any) -> Any:
        if isinstance(value, list):
            return [shift(item) for item in value]
        if value == 0:  # out of reach, on every machine
            return value
        return value + int(rng.integers(-ulps, ulps + 1)) * float(np.spacing(value))

    return record | {"information": shift(record["information"]), "prior": record["prior"]}


@pytest.mark.parametrize("seed", range(12))
def test_ulps_are_covered_and_changes_are_not(seed: int) -> None:
    scenario, rng = _drawn(seed), np.random.default_rng(seed)
    record = problem_document(scenario.problem("logdet"))
    test = same_problem(scenario, "logdet")
    assert test(record)
    moved = _shifted(record, rng, 2)
    assert moved != record
    assert test(moved)
    assert not test(_shifted(record, rng, 2) | {"alpha_s": 0})
    assert not test(record | {"prior": record["prior"][::-1]})
    first, *others = scenario.targets
    for changed in (
        scenario.replace(targets=(first.replace(x=first.x + 1e-9), *others)),
        scenario.replace(targets=(first.replace(process_std=0.5 + 1e-12), *others)),
        scenario.replace(robots=(scenario.robots[0].replace(y=scenario.robots[0].y - 1e-7), *scenario.robots[1:])),
        scenario.replace(sensor=scenario.sensor.replace(bearing_noise=scenario.sensor.bearing_noise * (1 + 1e-9))),
        scenario.replace(sampling_period=scenario.sampling_period * (1 + 1e-8)),
        scenario.replace(alpha_c=0),
    ):
        other = problem_document(changed.problem("logdet"))
        assert other == record or not test(other)
    weighted = scenario.replace(targets=(first.replace(weight=1.0 + 2**-52), *others))
    assert not test(problem_document(weighted.problem("logdet")))


def test_a_certificate_made_without_vector_instructions_is_accepted(tmp_path: Path) -> None:
    """The same file on a processor that lacks them; the matrices differ there in their last digits, or are equal."""
    path, out = tmp_path / "s.json", tmp_path / "o"
    ro.save_scenario(_drawn(0), path)
    features = subprocess.run(
        [sys.executable, "-c", "from numpy._core._multiarray_umath import __cpu_dispatch__ as d; print(*d)"],
        capture_output=True, text=True, check=True,
    ).stdout.strip()  # fmt: skip
    environment = os.environ | {"NPY_DISABLE_CPU_FEATURES": features, "PYTHONPATH": str(ROOT), "PYTHONWARNINGS": ""}
    command = [sys.executable, "-c", "from ratt_opt.cli import main; main()", "bound", str(path), "--out", str(out)]
    done = subprocess.run(command, env=environment, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    certificate = str(out / "certificate.json")
    assert json.loads((out / "report.json").read_text())["certificate"]["verified"]
    assert run(["verify", certificate, "--problem", str(path)]) == 0
    other = tmp_path / "t.json"
    scenario = _drawn(0)
    ro.save_scenario(scenario.replace(robots=(scenario.robots[0].replace(x=1.0), *scenario.robots[1:])), other)
    assert run(["verify", certificate, "--problem", str(other)]) == 1
