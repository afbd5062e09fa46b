"""The extended studies, small: what must hold whatever the random numbers."""

from __future__ import annotations

import os
import subprocess
import sys
from itertools import pairwise
from pathlib import Path

import pytest

from analysis.extended.budgets import LEVELS
from analysis.extended.exact_attack import STUDY as EXACT
from analysis.studies.statistics import column, select
from analysis.studies.store import read_table
from analysis.studies.study import run_trial

ROOT = Path(__file__).resolve().parents[2]
STUDIES = ("graphs", "budgets", "sensitivity")


@pytest.fixture(scope="module")
def out(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("extended")
    command = [sys.executable, "-m", "analysis.extended", "--trials", "2", "--out", str(folder), "--only", *STUDIES]
    environment = os.environ | {"OMP_NUM_THREADS": "1"}
    subprocess.run(command, cwd=ROOT, capture_output=True, check=True, env=environment)
    return folder


def test_every_figure_is_there(out: Path) -> None:
    for name in STUDIES:
        assert (out / name / f"{name}.png").stat().st_size > 10_000
        assert (out / name / f"{name}.svg").exists()
    assert not (out / "claims.md").exists()  # only some of the studies were asked for


def test_no_plan_is_proved_better_than_the_upper_bound(out: Path) -> None:
    rows = read_table(out / "graphs")
    upper = column(rows, "optimum/upper")
    assert (column(rows, "optimum/lower") <= upper).all()
    for planner in ("ratt", "greedy", "myopic"):
        assert (column(rows, f"{planner}/exact/proved") <= upper * (1 + 1e-12)).all()
        assert (column(rows, f"{planner}/exact/proved") <= column(rows, f"{planner}/exact/value")).all()


def test_fewer_links_never_help(out: Path) -> None:
    # Same scenario, same budgets, one graph inside the other: the complete graph keeps the most.
    rows = read_table(out / "graphs")
    for graph in ("ladder", "grid", "ring", "star", "line"):
        part, whole = (column(select(rows, graph=g), "optimum/lower") for g in (graph, "complete"))
        most = column(select(rows, graph="complete"), "optimum/upper")
        assert len(part) == len(whole) == 4
        assert (part <= most * (1 + 1e-12)).all()


def test_more_attacks_never_help(out: Path) -> None:
    rows = read_table(out / "budgets")
    for planner in ("ratt", "greedy"):
        traces = [column(rows, f"{planner}/{level}/trace") for level in range(LEVELS)]
        assert all((more >= less * (1 - 1e-12)).all() for less, more in pairwise(traces))


def test_large_optima_are_reproducible() -> None:
    # Searches are limited by nodes, never by seconds, so a row is a function of its seeds.
    assert run_trial(EXACT, 3, 0) == run_trial(EXACT, 3, 0)
