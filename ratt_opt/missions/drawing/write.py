"""Write a mission to a folder."""

from __future__ import annotations

import warnings
from pathlib import Path
from typing import TYPE_CHECKING

from ratt_opt._files import output_directory, write_atomically, write_json, write_together
from ratt_opt.errors import InputError
from ratt_opt.missions.drawing.animation import save_gif
from ratt_opt.missions.drawing.figures import mission_figure
from ratt_opt.missions.drawing.log import save_log, save_recording
from ratt_opt.missions.drawing.player import player_page
from ratt_opt.missions.drawing.tables import mission_columns, mission_rows, track_columns, track_rows
from ratt_opt.report.csv_file import write_csv
from ratt_opt.report.figure import draw_or_remark, save_figure

if TYPE_CHECKING:
    from collections.abc import Sequence

    from ratt_opt.missions.result import FlownMission

__all__ = ["FILES", "write_animation", "write_mission"]

NUMBERS = ("mission.json", "mission.csv", "tracks.csv", "player.html")
FIGURES = ("mission.png", "mission.svg", "mission.gif")
FILES = (*NUMBERS, *FIGURES)


def write_mission(mission: FlownMission, folder: str | Path, others: Sequence[FlownMission] = ()) -> list[Path]:
    """Write all of ``FILES`` and return them; the figures are of the mission and ``others`` with other seeds.

    Figures come last. If they cannot be drawn, a warning says why, and the other files are written.

    Raises
    ------
    InputError : the folder cannot be written.
    """
    out = output_directory(folder, *FILES)
    writers = (
        lambda file: write_json(file, mission.to_dict()),
        lambda file: write_csv(file, mission_columns(mission), mission_rows(mission)),
        lambda file: write_csv(file, track_columns(mission), track_rows(mission)),
        lambda file: file.write_text(player_page(mission), encoding="utf-8"),
    )
    files = write_together(out, dict(zip(NUMBERS, writers, strict=True)), outdated=FIGURES)
    figures, remarks = draw_or_remark(lambda: _draw(mission, out, others))
    for remark in remarks:
        warnings.warn(remark, RuntimeWarning, stacklevel=3)
    return [*files, *figures]


def _draw(mission: FlownMission, out: Path, others: Sequence[FlownMission]) -> list[Path]:
    figure = mission_figure([mission, *others])
    writers = (
        lambda file: save_figure(figure, file),
        lambda file: save_figure(figure, file),
        lambda file: save_gif(mission, file),
    )
    return write_together(out, dict(zip(FIGURES, writers, strict=True)))


def write_animation(mission: FlownMission, path: str | Path) -> Path:
    """Write the animation (``.gif``), the player (``.html``), or a log for viewers.

    ``.mcap`` needs the extra ``viewers``; ``.rrd``, for Rerun, the extra ``live``.

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
    if target.suffix == ".rrd":
        return write_atomically(target, lambda file: save_recording(mission, file))
    raise InputError("path", "must end in .gif, .html, .mcap or .rrd", target)
