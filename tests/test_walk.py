"""A stranger's walk: an engineer with drones, a researcher with a planner, a reviewer with a doubt, each end to end.

Each writes what is here into files of a folder of their own and runs it; nothing of the repository is used. The lines
that it takes are counted, so that they do not grow again.
"""

from __future__ import annotations

import csv
import json
import subprocess
import sys
from typing import TYPE_CHECKING

import pytest

if TYPE_CHECKING:
    from pathlib import Path

DRONES = """\
import ratt_opt as ro

camera = ro.BearingOnly(ro.Sensor(law="std", bearing_noise=0.05, max_range=60.0, field_of_view=2.0))
drones = [ro.Robot(x=12.0 * i, y=0.0, heading=1.57, name=f"drone {i}") for i in range(6)]
boats = [ro.Target(x=15.0 * j + 5.0, y=25.0 + 5.0 * j, speed=1.0) for j in range(4)]
team = ro.Scenario(robots=drones, targets=boats, sensor=camera, alpha_s=2, alpha_c=3)
ro.bound(team).save("drones")
ro.run_mission(team, steps=3).save("flight")
ro.save_scenario(team, "drones.json")
"""
PLANNER = '''\
import sys

from ratt_opt.studies import Case, Entry, Study, main


def strongest(problem):
    """Every robot's best element alone, as if nobody else were there."""
    alone = problem.objective.singletons()
    return [int(own[alone[own].argmax()]) for own in problem.choices]


cases = [Case(n_robots=4, n_targets=3, alpha_s=s, alpha_c=2) for s in (1, 2)]
study = Study(name="mine", cases=tuple(cases), planners=("ratt", strongest), attackers=("exact",), metrics=("value",))

if __name__ == "__main__":
    sys.exit(main("My planner.", [Entry(study)], trials=3))
'''
DOUBT = """\
import json
import numpy as np
import ratt_opt as ro

report = json.load(open("demo/report.json"))
problem = ro.load_scenario("demo/scenario.json").problem()
plan, rng = report["recommended"]["elements"], np.random.default_rng(0)
links = sorted(problem.communication.links)
for _ in range(2000):
    blind = frozenset(rng.choice(problem.n_robots, problem.alpha_s, replace=False).tolist())
    cut = frozenset(links[k] for k in rng.choice(len(links), problem.alpha_c, replace=False))
    assert problem.team_value(plan, ro.Attack(blind, cut)) >= report["recommended"]["worst_case"]["lower"]
"""


def lines_of(script: str) -> int:
    """Lines of code: neither empty nor a comment nor a docstring."""
    kept = [line.strip() for line in script.splitlines()]
    return sum(bool(line) and not line.startswith(("#", '"""')) for line in kept)


@pytest.fixture
def at_home(tmp_path: Path):
    def command(*arguments: str, code: int = 0) -> str:
        if arguments[0] == "ratt-opt":
            arguments = ("-m", "ratt_opt", *arguments[1:])
        done = subprocess.run([sys.executable, *arguments], cwd=tmp_path, capture_output=True, text=True, check=False)
        assert done.returncode == code, done.stderr
        return done.stdout

    return command


def test_an_engineer_s_drones_are_planned_proved_and_flown(tmp_path: Path, at_home) -> None:
    (tmp_path / "drones.py").write_text(DRONES)
    assert lines_of(DRONES) <= 12
    at_home("drones.py")
    written = {path.name for path in (tmp_path / "drones").iterdir()}
    assert written == {"report.json", "report.html", "plan.csv", "plan.png", "plan.svg", "certificate.json"}
    rows = list(csv.DictReader((tmp_path / "drones" / "plan.csv").read_text().splitlines()))
    assert {row["under attack"] for row in rows} <= {"blinded", "sees", "cut off"}
    assert all(float(row["speed"]) and row["turn_rate"] for row in rows)
    checked = at_home("ratt-opt", "verify", "drones/certificate.json", "--problem", "drones.json")
    assert "the very input that it was made from" in checked
    at_home("ratt-opt", "attack", "drones.json", "--plan", "drones/report.json", "--protect", "2")
    at_home("ratt-opt", "track", "drones.json", "--steps", "2", "--out", "again")
    assert json.loads((tmp_path / "flight" / "mission.json").read_text())["n_robots"] == 6


def test_a_researcher_s_planner_has_its_table_and_figure(tmp_path: Path, at_home) -> None:
    (tmp_path / "mine.py").write_text(PLANNER)
    assert lines_of(PLANNER) <= 10
    printed = at_home("mine.py", "--workers", "1", "--out", "out", "--latex")  # LaTeX is one argument
    assert r"\begin{tabular}" in printed
    assert "strongest" in printed
    table = list(csv.DictReader((tmp_path / "out" / "mine" / "means.csv").read_text().splitlines()))  # CSV is there
    assert {row["planner"] for row in table} == {"ratt", "strongest"}
    assert (tmp_path / "out" / "mine" / "means.svg").exists()


def test_a_reviewer_s_doubt_is_answered(tmp_path: Path, at_home) -> None:
    at_home("ratt-opt", "demo", "--out", "demo")
    at_home("ratt-opt", "verify", "demo/certificate.json", "--problem", "demo/scenario.json")
    (tmp_path / "doubt.py").write_text(DOUBT)
    at_home("doubt.py")
    proof = json.loads((tmp_path / "demo" / "certificate.json").read_text())
    proof["claim"]["lower"] *= 1.001
    (tmp_path / "forged.json").write_text(json.dumps(proof))
    at_home("ratt-opt", "verify", "forged.json", code=1)
