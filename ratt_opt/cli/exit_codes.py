"""Exit codes of ``ratt-opt`` besides 0: ``docs/commands.md`` says what each means."""

from __future__ import annotations

__all__ = ["BAD_INPUT", "FAULT", "INTERRUPTED", "NO_OUTPUT", "REFUTED", "UNDECIDED", "UPPER_ONLY"]

REFUTED = 1
BAD_INPUT = 2
UPPER_ONLY = 3
UNDECIDED = 4
FAULT = 70
NO_OUTPUT = 74
INTERRUPTED = 130
