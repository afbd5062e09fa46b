"""No search returns less than RATT's, the greedy and the myopic plan and exchanges from them, whatever the limit."""

from __future__ import annotations

from itertools import combinations

import networkx as nx
import numpy as np
import pytest

import ratt_opt as ro
from ratt_opt.solvers.maxmin.params import FirstPlanParams
from tests.solvers.by_values.test_rows import OwnSum
from tests.solvers.maxmin.engine import NO_PLANS_LISTED
from tests.strategies import Opaque, Submodular, information_data
from tests.watchdog import ends_within
from tests.ways import go


def criterion(rng, n):
    prior, information = information_data(rng, n, 5, 2)
    return ro.TraceObjective(prior, information * (rng.random((n, 5)) < 0.4)[:, :, None, None])


KINDS = {
    "facilities": lambda rng, n: ro.FacilityLocation(rng.random((n, 20)) ** 3),
    "coverage": lambda rng, n: ro.Coverage(rng.random((n, 30)) < 0.12, rng.integers(1, 4, 30).astype(float)),
    "own sum": lambda rng, n: OwnSum(rng.random((n, 12)) < 0.2),
    "submodular": lambda rng, n: Submodular(ro.FacilityLocation(rng.random((n, 20)) ** 3)),
    "values": lambda rng, n: Opaque(criterion(rng, n)),
    "measured": criterion,
}
ATTACKS = {"none": (0, 0), "blinded": (2, 0), "cuts": (1, 3)}


def team(kind, attacks, seed):
    rng = np.random.default_rng(seed)
    alpha_s, alpha_c = ATTACKS[attacks]
    graph = nx.circulant_graph(8, [1, 2]) if attacks == "cuts" else None
    return ro.Problem(KINDS[kind](rng, 32), np.repeat(np.arange(8), 4), graph, alpha_s, alpha_c)


def worst(problem, plan):
    return ro.worst_case_attack(problem, plan).lower


def check(problem, limit):
    found = ro.solve_maxmin(problem, time_limit=limit)
    kept = worst(problem, found.elements)
    slack = 1e-9 * abs(kept)
    assert found.lower <= kept + slack
    for planner in (ro.ratt, ro.greedy, ro.myopic):
        assert kept >= worst(problem, planner(problem).elements) - slack, planner
    return found


def improves(problem, found):
    """Tell whether a single exchange of an element would keep more."""
    for i, choice in enumerate(problem.choices):
        for e in choice:
            other = found.elements.copy()
            other[i] = e
            if worst(problem, other) > worst(problem, found.elements) * (1 + 1e-9):
                return True
    return False


@pytest.mark.parametrize("limit", [0, 0.01, 0.05])
@pytest.mark.parametrize("kind", KINDS)
def test_first_plans_are_a_floor_whatever_the_limit(kind, limit):
    for seed, attacks in enumerate(ATTACKS):
        check(team(kind, attacks, seed), limit)


@pytest.mark.parametrize("kind", ["facilities", "values"])
@pytest.mark.parametrize("attacks", ["none", "blinded"])
def test_no_single_exchange_is_left_whatever_the_limit(kind, attacks):
    problem = team(kind, attacks, 5)
    assert not improves(problem, check(problem, 0))


def exchanged(problem, plan):
    """The worst case that exchanges reach, by definition: robot by robot its best element, judged by all attacks."""
    sets = list(combinations(range(problem.n_robots), problem.alpha_s))

    def exact(plans):
        members = np.zeros((len(plans), len(sets), problem.objective.n), dtype=np.bool_)
        for row, one in zip(members, plans, strict=True):
            row[:, one] = True
            for k, lost in enumerate(sets):
                row[k, one[list(lost)]] = False
        values = problem.objective.evaluate(members.reshape(-1, problem.objective.n))
        return values.reshape(len(plans), len(sets)).min(axis=1)

    plan, unchanged, i = np.array(plan), 0, 0
    value = exact([plan])[0]
    while unchanged < problem.n_robots:
        unchanged += 1
        others = [np.where(problem.robot[e] == np.arange(problem.n_robots), e, plan) for e in problem.choices[i]]
        values = exact(others)
        if values.max() > value * (1 + 1e-12):
            plan, value, unchanged = others[int(values.argmax())], values.max(), 0
        i = (i + 1) % problem.n_robots
    return value


@pytest.mark.parametrize("kind", ["facilities", "coverage", "submodular"])
def test_exchanges_by_exact_attacks_are_a_floor(kind):
    """Judged by known attacks alone, exchanges once ended at 0.98 of these."""
    params = ro.MaxMinParams(first_plans=FirstPlanParams(beyond=60))
    for seed in range(3):
        rng = np.random.default_rng([seed, 12])
        problem = ro.Problem(KINDS[kind](rng, 48), np.repeat(np.arange(12), 4), None, 2, 0)
        kept = worst(problem, ro.solve_maxmin(problem, time_limit=0, params=params).elements)
        for planner in (ro.ratt, ro.greedy, ro.myopic):
            assert kept >= exchanged(problem, planner(problem).elements) * (1 - 1e-9), (seed, planner)


@pytest.mark.slow
@pytest.mark.parametrize("limit", [0, 0.01, 0.05, 0.2, 1])
@pytest.mark.parametrize("attacks", ATTACKS)
@pytest.mark.parametrize("kind", KINDS)
def test_first_plans_are_a_floor_of_many_teams(kind, attacks, limit):
    for seed in range(10):
        check(team(kind, attacks, seed), limit)


def test_without_a_limit_a_search_goes_on_until_it_is_proved(monkeypatch):
    """Beyond twelve robots a search that nothing limited once ended as heuristic, after a walk and no node."""
    go(monkeypatch, NO_PLANS_LISTED)
    rng = np.random.default_rng(3)
    value = rng.random(26) * 10 ** rng.uniform(0, 1.5, 26)
    one = ro.Problem(Opaque(ro.ConcaveOfModular(value)), np.repeat(np.arange(13), 2), None, 2, 0)
    with ends_within(30):
        found = ro.solve_maxmin(one)
    assert found.stop is ro.Stop.CLOSED
    best = np.sort(value.reshape(13, 2).max(axis=1))[:-2].sum()
    assert found.lower == pytest.approx(ro.ConcaveOfModular([best])([0]))
