"""Teams with limited views, checked against what defines them: geometry, controls, files, refusals."""

import math

import numpy as np
import pytest

import ratt_opt as ro


def _sees(scenario: ro.Scenario, view: float, reach: float | None) -> np.ndarray:
    """(E, M) from the geometry alone."""
    poses, targets = scenario.predicted_poses, scenario.predicted_targets
    seen = np.zeros((len(poses), len(targets)), dtype=bool)
    for e, (x, y, heading) in enumerate(poses):
        for j, (u, v) in enumerate(targets):
            ahead = np.array([math.cos(heading), math.sin(heading)])
            apart = np.array([u - x, v - y])
            distance = float(np.linalg.norm(apart))
            angle = math.degrees(math.acos(np.clip(ahead @ apart / distance, -1, 1)))
            seen[e, j] = angle <= view / 2 and (reach is None or distance <= reach)
    return seen


@pytest.mark.parametrize(("view", "reach"), [(57, None), (60, 25.0), (120, 40), (360, 20.0), (360, None)])
@pytest.mark.parametrize("seed", range(3))
def test_information_is_zero_exactly_outside_the_view_and_reach(view, reach, seed):
    scenario = ro.limited_view_scenario(6, 8, alpha_s=2, alpha_c=4, seed=seed, view=view, reach=reach)
    objective = scenario.problem("trace").objective
    told = np.abs(objective.information).max(axis=(2, 3)) > 0
    assert (told == _sees(scenario, view, reach)).all()


@pytest.mark.parametrize("headings", [1, 2, 3, 8, 12])
def test_controls_are_two_speeds_times_equally_spaced_headings(headings):
    scenario = ro.limited_view_scenario(3, 4, alpha_s=1, alpha_c=1, seed=5, view=200, headings=headings)
    for i, robot in enumerate(scenario.robots):
        own = scenario.robot == i
        assert sorted({speed for speed, _ in robot.controls}) == [0.0, 2.0]
        assert own.sum() == 2 * headings
        for speed in (0.0, 2.0):
            looks = scenario.predicted_poses[own & (scenario.controls[:, 0] == speed), 2] - robot.heading
            steps = np.mod(looks * headings / (2 * math.pi), headings)
            found = sorted(round(float(step)) % headings for step in steps)
            assert np.allclose(np.mod(steps + 0.5, 1), 0.5)
            assert found == list(range(headings))
            assert (np.abs(looks) <= math.pi + 1e-12).all()


@pytest.mark.parametrize(("n_robots", "side"), [(2, 60.0), (6, 60.0), (10, 60.0), (40, 120.0)])
def test_the_square_grows_with_the_team_so_that_density_stays(n_robots, side):
    scenarios = [ro.limited_view_scenario(n_robots, 30, alpha_s=0, alpha_c=0, seed=s, view=360) for s in range(30)]
    places = np.concatenate([[(t.x, t.y) for t in s.targets] + [(r.x, r.y) for r in s.robots] for s in scenarios])
    assert places.min() >= 0
    assert 0.97 * side < places.max() <= side


def test_links_are_complete_or_those_within_range():
    complete = ro.limited_view_scenario(6, 5, alpha_s=2, alpha_c=4, seed=1)
    assert complete.problem().communication.links == frozenset((i, j) for j in range(6) for i in range(j))
    disk = ro.limited_view_scenario(6, 5, alpha_s=2, alpha_c=4, seed=1, communication_range=30)
    near = {
        (i, j)
        for j in range(6)
        for i in range(j)
        if math.dist((disk.robots[i].x, disk.robots[i].y), (disk.robots[j].x, disk.robots[j].y)) <= 30
    }
    assert disk.problem().communication.links == near
    assert disk.robots == complete.robots


@pytest.mark.parametrize("sensor", ["camera", "radar", ro.Sensor()])
def test_files_hold_the_family(sensor, tmp_path):
    scenario = ro.limited_view_scenario(
        5, 4, alpha_s=1, alpha_c=2, seed=2, view=75.5, reach=33, headings=6, communication_range=40, sensor=sensor
    )
    ro.save_scenario(scenario, tmp_path / "team.json")
    loaded = ro.load_scenario(tmp_path / "team.json")
    assert loaded == scenario
    assert (loaded.problem().objective.information == scenario.problem().objective.information).all()


def test_the_same_seed_gives_the_same_team_and_another_seed_another():
    first, again, other = (ro.limited_view_scenario(4, 3, alpha_s=1, alpha_c=1, seed=s) for s in (7, 7, 8))
    assert first == again
    assert first.robots != other.robots


@pytest.mark.parametrize(
    ("arguments", "text"),
    [
        ({"view": 361}, r"view must be in \(0, 360\] degrees; got 361"),
        ({"view": 0}, r"view must be in \(0, 360\] degrees; got 0"),
        ({"view": -5.0}, r"view must be in \(0, 360\] degrees; got -5.0"),
        ({"view": math.nan}, r"view must be in \(0, 360\] degrees; got nan"),
        ({"view": "wide"}, r"view must be in \(0, 360\] degrees; got wide"),
        ({"reach": 0}, r"reach must be a finite number > 0 \[m\], or None; got 0"),
        ({"reach": -3}, r"reach must be a finite number > 0 \[m\], or None; got -3"),
        ({"reach": "far"}, r"reach must be a finite number > 0 \[m\], or None; got far"),
        ({"reach": math.inf}, r"reach must be a finite number > 0 \[m\], or None; got inf"),
        ({"reach": math.nan}, r"reach must be a finite number > 0 \[m\], or None; got nan"),
        ({"reach": 1e-6}, "view and reach must let a robot see a target; got 60 degrees, 1e-06 m"),
        ({"view": 1e-9}, "view and reach must let a robot see a target; got 1e-09 degrees, no limit"),
        ({"headings": 0}, "headings must be an integer >= 1; got 0"),
        ({"communication_range": -1}, "communication_range must be"),
        ({"sensor": "sonar"}, "sensor must be camera, radar or a Sensor; got sonar"),
        ({"alpha_s": 7}, "alpha_s must be"),
        ({"prior_std": 0}, "prior_std must be"),
        ({"seed": -1}, "seed must be"),
    ],
)
def test_bad_input_is_refused_in_one_line(arguments, text):
    given = {"alpha_s": 1, "alpha_c": 1, "seed": 0} | arguments
    with pytest.raises(ro.InputError, match=text) as caught:
        ro.limited_view_scenario(4, 3, **given)
    assert "\n" not in str(caught.value)
