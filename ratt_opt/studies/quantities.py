"""Quantities measured once per trial, whatever the planners: brackets of the optimum and guarantees."""

from __future__ import annotations

from decimal import ROUND_FLOOR, Context, Decimal
from functools import cache
from typing import TYPE_CHECKING

import numpy as np

from ratt_opt.bounds.guarantees import pattern_free_bound, theorem1_bound
from ratt_opt.curvatures.curvature import curvature, total_curvature
from ratt_opt.setfunctions.criteria.logdet import LogDetObjective
from ratt_opt.setfunctions.criteria.trace import TraceObjective
from ratt_opt.solvers.ratt import equivalent_sensing_attacks
from ratt_opt.worst_ratio.ratio import worst_case_ratio

if TYPE_CHECKING:
    from collections.abc import Callable

    from ratt_opt.studies.cases import Cell
    from ratt_opt.studies.instance import Instance

__all__ = ["QUANTITIES"]


def _optimum(instance: Instance) -> dict[str, Cell]:
    """Return the certified bracket of the optimum, and why the search stopped."""
    result = instance.optimum
    return {"optimum/lower": result.lower, "optimum/upper": result.upper, "optimum/stop": result.stop.value}


def _trace_bound(instance: Instance) -> dict[str, Cell]:
    """Return what no plan's trace per target [m^2] can fall below under its worst attack; trace objective only."""
    objective = instance.objective
    assert isinstance(objective, TraceObjective)
    left = objective.criterion(objective.posterior_information(np.array([], dtype=np.int64))).sum()
    return {"optimum/trace_bound": float(left - instance.optimum.upper) / len(objective.prior)}


def _guarantees(instance: Instance) -> dict[str, Cell]:
    """Return the curvature bracket over feasible sets, and what is guaranteed at its conservative end.

    The curvature is ``k`` for the log-determinant, which is submodular, and the total curvature ``c`` otherwise.
    ``ratio`` is the smallest ratio over all set functions of that class and curvature, with the instance's
    team and budgets on the complete graph.
    """
    problem, submodular = instance.problem, isinstance(instance.objective, LogDetObjective)
    found = (curvature if submodular else total_curvature)(instance.objective, problem.robot)
    named = {"k" if submodular else "c": found.upper}
    alpha_cs = equivalent_sensing_attacks(problem)
    all_bait = problem.alpha_s + alpha_cs >= problem.n_robots
    family = "submodular" if submodular else "nondecreasing"
    budgets = (problem.n_robots, problem.alpha_s, problem.alpha_c)
    return {
        "curvature/lower": found.lower,
        "curvature/upper": found.upper,
        "theorem1": float(theorem1_bound(alpha_cs, all_bait=all_bait, **named)),
        "pattern_free": float(pattern_free_bound(**named)),
        "ratio": _smallest_ratio(*budgets, str(curvature_class(found.upper)), family),
    }


def curvature_class(upper: float) -> Decimal:
    """Return a curvature at least ``upper`` whose distance to 1 has two digits.

    The smallest ratio does not grow with the curvature, so the one of this larger class is still guaranteed;
    a sweep meets few classes, which are solved once.
    """
    down = Context(prec=2, rounding=ROUND_FLOOR)
    return 1 - down.subtract(Decimal(1), Decimal(upper))


@cache
def _smallest_ratio(n_robots: int, alpha_s: int, alpha_c: int, bound: str, family: str) -> float:
    return worst_case_ratio(n_robots, alpha_s, alpha_c, curvature=bound, family=family, domain="feasible").lower


QUANTITIES: dict[str, Callable[[Instance], dict[str, Cell]]] = {
    "optimum": _optimum,
    "trace_bound": _trace_bound,
    "guarantees": _guarantees,
}
