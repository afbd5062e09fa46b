"""Every field of every input record can be changed, and what results is checked like a file."""

from typing import Any

import pytest

from ratt_opt import InformationInput, InputError, Robot, Scenario, Sensor, random_scenario
from ratt_opt.scenario.record import Record

SCENARIO = random_scenario(3, 2, alpha_s=1, alpha_c=1, seed=0)
INFORMATION = InformationInput(
    prior=[[[2.0]]], information=[[[[1.0]]], [[[0.0]]], [[[0.0]]]], robot=[0, 0, 1], alpha_s=1, alpha_c=0
)
ROBOT, TARGET = SCENARIO.robots[0], SCENARIO.targets[0]

GOOD_AND_BAD: list[tuple[Record, dict[str, tuple[Any, Any]]]] = [
    (
        SCENARIO,
        {
            "format": ("ratt-opt scenario", "ratt-opt information"),
            "version": (1, 2),
            "robots": ((*SCENARIO.robots, Robot(x=1.0, y=2.0)), ()),
            "targets": (SCENARIO.targets[:1], ()),
            "sensor": (Sensor(max_range=50.0), None),
            "sampling_period": (0.5, 0.0),
            "alpha_s": (3, 4),
            "alpha_c": (3, 4),
            "links": (((0, 1), (1, 2)), ((0, 3),)),
            "communication_range": (500.0, -1.0),
            "protected_robots": ((2,), (3,)),
            "protected_links": (((0, 2),), ((0, 3),)),
            "notes": (("measured",), ("two\nlines",)),
        },
    ),
    (
        INFORMATION,
        {
            "format": ("ratt-opt information", "ratt-opt scenario"),
            "version": (1, 2),
            "prior": ([[[3.0]]], [[[-3.0]]]),
            "information": ([[[[1.0]]], [[[2.0]]], [[[4.0]]]], [[[[1.0]]], [[[2.0]]], [[[-4.0]]]]),
            "robot": ((0, 1, 1), (0, 2, 2)),
            "alpha_s": (2, 3),
            "alpha_c": (1, 2),
            "weights": ((2.0,), (0.0,)),
            "labels": (("a", "b", "c"), ("a",)),
            "links": ((), ((0, 2),)),
            "protected_robots": ((1,), (2,)),
            "protected_links": (((0, 1),), ((0, 2),)),
            "notes": (("measured",), ("two\nlines",)),
            "robot_names": (("a", "b"), ("a",)),
            "target_names": (("a",), ("a", "b")),
            "robot_positions": (((0.0, 0.0), (1.0, 1.0)), ((0.0, 0.0),)),
            "element_positions": (((0.0, 0.0),) * 3, ((0.0, float("nan")),) * 3),
            "target_positions": (((0.0, 0.0),), ()),
            "output": (((2.0,),), ((1.0, 2.0),)),
            "at_most": (1, 3),
            "units": (("m",), ("m", "m")),
            "element_headings": ((0.0, 1.0, 2.0), (0.0,)),
            "element_controls": (((1.0, 0.0),) * 3, ((1.0, 0.0),)),
        },
    ),
    (
        ROBOT,
        {
            "x": (1.0, "far"),
            "y": (1.0, float("nan")),
            "heading": (1.0, True),
            "controls": (((1.0, 0.0),), ()),
            "sensor": (Sensor(), 3),
            "name": ("scout", "two\nlines"),
            "z": (30.0, "high"),
            "motion": ("holonomic", "swims"),
        },
    ),
    (
        TARGET,
        {
            "x": (1.0, "far"),
            "y": (1.0, float("nan")),
            "covariance": (((4.0, 1.0), (1.0, 4.0)), ((1.0, 2.0), (2.0, 1.0))),
            "speed": (2.0, float("inf")),
            "turn_rate": (0.1, None),
            "heading": (1.0, True),
            "process_std": (0.0, -1.0),
            "weight": (2.0, 0.0),
            "name": ("boat", "two\nlines"),
            "z": (30.0, "high"),
            "climb": (-1.0, float("inf")),
            "velocity_std": (0.5, 0.0),
            "process_noise": (0.2, -1.0),
        },
    ),
    (
        Sensor(),
        {
            "law": ("std", "gauss"),
            "range_noise": (1.0, 0.0),
            "range_noise_slope": (0.0, -1.0),
            "bearing_noise": (0.01, 0.0),
            "bearing_noise_slope": (0.0, -1.0),
            "max_range": (10.0, 0.0),
            "field_of_view": (1.0, 7.0),
        },
    ),
]
CASES = [
    pytest.param(record, name, *values, id=f"{type(record).__name__}.{name}")
    for record, fields in GOOD_AND_BAD
    for name, values in fields.items()
]


def fields_of(record: Record) -> dict[str, Any]:
    return {name: getattr(record, name) for name in type(record).model_fields}


@pytest.mark.parametrize(("record", "name", "good", "bad"), CASES)
def test_a_field_is_changed_in_a_checked_copy(record: Record, name: str, good: object, bad: object) -> None:
    before = fields_of(record)
    changed = record.replace(**{name: good})
    assert changed == type(record)(**(before | {name: good}))
    assert (changed == record) == (fields_of(changed)[name] == before[name])
    assert fields_of(changed) | {name: None} == before | {name: None}
    assert fields_of(record) == before
    with pytest.raises(InputError, match=name.removeprefix("protected_").rstrip("s")):
        record.replace(**{name: bad})


def test_no_field_is_left_out() -> None:
    for record, fields in GOOD_AND_BAD:
        own = {"payload"}  # does not count for equality: see test_information_input.py
        assert fields.keys() == type(record).model_fields.keys() - own
    with pytest.raises(InputError, match="colour is not a field"):
        SCENARIO.replace(colour="red")


def test_what_follows_from_a_field_follows_it() -> None:
    """A changed copy keeps nothing that was computed from the old fields."""
    assert SCENARIO.information.shape == (36, 2, 2, 2)
    near = SCENARIO.replace(sensor=Sensor(max_range=1e-3), links=((0, 1),))
    assert not near.information.any()
    assert near.problem().communication.links == {(0, 1)}
    assert Scenario(**fields_of(near)) == near
    assert repr(near) == "Scenario(3 robots, 2 targets, alpha_s=1, alpha_c=1)"
