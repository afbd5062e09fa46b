"""Best plans by covers: against every plan and attack, where robots see few targets."""

from itertools import product
from pathlib import Path

import numpy as np
import pytest

from ratt_opt import (
    Problem,
    certify,
    limited_view_scenario,
    solve_maxmin,
    worst_case_attack,
)
from ratt_opt.solvers.maxmin.covers.pool import cover_bound
from ratt_opt.solvers.maxmin.covers.separation import Separation
from ratt_opt.solvers.maxmin.elements import Elements
from ratt_opt.solvers.maxmin.proof import Cover
from tests.oracles import brute_force_worst_case
from tests.solvers.maxmin.engine import COVERS_ALONE, NO_PLANS_LISTED, covers
from tests.strategies import sparse_problem
from tests.ways import Way, go

CASES = 40


def all_plans(problem: Problem) -> list[tuple[int, ...]]:
    return list(product(*(choice.tolist() for choice in problem.choices)))


@pytest.fixture
def by_covers_alone(monkeypatch: pytest.MonkeyPatch) -> None:
    """No other search runs, and covers are looked for however much robots see."""
    go(monkeypatch, COVERS_ALONE)


@pytest.mark.usefixtures("by_covers_alone")
@pytest.mark.parametrize(("kind", "dimension"), [("trace", 2), ("logdet", 2), ("trace", 3), ("logdet", 3)])
def test_covers_alone_find_and_prove_the_best_plan(kind: str, dimension: int, tmp_path: Path):
    proved = 0
    for seed in range(CASES):
        problem = sparse_problem(np.random.default_rng([seed, dimension]), kind, dimension)
        optimum = max(brute_force_worst_case(problem, np.array(plan)) for plan in all_plans(problem))
        found = solve_maxmin(problem)
        scale = max(1e-3, problem.objective(range(problem.objective.n)))
        slack = 1e-12 * scale + 2 * problem.evaluation_error
        assert found.lower == pytest.approx(optimum, rel=1e-9, abs=slack)
        assert optimum - slack <= found.upper <= optimum + 2e-9 * scale + slack
        if found.proof is not None and found.proof.covers:
            proved += 1
            certificate = certify(problem, found, tmp_path / "c.json")
            assert certificate.verified.upper <= optimum + 1e-6 * scale
    assert proved > CASES // 3


@pytest.mark.parametrize("dimension", [16, 64, 65])
@pytest.mark.parametrize("kind", ["trace", "logdet"])
def test_states_of_many_coordinates(kind: str, dimension: int, monkeypatch: pytest.MonkeyPatch):
    """The loops have up to 64; beyond, concave relaxations are alone."""
    go(monkeypatch, NO_PLANS_LISTED)
    for seed in range(3):
        problem = sparse_problem(np.random.default_rng([seed, dimension]), kind, dimension)
        optimum = max(brute_force_worst_case(problem, np.array(plan)) for plan in all_plans(problem))
        found = solve_maxmin(problem, max_nodes=20)
        assert found.lower <= optimum * (1 + 1e-9) + 1e-12
        assert found.upper >= optimum * (1 - 1e-9) - 1e-12


@pytest.mark.usefixtures("by_covers_alone")
@pytest.mark.parametrize("limits", [covers(covers=4), covers(recorded=8)], ids=["covers", "nodes"])
def test_forgetting_covers_and_searches_makes_no_bracket_false(limits: Way, monkeypatch: pytest.MonkeyPatch):
    go(monkeypatch, limits)
    for seed in range(CASES // 2):
        problem = sparse_problem(np.random.default_rng([seed, 2]), "trace")
        optimum = max(brute_force_worst_case(problem, np.array(plan)) for plan in all_plans(problem))
        found = solve_maxmin(problem, max_nodes=300)
        assert found.lower <= optimum * (1 + 1e-9) + 1e-12
        assert found.upper >= optimum * (1 - 1e-12) - 1e-12


def fails(problem: Problem, cover: Cover, plan: tuple[int, ...]) -> bool:
    """Whether a plan counts less than the cover asks for, by its definition."""
    chosen = {i for i, e in enumerate(plan) if e in cover.left_out}
    can_be_blinded = problem.n_robots - len(problem.protected_robots)
    return not chosen & problem.protected_robots and len(chosen) <= min(problem.alpha_s, can_be_blinded)


@pytest.mark.parametrize("kind", ["trace", "logdet"])
def test_a_plan_that_fails_a_cover_is_worth_no_more_than_its_bound(kind: str):
    failing = 0
    for seed in range(CASES):
        rng = np.random.default_rng([seed, 5])
        problem = sparse_problem(rng, kind)
        values = {plan: brute_force_worst_case(problem, np.array(plan)) for plan in all_plans(problem)}
        elements = Elements(problem)
        separation = Separation(elements.problem)
        top = max(values.values())
        for level in top * rng.uniform(0.3, 1.1, 4):
            share = rng.random(elements.problem.objective.n)
            separation.violated(share, level, separation.enough)
            plan = np.array([rng.choice(choice) for choice in elements.problem.choices])
            attack = worst_case_attack(elements.problem, plan)
            if attack.upper <= level:
                separation.from_attack(plan, attack.attack, level)
        for k in range(len(separation.pool)):
            cover = separation.stated(k, elements)
            bound = cover_bound(problem, cover)
            assert bound <= separation.pool.level[k] * (1 + 1e-9) + 1e-9
            own = [value for plan, value in values.items() if fails(problem, cover, plan)]
            failing += len(own)
            assert max(own, default=-np.inf) <= bound + 1e-12 * max(top, 1.0)
    assert failing > 1000


def test_covers_close_what_concave_relaxations_leave_open(tmp_path: Path):
    problem = limited_view_scenario(6, 8, alpha_s=2, alpha_c=4, seed=0, view=57.0, communication_range=45.0).problem(
        "trace"
    )
    found = solve_maxmin(problem, gap=1e-6)
    assert found.proof is not None
    assert found.proof.covers
    assert found.upper - found.lower <= 1e-6 * found.upper
    assert certify(problem, found, tmp_path / "c.json").upper_raised <= 1e-6 * found.upper


@pytest.mark.usefixtures("by_covers_alone")
def test_a_limit_of_nodes_leaves_a_true_bracket():
    for seed in range(4):
        problem = limited_view_scenario(5, 6, alpha_s=1, alpha_c=2, seed=seed).problem("trace")
        whole = solve_maxmin(problem)
        for nodes in (1, 3, 10):
            part = solve_maxmin(problem, max_nodes=nodes)
            assert part.lower <= whole.upper * (1 + 1e-9)
            assert part.upper >= whole.lower * (1 - 1e-9)
