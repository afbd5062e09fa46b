"""Proofs by rows of single targets, made without the solver: small problems, lemmas of all kinds, spaced values."""

import json
from dataclasses import replace
from itertools import product
from types import SimpleNamespace

import numpy as np

from ratt_opt import CertificateParams, Problem, TraceObjective, exhaustive_optimum
from ratt_opt.certificates.target_trees import TargetTreeParams
from ratt_opt.certificates.upper import upper_record
from ratt_opt.certificates.write import write_certificate
from ratt_opt.solvers.maxmin.proof import TargetLemma
from tests.certificates.cases import one_leaf_per_plan

BASES = CertificateParams(lemmas=TargetTreeParams(plain=0))
"""Trees of log-dets have base sets at leaves, however few tangents would do."""


def touching(problem: Problem, target: int):
    """Elements that have information about a target."""
    return np.flatnonzero(problem.objective.information[:, target].any(axis=(-2, -1)))


def sets_of(problem: Problem, elements):
    """Every set of some elements with at most one of each robot."""
    own = [[None, *(e for e in elements if problem.robot[e] == i)] for i in range(problem.n_robots)]
    return [[e for e in chosen if e is not None] for chosen in product(*own)]


def target_value(problem: Problem, target: int, elements) -> float:
    """What a set is worth for one target; of the max-eigenvalue, if the target's posterior were the largest."""
    f, at = problem.objective, np.zeros(problem.objective.n)
    at[list(elements)] = 1.0
    after, before = (f.criterion(f.posterior_mixture(x))[target] for x in (at, np.zeros(f.n)))
    return float((f.prior_criterion if f.name == "maxeig" else before) - after)


def drawn_lemma(problem: Problem, rng, target: int) -> TargetLemma:
    """Scores around the marginals at some set, so that it is nearly tight there; the constant that sets need."""
    own = touching(problem, target)
    base = sets_of(problem, own)[int(rng.integers(len(sets_of(problem, own))))]
    scores = np.zeros(problem.objective.n)
    value = target_value(problem, target, base)
    for e in own:
        others = [x for x in base if problem.robot[x] != problem.robot[e]]
        if e in base:
            scores[e] = value - target_value(problem, target, others)
        else:
            scores[e] = target_value(problem, target, [*others, e]) - target_value(problem, target, others)
    scores[own] *= rng.choice([0.0, 0.5, 1.0, 1.0, 1.5], len(own))
    worst = max(target_value(problem, target, s) - scores[list(s)].sum() for s in sets_of(problem, own))
    return TargetLemma(target=target, constant=float(worst), scores=scores)


def by_rows(problem: Problem, rng):
    """A proof with one leaf for each plan, whose cuts are rows; for some targets lemmas that are tight at the plan.

    The max-eigenvalue has no rows in searches: its cuts stay.
    """
    proof = one_leaf_per_plan(problem)
    if problem.objective.name == "maxeig":
        return proof
    cuts = []
    for cut in proof.cuts:
        lemmas = tuple(
            tight_lemma(problem, cut.point[j], j) for j in range(problem.objective.n_targets) if rng.random() < 0.5
        )
        cuts.append(replace(cut, target=None, lemmas=lemmas, by_target=True))
    return replace(proof, cuts=tuple(cuts))


def tight_lemma(problem: Problem, point, target: int) -> TargetLemma:
    """The tangent of one target, as a lemma whose constant only a tree shows to be smaller."""
    f = problem.objective
    slope = f.of_target(target).gradient(point[None])[0]
    scores = np.einsum("eab,ab->e", f.information[:, target], slope)
    own = touching(problem, target)
    worst = max(target_value(problem, target, s) - scores[list(s)].sum() for s in sets_of(problem, own))
    return TargetLemma(target=target, constant=float(worst), scores=scores)


def covering(rng, *, robots=3, paths=2, targets=5, lost=1) -> Problem:
    """Coverage by paths: elements see targets well or not at all."""
    seen = rng.random((robots * paths, targets)) < 0.4
    information = np.where(seen, 1e4 * rng.uniform(0.5, 2, seen.shape), 0.0)[..., None, None]
    return Problem(
        TraceObjective(np.ones((targets, 1, 1)), information), np.repeat(np.arange(robots), paths), None, lost, 0
    )


def spaced(problem: Problem):
    """A proof by rows whose leaves only show somewhat more than the best value; its spacing closes the rest."""
    proof = one_leaf_per_plan(problem)
    cuts = tuple(replace(cut, target=None, by_target=True, point=cut.point * 0.8) for cut in proof.cuts)
    return replace(proof, cuts=cuts, spacing=SimpleNamespace(count=round))


def certified_by_rows(problem: Problem, proof, path, params=CertificateParams()):  # noqa: B008
    """A certificate of the exhaustive optimum by such a proof; returns it and its document."""
    best = exhaustive_optimum(problem)
    part = upper_record(problem, proof, best.upper, params)
    written = write_certificate(problem, best.elements, lower=best.lower, upper=best.upper, upper_part=part, path=path)
    return written, json.loads(path.read_text())
