"""Raise the bound of an affine underestimator over its multipliers, by smoothing.

The bound is concave and piecewise linear: per target the least of ``value - multipliers . vertex`` over an outer
polytope's vertices, plus the sum of the smallest scores over the robots. Each least value is replaced by a soft
minimum of falling temperature (Nesterov, Math. Program. 103, 2005) and the smooth function is maximised by L-BFGS
(SciPy). It starts well from a related family's multipliers; a simplex method would start afresh.
"""

from __future__ import annotations

from ctypes import byref, c_double
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from ratt_opt.native.library import address, checked
from ratt_opt.native.loops import ProgramRecord, loops

if TYPE_CHECKING:
    from ratt_opt._validation import FloatArray, IntArray
    from ratt_opt.attack.params.least_sets import AscentParams
    from ratt_opt.budget import Budget

__all__ = ["DualProgram", "Multipliers", "ProgramRecord"]


@dataclass(frozen=True, slots=True)
class Multipliers:
    """``slopes`` : (M, 3) in the light robots' information; ``own`` : (M, h) scores of the heavy robots."""

    slopes: FloatArray
    own: FloatArray

    def together(self) -> FloatArray:
        """(M, 3 + h) slopes, then scores."""
        return np.ascontiguousarray(np.concatenate([self.slopes, self.own], axis=1), dtype=np.float64)


@dataclass(frozen=True, slots=True)
class DualProgram:
    """The function to maximise.

    ``first`` : (M + 1,) target ``j`` owns points ``first[j]:first[j + 1]``; ``pattern``, ``values`` : (V,);
    ``light`` : (V, 3) information of the light robots there; ``patterns`` : (P, h); ``heavy`` : (M, h);
    ``information`` : (F, M, 3), zero for each target's heavy robots; ``size`` robots are chosen
    """

    first: IntArray
    pattern: IntArray
    values: FloatArray
    light: FloatArray
    patterns: FloatArray
    heavy: IntArray
    information: FloatArray
    size: int
    params: AscentParams

    def smoothed(
        self, multipliers: Multipliers, temperature: float, gradient: FloatArray, fraction: FloatArray
    ) -> tuple[float, float]:
        """The bound and its smoothed value; adds to ``gradient`` (M, 3 + h) and fills ``fraction`` (F,)."""
        given, soft = multipliers.together(), c_double(0.0)
        rest, spare = np.empty(len(self.values)), np.empty(len(self.patterns) + 2 * len(self.information))
        places = address(gradient), address(fraction), byref(soft), address(rest), address(spare)
        return loops.smoothed_bound(self._record(), address(given), temperature, *places), soft.value

    def _record(self) -> ProgramRecord:
        """Record that the C code reads; it holds the addresses of this program's arrays."""
        (n_targets, n_heavy), n_patterns, n_robots = self.heavy.shape, len(self.patterns), len(self.information)
        return ProgramRecord(
            targets=n_targets,
            robots=n_robots,
            heavies=n_heavy,
            patterns=n_patterns,
            size=self.size,
            first=address(checked("first", self.first, np.int64, (n_targets + 1,))),
            pattern=address(checked("pattern", self.pattern, np.int64, self.values.shape)),
            values=address(checked("values", self.values, np.float64, self.values.shape)),
            light=address(checked("light", self.light, np.float64, (len(self.values), 3))),
            inside=address(checked("patterns", self.patterns, np.float64, (n_patterns, n_heavy))),
            heavy=address(checked("heavy", self.heavy, np.int64, (n_targets, n_heavy))),
            information=address(checked("information", self.information, np.float64, (n_robots, n_targets, 3))),
        )

    def ascend(
        self, start: Multipliers, goal: float, *, cold: bool, budget: Budget | None = None
    ) -> tuple[Multipliers, FloatArray]:
        """Better multipliers, and the fractions (F,) in which the smoothed weakest set holds the robots.

        Ends early where the bound reaches ``goal``, or the ``budget`` is over: of a thousand robots it takes seconds.
        """
        n_targets, n_robots = len(self.heavy), len(self.information)
        best, fraction = start, np.full(n_robots, self.size / n_robots)
        rest = self.rest(start)
        bound = self.bound(start, rest)
        room = goal - bound
        factor = np.asarray(np.linalg.inv(self._spread()).transpose(0, 2, 1), dtype=np.float64)
        for share in self.params.cold if cold else self.params.warm:
            if bound >= goal or (budget is not None and budget.is_over):
                break
            temperature = max(share * room / n_targets, 1e-12)
            screened = self._screened(rest, self.params.screened * temperature)
            ascent = _Ascent(screened, factor, start, temperature, goal)
            start, reached = ascent.run(budget)
            rest = self.rest(start)
            if (true := self.bound(start, rest)) >= bound:
                best, bound, fraction = start, true, reached
        return best, fraction

    def rest(self, multipliers: Multipliers) -> FloatArray:
        """(V,) value of each point minus what the multipliers say."""
        rest, given, spare = np.empty(len(self.values)), multipliers.together(), np.empty(len(self.patterns))
        loops.rest_of_vertices(self._record(), address(given), address(rest), address(spare))
        return rest

    def least(self, rest: FloatArray) -> FloatArray:
        """(M,) the least over each target's points; infinite if there is none."""
        used = np.diff(self.first) > 0
        least = np.full(len(used), np.inf)
        if used.any():
            least[used] = np.minimum.reduceat(rest, self.first[:-1][used])
        return least

    def rounding(self, multipliers: Multipliers) -> float:
        """Return what the bound may lose by rounding; large multipliers, whose terms cancel, make it large.

        A sum loses at most the number of its terms times an ulp of their sizes; four such sums follow each
        other: of a vertex, of scores, of robots decided, and of reduced costs.
        """
        slopes = np.abs(multipliers.slopes)
        terms = len(self.heavy) * np.abs(self.values).max(initial=0.0) + np.abs(multipliers.own).sum()
        terms += np.einsum("fmt,mt->", np.abs(self.information), slopes)
        terms += (slopes @ np.abs(self.light).max(axis=0, initial=0.0)).sum()
        return float(4 * (len(self.information) + len(self.heavy) + 16) * np.finfo(np.float64).eps * terms)

    def bound(self, multipliers: Multipliers, rest: FloatArray) -> float:
        """Return the dual bound of the multipliers; targets without points have no part in it."""
        used = np.diff(self.first) > 0
        scores = np.einsum("fmt,mt->f", self.information, multipliers.slopes)
        np.add.at(scores, self.heavy[used].ravel(), multipliers.own[used].ravel())
        bound = self.least(rest)[used].sum() + np.partition(scores, self.size - 1)[: self.size].sum()
        return float(bound - self.rounding(multipliers))

    def _screened(self, rest: FloatArray, margin: float) -> DualProgram:
        """Drop the points whose ``rest`` is more than ``margin`` above their target's least."""
        near = rest <= np.repeat(self.least(rest), np.diff(self.first)) + margin
        first = np.concatenate([[0], np.cumsum(near)])[self.first]
        return replace(self, first=first, pattern=self.pattern[near], values=self.values[near], light=self.light[near])

    def _spread(self) -> FloatArray:
        """(M, 3, 3) lower-triangular factors of the covariance of each target's points; 1 without points."""
        covariance = np.tile(np.eye(3), (len(self.heavy), 1, 1))
        counts = np.diff(self.first)
        used = counts > 0
        if used.any():
            counts, starts = counts[used], self.first[:-1][used]
            mean = np.add.reduceat(self.light, starts, axis=0) / counts[:, None]
            centred = self.light - np.repeat(mean, counts, axis=0)
            for s in range(3):
                for t in range(3):
                    covariance[used, s, t] = np.add.reduceat(centred[:, s] * centred[:, t], starts) / counts
            size = np.trace(covariance[used], axis1=1, axis2=2) + 1e-12 * (mean**2).sum(axis=1) + 1e-300
            covariance[used] += self.params.flat * size[:, None, None] * np.eye(3)
        return np.asarray(np.linalg.cholesky(covariance))


class _Ascent:
    """L-BFGS at one temperature, in coordinates in which every target's points spread alike."""

    def __init__(
        self, program: DualProgram, factor: FloatArray, start: Multipliers, temperature: float, goal: float
    ) -> None:
        self._program, self._factor, self._temperature, self._goal = program, factor, temperature, goal
        slopes = np.linalg.solve(self._factor, start.slopes[..., None])[..., 0]
        self._best = np.concatenate([slopes, start.own], axis=1).ravel()
        self._bound = -np.inf
        self._fraction = np.zeros(len(program.information))

    def run(self, budget: Budget | None) -> tuple[Multipliers, FloatArray]:
        """The multipliers of the best bound met, and the fractions there."""
        from scipy.optimize import minimize

        def stop(xk: FloatArray) -> None:  # noqa: ARG001  (the name SciPy looks for)
            if self._bound >= self._goal or (budget is not None and budget.is_over):
                raise StopIteration

        params = self._program.params
        options: Any = {"maxiter": params.steps, "maxcor": params.memory}
        minimize(self._negated, self._best, jac=True, method="L-BFGS-B", callback=stop, options=options)
        return self._multipliers(self._best), self._fraction

    def _negated(self, point: Any) -> tuple[float, Any]:
        """Minus the smoothed bound, and its gradient; the best point is kept by the bound itself."""
        program, multipliers = self._program, self._multipliers(point)
        gradient, fraction = np.zeros((len(program.heavy), 3 + multipliers.own.shape[1])), np.zeros(len(self._fraction))
        bound, value = program.smoothed(multipliers, self._temperature, gradient, fraction)
        if bound > self._bound:
            self._bound, self._best, self._fraction = bound, point.copy(), fraction
        gradient[:, :3] = np.einsum("mst,ms->mt", self._factor, gradient[:, :3])
        return -value, -gradient.ravel()

    def _multipliers(self, point: FloatArray) -> Multipliers:
        shaped = point.reshape(len(self._program.heavy), -1)
        return Multipliers(np.einsum("mst,mt->ms", self._factor, shaped[:, :3]), shaped[:, 3:])
