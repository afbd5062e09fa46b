"""Frames of a mission as plain data, for the animation and the player alike."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from ratt_opt.report.description import views_of
from ratt_opt.report.ellipses import ellipse_of

if TYPE_CHECKING:
    from ratt_opt.missions.result import FlownMission, MissionStep
    from ratt_opt.report.description import FieldOfView

__all__ = ["MOST_LINKS", "frames_of", "limits"]

MOST_LINKS = 80
"""Links drawn of a kind in one picture; of more, the first ones by their robots' numbers."""


def frames_of(mission: FlownMission, unlimited: float = 0.15) -> list[dict[str, Any]]:
    """One picture a step: robots with roles, links left and cut, targets with what the team believes of them.

    ``unlimited`` : radius of a field of view without a limit of range, as a share of the diagonal of all places.
    """
    views = views_of(mission.scenario)
    limited = any(view.angle is not None or view.reach is not None for view in views)
    endless = unlimited * _across(mission)
    fields = [_field(view, endless) for view in views] if limited else []
    return [_frame(number, step) | {"fields": fields} for number, step in enumerate(mission.steps, start=1)]


def _across(mission: FlownMission) -> float:
    """Diagonal of everywhere that robots and targets have been [m]."""
    places = np.concatenate([part[:, :2] for step in mission.steps for part in (step.poses, step.truth)])
    return float(np.linalg.norm(np.ptp(places, axis=0)))


def _field(view: FieldOfView, endless: float) -> list[float]:
    """Full angle [rad] of a field of view, and the radius at which it is drawn [m]."""
    return [2 * np.pi if view.angle is None else view.angle, endless if view.reach is None else view.reach]


def limits(frames: list[dict[str, Any]]) -> tuple[float, float, float, float]:
    """Lowest x, highest x, lowest y, highest y of everything shown, with a margin."""
    places = np.array([p[:2] for f in frames for key in ("robots", "targets", "estimates") for p in f[key]])
    low, high = places.min(axis=0), places.max(axis=0)
    across = float(np.linalg.norm(high - low))
    for frame in frames:
        for (x, y, _), (_, radius) in zip(frame["robots"], frame.get("fields", ()), strict=False):
            if radius <= across:  # the picture holds it whole; wider ones would shrink all else
                low, high = np.minimum(low, [x - radius, y - radius]), np.maximum(high, [x + radius, y + radius])
    margin = 0.06 * max(float((high - low).max()), 1.0)
    return float(low[0] - margin), float(high[0] + margin), float(low[1] - margin), float(high[1] + margin)


def _frame(number: int, step: MissionStep) -> dict[str, Any]:
    ellipses = [ellipse_of(covariance) for covariance in step.team.belief.position_covariance]
    return {
        "step": number,
        "robots": step.poses[:, :3].tolist(),
        "roles": [step.role(i) for i in range(len(step.poses))],
        "links": [list(link) for link in sorted(step.links)[:MOST_LINKS]],
        "cut": [list(link) for link in sorted(step.attack.links)[:MOST_LINKS]],
        "n_cut": len(step.attack.links),
        "targets": step.truth[:, :2].tolist(),
        "estimates": step.team.belief.positions.tolist(),
        "ellipses": ellipses,
    }
