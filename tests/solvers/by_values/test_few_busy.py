"""Functions known by their values, few robots busy: brackets without enumeration against all plans."""

from dataclasses import replace

import numpy as np
import pytest

import ratt_opt as ro
from ratt_opt.budget import Budget
from ratt_opt.solvers.by_values import solve_by_values
from tests.solvers.test_at_most import best_by_definition, drawn


@pytest.mark.parametrize("kind", ["coverage", "table", "facilities"])
def test_values_alone_bracket_it_where_plans_are_not_enumerated(kind, monkeypatch):
    monkeypatch.setattr(solve_by_values, "_enumerated", lambda *_: None)
    for seed in range(12):
        problem = drawn(seed, robots=3 + seed % 2, kind="coverage")
        if kind == "table":
            problem = replace(problem, objective=ro.TableFunction(problem.objective.table()))
        if kind == "facilities":
            utility = np.random.default_rng(seed).integers(0, 5, (problem.objective.n, 4)).astype(np.float64)
            utility[::3] = 0.0
            problem = replace(problem, objective=ro.FacilityLocation(utility))
        found, best = solve_by_values.solve_by_values(problem, Budget()), best_by_definition(problem)
        problem.check_plan(found.elements)
        assert found.lower <= best + 1e-9 <= found.upper + 2e-9
