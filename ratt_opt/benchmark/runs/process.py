"""A foreign command under a limit: its lines as they come, and the end of its whole group of processes.

The command runs in a session of its own. At the limit and a grace its group is killed; so is what the command leaves
behind when it ends, and (on Linux) what has left the group, which is known by a mark in its environment.
"""

from __future__ import annotations

import os
import secrets
import signal
import subprocess
import sys
import threading
import time
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from queue import Empty, Queue
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Sequence

__all__ = ["Limits", "Line", "Run", "run_command"]

MARK = "RATT_OPT_BENCH_RUN"


@dataclass(frozen=True, slots=True, kw_only=True)
class Limits:
    """Limits of one run: the ``seconds`` it is told, the ``grace`` [s] until it is killed, ``most_bytes`` it prints.

    ``poll`` : seconds between two looks at the clock; fewer cost the solver's machine time.
    """

    seconds: float
    grace: float = 2.0
    most_bytes: int = 16 * 2**20
    poll: float = 0.05


@dataclass(frozen=True, slots=True)
class Line:
    """One line of the output and when it came [s after the start]."""

    at: float
    text: str


@dataclass(frozen=True, slots=True, kw_only=True)
class Run:
    """A command that has ended.

    ``exit_code`` : ``None`` if it was killed, or could not be started; ``killed`` : why it was killed, or nothing;
    ``left_behind`` : processes of it were still alive when it ended; ``torn`` : its last line has no end;
    ``processor`` : seconds of the processor of it and of all processes that it waited for
    """

    lines: tuple[Line, ...]
    errors: str
    exit_code: int | None
    killed: str
    left_behind: bool
    torn: bool
    seconds: float
    processor: float


def run_command(words: Sequence[str], folder: Path, limits: Limits) -> Run:
    """Run a command in ``folder`` until it ends or is killed. An interrupt kills it, too."""
    mark, before = secrets.token_hex(8), _children_seconds()
    environment = {**os.environ, MARK: mark, "OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1"}
    began = time.monotonic()
    with (folder / "errors.txt").open("w+b") as errors:
        try:
            process = subprocess.Popen(
                words,
                stdin=subprocess.DEVNULL,
                stdout=subprocess.PIPE,
                stderr=errors,
                cwd=folder,
                env=environment,
                start_new_session=True,
            )
        except OSError as error:
            return Run(
                lines=(),
                errors=f"cannot be started: {error.strerror}",
                exit_code=None,
                killed="",
                left_behind=False,
                torn=False,
                seconds=0.0,
                processor=0.0,
            )
        try:
            lines, torn, killed = _read(process, began, limits)
        finally:
            left_behind = _end(process, mark)
        errors.seek(0)
        text = errors.read(2000).decode("utf-8", "replace")
    return Run(
        lines=lines,
        errors=text,
        exit_code=None if killed else process.returncode,
        killed=killed,
        left_behind=left_behind and not killed,
        torn=torn,
        seconds=time.monotonic() - began,
        processor=_children_seconds() - before,
    )


def _read(process: subprocess.Popen[bytes], began: float, limits: Limits) -> tuple[tuple[Line, ...], bool, str]:
    """Lines until the command ends or a limit is met; whether the last one is torn; why it is to be killed."""
    chunks: Queue[tuple[float, bytes]] = Queue()
    threading.Thread(target=_pump, args=(process, began, chunks), daemon=True).start()
    lines: list[Line] = []
    rest, size, killed = b"", 0, ""
    while True:
        if time.monotonic() - began > limits.seconds + limits.grace:
            killed = f"killed {limits.grace:g} s after its {limits.seconds:g} s"
            break
        with suppress(Empty):
            at, chunk = chunks.get(timeout=limits.poll)
            if not chunk:
                break
            size += len(chunk)
            *whole, rest = (rest + chunk).split(b"\n")
            lines += [Line(at, text.decode("utf-8", "replace")) for text in whole]
            if size > limits.most_bytes:
                killed = f"killed as it printed more than {limits.most_bytes} bytes"
                break
            continue
        if process.poll() is not None and chunks.empty():
            break
    if not killed:
        _wait(process, began + limits.seconds + limits.grace, limits.poll / 5)
        if process.poll() is None:
            killed = f"killed {limits.grace:g} s after its {limits.seconds:g} s"
    if rest:
        lines.append(Line(time.monotonic() - began, rest.decode("utf-8", "replace")))
    return tuple(lines), bool(rest), killed


def _pump(process: subprocess.Popen[bytes], began: float, chunks: Queue[tuple[float, bytes]]) -> None:
    """Hand on what the command prints; an empty piece says that its output is closed."""
    assert process.stdout is not None
    while True:
        try:
            chunk = os.read(process.stdout.fileno(), 65536)
        except (OSError, ValueError):
            chunk = b""
        chunks.put((time.monotonic() - began, chunk))
        if not chunk:
            return


def _wait(process: subprocess.Popen[bytes], until: float, pause: float) -> None:
    while process.poll() is None and time.monotonic() < until:
        time.sleep(pause)


def _end(process: subprocess.Popen[bytes], mark: str) -> bool:
    """Kill the rest of a run; tell whether processes were left when the command had ended by itself."""
    alive = process.poll() is not None and _signal_group(process.pid, 0)
    _signal_group(process.pid, signal.SIGKILL)
    with suppress(ProcessLookupError):
        process.kill()
    process.wait()
    for pid in _marked(mark):
        alive = True
        with suppress(ProcessLookupError, PermissionError):
            os.kill(pid, signal.SIGKILL)
    if process.stdout is not None:
        with suppress(OSError):
            process.stdout.close()
    return alive


def _signal_group(group: int, number: int) -> bool:
    """Send a signal to a group; tell whether there is one. Elsewhere than on POSIX there are no groups."""
    if sys.platform == "win32":
        return False
    try:
        os.killpg(group, number)
    except (ProcessLookupError, PermissionError):
        return False
    return True


def _marked(mark: str) -> list[int]:
    """Processes whose environment has the mark, if the system shows that."""
    found = []
    word = f"{MARK}={mark}".encode()
    for entry in Path("/proc").glob("[0-9]*"):
        with suppress(OSError):
            if word in (entry / "environ").read_bytes().split(b"\0"):
                found.append(int(entry.name))
    return found


def _children_seconds() -> float:
    """Seconds of the processor of all children that have ended."""
    times = os.times()
    return times.children_user + times.children_system
