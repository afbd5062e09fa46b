"""Linear program over mixtures: bound on the smallest level of all targets above one target's own.

For contexts ``S`` (one option an owner) let ``t(S)`` be the smallest level over all targets of ``base + S``. Let
``own(S)`` be the level of target ``j`` of ``own_base + S``, if its weakest direction, at double angle ``a``, lies in a
sector ``|a - middle| <= half < pi/2``. Then :class:`LevelProgram` finds a number ``V >= t(S) - slope own(S)``.

- ``t`` is at most every target's quadratic form in every direction, so at most any average of them (*cuts*).
- With ``y = -(even, odd)`` of target ``j``, the level is ``mean - |y|``, ``y`` points to ``a``, so in the sector
  ``|y| <= y . u / cos(half)`` with ``u`` the unit vector at ``middle``: ``own >= mean - y . u / cos(half)``.
- In the sector ``y . v >= 0`` for the two unit vectors ``v`` at ``middle +- (pi/2 - half)``.

All are linear in ``S``. Whatever multipliers the linear program has, clipped and normalised, give a valid ``V``: a sum
over owners of their best option. If the sector holds no mixture at all ``V`` is merely low, as
the multipliers of its edges are capped.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import inf
from typing import TYPE_CHECKING

import numpy as np

from ratt_opt.curvatures.params import DEFAULT
from ratt_opt.curvatures.planar.contexts import along, levels
from ratt_opt.highs import LinearProgram, Rows

if TYPE_CHECKING:
    from ratt_opt._validation import BoolArray, FloatArray, IntArray
    from ratt_opt.budget import Budget
    from ratt_opt.curvatures.params import PlanarParams
    from ratt_opt.curvatures.planar.contexts import Options

__all__ = ["MARGIN", "Cuts", "LevelProgram", "RelaxedContext", "Sector", "own_direction"]

MARGIN = 1e-12
"""Safety margin for rounding of a ceiling, relative to the sum of the absolute terms."""
EDGES = 2
"""Edges of a sector."""


@dataclass(frozen=True, slots=True, eq=False)
class Sector:
    """Double angles within ``half`` of ``middle``, of one target."""

    target: int
    middle: float
    half: float


@dataclass(frozen=True, slots=True, eq=False)
class Cuts:
    """Directions: (C,) targets and (C,) double angles."""

    targets: IntArray
    angles: FloatArray


@dataclass(frozen=True, slots=True, eq=False)
class RelaxedContext:
    """``ceiling`` is proved; ``mixture`` (K,) attains about that, with ``level`` and ``own``; ``cuts`` bind there.

    ``multipliers`` : (C,) of the binding cuts, with sum 1. ``average`` : (3, M) of them: ``t <= <average, total>``.
    """

    ceiling: float
    mixture: FloatArray
    level: float
    own: float
    cuts: Cuts
    multipliers: FloatArray
    average: FloatArray
    slope: float


class MixtureProgram:
    """``max t - slope own - edge_cost (violation of the edges)`` over mixtures in HiGHS; its word is not trusted.

    It grows by cuts and is solved for one slope after another, each time from the last basis.

    ``owners`` : (n,) of each option, 0 to R - 1, ascending; ``own`` : (n,) scores of the target's own level;
    ``edges`` : (2, n) scores and (2,) constants of the sector's edges.
    """

    def __init__(
        self, owners: IntArray, own: FloatArray, edges: tuple[FloatArray, FloatArray], edge_cost: float
    ) -> None:
        self._own, self._cuts, self._solved, self._edge_cost = own, 0, False, edge_cost
        self._n, self._owners = free, count = len(owners), int(owners[-1]) + 1 if len(owners) else 0
        matrix = np.zeros((count + EDGES, free + 1 + EDGES))
        matrix[owners, np.arange(free)] = 1.0
        matrix[count:, :free] = edges[0]
        matrix[count:, free + 1 :] = np.eye(EDGES)
        rows, columns = np.nonzero(matrix)
        lower, upper = (np.concatenate([np.ones(count), edge]) for edge in (-edges[1], np.full(EDGES, inf)))
        starts = np.concatenate([[0], np.cumsum(np.bincount(rows, minlength=len(matrix)))])
        self._program = LinearProgram(
            np.concatenate([np.zeros(free), [-1.0], np.full(EDGES, edge_cost)]),
            np.concatenate([np.zeros(free), [-inf], np.zeros(EDGES)]),
            np.concatenate([np.ones(free), np.full(1 + EDGES, inf)]),
            rows=Rows(lower, upper, starts, columns, matrix[rows, columns]),
            solver="simplex",
            presolve="off",
        )

    def add(self, scores: FloatArray, constants: FloatArray) -> None:
        """Rows ``t <= constants + scores . z``: (C, n) and (C,)."""
        count, width = len(constants), self._n + 1
        columns, values = np.tile(np.arange(width), count), np.concatenate([-scores, np.ones((count, 1))], axis=1)
        starts = np.arange(count + 1) * width
        self._program.add_rows(Rows(np.full(count, -inf), constants, starts, columns, values.ravel()))
        self._cuts += count
        self._program.option("simplex_strategy", 1)  # dual simplex: only rows are new

    def change_slope(self, slope: float) -> None:
        """Change the slope in the objective; the old solution stays feasible."""
        self._program.change_cost(slope * self._own)
        if self._solved:
            self._program.option("simplex_strategy", 4)  # primal simplex: only the objective is new

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
            weights[:EDGES] = np.clip(duals[self._owners : self._owners + EDGES], 0.0, self._edge_cost)
            weights[EDGES:] = cuts / cuts.sum()
        return np.clip(claim.x[: self._n], 0.0, 1.0), float(claim.x[self._n]), weights


class LevelProgram:
    """Bounds ``t - slope own`` over the contexts of allowed options, for one slope after another.

    ``base``, ``own_base`` : (3, M) parts of what every context is added to; without a sector ``own`` is 0.
    ``allowed`` : (K,), some option of every owner; ``start`` : (3, M) average of cuts that bounded something similar.
    """

    def __init__(
        self,
        options: Options,
        base: FloatArray,
        own_base: FloatArray,
        sector: Sector | None,
        *,
        allowed: BoolArray,
        start: FloatArray | None = None,
        params: PlanarParams = DEFAULT.planar,
    ) -> None:
        self._base, self._allowed, self._params = base, allowed, params
        self._parts, self._owners = np.ascontiguousarray(options.parts[allowed]), options.owners[allowed]
        self._first = np.flatnonzero(np.diff(self._owners, prepend=-1))
        if start is None:
            shares = 1 / np.bincount(self._owners)[self._owners]
            start = _worst(base + np.tensordot(shares, self._parts, axes=1), params.first_cuts)
        self._scores, self._constants = _sector_forms(self._parts, own_base, sector)
        edges = self._scores[1:], self._constants[1:]
        self._program = MixtureProgram(self._owners, self._scores[0], edges, params.edge_cost)
        self._cuts = Cuts(np.empty(0, dtype=np.int64), np.empty(0))
        targets = np.flatnonzero(start[0] > params.smallest_share)
        self._add(targets, np.arctan2(start[2, targets], start[1, targets]))

    def bound(self, slope: float, budget: Budget, enough: float = -np.inf) -> RelaxedContext:
        """The bound with one slope; ``enough`` : a ceiling low enough to stop at. It holds at every stop."""
        self._program.change_slope(slope)
        for last in [False] * (self._params.rounds - 1) + [True]:
            z, level, weights = self._program.solve()
            highest = self._ceiling(np.append(-slope, weights))
            own = float(self._constants[0] + self._scores[0] @ z)
            if last or highest <= enough or not np.isfinite(level) or budget.is_over:
                break
            found = self._violated(z, level - self._params.violation * abs(level - own))
            if len(found[0]) == 0:
                break
            self._add(*found)
        mixture = np.zeros(len(self._allowed))
        mixture[self._allowed] = z
        binding = weights[EDGES:] > 0
        cuts = Cuts(self._cuts.targets[binding], self._cuts.angles[binding])
        multipliers = weights[EDGES:][binding]
        average = _average(cuts, multipliers, self._base)
        return RelaxedContext(highest, mixture, level, own, cuts, multipliers, average, slope)

    def _ceiling(self, weights: FloatArray) -> float:
        """Largest weighted sum of the forms ``constants + scores . z`` over all contexts: each owner's best option."""
        options = weights @ self._scores
        best = np.maximum.reduceat(options, self._first) if len(options) else options
        terms = np.concatenate([weights * self._constants, best])
        return float(terms.sum() + MARGIN * np.abs(terms).sum())

    def _violated(self, z: FloatArray, limit: float) -> tuple[IntArray, FloatArray]:
        """Targets of the mixture ``z`` (n,) whose level is below a limit, weakest first, and their weakest angles."""
        total = self._base + (z @ self._parts.reshape(len(z), self._base.size)).reshape(self._base.shape)
        level = levels(total)
        targets = np.argsort(level, kind="stable")[: self._params.new_cuts]
        targets = targets[level[targets] < limit]
        return targets, np.arctan2(-total[2, targets], -total[1, targets])

    def _add(self, targets: IntArray, angles: FloatArray) -> None:
        directions = along(angles)
        scores = np.einsum("kpc,cp->ck", self._parts[:, :, targets], directions)
        constants = np.einsum("pc,cp->c", self._base[:, targets], directions)
        self._program.add(scores, constants)
        self._scores = np.concatenate([self._scores, scores])
        self._constants = np.append(self._constants, constants)
        self._cuts = Cuts(np.append(self._cuts.targets, targets), np.append(self._cuts.angles, angles))


def _sector_forms(parts: FloatArray, own_base: FloatArray, sector: Sector | None) -> tuple[FloatArray, FloatArray]:
    """(3, n) scores and (3,) constants: the level of the sector's target, from below, and the sector's two edges."""
    if sector is None:
        return np.zeros((3, len(parts))), np.zeros(3)
    EDGES = sector.middle + np.array([1.0, -1.0]) * (np.pi / 2 - sector.half)
    directions = np.concatenate([own_direction(sector.middle, sector.half)[None], -along(EDGES)])
    directions[1:, 0] = 0.0
    return directions @ parts[:, :, sector.target].T, directions @ own_base[:, sector.target]


def own_direction(middle: FloatArray | float, half: FloatArray | float) -> FloatArray:
    """(..., 3) coefficients of the lower bound on a target's level in a sector."""
    direction = along(middle)
    direction[..., 1:] /= np.cos(half)[..., None]
    return direction


def _average(cuts: Cuts, weights: FloatArray, base: FloatArray) -> FloatArray:
    """(3, M) of cuts with weights."""
    average = np.zeros_like(base)
    np.add.at(average.T, cuts.targets, weights[:, None] * along(cuts.angles))
    return average


def _worst(total: FloatArray, count: int) -> FloatArray:
    """(3, M) average of the weakest directions of the targets with the smallest levels."""
    targets = np.argsort(levels(total), kind="stable")[:count]
    cuts = Cuts(targets, np.arctan2(-total[2, targets], -total[1, targets]))
    return _average(cuts, np.full(len(targets), 1 / len(targets)), total)
