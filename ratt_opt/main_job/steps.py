"""What the main job tells while it runs, and how long each of its steps took."""

from __future__ import annotations

from contextlib import contextmanager
from dataclasses import dataclass, field
from time import monotonic
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

__all__ = ["Steps"]

SECONDS_BETWEEN_LINES = 1.0
"""A search tells where it stands at most so often: about as fast as a person reads a line."""


@dataclass(slots=True)
class Steps:
    """``tell`` : called with one line of text, or ``None``; ``seconds`` : wall time of each step that has ended."""

    tell: Callable[[str], None] | None
    seconds: dict[str, float] = field(default_factory=dict)
    _last_line: float = -SECONDS_BETWEEN_LINES

    @contextmanager
    def __call__(self, step: str) -> Iterator[None]:
        """Tell that a step begins, and keep how long it takes."""
        self._say(step)
        began = monotonic()
        yield
        self.seconds[step] = monotonic() - began

    def search_line(self, nodes: int, lower: float, upper: float) -> None:
        """Tell where a search stands, unless that was told just now."""
        if monotonic() - self._last_line >= SECONDS_BETWEEN_LINES:
            self._last_line = monotonic()
            self._say(f"  {nodes} nodes: between {lower:.8g} and {upper:.8g}")

    def _say(self, line: str) -> None:
        if self.tell is not None:
            self.tell(line)
