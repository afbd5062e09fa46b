"""Covers: conditions that every plan worth more than a level meets.

Cut some links. Of each group that is left keep elements such that no choice of kept ones is worth more than the level.
Take a plan of which at most ``alpha_s`` robots choose an element that is left out. Blind these robots: what the
others choose is kept, and robots that are blinded add nothing, so no group is worth more than the level. Hence

    a plan worth more has at least ``alpha_s + 1`` robots with an element that is left out.

A robot that is protected cannot be blinded, so one such robot with an element left out is enough: its elements count
``alpha_s + 1`` times. That a group is worth no more is shown by one tangent: a constant and, robot by robot, the
largest score of a kept element, or 0.

Source: combinatorial Benders cuts (Codato and Fischetti 2006), lifted.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from ratt_opt._values import ByValue
from ratt_opt.bounds.cuts import ROUNDING, tangent_cut

if TYPE_CHECKING:
    from ratt_opt._validation import BoolArray, FloatArray
    from ratt_opt.problem import Attack, Problem

__all__ = ["Cover", "cover_bound"]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class Cover(ByValue):
    """What one attack cannot afford to leave.

    ``attack`` : on links only; ``left_out`` : elements, ascending; ``points`` : for each group that the attack leaves,
    by lowest robot, the posterior information (M, d, d) where its tangent touches
    """

    attack: Attack
    left_out: tuple[int, ...]
    points: tuple[FloatArray, ...]


def cover_bound(problem: Problem, cover: Cover) -> float:
    """No plan that fails the cover is worth more under the attacks that it stands for."""
    kept = np.ones(problem.objective.n, dtype=np.bool_)
    kept[list(cover.left_out)] = False
    groups = sorted(map(sorted, problem.groups_left(cover.attack)))
    return max(_kept_bound(problem, group, kept, point) for group, point in zip(groups, cover.points, strict=True))


def _kept_bound(problem: Problem, group: list[int], kept: BoolArray, point: FloatArray) -> float:
    """No choice of kept elements of a group is worth more."""
    cut = tangent_cut(problem, tuple(group), point)
    largest = np.zeros(problem.n_robots)
    np.maximum.at(largest, problem.robot[kept], cut.scores[kept])
    total = float(largest.sum())
    return cut.constant + total + ROUNDING * (abs(cut.constant) + total)
