"""A running tracker in the viewer Rerun; the extra ``live``."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any, Self

from ratt_opt.missions.drawing.rerun_log import RerunLog
from ratt_opt.report.ellipses import ellipse_of

if TYPE_CHECKING:
    from types import TracebackType

    from ratt_opt.missions.live.packets import TrackerPlan
    from ratt_opt.missions.live.tracker import Tracker

__all__ = ["LiveView"]


class LiveView:
    """Pictures of a tracker as it runs: ``with LiveView() as view: ... view.show(tracker, plan)``.

    Parameters
    ----------
    path : file ``.rrd`` to write, for a viewer that opens it later; without one the viewer opens now

    Raises
    ------
    InputError : the library ``rerun-sdk`` is not installed.
    """

    def __init__(self, path: str | Path | None = None) -> None:
        self._log = RerunLog(None if path is None else Path(path))

    def show(self, tracker: Tracker, plan: TrackerPlan | None = None) -> None:
        """Show robots with their links, targets with their 95 % ellipses, and what the plan of this step skipped."""
        numbers: dict[str, float | None] = {"trace": tracker.beliefs.trace, "targets": len(tracker.targets)}
        if plan is not None:
            numbers |= {"measured": len(plan.innovations), "skipped": len(plan.skipped)}
        self._log.add(frame_of_tracker(tracker), numbers, tracker.state.time)

    def close(self) -> None:
        """Send on what was shown; a file is whole then."""
        self._log.close()

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, fault: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()


def frame_of_tracker(tracker: Tracker) -> dict[str, Any]:
    """The picture of a tracker now, without truth: see ``drawing/frames.py``."""
    state, robots = tracker.state, tracker.scenario.robots
    lost = dict(state.lost)
    roles = [
        "blinded" if i in state.attack.sensing else "cut off" if i in lost else "best group" for i in range(len(robots))
    ]
    return {
        "step": state.steps,
        "robots": state.poses[:, :3].tolist(),
        "names": [robot.name or str(i) for i, robot in enumerate(robots)],
        "roles": roles,
        "links": [list(link) for link in sorted(tracker.links)],
        "cut": [list(link) for link in sorted(state.attack.links)],
        "targets": [],
        "estimates": tracker.beliefs.positions.tolist(),
        "ellipses": [ellipse_of(covariance) for covariance in tracker.beliefs.position_covariance],
    }
