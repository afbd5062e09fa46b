"""A mission as users have it: what was flown, and how it is saved and drawn."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ratt_opt.missions.result import FlownMission

if TYPE_CHECKING:
    from pathlib import Path

__all__ = ["Mission"]


class Mission(FlownMission):
    """A finished mission; equal missions are equal to the bit.

    ``start`` : the poses (N, 3) it began at; ``settings`` : its arguments by name, for people; ``decisions`` : the
    elements and attack of every step, from which it can be replayed.
    """

    __slots__ = ()

    def save(self, directory: str | Path) -> list[Path]:
        """Write ``mission.json``, ``mission.csv``, ``tracks.csv``, figures, the animation and the player.

        InputError : the folder cannot be written.
        """
        from ratt_opt.missions.drawing.write import write_mission  # draws

        return write_mission(self, directory)

    def animate(self, path: str | Path) -> Path:
        """Write the animation: ``.gif``, ``.html`` for a player that needs nothing else, ``.mcap`` for log viewers,
        ``.rrd`` for the viewer Rerun.

        InputError : another ending, a library that is not installed, or the file cannot be written.
        """
        from ratt_opt.missions.drawing.write import write_animation  # draws

        return write_animation(self, path)
