"""Attacks and best plans whose budgets, and parts of them, end at random looks: no bracket says too much.

A share of a budget can end within any stage, and the next stage, or the next call with the same memory, begins with
what is left of it. So whatever a search had in hand when it ended must still count as open.
"""

import random
from collections.abc import Callable

import networkx as nx
import numpy as np
import pytest

import ratt_opt as ro
from ratt_opt import Stop
from ratt_opt.budget import Budget
from tests.attack.engine import LARGE, WAYS, AttackMemory
from tests.strategies import random_problem, team_problem
from tests.ways import go

SECONDS = 1000.0
"""Of every limit: it is chance that ends them."""
CALLS = 12


@pytest.fixture
def end_with(monkeypatch: pytest.MonkeyPatch) -> Callable[[float, int], None]:
    """Let every look at a limited budget end it with so much probability."""
    looked = Budget.stop

    def begin(probability: float, seed: int) -> None:
        chance = random.Random(seed)

        def stop(budget: Budget) -> Stop | None:
            if budget.time_limit is not None and chance.random() < probability:
                budget.time_limit = 0.0
            return looked(budget)

        monkeypatch.setattr(Budget, "stop", stop)

    return begin


@pytest.mark.parametrize("way", WAYS)
@pytest.mark.parametrize("seed", range(8))
def test_attacks(seed: int, way: str, end_with: Callable[[float, int], None], monkeypatch: pytest.MonkeyPatch) -> None:
    rng = np.random.default_rng([seed, *way.encode()])
    n_robots = int(rng.integers(4, 10))
    alike = way == "no lists" or rng.random() < 0.2
    problem, plan = team_problem(
        int(rng.integers(10**6)), n_robots, graph=nx.complete_graph(n_robots) if alike else None
    )
    truth, memory = ro.worst_case_attack(problem, plan).upper, AttackMemory()
    rounding = 1e-9 * abs(truth) + 1e-10
    go(monkeypatch, LARGE, WAYS[way])
    for call in range(CALLS):
        end_with(10 ** rng.uniform(-2.5, -1) * 0.8**call, seed)
        found = ro.worst_case_attack(problem, plan, time_limit=SECONDS, memory=memory)
        assert found.lower <= truth + rounding
        assert found.upper >= truth - rounding
        if found.stop is ro.Stop.CLOSED:
            assert found.lower >= truth - 10 * rounding
            break


@pytest.mark.parametrize("way", WAYS)
@pytest.mark.parametrize("seed", range(4))
def test_best_plans(
    seed: int, way: str, end_with: Callable[[float, int], None], monkeypatch: pytest.MonkeyPatch
) -> None:
    rng = np.random.default_rng([seed, *way.encode()])
    problem = random_problem(rng, int(rng.integers(3, 6)), kind=["trace", "logdet", "maxeig"][seed % 3])
    truth, start = ro.exhaustive_optimum(problem).upper, None
    rounding = 1e-8 * abs(truth) + 1e-9
    go(monkeypatch, LARGE, WAYS[way])
    for call in range(CALLS):
        end_with(10 ** rng.uniform(-2.5, -1) * 0.7**call, seed)
        best = ro.solve_maxmin(problem, gap=1e-9, time_limit=SECONDS, start=start)
        assert best.lower <= truth + rounding
        assert best.upper >= truth - rounding
        start = best if rng.random() < 0.5 else None
        if best.stop in {ro.Stop.GAP, ro.Stop.CLOSED, ro.Stop.EXHAUSTED}:
            break
