"""No search returns less than RATT's, the greedy and the myopic plan and exchanges from them, whatever the limit."""

from __future__ import annotations

import networkx as nx
import numpy as np
import pytest

import ratt_opt as ro
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
