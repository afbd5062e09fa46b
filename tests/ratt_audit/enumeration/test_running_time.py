"""Theorem 2: counts against the definition, lazy evaluation against plain greedy, fits of known laws."""

import numpy as np
import pytest

from ratt_audit.engine.decide import Verdict
from ratt_audit.enumeration.running_time import (
    count_orders,
    evaluation_bound,
    evaluation_count,
    fit_growth,
    lazy_greedy_picks,
    measured_growth,
)
from ratt_opt import InputError, Problem, SetFunction, TableFunction, random_scenario, ratt


class Counting(SetFunction):
    """An additive function that counts how many sets it is asked for."""

    def __init__(self, values: np.ndarray) -> None:
        self.values, self.asked = values, 0

    @property
    def n(self) -> int:
        return len(self.values)

    def evaluate(self, membership: np.ndarray) -> np.ndarray:
        self.asked += len(membership)
        return membership @ self.values


def test_every_order_of_picks_stays_within_the_square() -> None:
    assert count_orders(4).verdict is Verdict.PROVED


@pytest.mark.parametrize("sizes", [(3,), (2, 2, 2), (4, 1, 2), (1, 1, 1, 1)])
@pytest.mark.parametrize("alpha_s", [0, 1])
def test_reported_evaluations_are_what_the_function_was_asked(sizes: tuple[int, ...], alpha_s: int) -> None:
    owners = np.repeat(np.arange(len(sizes)), sizes)
    function = Counting(np.arange(1.0, len(owners) + 1))
    plan = ratt(Problem(function, owners, None, alpha_s, 0))
    assert plan.evaluations == function.asked
    greedy = [sizes[i] for i in range(len(sizes)) if i not in plan.bait]
    assert plan.evaluations <= evaluation_bound(len(owners), greedy) <= len(owners) ** 2


def test_the_bound_is_attained_by_equal_teams_and_by_small_robots_first() -> None:
    owners = np.repeat(np.arange(3), [1, 2, 3])
    values = np.array([9.0, 5, 4, 3, 2, 1])
    plan = ratt(Problem(TableFunction((np.arange(64)[:, None] >> np.arange(6) & 1) @ values), owners, None, 0, 0))
    assert plan.evaluations == evaluation_bound(6, [1, 2, 3]) == 6 + 2 + 3 + 3


@pytest.mark.parametrize("seed", range(6))
def test_lazy_evaluation_finds_ratt_s_plan_on_a_submodular_objective(seed: int) -> None:
    found = evaluation_count(random_scenario(6, 4, alpha_s=2, alpha_c=0, seed=seed).problem("logdet"))
    assert found.same_plan
    assert found.elements < found.lazy <= found.measured == found.bound


def test_lazy_evaluation_can_miss_greedy_s_choice_without_submodularity() -> None:
    """Element 2 gains beside element 0: its stale marginal is no upper bound."""
    values = np.array([0, 5, 4, 9, 1, 16, 5, 20], dtype=float)  # f(0,2) = 16: marginal 11 instead of 1
    problem = Problem(TableFunction(values), [0, 1, 1], None, 0, 0)
    picks, _ = lazy_greedy_picks(problem, np.arange(2))
    assert ratt(problem).elements.tolist() == [0, 2]
    assert picks.tolist() == [0, 1]


def test_a_power_law_is_recovered_and_bad_data_refused() -> None:
    x = np.array([10.0, 20, 40, 80])
    fit = fit_growth(x, 0.5 * x**1.7)
    assert (fit.factor, fit.exponent) == (pytest.approx(0.5), pytest.approx(1.7))
    assert fit.residual < 1e-9
    with pytest.raises(InputError, match="two different sizes"):
        fit_growth([3, 3], [1, 2])
    with pytest.raises(InputError, match="positive"):
        fit_growth([3, 4], [0, 2])


def test_the_measurement_states_both_exponents() -> None:
    counted = measured_growth(teams=(4, 6), seeds=(0,))
    assert counted.verdict is Verdict.NO_VIOLATION
    assert "plain greedy" in counted.detail
    assert "lazy" in counted.detail
