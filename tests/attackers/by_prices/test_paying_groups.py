"""The search for groups that pay their prices, against every group."""

from __future__ import annotations

import networkx as nx
import numpy as np
import pytest

from ratt_opt.attack.links import Links
from ratt_opt.attackers.by_prices.convex_forms import ConvexForms
from ratt_opt.attackers.by_prices.falling_prices import FallingPrices
from ratt_opt.attackers.by_prices.groups.columns import Prices, Question
from ratt_opt.attackers.by_prices.groups.weak_sizes import WeakSizes
from ratt_opt.attackers.by_prices.paying_groups import PayingSearch, Way
from ratt_opt.attackers.by_prices.prices import GroupPrices, PriceVector
from ratt_opt.attackers.by_prices.team import PricedTeam
from ratt_opt.attackers.weakest_set.packed_team import PackedTeam
from ratt_opt.budget import Budget
from tests.attackers.by_prices.definition import fitted_forms, least_cost, reduced_cost
from tests.strategies import team_problem


def paying_search(team, links, threat, forms_at=None, way=Way.SEEING_WITH_FORMS):
    search = PayingSearch(team, links, fitted_forms(threat, forms_at))
    search._way = way
    return search


def unpaid_question(seed):
    """A connected team of six robots, a threshold, and prices that no group of theirs pays, though some nearly do."""
    rng = np.random.default_rng(seed)
    problem, plan = team_problem(6 * seed + 1, 6, graph=nx.connected_watts_strogatz_graph(6, 4, 0.5, seed=seed))
    team, links, threat = PricedTeam.of(problem.objective, plan), Links.of(problem.threat), problem.threat
    threshold, robot, blinded = 0.7 * problem.objective(plan), rng.uniform(0, 2, 6), rng.uniform(0.5, 2)
    size = WeakSizes(team, PackedTeam.planar(problem.objective, plan)).largest(threshold, Budget())
    while least_cost(problem, plan, threshold, (robot, blinded)) < 1e-3:
        robot *= 0.6
    for _ in range(3):  # as much as they may be, nearly
        robot += least_cost(problem, plan, threshold, (robot, blinded)) / 6.1
    at = Prices(robot, blinded, np.ones(6), float(size), blinded, np.ones(1), ConvexForms(threat).known)
    return (team, links, threat), at, Question(threshold, threat.n_blinded, -1e-6, np.arange(6), 0, 0)


@pytest.mark.parametrize("way", Way)
@pytest.mark.parametrize("seed", range(3))
def test_a_search_asked_again_goes_on_where_it_was(seed, way, monkeypatch):
    """All ways have their part; the one that ends is the first to be asked the next time."""
    monkeypatch.setattr("ratt_opt.attackers.by_prices.paying_groups.NEARLY", 0)
    (team, links, threat), at, question = unpaid_question(seed)
    alone = {}
    for only in Way:
        budget = Budget()
        search = paying_search(team, links, threat, forms_at=at.robot, way=only)
        assert search.find(at, question, budget, nodes=10**6, room=1).is_complete
        alone[only] = budget.nodes
    search, budget, nodes = paying_search(team, links, threat, forms_at=at.robot, way=way), Budget(), 2
    while not search.find(at, question, budget, nodes=nodes, room=1).is_complete:
        nodes += 2
    assert budget.nodes <= sum(alone.values())
    assert budget.nodes >= alone[search._way]


@pytest.mark.parametrize("way", Way)
def test_a_search_that_nearly_ends_goes_on_beyond_its_nodes(way, monkeypatch):
    (team, links, threat), at, question = unpaid_question(0)
    for nearly in (0.0, 1.0):
        monkeypatch.setattr("ratt_opt.attackers.by_prices.paying_groups.NEARLY", nearly)
        search = paying_search(team, links, threat, forms_at=at.robot, way=way)
        assert search.find(at, question, Budget(), nodes=3, room=1).is_complete == (nearly == 1.0)


@pytest.mark.parametrize("way", Way)
@pytest.mark.parametrize("seed", range(12))
def test_a_search_whose_prices_fell_is_not_gone_on_with_at_higher_prices(seed, way):
    rng = np.random.default_rng(seed)
    (team, links, threat), at, question = unpaid_question(seed)
    problem, plan = team_problem(6 * seed + 1, 6, graph=nx.connected_watts_strogatz_graph(6, 4, 0.5, seed=seed))
    robot = at.robot + rng.uniform(0.0, 1.0, 6)  # some groups may pay now
    first = PriceVector(robot=robot, blinded=at.blinded, links=float(robot.sum() - at.blinded * threat.n_blinded))
    search, nodes, found = paying_search(team, links, threat, forms_at=robot, way=way), 1, None
    while found is None or not found.is_complete:
        falling = FallingPrices(
            program=GroupPrices(threat), threshold=question.threshold, prices=first, links=first.links - 100.0
        )
        found = search.find(at._replace(robot=robot), question, Budget(), falling, nodes=nodes, room=10**6)
        assert not found.groups
        nodes += 1
    left = falling.prices.robot, at.blinded
    assert least_cost(problem, plan, question.threshold, left) >= -1e-5


@pytest.mark.parametrize("way", Way)
@pytest.mark.parametrize("seed", range(24))
def test_the_search_for_groups_that_pay_finds_some_or_proves_that_none_does(seed, way):
    rng = np.random.default_rng(seed)
    problem, plan = team_problem(seed, 6, graph=nx.gnp_random_graph(6, 0.5, seed=seed))
    team, links, threat = PricedTeam.of(problem.objective, plan), Links.of(problem.threat), problem.threat
    threshold, prices = problem.objective(plan) * rng.uniform(0.4, 0.9), (rng.uniform(0, 2, 6), rng.uniform(0.0, 2))
    size = WeakSizes(team, PackedTeam.planar(problem.objective, plan)).largest(threshold, Budget())
    raised = max(least_cost(problem, plan, threshold, prices), 0) + 0.5  # some groups pay
    prices = (prices[0] + raised, prices[1])
    least = least_cost(problem, plan, threshold, prices)
    piece = least_cost(problem, plan, threshold, prices, connected=True)  # of a group that pays, one piece pays
    assert least <= piece < 0
    at = Prices(prices[0], prices[1], np.ones(6), float(size), prices[1], np.ones(1), ConvexForms(threat).known)
    search = paying_search(team, links, threat, forms_at=prices[0] if seed % 2 else None, way=way)
    for limit, room in ((least - 1e-6, 5), (piece + 1e-6, 5), (-1e-6, 3)):
        question = Question(threshold, threat.n_blinded, limit, np.arange(6), 0, 0)
        found = search.find(at, question, Budget(), nodes=10**6, room=room)
        assert (len(found.groups) > 0) == (least <= limit)
        assert found.is_complete or len(found.groups) == room
        for group in found.groups:
            assert group.need <= threat.n_blinded
            assert reduced_cost(problem, group.robots.astype(int), (prices[0], 0.0)) + prices[1] * group.need <= limit
    assert not search.find(at, question, Budget(), nodes=0, room=3).is_complete


@pytest.mark.parametrize("way", Way)
@pytest.mark.parametrize("seed", range(24))
def test_prices_fall_for_groups_that_pay_until_none_does(seed, way):
    """What is closed at higher prices stays closed: one search proves what the prices left at its end claim."""
    rng = np.random.default_rng(seed)
    problem, plan = team_problem(seed, 6, graph=nx.gnp_random_graph(6, 0.5, seed=seed))
    team, links, threat = PricedTeam.of(problem.objective, plan), Links.of(problem.threat), problem.threat
    threshold, blinded = problem.objective(plan) * rng.uniform(0.4, 0.9), rng.uniform(0.0, 2)
    size = WeakSizes(team, PackedTeam.planar(problem.objective, plan)).largest(threshold, Budget())
    robot = rng.uniform(0, 2, 6)
    robot += max(least_cost(problem, plan, threshold, (robot, blinded)), 0) + 0.5  # some groups pay
    first = PriceVector(robot=robot.copy(), blinded=blinded, links=float(robot.sum() - blinded * threat.n_blinded))
    at = Prices(robot, blinded, np.ones(6), float(size), blinded, np.ones(1), ConvexForms(threat).known)
    question = Question(threshold, threat.n_blinded, -1e-6, np.arange(6), 0, 0)
    search = paying_search(team, links, threat, forms_at=robot if seed % 2 else None, way=way)
    for least in (-1e9, first.links - 0.5):
        falling = FallingPrices(program=GroupPrices(threat), threshold=threshold, prices=first, links=least)
        found = search.find(at, question, Budget(), falling, nodes=10**6, room=10**6)
        left = falling.prices
        assert falling.learned > 0
        assert np.all(left.robot <= robot + 1e-9)
        assert left.blinded == blinded
        assert left.links == pytest.approx(left.robot.sum() - blinded * threat.n_blinded)
        assert left.links >= least
        assert found.is_complete
        assert not (found.groups and least < -1e8)
        assert (least_cost(problem, plan, threshold, (left.robot, blinded)) >= -1e-5) == (not found.groups)
    np.testing.assert_array_equal(at.robot, first.robot)
