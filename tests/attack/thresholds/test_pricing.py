"""Groups of small reduced cost, what they need, and how large sets below a threshold are, against the definitions."""

from ctypes import c_uint64
from itertools import combinations

import networkx as nx
import numpy as np
import pytest

from ratt_opt import AttackParams
from ratt_opt.attack.params.groups import PricingParams
from ratt_opt.attack.team import Links
from ratt_opt.attack.thresholds.pricing import BLINDED, UNIT, GroupSearch, PricingProblem, Question, _least_cuts
from ratt_opt.budget import Budget
from ratt_opt.graph.communication import CommunicationGraph
from ratt_opt.graph.threat import Threat
from tests.attack.thresholds.pricing_definition import least_cost, paying_groups, reduced_cost
from tests.strategies import OBJECTIVES, information_data, team_problem


def question_of(threshold, prices, limit, most):
    """Of dual prices in half links; rounded so that no group costs less."""
    robots = np.floor(prices[0] * 2 * UNIT).astype(np.int64)
    return Question(threshold, most, robots, int(np.ceil(prices[1] * 2 * UNIT)), int(limit * 2 * UNIT))


def groups_of(search, nodes=10**9, room=200):
    """Every group; nodes, and groups, at a time."""
    is_over = False
    while not is_over:
        columns, is_over = search.columns(nodes, room, Budget())
        yield from columns


def cost_of(problem, column, prices):
    return reduced_cost(problem, column.robots.astype(int), (prices[0], 0.0)) + prices[1] * column.need


@pytest.mark.parametrize("nodes", [1, 10**9])
@pytest.mark.parametrize("seed", range(20))
def test_every_group_that_costs_less_is_listed_with_what_it_needs(seed, nodes):
    rng = np.random.default_rng(seed)
    problem, plan = team_problem(seed, 7, graph=nx.gnp_random_graph(7, 0.5, seed=seed))
    team, prices = (
        PricingProblem.of(problem.objective, plan, problem.threat),
        (rng.uniform(0, 2, 7), rng.uniform(0.2, 2)),
    )
    threshold = problem.objective(plan) * rng.uniform(0.4, 0.9)
    question = question_of(threshold, prices, 0.5, team.most_below(threshold))
    search = GroupSearch(team, question, rng.permutation(7))
    columns = list(groups_of(search, nodes, [200, 3][seed % 2]))
    found = {tuple(np.flatnonzero(one.robots)): (one.need, one.found) for one in columns}
    expected = paying_groups(problem, plan, (threshold, 0.5), prices)
    assert {group: (need, need) for group, need in expected.items()} == found
    assert len(columns) == len(found)


@pytest.mark.parametrize("seed", range(60))
def test_a_group_is_found_or_there_is_none(seed):
    rng = np.random.default_rng(seed)
    problem, plan = team_problem(seed, 6, graph=nx.gnp_random_graph(6, (0.3, 0.5, 0.9)[seed % 3], seed=seed))
    team, threshold = (
        PricingProblem.of(problem.objective, plan, problem.threat),
        problem.objective(plan) * rng.uniform(0.4, 1.1),
    )
    prices = rng.uniform(0, 2, 6), rng.uniform(0.0, 2)
    raised = max(least_cost(problem, plan, threshold, prices), 0) + 0.5  # some groups cost less than nothing
    if not np.isfinite(raised):
        return
    prices = (prices[0] + raised, prices[1])
    piece = least_cost(problem, plan, threshold, prices, connected=True)  # of a group that does, one piece does
    most = team.most_below(threshold)
    for limit, exists in ((piece - 1e-4, False), (piece + 1e-4, True), (-1e-6, True)):
        question = question_of(threshold, prices, min(limit, -1e-6), most)
        columns = list(groups_of(GroupSearch(team, question, np.arange(6)), int(rng.integers(1, 50))))
        assert bool(columns) == exists
        for one in columns:
            assert one.need <= problem.threat.n_blinded
            assert cost_of(problem, one, prices) <= limit + 1e-4
            assert one.blinded.sum() == one.found
            assert not (one.blinded & ~one.robots).any()
            assert not set(np.flatnonzero(one.blinded)) & problem.protected_robots
            assert problem.objective(plan[one.robots & ~one.blinded]) < threshold * (1 + 1e-9)


@pytest.mark.parametrize("seed", range(40))
def test_no_set_below_a_threshold_is_larger_than_said(seed):
    """Targets of one to four coordinates; small sets are decided exactly."""
    rng, dimension = np.random.default_rng(seed), 1 + seed % 4
    prior, information = information_data(rng, 7, 3, dimension)
    threat = Threat(CommunicationGraph(7, frozenset()), 2, 0)
    for objective in (cls(prior, information) for cls in OBJECTIVES.values()):
        sets = [s for k in range(8) for s in combinations(range(7), k)]
        team = PricingProblem.of(objective, np.arange(7), threat)
        for share in (*rng.uniform(0, 1, 3), 0.0, 1.1):
            threshold = share * objective(range(7))
            below = {s for s in sets if objective(s) < threshold}
            nearly = {s for s in sets if objective(s) < threshold + 1e-9}
            assert max(map(len, below), default=0) <= team.most_below(threshold) <= max(map(len, nearly), default=0)
            group = rng.random(7) < 0.7
            least, most = (max((len(s) for s in those if group[list(s)].all()), default=0) for those in (below, nearly))
            assert least <= team.most_below(threshold, group) <= most


@pytest.mark.parametrize("dimension", [2, 4])
def test_averages_alone_are_exact_for_robots_that_are_alike(dimension):
    params = AttackParams(pricing=PricingParams(work=0))
    prior, information = information_data(np.random.default_rng(dimension), 1, 3, dimension)
    threat = Threat(CommunicationGraph(30, frozenset()), 2, 0)
    for criterion in OBJECTIVES.values():
        alike = criterion(prior, np.repeat(information, 30, axis=0))
        worth = alike(range(12))
        if worth > 1e-6:
            assert PricingProblem.of(alike, np.arange(30), threat, params).most_below(worth * (1 - 1e-6)) <= 11


@pytest.mark.parametrize("seed", range(12))
def test_annealed_groups_are_real_and_mostly_the_cheapest(seed):
    rng = np.random.default_rng(seed)
    problem, plan = team_problem(seed, 7, graph=nx.gnp_random_graph(7, 0.5, seed=seed))
    team, threshold = (
        PricingProblem.of(problem.objective, plan, problem.threat),
        problem.objective(plan) * rng.uniform(0.4, 0.9),
    )
    prices, found, random = (rng.uniform(0, 2, 7), rng.uniform(0.2, 2)), [], c_uint64(seed + 1)
    question = question_of(threshold, prices, 0.0, 7)
    for first, one in enumerate(team.annealed(question, 2_000, (4.0, 0.1), random)):
        cut = {(i, j) for i, j in problem.communication.links if one.robots[i] != one.robots[j]}
        if one.cost > 1e6 * UNIT or cut & problem.protected_links:
            continue
        assert one.robots[first]
        assert one.need == one.found == one.blinded.sum() <= problem.threat.n_blinded
        assert problem.objective(plan[one.robots & ~one.blinded]) < threshold
        assert one.cost / (2 * UNIT) == pytest.approx(cost_of(problem, one, prices), abs=1e-4)
        found.append(one.cost / (2 * UNIT))
    groups = paying_groups(problem, plan, (threshold, 1e6), prices)
    part = {group: np.isin(range(7), group).astype(int) for group in groups}
    costs = [reduced_cost(problem, part[group], prices) + prices[1] * need for group, need in groups.items()]
    assert problem.protected_links or not costs or min(found) <= min(costs) + 1e-4
    assert BLINDED == 2


@pytest.mark.parametrize("seed", range(10))
def test_groups_of_a_size_cut_no_fewer_links_than_said(seed):
    graph = nx.gnp_random_graph(8, (0.2, 0.5, 0.8, 1.0)[seed % 4], seed=seed)
    least = _least_cuts(Threat(CommunicationGraph(8, frozenset(graph.edges)), 1, 0))
    for size in range(9):
        assert least[size] <= min(nx.cut_size(graph, group) for group in combinations(range(8), size))
    if nx.density(graph) == 1.0:
        assert least.tolist() == [size * (8 - size) for size in range(9)]


@pytest.mark.parametrize("seed", range(20))
def test_arcs_are_those_of_the_definition(seed):
    rng = np.random.default_rng([seed, 5])
    n_robots = int(rng.integers(1, 10))
    graph = CommunicationGraph.from_networkx(nx.gnp_random_graph(n_robots, [0, 0.3, 0.7, 1][seed % 4], seed), n_robots)
    protected = frozenset(link for link in graph.links if rng.random() < 0.3)
    found = Links.of(Threat(graph, 0, 0, frozenset({0}), protected))
    arcs = sorted([*graph.links, *((j, i) for i, j in graph.links)])
    assert found.robot.tolist() == [j for _, j in arcs]
    assert found.start.tolist() == [sum(i < robot for i, _ in arcs) for robot in range(n_robots + 1)]
    assert found.back.tolist() == [arcs.index((j, i)) for i, j in arcs]
    assert found.fixed.tolist() == [(min(arc), max(arc)) in protected for arc in arcs]
    assert found.seeing.tolist() == [robot == 0 for robot in range(n_robots)]
