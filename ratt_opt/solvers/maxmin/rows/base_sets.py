"""Inequalities by base sets: no set adds more to a base than the largest marginals of its elements beyond it.

    phi(T) <= phi(T + S) <= phi(S) + sum over e in T outside S of the largest marginal of e beyond a set that holds S.

If gains diminish, the marginal at ``S`` itself is the largest. Relies on information that is positive semidefinite:
what rounding left below zero is added to it first.
"""

from __future__ import annotations

from itertools import combinations
from typing import TYPE_CHECKING

import numpy as np

from ratt_opt.setfunctions.rounding_errors import UNIT
from ratt_opt.solvers.maxmin.proof import TargetLemma
from ratt_opt.solvers.maxmin.rows.inequalities import Inequalities, TargetInequality

if TYPE_CHECKING:
    from ratt_opt._validation import FloatArray, IntArray
    from ratt_opt.setfunctions.information import InformationObjective
    from ratt_opt.solvers.maxmin.elements import Task
    from ratt_opt.solvers.maxmin.params import RowParams

__all__ = ["base_set_inequalities", "first_of_each_class", "semidefinite"]

EIGENVALUES = 8
"""Roundings, of a matrix's size and for each dimension, by which computed eigenvalues may be off."""
CALL = 20
"""Operations of a marginal beside those of its matrices."""
BLOCK = 64
"""Base sets of one target whose marginals are computed at once."""


def semidefinite(information: FloatArray) -> FloatArray:
    """Information (E, M, d, d) no less than what is given, and no less than zero."""
    d = information.shape[-1]
    sizes = np.linalg.norm(information, axis=(-2, -1))
    missing = EIGENVALUES * d * UNIT * sizes - np.linalg.eigvalsh(information)[..., 0]
    missing[sizes == 0] = 0.0
    return np.asarray(information + np.maximum(missing, 0.0)[..., None, None] * np.eye(d))


def base_set_inequalities(task: Task, params: RowParams) -> list[Inequalities]:
    """Build inequalities of the empty set, of elements, and of pairs of those with most information on a target."""
    objective, error = task.objective, params.value_errors * task.problem.evaluation_error
    if not np.isfinite(error):  # nothing is known of differences of values
        return []
    information, first = semidefinite(objective.information), first_of_each_class(task)
    everything = task.objective.posterior_mixture(np.ones(objective.n))
    least = params.similar * objective.target_values(everything)
    every = (_of_target(objective, information[:, j], (j, first), params, error) for j in range(objective.n_targets))
    return [_without_similar(task, own, float(tolerance)) for own, tolerance in zip(every, least, strict=True)]


def first_of_each_class(task: Task) -> IntArray:
    """(E,) the element that a search takes for each: of equal ones a set has one, and is worth as much with another."""
    first = np.arange(task.objective.n)
    for classes in task.classes:
        for element, members in classes.items():
            first[members] = element
    return first


def _of_target(
    objective: InformationObjective,
    information: FloatArray,
    which: tuple[int, IntArray],
    params: RowParams,
    error: float,
) -> Inequalities:
    """Build the inequalities of one target; ``which`` : the target, and the element (E,) whose score each has."""
    target, first = which
    one = objective.of_target(target)
    seers = np.flatnonzero(information.any(axis=(-2, -1)))
    own, prior = information[seers], one.prior_information[0]
    alone = one.value((prior + own)[:, None])
    best = np.argsort(-alone, kind="stable")
    pairs = list(combinations(best[: params.paired].tolist(), 2))
    cost = objective.n_targets * max(len(seers), 1) * (objective.dimension**3 + CALL)
    most = int(min(params.most_bases / objective.n_targets, params.base_work / cost))
    bases: list[tuple[int, ...]] = [(), *((e,) for e in best.tolist()[: max(most - len(pairs), 0)])]
    bases += pairs[: max(most - len(bases), 0)]
    scores, constants = np.zeros((objective.n, len(bases))), np.zeros(len(bases))
    for k in range(0, len(bases), BLOCK):
        block = bases[k : k + BLOCK]
        points = np.array([prior + own[list(base)].sum(axis=0) for base in block])
        constants[k : k + BLOCK] = one.value(points[:, None]) + error
        marginals = one.marginals_beyond(points[:, None], own[:, None])[..., 0] + error
        for row, base in zip(marginals, block, strict=True):
            row[list(base)] = 0.0
        scores[seers, k : k + BLOCK] = marginals.T
    scores = scores[first]
    lemmas = (TargetLemma(target=target, constant=float(constants[k]), scores=scores[:, k]) for k in range(len(bases)))
    origins = tuple(TargetInequality(target=target, lemma=lemma) for lemma in lemmas)
    targets = np.full(len(bases), target, dtype=np.int64)
    return Inequalities(targets=targets, constants=constants, scores=scores, origins=origins)


def _without_similar(task: Task, of_target: Inequalities, least: float) -> Inequalities:
    """Inequalities of one target that for some plan's set are lower by more than ``least`` than each kept before."""
    constants, scores, kept = of_target.constants, of_target.scores, [0]
    order = np.argsort(task.problem.robot, kind="stable")
    starts = np.searchsorted(task.problem.robot[order], np.arange(task.problem.n_robots))
    for k in range(1, len(constants)):
        lower = np.maximum(scores[:, kept] - scores[:, k : k + 1], 0.0)[order]
        gains = constants[kept] - constants[k] + np.maximum.reduceat(lower, starts, axis=0).sum(axis=0)
        if gains.min() > least:
            kept.append(k)
    origins = tuple(of_target.origins[k] for k in kept)
    return Inequalities(
        targets=of_target.targets[kept], constants=constants[kept], scores=scores[:, kept], origins=origins
    )
