"""Colours of one figure stay apart for everyone, and what they say is said again by shape."""

from itertools import combinations

import pytest

from ratt_opt.report import palette
from tests.report.colour_vision import VISIONS, distance

ON_A_MAP = (palette.SURVIVING, palette.LOST, palette.BLINDED, palette.TARGET)
OF_PLANNERS = tuple(look.colour for look in palette.PLANNERS.values())
OF_VERDICTS = tuple(look.colour for look in palette.VERDICTS.values())


@pytest.mark.parametrize("vision", VISIONS)
@pytest.mark.parametrize("colours", [ON_A_MAP, OF_PLANNERS, OF_VERDICTS], ids=["map", "planners", "verdicts"])
def test_colours_stay_apart(colours, vision):
    least = 10 if vision == "grey" else 20  # steps of lightness of 100; about nine times a just noticeable difference
    assert min(distance(a, b, vision) for a, b in combinations(colours, 2)) >= least


def test_the_simulation_knows_what_is_confused():
    """Red and green of equal lightness: far apart to most, close to people without one kind of cone."""
    assert distance("#c1584f", "#84803a", "normal") > 40
    assert distance("#c1584f", "#84803a", "deuteranopia") < 20
    assert distance("#ffffff", "#000000", "grey") == pytest.approx(100, abs=0.1)


@pytest.mark.parametrize("looks", [palette.PLANNERS, palette.VERDICTS], ids=["planners", "verdicts"])
def test_they_differ_without_colour(looks):
    shapes = looks.values()
    assert len({look.marker for look in shapes}) == len({look.hatch for look in shapes}) == len(looks)
