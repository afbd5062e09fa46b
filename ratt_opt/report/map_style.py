"""Sizes and limits of a map on paper: which robots and links are drawn one by one, and where words stand."""

from __future__ import annotations

from dataclasses import dataclass, fields

from ratt_opt.errors import InputError

__all__ = ["MapStyle"]


@dataclass(frozen=True, slots=True, kw_only=True)
class MapStyle:
    """Sizes and limits of a map on paper.

    ``many_robots`` : from this number only the best group and attacked robots are drawn one by one, the rest as a
    density; more of it shows each robot, and words cover each other
    ``drawn_networks``, ``links_each`` : networks of at most that many robots and links a robot are drawn whole: they
    are read by all of their links
    ``many_links`` : of a kind; above it they are drawn the fainter the more there are, so that they are not one blot
    ``nearest_edge`` : share of the map's diagonal; a field of view without a reach is drawn over it at least
    ``mark`` : half the width of a robot or target [points], which no word should cover
    ``pointer`` : width of the line from a word to a place that it does not touch [points]
    """

    many_robots: int = 20
    drawn_networks: int = 60
    links_each: int = 4
    many_links: int = 60
    nearest_edge: float = 0.12
    mark: float = 7.0
    pointer: float = 0.6

    def __post_init__(self) -> None:
        """Check that sizes can be drawn. ``InputError`` : a number is negative or not a number."""
        for one in fields(self):
            if not (value := getattr(self, one.name)) >= 0:
                raise InputError(f"style.{one.name}", "must be at least 0", value)
