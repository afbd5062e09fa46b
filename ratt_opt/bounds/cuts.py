"""Linear upper bounds on the value of one group, valid for every plan.

All three criteria are concave in the posterior information ``Lambda``, and ``Lambda`` is linear in the elements chosen.
A supergradient at any point therefore bounds the value of every plan by a constant plus one score per chosen element:

    phi(elements of the group's robots) <= constant + sum over robots i of the group of scores[e_i].

Any convex combination of such bounds, over groups that attain the team value of attacks,
bounds the worst-case value of every plan; its largest value splits into one maximum a robot.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from ratt_opt._validation import FloatArray, IntArray
    from ratt_opt.choice_limit import ChoiceLimit
    from ratt_opt.problem import Problem

__all__ = ["GroupCut", "combined_bound", "largest_of_each", "mixed_information", "tangent_cut", "uniform_selection"]

ROUNDING = 64 * np.finfo(np.float64).eps
"""Relative margin added to every bound: sums of at most a few thousand terms lose less."""


@dataclass(frozen=True, slots=True, kw_only=True)
class GroupCut:
    """``phi(plan on group) <= constant + sum_{i in group} scores[e_i]`` for every plan.

    ``group`` : robots, ascending. ``scores`` : (E,), zero for robots outside the group.
    ``point`` : (M, d, d) posterior information ``Lambda`` at which the bound touches, from which a
    checker can derive it again (``Y = Lambda^{-1}`` in its Fenchel form). ``target`` : for the max-eigenvalue
    criterion, the target whose largest eigenvalue the bound is about.
    """

    group: tuple[int, ...]
    constant: float
    scores: FloatArray
    point: FloatArray
    target: int | None = None


def tangent_cut(problem: Problem, group: Iterable[int], point: FloatArray, target: int | None = None) -> GroupCut:
    """Bound the value of one group by the tangent at the posterior information ``point`` (M, d, d).

    ``target`` : for the max-eigenvalue criterion, the target to use; the worst one if ``None``.

    The criterion's own tangent: a Fenchel form that holds for any ``Y`` (``setfunctions/criteria``), so that an
    inexact point costs strength, never validity; for a criterion without one, value and supergradient there.
    """
    members, objective = tuple(sorted(group)), problem.information_objective
    if target is None:
        target = objective.tangent_targets(point, -np.inf, 1)[0]
    if not members:  # the value of no measurement is known exactly
        nothing = np.zeros(objective.n)
        return GroupCut(group=(), constant=objective([]), scores=nothing, point=point, target=target)
    tangent = objective.tangent(point, target)
    slope, offset = tangent.slope, tangent.offset
    team = np.zeros(problem.n_robots)
    team[list(members)] = 1.0
    scores = (objective.information.reshape(objective.n, -1) @ slope.ravel()) * team[problem.robot]
    prior_part = float(np.einsum("jkl,jkl->", slope, objective.prior_information))
    constant = offset + prior_part
    constant += ROUNDING * (abs(offset) + abs(prior_part) + float(np.abs(scores).max(initial=0.0)) * len(members))
    return GroupCut(group=members, constant=constant, scores=scores, point=point, target=target)


def combined_bound(
    constants: FloatArray,
    scores: FloatArray,
    weights: FloatArray,
    choices: Sequence[IntArray],
    limit: ChoiceLimit | None = None,
) -> tuple[float, FloatArray]:
    """Largest value of a convex combination of cuts over plans with elements in ``choices``.

    ``constants`` : (K,); scores : (K, E); weights : (K,) >= 0, not all zero (normalised here)
    ``choices`` : per robot, the elements that remain; ``limit`` : on how many robots are busy

    Returns the bound, and the (E,) combined scores it came from. If no plan is left it is 0, which all ends exceed.
    """
    share = weights / weights.sum()
    combined = share @ scores
    terms = _terms(combined, choices, limit)
    if terms is None:
        return 0.0, combined
    constant = float(share @ constants)
    magnitude = abs(constant) + float(np.abs(share * constants).sum()) + sum(map(abs, terms))
    return constant + sum(terms) + ROUNDING * magnitude, combined


def _terms(amounts: FloatArray, choices: Sequence[IntArray], limit: ChoiceLimit | None) -> list[float] | None:
    """The largest sum of amounts (E,) of a plan, robot by robot; ``None`` if there is no plan."""
    if limit is None:
        return list(largest_of_each(amounts, choices).tolist())
    best = limit.best_plan(amounts, choices)
    return None if best is None else list(amounts[best].tolist())


def largest_of_each(amounts: FloatArray, choices: Sequence[IntArray]) -> FloatArray:
    """(N,) largest of the amounts (E,) of each robot's elements; ``choices`` : per robot, at least one element."""
    starts = np.cumsum([0, *map(len, choices[:-1])])
    return np.asarray(np.maximum.reduceat(amounts[np.concatenate(choices)], starts))


def uniform_selection(problem: Problem) -> FloatArray:
    """(E,) every robot mixes its elements equally."""
    selection = np.empty(problem.objective.n)
    for choice in problem.choices:
        selection[choice] = 1 / len(choice)
    return selection


def mixed_information(problem: Problem, selection: FloatArray) -> FloatArray:
    """(N, M, d, d) information of each robot under weights (E,) of the elements of an information criterion."""
    information = problem.information_objective.information
    chosen = np.flatnonzero(selection)
    owner = np.zeros((problem.n_robots, len(chosen)))
    owner[problem.robot[chosen], np.arange(len(chosen))] = selection[chosen]
    flat = owner @ information[chosen].reshape(len(chosen), -1)
    return np.asarray(flat.reshape(-1, *information.shape[1:]))
