"""A mission as a game: the API's own test, and the same mission as ``run_mission`` flies."""

import numpy as np
import pytest

import ratt_opt as ro

pytest.importorskip("pettingzoo", reason="the extra pettingzoo is not installed")


def game(steps=4, **options):
    from ratt_opt.interop.pettingzoo_env import TrackingEnv

    team = ro.limited_view_scenario(4, 3, alpha_s=1, alpha_c=2, seed=1)
    return team, TrackingEnv(team, steps=steps, **options)


@pytest.mark.filterwarnings("ignore")
def test_the_api_test_of_pettingzoo_passes():
    from pettingzoo.test import parallel_api_test, parallel_seed_test

    parallel_api_test(game()[1], num_cycles=12)
    parallel_seed_test(lambda: game()[1], num_cycles=6)


def test_an_episode_by_ratt_is_the_mission_by_ratt():
    team, env = game()
    mission = ro.run_mission(team, steps=4, planner="ratt", attacker="worst", seed=7)
    env.reset(seed=7)
    for step in mission.steps:
        agents = list(env.agents)
        _, rewards, terminated, truncated, infos = env.step(env.actions_of(ro.ratt(env.problem)))
        assert set(rewards.values()) == {step.value}
        assert infos[agents[0]]["attack"] == step.attack
        assert not any(terminated.values())
    assert all(truncated.values())
    assert env.agents == []


def test_observations_hold_what_planners_know():
    team, env = game()
    seen, _ = env.reset(seed=1)
    agents = env.possible_agents
    assert all(env.observation_space(agent).contains(seen[agent]) for agent in agents)
    assert np.array_equal(np.array([seen[agent][:4] for agent in agents]), np.eye(4))
    assert np.array_equal(seen[agents[0]][4:16].reshape(4, 3), team.poses[:, :3])
    assert [env.action_space(agent).n for agent in agents] == [16] * 4


def test_bad_actions_are_named():
    _, env = game()
    with pytest.raises(ro.InputError, match="must come after reset"):
        env.step({})
    env.reset()
    first = env.agents[0]
    with pytest.raises(ro.InputError, match="must have one for every agent"):
        env.step({first: 0})
    with pytest.raises(ro.InputError, match=rf"action of {first} must be an integer in \[0, 15\]; got 99"):
        env.step(dict.fromkeys(env.agents, 99))
    with pytest.raises(ro.InputError, match="agent must be one of"):
        env.action_space("nobody")
