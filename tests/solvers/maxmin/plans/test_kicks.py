"""Kicks of the best plan find better ones, the same every time, and judge them by exact attacks."""

from __future__ import annotations

import numpy as np
import pytest

from ratt_opt import exhaustive_optimum, random_scenario
from ratt_opt.budget import Budget
from ratt_opt.solvers.maxmin.plans.incumbent import Incumbent
from ratt_opt.solvers.maxmin.plans.kicks import FIRST, Kicks
from ratt_opt.solvers.maxmin.plans.outcome_pool import OutcomePool
from tests.solvers.maxmin.engine import BLIND
from tests.ways import go

KICKS = 60


def kicked(problem, *, times: int = KICKS) -> Incumbent:
    """What is known after kicks of the plan of each robot's first element."""
    first = np.array([choice[0] for choice in problem.choices])
    incumbent = Incumbent(problem, OutcomePool(problem), first, Budget())
    incumbent.proved.attack(first, incumbent.budget)
    incumbent.offer(first)
    kicks = Kicks(incumbent)
    for _ in range(times):
        kicks.kick()
    return incumbent


@pytest.mark.parametrize("blind", [False, True])
def test_kicks_find_the_best_plan_of_a_small_team(blind: bool, monkeypatch: pytest.MonkeyPatch) -> None:
    """Also where quick attacks see nothing, and only exact ones tell good plans from bad."""
    if blind:
        go(monkeypatch, BLIND)
    better = 0
    for seed in range(4):
        problem = random_scenario(5, 5, alpha_s=1, alpha_c=5, seed=seed).problem("maxeig")
        optimum = exhaustive_optimum(problem).upper
        before, after = kicked(problem, times=0).proved.lower, kicked(problem).proved.lower
        assert before <= after <= optimum * (1 + 1e-9)
        assert after == pytest.approx(optimum, rel=1e-2)
        better += after > before
    assert better


def test_kicks_are_the_same_every_time() -> None:
    problem = random_scenario(13, 5, alpha_s=1, alpha_c=40, seed=3).problem("maxeig")
    one, other = kicked(problem, times=5), kicked(problem, times=5)
    assert np.array_equal(one.candidates.best, other.candidates.best)
    assert len(one.pool) == len(other.pool)


def test_the_next_kick_waits_for_nodes_the_longer_the_more_attacks_there_were() -> None:
    problem = random_scenario(13, 5, alpha_s=1, alpha_c=40, seed=3).problem("maxeig")
    incumbent = kicked(problem, times=0)
    kicks = Kicks(incumbent)
    assert not kicks.are_due(FIRST - 1)
    assert kicks.are_due(FIRST)
    incumbent.budget.nodes = FIRST
    kicks.kick()
    assert not kicks.are_due(FIRST + 1)
    assert kicks.are_due(10 * FIRST)
