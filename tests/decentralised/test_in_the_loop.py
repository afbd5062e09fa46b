"""Missions and studies know the planner; it takes the same choices as RATT on connected teams."""

import numpy as np
import pytest

import ratt_opt as ro
from ratt_opt.decentralised.processes import plan_in_processes


def test_a_mission_planned_by_messages_is_ratt_s():
    scenario = ro.random_scenario(4, 4, alpha_s=1, alpha_c=2, seed=3)
    by_messages, central = (
        ro.run_mission(scenario, steps=3, planner=name, sharing="all surviving") for name in ("decentralised", "ratt")
    )
    assert (
        by_messages.settings["sharing"]
        == ro.run_mission(scenario, steps=1, planner="decentralised").settings["sharing"]
    )
    assert np.array_equal(by_messages.rmse, central.rmse)
    assert np.array_equal(by_messages.nees, central.nees)


def test_a_limit_of_chosen_elements_is_refused_by_name():
    objective = ro.TraceObjective(np.eye(2)[None], np.array([np.zeros((1, 2, 2)), np.eye(2)[None]] * 2))
    problem = ro.Problem(objective, [0, 0, 1, 1], None, 0, 0, at_most=1)
    with pytest.raises(ro.InputError, match="at_most"):
        ro.decentralised_ratt(problem)


def test_planners_by_messages_have_options_and_refuse_what_cannot_be():
    problem = ro.limited_view_scenario(4, 4, alpha_s=1, alpha_c=1, seed=1, headings=4).problem()
    assert list(ro.DecentralisedPlanner(hops=1)(problem)) == list(ro.decentralised_ratt(problem, hops=1))
    exchanges = ro.ExchangeParams(most=1)
    planner = ro.DecentralisedPlanner(exchanges=exchanges)
    assert list(planner(problem)) == list(ro.decentralised_refined(problem, params=exchanges))
    with pytest.raises(ro.InputError, match="hops"):
        ro.DecentralisedPlanner(exchanges=exchanges, hops=1)
    with pytest.raises(ro.InputError, match="hops"):
        plan_in_processes(problem, hops=1, exchanges=exchanges)
