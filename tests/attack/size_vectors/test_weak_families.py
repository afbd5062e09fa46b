"""Weak families of groups by sizes: where they start, what shares of the budget they leave."""

from types import SimpleNamespace

import numpy as np
import pytest

import ratt_opt as ro
from ratt_opt import AttackParams
from ratt_opt.attack import team as team_module
from ratt_opt.attack.least_sets import exchanges
from ratt_opt.attack.params.sizes import FamilyExchangeParams
from ratt_opt.attack.size_vectors import weak_families
from ratt_opt.attack.size_vectors.size_vector_search import SizeVectorSearch
from ratt_opt.attack.task import AttackBracket, AttackTask, PlanValues
from ratt_opt.attack.team import Team
from ratt_opt.budget import Budget
from ratt_opt.running.pace import PaceParams


@pytest.mark.parametrize("name", ["trace", "logdet"])
def test_large_teams_start_from_where_linear_descent_ends(name, monkeypatch):
    """With time for one exchange only, that is much of what the attack is."""
    monkeypatch.setattr(team_module, "EXCHANGES", PaceParams(first=0, most=0))
    found = {0: 0.0, 10**9: 0.0}
    for seed in range(4):
        problem = ro.random_scenario(40, 12, alpha_s=4, alpha_c=40, seed=seed).problem(name)
        values = PlanValues(problem, ro.ratt(problem).elements)
        task = AttackTask(problem, values, AttackBracket(ro.Attack(), np.inf, 0.0), Budget(time_limit=0))
        for large in found:
            params = AttackParams(family_exchanges=FamilyExchangeParams(large=large))
            team = Team.of(problem.objective, values.plan, params)
            sizes = SizeVectorSearch(task, team).vectors[0]
            found[large] += weak_families.WeakFamilies(task, team)._settled(sizes, task.budget).value
    assert found[0] < found[10**9]


def test_exchanges_that_do_not_end_leave_time_for_bounds(monkeypatch):
    monkeypatch.setattr(exchanges, "loops", SimpleNamespace(exchange_groups=lambda *_: 0))
    problem = ro.random_scenario(40, 4, alpha_s=4, alpha_c=40, seed=1).problem("logdet")
    values = PlanValues(problem, ro.ratt(problem).elements)
    team = Team.of(problem.objective, values.plan)
    task = AttackTask(problem, values, AttackBracket(ro.Attack(), np.inf, 0.0), Budget(time_limit=2.0))
    search = SizeVectorSearch(task, team)
    assert search.weak.exchanged(search.vectors)
    assert not task.budget.is_over
