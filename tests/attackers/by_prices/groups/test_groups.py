"""Searches of groups at prices, covers by groups, and sizes of weak sets, against all groups."""

from __future__ import annotations

from itertools import combinations

import networkx as nx
import numpy as np
import pytest

from ratt_opt.attack.links import Links
from ratt_opt.attackers.by_prices.groups import cover
from ratt_opt.attackers.by_prices.groups.cheap_groups import BLINDED, NOBODY, SEEING, cheap_group
from ratt_opt.attackers.by_prices.groups.columns import FINISHED, Prices, Question, Stack, enumerate_groups
from ratt_opt.attackers.by_prices.groups.cover import next_cover
from ratt_opt.attackers.by_prices.groups.weak_sizes import WeakSizes
from ratt_opt.attackers.by_prices.team import PricedTeam
from ratt_opt.attackers.weakest_set.packed_team import PackedTeam
from ratt_opt.budget import Budget
from tests.attackers.by_prices.definition import fitted_forms, paying_groups, reduced_cost
from tests.strategies import OBJECTIVES, information_data, team_problem


@pytest.mark.parametrize("seed", range(12))
def test_the_enumeration_lists_every_group_that_pays(seed):
    """Against all connected groups and all blindings, at random prices."""
    rng = np.random.default_rng(seed)
    problem, plan = team_problem(seed, 7, graph=nx.gnp_random_graph(7, 0.5, seed=seed))
    team, links = PricedTeam.of(problem.objective, plan), Links.of(problem.threat)
    whole = problem.objective(plan)
    threshold, blinded, robot = whole * rng.uniform(0.4, 0.9), rng.uniform(0.2, 2), rng.uniform(0, 2, 7)
    sets = [s for k in range(8) for s in combinations(range(7), k)]
    largest = max(len(s) for s in sets if problem.objective(plan[list(s)]) < threshold)
    forms = fitted_forms(problem.threat, robot if seed % 2 else None)
    prices = Prices(robot, blinded, np.ones(7), float(largest), blinded, np.array([1.0, 0.5, 0.0]), forms.known)
    question = Question(threshold, problem.threat.n_blinded, 0.5, rng.permutation(7), 10**6, 10**6)
    stack = Stack.of(7, len(links.robot), (3, forms.n_forms))
    listed = (np.zeros((200, 7), np.bool_), np.zeros((200, 7), np.bool_), np.zeros((200, 2), np.int64), np.zeros(200))
    assert enumerate_groups(team, links, prices, question, stack, 10**6, listed) == FINISHED
    found = {tuple(np.flatnonzero(row)): need for row, need in zip(listed[0], listed[2], strict=True) if row.any()}
    expected = paying_groups(problem, plan, (threshold, 0.5), (robot, blinded))
    assert set(found) == set(expected)
    assert all(tuple(found[group]) == (need, need) for group, need in expected.items())


@pytest.mark.parametrize("seed", range(30))
def test_covers_against_all_choices_of_groups(seed):
    rng = np.random.default_rng(seed)
    masks = rng.choice(np.arange(1, 32), size=12, replace=False)
    groups = np.array([[bool(mask >> i & 1) for i in range(5)] for mask in masks])
    groups = groups[np.argsort(groups.argmax(axis=1), kind="stable")]
    costs, budgets = rng.integers(0, 4, (12, 3)).astype(float), rng.integers(2, 7, 3).astype(float)
    expected = {
        chosen
        for k in range(1, 6)
        for chosen in combinations(range(12), k)
        if (groups[list(chosen)].sum(axis=0) == 1).all() and (costs[list(chosen)].sum(axis=0) <= budgets).all()
    }
    first = np.searchsorted(groups.argmax(axis=1), np.arange(6))
    position, depth = np.full(7, -1), np.zeros(1, dtype=np.int64)
    state = (position, np.zeros((7, 5), dtype=np.bool_), np.zeros((7, 3)), depth, first)
    found = []
    while (code := next_cover(groups, costs, budgets, state, int(rng.integers(1, 20)))) != cover.FINISHED:
        if code == cover.FOUND:
            found.append(tuple(sorted(position[: depth[0] + 1].tolist())))
    assert len(found) == len(set(found))
    assert set(found) == expected


@pytest.mark.parametrize("seed", range(12))
def test_annealed_groups_are_real_and_mostly_the_cheapest(seed):
    rng = np.random.default_rng(seed)
    problem, plan = team_problem(seed, 7, graph=nx.gnp_random_graph(7, 0.5, seed=seed))
    team, links, threat = PricedTeam.of(problem.objective, plan), Links.of(problem.threat), problem.threat
    threshold, prices = problem.objective(plan) * rng.uniform(0.4, 0.9), (rng.uniform(0, 2, 7), rng.uniform(0.2, 2))
    found, part = [], np.zeros(7, dtype=np.int8)
    for first in range(7):
        limits, cooling = (threshold, threat.n_blinded), (2_000, 2.0, 0.05)
        cost = cheap_group(team, links, prices, limits, first, cooling, rng, part)
        if cost == NOBODY:
            continue
        cut = {(i, j) for i, j in problem.communication.links if (part[i] > 0) != (part[j] > 0)}
        if cut & problem.protected_links:
            continue
        assert part[first]
        assert (part == BLINDED).sum() <= threat.n_blinded
        assert problem.objective([plan[i] for i in range(7) if part[i] == SEEING]) < threshold
        assert cost == pytest.approx(reduced_cost(problem, part, prices), abs=1e-9)
        found.append(cost)
    limit = 1e6 if not problem.protected_links else -1e6
    groups = paying_groups(problem, plan, (threshold, limit), prices)
    costs = [
        reduced_cost(problem, np.isin(range(7), group).astype(int), prices) + prices[1] * need
        for group, need in groups.items()
    ]
    assert not costs or min(found) <= min(costs) + 1e-9


@pytest.mark.parametrize("seed", range(12))
def test_no_weak_set_is_larger_than_its_size(seed):
    problem, plan = team_problem(seed, 7)
    team, planar = PricedTeam.of(problem.objective, plan), PackedTeam.planar(problem.objective, plan)
    values = {s: problem.objective(plan[list(s)]) for k in range(8) for s in combinations(range(7), k)}
    sizes = WeakSizes(team, planar)
    for share in (0.3, 0.6, 0.9):
        threshold = share * problem.objective(plan)
        largest = max((len(s) for s, value in values.items() if value < threshold), default=0)
        assert sizes.largest(threshold, Budget()) == largest


@pytest.mark.parametrize("seed", range(40))
def test_sizes_that_nothing_but_averages_rules_out_have_no_weak_set(seed, monkeypatch):
    """Targets of one, three and four coordinates; averages alone say as much as they can in teams of equal robots."""
    monkeypatch.setattr("ratt_opt.attackers.by_prices.groups.weak_sizes.SIZE_WORK", 0)
    rng, dimension = np.random.default_rng(seed), (1, 3, 4)[seed % 3]
    prior, information = information_data(rng, 7, 3, dimension)
    for objective in (cls(prior, information) for cls in OBJECTIVES.values()):
        values = [(k, objective(s)) for k in range(8) for s in combinations(range(7), k)]
        sizes = WeakSizes(PricedTeam.of(objective, np.arange(7)), None)
        for share in rng.uniform(0, 1, 3):
            threshold = share * objective(range(7))
            assert sizes.largest(threshold, Budget()) >= max((k for k, value in values if value < threshold), default=0)
        alike = type(objective)(prior, np.repeat(information[:1], 30, axis=0))
        sizes = WeakSizes(PricedTeam.of(alike, np.arange(30)), None)
        worth = alike(range(12))
        assert worth < 1e-6 or sizes.largest(worth * (1 - 1e-6), Budget()) <= 11
