"""The extended studies, small: what must hold whatever the random numbers."""

from __future__ import annotations

import os
import subprocess
import sys
from dataclasses import replace
from itertools import pairwise
from pathlib import Path
from typing import Any

import pytest

from analysis.extended.budgets import LEVELS
from analysis.extended.comparisons import DEFAULTS, GUARANTEES, VARIANTS, shares
from analysis.extended.exact_attack import STUDY as EXACT
from ratt_opt import AttackResult, Problem, worst_case_attack, worst_case_ratio
from ratt_opt.studies.cases import Case, Seeds
from ratt_opt.studies.instance import Instance
from ratt_opt.studies.quantities import curvature_class
from ratt_opt.studies.statistics import column, select
from ratt_opt.studies.store import read_table
from ratt_opt.studies.study import run_trial

ROOT = Path(__file__).resolve().parents[2]
STUDIES = ("guarantees", "graphs", "budgets", "sensitivity")


@pytest.fixture(scope="module")
def out(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("extended")
    command = [sys.executable, "-m", "analysis.extended", "--trials", "2", "--out", str(folder), "--only", *STUDIES]
    environment = os.environ | {"OMP_NUM_THREADS": "1"}
    subprocess.run(command, cwd=ROOT, capture_output=True, check=True, env=environment)
    return folder


def test_every_figure_and_table_is_there(out: Path) -> None:
    assert (out / "budgets" / "budgets.png").stat().st_size > 10_000
    assert (out / "budgets" / "budgets.svg").exists()
    for name in STUDIES:
        assert name == "budgets" or (out / name / "means.csv").exists()
    assert not (out / "extended_claims.md").exists()  # only some of the studies were asked for


def test_no_plan_is_proved_better_than_the_upper_bound(out: Path) -> None:
    rows = read_table(out / "graphs")
    upper = column(rows, "optimum/upper")
    assert (column(rows, "optimum/lower") <= upper).all()
    for planner in ("ratt", "greedy", "myopic"):
        assert (column(rows, f"{planner}/worst/proved") <= upper * (1 + 1e-12)).all()
        assert (column(rows, f"{planner}/worst/proved") <= column(rows, f"{planner}/worst/value")).all()


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


def test_large_optima_are_reproducible_and_no_trace_is_below_their_bound() -> None:
    # Searches are limited by nodes, never by seconds, so a row is a function of its seeds.
    row = run_trial(EXACT, 3, 0)
    assert row == run_trial(EXACT, 3, 0)
    bound = float(row["optimum/trace_bound"])
    assert bound < float(row["maxmin/worst/trace"]) < 1.02 * bound
    for planner in EXACT.planner_names:
        trace, value = (float(row[f"{planner}/worst/{name}"]) for name in ("trace", "value"))
        assert trace >= bound * (1 - 1e-12)
        # Trace and value are two readings of one number.
        assert trace - bound == pytest.approx((float(row["optimum/upper"]) - value) / 20)


def test_guarantees_are_ordered_and_hold_on_every_instance(out: Path) -> None:
    rows = read_table(out / "guarantees")
    found = shares(rows)
    assert (found["theorem1"] <= found["pattern_free"] * (1 + 1e-12)).all()
    assert (found["ratio"] <= found["certified"] * (1 + 1e-12)).all()
    assert (found["pattern_free"] <= found["certified"]).all()
    # With both budgets at work a single robot remains in the second half of the cases: RATT is then optimal.
    assert (column(select(rows, alpha_s=2), "ratio") == 1).all()


def test_each_plan_is_attacked_once_and_exactly(monkeypatch: pytest.MonkeyPatch) -> None:
    attacked = []

    def counting(problem: Problem, plan: Any) -> AttackResult:
        attacked.append(plan.tolist())
        return worst_case_attack(problem, plan)

    monkeypatch.setattr("ratt_opt.studies.instance.worst_case_attack", counting)
    instance = Instance.of(EXACT.cases[0], Seeds.of(1, 0))
    plans = [instance.plan(name) for name in ("maxmin", "ratt", "greedy", "ratt")]
    for plan in plans:
        found, fresh = instance.worst_case(plan), worst_case_attack(instance.problem, plan)
        assert instance.strike("worst", plan) == (found.attack, found.lower)
        assert (found.lower, found.upper) == pytest.approx((fresh.lower, fresh.upper), rel=1e-9)
    assert len(attacked) == len({tuple(plan) for plan in attacked}) <= 2  # the search has attacked its own plan


@pytest.mark.parametrize("upper", [0.0, 0.5, 0.7374127301306086, 0.998765, 1 - 1e-9, 1.0])
def test_the_class_of_a_curvature_contains_it_narrowly(upper: float) -> None:
    bound = float(curvature_class(upper))
    assert upper <= bound <= 1
    assert 1 - bound >= 0.9 * (1 - upper) * (1 - 1e-6)


def test_the_ratio_of_a_row_is_the_librarys() -> None:
    row = run_trial(GUARANTEES, 0, 1)
    bound = str(curvature_class(float(row["curvature/upper"])))
    assert row["ratio"] == worst_case_ratio(4, 1, 3, curvature=bound, family="submodular", domain="feasible").lower


def test_sensitivity_varies_around_the_librarys_defaults() -> None:
    plain = Case(n_robots=4, n_targets=3, alpha_s=1, alpha_c=2)
    seeds = Seeds.of(1, 0)
    scenarios = [
        Instance.of(replace(plain, options=tuple((DEFAULTS | change).items())), seeds) for change in VARIANTS.values()
    ]
    assert scenarios[0].scenario == Instance.of(plain, seeds).scenario
    assert len({one.digest for one in scenarios}) == len(VARIANTS)
