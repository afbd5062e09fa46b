"""What is known of a plan from quick attacks, and from known outcomes by exchanges: no plan is lost by it."""

import numpy as np
import pytest

import ratt_opt as ro
from ratt_opt.budget import Budget
from ratt_opt.solvers.maxmin.adversary import Adversary
from ratt_opt.solvers.maxmin.outcome_pool import OutcomePool
from tests.solvers.maxmin.engine import EXCHANGED, UNLISTED
from tests.solvers.maxmin.proofs import proved_upper
from tests.strategies import OBJECTIVES, ragged, threatened
from tests.ways import go

BUDGETS = ((5, 0, 6), (5, 1, 4), (6, 0, 9), (6, 1, 7), (6, 2, 6), (6, 0, 11))
"""(N, sensing, links) that leave several groups."""


def test_criteria_without_compiled_code_are_attacked_too():
    class Own(ro.TraceObjective):
        native_kernel = None  # as in a criterion of one's own

    shown = ro.network_scenario("disk-6", 16, 3, alpha_s=3, alpha_c=6, seed=0).problem()
    own = Own(shown.objective.prior, shown.objective.information)
    problem = ro.Problem(own, shown.robot, shown.graph, shown.alpha_s, shown.alpha_c)
    assert Adversary(problem, OutcomePool(problem), Budget()).learn(ro.greedy(problem).elements)


@pytest.mark.parametrize("family", ["hubs", "small-world", "disk-12"])
def test_the_known_outcomes_of_a_plan_on_a_network_are_nearly_its_worst(family):
    """Greedy attacks alone are 5 % milder on hubs and small worlds."""
    problem = ro.network_scenario(family, 20, 10, alpha_s=0.25, alpha_c=0.25, seed=1).problem()
    pool = OutcomePool(problem)
    adversary, plan = Adversary(problem, pool, Budget()), ro.greedy(problem).elements
    while adversary.learn(plan):
        pass
    exact = ro.worst_case_attack(problem, plan)
    assert exact.lower <= pool.plan_value(plan) <= 1.02 * exact.upper


@pytest.mark.parametrize("seed", range(48))
def test_searches_agree_with_exhaustive_search_wherever_they_stop(seed: int, monkeypatch: pytest.MonkeyPatch) -> None:
    """As large teams are searched: outcomes are not listed beforehand, and known ones are exchanged."""
    go(monkeypatch, UNLISTED, EXCHANGED)
    rng = np.random.default_rng([23, seed])
    robots, alpha_s, alpha_c = BUDGETS[seed % len(BUDGETS)]
    problem = threatened(ragged(rng, robots, 4, list(OBJECTIVES)[seed % 3]), alpha_s, alpha_c)
    best = ro.exhaustive_optimum(problem)
    slack = 1e-9 * best.upper + 16 * problem.objective.rounding
    for nodes in (1, 2, 4, None):
        found = ro.solve_maxmin(problem, gap=0, max_nodes=nodes)
        assert found.lower - slack <= best.lower
        assert best.upper <= found.upper + slack
        if found.proof is not None:
            assert proved_upper(problem, found.proof) <= found.upper + slack
    assert found.upper <= best.upper + slack
    assert found.lower >= best.lower - slack


def test_worse_outcomes_are_found_next_to_known_ones(monkeypatch: pytest.MonkeyPatch) -> None:
    problem = ro.random_scenario(20, 20, alpha_s=0, alpha_c=132, seed=0).problem()
    pool = OutcomePool(problem)
    judge = Adversary(problem, pool, Budget())
    assert judge.learn(ro.ratt(problem).elements)
    anew = []
    monkeypatch.setattr(judge, "_quick_attack", lambda *_: anew.append(1) or pool.attack(0))
    rng = np.random.default_rng(0)
    for _ in range(20):
        plan = np.array([rng.choice(choice) for choice in problem.choices])
        before, tried = pool.plan_value(plan), len(anew)
        if judge.learn(plan):
            assert len(anew) == tried
            assert pool.plan_value(plan) < before
    assert len(anew) < 20
