"""Exit codes of ``ratt-opt`` besides 0: ``docs/commands.md`` says what each means."""

from __future__ import annotations

from enum import IntEnum

__all__ = ["ExitCode"]


class ExitCode(IntEnum):
    """Exit codes as programs rely on them; the last three are those of ``sysexits.h`` and of shells."""

    REFUTED = 1
    BAD_INPUT = 2
    UPPER_ONLY = 3
    UNDECIDED = 4
    FAULT = 70
    NO_OUTPUT = 74
    INTERRUPTED = 130
