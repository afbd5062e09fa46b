"""Numbers of drawn scenarios are arguments: speeds, areas and network shapes, checked by name."""

import numpy as np
import pytest

import ratt_opt as ro
from ratt_opt import NetworkShape

BUDGETS = {"alpha_s": 1, "alpha_c": 1, "seed": 2}


def test_targets_move_as_they_are_told() -> None:
    drawn = ro.random_scenario(3, 9, **BUDGETS, target_speeds=(1.0, 2.0), target_turn_rates=(0.3,))
    assert {target.speed for target in drawn.targets} == {1.0, 2.0}
    assert {target.turn_rate for target in drawn.targets} == {0.3}
    with pytest.raises(ro.InputError, match="target_speeds and target_turn_rates must hold"):
        ro.random_scenario(3, 1, **BUDGETS, target_speeds=())


def test_views_are_drawn_in_the_area_and_at_the_speeds_that_are_given() -> None:
    plain = ro.limited_view_scenario(4, 4, **BUDGETS, reach=None)
    small = ro.limited_view_scenario(4, 4, **BUDGETS, side=30.0, speeds=(1.0,), target_speed=0.1)
    np.testing.assert_allclose(small.poses[:, :2], plain.poses[:, :2] / 2)
    assert {control[0] for robot in small.robots for control in robot.controls} == {1.0}
    assert max(target.speed for target in small.targets) <= 0.1
    wide = ro.limited_view_scenario(4, 4, **BUDGETS, crowd=1)
    np.testing.assert_allclose(wide.poses[:, :2], plain.poses[:, :2] * 2)


@pytest.mark.parametrize("bad", [{"side": 0}, {"crowd": 0}, {"target_speed": float("nan")}, {"speeds": ()}])
def test_bad_numbers_of_views_are_refused_by_name(bad: dict[str, object]) -> None:
    with pytest.raises(ro.InputError, match=next(iter(bad))):
        ro.limited_view_scenario(2, 2, **BUDGETS, **bad)


def test_networks_have_the_shape_that_is_given() -> None:
    shapes = {
        "dense": (NetworkShape(density=1.0), 45),
        "small-world": (NetworkShape(neighbours=2, rewired=0.0), 10),
        "hubs": (NetworkShape(attached=1), 9),
    }
    for family, (shape, count) in shapes.items():
        scenario = ro.network_scenario(family, 10, 3, **BUDGETS, shape=shape)
        assert len(scenario.links) == count
    with pytest.raises(ro.InputError, match=r"shape.density must be in \[0, 1\]; got 2"):
        NetworkShape(density=2)
    with pytest.raises(ro.InputError, match=r"shape.attached must be an integer >= 1; got 0"):
        NetworkShape(attached=0)
