"""A page that plays the mission: self-contained, nothing is fetched."""

from __future__ import annotations

import json
from html import escape
from importlib import resources
from typing import TYPE_CHECKING

from ratt_opt.missions.drawing.frames import MOST_LINKS, frames_of, limits
from ratt_opt.report.palette import BLINDED, CUT, INK, LOST, SURVIVING, TARGET

if TYPE_CHECKING:
    from ratt_opt.missions.result import FlownMission

__all__ = ["player_page"]

COLOURS = {
    "best group": SURVIVING,
    "cut off": LOST,
    "blinded": BLINDED,
    "cut": CUT,
    "link": LOST,
    "target": TARGET,
    "ink": INK,
    "grid": "#eeeeee",
}
STYLE = "body{font-family:sans-serif;max-width:46rem;margin:1rem auto;padding:0 .6rem}canvas{width:100%;display:block}"


def player_page(mission: FlownMission) -> str:
    """Return the page as HTML."""
    frames = frames_of(mission)
    data = {
        "frames": frames,
        "view": limits(frames),
        "rmse": mission.rmse.tolist(),
        "nees": mission.nees.tolist(),
        "colours": COLOURS,
    }
    # "</" inside a script element would end it, whatever it is part of.
    text = json.dumps(data, allow_nan=False).replace("</", "<\\/")
    script = (resources.files("ratt_opt.missions.drawing") / "player.js").read_text(encoding="utf-8")
    title = f"Mission of {mission.scenario.n_robots} robots, {mission.scenario.n_targets} targets"
    about = "; ".join(f"{name}: {value}" for name, value in mission.settings.items())
    key = "Blue circles: the team's best group; grey squares: cut off; crossed: blinded; "
    key += "pale sectors: fields of view, only the rims of wide ones; " if frames and frames[0]["fields"] else ""
    key += f"lines: links, dashed: cut ones (at most {MOST_LINKS} of a kind are drawn); "
    return (
        '<!DOCTYPE html><html lang="en"><head><meta charset="utf-8">'
        '<meta name="viewport" content="width=device-width, initial-scale=1">'
        f"<title>{escape(title)}</title><style>{STYLE}</style></head><body><h1>{escape(title)}</h1>"
        f'<p>{escape(about)}</p><canvas id="map" role="img" aria-label="Map"></canvas>'
        f'<p><button id="play">Play</button> <input id="step" type="range" min="0" max="{len(frames) - 1}" value="0" '
        f'aria-label="Step" style="width:70%"></p><p id="text" role="status"></p>'
        f"<p>{escape(key)}stars: targets; ellipses: the team's estimates, 95 %.</p>"
        f'<script type="application/json" id="mission">{text}</script><script>{script}</script></body></html>\n'
    )
