"""Annealed attacks on set functions known by their values keep the budgets, and find what greedy steps do not."""

from dataclasses import replace

import numpy as np
import pytest

import ratt_opt as ro
from ratt_opt import Problem
from tests.attack.engine import searched


class Seen(ro.SetFunction):
    """Weight of the places that somebody sees, and a little of its square: grows, and is not submodular."""

    def __init__(self, n: int, seed: int) -> None:
        rng = np.random.default_rng([7, seed])
        self.sees, self.weight = rng.random((n, 40)) < 0.08, rng.random(40)
        self.asked = 0

    @property
    def n(self) -> int:
        return len(self.sees)

    def evaluate(self, membership):
        self.asked += len(membership)
        seen = (membership.astype(np.int64) @ self.sees > 0) @ self.weight
        return seen + 0.02 * seen**2


def drawn(n_robots: int, family: str, seed: int) -> Problem:
    """Seeing robots on a network, some of them and some links protected."""
    base = ro.network_scenario(family, n_robots, 2, alpha_s=0.2, alpha_c=0.3, seed=seed).problem()
    rng = np.random.default_rng([8, seed])
    held = frozenset(link for link in sorted(base.communication.links) if rng.random() < 0.1)
    sure = frozenset(i for i in range(n_robots) if rng.random() < 0.1)
    own = {"protected_robots": sure, "protected_links": held}
    return replace(base, objective=Seen(n_robots, seed), robot=np.arange(n_robots), **own)


@pytest.mark.parametrize("seed", range(3))
def test_finds_the_worst_attack_of_few_robots(seed: int) -> None:
    problem = drawn(9, ("disk-6", "hubs", "small-world")[seed % 3], seed)
    plan = np.arange(9)
    bracket, _, _ = searched("annealed values", problem, plan)
    problem.check_attack(bracket.attack)
    worst = ro.worst_case_attack(problem, plan)
    assert worst.stop in {ro.Stop.CLOSED, ro.Stop.EXHAUSTED}
    assert bracket.upper == pytest.approx(worst.upper, rel=1e-12)
    assert problem.team_value(plan, bracket.attack) == pytest.approx(bracket.upper, rel=1e-12)


def test_finds_worse_attacks_than_greedy_steps_on_networks() -> None:
    better = 0
    for seed in range(2):
        problem = drawn(24, "disk-6", seed)
        plan = np.arange(24)
        greedy = ro.greedy_attack(problem, plan).upper
        asked = problem.objective.asked
        found = ro.worst_case_attack(problem, plan, max_evaluations=3_000)
        assert problem.objective.asked <= asked + 3_100
        problem.check_attack(found.attack)
        assert found.upper <= greedy
        better += found.upper < 0.99 * greedy
    assert better >= 1
