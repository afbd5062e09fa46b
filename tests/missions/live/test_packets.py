"""Bad packets and outliers: what is skipped and why, and beliefs against a NumPy filter with a gate of its own."""

import json
import logging

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.optimize import brentq
from scipy.stats import chi2

import ratt_opt as ro
from ratt_opt import Attack, Gate, InputError, Measurement, MissionModel, Tracker, TrackerState, random_scenario
from tests.afternoon import nearest
from tests.missions import numpy_filter

STILL = ((0.0, 0.0),)


def standing(n_robots=2, n_targets=2, **options):
    scenario = random_scenario(n_robots, n_targets, alpha_s=0, alpha_c=0, seed=7, controls=STILL)
    return scenario.replace(**options)


def seen_from(scenario, robot, place, rng):
    value, *_ = numpy_filter.observed(scenario.poses[robot], place)
    return tuple((value + rng.normal(size=2) * [0.3, 0.02]).tolist())


def test_bad_packets_cost_nothing_but_themselves(caplog) -> None:
    """Twenty good measurements and one of each kind of bad one: the belief is that of the good ones."""
    rng = np.random.default_rng(0)
    team = standing(5, 5)
    trackers = [Tracker(team), Tracker(team)]
    for tracker in trackers:
        tracker.step(now=10.0)
        tracker.step(now=11.0)
        tracker.drop_target(4)
        tracker.lose(4)
        tracker.attacked(Attack({3}))
        tracker.add_target(team.targets[4])
    places = [np.array([t.x, t.y]) for t in team.targets]
    good = [Measurement(i, j, seen_from(team, i, places[j], rng), 11.5) for i in range(3) for j in range(4)]
    late = [Measurement(i, 0, seen_from(team, i, places[0], rng), 12.005) for i in range(3)]  # a clock 5 ms ahead
    bad = {
        "unknown robot": Measurement(9, 0, (30.0, 0.1)),
        "unknown target": Measurement(0, 4, (30.0, 0.1)),
        "lost robot": Measurement(4, 0, (30.0, 0.1), 11.5),
        "blinded robot": Measurement(3, 0, seen_from(team, 3, places[0], rng), 11.5),
        "future": Measurement(0, 1, (30.0, 0.1), 12.5),
        "too late": Measurement(0, 1, (30.0, 0.1), 9.0),
        "before its target": Measurement(0, 5, (30.0, 0.1), 10.5),
        "repeated": good[0],
        "impossible": Measurement(0, 1, (-30.0, 0.1), 11.7),
        "outlier": Measurement(0, 1, (1000 * good[1].values[0], good[1].values[1]), 11.8),
    }
    with caplog.at_level(logging.WARNING, logger="ratt_opt.tracker"):
        plan = trackers[0].step([*good, *late, *bad.values()], now=12.0)
    clean = trackers[1].step([*good, *late], now=12.0)
    assert {one.reason: one.measurement for one in plan.skipped} == bad
    assert len(caplog.records) == len(bad)
    assert all("\n" not in one.why and one.reason in caplog.text for one in plan.skipped)
    assert clean.skipped == ()
    np.testing.assert_allclose(trackers[0].beliefs.mean, trackers[1].beliefs.mean, rtol=1e-12)
    assert len(clean.innovations) == len(good) + len(late)
    again = trackers[0].step(late, now=13.0)  # the same stamps, now of the past
    assert [one.reason for one in again.skipped] == ["repeated"] * 3
    for reason, packet in bad.items():
        if reason != "outlier":
            before = trackers[1].state
            with pytest.raises(InputError):
                trackers[1].step([packet, *good[:1]], now=12.0, strict=True)
            assert trackers[1].state is before


@pytest.mark.parametrize(
    "broken", [Measurement(0, 0, (1.0,)), Measurement(0, 0, (1.0, np.nan)), Measurement("a", 0, (1.0, 1.0)), "packet"]
)
def test_programming_errors_stay_errors(broken) -> None:
    tracker = Tracker(standing())
    with pytest.raises(InputError):
        tracker.step([broken])


class Oracle:
    """One target's filter with a gate: covariance form, written out again."""

    def __init__(self, target, variances, probability=0.999, patience=5):
        self.mean, self.covariance = np.array([target.x, target.y]), np.array(target.covariance)
        self.noise, self.variances = target.process_std**2, variances
        self.limit, self.patience, self.refused = chi2.ppf(probability, 2), patience, 0

    def square(self, sighting, scale=1.0):
        pose, values = sighting
        value, slope, bend = numpy_filter.observed(pose, self.mean)
        P = self.covariance * scale
        R = np.diag(self.variances(*value))
        R = R + 0.5 * np.array([[np.trace(a @ P @ b @ P) for b in bend] for a in bend])
        surprise = values - value
        surprise[1] = numpy_filter.wrapped(surprise[1])
        return float(surprise @ np.linalg.solve(slope @ P @ slope.T + R, surprise))

    def advance(self, sightings):
        self.covariance = self.covariance + self.noise * np.eye(2)
        squares = [self.square(one) for one in sightings]
        if sightings and min(squares) > self.limit:
            if self.refused >= self.patience:
                return squares, self.find(sightings, squares)
            self.refused += 1
        passed = [one for one in sightings if self.square(one) <= self.limit]
        self.refused = 0 if passed else self.refused
        self.take(passed)
        return squares, False

    def take(self, passed):
        triples = [(pose, values, None) for pose, values in passed]
        self.mean, self.covariance = numpy_filter.updated(self.mean, self.covariance, triples, self.variances)

    def find(self, sightings, squares):
        """Where most sightings agree, of equal choices the nearest."""
        before, best = (self.mean, self.covariance), (0, None, None)
        for k in np.argsort(squares, kind="stable"):
            one = sightings[k]
            scale = np.exp(brentq(lambda s, one=one: self.square(one, np.exp(s)) - 2, 0, np.log(1e12), xtol=1e-13))
            self.covariance = before[1] * scale
            self.take([one])
            agree = [other for other in sightings if other is one or self.square(other) <= self.limit]
            best = (len(agree), agree, scale) if len(agree) > best[0] else best
            self.mean, self.covariance = before
        self.covariance, self.refused = before[1] * best[2], 0
        self.take(best[1])
        return True


@settings(max_examples=4)
@given(seed=st.integers(0, 10_000))
def test_the_gated_belief_is_that_of_an_independent_filter(seed: int) -> None:
    """Outliers, and now and then a target that is elsewhere for good, so that it is lost and found again."""
    rng = np.random.default_rng(seed)
    scenario = standing(3, 2)
    scenario = scenario.replace(targets=[t.replace(speed=0.0) for t in scenario.targets])
    tracker = Tracker(scenario, gate=Gate(patience=3))
    oracles = [Oracle(t, scenario.sensor.noise_variances, patience=3) for t in scenario.targets]
    places = [np.array([t.x, t.y]) + rng.normal(size=2) for t in scenario.targets]
    tracker.step(now=0.0)
    events, squares_apart = set(), []
    for now in range(1, 14):
        if now == 4:
            places[1] = places[1] + [150.0, -90.0]
        made = [
            Measurement(i, j, seen_from(scenario, i, places[j], rng))
            for i in range(3)
            for j in range(2)
            if rng.random() < 0.7
        ]
        wrong = {0: 0.5, 1: 0.4 if now < 4 else 0.0}
        made = [
            m if rng.random() > wrong[m.target] else Measurement(m.robot, m.target, (m.values[0] * 3, 1.0))
            for m in made
        ]
        plan = tracker.step(made, now=float(now))
        expected = []
        for j, oracle in enumerate(oracles):
            own = [(scenario.poses[m.robot], np.array(m.values)) for m in made if m.target == j]
            squares, found = oracle.advance(own)
            assert found == (j in plan.found)
            expected += squares
        events |= {"lost"} if plan.lost else set()
        events |= {"found"} if plan.found else set()
        if now > 7:
            squares_apart.append(float(tracker.beliefs.nees(np.array(places))[1]))
        told = sorted(plan.innovations, key=lambda one: one.measurement.target)
        np.testing.assert_allclose([one.squared for one in told], expected, rtol=1e-7)
        np.testing.assert_allclose(tracker.beliefs.mean, [o.mean for o in oracles], rtol=1e-9, atol=1e-9)
        np.testing.assert_allclose(tracker.beliefs.covariance, [o.covariance for o in oracles], rtol=1e-9, atol=1e-9)
        assert tracker.state.moments[-1].refused == tuple(o.refused for o in oracles)
    assert events == {"lost", "found"}
    assert min(squares_apart) < chi2.ppf(1 - 1e-6, 2)  # it was where the target is
    state = TrackerState.from_dict(json.loads(json.dumps(tracker.state.to_dict())))
    assert state == tracker.state


def test_a_gate_of_none_takes_all_and_a_wrong_one_is_refused() -> None:
    scenario = standing(1, 1)
    tracker = Tracker(scenario, gate=None)
    tracker.step(now=0.0)
    (one,) = tracker.step([Measurement(0, 0, (1e5, 0.0))], now=1.0).innovations
    assert one.accepted
    assert one.squared > 1e5
    assert one.probability == 0.0
    for gate in (0.0, 1.0, 2.0):
        with pytest.raises(InputError, match="gate must be a probability between 0 and 1"):
            Tracker(scenario, gate=gate)


def test_states_of_version_2_are_read() -> None:
    tracker = Tracker(standing(), gate=None)
    tracker.step([Measurement(0, 0, (30.0, 0.1))], now=0.0)
    document = json.loads(json.dumps(tracker.state.to_dict()))
    old = {k: v for k, v in document.items() if k not in {"blinded", "failed", "attacks"}} | {"version": 2}
    for moment in old["moments"]:
        del moment["refused"]
        moment["measurements"] = [row[:3] for row in moment["measurements"]]
    assert TrackerState.from_dict(old) == tracker.state


@pytest.mark.parametrize("limit", [None, 5.0])
@pytest.mark.parametrize("error", [RuntimeError("boom"), TimeoutError("mine"), None])
def test_a_planner_that_fails_costs_no_plan(limit, error) -> None:
    def planner(_problem):
        if error is not None:
            raise error
        return [0]  # no plan

    team = random_scenario(4, 3, alpha_s=1, alpha_c=2, seed=3)
    tracker = Tracker(team, planner=planner, time_limit=limit)
    plan = tracker.step()
    assert plan.fallback
    assert (tracker.state.failed, tracker.state.missed) == (1, 0)
    problem = team.problem()
    assert problem.check_plan(plan.elements).shape == (4,)
    with pytest.raises(type(error) if error else InputError):
        Tracker(team, planner=planner, time_limit=limit, strict=True).step()


def test_planners_see_the_same_world_everywhere() -> None:
    """In one step with nothing known to have failed, tracker, mission, bound and study see one world."""
    team = random_scenario(4, 3, alpha_s=1, alpha_c=2, seed=3, communication_range=60.0)
    worlds = []

    def spy(problem, world):
        worlds.append((problem, world))
        return nearest(problem, world)

    model = MissionModel(linearisation="first order")
    flown = ro.run_mission(team, steps=3, planner=spy, model=model)
    Tracker(team, planner=spy, model=model).step()
    ro.bound(team, planners={"nearest": spy}, time_limit=2.0, guarantees="none")
    (first, *_, live, single) = worlds
    for _, world in (live, single):
        for name in ("poses", "ends", "controls", "states", "covariances", "links", "robots", "step", "attacks"):
            np.testing.assert_equal(getattr(world, name), getattr(first[1], name), err_msg=name)
    problem, world = first
    assert set(world.links) == problem.communication.links
    for (i, j), length in world.links.items():
        assert length == pytest.approx(np.linalg.norm(team.poses[i, :2] - team.poses[j, :2]))
    np.testing.assert_allclose(world.targets, team.predicted_targets)
    np.testing.assert_allclose(world.covariances, team.prior)
    later = worlds[2][1]
    assert later.step == 2
    assert later.attacks[0] == (0, flown.steps[0].attack)
    assert np.array_equal(flown.decisions[0][0], nearest(*first))


def test_parts_see_their_own_robots() -> None:
    """Robots that failures keep apart plan for themselves, in numbers of their own."""
    team = random_scenario(4, 3, alpha_s=0, alpha_c=4, seed=3)
    cut = Attack(frozenset(), frozenset({(0, 2), (0, 3), (1, 2), (1, 3)}))
    worlds = []

    def spy(problem, world):
        worlds.append(world)
        assert world.poses.shape[0] == problem.n_robots
        assert len(world.ends) == problem.objective.n
        return nearest(problem, world)

    ro.run_mission(
        team,
        steps=2,
        planner=spy,
        attacker=lambda _problem, _plan: cut,
        attacks="persistent",
        sharing="all surviving",
    )
    assert [world.robots for world in worlds] == [(0, 1, 2, 3), (0, 1), (2, 3)]
    assert [set(world.links) for world in worlds[1:]] == [{(0, 1)}, {(0, 1)}]
