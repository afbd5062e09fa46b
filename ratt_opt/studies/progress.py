"""Progress with the time left: a bar on a terminal, plain lines when piped."""

from __future__ import annotations

import sys
import time
from contextlib import contextmanager
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

__all__ = ["Progress"]


class Progress:
    """Reports to standard error, so that standard output stays for results."""

    @contextmanager
    def task(self, name: str, *, total: int, done: int) -> Iterator[Callable[[], None]]:
        """Report on ``total`` trials of which ``done`` were finished before; yields what to call after each."""
        reporter = _bar if sys.stderr.isatty() else _lines
        with reporter(name, total, done) as advance:
            yield advance


@contextmanager
def _bar(name: str, total: int, done: int) -> Iterator[Callable[[], None]]:
    from rich.console import Console
    from rich.progress import BarColumn, MofNCompleteColumn, TextColumn, TimeElapsedColumn, TimeRemainingColumn
    from rich.progress import Progress as Bar

    columns = (
        TextColumn("{task.description}"),
        BarColumn(),
        MofNCompleteColumn(),
        TimeElapsedColumn(),
        TextColumn("left"),
        TimeRemainingColumn(),
    )
    with Bar(*columns, console=Console(stderr=True)) as bar:
        task = bar.add_task(name, total=total, completed=done)
        yield lambda: bar.advance(task)


@contextmanager
def _lines(name: str, total: int, done: int, apart: float = 10.0) -> Iterator[Callable[[], None]]:
    """Print plain lines, at least ``apart`` seconds from each other."""
    began = said = time.monotonic()
    finished = done

    def say(text: str) -> None:
        print(f"{name}: {finished}/{total} trials{text}", file=sys.stderr, flush=True)

    def advance() -> None:
        nonlocal finished, said
        finished += 1
        now = time.monotonic()
        if now - said >= apart and finished < total:
            said = now
            left = (now - began) / (finished - done) * (total - finished)
            say(f", about {left:.0f} s left")

    if done:
        say(" were already there")
    yield advance
    say(f", {time.monotonic() - began:.1f} s")
