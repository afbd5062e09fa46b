"""Where text goes: results to standard output, progress to standard error."""

from __future__ import annotations

import json
import sys
from contextlib import contextmanager
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator

    from rich.console import RenderableType

__all__ = ["fail", "print_json", "print_tables", "progress"]


def fail(text: str, code: int) -> int:
    """Print an error as one line and return its exit code."""
    print(f"error: {' '.join(text.split())}", file=sys.stderr)
    return code


def print_json(document: object) -> None:
    """Print strict JSON."""
    print(json.dumps(document, indent=1, allow_nan=False))


def print_tables(tables: Iterable[RenderableType]) -> None:
    """Print tables; piped, they are plain text as wide as their content needs."""
    from rich.console import Console

    console = Console(soft_wrap=False) if sys.stdout.isatty() else Console(width=160, no_color=True)
    for table in tables:
        console.print(table)


@contextmanager
def progress() -> Iterator[Callable[[str], None]]:
    """A spinner with the current line on a terminal, plain lines elsewhere."""
    from rich.console import Console

    if not sys.stderr.isatty():
        yield lambda text: print(text, file=sys.stderr, flush=True)
        return
    with Console(stderr=True).status("") as status:
        yield lambda text: status.update(text.strip())
