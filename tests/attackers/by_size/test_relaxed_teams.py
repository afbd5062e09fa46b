"""What groups of possible sizes leave is never above the worst case, on any graph."""

from __future__ import annotations

from contextlib import suppress

import numpy as np
import pytest

import ratt_opt as ro
from ratt_opt.attack.least_sets.packed_team import PackedTeam
from ratt_opt.attackers.by_size.relaxed_teams import PossibleGroups
from ratt_opt.attackers.task import AttackBracket, AttackTask, PlanValues
from ratt_opt.budget import Budget, OutOfBudget
from tests.oracles import brute_force_worst_case
from tests.strategies import OBJECTIVES, random_elements, random_problem


def _task(problem, plan, budget=None):
    attack = ro.Attack()
    bracket = AttackBracket(attack, problem.team_value(plan, attack), -np.inf, problem.objective.rounding)
    return AttackTask(problem, PlanValues(problem, plan), bracket, Budget() if budget is None else budget)


def _bounded(problem, plan, budget=None, least=0):
    """The bracket after the bound, and the seeing robots left in some group."""
    task, groups = _task(problem, plan, budget), PossibleGroups(PackedTeam.planar(problem.objective, plan), least)
    if PossibleGroups.apply(task) and not task.bracket.is_closed:
        groups.bound(task)
        if groups.has_sets:
            groups.ask(task)
    return task.bracket, groups.least


@pytest.mark.parametrize("name", OBJECTIVES)
@pytest.mark.parametrize("seed", range(40))
def test_no_attack_leaves_less(name, seed):
    rng = np.random.default_rng([seed, 4])
    problem = random_problem(rng, kind=name)
    plan = random_elements(rng, problem)
    bracket, _ = _bounded(problem, plan)
    assert bracket.lower <= brute_force_worst_case(problem, plan) * (1 + 1e-9) + 1e-9


@pytest.mark.parametrize("seed", range(5))
def test_on_a_complete_graph_it_is_the_worst_case(seed):
    problem = ro.random_scenario(8, 4, alpha_s=1 + seed % 3, alpha_c=10 + 2 * seed, seed=seed).problem()
    plan = ro.ratt(problem).elements
    bracket, _ = _bounded(problem, plan)
    assert bracket.lower == pytest.approx(ro.worst_case_attack(problem, plan).upper, rel=1e-8)


@pytest.mark.parametrize(("seed", "alpha_s", "alpha_c"), [(0, 3, 11), (2, 3, 11), (2, 5, 17), (3, 3, 12), (3, 5, 17)])
def test_on_dense_networks_it_is_the_worst_case(seed, alpha_s, alpha_c):
    """Groups of possible sizes alone are worth 1 to 6 % less: sets that attacks cannot leave are ruled out."""
    problem = ro.network_scenario("dense", 14, 6, alpha_s=alpha_s, alpha_c=alpha_c, seed=seed).problem()
    plan = np.array([choice[0] for choice in problem.choices])
    bracket, size = _bounded(problem, plan)
    worst = ro.worst_case_attack(problem, plan)
    assert bracket.lower == pytest.approx(worst.upper, rel=1e-8)
    groups = problem.groups_left(worst.attack)
    assert 1 < size <= max(len(group - worst.attack.sensing) for group in groups)


def test_spent_time_and_interrupts_claim_nothing():
    problem = ro.network_scenario("dense", 24, 5, alpha_s=5, alpha_c=30, seed=1).problem()
    plan = np.array([choice[0] for choice in problem.choices])
    interrupted = Budget()
    interrupted.interrupt()
    for budget in (Budget(time_limit=0.0), interrupted):
        task, team = _task(problem, plan, budget), PackedTeam.planar(problem.objective, plan)
        with suppress(OutOfBudget):
            PossibleGroups(team, 3).bound(task)
        assert task.bracket.lower == -np.inf
