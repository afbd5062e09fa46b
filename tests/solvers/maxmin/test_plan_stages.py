"""Stages of the lower end: brackets hold without any one of them, and a new one is a class and a line."""

from __future__ import annotations

from itertools import product

import numpy as np
import pytest

from ratt_opt import exhaustive_optimum, solve_maxmin
from ratt_opt.attack.staging import without_stages
from ratt_opt.budget import Budget
from ratt_opt.solvers.maxmin.incumbent import Incumbent
from ratt_opt.solvers.maxmin.outcome_pool import OutcomePool
from ratt_opt.solvers.maxmin.plan_stage import LowerEnd, PlanPhase, PlanStage
from ratt_opt.solvers.maxmin.stages import schedule
from tests.solvers.maxmin.engine import UNLISTED
from tests.strategies import small_team
from tests.ways import go


@pytest.mark.parametrize("name", [stage.name for stage in schedule.PLAN_STAGES])
def test_brackets_hold_without_any_one_stage(name, monkeypatch):
    go(monkeypatch, UNLISTED)
    for seed in range(3):
        problem = small_team(seed)
        best = exhaustive_optimum(problem).upper
        slack = 1e-9 * best + 16 * problem.objective.rounding
        with without_stages(name):
            found = solve_maxmin(problem, max_nodes=40)
        assert found.lower - slack <= best <= found.upper + slack
        if name != "proof":
            assert found.upper - found.lower <= slack


class DrawnStage(PlanStage):
    """Stage that offers plans drawn at random."""

    name = "drawn"
    phase = PlanPhase.BEFORE

    def __init__(self):
        self.offered = 0

    def run(self, state, _budget):
        """Offer ten plans."""
        rng, incumbent = np.random.default_rng(0), state.incumbent
        for _ in range(10):
            incumbent.offer(np.array([rng.choice(choice) for choice in incumbent.problem.choices]))
            self.offered += 1


class DrawnAfterStage(DrawnStage):
    """The stage after the proof."""

    phase = PlanPhase.AFTER


def test_a_new_stage_is_a_class_and_a_line(monkeypatch):
    drawn, after = DrawnStage(), DrawnAfterStage()
    monkeypatch.setattr(schedule, "PLAN_STAGES", (drawn, *schedule.PLAN_STAGES, after))
    problem = small_team(1)
    assert solve_maxmin(problem).lower == pytest.approx(exhaustive_optimum(problem).lower, rel=1e-9)
    assert drawn.offered == after.offered == 10
    with without_stages("drawn"):
        solve_maxmin(problem)
    assert drawn.offered == 10


@pytest.mark.parametrize("seed", range(4))
def test_plans_are_attacked_until_one_does_not_fall(seed):
    problem, budget = small_team(seed), Budget()
    plans = list(product(*(choice.tolist() for choice in problem.choices)))
    incumbent = Incumbent(problem, OutcomePool(problem), np.array(plans[0]), budget)
    for plan in map(np.array, plans[1:]):  # of which no attack is known yet
        incumbent.candidates.meet(plan)
        incumbent.candidates.add(plan)
    stage = next(stage for stage in schedule.PLAN_STAGES if stage.name == "best plan so far")
    stage.run(LowerEnd(incumbent=incumbent, plans=[np.array(plans[0])], gap=1e-9, by_rows=True), budget)
    assert incumbent.is_proved
    assert incumbent.proved.lower == pytest.approx(exhaustive_optimum(problem).lower, rel=1e-9)
