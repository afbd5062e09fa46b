"""A sensor class of one's own counts for what it states: in plans, filters, simulations, files and journals."""

import json

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from ratt_opt import (
    BearingOnly,
    InputError,
    Measurement,
    MissionModel,
    RangeBearing,
    Sensor,
    Tracker,
    bound,
    certify,
    load_input,
    load_scenario,
    random_scenario,
    ratt,
    run_mission,
    save_scenario,
    solve_maxmin,
    worst_case_attack,
)


class Nothing(Sensor):
    """Tells nothing."""

    def information(self, poses, targets):
        return 0 * super().information(poses, targets)


class Share(Sensor):
    """Tells a share of what the library's sensor does."""

    share: float = 0.5

    def information(self, poses, targets):
        return self.share * super().information(poses, targets)


class Noisy(Sensor):
    """Says its share by the noise."""

    share: float = 0.5

    def noise_variances(self, distance, bearing):
        return tuple(variance / self.share for variance in super().noise_variances(distance, bearing))


class Ahead(Sensor):
    """Tells of what is ahead, by its own rule."""

    def information(self, poses, targets):
        told = super().information(poses, targets)
        return told * (targets[None, :, 0] > poses[:, None, 0])[..., None, None]


def team(sensor, seed=1, **options):
    return random_scenario(3, 3, **({"alpha_s": 1, "alpha_c": 0, "seed": seed, "sensor": sensor} | options))


def sightings(scenario, rng):
    return [
        Measurement(i, j, (float(rng.uniform(5, 60)), float(rng.uniform(-3, 3))))
        for i in range(scenario.n_robots)
        for j in range(scenario.n_targets)
    ]


def believed(scenario, measured, order="second order"):
    tracker = Tracker(scenario, model=MissionModel(linearisation=order), gate=None)
    tracker.step()
    tracker.step(measured)
    return tracker.beliefs


def test_a_sensor_that_tells_nothing_leaves_the_belief() -> None:
    scenario = team(Nothing())
    tracker = Tracker(scenario)
    tracker.step()
    skipped = tracker.step(sightings(scenario, np.random.default_rng(0))).skipped
    assert {one.reason for one in skipped} == {"tells nothing"}
    assert tracker.beliefs.trace == pytest.approx(54.0 + 3 * 2 * 0.25)
    assert np.isnan(run_mission(scenario, steps=2).nis).all()


@settings(max_examples=15)
@given(
    share=st.floats(0.05, 3.0),
    seed=st.integers(0, 50),
    order=st.sampled_from(["first order", "second order", "iterated"]),
)
def test_information_of_ones_own_is_the_noise_that_it_implies(share: float, seed: int, order: str) -> None:
    """Two classes that say the same in two ways make the same plans and the same beliefs."""
    stated, by_noise = team(Share(share=share), seed), team(Noisy(share=share), seed)
    measured = sightings(stated, np.random.default_rng(seed))
    first, second = believed(stated, measured, order), believed(by_noise, measured, order)
    np.testing.assert_allclose(first.mean, second.mean, rtol=1e-8)
    np.testing.assert_allclose(first.covariance, second.covariance, rtol=1e-8, atol=1e-11)


def test_missions_draw_the_noise_that_it_implies() -> None:
    rng = np.random.default_rng(0)
    pose, point = np.zeros(3), np.array([9.0, 4.0])
    stated, by_noise = RangeBearing(Share(share=0.3)), RangeBearing(Noisy(share=0.3))
    drawn = stated.disturbance(np.broadcast_to(pose, (4000, 3)), point, rng.standard_normal((4000, 2)))
    expected = by_noise.noise_covariance(pose, point)
    np.testing.assert_allclose(np.cov(drawn.T), expected, rtol=0.1, atol=0.1 * np.sqrt(np.linalg.det(expected)))
    missions = [run_mission(team(kind(share=0.3)), steps=4) for kind in (Share, Noisy)]
    np.testing.assert_allclose(missions[0].traces, missions[1].traces, rtol=1e-9)


def test_a_sighting_outside_its_own_reach_counts_as_where_it_points() -> None:
    """The target is expected behind the robot, where the sensor states nothing, and seen ahead."""
    scenario = random_scenario(1, 1, alpha_s=0, alpha_c=0, seed=0, sensor=Ahead())
    robot = scenario.robots[0].replace(x=0.0, y=0.0, heading=0.0, controls=((0.0, 0.0),))
    target = scenario.targets[0].replace(x=-2.0, y=1.0, speed=0.0, covariance=((16.0, 0.0), (0.0, 16.0)))
    tracker = Tracker(scenario.replace(robots=(robot,), targets=(target,)))
    tracker.step()
    for _ in range(20):
        tracker.step([Measurement(0, 0, (6.0, 0.2))])
    assert np.linalg.norm(tracker.beliefs.mean[0] - 6 * np.array([np.cos(0.2), np.sin(0.2)])) < 1.0


def test_half_a_sensor_cannot_state_the_whole() -> None:
    with pytest.raises(InputError, match="sensor must not state its own information"):
        BearingOnly(Share())


def test_files_refuse_it_by_name_and_hold_its_matrices(tmp_path) -> None:
    scenario = team(Share())
    mixed = team(Sensor())
    mixed = mixed.replace(robots=(*mixed.robots[:2], mixed.robots[2].replace(sensor=Noisy())))
    for owner, text in ((scenario, "sensor must be .* got Share with its own information"), (mixed, r"robots\[2\]")):
        with pytest.raises(InputError, match=text) as refused:
            save_scenario(owner, tmp_path / "team.json")
        assert "\n" not in str(refused.value)
        save_scenario(owner.to_information(), tmp_path / "matrices.json")
        problem, again = owner.problem(), load_input(tmp_path / "matrices.json").problem()
        assert np.array_equal(problem.objective.information, again.objective.information)
        assert owner.digest == load_input(tmp_path / "matrices.json").digest
    assert scenario.digest != team(Share(share=0.25)).digest != team(Sensor()).digest


def test_a_report_is_about_the_sensor_that_was_given(tmp_path) -> None:
    """What it holds of the input gives its numbers again: it held another sensor's, and gave other numbers."""
    report = bound(team(Share(share=0.2)), time_limit=None)
    report.save(tmp_path)
    document = json.loads((tmp_path / "report.json").read_text())
    (tmp_path / "again.json").write_text(json.dumps(document["input"]["document"]))
    again = load_input(tmp_path / "again.json")
    assert document["input"]["sha256"] == again.digest
    problem = again.problem()
    assert worst_case_attack(problem, report.ratt.elements).upper == report.ratt.worst_case.upper


def test_a_certificate_of_it_names_its_matrices(tmp_path) -> None:
    scenario = team(Share())
    problem = scenario.problem()
    proof = certify(problem, solve_maxmin(problem), tmp_path / "c.json", source=scenario)
    assert proof.verified.made_from == scenario.to_information().digest


def test_a_journal_of_another_sensor_is_refused(tmp_path) -> None:
    journal = tmp_path / "j"
    run_mission(team(Share(share=0.2)), steps=2, journal=journal)
    for sensor in (Share(share=0.3), Sensor(), Noisy(share=0.2)):
        with pytest.raises(InputError, match="journal must be of the same mission"):
            run_mission(team(sensor), steps=2, journal=journal)


@pytest.mark.parametrize("reach", [None, 60.0])
def test_matrices_are_the_scenarios_problem(reach, tmp_path) -> None:
    scenario = random_scenario(4, 3, alpha_s=1, alpha_c=1, seed=2).replace(communication_range=reach)
    save_scenario(scenario.to_information(), tmp_path / "m.json")
    problem, again = scenario.problem(), load_input(tmp_path / "m.json").problem()
    assert np.array_equal(problem.objective.prior, again.objective.prior)
    assert problem.communication.links == again.communication.links
    assert np.array_equal(ratt(problem).elements, ratt(again).elements)


def test_fields_of_a_subclass_without_behaviour_are_no_sensor_of_ones_own(tmp_path) -> None:
    class Labelled(Sensor):
        maker: str = "unknown"

    scenario = team(Labelled(maker="us"))
    assert scenario.own_sensors == {}
    save_scenario(scenario, tmp_path / "team.json")
    assert np.array_equal(load_scenario(tmp_path / "team.json").information, scenario.information)
