"""Frames of a mission as plain data, for the animation and the player alike."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from ratt_opt._validation import FloatArray
    from ratt_opt.missions.result import FlownMission, MissionStep

__all__ = ["MOST_LINKS", "SIGMAS", "ellipse_of", "frames_of", "limits"]

SIGMAS = 2.4477
"""Half-axes of an ellipse that holds 95 % of a two-dimensional Gaussian."""
MOST_LINKS = 80
"""Links drawn of a kind in one picture; of more, the first ones by their robots' numbers."""


def frames_of(mission: FlownMission) -> list[dict[str, Any]]:
    """One picture a step: robots with roles, links left and cut, targets with what the team believes of them."""
    return [_frame(number, step) for number, step in enumerate(mission.steps, start=1)]


def limits(frames: list[dict[str, Any]]) -> tuple[float, float, float, float]:
    """Lowest x, highest x, lowest y, highest y of everything shown, with a margin."""
    places = np.array([p[:2] for f in frames for key in ("robots", "targets", "estimates") for p in f[key]])
    low, high = places.min(axis=0), places.max(axis=0)
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


def ellipse_of(covariance: FloatArray) -> list[float]:
    """Half-axes [m] and angle [rad] of the 95 % ellipse."""
    variances, axes = np.linalg.eigh(covariance)
    long, short = SIGMAS * np.sqrt(np.clip(variances[::-1], 0.0, None))
    return [float(long), float(short), float(np.arctan2(axes[1, 1], axes[0, 1]))]
