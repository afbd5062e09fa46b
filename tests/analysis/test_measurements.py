"""Pages show the measured values of the file; a value that is off is noticed."""

import re

import pytest

from analysis import measurements
from analysis.measurements import AGAIN, Value, filled, places, values

KNOWN = values()


@pytest.mark.parametrize(("page", "template"), places(), ids=lambda given: getattr(given, "name", "")[:40])
def test_pages_show_what_was_measured(page, template) -> None:
    text = page.read_text(encoding="utf-8")
    assert filled(text, template, KNOWN) == text


def test_every_value_is_shown_somewhere_and_can_be_measured() -> None:
    shown = {name for _, template in places() for name in measurements.SLOT.findall(template)}
    assert shown == set(KNOWN)
    for value in KNOWN.values():
        assert value.command
        assert not value.again or (value.again in AGAIN and value.factor > 1)


def value(low: float, high: float, unit: str) -> Value:
    return Value(name="x", low=low, high=high, text="x", unit=unit, command="x", again="x", factor=2.0)


@pytest.mark.parametrize(
    ("unit", "found", "is_off"),
    [("s", 5, False), ("s", 21, True), ("s", 0.1, False), ("kB", 19, False), ("kB", 21, True), ("kB", 4, True)],
)
def test_seconds_may_be_fewer_and_other_values_neither_more_nor_less(unit: str, found: float, is_off: bool) -> None:
    assert value(10, 10, unit).is_off(found, found) is is_off


def test_a_place_is_filled_or_named() -> None:
    known = {"x": Value(name="x", low=1200, high=3, text="1,200 to 3", unit="", command="", again="", factor=1)}
    assert filled("a: 7.5 m.", "a: {x} m.", known) == "a: 1,200 to 3 m."
    assert filled("a: 7 to 8 m.", "a: {x} m.", known) == "a: 1,200 to 3 m."
    with pytest.raises(ValueError, match="0 places"):
        filled("b: 7 m.", "a: {x} m.", known)


def test_every_section_of_measurements_has_a_command_and_a_date() -> None:
    text = (measurements.ROOT / "docs" / "researchers" / "benchmarks.md").read_text(encoding="utf-8")
    for section in text.split("\n## ")[1:]:
        title = section.partition("\n")[0]
        assert "`" in section, title
        assert re.search(r"^Figures of .*20\d\d-\d\d-\d\d \([0-9a-f]{8}", section, re.MULTILINE), title
