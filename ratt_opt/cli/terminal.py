"""Output: results to standard output, errors to standard error; what users wrote is text, never markup."""

from __future__ import annotations

import json
import sys
from contextlib import contextmanager, suppress
from typing import TYPE_CHECKING

from ratt_opt.errors import printable

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

    from rich.table import Table

__all__ = [
    "OutputError",
    "WorkInterrupted",
    "abandon_output",
    "encode_anything",
    "fail",
    "flush",
    "note",
    "print_json",
    "print_lines",
    "print_tables",
    "written",
]


class WorkInterrupted(Exception):  # noqa: N818  (not an error: what is finished is kept)
    """The user ended a command that kept what was finished; the text says what."""


class OutputError(Exception):
    """Standard output is closed, full or gone; the text says which."""


def encode_anything() -> None:
    """Show what the locale cannot encode by its escape, instead of failing in the middle of a line."""
    for stream in (sys.stdout, sys.stderr):
        if hasattr(stream, "reconfigure"):
            stream.reconfigure(errors="backslashreplace")


def fail(text: str, code: int) -> int:
    """Print an error as one line and return its exit code, also if standard error is closed."""
    _complain(f"error: {printable(text)}")
    return code


def note(text: str) -> None:
    """Print a note as one line to standard error."""
    _complain(f"note: {printable(text)}")


def print_json(document: object) -> None:
    """Print strict JSON."""
    print_lines([json.dumps(document, indent=1, allow_nan=False)])


def print_lines(lines: Iterable[str]) -> None:
    """Print lines to standard output; raises :class:`OutputError` if they cannot arrive."""
    with _delivered():
        print("\n".join(lines))


def written(files: Iterable[object]) -> str:
    """The line that names the files that a command wrote."""
    return "written: " + ", ".join(printable(str(file)) for file in files)


def print_tables(tables: Iterable[Table], lines: Iterable[str] = (), *, latex: bool = False) -> None:
    """Print tables, then lines; piped, tables are plain text as wide as their content needs.

    ``latex`` : as LaTeX instead, the lines as its comments
    """
    if latex:
        from ratt_opt.report.latex import latex_of

        print_lines([*map(latex_of, tables), *(f"% {line}" for line in lines)])
        return
    from rich.console import Console

    with _delivered():
        width, no_color = (None, None) if sys.stdout.isatty() else (160, True)
        console = Console(width=width, no_color=no_color, markup=False, emoji=False)
        # Terminals of fewer columns break lines themselves; a table would cut numbers short.
        console.width = max(console.width, 80)
        for table in tables:
            console.print(table)
        for line in lines:
            print(line)


def flush() -> None:
    """Send on what was printed; raises :class:`OutputError` if it cannot arrive."""
    with _delivered():
        pass


def abandon_output() -> None:
    """Send on what was printed if that is still possible; the program ends without another try."""
    for stream in (sys.stdout, sys.stderr):
        if stream is not None:
            with suppress(OSError, ValueError):
                stream.flush()


@contextmanager
def _delivered() -> Iterator[None]:
    """Flush what is printed inside; a stream that does not take it is not written to again."""
    if sys.stdout is None:
        raise OutputError("standard output is closed")
    try:
        yield
        sys.stdout.flush()
    except (OSError, ValueError) as error:
        if isinstance(error, ValueError) and "closed file" not in str(error):
            raise
        sys.stdout = None  # the interpreter would flush it once more, and complain
        reason = error.strerror if isinstance(error, OSError) else "it is closed"
        raise OutputError(f"standard output does not take the result ({reason})") from None


def _complain(line: str) -> None:
    # print(file=None) would print to standard output.
    if sys.stderr is not None:
        with suppress(OSError, ValueError):
            print(line, file=sys.stderr, flush=True)
