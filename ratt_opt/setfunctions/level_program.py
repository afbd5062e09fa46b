"""How far the smallest level of all targets can rise above one target's own: a linear program over mixtures.

For contexts ``S`` (one option a robot) let ``t(S)`` be the smallest level over all targets of ``base + S``, and
``own(S)`` the level of target ``j`` of ``own_base + S``, where its weakest direction, at double angle ``a``, lies in a
sector ``|a - middle| <= half < pi/2``. :func:`relax` returns a number ``V >= t(S) - slope own(S)``.

- ``t`` is at most every target's quadratic form in every direction, so at most any average of them (*cuts*).
- With ``y = -(even, odd)`` of target ``j``, the level is ``mean - |y|``, ``y`` points to ``a``, so in the sector
  ``|y| <= y . u / cos(half)`` with ``u`` the unit vector at ``middle``: ``own >= mean - y . u / cos(half)``.
- In the sector ``y . v >= 0`` for the two unit vectors ``v`` at ``middle +- (pi/2 - half)``.

All are linear in ``S``. Whatever multipliers the solver returns, clipped and normalised, give a valid ``V``: a sum over
robots of their best option, evaluated here afresh. Where the sector holds no mixture at all ``V`` is merely low, as the
multipliers of its edges are capped.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from ratt_opt.setfunctions.planar import along, levels

if TYPE_CHECKING:
    from collections.abc import Callable

    from ratt_opt._validation import BoolArray, FloatArray, IntArray
    from ratt_opt.setfunctions.planar import Options

__all__ = ["NO_CUTS", "Cuts", "Relaxed", "Sector", "own_direction", "relax"]

ROUNDS = 12
"""Most times the violated cuts are added."""
NEW_CUTS = 10
"""Worst targets that get a cut a round."""
VIOLATION = 1e-2
"""Cuts violated by less than this, relative to ``|t - own|``, are left."""
EDGE_COST = 100.0
"""Cap on the multipliers of a sector's edges."""
MARGIN = 1e-12
"""Safety margin for rounding, relative to the sum of the absolute terms."""


@dataclass(frozen=True, slots=True)
class Sector:
    """Double angles within ``half`` of ``middle``, of one target."""

    target: int
    middle: float
    half: float


@dataclass(frozen=True, slots=True)
class Cuts:
    """Directions: (C,) targets and (C,) double angles."""

    targets: IntArray
    angles: FloatArray

    def joined(self, others: Cuts) -> Cuts:
        """These, and those of the others that are not among them."""
        if others is self or len(others.targets) == 0:
            return self
        here = set(zip(self.targets.tolist(), self.angles.tolist(), strict=True))
        new = [pair not in here for pair in zip(others.targets.tolist(), others.angles.tolist(), strict=True)]
        return Cuts(
            np.concatenate([self.targets, others.targets[new]]), np.concatenate([self.angles, others.angles[new]])
        )


NO_CUTS = Cuts(np.empty(0, dtype=np.int64), np.empty(0))


@dataclass(frozen=True, slots=True)
class Relaxed:
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


@dataclass(frozen=True, slots=True)
class _Form:
    """``constant + sum of the chosen options' scores``: one row, or several, a linear form of the context."""

    constant: FloatArray
    scores: FloatArray


def relax(
    options: Options,
    base: FloatArray,
    own_base: FloatArray,
    sector: Sector | None,
    *,
    slope: float,
    allowed: BoolArray,
    cuts: Cuts,
    closes: Callable[[float], bool] | None = None,
) -> Relaxed:
    """Bound ``t - slope own`` over the contexts of allowed options; without a sector, ``t`` alone.

    Parameters
    ----------
    base, own_base : (3, M) parts of what every context is added to; allowed : (K,); cuts : directions to start from
    closes : whether a ceiling is low enough to stop at
    """
    own, edges = _sector_forms(options, own_base, sector)
    columns = np.flatnonzero(allowed)
    if len(cuts.targets) == 0:
        counts = np.bincount(options.robot, allowed)
        cuts = _worst(options, base, allowed / counts[options.robot])
    program = _Program(options, columns, own, edges, slope)
    forms = _cut_forms(options, base, cuts)
    program.add(forms)
    for last in [False] * (ROUNDS - 1) + [True]:
        mixture, level = program.solve()
        weights, edge_weights = program.multipliers(len(cuts.targets))
        ceiling = _ceiling(options, allowed, [(forms, weights), (own, np.array([-slope])), (edges, edge_weights)])
        if last or not np.isfinite(level) or (closes and closes(ceiling)):
            break
        # Without a sector the level itself is wanted; else its distance from the target's own.
        apart = abs(level - float(own.constant[0] + own.scores[0] @ mixture))
        found = _worst(options, base, mixture, below=level - VIOLATION * apart)
        if len(found.targets) == 0:
            break
        new = _cut_forms(options, base, found)
        program.add(new)
        forms = _Form(np.append(forms.constant, new.constant), np.concatenate([forms.scores, new.scores]))
        cuts = Cuts(np.concatenate([cuts.targets, found.targets]), np.concatenate([cuts.angles, found.angles]))
    binding = weights > 0
    average = np.zeros_like(base)
    np.add.at(average.T, cuts.targets, weights[:, None] * along(cuts.angles))
    return Relaxed(
        ceiling=ceiling,
        mixture=mixture,
        level=level,
        own=float(own.constant[0] + own.scores[0] @ mixture),
        cuts=Cuts(cuts.targets[binding], cuts.angles[binding]),
        multipliers=weights[binding],
        average=average,
        slope=slope,
    )


def _sector_forms(options: Options, own_base: FloatArray, sector: Sector | None) -> tuple[_Form, _Form]:
    """The level of the sector's target, from below, and its two edges."""
    size = len(options.elements)
    if sector is None:
        return _Form(np.zeros(1), np.zeros((1, size))), _Form(np.empty(0), np.empty((0, size)))
    parts, start = options.parts[:, :, sector.target], own_base[:, sector.target]
    direction = own_direction(sector.middle, sector.half)
    sides = sector.middle + np.array([1.0, -1.0]) * (np.pi / 2 - sector.half)
    edge = -along(sides)
    edge[:, 0] = 0.0
    return (
        _Form(np.array([start @ direction]), (parts @ direction)[None]),
        _Form(edge @ start, edge @ parts.T),
    )


def own_direction(middle: FloatArray | float, half: FloatArray | float) -> FloatArray:
    """(..., 3) coefficients of the lower bound on a target's level in a sector."""
    direction = along(middle)
    direction[..., 1:] /= np.cos(half)[..., None]
    return direction


def _cut_forms(options: Options, base: FloatArray, cuts: Cuts) -> _Form:
    direction = along(cuts.angles)
    scores = np.einsum("kpc,cp->ck", options.parts[:, :, cuts.targets], direction)
    return _Form(np.einsum("pc,cp->c", base[:, cuts.targets], direction), scores)


def _worst(options: Options, base: FloatArray, mixture: FloatArray, below: float = np.inf) -> Cuts:
    """The weakest directions of the targets whose level is below a number."""
    total = base + np.tensordot(mixture, options.parts, axes=1)
    level = levels(total)
    targets = np.argsort(level, kind="stable")[:NEW_CUTS]
    targets = targets[level[targets] < below]
    return Cuts(targets, np.arctan2(-total[2, targets], -total[1, targets]))


def _ceiling(options: Options, allowed: BoolArray, terms: list[tuple[_Form, FloatArray]]) -> float:
    """Largest weighted sum of forms over all contexts: each robot's best option."""
    scores = sum((weights @ form.scores for form, weights in terms), np.zeros(len(allowed)))
    best = np.empty(0)
    if len(options.first):
        best = np.maximum.reduceat(np.where(allowed, scores, -np.inf), options.first)
    numbers = np.concatenate([best, *(weights * form.constant for form, weights in terms)])
    return float(numbers.sum() + MARGIN * np.abs(numbers).sum())


class _Program:
    """``max t - slope own - EDGE_COST (violation of the edges)`` in highspy; its word is not trusted."""

    def __init__(self, options: Options, columns: IntArray, own: _Form, edges: _Form, slope: float) -> None:
        import highspy

        self._columns, self._size = columns, len(options.elements)
        self._infinity = highspy.kHighsInf
        self._robots, self._edges = len(options.first), len(edges.constant)
        free, violations = len(columns), len(edges.constant)
        model: Any = highspy.HighsLp()
        model.num_col_, model.num_row_ = free + 1 + violations, self._robots + violations
        model.col_cost_ = np.concatenate([slope * own.scores[0, columns], [-1.0], np.full(violations, EDGE_COST)])
        model.col_lower_ = np.concatenate([np.zeros(free), [-self._infinity], np.zeros(violations)])
        model.col_upper_ = np.concatenate([np.ones(free), np.full(1 + violations, self._infinity)])
        model.row_lower_ = np.concatenate([np.ones(self._robots), -edges.constant])
        model.row_upper_ = np.concatenate([np.ones(self._robots), np.full(violations, self._infinity)])
        matrix = np.zeros((self._robots + violations, free + 1 + violations))
        matrix[options.robot[columns], np.arange(free)] = 1.0
        matrix[self._robots :, :free] = edges.scores[:, columns]
        matrix[self._robots :, free + 1 :] = np.eye(violations)
        rows, indices = np.nonzero(matrix)
        model.a_matrix_.format_ = highspy.MatrixFormat.kRowwise
        model.a_matrix_.start_ = np.concatenate([[0], np.cumsum(np.bincount(rows, minlength=len(matrix)))])
        model.a_matrix_.index_, model.a_matrix_.value_ = indices, matrix[rows, indices]
        self._solver: Any = highspy.Highs()  # type: ignore[no-untyped-call]
        for option, value in (("output_flag", False), ("threads", 1), ("solver", "simplex"), ("presolve", "off")):
            self._solver.setOptionValue(option, value)
        self._solver.passModel(model)

    def add(self, cuts: _Form) -> None:
        """Rows ``t - scores . z <= constant``."""
        count, width = len(cuts.constant), len(self._columns) + 1
        values = np.concatenate([-cuts.scores[:, self._columns], np.ones((count, 1))], axis=1)
        self._solver.addRows(
            count,
            np.full(count, -self._infinity),
            cuts.constant,
            count * width,
            (np.arange(count) * width).astype(np.int32),
            np.tile(np.arange(width), count).astype(np.int32),
            np.ascontiguousarray(values.ravel()),
        )

    def solve(self) -> tuple[FloatArray, float]:
        """(K,) mixture and ``t``."""
        self._solver.run()
        values = np.array(self._solver.getSolution().col_value)
        mixture = np.zeros(self._size)
        if len(values) <= len(self._columns):
            return mixture, -np.inf
        mixture[self._columns] = np.clip(values[: len(self._columns)], 0.0, 1.0)
        return mixture, float(values[len(self._columns)])

    def multipliers(self, cuts: int) -> tuple[FloatArray, FloatArray]:
        """(C,) weights of the cuts, with sum 1, and weights of the edges, both non-negative."""
        duals = np.array(self._solver.getSolution().row_dual)
        weights = np.clip(-duals[self._robots + self._edges :], 0.0, None)
        if len(weights) != cuts or not weights.sum() > 0:
            return np.full(cuts, 1 / cuts), np.zeros(self._edges)
        return weights / weights.sum(), np.clip(duals[self._robots : self._robots + self._edges], 0.0, EDGE_COST)
