"""The recipes of docs/contributors/recipes.md, done: a criterion, attacker, guarantee and sensor of one's own."""

import numpy as np
import pytest

import ratt_opt as ro
from ratt_opt.attack.heuristics import heuristic_result
from ratt_opt.attack.task import PlanValues
from ratt_opt.bounds.guarantees import NON_DECREASING
from ratt_opt.scenario.sensor import jacobian
from ratt_opt.setfunctions.criteria import registry
from ratt_opt.setfunctions.information import InformationObjective
from tests.brackets import attains
from tests.oracles import brute_force_worst_case


class RootTraceObjective(InformationObjective):
    """``sum_j w_j [tr(prior_j^{1/2}) - tr(Lambda_j(S)^{-1/2})]``: standard deviations instead of variances [m]."""

    name = "root"
    unit = "m"

    def criterion(self, posterior_information):
        return self.weights * (np.linalg.eigvalsh(posterior_information) ** -0.5).sum(axis=-1)

    def gradient(self, posterior_information):
        eigenvalues, vectors = np.linalg.eigh(posterior_information)
        scaled = vectors * (0.5 * eigenvalues**-1.5)[..., None, :]
        return self.weights[:, None, None] * (scaled @ np.swapaxes(vectors, -1, -2))


def test_recipe_a_criterion(monkeypatch):
    monkeypatch.setitem(registry.CRITERIA, "root", RootTraceObjective)
    problem = ro.random_scenario(3, 3, alpha_s=1, alpha_c=2, seed=0).problem("root")
    best, listed = ro.solve_maxmin(problem), ro.exhaustive_optimum(problem)
    assert best.lower == pytest.approx(listed.lower, rel=1e-9)
    assert best.upper == pytest.approx(listed.upper, rel=1e-8)
    plan = ro.ratt(problem).elements
    expected = brute_force_worst_case(problem, plan)
    assert ro.worst_case_attack(problem, plan).upper == pytest.approx(expected, rel=1e-9)


class BearingOnly(ro.Sensor):
    """A camera: no range, and no information along the line of sight."""

    def information(self, poses, targets):
        across = jacobian(poses[:, None], targets[None])[..., 1, :]
        return across[..., :, None] * across[..., None, :] / self.bearing_noise


def test_recipe_a_sensor():
    scenario = ro.random_scenario(3, 2, alpha_s=1, alpha_c=1, seed=0).replace(sensor=BearingOnly())
    objective = scenario.problem().objective
    assert np.linalg.matrix_rank(objective.information, tol=1e-12).max() == 1
    assert scenario.replace(alpha_s=0).sensor == scenario.sensor
    assert ro.bound(scenario).certified_ratio > 0


def loudest_attack(problem, elements):
    """Blind the robots that are linked to most others."""
    values = PlanValues(problem, elements)
    degree = [-len(problem.communication.links_of(i)) for i in range(problem.n_robots)]
    order = [int(i) for i in np.argsort(degree, kind="stable") if i not in problem.protected_robots]
    return heuristic_result(problem, values, ro.Attack(frozenset(order[: problem.alpha_s])))


def test_recipe_an_attacker():
    problem = ro.random_scenario(5, 3, alpha_s=2, alpha_c=3, seed=1).problem()
    plan = ro.ratt(problem).elements
    found, exact = loudest_attack(problem, plan), ro.worst_case_attack(problem, plan)
    assert found.lower == 0 <= exact.upper <= found.upper
    assert attains(problem, plan, found)
    assert len(found.attack.sensing) == 2


def nobody_attacks_bound(problem, *, c):
    """Where nobody attacks, greedy keeps ``1 - c``: its marginals are at least ``(1 - c)`` times any others'."""
    needs = (NON_DECREASING, "total curvature at most c", "no attacks")
    return ro.Guarantee(1 - c if problem.alpha_s == problem.alpha_c == 0 else 0.0, needs, "a recipe")


def test_recipe_a_guarantee():
    problem = ro.random_scenario(3, 2, alpha_s=0, alpha_c=0, seed=2).problem()
    c = ro.total_curvature(problem.objective, problem.robot)
    promised = nobody_attacks_bound(problem, c=c.upper)
    kept = ro.worst_case_attack(problem, ro.ratt(problem).elements).lower
    assert kept >= promised * ro.solve_maxmin(problem).upper * (1 - 1e-9)
    assert promised.hypotheses[-1] == "no attacks"
