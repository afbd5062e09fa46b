"""What is known of a plan from quick attacks."""

from __future__ import annotations

import pytest

import ratt_opt as ro
from ratt_opt.budget import Budget
from ratt_opt.solvers.maxmin.adversary import Adversary
from ratt_opt.solvers.maxmin.outcome_pool import OutcomePool


def test_criteria_without_compiled_code_are_attacked_too():
    class Own(ro.TraceObjective):
        compiled_code = None  # as in a criterion of one's own

    shown = ro.network_scenario("disk-6", 16, 3, alpha_s=3, alpha_c=6, seed=0).problem()
    own = Own(shown.objective.prior, shown.objective.information)
    problem = ro.Problem(own, shown.robot, shown.graph, shown.alpha_s, shown.alpha_c)
    assert Adversary(problem, OutcomePool(problem), Budget()).learn(ro.greedy(problem).elements)


@pytest.mark.parametrize("family", ["hubs", "small-world", "disk-12"])
def test_the_known_outcomes_of_a_plan_on_a_network_are_nearly_its_worst(family):
    """Greedy attacks alone are 5 % milder on hubs and small worlds."""
    problem = ro.network_scenario(family, 20, 10, alpha_s=0.25, alpha_c=0.25, seed=1).problem()
    pool = OutcomePool(problem)
    adversary, plan = Adversary(problem, pool, Budget()), ro.greedy(problem).elements
    while adversary.learn(plan):
        pass
    exact = ro.worst_case_attack(problem, plan)
    assert exact.lower <= pool.plan_value(plan) <= 1.02 * exact.upper
