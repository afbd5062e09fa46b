"""Plans by numbers of watchers: against all plans, and where no attack should take all watchers of a target."""

from __future__ import annotations

from itertools import product

import numpy as np
import pytest

from ratt_opt import limited_view_scenario, ratt, worst_case_attack
from ratt_opt.budget import Budget
from ratt_opt.solvers.maxmin.params import WatcherParams
from ratt_opt.solvers.maxmin.watchers import watched_plan
from tests.strategies import small_team


@pytest.mark.parametrize("objective", ["trace", "logdet"])
@pytest.mark.parametrize("seed", range(3))
def test_no_plan_has_a_smaller_sum(seed, objective):
    problem = limited_view_scenario(4, 5, alpha_s=1, alpha_c=0, seed=seed, view=57, headings=4).problem(objective)
    params = WatcherParams(unseen=0.0, precise=0.0, kicks=60)
    found = watched_plan(problem, Budget(), params)
    f = problem.objective
    most = f.target_values(f.prior_information + f.information.sum(axis=0))
    watching = f.target_values(f.prior_information + f.information) >= params.watching * most
    plans = np.array(list(product(*problem.choices)))
    sums = np.exp(-watching[plans].sum(axis=1).astype(float)).sum(axis=1)
    assert problem.check_plan(found) is not None
    assert np.exp(-watching[found].sum(axis=0).astype(float)).sum() == pytest.approx(sums.min(), rel=1e-9)


def test_robots_that_see_all_have_no_such_plan():
    assert watched_plan(small_team(0), Budget(), WatcherParams()) is None


def test_there_is_no_such_plan_if_one_robot_alone_tells_little():
    scenario = limited_view_scenario(20, 20, alpha_s=5, alpha_c=20, seed=0, view=57)
    assert watched_plan(scenario.problem("logdet"), Budget(), WatcherParams()) is None
    assert watched_plan(scenario.problem("trace"), Budget(), WatcherParams()) is not None


def test_plans_watch_each_target_by_more_than_an_attack_takes():
    problem = limited_view_scenario(20, 20, alpha_s=6, alpha_c=0, seed=1, view=57).problem("trace")
    found = watched_plan(problem, Budget(), WatcherParams())
    assert worst_case_attack(problem, found).lower > 360
    assert worst_case_attack(problem, ratt(problem)).upper < 350
