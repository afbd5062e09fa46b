"""Trees that prove inequalities of single targets, as lemmas of certificates.

A lemma says ``phi_j(T) <= constant + sum of scores[e] over e in T``. Its tree is a branch and bound over such sets. A
case says what each robot may have, an element or nothing. The value is concave in the information, so a relaxed set
of a case, found by conditional gradients, has a tangent that bounds all its sets. Cases whose bound is above the
constant are divided by one robot's options. All cases of one depth, of all lemmas, are bounded at once.

Source: conditional gradients (Frank and Wolfe 1956), whose gap is a bound at every step.
"""

from __future__ import annotations

from copy import copy
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np

from ratt_opt.certificates.verifier.work import tick

if TYPE_CHECKING:
    from collections.abc import Sequence

    from ratt_opt._validation import BoolArray, FloatArray, IntArray
    from ratt_opt.problem import Problem
    from ratt_opt.setfunctions.information import InformationObjective
    from ratt_opt.solvers.maxmin.proof import TargetLemma

__all__ = ["TargetTree", "TreeParams", "target_trees"]


@dataclass(frozen=True, slots=True, kw_only=True)
class TreeParams:
    """Limits of the trees: what they leave open raises a lemma's constant, and so the end that is proved.

    ``tolerance`` : of a target's largest value, by which a leaf may be above the constant: shorter trees against
        a larger constant
    ``steps`` : of conditional gradients for one case, at most; then it is divided
    ``searches`` : evaluations of one step's length
    ``nodes`` : of one tree, beyond which its cases are leaves as they are
    ``at_once`` : cases bounded together, for the memory that they take
    """

    tolerance: float = 1e-9
    steps: int = 24
    searches: int = 4
    nodes: int = 20_000
    at_once: int = 4096


@dataclass(slots=True, eq=False)
class TargetTree:
    """A tree over a target's sets: a leaf has the information (d, d) where its tangent touches, a branch its parts."""

    point: FloatArray | None = None
    robot: int = -1
    parts: list[list[int]] = field(default_factory=list)
    below: list[TargetTree] = field(default_factory=list)


@dataclass(frozen=True, slots=True, eq=False)
class _Cases:
    """Cases of one depth: their ``lemmas`` (K,), options ``allowed`` (K, R, C) and the ``nodes`` that they are."""

    lemmas: IntArray
    allowed: BoolArray
    nodes: list[TargetTree]


def target_trees(problem: Problem, lemmas: Sequence[TargetLemma], params: TreeParams | None = None) -> list[TargetTree]:
    """Return a tree for each lemma; where its constant is too low, or limits are met, it proves a larger one only."""
    return _TargetTrees(problem, lemmas, params or TreeParams()).grown() if lemmas else []


class _TargetTrees:
    """The lemmas as arrays.

    ``elements`` (L, R, C): the options of each robot that touches a lemma's target, -1 for nothing, -2 for no option;
    ``information`` (L, R, C, d, d) and ``scores`` (L, R, C) of them.
    """

    def __init__(self, problem: Problem, lemmas: Sequence[TargetLemma], params: TreeParams) -> None:
        self.params, objective = params, problem.information_objective
        self.objective, self.targets = objective, np.array([lemma.target for lemma in lemmas])
        sees, owner = abs(objective.information).sum(axis=(-2, -1)), problem.robot
        touching = [np.flatnonzero(sees[:, lemma.target] + abs(lemma.scores)) for lemma in lemmas]
        options = [_options(own, owner) for own in touching]
        rows, columns = max(map(len, options), default=0), max((len(o) for own in options for o in own), default=1)
        shape = len(lemmas), max(rows, 1), columns
        self.elements = np.full(shape, -2)
        self.elements[..., 0] = -1
        self.robots = np.full(shape[:2], -1)
        d = objective.dimension
        self.information, self.scores = np.zeros((*shape, d, d)), np.zeros(shape)
        for k, (lemma, own) in enumerate(zip(lemmas, options, strict=True)):
            for r, option in enumerate(own):
                self.elements[k, r, : len(option)] = option
                real = np.array(option[:-1])
                self.robots[k, r] = owner[real[0]]
                self.information[k, r, : len(real)] = objective.information[real, lemma.target]
                self.scores[k, r, : len(real)] = lemma.scores[real]
        everything = objective.posterior_mixture(np.ones(objective.n))
        most = objective.target_values(everything)[self.targets]
        self.enough = np.array([lemma.constant for lemma in lemmas]) + params.tolerance * most
        self.prior = objective.prior_information[self.targets]
        self.weights = objective.weights[self.targets]
        base = objective.target_values(objective.prior_information) + objective.criterion(objective.prior_information)
        self.base = np.full(len(lemmas), base.max()) if objective.is_least_of_targets else base[self.targets]

    def grown(self) -> list[TargetTree]:
        """The trees, grown depth by depth."""
        trees = [TargetTree() for _ in self.targets]
        counts = np.zeros(len(trees), dtype=np.int64)
        waiting = [_Cases(np.arange(len(trees)), self.elements >= -1, trees)]
        while waiting:
            cases = waiting.pop()
            if len(cases.nodes) > self.params.at_once:
                halves = np.array_split(np.arange(len(cases.nodes)), 2)
                waiting += [
                    _Cases(cases.lemmas[own], cases.allowed[own], [cases.nodes[k] for k in own]) for own in halves
                ]
                continue
            np.add.at(counts, cases.lemmas, 1)
            if below := self._expand(cases, counts):
                waiting.append(below)
        return trees

    def _expand(self, cases: _Cases, counts: IntArray) -> _Cases | None:
        """Make leaves of the cases that are closed, and return those below the others."""
        tick()
        bounds, points, shares = self._bound(cases)
        decided = (cases.allowed.sum(axis=-1) <= 1).all(axis=-1)
        closed = (bounds <= self.enough[cases.lemmas]) | decided | (counts[cases.lemmas] > self.params.nodes)
        lemmas: list[int] = []
        allowed: list[BoolArray] = []
        nodes: list[TargetTree] = []
        for k, node in enumerate(cases.nodes):
            if closed[k]:
                node.point = points[k]
                continue
            own, lemma = cases.allowed[k], int(cases.lemmas[k])
            row = _divided_row(own, shares[k])
            node.robot = int(self.robots[lemma, row])
            for column in np.flatnonzero(own[row] & (self.elements[lemma, row] >= 0)).tolist():
                node.parts.append([int(self.elements[lemma, row, column])])
                node.below.append(TargetTree())
                lemmas.append(lemma)
                allowed.append(_with_only(own, row, column))
            nothing = np.flatnonzero(own[row] & (self.elements[lemma, row] == -1)).tolist()
            for column in nothing:
                node.below.append(TargetTree())
                lemmas.append(lemma)
                allowed.append(_with_only(own, row, column))
            nodes += node.below
        return _Cases(np.array(lemmas), np.array(allowed), nodes) if nodes else None

    def _bound(self, cases: _Cases) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Bounds (K,), the points (K, d, d) of their tangents, and relaxed sets (K, R, C), by conditional gradients."""
        count, enough = len(cases.nodes), self.enough[cases.lemmas]
        information, scores = self.information[cases.lemmas], self.scores[cases.lemmas]
        prior, open_ = self.prior[cases.lemmas], np.arange(count)
        shares = cases.allowed / cases.allowed.sum(axis=-1, keepdims=True)
        bounds, points = np.full(count, np.inf), np.array(prior)
        for _ in range(self.params.steps):
            own, x, lemmas = information[open_], shares[open_], cases.lemmas[open_]
            point = prior[open_] + np.einsum("krc,krcab->kab", x, own)
            value, slope = self._value(point, lemmas), self._slope(point, lemmas)
            gains = np.einsum("kab,krcab->krc", slope, own) - scores[open_]
            gains[~cases.allowed[open_]] = -np.inf
            best = gains.argmax(axis=-1)
            most = np.take_along_axis(gains, best[..., None], axis=-1)[..., 0].sum(axis=-1)
            bound = value + np.einsum("kab,kab->k", slope, prior[open_] - point) + most
            lower = bound < bounds[open_]
            bounds[open_[lower]], points[open_[lower]] = bound[lower], point[lower]
            relaxed = value - np.einsum("krc,krc->k", x, scores[open_])
            going = (bounds[open_] > enough[open_]) & (relaxed <= enough[open_]) & (bound > relaxed)
            if not going.any():
                break
            open_, x, best = open_[going], x[going], best[going]
            vertex = np.zeros_like(x)
            np.put_along_axis(vertex, best[..., None], 1.0, axis=-1)
            step = vertex - x
            toward = np.einsum("krc,krcab->kab", step, own[going])
            paid = np.einsum("krc,krc->k", step, scores[open_])
            shares[open_] = x + self._length(point[going], toward, paid, lemmas[going])[:, None, None] * step
        return bounds, points, shares

    def _length(self, point: FloatArray, toward: FloatArray, paid: FloatArray, lemmas: IntArray) -> FloatArray:
        """(K,) lengths of steps in (0, 1] that nearly maximise values less scores, by secants of their derivative."""

        def derivative(length: FloatArray) -> FloatArray:
            slope = self._slope(point + length[:, None, None] * toward, lemmas)
            return np.asarray(np.einsum("kab,kab->k", slope, toward) - paid)

        low, high = np.zeros(len(paid)), np.ones(len(paid))
        at_low, at_high = derivative(low), derivative(high)
        whole = at_high >= 0
        for _ in range(self.params.searches):
            with np.errstate(divide="ignore", invalid="ignore"):
                secant = low + (high - low) * at_low / (at_low - at_high)
            middle = np.where(np.isfinite(secant), np.clip(secant, low + (high - low) / 16, high), high)
            at_middle = derivative(middle)
            rising = at_middle >= 0
            low, at_low = np.where(rising, middle, low), np.where(rising, at_middle, at_low)
            high, at_high = np.where(rising, high, middle), np.where(rising, at_high, at_middle)
        return np.where(whole, 1.0, (low + high) / 2)

    def _value(self, point: FloatArray, lemmas: IntArray) -> FloatArray:
        """(K,) values of the lemmas' targets at information (K, d, d)."""
        return np.asarray(self.base[lemmas] - self._alone(lemmas).criterion(point))

    def _slope(self, point: FloatArray, lemmas: IntArray) -> FloatArray:
        """(K, d, d) supergradients of these values."""
        if not self.objective.is_least_of_targets:
            return self._alone(lemmas).gradient(point)
        found = np.empty_like(point)
        for lemma in np.unique(lemmas).tolist():
            own = lemmas == lemma
            found[own] = self.objective.of_target(int(self.targets[lemma])).gradient(point[own][:, None])[:, 0]
        return found

    def _alone(self, lemmas: IntArray) -> InformationObjective:
        """The criterion with a target for each case."""
        one = copy(self.objective)
        one.weights = self.weights[lemmas]
        one.output = None if self.objective.output is None else self.objective.output[self.targets[lemmas]]
        return one


def _options(elements: IntArray, owner: IntArray) -> list[list[int]]:
    """Options of each robot: its own of some elements, or nothing (-1)."""
    return [[*elements[owner[elements] == i].tolist(), -1] for i in np.unique(owner[elements]).tolist()]


def _divided_row(allowed: BoolArray, shares: FloatArray) -> int:
    """The row of the robot whose choice is the most divided of those that have one."""
    open_rows = allowed.sum(axis=-1) > 1
    return int(np.where(open_rows, 1 - shares.max(axis=-1), -1.0).argmax())


def _with_only(allowed: BoolArray, row: int, column: int) -> BoolArray:
    """The case in which one robot has one option left."""
    left = allowed.copy()
    left[row] = False
    left[row, column] = True
    return left
