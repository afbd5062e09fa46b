"""Losses and gains of mixtures of a robot's elements, and the division of its elements.

A relaxed plan mixes elements. At its level ``t`` all cuts with a multiplier are tight, and a robot that takes one
element ``e`` of its mixture while the others do not adapt lowers cut ``k`` by ``sum_e' z_e' s_ke' - s_ke``. (The
*combined* scores say nothing here: at an optimum all elements in a mixture have the same.) What the robot loses at
least, for any element that it takes, is about what deciding it takes off the bound:

    loss_i = min over e in the mixture of max_k [ sum_e' z_e' s_ke' - s_ke ].

If cuts do not tell elements apart, the criteria do: they are concave, so a mixture is worth more to a group than
its elements on average, over groups ``k`` with weights ``w_k`` by

    gain_i = sum_k w_k [ value_k(Lambda_k) - sum_e z_e value_k(Lambda_k + I_e - sum_e' z_e' I_e') ].
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from ratt_opt._validation import BoolArray, FloatArray, IntArray
    from ratt_opt.problem import Problem
    from ratt_opt.setfunctions.information import InformationObjective

__all__ = ["divide_by_scores", "divide_elements", "mixing_gains", "rounding_losses"]


def _is_mixed(weights: FloatArray) -> BoolArray:
    """Test which elements are part of a mixture: not nearly all or nothing of their robot's choice."""
    return (weights > 1e-6) & (weights < 1 - 1e-6)


def rounding_losses(choices: Sequence[IntArray], selection: FloatArray, scores: FloatArray) -> FloatArray:
    """(N,) what some cut loses at least when a robot takes one element of its mixture.

    ``selection`` : (E,) weights of elements, summing to one for each robot; scores : (E, K) of the tight cuts
    """
    losses = np.zeros(len(choices))
    if not scores.shape[1]:
        return losses
    for i, choice in enumerate(choices):
        mixed = choice[_is_mixed(selection[choice])]
        if len(mixed) > 1:
            mean = selection[mixed] @ scores[mixed] / selection[mixed].sum()
            losses[i] = (mean - scores[mixed]).max(axis=1).min()
    return losses


def divide_by_scores(
    choice: IntArray, selection: FloatArray, scores: FloatArray, weights: FloatArray
) -> tuple[IntArray, IntArray]:
    """Divide a robot's elements between the two of largest weight, each with those of the most similar scores.

    ``scores`` : (E, K) of cuts; weights : (K,) of their squared differences
    """
    return _divided(choice, selection, lambda seed: ((scores[choice] - scores[seed]) ** 2) @ weights)


def mixing_gains(
    problem: Problem,
    *,
    selection: FloatArray,
    inside: BoolArray,
    points: FloatArray,
    weights: FloatArray,
    targets: Sequence[int | None],
) -> FloatArray:
    """(N,) gain of each robot's mixture of elements.

    ``selection`` : (E,) weights of elements, summing to one for each robot
    ``inside`` : (K, N) which robots are in each group; ``points`` : (K, M, d, d) information of each group
    ``weights`` : (K,) weight of each group in the bound
    ``targets`` : for max-eigenvalue, the target each group is bounded by
    """
    objective, gains = problem.information_objective, np.zeros(problem.n_robots)
    if not len(weights):
        return gains
    support = np.flatnonzero(_is_mixed(selection))
    owners = problem.robot[support]
    before = objective.cut_values(points, targets)
    for i in np.unique(owners).tolist():
        own, rows = support[owners == i], np.flatnonzero(inside[:, i])
        if not len(rows) or len(own) < 2:
            continue
        share = selection[own] / selection[own].sum()
        information = objective.information[own]
        change = information - np.tensordot(share, information, axes=1)
        own_targets = [targets[k] for k in rows.tolist()]
        after = objective.cut_values(points[rows, None] + change[None], own_targets)
        gains[i] = weights[rows] @ (before[rows] - after @ share)
    return gains


def divide_elements(
    objective: InformationObjective, choice: IntArray, selection: FloatArray, point: FloatArray
) -> tuple[IntArray, IntArray]:
    """Divide a robot's elements between the two of largest weight, each with those nearest to it.

    Distances are measured in the curvature of the criterion at the posterior information ``point`` (M, d, d).
    """
    covariance = np.linalg.inv(point)

    def distances(seed: int) -> FloatArray:
        scaled = covariance @ (objective.information[choice] - objective.information[seed])
        return np.asarray(np.einsum("ejkl,ejlm,jmk,j->e", scaled, scaled, covariance, objective.weights))

    return _divided(choice, selection, distances)


def _divided(
    choice: IntArray, selection: FloatArray, distances: Callable[[int], FloatArray]
) -> tuple[IntArray, IntArray]:
    """Elements between the two of largest weight; ``distances`` : of all of them from one."""
    order = np.argsort(-selection[choice], kind="stable")
    near = distances(choice[order[0]]) <= distances(choice[order[1]])
    near[order[1]] = False
    return choice[near], choice[~near]
