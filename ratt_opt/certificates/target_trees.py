"""Trees that prove inequalities of single targets, as lemmas of certificates.

A lemma says ``phi_j(T) <= constant + sum of scores[e] over e in T``. Its tree is a branch and bound over such sets. A
case says what each robot may have, an element or nothing. The value is concave in the information, so a relaxed set
of a case, found by conditional gradients, has a tangent that bounds all its sets. Cases whose bound is above the
constant are divided by one robot's options, those with the largest bounds first, of all lemmas at once.

Source: conditional gradients (Frank and Wolfe 1956), whose gap is a bound at every step.
"""

from __future__ import annotations

from copy import copy
from dataclasses import dataclass, field, replace
from time import monotonic
from typing import TYPE_CHECKING

import numpy as np

from ratt_opt.certificates.verifier.work import seconds_left, tick

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from ratt_opt._validation import BoolArray, FloatArray, IntArray
    from ratt_opt.problem import Problem
    from ratt_opt.setfunctions.information import InformationObjective
    from ratt_opt.solvers.maxmin.proof import TargetLemma

__all__ = ["TargetTree", "TargetTreeParams", "target_trees"]


@dataclass(frozen=True, slots=True, kw_only=True)
class TargetTreeParams:
    """Limits of the trees: what they leave open raises a lemma's constant, and so the end that is proved.

    ``tolerance`` : of a target's largest value, by which a leaf may be above the constant: shorter trees against
        a larger constant
    ``steps`` : of conditional gradients for one case, at most; then it is divided
    ``searches`` : evaluations of one step's length
    ``nodes``, ``all_nodes`` : of one tree, and of all; then cases are leaves as they are. Files and the time to verify
        them grow with both
    ``plain`` : nodes of a tree of tangents alone, which are rational, before bases are leaves, too (log-det)
    ``divided`` : cases of one tree divided together, those with the largest bounds: fewer rounds against more nodes
    ``at_once`` : cases bounded together, for the memory that they take
    ``share`` : of the seconds left, likewise
    """

    tolerance: float = 1e-9
    steps: int = 24
    searches: int = 4
    nodes: int = 4_000
    plain: int = 200
    all_nodes: int = 80_000
    divided: int = 32
    at_once: int = 4096
    share: float = 0.3


@dataclass(slots=True, eq=False)
class TargetTree:
    """A tree over a target's sets: a branch has its parts, a leaf a bound.

    ``base`` : elements beyond which gains diminish; else ``point`` : the information (d, d) where a tangent touches
    """

    point: FloatArray | None = None
    base: list[int] | None = None
    robot: int = -1
    parts: list[list[int]] = field(default_factory=list)
    below: list[TargetTree] = field(default_factory=list)


@dataclass(frozen=True, slots=True, eq=False)
class _OpenCase:
    """An open case of a tree: what robots may have, ``allowed`` (R, C), and how its sets are bounded."""

    node: TargetTree
    allowed: BoolArray
    share: FloatArray
    bound: float


def target_trees(problem: Problem, lemmas: Sequence[TargetLemma], params: TargetTreeParams) -> list[TargetTree]:
    """Return a tree for each lemma; where its constant is too low, or limits are met, it proves a larger one only."""
    if not lemmas:
        return []
    if not problem.information_objective.is_submodular:
        return _TargetTrees(problem, lemmas, params).grown()[0]
    trees, closed = _TargetTrees(problem, lemmas, replace(params, nodes=min(params.plain, params.nodes))).grown()
    left = [k for k, is_closed in enumerate(closed) if not is_closed]
    if left:
        again = _TargetTrees(problem, [lemmas[k] for k in left], params, has_bases=True).grown()[0]
        for k, tree in zip(left, again, strict=True):
            trees[k] = tree
    return trees


class _TargetTrees:
    """The lemmas as arrays.

    ``elements`` (L, R, C): the options of each robot that touches a lemma's target, -1 for nothing, -2 for no option;
    ``information`` (L, R, C, d, d) and ``scores`` (L, R, C) of them.
    """

    def __init__(
        self, problem: Problem, lemmas: Sequence[TargetLemma], params: TargetTreeParams, *, has_bases: bool = False
    ) -> None:
        self.params, self.has_bases, objective = params, has_bases, problem.information_objective
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

    def grown(self) -> tuple[list[TargetTree], list[bool]]:
        """The trees, and whether each shows its constant.

        Cases of largest bounds are divided until none is too large, or limits are met.
        """
        trees = [TargetTree() for _ in self.targets]
        waiting: list[list[_OpenCase]] = [[] for _ in trees]
        self._open(waiting, [(k, tree, self.elements[k] >= -1) for k, tree in enumerate(trees)])
        if self.has_bases:
            for k, tree in enumerate(trees):
                if self._bounded_beyond(k, tree):
                    waiting[k].clear()
        counts, until = np.ones(len(trees), dtype=np.int64), monotonic() + self.params.share * seconds_left()
        most = min(self.params.nodes, self.params.all_nodes // max(len(trees), 1))
        while monotonic() < until:
            tick()
            below: list[tuple[int, TargetTree, BoolArray]] = []
            for k, own in enumerate(waiting):
                if own and counts[k] < most:
                    own.sort(key=lambda case: case.bound)
                    for case in own[-self.params.divided :]:
                        below += [(k, *child) for child in self._divide(k, case)]
                    del own[-self.params.divided :]
            if not below:
                break
            np.add.at(counts, [k for k, _, _ in below], 1)
            self._open(waiting, below)
        return trees, [not own for own in waiting]

    def _open(self, waiting: list[list[_OpenCase]], fresh: list[tuple[int, TargetTree, BoolArray]]) -> None:
        """Bound new cases, each a leaf for now; keep those that may be divided and are not low enough."""
        for start in range(0, len(fresh), self.params.at_once):
            some = fresh[start : start + self.params.at_once]
            lemmas, allowed = np.array([k for k, _, _ in some]), np.array([own for _, _, own in some])
            bounds, points, shares = self._bound(lemmas, allowed)
            beyond = self._beyond(lemmas, allowed) if self.has_bases else np.full(len(some), np.inf)
            by_base, bounds = beyond < bounds, np.minimum(beyond, bounds)
            divisible = (allowed.sum(axis=-1) > 1).any(axis=-1) & (bounds > self.enough[lemmas])
            for number, (k, node, own) in enumerate(some):
                node.point, node.base = points[number], self._decided(k, own) if by_base[number] else None
                if divisible[number]:
                    waiting[k].append(_OpenCase(node, own, shares[number], float(bounds[number])))

    def _divide(self, lemma: int, case: _OpenCase) -> Iterator[tuple[TargetTree, BoolArray]]:
        """Divide a case by one robot's options; yield the nodes below and what they allow, nothing last."""
        node, own = case.node, case.allowed
        row = _divided_row(own, case.share)
        node.robot, node.point, node.base = int(self.robots[lemma, row]), None, None
        for column in sorted(np.flatnonzero(own[row]).tolist(), key=lambda c: self.elements[lemma, row, c] < 0):
            if self.elements[lemma, row, column] >= 0:
                node.parts.append([int(self.elements[lemma, row, column])])
            node.below.append(TargetTree())
            yield node.below[-1], _with_only(own, row, column)

    def _bound(self, of: IntArray, allowed: BoolArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Bound cases of lemmas ``of`` (K,) by conditional gradients.

        Returns bounds (K,), the points (K, d, d) of their tangents, and relaxed sets (K, R, C)
        """
        count, enough = len(of), self.enough[of]
        information, scores = self.information[of], self.scores[of]
        prior, open_ = self.prior[of], np.arange(count)
        shares = allowed / allowed.sum(axis=-1, keepdims=True)
        bounds, points = np.full(count, np.inf), np.array(prior)
        for _ in range(self.params.steps):
            own, x, lemmas = information[open_], shares[open_], of[open_]
            point = prior[open_] + np.einsum("krc,krcab->kab", x, own)
            value, slope = self._value(point, lemmas), self._slope(point, lemmas)
            gains = np.einsum("kab,krcab->krc", slope, own) - scores[open_]
            gains[~allowed[open_]] = -np.inf
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

    def _beyond(self, of: IntArray, allowed: BoolArray) -> FloatArray:
        """(K,) bounds of cases by what their sure elements are worth, and the largest gains beside these."""
        information, scores = self.information[of], self.scores[of]
        sure = allowed & (allowed.sum(axis=-1, keepdims=True) == 1)
        point = self.prior[of] + np.einsum("krc,krcab->kab", sure, information)
        alone, before = self._alone(of), self._value(point, of)
        after = self.base[of][:, None, None] - np.moveaxis(
            alone.criterion(np.moveaxis(point[:, None, None] + information, 0, -3)), -1, 0
        )
        gains = np.where(sure, 0.0, after - before[:, None, None]) - scores
        gains[~allowed] = -np.inf
        return np.asarray(before + gains.max(axis=-1).sum(axis=-1))

    def _bounded_beyond(self, lemma: int, root: TargetTree) -> bool:
        """Bound all sets beyond the elements without a score, as base sets have none; whether that is enough."""
        real = self.elements[lemma] >= 0
        of_base = real & (self.scores[lemma] == 0)
        point = self.prior[lemma] + self.information[lemma][of_base].sum(axis=0)
        of = np.full(1, lemma)
        before = self._value(point[None], of)[0]
        after = self._value(point + self.information[lemma][real], np.full(int(real.sum()), lemma))
        gains = np.zeros(real.shape)
        gains[real] = after - before
        gains = np.where(of_base, 0.0, gains) - self.scores[lemma]
        gains[self.elements[lemma] < -1] = -np.inf
        enough = before + gains.max(axis=-1).sum() <= self.enough[lemma]
        if enough:
            root.base = sorted(self.elements[lemma][of_base].tolist())
        return bool(enough)

    def _decided(self, lemma: int, allowed: BoolArray) -> list[int]:
        """Elements that all sets of a case have."""
        sure = allowed & (allowed.sum(axis=-1, keepdims=True) == 1) & (self.elements[lemma] >= 0)
        return sorted(self.elements[lemma][sure].tolist())

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
