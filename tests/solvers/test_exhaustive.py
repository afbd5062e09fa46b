"""The exhaustive optimum against the definition: every plan, every sensing subset, every link subset."""

import numpy as np
import pytest

from ratt_opt import InputError, Problem, Stop, TableFunction, TraceObjective, exhaustive_optimum, worst_case_attack
from ratt_opt.budget import Budget
from tests.oracles import brute_force_optimum, brute_force_worst_case
from tests.strategies import information_data, random_problem, range_bearing


@pytest.mark.parametrize("seed", range(300))
def test_equals_the_definition(seed: int) -> None:
    rng = np.random.default_rng([2, seed])
    problem = random_problem(rng, int(rng.integers(1, 5)))
    result = exhaustive_optimum(problem)
    expected = brute_force_optimum(problem)
    scale = max(1.0, abs(expected))
    assert 0 <= result.upper - result.lower <= 3 * problem.evaluation_error
    assert result.upper == pytest.approx(expected, abs=1e-9 * scale)
    assert brute_force_worst_case(problem, result.elements) == pytest.approx(expected, abs=1e-9 * scale)
    assert result.stop is Stop.EXHAUSTED


@pytest.mark.parametrize(("alpha_s", "alpha_c"), [(1, 3), (1, 4), (2, 3), (2, 4), (4, 0), (0, 6), (4, 6)])
def test_small_comparison_of_the_paper(alpha_s: int, alpha_c: int) -> None:
    prior, information = range_bearing(np.random.default_rng(5), 4, 4, 4)
    problem = Problem(TraceObjective(prior, information), np.repeat(np.arange(4), 4), None, alpha_s, alpha_c)
    result = exhaustive_optimum(problem)
    attack = worst_case_attack(problem, result.elements)
    assert (result.lower, result.upper) == (attack.lower, attack.upper)
    assert result.nodes == 4**4
    assert (result.lower == 0) == (alpha_s == 4)


def test_the_first_of_equal_plans_is_returned() -> None:
    result = exhaustive_optimum(Problem(TableFunction(np.zeros(16)), [1, 0, 0, 1], None, 0, 0))
    assert result.elements.tolist() == [1, 0]


def test_too_many_plans_are_refused() -> None:
    prior, information = information_data(np.random.default_rng(0), 96, 1)
    problem = Problem(TraceObjective(prior, information), np.repeat(np.arange(8), 12), None, 1, 1)
    with pytest.raises(InputError, match="use solve_maxmin"):
        exhaustive_optimum(problem)


@pytest.mark.parametrize("calls", range(6))
def test_an_interrupt_returns_the_bracket_so_far(calls: int, monkeypatch: pytest.MonkeyPatch) -> None:
    problem = random_problem(np.random.default_rng([4, calls]), 4, kind="trace")
    optimum = exhaustive_optimum(problem)
    evaluate, asked = TraceObjective.evaluate, iter(range(calls))

    def interrupted(self: TraceObjective, membership: np.ndarray) -> np.ndarray:
        if len(membership) > 1 and next(asked, None) is None:
            raise KeyboardInterrupt
        return evaluate(self, membership)

    monkeypatch.setattr(TraceObjective, "evaluate", interrupted)
    outer = Budget()
    result = exhaustive_optimum(problem, budget=outer)
    assert result.lower <= optimum.lower
    assert (
        optimum.upper
        <= result.upper
        <= problem.widen_by_rounding(0.0, problem.objective(range(problem.objective.n)))[1]
    )
    assert result.stop is (outer.stop() or Stop.EXHAUSTED)


def test_a_spent_budget_returns_what_monotonicity_proves() -> None:
    problem = random_problem(np.random.default_rng(4), 3, kind="trace")
    result = exhaustive_optimum(problem, budget=Budget(time_limit=0))
    assert 0 < result.lower <= brute_force_worst_case(problem, result.elements)
    assert result.upper == problem.widen_by_rounding(0.0, problem.objective(range(problem.objective.n)))[1]
    assert result.stop is Stop.TIME
