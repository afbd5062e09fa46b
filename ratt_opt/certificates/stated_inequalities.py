"""Inequalities of single targets as a certificate states them: tangents, lemmas with their trees, and rows of both."""

from __future__ import annotations

import math
from collections import Counter
from dataclasses import replace
from functools import cache, partial
from typing import TYPE_CHECKING, Any

import numpy as np
from flint import arb, ctx, fmpq

from ratt_opt.certificates.params import DEFAULT
from ratt_opt.certificates.stated_problem import statement_of
from ratt_opt.certificates.target_trees import target_trees
from ratt_opt.certificates.verifier import target_lemmas as checked
from ratt_opt.certificates.verifier.marginals import MarginalBounds
from ratt_opt.certificates.verifier.tangents import read_tangents, seers_of
from ratt_opt.solvers.maxmin.proof import TargetLemma

if TYPE_CHECKING:
    from ratt_opt._validation import FloatArray
    from ratt_opt.certificates.params import CertificateParams
    from ratt_opt.certificates.target_trees import TargetTree
    from ratt_opt.problem import Problem
    from ratt_opt.solvers.maxmin.proof import TangentCut

__all__ = ["StatedInequalities", "round_up", "shortened"]

SLACK = fmpq(1, 2**60)
"""Added to constants of which only a ball is known, so that checkers of fewer bits can decide them, too."""


class StatedInequalities:
    """Inequalities of a proof's rows, each stated once; tangents are counted first, lemmas behind them."""

    def __init__(self, problem: Problem, params: CertificateParams = DEFAULT) -> None:
        self._problem, self._objective, self._params = problem, problem.information_objective, params
        self._tangents: dict[tuple[int, bytes], int] = {}
        self._stated: list[Any] = []
        self._lemmas: dict[tuple[int, float, bytes], int] = {}
        self._proved: list[TargetLemma] = []
        self._rows: list[tuple[list[int], dict[int, tuple[bool, int]]]] = []

    def add(self, place: list[int], cut: TangentCut) -> None:
        """Add a row; ``place`` : its attack and group."""
        row = {lemma.target: (True, self._lemma(lemma)) for lemma in cut.lemmas}
        for j in range(self._objective.n_targets):
            if j not in row:
                row[j] = False, self._tangent(j, cut.point[j])
        self._rows.append((place, row))

    def record(self, count: int | None = None) -> dict[str, Any]:
        """The fields of an upper proof; none if there is nothing to state.

        ``count`` : of targets, if the spacing of values is to show that plans are worth no more
        """
        spaced = [] if count is None else [self._lemma(lemma) for lemma in self._largest_values()]
        lemmas = self._proved_lemmas()
        if not self._rows and count is None:
            return {}
        known = Counter((j, inequality) for _, row in self._rows for j, inequality in row.items())
        most: dict[int, tuple[bool, int]] = {}
        for (j, inequality), _ in known.most_common():
            most.setdefault(j, inequality)
        found: dict[str, Any] = {
            "tangents": self._stated,
            "lemmas": lemmas,
            "usual": [self._number(most[j]) for j in sorted(most)],
            "rows": [
                [*place, [self._number(row[j]) for j in sorted(row) if row[j] != most[j]]] for place, row in self._rows
            ],
        }
        if count is not None:
            found["spacing"] = {"count": min(count, self._objective.n_targets), "lemmas": spaced}
        return found

    def _number(self, inequality: tuple[bool, int]) -> int:
        is_lemma, number = inequality
        return number + len(self._stated) * is_lemma

    def _tangent(self, target: int, point: FloatArray) -> int:
        """Number of the tangent at the information ``point`` (d, d)."""
        key = target, point.tobytes()
        if key not in self._tangents:
            fenchel = self._objective.of_target(target).fenchel_point(point[None], 0)
            touch = fenchel[1:] if self._objective.is_least_of_targets else fenchel
            digits = self._params.points.lemma_digits
            self._tangents[key] = len(self._stated)
            self._stated.append([target, *shortened(touch, point, digits, self._params.points.condition)])
        return self._tangents[key]

    def _lemma(self, lemma: TargetLemma) -> int:
        key = lemma.target, lemma.constant, lemma.scores.tobytes()
        if key not in self._lemmas:
            self._lemmas[key] = len(self._proved)
            self._proved.append(lemma)
        return self._lemmas[key]

    def _largest_values(self) -> list[TargetLemma]:
        """Lemmas without scores, that no set is worth more for a target than all elements together."""
        objective = self._objective
        everything = objective.target_values(objective.posterior_mixture(np.ones(objective.n)))
        seen = objective.information.any(axis=(-2, -1)).any(axis=0)
        none = np.zeros(objective.n)
        return [
            TargetLemma(target=j, constant=float(everything[j]), scores=none) for j in np.flatnonzero(seen).tolist()
        ]

    def _proved_lemmas(self) -> list[dict[str, Any]]:
        """The lemmas with their trees, and the least constants that these prove."""
        if not self._proved:
            return []
        digits = self._params.points.lemma_digits
        lemmas = [replace(given, scores=np.array(_short(given.scores.tolist(), digits))) for given in self._proved]
        grown = target_trees(self._problem, lemmas, self._params.lemmas)
        trees = [self._nodes(lemma.target, tree) for lemma, tree in zip(lemmas, grown, strict=True)]
        about = statement_of(self._problem)
        found = []
        with ctx.workprec(self._params.points.precision):
            tangents, marginals = read_tangents(about, self._stated), cache(partial(MarginalBounds, about))
            for lemma, tree in zip(lemmas, trees, strict=True):
                elements = np.flatnonzero(lemma.scores).tolist()
                scores = {e: fmpq(*float(lemma.scores[e]).as_integer_ratio()) for e in elements}
                claim = checked.StatedLemma(lemma.target, scores, fmpq(0))
                options = checked.options_of(about, claim, seers_of(about, lemma.target))
                least = checked.least_constant(tangents, marginals, claim, tree, options)
                constant = round_up(least if isinstance(least, fmpq) else least + SLACK)
                found.append(
                    {
                        "target": lemma.target,
                        "elements": elements,
                        "scores": lemma.scores[elements].tolist(),
                        "constant": constant,
                        "tree": tree,
                    }
                )
        return found

    def _nodes(self, target: int, root: TargetTree) -> list[Any]:
        """A tree in preorder: the number of a leaf's tangent, or a branch."""
        nodes, waiting = list[Any](), [root]
        while waiting:
            node = waiting.pop()
            if node.base is not None:
                nodes.append({"base": node.base})
            elif node.point is not None:
                nodes.append(self._tangent(target, node.point))
            else:
                nodes.append({"element": node.robot, "parts": node.parts})
                waiting += reversed(node.below)
        return nodes


def shortened(touch: Any, point: FloatArray, digits: int, condition: float) -> Any:
    """Shorten the digits of a Fenchel point (nested lists) of well conditioned information ``point`` (..., d, d)."""
    return touch if np.linalg.cond(point).max() > condition else _short(touch, digits)


def _short(value: Any, digits: int) -> Any:
    if isinstance(value, list):
        return [_short(item, digits) for item in value]
    return value if isinstance(value, int) else float(f"{value:.{digits}g}")


def round_up(bound: fmpq | arb) -> float:
    """The smallest float that is surely no less than a number, or the ball around it."""
    value = float(arb(bound).upper())
    while not bound <= fmpq(*value.as_integer_ratio()):
        value = math.nextafter(value, math.inf)
    return value
