"""Any set function, known by its values alone: brackets hold against brute force, values are counted and checked."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import ratt_opt as ro
from tests.attack.engine import NO_TABLES
from tests.oracles import brute_force_optimum, brute_force_worst_case
from tests.solvers.maxmin.engine import NO_PLANS_LISTED, open_nodes
from tests.strategies import (
    SEEDED,
    Opaque,
    Submodular,
    information_data,
    problems_by_value,
)
from tests.ways import go


@pytest.fixture
def nothing_is_enumerated(monkeypatch):
    """As for problems too large for it."""
    go(monkeypatch, NO_PLANS_LISTED)
    go(monkeypatch, NO_TABLES)


LIMITS = [{}, {"time_limit": 0}, {"max_evaluations": 0}, {"max_evaluations": 7}, {"max_evaluations": 60}]


def check_brackets(problem, limits):
    found, best = ro.solve_maxmin(problem, **limits), brute_force_optimum(problem)
    assert found.lower <= brute_force_worst_case(problem, found.elements) + 1e-9
    assert found.lower - 1e-9 <= best <= found.upper + 1e-9
    attack = ro.worst_case_attack(problem, found.elements, **limits)
    worst = brute_force_worst_case(problem, found.elements)
    assert attack.lower - 1e-9 <= worst <= attack.upper + 1e-9
    assert problem.team_value(found.elements, attack.attack) == attack.upper


@pytest.mark.usefixtures("nothing_is_enumerated")
@SEEDED
@given(problems_by_value(), st.sampled_from(LIMITS))
def test_brackets_of_what_is_too_large_to_enumerate_hold(problem, limits):
    check_brackets(problem, limits)


@SEEDED
@given(problems_by_value(), st.sampled_from(LIMITS))
def test_brackets_of_what_is_enumerated_hold(problem, limits):
    check_brackets(problem, limits)


@SEEDED
@given(problems_by_value())
def test_small_problems_are_solved(problem):
    found = ro.solve_maxmin(problem)
    assert found.stop is ro.Stop.EXHAUSTED
    assert found.lower == found.upper == brute_force_optimum(problem)


@pytest.mark.usefixtures("nothing_is_enumerated")
@SEEDED
@given(problems_by_value(), st.sampled_from([1, 3, 10, 40]))
def test_brackets_hold_at_every_node_count(problem, nodes):
    check_brackets(problem, {"max_nodes": nodes})


@pytest.fixture
def attacks_are_exact(monkeypatch):
    """Only plans are too many to be enumerated."""
    go(monkeypatch, NO_PLANS_LISTED)


@pytest.mark.usefixtures("attacks_are_exact")
@SEEDED
@given(problems_by_value(largest=5))
def test_what_is_not_enumerated_is_divided_until_it_closes(problem):
    """Once it ended as heuristic with most of its time left, and 60 % open at ten robots."""
    found = ro.solve_maxmin(problem, time_limit=600)
    assert found.stop in {ro.Stop.CLOSED, ro.Stop.EXHAUSTED}
    assert found.lower == pytest.approx(brute_force_optimum(problem), abs=1e-9)
    assert found.upper == pytest.approx(found.lower, abs=1e-9)


@pytest.mark.usefixtures("attacks_are_exact")
@settings(SEEDED, max_examples=20)
@given(problems_by_value(largest=5), st.integers(1, 4))
def test_plans_beyond_what_is_kept_by_bounds_are_divided_last_first(problem, most):
    with pytest.MonkeyPatch.context() as patch:
        go(patch, open_nodes(most))
        found = ro.solve_maxmin(problem, time_limit=600)
    assert found.lower == pytest.approx(brute_force_optimum(problem), abs=1e-9)
    assert found.upper == pytest.approx(found.lower, abs=1e-9)


@settings(SEEDED, max_examples=4)
@given(st.integers(21, 60), st.integers(0, 99))
def test_a_large_team_is_searched_until_its_values_or_nodes_are_spent(robots, seed):
    rng = np.random.default_rng(seed)
    prior, information = information_data(rng, 3 * robots, 2)
    f = Opaque(ro.TraceObjective(prior, information))
    problem = ro.Problem(f, np.repeat(np.arange(robots), 3), None, robots // 5, robots)
    assert ro.solve_maxmin(problem, max_evaluations=1500).stop is ro.Stop.EVALUATIONS


ALWAYS = 16
"""Values that are asked for whatever the limit: both ends, one of each of ten groups, a scale."""


@settings(SEEDED, max_examples=30)
@given(st.integers(0, 400), st.integers(0, 20), st.integers(2, 10), st.booleans())
def test_values_are_counted_and_limited(limit, cut, robots, is_known):
    f = (Submodular if is_known else Opaque)(ro.ConcaveOfModular(np.arange(3.0 * robots), np.sqrt))
    owners = np.repeat(np.arange(robots), 3)
    problem = ro.Problem(f, owners, None, robots // 3, min(cut, robots * (robots - 1) // 2))
    for search in (
        lambda: ro.solve_maxmin(problem, max_evaluations=limit),
        lambda: ro.worst_case_attack(problem, 3 * np.arange(robots), max_evaluations=limit),
        lambda: ro.nonrobust_optimum(problem, max_evaluations=limit),
        lambda: ro.total_curvature(f, owners, max_evaluations=limit),
        lambda: ro.curvature(f, max_evaluations=limit),
        lambda: ro.submodularity_ratio(f, owners, max_evaluations=limit),
    ):
        f.asked = 0
        search()
        assert f.asked <= limit + ALWAYS
    f.asked = 0
    found = ro.find_monotonicity_violation(f, max_evaluations=limit)
    assert not found
    assert f.asked <= limit + ALWAYS


@pytest.mark.parametrize(
    ("bad", "text"),
    [
        (lambda v: np.where(v > 2, np.nan, v), "finite values.*nan for the set"),
        (lambda v: np.where(v > 2, np.inf, v), "finite values.*inf for the set"),
        (lambda v: v[:, None], "one number for each of"),
        (lambda v: v[:1] if len(v) > 1 else v[:, None], "one number for each of"),
        (lambda v: v.astype(complex), "one number for each of"),
    ],
)
def test_values_that_are_no_numbers_are_refused_at_the_call_that_produced_them(bad, text):
    class Wrong(Opaque):
        def evaluate(self, membership):
            return bad(super().evaluate(membership))

    f = Wrong(ro.Modular([1.0] * 8))
    problem = ro.Problem(f, np.repeat(np.arange(4), 2), None, 1, 2)
    for call in (
        lambda: ro.solve_maxmin(problem),
        lambda: ro.exhaustive_optimum(problem),
        lambda: ro.worst_case_attack(problem, [0, 2, 4, 6]),
        lambda: ro.ratt(problem),
        lambda: ro.find_submodularity_violation(f),
        lambda: ro.total_curvature(f),
        lambda: f(range(8)),
        f.table,
    ):
        with pytest.raises(ro.InputError, match=text):
            call()


@SEEDED
@given(problems_by_value(), st.data())
def test_small_functions_that_fall_are_refused_with_the_witness(problem, data):
    values = problem.objective.f.table().copy()
    top = problem.choices[0][0]
    values[1 << int(top)] = -1.0 - data.draw(st.integers(0, 3))  # below nothing at all
    falling = replace(problem, objective=ro.TableFunction(values))
    with pytest.raises(ro.InputError, match=r"must be non-decreasing.*changes it by -"):
        ro.solve_maxmin(falling)


@settings(SEEDED, max_examples=6)
@given(st.integers(21, 40), st.data())
def test_large_modular_teams_without_link_attacks_close(robots, data):
    """Their worst case is known: the strongest are blinded."""
    weights = np.array([data.draw(st.integers(0, 5)) for _ in range(robots)], dtype=float)
    blinded = data.draw(st.integers(0, robots))
    problem = ro.Problem(Submodular(ro.Modular(weights)), np.arange(robots), None, blinded, 0)
    attack = ro.worst_case_attack(problem, np.arange(robots))
    truth = np.sort(weights)[: robots - blinded].sum()
    assert attack.lower == attack.upper == truth
    assert ro.solve_maxmin(problem).upper == truth


@pytest.mark.parametrize(("robots", "blinded", "links"), [(26, 6, 0), (40, 10, 10)])
def test_what_attacks_leave_open_of_a_plan_is_not_called_closed(robots, blinded, links):
    """Nothing is limited, and attacks on teams of unknown values end unproved; the first robot has two elements."""
    value = np.random.default_rng(0).uniform(1, 2, robots + 1)
    f = ro.ConcaveOfModular(value)
    found = ro.solve_maxmin(ro.Problem(Opaque(f), np.append(np.arange(robots), 0), None, blinded, links))
    first = 0 if value[0] >= value[-1] else robots
    best = sorted([first, *range(1, robots)], key=lambda e: value[e])[: robots - blinded]
    assert found.stop is ro.Stop.HEURISTIC
    assert found.lower < f(best) <= found.upper


@pytest.mark.parametrize("n_robots", [8, 9])
@pytest.mark.parametrize("seed", range(4))
def test_a_limited_search_proves_what_an_attack_on_ratt_s_plan_alone_does(n_robots, seed):
    """With twice the values that close that attack: the share it has first must do for it."""
    prior, information = information_data(np.random.default_rng(seed), 8 * n_robots, 4, 3)
    objective = Opaque(ro.TraceObjective(prior, information))
    problem = ro.Problem(objective, np.repeat(np.arange(n_robots), 8), None, 2, 4)
    most = 3 * 2**n_robots
    alone = ro.worst_case_attack(problem, ro.ratt(problem).elements, max_evaluations=most // 2)
    found = ro.solve_maxmin(problem, max_evaluations=most)
    assert alone.stop is ro.Stop.EXHAUSTED
    assert found.lower >= alone.lower


@pytest.mark.parametrize("n_robots", [21, 40])
@pytest.mark.parametrize("seed", range(3))
def test_a_short_search_proves_what_individual_values_prove_of_ratt_s_plan(n_robots, seed):
    """Where values are few, they are asked for first of all: plans begin with them and bounds need no others."""
    rng = np.random.default_rng(seed)
    prior, information = information_data(rng, 6 * n_robots, 4, 3)
    problem = ro.Problem(
        Opaque(ro.TraceObjective(prior, information)), np.repeat(np.arange(n_robots), 6), None, n_robots // 4, n_robots
    )
    alone = ro.worst_case_attack(problem, ro.ratt(problem).elements, max_evaluations=10 * n_robots)
    found = ro.solve_maxmin(problem, max_evaluations=2 * 6 * n_robots)
    assert found.lower >= alone.lower > 0
