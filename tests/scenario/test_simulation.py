"""Simulated tracking: the filter's covariance is the plan's, and its errors are as large as it says."""

import numpy as np
import pytest

from ratt_opt import InputError, Sensor, random_scenario, ratt, simulate_tracking


@pytest.mark.parametrize("seed", range(5))
def test_joseph_covariance_is_the_information_form(seed: int) -> None:
    scenario = random_scenario(5, 4, alpha_s=1, alpha_c=2, seed=seed)
    problem = scenario.problem()
    plan = ratt(problem).elements
    for group in ([], [2], [0, 3, 4]):
        tracking = simulate_tracking(scenario, plan, group, seed=1, draws=3)
        expected = np.linalg.inv(problem.objective.posterior_information(plan[group]))
        np.testing.assert_allclose(tracking.covariances, np.broadcast_to(expected, (3, 4, 2, 2)), rtol=1e-9)
        value = problem.objective.prior.trace(axis1=1, axis2=2).sum() - 4 * tracking.trace
        assert value == pytest.approx(problem.objective(plan[group]), rel=1e-9, abs=1e-9)


def test_without_measurements_the_error_is_the_prior() -> None:
    scenario = random_scenario(2, 3, alpha_s=0, alpha_c=0, seed=4)
    tracking = simulate_tracking(scenario, ratt(scenario.problem()).elements, [], seed=0, draws=20_000)
    assert np.array_equal(tracking.estimates[0], tracking.estimates[1])
    errors = tracking.truth - tracking.estimates
    sampled = np.einsum("dmi,dmj->mij", errors, errors) / len(errors)
    np.testing.assert_allclose(sampled, tracking.covariances[0], atol=0.05 * tracking.trace)
    assert tracking.mse == pytest.approx(tracking.trace, rel=0.03)


def test_the_same_luck_for_every_group_and_plan() -> None:
    scenario = random_scenario(3, 2, alpha_s=0, alpha_c=0, seed=4)
    plan = ratt(scenario.problem()).elements
    first, second = (simulate_tracking(scenario, plan, g, seed=5, draws=4) for g in ([0], [1, 2]))
    assert np.array_equal(first.truth, second.truth)
    again = simulate_tracking(scenario, plan, [0], seed=5, draws=4)
    assert np.array_equal(first.estimates, again.estimates)
    assert not np.array_equal(first.truth, simulate_tracking(scenario, plan, [0], seed=6, draws=4).truth)


def test_a_sighting_counts_wherever_the_target_was_expected() -> None:
    """The edge of the reach is where targets are expected: what is seen of the nearer half is not thrown away."""
    scenario = random_scenario(1, 1, alpha_s=0, alpha_c=0, seed=4)
    plan = ratt(scenario.problem()).elements
    reach = float(np.linalg.norm(scenario.predicted_poses[plan[0], :2] - scenario.predicted_targets[0])) - 0.5
    short = scenario.replace(sensor=scenario.sensor.replace(max_range=reach))
    whole, part = (simulate_tracking(s, plan, [0], seed=0, draws=400) for s in (scenario, short))
    places = whole.truth[:, 0] - scenario.predicted_poses[plan[0], :2]
    seen = np.linalg.norm(places, axis=-1) <= reach
    assert 0.2 < seen.mean() < 0.8
    assert np.array_equal(part.estimates[seen], whole.estimates[seen])
    assert np.array_equal(part.estimates[~seen, 0], np.broadcast_to(scenario.predicted_targets[0], ((~seen).sum(), 2)))


def test_a_sensor_that_states_its_information_is_refused_by_name() -> None:
    class Vague(Sensor):
        def information(self, poses, targets):
            return 0.1 * super().information(poses, targets)

    scenario = random_scenario(2, 2, alpha_s=0, alpha_c=0, seed=4, sensor=Vague())
    with pytest.raises(InputError, match=r"sensor of robots\[1\] must not state its own information; got Vague"):
        simulate_tracking(scenario, ratt(scenario.problem()).elements, [1], seed=0)


@pytest.mark.parametrize(
    ("change", "name"), [({"seed": -1}, "seed"), ({"draws": 0}, "draws"), ({"robots": [3]}, "robot")]
)
def test_bad_arguments_are_refused(change: dict[str, object], name: str) -> None:
    scenario = random_scenario(3, 2, alpha_s=0, alpha_c=0, seed=4)
    plan = ratt(scenario.problem()).elements
    arguments: dict[str, object] = {"robots": [0], "seed": 0, "draws": 1} | change
    with pytest.raises(InputError, match=name):
        simulate_tracking(scenario, plan, **arguments)  # type: ignore[arg-type]
