"""What no plan can exceed by monotonicity is a bound, and its proof is one; a search that found nothing has it."""

import numpy as np
import pytest

from ratt_opt import Attack, certify, exhaustive_optimum, random_scenario, solve_maxmin
from ratt_opt.solvers.maxmin.monotone_bound import monotone_bound
from tests.oracles import brute_force_optimum, groups_left
from tests.solvers.maxmin.proofs import proved_upper
from tests.strategies import OBJECTIVES, random_problem

KINDS = list(OBJECTIVES)


def some_attack(rng, problem) -> Attack:
    """A random one within the budgets."""
    robots = sorted(set(range(problem.n_robots)) - problem.protected_robots)
    links = sorted(problem.communication.links - problem.protected_links)
    cut = rng.permutation(len(links))[: rng.integers(0, problem.alpha_c + 1)]
    return Attack(
        frozenset(rng.permutation(robots)[: rng.integers(0, problem.alpha_s + 1)].tolist()),
        frozenset(links[k] for k in cut),
    )


@pytest.mark.parametrize("seed", range(150))
def test_it_is_a_bound_and_its_proof_proves_it(seed):
    rng = np.random.default_rng([61, seed])
    problem = random_problem(rng, int(rng.integers(1, 6)), kind=KINDS[seed % 3])
    optimum, attack = brute_force_optimum(problem), some_attack(rng, problem)
    found, slack = monotone_bound(problem, attack), 1e-10 * max(1.0, optimum)
    assert found.upper >= optimum - slack
    assert proved_upper(problem, found.proof) <= found.upper + slack
    left = {tuple(sorted(group - attack.sensing)) for group in groups_left(problem, attack.links)}
    most = max(problem.objective(np.flatnonzero(np.isin(problem.robot, group)).tolist()) for group in left)
    assert found.upper == pytest.approx(most, abs=slack)


@pytest.mark.parametrize("limits", [{"time_limit": 0}, {"time_limit": 0.001}, {"max_nodes": 1}])
@pytest.mark.parametrize("kind", KINDS)
def test_a_search_that_is_stopped_at_once_can_be_certified(kind, limits, tmp_path):
    for seed in range(6):
        rng = np.random.default_rng([62, seed])
        problem = random_problem(rng, int(rng.integers(1, 6)), kind=kind)
        result, best = solve_maxmin(problem, **limits), exhaustive_optimum(problem).lower
        written, slack = certify(problem, result, tmp_path / "c.json"), 1e-9 * max(1.0, best)
        assert written.verified.lower <= best + slack
        assert written.verified.upper >= best - slack
        assert 0 <= written.upper_raised <= slack


def test_the_attack_that_is_known_makes_it_lower():
    """By the team's own best elements with nobody attacking it was 276.6 here."""
    problem = random_scenario(20, 15, alpha_s=5, alpha_c=60, seed=1).problem()
    result = solve_maxmin(problem, time_limit=0)
    assert 0 < result.lower <= result.upper
    assert result.upper < problem.objective(range(problem.objective.n)) * (1 - 1e-6)
    assert problem.widen_by_rounding(0.0, monotone_bound(problem, result.worst_case.attack).upper)[1] == result.upper
