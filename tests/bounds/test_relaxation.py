"""The conic relaxation: its re-derived bound is true, tight where convexity is, and never the solver's word."""

import networkx as nx
import numpy as np
import pytest

import ratt_opt as ro
from ratt_opt.bounds import relaxation
from ratt_opt.budget import Budget
from tests.oracles import all_attacks, brute_force_optimum
from tests.strategies import OBJECTIVES, information_data, random_problem


def attacks_of(problem, rng):
    """A handful of attacks within the budgets: the worst on some plans, and one at random."""
    plans = [ro.ratt(problem).elements, ro.random_plan(problem, seed=0).elements]
    every = list(all_attacks(problem))
    blinded, cut = every[rng.integers(len(every))]
    worst = [ro.worst_case_attack(problem, plan).attack for plan in plans]
    return [*worst, ro.Attack(frozenset(blinded), frozenset(cut))]


@pytest.mark.parametrize("kind", OBJECTIVES)
@pytest.mark.parametrize("seed", range(12))
def test_no_plan_exceeds_the_bound(kind, seed):
    rng = np.random.default_rng([seed, 4])
    problem = random_problem(rng, int(rng.integers(2, 5)), kind=kind)
    bound = relaxation.relaxation_bound(problem, attacks_of(problem, rng))
    best = brute_force_optimum(problem)
    assert bound.upper >= best - 1e-9 * max(1.0, best)
    if problem.communication.is_complete and bound.status == "optimal":
        assert bound.upper >= bound.claimed - 1e-6 * max(1.0, abs(bound.claimed))


@pytest.mark.parametrize("kind", OBJECTIVES)
def test_solver_and_re_derived_bound_agree_on_one_group(kind):
    """Without link attacks one group is left, the program is convex, and both sides must meet.

    The re-derived bound is exact at the solver's point and errs by the distance of that point from the optimum, to
    first order: about the root of the solver's tolerance of 1e-10, times slopes of less than 1.
    """
    for seed in range(5):
        rng = np.random.default_rng(seed)
        prior, information = information_data(rng, 12, 3, 2)
        objective = OBJECTIVES[kind](prior, information)
        problem = ro.Problem(objective, np.repeat(np.arange(4), 3), None, 1, 0)
        attacks = [ro.Attack(frozenset({i}), frozenset()) for i in range(4)]
        bound = relaxation.relaxation_bound(problem, attacks)
        assert bound.upper == pytest.approx(bound.claimed, rel=5e-6)


def test_a_lying_solver_gives_a_weak_bound_never_a_false_one(monkeypatch):
    rng = np.random.default_rng(1)
    problem = random_problem(rng, 4, kind="trace", complete=True)
    best = brute_force_optimum(problem)
    attacks = attacks_of(problem, rng)
    honest = relaxation.relaxation_bound(problem, attacks).upper
    wrong = np.zeros(problem.objective.n)
    wrong[[choice[-1] for choice in problem.choices]] = 1.0
    monkeypatch.setattr(relaxation, "_solve", lambda *_: (-1.0, wrong, "optimal"))
    lied = relaxation.relaxation_bound(problem, attacks)
    assert lied.claimed == -1.0
    assert lied.upper >= max(best, honest) - 1e-9


def test_what_it_cannot_bound_is_refused():
    table = ro.Problem(ro.TableFunction([0, 1, 1, 2]), [0, 1], None, 1, 0)
    nobody = ro.Attack(frozenset(), frozenset())
    with pytest.raises(ro.InputError, match="criterion of information matrices"):
        relaxation.relaxation_bound(table, [nobody])
    prior, information = information_data(np.random.default_rng(0), 3, 1)
    problem = ro.Problem(ro.TraceObjective(prior, information), [0, 1, 2], nx.path_graph(3), 1, 1)
    with pytest.raises(ro.InputError, match="at least one attack"):
        relaxation.relaxation_bound(problem, [])
    with pytest.raises(ro.InputError, match="at most alpha_s = 1"):
        relaxation.relaxation_bound(problem, [ro.Attack(frozenset({0, 1}), frozenset())])


@pytest.mark.parametrize("kind", OBJECTIVES)
@pytest.mark.parametrize("seed", range(4))
def test_relaxing_over_all_attacks_is_the_root_of_the_search(kind, seed):
    """Two independent ways: conic programs with outcomes by enumeration; linear cuts with outcomes by attacks."""
    problem = ro.random_scenario(7, 6, alpha_s=2, alpha_c=6, seed=seed).problem(kind)
    bounds = list(ro.relaxation_bounds(problem))
    best = ro.solve_maxmin(problem)
    assert all(bound.upper >= best.lower * (1 - 1e-12) for bound in bounds)
    root = ro.solve_maxmin(problem, max_nodes=1)
    if root.stop is ro.Stop.NODES:
        assert root.upper == pytest.approx(bounds[-1].upper, rel=1e-3 if kind == "maxeig" else 1e-5)
    else:
        assert bounds[-1].upper >= root.lower * (1 - 1e-12)


def test_relaxing_over_all_attacks_needs_a_list_of_them():
    with pytest.raises(ro.InputError, match="at most 20000 outcomes"):
        next(ro.relaxation_bounds(ro.random_scenario(30, 2, alpha_s=10, alpha_c=108, seed=0).problem()))
    with pytest.raises(ro.InputError, match="criterion of information matrices"):
        next(ro.relaxation_bounds(ro.Problem(ro.TableFunction([0, 1]), [0], None, 0, 0)))


def test_a_spent_budget_ends_the_rounds():
    problem = random_problem(np.random.default_rng(1), 3, kind="trace")
    budget = Budget()
    rounds = ro.relaxation_bounds(problem, budget=budget)
    assert next(rounds).upper >= ro.exhaustive_optimum(problem).lower
    budget.interrupt()
    assert list(rounds) == []
