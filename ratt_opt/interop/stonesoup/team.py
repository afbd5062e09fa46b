"""What managers of a team have in common: platforms and sensors in an order that lasts."""

from __future__ import annotations

from typing import Any

from ordered_set import OrderedSet
from stonesoup.sensormanager.base import SensorManager

from ratt_opt.interop.stonesoup.nodes import Node, in_order, nodes_of

__all__ = ["TeamManager"]


class TeamManager(SensorManager):
    """A manager whose platforms and sensors keep their order: a list's, or, for a set, that of their attributes."""

    def __init__(self, *args: Any, **kwargs: Any) -> None:
        super().__init__(*args, **kwargs)
        self.platforms: Any = OrderedSet(in_order(self.platforms))
        self._property_sensors: Any = OrderedSet(in_order(self._property_sensors))

    @property
    def nodes(self) -> tuple[Node, ...]:
        """Who can be blinded, in order: platforms with their sensors, then sensors that stand alone."""
        return nodes_of(self.platforms, self.sensors)
