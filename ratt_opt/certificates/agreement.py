"""Agreement of a certificate with the problem in a file, on any machine.

Two machines compute the matrices of one scenario with differences in the last digits (vector instructions). So they
are enclosed anew from the scenario's own numbers, in ball arithmetic that shares nothing with the code that
computed them: every stored number must lie in the ball of all values that rounding can give, and links within a range
must be those that the balls of the distances allow. A change of the data that moves a number out of its ball is
refused. Everything that is not computed must be equal.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from flint import arb, ctx

from ratt_opt.certificates.stated_problem import problem_document
from ratt_opt.certificates.verifier.work import tick
from ratt_opt.scenario.model import Scenario
from ratt_opt.scenario.sensor import Sensor

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from ratt_opt.scenario.information_input import InformationInput
    from ratt_opt.scenario.model import Robot, Target

__all__ = ["differences"]

OF_POSITIONS = 2.0**-49
"""Rounding of a position or an angle, relative to the largest number it is made of: a few roundings of 2^-53."""
OF_ENTRIES = 2.0**-45
"""Rounding of an entry, relative to the sum of the sizes of its terms: a dozen operations, a few ulps each."""

Point = tuple[arb, arb]


def differences(given: Scenario | InformationInput, objective: str) -> Callable[[Any], str]:
    """Return what says of a certificate's problem record how it differs from ``given``: nothing, or words.

    The matrices of an information file are not computed, and must be equal; so must those of sensors of other classes
    than the library's, whose arithmetic is not known here.
    """
    expected = problem_document(given.problem(objective))

    def difference(record: Any) -> str:
        if record == expected:
            return ""
        if not isinstance(record, dict) or set(record) != set(expected):
            return "its record has other fields"
        if not isinstance(given, Scenario) or not _enclosable(given):
            return _unequal(record, expected, set())
        with ctx.workprec(160):  # three times the bits of a float: balls are far narrower than the roundings allowed
            return (
                _unequal(record, expected, {"prior", "information", "links"})
                or ("" if _linked(given, record["links"], expected["links"]) else "its links differ")
                or _outside(record, "prior", (_prior(target) for target in given.targets))
                or _outside(
                    record, "information", (row for robot in given.robots for row in _information(given, robot))
                )
            )

    return difference


def _enclosable(given: Scenario) -> bool:
    """Tell whether the formulas of all sensors, motions and noises stand here."""
    noises = all(target.process_noise is None for target in given.targets)
    motions = all(robot.motion == "unicycle" for robot in given.robots)
    return noises and motions and all(type(robot.sensor or given.sensor) is Sensor for robot in given.robots)


def _unequal(record: dict[str, Any], expected: dict[str, Any], computed: set[str]) -> str:
    names = [name for name in expected if name not in computed and record[name] != expected[name]]
    if "objective" in names:
        return f"its criterion is {record['objective']!s:.20}, not {expected['objective']}"
    return f"its field '{names[0]}' differs" if names else ""


def _outside(record: dict[str, Any], name: str, enclosed: Iterator[Any]) -> str:
    return (
        ""
        if _inside(record[name], enclosed)
        else f"its {name} is not what comes of the given one, however it is rounded"
    )


def _linked(given: Scenario, stored: Any, expected: list[list[int]]) -> bool:
    """Test whether links are those of the scenario.

    If links follow from a range, those that rounding decides may differ.
    """
    if stored == expected or given.communication_range is None:
        return bool(stored == expected)
    try:
        differing = {(i, j) for i, j in stored} ^ {(i, j) for i, j in expected}
    except (TypeError, ValueError):
        return False
    return all(_at_range(given, *link) for link in differing)


def _at_range(given: Scenario, *link: Any) -> bool:
    if not all(type(i) is int and 0 <= i < given.n_robots for i in link):
        return False
    a, b = (given.robots[i] for i in link)
    distance = ((arb(a.x) - b.x) ** 2 + (arb(a.y) - b.y) ** 2).sqrt()
    return bool(_rounded(distance, a.x, b.x, a.y, b.y, share=OF_POSITIONS).overlaps(arb(given.communication_range)))


def _inside(stored: Any, enclosed: Iterator[Any]) -> bool:
    """Test whether nested lists of floats lie in nested lists of balls (or sets of balls) of the same shape."""
    balls = list(enclosed)
    if not isinstance(stored, list) or len(stored) != len(balls):
        return False
    for item, ball in zip(stored, balls, strict=True):
        if isinstance(ball, list):
            if not _inside(item, iter(ball)):
                return False
        elif not (isinstance(item, (int, float)) and not isinstance(item, bool) and ball.contains(arb(item))):
            return False
    return True


def _rounded(value: arb, *sizes: arb | float, share: float) -> arb:
    """The ball, widened by ``share`` of the sizes that its rounding goes with."""
    size = sum((abs(arb(x)) for x in sizes), arb(0))
    return value + arb(0, (size * share).upper())


def _prior(target: Target) -> list[arb]:
    (a, b, *_), (_, d, *_) = target.covariance[:2]
    noise = arb(target.process_std) ** 2
    return [
        _rounded(a + noise, a, noise, share=OF_ENTRIES),
        arb(b),
        _rounded(d + noise, d, noise, share=OF_ENTRIES),
    ]


def _moved(place: tuple[float, float], step: arb, angle: arb) -> Point:
    x, y = place
    return (
        _rounded(x + step * angle.cos(), x, step, share=OF_POSITIONS),
        _rounded(y + step * angle.sin(), y, step, share=OF_POSITIONS),
    )


def _information(scenario: Scenario, robot: Robot) -> Iterator[list[list[arb]]]:
    """Enclosures of one robot's rows: (controls, M, 3)."""
    period = arb(scenario.sampling_period)
    aims = []
    for target in scenario.targets:
        turn = period * target.turn_rate
        angle = _rounded(target.heading + turn, target.heading, turn, share=OF_POSITIONS)
        aims.append(_moved((target.x, target.y), period * target.speed, angle))
    for speed, turn_rate in robot.controls:
        tick()
        here = _moved((robot.x, robot.y), period * speed, arb(robot.heading))
        turn = period * turn_rate
        heading = _rounded(robot.heading + turn, robot.heading, turn, 4.0, share=OF_POSITIONS)
        sensor = robot.sensor or scenario.sensor
        assert isinstance(sensor, Sensor)
        yield [_entries(sensor, here, heading, aim) for aim in aims]


def _entries(sensor: Sensor, here: Point, heading: arb, aim: Point) -> list[arb]:
    """Enclose the lower triangle of ``H^T R^{-1} H``; of what may be in or out of reach, both."""
    dx, dy = (_rounded(a - b, a, b, share=2.0**-52) for a, b in zip(aim, here, strict=True))
    squared = dx * dx + dy * dy
    distance = squared.sqrt()
    angle = _wrapped(arb.atan2(dy, dx) - heading)
    of_range = sensor.range_noise + sensor.range_noise_slope * distance
    of_bearing = sensor.bearing_noise + sensor.bearing_noise_slope * angle
    if sensor.law == "std":
        of_range, of_bearing = of_range**2, of_bearing**2
    terms = [
        (u * v / squared / of_range, p * q / squared**2 / of_bearing)
        for u, v, p, q in ((dx, dx, dy, dy), (dx, dy, dy, -dx), (dy, dy, dx, dx))
    ]
    full = [_rounded(a + b, a, b, share=OF_ENTRIES) for a, b in terms]
    seen = _reaches(sensor, distance, angle)
    return full if seen else [arb(0) if seen is False else ball.union(arb(0)) for ball in full]


def _reaches(sensor: Sensor, distance: arb, angle: arb) -> bool | None:
    """Decide whether the target is in reach; ``None`` if rounding decides that."""
    limits = []
    if sensor.max_range is not None:
        limits.append((_rounded(distance, distance, share=OF_POSITIONS), arb(sensor.max_range)))
    if sensor.field_of_view is not None:
        limits.append((_rounded(angle, angle, share=OF_POSITIONS), arb(sensor.field_of_view) / 2))
    if any(value > limit for value, limit in limits):
        return False
    return True if all(value <= limit for value, limit in limits) else None


def _wrapped(angle: arb) -> arb:
    """The size of an angle in ``[0, pi]``: the distance to the nearest multiple of the whole turn."""
    turns = (angle.mid() / (2 * arb.pi())).mid()
    nearest = (turns + 0.5).floor().mid()
    rest = angle - 2 * arb.pi() * nearest
    size = abs(rest)
    return arb.min(size, 2 * arb.pi() - size)
