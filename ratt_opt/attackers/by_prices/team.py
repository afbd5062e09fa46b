"""A plan as arrays for the compiled loops."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from ratt_opt.attack.team import has_loops
from ratt_opt.setfunctions.information import triangles

if TYPE_CHECKING:
    from ratt_opt._validation import BoolArray, FloatArray, IntArray
    from ratt_opt.setfunctions.base import SetFunction

__all__ = ["PricedTeam"]


class PricedTeam(NamedTuple):
    """What the robots see under one plan; symmetric matrices packed by rows of the lower triangle, T = d (d + 1) / 2.

    ``code`` : the criterion's ``compiled_code``; ``weights`` : (M,); ``prior`` : (M, T) prior information;
    ``information`` : (N, M, T); ``baseline`` : the criterion without measurements; ``single`` : (N,) individual values
    """

    code: int
    weights: FloatArray
    prior: FloatArray
    information: FloatArray
    baseline: float
    single: FloatArray

    @classmethod
    def of(cls, objective: SetFunction, plan: IntArray) -> PricedTeam | None:
        """The compact form, or ``None`` where the objective has no compiled code."""
        if not has_loops(objective):
            return None
        assert objective.compiled_code is not None
        prior, information = triangles(objective.prior_information), triangles(objective.information[plan])
        baseline = float(objective.combine(objective.criterion(objective.prior_information)))
        empty = np.zeros(objective.n, dtype=np.bool_)
        single = np.array([objective.evaluate(_only(empty, e))[0] for e in plan])
        return cls(objective.compiled_code, np.array(objective.weights), prior, information, baseline, single)


def _only(empty: BoolArray, element: int) -> BoolArray:
    row = empty[None].copy()
    row[0, element] = True
    return row
