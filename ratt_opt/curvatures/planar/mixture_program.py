"""``max t - slope own - EDGE_COST (violation of the edges)`` over mixtures in HiGHS; its word is not trusted."""

from __future__ import annotations

from math import inf
from typing import TYPE_CHECKING

import numpy as np

from ratt_opt.highs import LinearProgram, Rows

if TYPE_CHECKING:
    from ratt_opt._validation import FloatArray, IntArray

__all__ = ["EDGES", "MixtureProgram"]

EDGES = 2
EDGE_COST = 100.0
"""Cap on the multipliers of a sector's edges."""
DUAL, PRIMAL = 1, 4
"""Simplex strategies of HiGHS: after new rows, and after a new objective."""


class MixtureProgram:
    """A program that grows by cuts and is solved for one slope after another, each time from the last basis.

    Parameters
    ----------
    owners : (n,) of each option, 0 to R - 1, ascending
    own : (n,) scores of the target's own level; edges : (2, n) scores and (2,) constants of the sector's edges
    """

    def __init__(self, owners: IntArray, own: FloatArray, edges: tuple[FloatArray, FloatArray]) -> None:
        self._n, self._owners, self._cuts, self._solved = (
            len(owners),
            int(owners[-1]) + 1 if len(owners) else 0,
            0,
            False,
        )
        self._own, free, count = own, self._n, self._owners
        matrix = np.zeros((count + EDGES, free + 1 + EDGES))
        matrix[owners, np.arange(free)] = 1.0
        matrix[count:, :free] = edges[0]
        matrix[count:, free + 1 :] = np.eye(EDGES)
        rows, columns = np.nonzero(matrix)
        self._program = LinearProgram(
            np.concatenate([np.zeros(free), [-1.0], np.full(EDGES, EDGE_COST)]),
            np.concatenate([np.zeros(free), [-inf], np.zeros(EDGES)]),
            np.concatenate([np.ones(free), np.full(1 + EDGES, inf)]),
            rows=Rows(
                lower=np.concatenate([np.ones(count), -edges[1]]),
                upper=np.concatenate([np.ones(count), np.full(EDGES, inf)]),
                starts=np.concatenate([[0], np.cumsum(np.bincount(rows, minlength=len(matrix)))]),
                columns=columns,
                values=matrix[rows, columns],
            ),
            solver="simplex",
            presolve="off",
        )

    def add(self, scores: FloatArray, constants: FloatArray) -> None:
        """Rows ``t <= constants + scores . z``: (C, n) and (C,)."""
        count, width = len(constants), self._n + 1
        self._program.add_rows(
            Rows(
                lower=np.full(count, -inf),
                upper=constants,
                starts=np.arange(count + 1) * width,
                columns=np.tile(np.arange(width), count),
                values=np.concatenate([-scores, np.ones((count, 1))], axis=1).ravel(),
            )
        )
        self._cuts += count
        self._program.option("simplex_strategy", DUAL)

    def change_slope(self, slope: float) -> None:
        """Another objective."""
        self._program.change_cost(slope * self._own)
        if self._solved:
            self._program.option("simplex_strategy", PRIMAL)

    def solve(self) -> tuple[FloatArray, float, FloatArray]:
        """(n,) mixture, ``t`` and (2 + C,) multipliers: of the edges, capped, and of the cuts, with sum 1."""
        claim = self._program.solve()
        self._solved = True
        weights = np.zeros(EDGES + self._cuts)
        weights[EDGES:] = 1 / self._cuts
        if len(claim.x) <= self._n or len(claim.duals) != self._owners + len(weights):
            return np.zeros(self._n), -np.inf, weights
        duals = np.nan_to_num(claim.duals, posinf=0.0, neginf=0.0)
        cuts = np.clip(-duals[self._owners + EDGES :], 0.0, None)
        if cuts.sum() > 0:
            weights[:EDGES] = np.clip(duals[self._owners : self._owners + EDGES], 0.0, EDGE_COST)
            weights[EDGES:] = cuts / cuts.sum()
        return np.clip(claim.x[: self._n], 0.0, 1.0), float(claim.x[self._n]), weights
