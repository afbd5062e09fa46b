"""Quantities of a trial: brackets of the optimum, guarantees that hold, and one exact attack for each plan."""

from dataclasses import replace
from typing import Any

import pytest

from ratt_opt import AttackResult, Problem, worst_case_attack, worst_case_ratio
from ratt_opt.studies.cases import Case, Seeds
from ratt_opt.studies.instance import Instance
from ratt_opt.studies.quantities import curvature_class
from ratt_opt.studies.study import Study, run_trial

TEAM = Case(n_robots=4, n_targets=4, alpha_s=1, alpha_c=3, objective="logdet")
GUARANTEES = Study(
    name="guarantees",
    cases=(TEAM, replace(TEAM, alpha_s=2, alpha_c=4), replace(TEAM, objective="trace")),
    planners=("ratt",),
    attackers=("worst",),
    metrics=("value", "proved"),
    quantities=("optimum", "guarantees"),
)
GRAPHS = tuple(
    Case(n_robots=6, n_targets=5, alpha_s=1, alpha_c=2, graph=graph)
    for graph in ("complete", "ladder", "grid", "ring", "star", "line")
)
LARGE = Study(
    name="large",
    cases=(Case(n_robots=10, n_targets=15, alpha_s=3, alpha_c=11),),
    planners=("maxmin", "ratt", "greedy"),
    attackers=("worst",),
    metrics=("value", "trace"),
    quantities=("optimum", "trace_bound"),
)


@pytest.mark.parametrize("case", range(3))
def test_guarantees_are_ordered_and_hold_on_every_instance(case: int) -> None:
    row: dict[str, Any] = run_trial(GUARANTEES, case, 0)
    certified = row["ratt/worst/proved"] / row["optimum/upper"]
    assert row["theorem1"] <= row["pattern_free"] * (1 + 1e-12)
    assert max(row["pattern_free"], row["ratio"]) <= certified * (1 + 1e-12)
    drawn = GUARANTEES.cases[case]
    family = "submodular" if drawn.objective == "logdet" else "nondecreasing"
    bound = str(curvature_class(row["curvature/upper"]))
    found = worst_case_ratio(4, drawn.alpha_s, drawn.alpha_c, curvature=bound, family=family, domain="feasible")
    assert row["ratio"] == found.lower
    # With both budgets at work a single robot remains in the second case: RATT is then optimal.
    assert row["ratio"] == 1 or case != 1


def test_fewer_links_never_help() -> None:
    optima = {case.graph: Instance.of(case, Seeds.of(1, 0)).optimum for case in GRAPHS}
    assert all(found.lower <= optima["complete"].upper * (1 + 1e-12) for found in optima.values())
    assert len({found.upper for found in optima.values()}) > 2


def test_a_row_is_reproducible_and_no_trace_is_below_its_bound() -> None:
    # Searches are limited by nodes, never by seconds, so a row is a function of its seeds.
    row: dict[str, Any] = run_trial(LARGE, 0, 0)
    assert row == run_trial(LARGE, 0, 0)
    bound = row["optimum/trace_bound"]
    assert bound < row["maxmin/worst/trace"] < 1.02 * bound
    for planner in LARGE.planner_names:
        trace, value = row[f"{planner}/worst/trace"], row[f"{planner}/worst/value"]
        assert trace >= bound * (1 - 1e-12)
        # Trace and value are two readings of one number.
        assert trace - bound == pytest.approx((row["optimum/upper"] - value) / 15)


def test_each_plan_is_attacked_once_and_exactly(monkeypatch: pytest.MonkeyPatch) -> None:
    attacked = []

    def counting(problem: Problem, plan: Any) -> AttackResult:
        attacked.append(plan.tolist())
        return worst_case_attack(problem, plan)

    monkeypatch.setattr("ratt_opt.studies.instance.worst_case_attack", counting)
    instance = Instance.of(LARGE.cases[0], Seeds.of(1, 0))
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


def test_options_of_a_case_reach_the_scenario() -> None:
    defaults = Instance.of(TEAM, Seeds.of(1, 0))
    same = Instance.of(replace(TEAM, options=(("prior_std", 3.0), ("sensor.range_noise", 0.5))), Seeds.of(1, 0))
    noisy = Instance.of(replace(TEAM, options=(("sensor.range_noise", 5.0),)), Seeds.of(1, 0))
    assert same.scenario == defaults.scenario
    assert noisy.digest != defaults.digest
