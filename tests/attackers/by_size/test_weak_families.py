"""Weak families of groups by sizes: where they start, what shares of the budget they leave."""

from __future__ import annotations

from contextlib import suppress
from dataclasses import replace

import numpy as np
import pytest

import ratt_opt as ro
from ratt_opt.attackers.by_size import group_exchanges, weak_families
from ratt_opt.attackers.by_size.size_vector_search import SizeVectorSearch
from ratt_opt.attackers.task import AttackBracket, AttackTask, PlanValues
from ratt_opt.attackers.weakest_set.packed_team import PackedTeam
from ratt_opt.budget import Budget, OutOfBudget
from tests.attackers.by_size.test_large_team import team_problem
from tests.attackers.engine import NO_LISTS, PACK_AGAIN
from tests.brackets import attained, worst_value
from tests.strategies import OBJECTIVES
from tests.ways import go


@pytest.mark.parametrize("name", OBJECTIVES)
@pytest.mark.parametrize("seed", range(40))
def test_shares_that_end_anywhere_lose_no_set(name, seed, monkeypatch):
    """Where a share ended while the groups around sets were packed, the next one closed the bracket without them."""
    go(monkeypatch, NO_LISTS, PACK_AGAIN)
    problem, elements = team_problem(seed, 6 + seed % 4, name, protect=seed % 3 == 0)
    expected, values = worst_value(problem, elements), PlanValues(problem, elements)
    start = ro.bounded_rational_attack(problem, elements)
    bracket, team = (
        AttackBracket(start.attack, attained(problem, elements, start), 0.0),
        PackedTeam.planar(problem.objective, values.plan),
    )
    search = SizeVectorSearch(AttackTask(problem, values, bracket, Budget()), team)
    search.bounds = dict.fromkeys(search.vectors, -np.inf)
    stop, nodes = None, 1
    while stop is not ro.Stop.CLOSED and nodes < 1e5:
        with suppress(OutOfBudget):
            search.task = replace(search.task, budget=Budget(max_nodes=int(nodes)))
            stop = search.decide_by_largest()
        assert bracket.lower <= expected + 1e-12
        nodes *= 1.3
    assert bracket.upper == pytest.approx(expected, rel=2e-10, abs=1e-12)


@pytest.mark.parametrize("name", ["trace", "logdet"])
def test_large_teams_start_from_where_linear_descent_ends(name, monkeypatch):
    """With time for one exchange only, that is much of what the attack is."""
    monkeypatch.setattr(group_exchanges, "AT_ONCE", 0)
    found = {0: 0.0, 10**9: 0.0}
    for seed in range(4):
        problem = ro.random_scenario(40, 12, alpha_s=4, alpha_c=40, seed=seed).problem(name)
        values = PlanValues(problem, ro.ratt(problem).elements)
        team = PackedTeam.planar(problem.objective, values.plan)
        task = AttackTask(problem, values, AttackBracket(ro.Attack(), np.inf, 0.0), Budget(time_limit=0))
        sizes = SizeVectorSearch(task, team).vectors[0]
        for large in found:
            monkeypatch.setattr(weak_families, "AT_ONCE", large)
            found[large] += weak_families.WeakFamilies(task, team)._settled(sizes, task.budget).value
    assert found[0] < found[10**9]


def test_exchanges_that_do_not_end_leave_time_for_bounds(monkeypatch):
    monkeypatch.setattr(group_exchanges, "function", lambda *_: lambda *_: 0)
    problem = ro.random_scenario(40, 4, alpha_s=4, alpha_c=40, seed=1).problem("logdet")
    values = PlanValues(problem, ro.ratt(problem).elements)
    team = PackedTeam.planar(problem.objective, values.plan)
    task = AttackTask(problem, values, AttackBracket(ro.Attack(), np.inf, 0.0), Budget(time_limit=2.0))
    search = SizeVectorSearch(task, team)
    assert search.weak.exchanged(search.vectors)
    assert not task.budget.is_over
