"""The linear program of a search node: the best relaxed plan under all cuts, solved by HiGHS."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from ratt_opt._validation import BoolArray, FloatArray, IntArray

__all__ = ["NodeProgram", "RelaxedPlan"]

ROUNDING = 1e-12
"""Weights of elements up to this are the simplex method's rounding."""


@dataclass(frozen=True, slots=True, kw_only=True)
class RelaxedPlan:
    """What the solver claims: ``selection`` (E,) weights of elements, ``duals`` >= 0 weights of ``cuts``."""

    selection: FloatArray
    cuts: IntArray
    duals: FloatArray
    level: float


class NodeProgram:
    """``max t`` with ``t <= constant_k + scores_k . z`` for the cuts in use, ``sum_e z_e = 1`` for each robot.

    One HiGHS model for the whole search: nodes differ in column bounds and in the cuts they use, so each
    solve starts from the last basis. Only the multipliers are used; every bound is derived from them anew.
    """

    def __init__(self, n_elements: int, choices: Sequence[IntArray]) -> None:
        import highspy

        self._highspy = highspy
        self._n = n_elements
        self._robots = len(choices)
        self._model = highspy.Highs()  # type: ignore[no-untyped-call]
        for option, value in (("output_flag", False), ("threads", 1), ("solver", "simplex")):
            self._model.setOptionValue(option, value)
        self._infinity = highspy.kHighsInf
        for _ in range(n_elements):
            self._model.addVar(0.0, 1.0)
        self._model.addVar(-self._infinity, self._infinity)
        self._model.changeColCost(n_elements, 1.0)
        self._model.changeObjectiveSense(highspy.ObjSense.kMaximize)
        for choice in choices:
            self._model.addRow(1.0, 1.0, len(choice), choice.astype(np.int32), np.ones(len(choice)))
        self._allowed = np.ones(n_elements, dtype=np.bool_)
        self._rows: list[int] = []
        self._idle: dict[int, int] = {}

    @property
    def in_use(self) -> list[int]:
        """Cuts that are rows now, in row order."""
        return self._rows

    def use(self, cut: int, constant: float, scores: FloatArray) -> None:
        """Add one cut as a row."""
        columns = np.flatnonzero(scores)
        indices = np.append(columns, self._n).astype(np.int32)
        values = np.append(-scores[columns], 1.0)
        self._model.addRow(-self._infinity, constant, len(indices), indices, values)
        self._rows.append(cut)
        self._idle[cut] = 0

    def drop(self, gone: Callable[[int], bool]) -> None:
        """Remove the rows of cuts for which ``gone`` is true."""
        positions = [position for position, cut in enumerate(self._rows) if gone(cut)]
        if positions:
            rows = np.array(positions, dtype=np.int32) + self._robots
            self._model.deleteRows(len(rows), rows)
            for position in positions:
                del self._idle[self._rows[position]]
            kept = set(positions)
            self._rows = [cut for position, cut in enumerate(self._rows) if position not in kept]

    def drop_idle(self, patience: int) -> None:
        """Remove cuts whose multiplier was zero in the last ``patience`` solves."""
        self.drop(lambda cut: self._idle[cut] > patience)

    def allow(self, allowed: BoolArray) -> None:
        """Set which elements may be chosen: (E,)."""
        for e in np.flatnonzero(allowed != self._allowed):
            self._model.changeColBounds(int(e), 0.0, 1.0 if allowed[e] else 0.0)
        self._allowed = allowed.copy()

    def solve(self) -> RelaxedPlan | None:
        """Solve and return what HiGHS claims, or ``None`` when it claims no optimum."""
        self._model.run()
        if self._model.getModelStatus() != self._highspy.HighsModelStatus.kOptimal:
            return None
        solution = self._model.getSolution()
        columns = np.array(solution.col_value)
        duals = np.abs(np.array(solution.row_dual)[self._robots :])
        for cut, dual in zip(self._rows, duals, strict=True):
            self._idle[cut] = 0 if dual > 0 else self._idle[cut] + 1
        return RelaxedPlan(
            selection=np.where(columns[: self._n] > ROUNDING, np.minimum(columns[: self._n], 1.0), 0.0),
            cuts=np.array(self._rows, dtype=np.int64),
            duals=duals,
            level=float(columns[self._n]),
        )
