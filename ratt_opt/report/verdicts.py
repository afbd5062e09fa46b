"""The table with which an audit ends: each claim, what was computed, and whether the claim holds."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ratt_opt.errors import InputError

__all__ = ["HEAD", "Checked", "VerdictTable"]

HEAD = ("claim", "computed", "verdict")
HOLDS, FAILS = "holds", "does not hold"


@dataclass(frozen=True, slots=True)
class Checked:
    """A claim with what was computed for it; ``holds`` is the comparison of both, never typed by hand.

    Raises
    ------
    InputError : ``holds`` is no truth value.
    """

    claim: str
    computed: object
    holds: bool

    def __post_init__(self) -> None:
        if not isinstance(self.holds, (bool, np.bool_)):
            raise InputError("holds", "must be True or False", self.holds)

    @property
    def verdict(self) -> str:
        """``holds`` in words."""
        return HOLDS if self.holds else FAILS


class VerdictTable:
    """Claims with their verdicts, shown as a table by notebooks and as Markdown when printed."""

    def __init__(self, *rows: tuple[str, object, bool]) -> None:
        """Take (claim, computed, holds) row by row."""
        self.rows = tuple(Checked(*row) for row in rows)

    def __repr__(self) -> str:
        cells = (HEAD, ("---",) * 3, *((row.claim, str(row.computed), row.verdict) for row in self.rows))
        return "\n".join(f"| {' | '.join(cell.replace('|', chr(92) + '|') for cell in row)} |" for row in cells)

    def _repr_markdown_(self) -> str:
        return repr(self).replace("*", r"\*")
