"""A tracker in every robot: each believes what a central tracker believes of exactly the packets that it holds."""

import numpy as np
import pytest

import ratt_opt as ro
from ratt_opt import Attack, Measurement, MissionModel, TeamTrackers, Tracker
from ratt_opt.missions.run import LUCK
from ratt_opt.missions.sensing import simulated_readings
from ratt_opt.missions.world import World

APART = frozenset({(0, 2), (0, 3), (1, 2), (1, 3)})
"""All links between robots 0, 1 and robots 2, 3."""


def scenario(seed=1):
    return ro.random_scenario(4, 3, alpha_s=1, alpha_c=4, seed=seed)


def sightings(poses, truth, rng):
    """Ranges and bearings of all targets from all robots, noisy."""
    found = []
    for i, (x, y, heading) in enumerate(poses[:, :3]):
        for j, target in enumerate(truth):
            apart = target - (x, y)
            bearing = np.arctan2(apart[1], apart[0]) - heading
            noise = rng.normal(size=2) * (0.1, 0.01)
            values = (float(np.hypot(*apart) + noise[0]), float(np.angle(np.exp(1j * (bearing + noise[1])))))
            found.append(Measurement(i, j, values))
    return found


def flown(team, attacks, seed=0):
    """Fly some steps; return poses and measurements of each."""
    rng, truth, log = np.random.default_rng(seed), team.trackers[0].beliefs.positions.copy(), []
    for k, attack in enumerate(attacks):
        poses = team.poses
        made = sightings(poses, truth, rng) if k else []
        step = team.step(made, attack)
        log.append((poses, made, step))
    return log


def test_a_connected_team_believes_and_plans_as_one_tracker():
    team, central = TeamTrackers(scenario(), gate=None), Tracker(scenario(), gate=None)
    for poses, made, step in flown(team, [Attack()] * 5):
        plan = central.step(made, poses=poses)
        assert list(step.elements) == list(plan.elements)
    assert all(tracker.beliefs == central.beliefs for tracker in team.trackers)


def test_split_robots_believe_what_they_heard_and_catch_up_when_links_return():
    attacks = [Attack(), Attack(), Attack(frozenset({3}), APART), Attack(frozenset(), APART), Attack(), Attack()]
    team = TeamTrackers(scenario(), gate=None)
    log = flown(team, attacks[:4])
    for i, mine in ((0, {0, 1}), (2, {2, 3})):
        known = Tracker(scenario(), gate=None)
        for k, (poses, made, _) in enumerate(log):
            heard = [m for m in made if (k < 2 or m.robot in mine) and m.robot not in attacks[k].sensing]
            known.step(heard, poses=poses)
        assert np.allclose(team.trackers[i].beliefs.mean, known.beliefs.mean, rtol=0, atol=1e-9)
        assert np.allclose(team.trackers[i].beliefs.covariance, known.beliefs.covariance, rtol=1e-9)
    assert team.trackers[1].beliefs == team.trackers[0].beliefs != team.trackers[2].beliefs
    again = TeamTrackers(scenario(), gate=None)
    log = flown(again, attacks)
    whole = Tracker(scenario(), gate=None)
    for k, (poses, made, _) in enumerate(log):
        whole.step([m for m in made if m.robot not in attacks[k].sensing], poses=poses)
    for tracker in again.trackers:
        assert tracker.beliefs == again.trackers[0].beliefs
        assert np.allclose(tracker.beliefs.mean, whole.beliefs.mean, rtol=0, atol=1e-9)


def test_a_mission_whose_links_stay_cut_has_the_same_beliefs_and_plans():
    cut, cameras = Attack(frozenset(), APART), ro.limited_view_scenario(4, 4, alpha_s=0, alpha_c=4, seed=2)
    mission = ro.run_mission(
        cameras,
        steps=4,
        planner="decentralised",
        attacker=lambda problem, _: Attack(frozenset(), APART & problem.communication.links),
        attacks="persistent",
        sharing="all surviving",
        seed=3,
    )
    team, world = TeamTrackers(cameras, gate=None), World(cameras, MissionModel(), 1)
    made, attack, standing = [], Attack(), Attack()
    for k, step in enumerate(mission.steps):
        planned = team.step(made, attack, standing=standing)
        assert np.array_equal(planned.controls, step.controls)
        rng = np.random.default_rng(np.random.SeedSequence(3, spawn_key=(k, LUCK)))
        luck = rng.standard_normal((4, 4, max(sensor.size for sensor in world.sensors)))
        made = [
            Measurement(i, j, tuple(map(float, reading.values[j])))
            for i, reading in enumerate(simulated_readings(world, step.poses, step.truth, luck))
            for j in np.flatnonzero(reading.seen)
        ]
        attack = standing = step.attack
    team.step(made, attack, standing=standing)
    assert mission.steps[-1].attack == cut
    for track in mission.steps[-1].groups:
        for i in track.robots:
            assert np.allclose(team.trackers[i].beliefs.mean, track.belief.mean, rtol=0, atol=1e-9)


def test_what_a_tracker_refuses_is_refused():
    with pytest.raises(ro.InputError, match="planner"):
        TeamTrackers(scenario(), planner="nobody")
    with pytest.raises(ro.InputError, match="time_limit"):
        TeamTrackers(scenario(), time_limit=0.0)
