"""Outcomes found for all plans of a node, and from known ones by exchanges: allowed, useful, and no plan is lost."""

from __future__ import annotations

import numpy as np
import pytest

from ratt_opt import Attack, exhaustive_optimum, random_scenario, ratt, solve_maxmin
from ratt_opt.budget import Budget
from ratt_opt.solvers.maxmin.adversary import Adversary
from ratt_opt.solvers.maxmin.node_attacks import NodeAttacks
from ratt_opt.solvers.maxmin.outcome_pool import OutcomePool
from tests.solvers.maxmin.engine import EXCHANGED, UNLISTED
from tests.solvers.maxmin.proofs import proved_upper
from tests.strategies import OBJECTIVES, ragged, threatened
from tests.ways import go

BUDGETS = ((5, 0, 6), (5, 1, 4), (6, 0, 9), (6, 1, 7), (6, 2, 6), (6, 0, 11))
"""(N, sensing, links) that leave several groups."""


@pytest.mark.parametrize("seed", range(48))
def test_searches_agree_with_exhaustive_search_wherever_they_stop(seed: int, monkeypatch: pytest.MonkeyPatch) -> None:
    """As large teams are searched: outcomes are not listed beforehand, and known ones are exchanged."""
    go(monkeypatch, UNLISTED, EXCHANGED)
    rng = np.random.default_rng([23, seed])
    robots, alpha_s, alpha_c = BUDGETS[seed % len(BUDGETS)]
    problem = threatened(ragged(rng, robots, 4, list(OBJECTIVES)[seed % 3]), alpha_s, alpha_c)
    best = exhaustive_optimum(problem)
    slack = 1e-9 * best.upper + 16 * problem.objective.rounding
    for nodes in (1, 2, 4, None):
        found = solve_maxmin(problem, gap=0, max_nodes=nodes)
        assert found.lower - slack <= best.lower
        assert best.upper <= found.upper + slack
        if found.proof is not None:
            assert proved_upper(problem, found.proof) <= found.upper + slack
    assert found.upper <= best.upper + slack
    assert found.lower >= best.lower - slack


@pytest.mark.parametrize(("blinded", "cut"), [(0, 134), (2, 171), (5, 117)])
def test_outcomes_for_a_node_are_attacks_that_hurt_its_plans(blinded: int, cut: int) -> None:
    problem = random_scenario(20, 20, alpha_s=blinded, alpha_c=cut, seed=1).problem()
    pool = OutcomePool(problem)
    attacks = NodeAttacks.of(problem, pool, Budget())
    assert attacks is not None
    rng = np.random.default_rng(cut)
    narrow = tuple(rng.permutation(choice)[:2] for choice in problem.choices)
    plans = [[int(rng.choice(choice)) for choice in narrow] for _ in range(20)]
    blind = [problem.team_value(plan, Attack()) for plan in plans]
    assert not attacks.learn(narrow, 0.0)  # no outcome is worth less than nothing
    assert attacks.learn(narrow, max(blind))
    for outcome in range(len(pool)):
        attack = pool.attack(outcome)
        problem.check_attack(attack)
        kept = [problem.team_value(plan, attack) for plan in plans]
        assert max(kept) < max(blind)
        assert not any(later > before for later, before in zip(kept, blind, strict=True))


def test_nodes_are_attacked_only_where_robots_and_links_are_alike() -> None:
    problem = random_scenario(14, 5, alpha_s=1, alpha_c=40, seed=0).problem()
    complete = OutcomePool(problem)
    complete.complete = True
    assert NodeAttacks.of(problem, complete, Budget()) is None
    guarded = type(problem)(problem.objective, problem.robot, None, 1, 40, protected_robots={0})
    assert NodeAttacks.of(guarded, OutcomePool(guarded), Budget()) is None


def test_worse_outcomes_are_found_next_to_known_ones(monkeypatch: pytest.MonkeyPatch) -> None:
    problem = random_scenario(20, 20, alpha_s=0, alpha_c=132, seed=0).problem()
    pool = OutcomePool(problem)
    judge = Adversary(problem, pool, Budget())
    assert judge.learn(ratt(problem).elements)
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


@pytest.mark.slow
def test_twenty_robots_of_which_many_groups_may_win_close() -> None:
    """Relaxed plans and the outcomes that they suggest leave 6 % open after 30 s."""
    problem = random_scenario(20, 20, alpha_s=2, alpha_c=171, seed=0).problem("maxeig")
    found = solve_maxmin(problem, gap=5e-5, max_nodes=3000)
    assert found.upper - found.lower <= 1e-4 * found.upper
