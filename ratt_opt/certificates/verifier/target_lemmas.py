"""Inequalities of single targets: lemmas, each proved by a tree, and rows, which add up one inequality of each target.

A lemma says ``phi_j(T) <= constant + sum of scores[e] over e in T`` for every set ``T`` of at most one element of each
robot. Its tree divides these sets by what they have of a robot: an element of one of the parts named, or, as the last
child, none of those. At a leaf a tangent of the target bounds all sets of the case, robot by robot; of the log-det,
whose gains diminish, also what a base set is worth, and the gains of other elements beside it (``marginals.py``).
"""

from __future__ import annotations

from functools import cache, partial
from typing import TYPE_CHECKING, Any, NamedTuple

from flint import arb, fmpq

from ratt_opt.certificates.verifier.exact_matrices import largest
from ratt_opt.certificates.verifier.limits import limits
from ratt_opt.certificates.verifier.marginals import MarginalBounds
from ratt_opt.certificates.verifier.reading import array, check_size, exact, fields, index, indices, need, walk
from ratt_opt.certificates.verifier.tangents import Bound, StatedTangent, read_tangents, seers_of
from ratt_opt.certificates.verifier.work import hold, tick

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from ratt_opt.certificates.verifier.statement import Statement

    Options = dict[int, tuple[int | None, ...]]

__all__ = ["StatedLemma", "TargetInequalities", "least_constant", "options_of"]

ZERO = fmpq(0)


class StatedLemma(NamedTuple):
    """Checked lemma; ``scores`` of elements that are not 0."""

    target: int
    scores: dict[int, fmpq]
    constant: fmpq


class TargetInequalities:
    """Tangents, lemmas and rows of an upper proof, each checked as it is read."""

    def __init__(self, about: Statement, tangents: object, lemmas: object, usual: object) -> None:
        self._about, self._terms, self._cells, self._seers = about, 0, 0, cache(partial(seers_of, about))
        self._kept: dict[int, dict[int, fmpq]] = {}
        self.marginals = cache(partial(MarginalBounds, about))
        self.tangents = read_tangents(about, tangents)
        self.lemmas = [self._lemma(k, lemma) for k, lemma in enumerate(array("lemmas", lemmas))]
        self._usual = self._named("usual", usual)

    def row(self, numbers: object) -> Bound:
        """The sum of one inequality of each target: the one that is named, or the usual one.

        Of the max-eigenvalue, which is no larger than that of any target, one inequality alone.
        """
        about, named = self._about, self._named("row", numbers)
        used = named if about.objective == "maxeig" else self._usual | named
        whole = len(used) == (1 if about.objective == "maxeig" else len(about.prior))
        need(whole, "upper proof: a row does not have one inequality of each target")
        terms = [(inequality.constant, self._scores_of(inequality)) for inequality in used.values()]
        self._terms += sum(1 + len(scores) for _, scores in terms)
        self._cells += len(about.owner)
        check_size("rows", self._terms, limits().terms)
        check_size("rows", self._cells, limits().scores)
        scores, constant = [fmpq(0)] * len(about.owner), fmpq(0)
        for summand, own in terms:
            tick()
            constant += summand
            for e, score in own.items():
                scores[e] += score
        for score in scores:
            hold(score)
        return Bound(scores, constant)

    def _scores_of(self, inequality: StatedTangent | StatedLemma) -> dict[int, fmpq]:
        """Scores, computed once and kept: rows share their inequalities."""
        if isinstance(inequality, StatedLemma):
            return inequality.scores
        if id(inequality) not in self._kept:
            found = self._kept[id(inequality)] = inequality.scores()
            self._cells += len(found)
            for score in found.values():
                hold(score)
        return self._kept[id(inequality)]

    def _named(self, where: str, numbers: object) -> dict[int, StatedTangent | StatedLemma]:
        """Inequalities by number, tangents first, as a record by target."""
        known, found = len(self.tangents), dict[int, StatedTangent | StatedLemma]()
        for number in array(where, numbers):
            k = index(where, number, known + len(self.lemmas))
            inequality = self.tangents[k] if k < known else self.lemmas[k - known]
            need(inequality.target not in found, f"upper proof: {where} names two inequalities of a target")
            found[inequality.target] = inequality
        return found

    def _lemma(self, number: int, given: object) -> StatedLemma:
        about, n = self._about, len(self._about.owner)
        target, elements, scores, stated, tree = fields("lemma", given, "target elements scores constant tree")
        j, constant = index("lemma target", target, len(about.prior)), exact("lemma constant", stated)
        scored = indices("lemma elements", elements, n)
        values = [exact("lemma scores", x) for x in array("lemma scores", scores, len(scored))]
        lemma = StatedLemma(j, dict(zip(scored, values, strict=True)), constant)
        least = least_constant(self.tangents, self.marginals, lemma, tree, options_of(about, lemma, self._seers(j)))
        need(least <= constant, f"upper proof: the tree of lemma {number} only proves {arb(least).str(17)}")
        return lemma


def options_of(about: Statement, lemma: StatedLemma, seers: tuple[int, ...]) -> Options:
    """Options of a set for each robot: an element that sees the target or has a score, or nothing (``None``)."""
    options: Options = {}
    for e in sorted({*seers, *lemma.scores}):
        options[about.owner[e]] = (*options.get(about.owner[e], ()), e)
    return {i: (*own, None) for i, own in options.items()}


def least_constant(
    tangents: list[StatedTangent],
    marginals: Callable[[], MarginalBounds],
    lemma: StatedLemma,
    tree: object,
    options: Options,
) -> Any:
    """Return the largest bound of the tree's leaves on ``phi_j(T) - scores(T)``; together they hold for every set."""
    bounds: list[Any] = []
    elements = tuple(e for own in options.values() for e in own if e is not None)

    def expand(node: object, case: Options) -> Iterator[Options]:
        if isinstance(node, dict) and "base" in node:
            (base,) = fields("lemma leaf", node, "base")
            of_base = indices("lemma leaf base", base, max(elements, default=-1) + 1)
            bound, gains = marginals().beyond(lemma.target, of_base, elements)
        elif isinstance(node, dict):
            yield from _below(node, case)
            return
        else:
            tangent = tangents[index("lemma leaf", node, len(tangents))]
            need(tangent.target == lemma.target, "upper proof: a leaf of a lemma is a tangent of another target")
            bound, gains = tangent.constant, tangent.scores()
        for own in case.values():
            bound += largest([ZERO if e is None else gains.get(e, ZERO) - lemma.scores.get(e, ZERO) for e in own])
        bounds.append(bound)

    walk("lemma", tree, options, expand)
    return largest(bounds)


def _below(node: object, case: Options) -> Iterator[Options]:
    """Yield the cases below a branch: one for each part, and one for the robot's other options."""
    robot, parts = fields("lemma branch", node, "element parts")
    i = index("lemma branch robot", robot, limits().robots)
    need(i in case, "upper proof: a lemma branches on a robot that does not see its target")
    blocks = [indices("lemma branch", part, 10**9) for part in array("lemma branch parts", parts)]
    named = [e for block in blocks for e in block]
    fits = all(blocks) and len(set(named)) == len(named) and set(named) <= set(case[i])
    need(fits, f"upper proof: the parts of robot {i} in a lemma are not of the elements left")
    for block in blocks:
        yield {**case, i: block}
    if rest := tuple(e for e in case[i] if e not in named):
        yield {**case, i: rest}
