"""Steps of the main job: what is told of them while they run, and how long each takes."""

from __future__ import annotations

from contextlib import contextmanager
from dataclasses import dataclass, field
from time import monotonic
from typing import TYPE_CHECKING

from ratt_opt._rounding import down, up
from ratt_opt.main_job.params import SHARES
from ratt_opt.running.progress import Step

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

__all__ = ["Steps"]


@dataclass(slots=True)
class Steps:
    """``tell`` : called with one line of text, or ``None``; ``seconds`` : wall time of each step that has ended."""

    tell: Callable[[str], None] | None
    shown: Step = field(default_factory=lambda: Step("planning"))
    seconds: dict[str, float] = field(default_factory=dict)
    _last_line: float = -SHARES.lines_apart

    @contextmanager
    def __call__(self, step: str) -> Iterator[None]:
        """Tell that a step begins, and keep how long it takes."""
        self._say(step)
        began = monotonic()
        with Step(step) as self.shown:
            yield
        self.seconds[step] = monotonic() - began

    def search_line(self, nodes: int, lower: float, upper: float) -> None:
        """Tell where a search stands, unless that was told just now."""
        if monotonic() - self._last_line >= SHARES.lines_apart:
            self._last_line = monotonic()
            line = f"{nodes} nodes: between {down(lower, 8)} and {up(upper, 8)}"
            self.shown.say(line)
            self._say(f"  {line}")

    def _say(self, line: str) -> None:
        if self.tell is not None:
            self.tell(line)
