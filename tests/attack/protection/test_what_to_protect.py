from dataclasses import replace

import networkx as nx
import numpy as np
import pytest

import ratt_opt as ro
from tests.attack.engine import watch
from tests.interrupts import interrupted_at
from tests.oracles import brute_force_worst_case
from tests.strategies import random_elements, random_problem


@pytest.mark.parametrize("seed", range(25))
def test_ranking_against_the_definition(seed):
    rng = np.random.default_rng(seed)
    problem = random_problem(rng, int(rng.integers(1, 5)))
    elements = random_elements(rng, problem)
    ranking = ro.criticality_ranking(problem, elements)
    links = problem.communication.links
    assert {row.target for row in ranking} == {*range(problem.n_robots), *links}
    base = brute_force_worst_case(problem, elements)
    nothing = replace(problem, alpha_s=0, alpha_c=0, protected_robots=frozenset(), protected_links=frozenset())
    whole = brute_force_worst_case(nothing, elements)
    for row in ranking:
        if isinstance(row.target, int):
            safer = replace(problem, protected_robots=problem.protected_robots | {row.target})
            attack = ro.Attack(frozenset([row.target]))
            alone = replace(nothing, alpha_s=1)
        else:
            safer = replace(problem, protected_links=problem.protected_links | {row.target})
            attack = ro.Attack(links=frozenset([row.target]))
            alone = replace(nothing, alpha_c=1)
        gain = brute_force_worst_case(safer, elements) - base
        assert row.gain_lower == pytest.approx(gain, abs=1e-9)
        assert row.gain_upper == pytest.approx(gain, abs=1e-9)
        assert row.loss == pytest.approx(whole - alone.team_value(elements, attack), abs=1e-9)
    gains = [row.gain_lower for row in ranking]
    assert gains == sorted(gains, reverse=True)


def test_a_bridge_is_the_link_to_protect():
    weights = np.arange(2**6)[:, None] >> np.arange(6) & 1
    graph = nx.barbell_graph(3, 0)
    problem = ro.Problem(ro.TableFunction(weights.sum(axis=1).astype(float)), np.arange(6), graph, 0, 1)
    first = ro.criticality_ranking(problem, np.arange(6))[0]
    assert (first.target, first.loss, first.gain_lower) == ((2, 3), 3.0, 3.0)
    only = ro.criticality_ranking(problem, np.arange(6), links=[(0, 1)])
    assert [row.target for row in only if not isinstance(row.target, int)] == [(0, 1)]
    with pytest.raises(ro.InputError, match="link"):
        ro.criticality_ranking(problem, np.arange(6), links=[(0, 5)])


@pytest.mark.parametrize("seed", range(25))
def test_smallest_budgets_against_every_budget(seed):
    rng = np.random.default_rng(seed)
    problem = random_problem(rng, int(rng.integers(1, 5)))
    elements = random_elements(rng, problem)
    free = replace(problem, alpha_s=0, alpha_c=0)
    goal = brute_force_worst_case(free, elements) * float(rng.choice([0.3, 0.6, 0.9, 1.0])) - 1e-9
    n_links = len(problem.communication.links)
    below = {
        (s, c)
        for s in range(problem.n_robots + 1)
        for c in range(n_links + 1)
        if brute_force_worst_case(replace(problem, alpha_s=s, alpha_c=c), elements) < goal
    }
    minimal = {b for b in below if not any(o != b and o[0] <= b[0] and o[1] <= b[1] for o in below)}
    found = ro.breaking_budgets(problem, elements, goal)
    assert {(b.alpha_s, b.alpha_c) for b in found} == minimal
    for budget in found:
        assert budget.is_proved
        asked = replace(problem, alpha_s=budget.alpha_s, alpha_c=budget.alpha_c)
        assert budget.value == asked.widen_by_rounding(0.0, asked.team_value(elements, budget.attack))[1] < goal


@pytest.mark.parametrize("seed", range(40))
def test_what_an_open_attack_supports(seed):
    """Attacks that a limit leaves open: brackets of gains hold the truth, and nothing open counts as exhausted."""
    rng = np.random.default_rng([seed, 7])
    problem = random_problem(rng, int(rng.integers(2, 6)))
    elements = random_elements(rng, problem)
    limits = [{"max_nodes": 1}, {"max_nodes": 3}, {"time_limit": 0}][seed % 3]
    base = brute_force_worst_case(problem, elements)
    for row in ro.criticality_ranking(problem, elements, **limits):
        one = {row.target}
        safer = (
            replace(problem, protected_robots=problem.protected_robots | one)
            if isinstance(row.target, int)
            else replace(problem, protected_links=problem.protected_links | one)
        )
        gain = brute_force_worst_case(safer, elements) - base
        assert row.gain_lower - 1e-9 <= gain <= row.gain_upper + 1e-9


def test_budgets_that_were_left_open_are_not_exhausted(monkeypatch):
    """An attack that may be worse than the one found: there may be budgets that are not in the list."""
    problem = random_problem(np.random.default_rng(2), 4, kind="trace", complete=True, protect=False)
    plan = random_elements(np.random.default_rng(2), problem)
    goal = brute_force_worst_case(replace(problem, alpha_s=0, alpha_c=0), plan) * 0.5
    assert ro.breaking_budgets(problem, plan, goal).stop is ro.Stop.EXHAUSTED

    def open_attack(asked, elements, **_):
        found = ro.worst_case_attack(replace(asked, alpha_s=0, alpha_c=0), elements)
        return replace(found, lower=0.0, stop=ro.Stop.NODES)

    monkeypatch.setattr("ratt_opt.attack.protection.criticality.worst_case_attack", open_attack)
    left_open = ro.breaking_budgets(problem, plan, goal)
    assert (len(left_open), left_open.stop) == (0, ro.Stop.NODES)


def test_a_value_that_is_not_a_number_is_refused():
    problem = random_problem(np.random.default_rng(0), 3)
    with pytest.raises(ro.InputError, match="value"):
        ro.breaking_budgets(problem, [c[0] for c in problem.choices], float("nan"))


def test_after_an_interrupt_nothing_more_is_searched(monkeypatch):
    """Brackets and budgets stay valid; what was not decided is not called proved."""
    problem = random_problem(np.random.default_rng(2), 5, kind="trace", complete=True, protect=False)
    problem = replace(problem, alpha_s=1, alpha_c=3)
    plan = random_elements(np.random.default_rng(2), problem)
    exact = {row.target: row for row in ro.criticality_ranking(problem, plan)}
    goal = ro.worst_case_attack(problem, plan).upper * 1.01
    asked = interrupted_at(1, lambda search, run: run(search))
    watch(monkeypatch, "thresholds", asked)
    for row in ro.criticality_ranking(problem, plan):
        assert row.gain_lower <= exact[row.target].gain_lower + 1e-12
        assert row.gain_upper >= exact[row.target].gain_upper - 1e-12
    asked.calls = 0
    found = ro.breaking_budgets(problem, plan, goal)
    assert all(one.value < goal and not (one.is_proved and one.alpha_c) for one in found)
    assert asked.calls == 1
    assert found.stop is ro.Stop.INTERRUPTED
