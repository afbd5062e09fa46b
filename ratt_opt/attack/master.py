"""The master: links that groups which cover the team cost at least, by duals of a linear program.

    minimise    sum cut(C) x_C
    subject to  each robot in exactly one chosen group   [duals u_i]
                sum blinded(C) x_C <= alpha_s            [dual -m]

HiGHS suggests ``u`` and ``m``. Rounded to integers they are a bound by themselves: of groups that cover the team each
costs at least ``u(C) - m blinded(C)`` plus the least reduced cost of all columns.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import inf
from typing import TYPE_CHECKING

import numpy as np

from ratt_opt.attack.columns import UNIT, Duals
from ratt_opt.graph.communication import robots_of
from ratt_opt.highs import LinearProgram, rows_of

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from ratt_opt._validation import FloatArray
    from ratt_opt.attack.columns import Column, Columns
    from ratt_opt.budget import Budget
    from ratt_opt.highs import Rows

__all__ = ["DualBound", "best_duals"]

USED = 1e-7
"""Part of a column in a solution that is more than the program's tolerance."""


@dataclass(frozen=True, slots=True)
class DualBound:
    """``duals`` : under which no column has a negative reduced cost; ``columns`` : of the program.

    ``used`` : columns of which the last solution takes a part
    """

    duals: Duals
    columns: list[Column]
    used: list[Column]


def best_duals(
    columns: Columns, n_blinded: int, most_cut: int, budget: Budget, first: Iterable[Column] = ()
) -> DualBound:
    """The best duals under which no column has a negative reduced cost, or some that claim more than ``most_cut``.

    ``first`` : columns that the program begins with

    Raises
    ------
    OutOfBudget : the time is up, or the user interrupted.
    """
    n, largest = columns.robots, 4.0 * (most_cut + columns.robots**2)
    lower = np.append(np.full(n, -largest), 0.0)
    program = LinearProgram(np.append(np.ones(n), -float(n_blinded)), lower, largest, maximise=True)
    best, known, parts = Duals(np.zeros(n, np.int64), 0), dict.fromkeys(first), np.zeros(0)
    program.add_rows(_rows(list(known), n))
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
        fresh = [one for one in columns.some(cheapest) if one not in known]
        if not fresh:
            break
        known.update(dict.fromkeys(fresh))
        program.add_rows(_rows(fresh, n))
    entered = list(known)
    return DualBound(best, entered, [entered[k] for k in np.flatnonzero(parts > USED)])


def _rounded(claimed: FloatArray, n: int) -> Duals | None:
    if len(claimed) != n + 1 or not np.isfinite(claimed).all():
        return None
    return Duals(np.floor(claimed[:n] * UNIT).astype(np.int64), max(int(np.ceil(claimed[n] * UNIT)), 0))


def _rows(columns: Sequence[Column], robots: int) -> Rows:
    entries = []
    for column in columns:
        members = robots_of(column.group)
        entries.append(([*members, robots], [*[1.0] * len(members), -float(column.blinded)]))
    return rows_of(entries, -inf, np.array([column.cut for column in columns], dtype=np.float64))
