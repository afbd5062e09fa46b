"""One tracker for each group that an attack leaves, so that groups are really apart."""

from __future__ import annotations

from copy import deepcopy
from typing import TYPE_CHECKING, Any

from stonesoup.base import Base, Property

if TYPE_CHECKING:
    from collections.abc import Iterable
    from datetime import datetime

    from ratt_opt.interop.stonesoup.attacker import Aftermath, SurvivingGroup

__all__ = ["GroupTrackers"]


class GroupTrackers(Base):
    """A copy of the user's tracker for each surviving group, fed with that group's detections alone.

    Initiator, deleter, data associator and updater are those of the tracker given. The detections of each sensor are
    given to it one after another, as Stone Soup's trackers expect at most one detection of a target at a time.
    """

    tracker: Any = Property(
        doc="A tracker with update_tracker(time, detections), as MultiTargetTracker(detector=None)."
    )
    reconnected: bool = Property(
        default=True,
        doc="Whether all can talk again between two attacks and go on from the best group's tracks; otherwise each "
        "group goes on from the best tracks that one of its members has.",
    )

    def __init__(self, *args: Any, **kwargs: Any) -> None:
        super().__init__(*args, **kwargs)
        self.groups: list[tuple[SurvivingGroup, Any]] = []
        """Each group of the last attack with its tracker, the best first."""

    @property
    def tracks(self) -> set[Any]:
        """The best group's tracks."""
        return set(self.groups[0][1].tracks if self.groups else self.tracker.tracks)

    def update(self, aftermath: Aftermath, truths: Iterable[Any], timestamp: datetime) -> set[Any]:
        """Let each group measure ``truths`` and update its own tracker; return the best group's tracks."""
        truths = list(truths)
        before = self.groups
        self.groups = []
        for group in aftermath.groups:
            tracker = _fork(self._held(group, before))
            seen = [detections for detections in group.detections(truths) if detections]
            for detections in seen or [set()]:
                tracker.update_tracker(timestamp, detections)
            self.groups.append((group, tracker))
        return self.tracks

    def _held(self, group: SurvivingGroup, before: list[tuple[SurvivingGroup, Any]]) -> Any:
        """The tracker that this group goes on from; earlier groups are ordered by how good they are."""
        if not before:
            return self.tracker
        members = {id(member) for member in group.members}
        own = [tracker for earlier, tracker in before if members & {id(member) for member in earlier.members}]
        return before[0][1] if self.reconnected or not own else own[0]


def _fork(tracker: Any) -> Any:
    """A copy with tracks of its own. Their states so far are shared: nobody changes them."""
    return deepcopy(tracker, {id(state): state for track in tracker.tracks for state in track.states})
