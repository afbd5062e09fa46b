"""Write a mission to a folder."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from ratt_opt._files import output_directory, write_atomically, write_json, write_together
from ratt_opt.errors import InputError
from ratt_opt.missions.drawing.animation import save_gif
from ratt_opt.missions.drawing.figures import mission_figure
from ratt_opt.missions.drawing.log import save_log
from ratt_opt.missions.drawing.player import player_page
from ratt_opt.missions.drawing.tables import MISSION_COLUMNS, TRACK_COLUMNS, mission_rows, track_rows
from ratt_opt.report.csv_file import write_csv
from ratt_opt.report.figure import save_figure

if TYPE_CHECKING:
    from collections.abc import Sequence

    from ratt_opt.missions.result import FlownMission

__all__ = ["FILES", "write_animation", "write_mission"]

FILES = ("mission.json", "mission.csv", "tracks.csv", "mission.png", "mission.svg", "player.html", "mission.gif")


def write_mission(mission: FlownMission, folder: str | Path, others: Sequence[FlownMission] = ()) -> list[Path]:
    """Write all of ``FILES`` and return them; the figures are of the mission and ``others`` with other seeds.

    Raises
    ------
    InputError : the folder cannot be written.
    """
    out = output_directory(folder)
    figure = mission_figure([mission, *others])
    writers = (
        lambda file: write_json(file, mission.to_dict()),
        lambda file: write_csv(file, MISSION_COLUMNS, mission_rows(mission)),
        lambda file: write_csv(file, TRACK_COLUMNS, track_rows(mission)),
        lambda file: save_figure(figure, file),
        lambda file: save_figure(figure, file),
        lambda file: file.write_text(player_page(mission), encoding="utf-8"),
        lambda file: save_gif(mission, file),
    )
    return write_together(out, dict(zip(FILES, writers, strict=True)))


def write_animation(mission: FlownMission, path: str | Path) -> Path:
    """Write the animation (``.gif``), the player (``.html``) or a log for viewers (``.mcap``, the extra ``viewers``).

    Raises
    ------
    InputError : another ending, a library that is not installed, or the file cannot be written.
    """
    target = Path(path)
    if target.suffix == ".gif":
        return write_atomically(target, lambda file: save_gif(mission, file))
    if target.suffix == ".html":
        return write_atomically(target, lambda file: file.write_text(player_page(mission), encoding="utf-8"))
    if target.suffix == ".mcap":
        return write_atomically(target, lambda file: save_log(mission, file))
    raise InputError("path", "must end in .gif, .html or .mcap", target)
