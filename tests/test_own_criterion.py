"""A user's own information criterion, defined here by a value and a supergradient alone, goes through the library."""

import networkx as nx
import numpy as np
import pytest

import ratt_opt as ro
from ratt_opt.setfunctions.information import InformationObjective
from tests.oracles import brute_force_optimum, brute_force_worst_case
from tests.setfunctions import oracle
from tests.strategies import information_data, random_elements


class RootObjective(InformationObjective):
    """``sum_j w_j [sqrt(tr prior_j) - sqrt(tr Lambda_j^{-1})]``: the decrease of the root mean square errors.

    Concave: with ``f = tr(L^{-1})``: ``sqrt(f) = exp(log(f) / 2)`` is convex in ``L``, because ``log f`` is.
    """

    __slots__ = ()

    def criterion(self, posterior_information):
        covariance = np.linalg.inv(posterior_information)
        return self.weights * np.sqrt(np.trace(covariance, axis1=-2, axis2=-1))

    def gradient(self, posterior_information):
        covariance = np.linalg.inv(posterior_information)
        half = self.weights / (2 * np.sqrt(np.trace(covariance, axis1=-2, axis2=-1)))
        return half[..., None, None] * (covariance @ covariance)


class ValueAlone(InformationObjective):
    """A criterion without supergradient."""

    __slots__ = ()

    criterion = RootObjective.criterion


def problem_of(seed: int, kind=RootObjective, robots: int | None = None) -> ro.Problem:
    rng = np.random.default_rng([40, seed])
    robots = robots or int(rng.integers(2, 6))
    owners = np.repeat(np.arange(robots), rng.integers(1, 4, robots))
    prior, information = information_data(rng, len(owners), int(rng.integers(1, 4)), int(rng.integers(1, 4)))
    graph = nx.cycle_graph(robots) if seed % 2 and robots > 2 else None
    objective = kind(prior, information, rng.uniform(0.5, 2, len(prior)))
    return ro.Problem(
        objective, owners, graph, int(rng.integers(0, robots)), int(rng.integers(0, 3)) if robots > 2 else 0
    )


@pytest.mark.parametrize("seed", range(20))
def test_the_gradient_is_a_supergradient(seed: int) -> None:
    f, rng = problem_of(seed).objective, np.random.default_rng(seed)
    here, there = (f.posterior_information(np.flatnonzero(rng.random(f.n) < 0.5)) for _ in range(2))
    assert f.value(there) <= f.value(here) + np.vdot(f.gradient(here), there - here) + 1e-9


@pytest.mark.parametrize("seed", range(30))
def test_the_search_finds_and_proves_the_optimum(seed: int) -> None:
    problem = problem_of(seed)
    best = ro.exhaustive_optimum(problem).lower
    assert best == pytest.approx(brute_force_optimum(problem), abs=1e-12)
    result = ro.solve_maxmin(problem)
    assert result.upper - result.lower <= 1e-8 * max(1.0, best)
    assert result.lower <= best + 1e-9 * max(1.0, best)
    assert result.upper >= best - 1e-9 * max(1.0, best)


@pytest.mark.parametrize("seed", range(30))
def test_the_worst_attack_is_the_worst(seed: int) -> None:
    problem = problem_of(seed)
    plan = random_elements(np.random.default_rng(seed), problem)
    result = ro.worst_case_attack(problem, plan)
    assert result.lower == result.upper == pytest.approx(brute_force_worst_case(problem, plan), abs=1e-12)
    assert problem.team_value(plan, result.attack) == result.upper


def test_a_team_that_is_too_large_to_enumerate_gets_a_bracket() -> None:
    problem = problem_of(4, robots=14)
    result = ro.solve_maxmin(problem, gap=1e-3, max_nodes=50)
    assert 0 < result.lower <= result.upper < problem.objective(range(problem.objective.n)) * (1 + 1e-12)
    assert ro.worst_case_attack(problem, result.elements).upper >= result.lower * (1 - 1e-9)


@pytest.mark.parametrize("seed", range(8))
def test_its_curvatures_hold_the_enumerated_ones(seed: int) -> None:
    problem = problem_of(seed, robots=3)
    f, owners = problem.objective, problem.robot
    values = [f([e for e in range(f.n) if mask >> e & 1]) for mask in range(2**f.n)]
    for measure in ("total_curvature", "curvature"):
        found = getattr(ro, measure)(f, owners)
        assert found.lower - 1e-9 <= getattr(oracle, measure)(values, owners) <= found.upper + 1e-9


@pytest.mark.parametrize(("seed", "robots"), [(7, 20), (6, 24)])
@pytest.mark.parametrize("measure", [ro.curvature, ro.total_curvature])
def test_curvatures_of_a_team_too_large_to_enumerate_are_bracketed(measure, seed: int, robots: int) -> None:
    problem = problem_of(seed, robots=robots)
    found = measure(problem.objective, problem.robot, time_limit=3.0)
    assert 0 <= found.lower <= found.upper <= 1


@pytest.mark.parametrize("seed", range(4))
def test_the_main_job_reports_it_without_a_certificate(seed: int, tmp_path) -> None:
    problem = problem_of(seed)
    report = ro.bound(problem, certificate=tmp_path / "c.json", time_limit=20.0)
    assert report.objective == "RootObjective"
    assert report.optimum.upper == pytest.approx(brute_force_optimum(problem), rel=1e-8, abs=1e-9)
    assert report.certificate.certificate is None
    assert "criteria have certificates" in report.certificate.why_not
    for plan in report.plans:
        assert plan.worst_case.upper == pytest.approx(brute_force_worst_case(problem, plan.elements), abs=1e-12)


def test_what_it_lacks_is_named(tmp_path) -> None:
    problem = problem_of(0)
    with pytest.raises(ro.InputError, match=r"must define fenchel_point\(point, target\).*; got RootObjective"):
        ro.certify(problem, ro.solve_maxmin(problem), tmp_path / "c.json")
    with pytest.raises(ro.InputError, match="must be trace, logdet or maxeig to be certified; got RootObjective"):
        ro.problem_document(problem)
    with pytest.raises(ro.InputError, match=r"must define conic_value\(posterior\).*; got RootObjective"):
        ro.relaxation_bound(ro.Problem(problem.objective, problem.robot, problem.graph, 0, 0), [ro.Attack()])
    without = problem_of(2, ValueAlone)
    with pytest.raises(ro.InputError, match=r"objective must define gradient\(posterior_information\)") as caught:
        ro.solve_maxmin(without)
    assert "\n" not in str(caught.value)
