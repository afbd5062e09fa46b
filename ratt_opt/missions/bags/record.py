"""Result of replaying a bag: every step as it was planned."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from ratt_opt._validation import FloatArray
    from ratt_opt.missions.belief import Belief
    from ratt_opt.missions.live.packets import TrackerPlan
    from ratt_opt.scenario.model import Scenario

__all__ = ["BagStep", "ReplayedBag"]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class BagStep:
    """One step at ``time`` [s of the bag]: ``poses`` (N, p), the ``plan`` and its ``controls`` (N, c).

    ``targets`` : numbers of those there are, in the order of ``belief``; ``measured`` : how many detections arrived.
    ``links`` : pairs of robots that can communicate at these poses.
    """

    time: float
    poses: FloatArray
    plan: TrackerPlan
    controls: FloatArray
    targets: tuple[int, ...]
    belief: Belief
    measured: int
    links: frozenset[tuple[int, int]] = frozenset()


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class ReplayedBag:
    """A replayed bag: its team, every step, and the bag's object names by target."""

    scenario: Scenario
    steps: tuple[BagStep, ...]
    objects: dict[int, str]
