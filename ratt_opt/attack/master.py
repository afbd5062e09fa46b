"""The master: links that groups which cover the team cost at least, by duals of a linear program.

    minimise    sum cut(C) x_C
    subject to  each robot in exactly one chosen group   [duals u_i]
                sum blinded(C) x_C <= alpha_s            [dual -m]

HiGHS suggests ``u`` and ``m``. Rounded to integers they are a bound by themselves: of groups that cover the team each
costs at least ``u(C) - m blinded(C)`` plus the least reduced cost of all columns.
"""

from __future__ import annotations

from math import inf
from typing import TYPE_CHECKING, Any, Protocol

import numpy as np

from ratt_opt.attack.columns import UNIT, Duals
from ratt_opt.graph.communication import robots_of
from ratt_opt.highs import LinearProgram, rows_of

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from ratt_opt._validation import FloatArray, IntArray
    from ratt_opt.budget import Budget

__all__ = ["best_duals"]

USED = 1e-7
"""Part of a column in a solution that is more than the program's tolerance."""


class ColumnList(Protocol):
    """Columns of a team: ``groups`` (C,) bit masks, ``cuts``, ``blinded`` (C,)."""

    @property
    def robots(self) -> int: ...
    @property
    def groups(self) -> NDArray[Any]: ...
    @property
    def cuts(self) -> NDArray[Any]: ...
    @property
    def blinded(self) -> NDArray[Any]: ...

    def cheapest(self, duals: Duals) -> tuple[int, IntArray]:
        """The least reduced cost, and some columns of negative one."""
        ...


def best_duals(columns: ColumnList, n_blinded: int, most_cut: int, budget: Budget) -> tuple[Duals, IntArray]:
    """Duals under which no column has a negative reduced cost; the best, or some that claim more than ``most_cut``.

    Also the columns of which the last solution takes a part.

    Raises
    ------
    OutOfBudget : the time is up, or the user interrupted.
    """
    n, largest = columns.robots, 4.0 * (most_cut + columns.robots**2)
    lower = np.append(np.full(n, -largest), 0.0)
    program = LinearProgram(np.append(np.ones(n), -float(n_blinded)), lower, largest, maximise=True)
    best, known, parts = Duals(np.zeros(n, np.int64), 0), dict[int, None](), np.zeros(0)
    while best.claim(n_blinded) <= most_cut * UNIT:
        budget.check()
        claimed = program.solve()
        duals, parts = _rounded(claimed.x, n), np.abs(claimed.duals)
        if duals is None:
            break  # HiGHS has nothing to say; what is known stays true
        least, cheapest = columns.cheapest(duals)
        if least < 0:  # every group has a robot, so that this makes up for it
            duals = Duals(duals.robots + least, duals.blinding)
        if duals.claim(n_blinded) > best.claim(n_blinded):
            best = duals
        fresh = [int(k) for k in cheapest if int(k) not in known]
        if not fresh:
            break
        known.update(dict.fromkeys(fresh))
        program.add_rows(rows_of(*_rows(columns, np.array(fresh))))
    entered = np.fromiter(known, np.int64)[: len(parts)]
    return best, entered[parts[: len(entered)] > USED]


def _rounded(claimed: FloatArray, n: int) -> Duals | None:
    if len(claimed) != n + 1 or not np.isfinite(claimed).all():
        return None
    return Duals(np.floor(claimed[:n] * UNIT).astype(np.int64), max(int(np.ceil(claimed[n] * UNIT)), 0))


def _rows(columns: ColumnList, chosen: IntArray) -> tuple[list[tuple[list[int], list[float]]], float, FloatArray]:
    entries = []
    for mask, blinded in zip(columns.groups[chosen].tolist(), columns.blinded[chosen].tolist(), strict=True):
        members = robots_of(mask)
        entries.append(([*members, columns.robots], [*[1.0] * len(members), -float(blinded)]))
    return entries, -inf, columns.cuts[chosen].astype(np.float64)
