"""Missions and studies know the planner; it takes the same choices as RATT on connected teams."""

import numpy as np
import pytest

import ratt_opt as ro


def test_a_mission_planned_by_messages_is_ratt_s():
    scenario = ro.random_scenario(4, 4, alpha_s=1, alpha_c=2, seed=3)
    by_messages, central = (ro.run_mission(scenario, steps=3, planner=name) for name in ("decentralised", "ratt"))
    assert np.array_equal(by_messages.rmse, central.rmse)
    assert np.array_equal(by_messages.nees, central.nees)


def test_a_limit_of_chosen_elements_is_refused_by_name():
    objective = ro.TraceObjective(np.eye(2)[None], np.array([np.zeros((1, 2, 2)), np.eye(2)[None]] * 2))
    problem = ro.Problem(objective, [0, 0, 1, 1], None, 0, 0, at_most=1)
    with pytest.raises(ro.InputError, match="at_most"):
        ro.decentralised_ratt(problem)
