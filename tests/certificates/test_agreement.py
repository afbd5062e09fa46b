"""Certificates travel: the same scenario on another machine is the same problem, changed data are not."""

import json
import os
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import ratt_opt as ro
from ratt_opt.certificates.agreement import differences
from ratt_opt.cli import run
from ratt_opt.errors import UndecidedError
from tests.certificates.engine import limited

SENSORS = [
    ro.Sensor(),
    ro.Sensor(law="std", range_noise=0.3, bearing_noise=0.02),
    ro.Sensor(max_range=60.0, field_of_view=2.0),
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
    record = ro.problem_document(scenario.problem("logdet"))
    difference = differences(scenario, "logdet")
    assert difference(record) == ""
    moved = _shifted(record, rng, 2)
    assert moved != record
    assert difference(moved) == ""
    assert difference(_shifted(record, rng, 2) | {"alpha_s": 0}) == "its field 'alpha_s' differs"
    assert "its prior is not what comes of" in difference(record | {"prior": record["prior"][::-1]})
    assert difference(ro.problem_document(scenario.problem("trace"))) == "its criterion is trace, not logdet"
    first, *others = scenario.targets
    for changed in (
        scenario.replace(targets=(first.replace(x=first.x + 1e-9), *others)),
        scenario.replace(targets=(first.replace(process_std=0.5 + 1e-12), *others)),
        scenario.replace(robots=(scenario.robots[0].replace(y=scenario.robots[0].y - 1e-7), *scenario.robots[1:])),
        scenario.replace(sensor=scenario.sensor.replace(bearing_noise=scenario.sensor.bearing_noise * (1 + 1e-9))),
        scenario.replace(sampling_period=scenario.sampling_period * (1 + 1e-8)),
        scenario.replace(alpha_c=0),
    ):
        other = ro.problem_document(changed.problem("logdet"))
        assert other == record or difference(other)
    weighted = scenario.replace(targets=(first.replace(weight=1.0 + 2**-52), *others))
    assert difference(ro.problem_document(weighted.problem("logdet"))) == "its field 'weights' differs"


def test_a_comparison_counts_as_work_of_the_verifier() -> None:
    """Of a thousand robots and targets it takes minutes."""
    scenario = _drawn(0)
    moved = _shifted(ro.problem_document(scenario.problem()), np.random.default_rng(0), 2)
    with limited(1e-9), pytest.raises(UndecidedError, match="not decided within"):
        differences(scenario, "trace")(moved)


def test_links_within_a_range_may_differ_where_rounding_decides() -> None:
    """Robots 3, 4 and 5 apart: on a machine that rounds the longest up, it is no link."""
    made = ro.random_scenario(3, 2, alpha_s=0, alpha_c=0, seed=1)
    places = ((0.1, 0.0), (0.1, 3.0), (4.1, 3.0))
    robots = tuple(robot.replace(x=x, y=y) for robot, (x, y) in zip(made.robots, places, strict=True))
    scenario = made.replace(robots=robots, communication_range=5.0)
    record, difference = ro.problem_document(scenario.problem()), differences(scenario, "trace")
    assert difference(record) == ""
    for links, same in (
        ([[0, 1], [1, 2]], True),
        ([[0, 1], [0, 2], [1, 2]], True),
        ([[0, 1], [0, 2]], False),
        ([[0, 1]], False),
        ([[0, 1], [1, 2], [0, 3]], False),
        ([[0, 1], [1, 2], [0, 2.5]], False),
        ([[0, 1], [1, 2], 0], False),
        (0, False),
    ):
        assert difference(record | {"links": links}) == ("" if same else "its links differ")
    further = scenario.replace(communication_range=5.0 + 1e-9)
    assert differences(further, "trace")(record | {"links": [[0, 1], [1, 2]]}) == "its links differ"


def test_a_certificate_made_without_vector_instructions_is_accepted(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """The same file on a processor that lacks them; the matrices differ there in their last digits, or are equal."""
    path, out = tmp_path / "s.json", tmp_path / "o"
    ro.save_scenario(_drawn(0), path)
    features = subprocess.run(
        [sys.executable, "-c", "from numpy._core._multiarray_umath import __cpu_dispatch__ as d; print(*d)"],
        capture_output=True, text=True, check=True,
    ).stdout.strip()  # fmt: skip
    without = {"NPY_DISABLE_CPU_FEATURES": features, "OPENBLAS_CORETYPE": "PRESCOTT"}
    environment = os.environ | without | {"PYTHONPATH": str(ROOT), "PYTHONWARNINGS": ""}
    command = [sys.executable, "-c", "from ratt_opt.cli import main; main()", "bound", str(path), "--out", str(out)]
    done = subprocess.run(command, env=environment, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    certificate = str(out / "certificate.json")
    report = json.loads((out / "report.json").read_text())
    assert report["certificate"]["verified"]
    source = report["input"]["sha256"]
    assert json.loads(Path(certificate).read_text())["made_from"] == source
    assert run(["verify", certificate, "--problem", str(path)]) == 0
    assert "the given file: the very input that it was made from" in capsys.readouterr().out
    other = tmp_path / "t.json"
    scenario = _drawn(0)
    ro.save_scenario(scenario.replace(robots=(scenario.robots[0].replace(x=1.0), *scenario.robots[1:])), other)
    assert run(["verify", certificate, "--problem", str(other)]) == 1
    assert f"made from the input with SHA-256 {source}" in capsys.readouterr().err
    named = scenario.replace(robots=tuple(robot.replace(name=f"r{k}") for k, robot in enumerate(scenario.robots)))
    ro.save_scenario(named, other)
    assert run(["verify", certificate, "--problem", str(other), "--json"]) == 0
    found = json.loads(capsys.readouterr().out)
    assert (found["made_from"], found["given"]) == (source, named.digest)
    assert source != named.digest


def test_only_a_hash_says_what_a_certificate_was_made_from(tmp_path: Path) -> None:
    """No proof needs it: files without one, of earlier releases or of problems in Python, stay what they are."""
    scenario = _drawn(1)
    problem, path = scenario.problem(), tmp_path / "c.json"
    result = ro.solve_maxmin(problem)
    assert ro.certify(problem, result, path).verified.made_from is None
    without = json.loads(path.read_text())
    assert ro.certify(problem, result, path, source=scenario).verified.made_from == scenario.digest
    document = json.loads(path.read_text())
    assert document == without | {"made_from": scenario.digest}
    path.write_text(json.dumps(document | {"made_from": "0" * 64}))
    assert ro.verify_certificate(path).made_from == "0" * 64
    for wrong in (None, 1, "", "0" * 63, "0" * 64 + "\n", "G" * 64, scenario.digest.upper() + "A", [scenario.digest]):
        path.write_text(json.dumps(document | {"made_from": wrong}))
        with pytest.raises(ro.FileFormatError, match="made_from must be a SHA-256"):
            ro.verify_certificate(path)
