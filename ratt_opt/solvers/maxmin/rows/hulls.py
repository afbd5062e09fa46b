"""Inequalities of concave hulls: of all that hold for one target, nearly the lowest one at a relaxed choice.

``phi(T) <= constant + scores(T)`` for every set ``T`` of at most one element of each robot. A linear program over some
sets suggests constant and scores; an exact search for the set that violates them most (``target_sets.c``) finds the
next set, and in the end the constant. Elements that the relaxed choice does not have get the least scores that the sets
of the program's optimum allow, then more where the search finds a violation.

Source: the concave envelope by column generation, as separation over a polytope given by its vertices.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from ratt_opt.highs import LinearProgram, rows_of
from ratt_opt.native.library import address
from ratt_opt.native.loops import SeersRecord, loops
from ratt_opt.setfunctions.criteria.logdet import LogDetObjective
from ratt_opt.setfunctions.criteria.trace import TraceObjective
from ratt_opt.setfunctions.information import triangles
from ratt_opt.setfunctions.rounding_errors import UNIT
from ratt_opt.solvers.maxmin.proof import TargetLemma
from ratt_opt.solvers.maxmin.rows.inequalities import Inequalities, TargetInequality

if TYPE_CHECKING:
    from ratt_opt._validation import BoolArray, FloatArray, IntArray
    from ratt_opt.setfunctions.information import InformationObjective
    from ratt_opt.solvers.maxmin.elements import Task
    from ratt_opt.solvers.maxmin.params import RowParams

__all__ = ["TargetHull", "hulls_of"]

MOST_ROBOTS = 64
"""Robots that masks hold."""
PLANE = 2


@dataclass(frozen=True, slots=True, eq=False)
class _Seers:
    """Some elements of a target, sorted by robot, as the compiled search reads them."""

    record: SeersRecord
    arrays: tuple[FloatArray | IntArray, ...]
    robots: int

    @classmethod
    def of(cls, one: InformationObjective, robots: IntArray, information: FloatArray, error: float) -> _Seers:
        first = np.append(np.flatnonzero(np.diff(robots, prepend=-1)), len(robots)).astype(np.int64)
        prior, packed = triangles(one.prior_information[0]), triangles(information)
        assert one.compiled_code is not None
        record = SeersRecord(
            robots=len(first) - 1,
            dimension=one.dimension,
            criterion=one.compiled_code,
            weight=float(one.weights[0]),
            baseline=float(one.criterion(one.prior_information)[0]),
            error=error,
            first=address(first),
            prior=address(prior),
            information=address(packed),
        )
        return cls(record, (first, prior, packed), len(first) - 1)

    def largest_excess(self, prices: FloatArray, floor: float, tolerance: float, most: int) -> tuple[float, IntArray]:
        """No set is worth more beyond its prices than this, or the floor; and the elements of a best one."""
        chosen = np.empty(self.robots, dtype=np.int64)
        prices = np.ascontiguousarray(prices)
        value = loops.largest_excess(self.record, address(prices), floor, tolerance, most, address(chosen))
        return float(value), chosen[chosen >= 0]


class TargetHull:
    """Hull of one target.

    Parameters
    ----------
    seers : (k,) elements that tell about it, one of each class of equal ones, sorted by robot
    information : (k, d, d) of the seers, positive semidefinite
    error : by which the difference of two values of the target may be off
    """

    def __init__(
        self,
        one: InformationObjective,
        seers: tuple[IntArray, IntArray],
        information: FloatArray,
        error: float,
        params: RowParams,
    ) -> None:
        self._one, self._params, self._error = one, params, error
        self.elements, self._robots = seers
        self._information = information
        self.seers = _Seers.of(one, self._robots, information, error)
        self._sets: dict[tuple[int, ...], float] = {}
        """Sets of optimal programs, with their values."""
        everything = one.prior_information + information.sum(axis=0)
        self._most = float(one.target_values(everything)[0])

    def inequality(self, share: FloatArray, below: float, tolerance: float = 0.0) -> tuple[float, FloatArray] | None:
        """The constant and the scores (k,) at weights ``share`` (k,); ``None`` if they are not known to be below.

        ``tolerance`` : by which the inequality may be higher than the lowest one
        """
        support = np.flatnonzero(share > self._params.least_share)
        if not len(support) or (share[support] > 1 - self._params.least_share).all():
            return None
        tolerance = max(self._params.hull_tolerance * self._most, tolerance / 2)
        found = self._on_support(share[support], support, below, tolerance)
        if found is None:
            return None
        constant, prices, tight = found
        return self._lifted(constant, prices, tight, share, tolerance)

    def _values(self, members: BoolArray) -> FloatArray:
        """(K,) of sets (K, k)."""
        sums = np.tensordot(members.astype(np.float64), self._information, axes=1)
        return np.asarray(self._one.target_values(self._one.prior_information + sums[:, None])[..., 0])

    def _members(self, sets: list[tuple[int, ...]]) -> BoolArray:
        members = np.zeros((len(sets), len(self.elements)), dtype=np.bool_)
        for row, own in zip(members, sets, strict=True):
            row[list(own)] = True
        return members

    def _on_support(
        self, share: FloatArray, support: IntArray, below: float, tolerance: float
    ) -> tuple[float, FloatArray, list[tuple[int, ...]]] | None:
        """Constant, prices (support,) and the sets of the program's optimum."""
        place = {int(e): k for k, e in enumerate(support)}
        seers = _Seers.of(self._one, self._robots[support], self._information[support], self._error)
        known = {s: v for s, v in self._sets.items() if all(e in place for e in s)}
        mixture, weights = self._mixture(share, support)
        fresh = [s for s in {(), *((e,) for e in place), *mixture} if s not in known]
        known |= dict(zip(fresh, self._values(self._members(fresh)).tolist(), strict=True))
        if sum(weight * known[own] for own, weight in zip(mixture, weights, strict=True)) >= below:
            return None
        sets = list(known)
        rows = rows_of([([0, *(place[e] + 1 for e in s)], [1.0] * (len(s) + 1)) for s in sets], list(known.values()))
        program = LinearProgram(np.append(1.0, share), rows=rows, presolve="off")
        for _ in range(self._params.hull_rounds):
            found = program.solve()
            if not found.is_optimal or float(found.x @ np.append(1.0, share)) >= below:
                return None  # the program has fewer sets than there are, so the hull is no lower
            constant, prices = float(found.x[0]), found.x[1:]
            excess, chosen = seers.largest_excess(prices, constant, tolerance, self._params.hull_nodes)
            if not np.isfinite(excess):
                return None
            if excess <= constant + 2 * tolerance:
                break
            new = tuple(support[chosen].tolist())
            if new in known:
                break
            known[new] = float(self._values(self._members([new]))[0])
            program.add_rows(rows_of([([0, *(place[e] + 1 for e in new)], [1.0] * (len(new) + 1))], [known[new]]))
            sets.append(new)
        else:
            return None
        tight = [s for s, dual in zip(sets, found.duals, strict=False) if abs(dual) > UNIT]
        self._sets |= {s: known[s] for s in tight}
        return constant, prices, tight

    @staticmethod
    def _mixture(share: FloatArray, support: IntArray) -> tuple[list[tuple[int, ...]], list[float]]:
        """Sets whose weighted mean is the relaxed choice, so that their mean value is below the envelope.

        Weights lie side by side on a circle of length 1; a set is what lies over one point of it.
        """
        ends = np.concatenate([[0.0], np.cumsum(share)])
        cuts = np.unique(np.append(ends % 1.0, 1.0))
        middles, weights = (cuts[1:] + cuts[:-1]) / 2, np.diff(cuts)
        over = np.diff(np.floor(ends - middles[:, None]), axis=1) > 0
        return [tuple(support[row].tolist()) for row in over], weights.tolist()

    def _lifted(
        self, constant: float, prices: FloatArray, tight: list[tuple[int, ...]], share: FloatArray, tolerance: float
    ) -> tuple[float, FloatArray] | None:
        """Give all other elements scores, and the constant what the search proves."""
        outside = share <= self._params.least_share
        scores = np.zeros(len(share))
        scores[~outside] = prices
        members = self._members(tight)
        other = self._robots[:, None] != self._robots[None]  # without elements of each element's robot
        rest = members[:, None, :] & other[None, outside]
        sums = np.tensordot(rest.astype(np.float64), self._information, axes=1) + self._information[outside]
        values = self._one.target_values(self._one.prior_information + sums[:, :, None])[..., 0]
        scores[outside] = np.maximum((values - constant - rest @ scores).max(axis=0), 0.0)
        for _ in range(self._params.hull_lifts):
            excess, chosen = self.seers.largest_excess(scores, constant, tolerance, self._params.hull_nodes)
            if not np.isfinite(excess):
                return None
            raised = chosen[outside[chosen]]
            if excess <= constant + 2 * tolerance or not len(raised):
                break
            scores[raised] += (excess - constant) / len(raised)
        else:
            excess, _ = self.seers.largest_excess(scores, constant, tolerance, self._params.hull_nodes)
            if not np.isfinite(excess):
                return None
        rounding = (len(self.seers.arrays[0]) + 4) * UNIT * (abs(excess) + self._most + float(np.abs(scores).sum()))
        return excess + self._error + rounding, scores


def hulls_of(task: Task, params: RowParams, information: FloatArray, first: IntArray) -> list[TargetHull | None]:
    """The hull of each target; ``None`` for one that the compiled search does not know.

    ``information`` : (E, M, d, d) positive semidefinite; ``first`` : (E,) the element that a search takes for each
    """
    objective, error = task.objective, params.value_errors * task.problem.evaluation_error
    is_known = isinstance(objective, LogDetObjective) or (
        isinstance(objective, TraceObjective) and objective.dimension <= PLANE and objective.compiled_code is not None
    )
    hulls: list[TargetHull | None] = []
    for j in range(objective.n_targets):
        own = np.flatnonzero(information[:, j].any(axis=(-2, -1)) & (first == np.arange(objective.n)))
        own = own[np.argsort(task.problem.robot[own], kind="stable")]
        robots = task.problem.robot[own]
        if not is_known or not np.isfinite(error) or not len(own) or len(np.unique(robots)) > MOST_ROBOTS:
            hulls.append(None)
        else:
            hulls.append(TargetHull(objective.of_target(j), (own, robots), information[own, j], error, params))
    return hulls


def as_inequalities(found: list[tuple[int, float, FloatArray]]) -> Inequalities:
    """Inequalities from (target, constant, scores (E,))."""
    lemmas = [TargetLemma(target=j, constant=constant, scores=scores) for j, constant, scores in found]
    return Inequalities(
        targets=np.array([lemma.target for lemma in lemmas], dtype=np.int64),
        constants=np.array([lemma.constant for lemma in lemmas]),
        scores=np.array([lemma.scores for lemma in lemmas]).T,
        origins=tuple(TargetInequality(target=lemma.target, lemma=lemma) for lemma in lemmas),
    )
