"""The paper's studies, small: what every table must satisfy whatever the random numbers."""

import csv
import math
import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from analysis.claims import Claim
from analysis.paper.claims import CLAIMS
from ratt_opt.studies.statistics import column
from ratt_opt.studies.store import read_table

ROOT = Path(__file__).resolve().parents[2]


@pytest.fixture(scope="module")
def out(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("paper")
    _run(folder)
    return folder


def _run(folder: Path) -> subprocess.CompletedProcess[str]:
    command = [sys.executable, "-m", "analysis.paper", "--trials", "2", "--out", str(folder)]
    return subprocess.run(
        command, cwd=ROOT, capture_output=True, text=True, check=True, env=os.environ | {"OMP_NUM_THREADS": "1"}
    )


def test_every_figure_and_table_is_there(out: Path) -> None:
    names = sorted(str(path.relative_to(out)) for path in out.rglob("*.png"))
    assert names == [
        "caa/caa.png",
        "large_scale/large_scale.png",
        "large_scale/large_scale_paired.png",
        "qualitative/one_link_attack.png",
        "qualitative/one_sensing_attack.png",
        "qualitative/one_sensing_two_link_attacks.png",
        "small_scale/small_scale.png",
        "small_scale/small_scale_paired.png",
    ]
    lines = (out / "claims.md").read_text().splitlines()
    assert len(lines) == 4 + len(CLAIMS)
    assert lines[2].endswith("| confirmed (exact) |")
    assert [len(read_table(out / name)) for name in ("caa", "qualitative", "small_scale", "large_scale")] == [
        11,
        6,
        8,
        18,
    ]


def test_a_second_run_repeats_nothing_and_changes_no_byte(out: Path) -> None:
    before = {path: path.read_bytes() for path in out.rglob("*") if path.is_file()}
    done = _run(out)
    assert "18/18 trials were already there" in done.stderr
    assert {path: path.read_bytes() for path in out.rglob("*") if path.is_file()} == before


def test_no_plan_beats_the_optimum_under_the_exact_attack(out: Path) -> None:
    rows = read_table(out / "small_scale")
    best = column(rows, "maxmin/worst/value")
    for planner in ("ratt", "nonrobust_optimum", "greedy", "random"):
        assert (column(rows, f"{planner}/worst/value") <= best * (1 + 1e-12)).all()
    without = read_table(out / "qualitative")
    assert (column(without, "nonrobust_optimum/none/value") >= column(without, "ratt/none/value") * (1 - 1e-12)).all()


def test_trials_of_one_team_share_their_scenario_over_budgets(out: Path) -> None:
    rows = read_table(out / "small_scale")
    assert len({row["seed"] for row in rows}) == 2
    assert len({row["scenario"] for row in rows}) == 8  # budgets are part of what is hashed


def test_trace_is_what_the_value_leaves(out: Path) -> None:
    # One trial, all planners: trace * M + value is the prior's trace, whoever planned.
    for row in read_table(out / "large_scale"):
        names = [f"{planner}/bounded_rational" for planner in ("ratt", "greedy", "random")]
        prior = [float(row[f"{n}/trace"]) * int(row["n_targets"]) + float(row[f"{n}/value"]) for n in names]
        np.testing.assert_allclose(prior, prior[0], rtol=1e-9)


def test_a_claim_is_a_paired_difference() -> None:
    rows = [
        {"case": case, "trial": str(t), "a": str(t), "b": str(t + shift)}
        for case, shift in (("x", 1), ("y", 2))
        for t in range(3)
    ]
    measured = Claim(figure="", command="", statement="", left="a", right="b").measured(rows)
    assert {case: values.tolist() for case, values in measured.items()} == {"x": [-1, -1, -1], "y": [-2, -2, -2]}
    share = Claim(figure="", command="", statement="", left="b", right="a", share=0.5)
    assert math.isclose(share.measured([row | {"a": "2", "b": "3"} for row in rows])["x"].mean(), 0.5)


def test_a_table_of_claims_says_what_each_row_rests_on(out: Path) -> None:
    with (out / "claims.csv").open(encoding="utf-8") as file:
        rows = [row for row in csv.DictReader(file) if row["claim"] == "RATT's MSE is below that of Random"]
    for figure, cases in (("small_comp", 4), ("large_comp", 9)):
        found = [row for row in rows if row["figure"] == figure]
        assert len(found) == cases + 1
        means = [float(row["mean"]) for row in found]
        assert found[-1]["case"] == "average over cases"
        assert means[-1] == pytest.approx(sum(means[:-1]) / cases)
        assert all(float(row["low"]) <= float(row["mean"]) <= float(row["high"]) for row in found)
