"""The max-min problem as one mixed-integer conic model: what one would write without this library.

Every non-dominated outcome is a constraint, every element a binary, and which group of an outcome wins another. For
two-dimensional targets the trace criterion needs second-order cones only: with ``m`` half the trace and ``r``
the distance of the eigenvalues from it, ``tr(L^-1) = 1 / (m - r) + 1 / (m + r)``, which grows with ``r``.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
import scipy.sparse as sp

from ratt_opt.graph.outcomes import non_dominated_outcomes
from ratt_opt.setfunctions.information import InformationObjective

if TYPE_CHECKING:
    from ratt_opt._validation import FloatArray
    from ratt_opt.problem import Problem

__all__ = ["ConicAnswer", "solve_conic_model"]


@dataclass(frozen=True, slots=True, kw_only=True)
class ConicAnswer:
    """What the solver reports: the best plan's value and its bound on all plans' (not checked)."""

    status: str
    lower: float
    upper: float


def solve_conic_model(problem: Problem, seconds: float) -> ConicAnswer:
    """Build the trace criterion's model in cvxpy and solve it with SCIP, stopped after ``seconds``."""
    import cvxpy as cp

    objective = problem.objective
    assert isinstance(objective, InformationObjective)
    outcomes = list(non_dominated_outcomes(problem.threat))
    groups = sorted({group for outcome in outcomes for group in outcome}, key=sorted)
    number = {group: k for k, group in enumerate(groups)}
    chosen = cp.Variable(objective.n, boolean=True)
    level = cp.Variable()
    value, radii = _group_values(problem, objective, groups, chosen)
    constraints: list[Any] = [cp.sum(chosen[own]) == 1 for own in problem.choices]
    rows = [(o, number[group]) for o, outcome in enumerate(outcomes) for group in outcome]
    outcome_of, group_of = (np.array(column) for column in zip(*rows, strict=True))
    wins = cp.Variable(len(rows), boolean=True)
    which = sp.csr_matrix((np.ones(len(rows)), (outcome_of, np.arange(len(rows)))))
    most = float(objective(range(objective.n)))  # by monotonicity no value exceeds it, so it switches any row off
    constraints += [radii, which @ wins == 1, level <= value[group_of] + most * (1 - wins)]
    data, _, _ = cp.Problem(cp.Maximize(level), constraints).get_problem_data(cp.SCIP)
    return _run_scip(data, seconds)


def _run_scip(data: dict[str, Any], seconds: float) -> ConicAnswer:
    """Load cvxpy's standard form ``min c'x, Ax + s = b, s in K`` row by row; its own loader takes minutes."""
    from pyscipopt import Model, quicksum

    model = Model()
    model.hideOutput()
    model.setParam("timing/clocktype", 1)  # processor time
    model.setParam("limits/time", seconds)
    binary = set(data["bool_vars_idx"])
    x = [model.addVar(vtype="B" if k in binary else "C", lb=None, obj=float(v)) for k, v in enumerate(data["c"])]
    rows, bounds, dims = data["A"].tocsr(), data["b"], data["dims"]
    slack = [
        float(b) - quicksum(float(v) * x[k] for k, v in zip(row.indices, row.data, strict=True))
        for b, row in zip(bounds, (rows[[i]] for i in range(len(bounds))), strict=True)
    ]
    for k, expression in enumerate(slack[: dims.zero + dims.nonneg]):
        model.addCons(expression == 0 if k < dims.zero else expression >= 0)
    start = dims.zero + dims.nonneg
    for size in dims.soc:
        cone = [model.addVar(lb=0.0 if k == 0 else None) for k in range(size)]
        for variable, expression in zip(cone, slack[start : start + size], strict=True):
            model.addCons(variable == expression)
        model.addCons(quicksum(v * v for v in cone[1:]) <= cone[0] * cone[0])
        start += size
    model.optimize()
    found = model.getNSols() > 0
    return ConicAnswer(
        status=model.getStatus(), lower=-model.getPrimalbound() if found else float("-inf"), upper=-model.getDualbound()
    )


def _group_values(
    problem: Problem, objective: InformationObjective, groups: list[frozenset[int]], chosen: Any
) -> tuple[Any, Any]:
    """(G,) concave expressions that are each group's value if the second, a constraint, is tight."""
    import cvxpy as cp

    inside = np.array([np.isin(problem.robot, sorted(group)) for group in groups])
    entries = [_entry(objective, inside, row, column) for row, column in ((0, 0), (0, 1), (1, 1))]
    a, b, c = (matrix @ chosen + constant for matrix, constant in entries)
    middle, half = (a + c) / 2, (a - c) / 2
    radius = cp.Variable(a.size)
    inverse = cp.inv_pos(middle - radius) + cp.inv_pos(middle + radius)
    weights = np.tile(objective.weights, len(groups))
    total = sp.kron(sp.eye(len(groups)), np.ones((1, objective.n_targets)))
    prior = float(objective.criterion(objective.prior_information).sum())
    return prior - total @ cp.multiply(weights, inverse), cp.norm(cp.vstack([half, b]), 2, axis=0) <= radius


def _entry(objective: InformationObjective, inside: FloatArray, row: int, column: int) -> tuple[Any, FloatArray]:
    """One entry of every group's and target's information, as an affine function of the elements chosen."""
    information = objective.information[:, :, row, column].T  # (M, E)
    matrix = sp.csr_matrix(np.concatenate([information * members for members in inside]))
    return matrix, np.tile(objective.prior_information[:, row, column], len(inside))
