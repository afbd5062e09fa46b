"""Every published end holds the exact value of the matrices as given, whatever the prior's condition."""

import warnings
from dataclasses import replace

import numpy as np
import pytest

import ratt_opt as ro
from ratt_opt.coordinates.preparation import prepared
from ratt_opt.coordinates.unit_prior import with_unit_prior
from tests.exact_values import ExactValues, holds
from tests.strategies import OBJECTIVES

pytestmark = pytest.mark.usefixtures("exact_balls")

KINDS = ("trace", "logdet", "maxeig")
CONDITIONS = (0, 3, 6, 9, 12, 14)


def spread_prior(rng, d, digits):
    """A rotated prior whose variances lie up to so many digits apart."""
    turn = np.linalg.qr(rng.normal(size=(d, d)))[0]
    prior = (turn * 10.0 ** -np.linspace(0, digits, d)) @ turn.T * 10.0 ** rng.uniform(-2, 2)
    return (prior + prior.T) / 2


def spread_problem(seed, kind, digits, *, d=3, targets=2, alpha_c=1):
    """Three robots with two elements each, on a path or a triangle."""
    rng = np.random.default_rng([seed, digits, d])
    prior = np.array([spread_prior(rng, d, digits if j == 0 else rng.uniform(0, digits)) for j in range(targets)])
    rows = rng.normal(size=(6, targets, int(rng.integers(1, d + 1)), d)) * 10.0 ** rng.uniform(
        -2, 1.5, (6, targets, 1, 1)
    )
    information = np.swapaxes(rows, -1, -2) @ rows
    information = (information + np.swapaxes(information, -1, -2)) / 2
    output = {"output": rng.normal(size=(1, d))} if kind != "logdet" and seed % 3 == 2 else {}
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        objective = OBJECTIVES[kind](prior, information, rng.uniform(0.5, 2, targets), **output)
    return ro.Problem(objective, [0, 0, 1, 1, 2, 2], None, 1, alpha_c)


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("digits", CONDITIONS)
def test_no_value_is_further_from_the_exact_one_than_is_said(kind, digits):
    for seed in range(4 if kind == "maxeig" else 20):
        d = 2 + seed % 4
        problem = spread_problem(seed, kind, digits, d=min(d, 3) if kind == "maxeig" else d)
        exact, rng = ExactValues(problem), np.random.default_rng(seed)
        for searched in {
            id(p): p for p in (problem, with_unit_prior(problem), ro.measured_coordinates(problem), prepared(problem))
        }.values():
            for _ in range(3):
                chosen = [int(rng.choice(c)) for c in problem.choices if rng.random() < 0.7]
                value, error = searched.objective(chosen), searched.evaluation_error
                assert holds(value - error, exact(chosen), value + error)


def test_problems_with_one_criterion_share_a_change_of_coordinates():
    problem = spread_problem(0, "trace", 9)
    others = replace(problem, alpha_s=0), ro.measured_coordinates(problem)
    searched, *shared = map(prepared, (problem, *others))
    assert searched.objective is not problem.objective
    assert all(one.objective is searched.objective for one in shared)
    moved = prepared(replace(problem, robot=[0, 0, 1, 1, 1, 2]))  # of other owners: the error is another
    assert moved.objective is not searched.objective


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("digits", CONDITIONS)
@pytest.mark.parametrize("seed", range(3))
def test_every_end_of_every_public_call_holds_the_exact_value(kind, digits, seed):
    problem = spread_problem(seed, kind, digits, d=2 if seed == 1 else 3)
    exact = ExactValues(problem)
    best = exact.optimum()
    optima = [ro.solve_maxmin(problem), ro.exhaustive_optimum(problem), ro.solve_maxmin(problem, time_limit=0)]
    for found in optima:
        assert holds(found.lower, best, found.upper)
        assert holds(found.lower, exact.worst_case(found.elements), float("inf"))
    unattacked = ro.nonrobust_optimum(problem)
    calm = ExactValues(ro.Problem(problem.objective, problem.robot, None, 0, 0)).optimum()
    assert holds(unattacked.lower, calm, unattacked.upper)
    plan = optima[0].elements
    worst = exact.worst_case(plan)
    attacks = [ro.worst_case_attack(problem, plan), ro.worst_case_attack(problem, plan, time_limit=0)]
    attacks += [ro.greedy_attack(problem, plan), ro.bounded_rational_attack(problem, plan)]
    for found in (*attacks, ro.random_attack(problem, plan, seed=seed)):
        assert holds(found.lower, worst, found.upper)
        assert holds(0, exact.team(plan, found.attack), found.upper)
    better = ro.refined(problem, time_limit=None, max_kicks=3)
    assert holds(better.lower, exact.worst_case(better.elements), better.upper)
    links = ro.links_to_protect(problem, plan, 1)
    protected = ro.Problem(problem.objective, problem.robot, None, 1, 1, protected_links=links.links)
    assert holds(links.lower, ExactValues(protected).worst_case(plan), links.upper)
    for row in ro.criticality_ranking(problem, plan):
        threat = (
            {"protected_robots": [row.target]} if isinstance(row.target, int) else {"protected_links": [row.target]}
        )
        spared = ro.Problem(problem.objective, problem.robot, None, 1, 1, **threat)
        assert holds(row.gain_lower, ExactValues(spared).worst_case(plan) - worst, row.gain_upper)


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("digits", CONDITIONS)
def test_a_report_goes_no_further_than_its_certificate(kind, digits, tmp_path):
    problem = spread_problem(3, kind, digits)
    report = ro.bound(problem, certificate=tmp_path / "proof.json")
    exact = ExactValues(problem)
    best = exact.optimum()
    assert holds(report.optimum.lower, best, report.upper)
    for plan in report.plans:
        assert holds(plan.worst_case.lower, exact.worst_case(plan.elements), plan.worst_case.upper)
    proof = report.certificate.certificate
    assert proof is not None
    assert holds(proof.verified.lower, best, proof.verified.upper)
    assert report.optimum.lower <= proof.verified.lower
    assert report.optimum.upper >= proof.verified.upper
    assert report.recommended.worst_case.lower <= proof.verified.lower


@pytest.mark.parametrize("digits", [0, 3, 6, 9])
def test_brackets_are_narrow_where_the_prior_alone_is_ill_conditioned(digits):
    for seed in range(6):
        found = ro.solve_maxmin(spread_problem(seed, KINDS[seed % 2], digits, alpha_c=0))
        assert found.upper - found.lower <= 1e-6 * found.upper


@pytest.mark.parametrize("kind", KINDS)
def test_a_diffuse_prior_costs_no_digits_where_each_sighting_locates_its_target(kind):
    for seed in range(3):
        problem = spread_problem(3 * seed, kind, 0, d=2)
        f = problem.objective
        information = f.information + 0.01 * np.trace(f.information, axis1=-2, axis2=-1)[..., None, None] * np.eye(2)
        diffuse = ro.Problem(type(f)(1e8 * f.prior, information, f.weights), problem.robot, None, 1, 1)
        exact, plan = ExactValues(diffuse), ro.ratt(diffuse).elements
        found = ro.worst_case_attack(diffuse, plan)
        assert holds(found.lower, exact.worst_case(plan), found.upper)
        assert found.upper - found.lower <= 1e-10 * found.upper
