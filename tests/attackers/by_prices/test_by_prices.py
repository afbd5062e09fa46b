"""The exact attacker of larger teams on any graph, run on teams small enough for the definition or a table."""

from __future__ import annotations

from itertools import combinations

import networkx as nx
import numpy as np
import pytest

import ratt_opt as ro
from ratt_opt.attackers.by_prices import price_search
from ratt_opt.attackers.by_prices.answer import Answer, Threshold
from ratt_opt.attackers.by_prices.convex_forms import ConvexForms
from ratt_opt.attackers.by_prices.falling_prices import FallingPrices
from ratt_opt.attackers.by_prices.groups import blinding, cover
from ratt_opt.attackers.by_prices.groups.blinding import ABSENT, WEAK, may_be_weak, weak_subset
from ratt_opt.attackers.by_prices.groups.cheap_groups import BLINDED, NOBODY, SEEING, cheap_group
from ratt_opt.attackers.by_prices.groups.columns import FINISHED, Prices, Question, Stack, enumerate_groups
from ratt_opt.attackers.by_prices.groups.cover import next_cover
from ratt_opt.attackers.by_prices.groups.weak_sizes import WeakSizes
from ratt_opt.attackers.by_prices.paying_groups import PayingSearch, Way
from ratt_opt.attackers.by_prices.price_search import PriceSearch
from ratt_opt.attackers.by_prices.prices import GroupPrices, KnownGroup, PriceVector
from ratt_opt.attackers.by_prices.team import Links, PricedTeam
from ratt_opt.attackers.task import AttackBracket, AttackTask, PlanValues
from ratt_opt.attackers.weakest_set.packed_team import PackedTeam
from ratt_opt.budget import Budget, OutOfBudget
from tests.brackets import assert_closed, worst_value
from tests.oracles import brute_force_worst_case
from tests.strategies import OBJECTIVES, information_data, team_problem


def run_prices(problem, plan, **limits):
    """The search itself, whatever ``worst_case_attack`` would choose for this team."""
    values = PlanValues(problem, plan)
    nothing = ro.Attack()
    bracket, budget = AttackBracket(nothing, problem.team_value(plan, nothing), 0.0), Budget(**limits)
    search = PriceSearch(AttackTask(problem, values, bracket, budget), PricedTeam.of(problem.objective, values.plan))
    try:
        search.anneal(4)
        stop = search.run()
    except OutOfBudget as out:
        stop = out.stop
    return bracket, stop


@pytest.mark.parametrize("seed", range(60))
def test_against_the_definition(seed):
    problem, plan = team_problem(seed, 3 + seed % 4)
    bracket, stop = run_prices(problem, plan)
    assert stop is ro.Stop.CLOSED
    assert_closed(problem, plan, bracket, brute_force_worst_case(problem, plan))


@pytest.mark.parametrize("seed", range(8))
def test_against_a_table_of_thresholds(seed):
    families = (nx.gnp_random_graph(13, 0.4, seed=seed), nx.watts_strogatz_graph(13, 4, 0.2, seed=seed))
    problem, plan = team_problem(seed, 13, graph=families[seed % 2])
    bracket, stop = run_prices(problem, plan, time_limit=60)
    assert stop is ro.Stop.CLOSED
    assert_closed(problem, plan, bracket, worst_value(problem, plan))


@pytest.mark.parametrize("n_robots", [1, 2, 5])
@pytest.mark.parametrize("seed", range(3))
def test_where_nothing_can_be_attacked_no_group_is_weak(n_robots, seed):
    problem, plan = team_problem(seed, n_robots, graph=nx.path_graph(n_robots))
    links = [(i, i + 1) for i in range(n_robots - 1)]
    safe = ro.Problem(problem.objective, problem.robot, problem.graph, n_robots, len(links), range(n_robots), links)
    bracket, stop = run_prices(safe, plan)
    assert stop is ro.Stop.CLOSED
    assert_closed(safe, plan, bracket, problem.objective(plan))


@pytest.mark.parametrize("nodes", [0, 1, 100, 2_000])
def test_a_bracket_that_is_stopped_is_valid(nodes):
    problem, plan = team_problem(1, 13, graph=nx.gnp_random_graph(13, 0.5, seed=1))
    exact = worst_value(problem, plan)
    bracket, _ = run_prices(problem, plan, max_nodes=nodes)
    assert bracket.lower <= exact * (1 + 1e-12)
    assert exact <= bracket.upper * (1 + 1e-12)


@pytest.mark.parametrize("seed", range(12))
def test_weak_subsets_against_all_of_them(seed):
    problem, plan = team_problem(seed, 8)
    team, links = PricedTeam.of(problem.objective, plan), Links.of(problem.threat)
    group = np.random.default_rng(seed).random(8) < 0.8
    members = np.flatnonzero(group).tolist()
    free = [i for i in members if not links.seeing[i]]
    for blinded in range(len(free) + 1):
        values = [problem.objective([plan[i] for i in members if i not in out]) for out in combinations(free, blinded)]
        least = min(values)
        for threshold in (least * 0.999, least * 1.001) if least > 1e-6 else (1e-3,):
            found = np.zeros(8, dtype=np.bool_)
            answer = weak_subset(team, links.seeing, group, blinded, threshold, 10**6, found)
            assert answer == (WEAK if least < threshold else ABSENT)
            if answer == WEAK:
                left = [plan[i] for i in members if not found[i]]
                assert found.sum() == blinded
                assert problem.objective(left) < threshold


@pytest.mark.parametrize("seed", range(12))
def test_weak_subsets_in_pieces_are_those_in_one(seed, monkeypatch):
    """Of 53 robots and targets of four coordinates one piece took 1.9 s, which no limit and no interrupt ended."""
    problem, plan = team_problem(seed, 9)
    team, rng, asked = PricedTeam.of(problem.objective, plan), np.random.default_rng(seed), []
    group, nobody = rng.random(9) < 0.8, np.zeros(9, dtype=np.bool_)
    most = problem.objective([plan[i] for i in np.flatnonzero(group)])
    for blinded in range(int(group.sum()) + 1):
        for threshold, limit in zip(rng.uniform(0, 1.1, 8) * most, (1, 2, 5, 6, 20, 100, 10**4, 10**4), strict=True):
            monkeypatch.setattr(blinding, "AT_ONCE", 10**6)
            whole = weak_subset(team, nobody, group, blinded, threshold, limit, nobody.copy()) != ABSENT
            for pieces in (1, 3, 10**6):
                monkeypatch.setattr(blinding, "AT_ONCE", pieces)
                found = may_be_weak(team, group, blinded, threshold, limit, lambda: asked.append(1))
                assert found == whole
    assert len(asked) > 9 * 8 * 3 // 2


def fitted_forms(threat, prices=None):
    """Fitted to prices (N,), as after some thousand nodes, or not yet."""
    forms = ConvexForms(threat)
    if prices is not None:
        forms.fit(prices, len(prices), Budget())
    return forms


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


def paying_groups(problem, plan, question, prices):
    """Connected groups and the fewest blinded robots they need, by the definition."""
    (threshold, limit), (robot, blinded), answer = question, prices, {}
    graph, protected = problem.communication, problem.protected_robots
    for group in (s for k in range(1, 8) for s in combinations(range(7), k)):
        crossing = [link for link in graph.links if (link[0] in group) != (link[1] in group)]
        if len(graph.groups_among(frozenset(group))) > 1 or set(crossing) & problem.protected_links:
            continue
        free = [i for i in group if i not in protected]
        needs = (
            k
            for k in range(min(len(free), problem.threat.n_blinded) + 1)
            if any(
                problem.objective([plan[i] for i in group if i not in out]) < threshold for out in combinations(free, k)
            )
        )
        need = next(needs, None)
        if need is not None and len(crossing) / 2 + blinded * need - robot[list(group)].sum() <= limit:
            answer[group] = need
    return answer


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


def reduced_cost(problem, part, prices):
    """By the definition, of a group given as what each robot is to it."""
    inside = set(np.flatnonzero(part).tolist())
    crossing = [link for link in problem.communication.links if len(inside & set(link)) == 1]
    return len(crossing) / 2 + prices[1] * int((part == BLINDED).sum()) - prices[0][sorted(inside)].sum()


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


@pytest.mark.parametrize("seed", range(6))
def test_every_choice_of_prices_claims_what_it_says_and_no_known_group_pays_it(seed):
    problem, _ = team_problem(2 * seed, 6, graph=nx.complete_graph(6))
    rng, threat = np.random.default_rng(seed), problem.threat
    prices = GroupPrices(threat)
    groups = [
        KnownGroup(robots=np.array([bool(mask >> i & 1) for i in range(6)]), need=int(rng.integers(0, 3)), value=0.0)
        for mask in {*rng.integers(1, 63, 20).tolist(), 1, 2, 4, 8, 16, 32}
    ]
    prices.add(groups)
    found = prices.solve(1.0)
    links = 0.6 * found.links
    scaled, for_robots = found.scaled(links), found.for_robots(links, threat.n_blinded)
    dearest = prices.dearest(1.0, links)
    for chosen in (scaled, prices.slackest(1.0, links), for_robots, dearest):
        assert chosen is not None
        assert chosen.links == pytest.approx(links)
        assert chosen.links == pytest.approx(chosen.robot.sum() - chosen.blinded * threat.n_blinded)
        paid = [chosen.robot[group.robots].sum() - chosen.blinded * group.need for group in groups]
        assert all(p <= prices.half_cut(group.robots) + 1e-6 for p, group in zip(paid, groups, strict=True))
    assert dearest.blinded >= found.blinded
    assert prices.solve(1.0).links == pytest.approx(found.links)
    assert prices.dearest(1.0, found.links + 1.0) is None


@pytest.mark.parametrize("seed", range(12))
def test_prices_for_dear_blinded_robots_hold_while_groups_are_added(seed):
    """The price of a blinded robot stays while enough can be claimed at it, and is chosen again where it cannot."""
    problem, _ = team_problem(2 * seed, 6, graph=nx.complete_graph(6))
    rng, threat = np.random.default_rng(seed), problem.threat
    prices = GroupPrices(threat)
    groups = [KnownGroup(robots=np.arange(6) == i, need=0, value=0.0) for i in range(6)]
    prices.add(groups)
    links, chosen = 0.25 * prices.solve(1.0).links, list[float]()
    for mask in rng.permutation(np.arange(1, 64)).tolist():
        dear = prices.dearest(1.0, links)
        assert (dear is not None) == (prices.solve(1.0).links >= links)
        if dear is not None:
            assert dear.links == pytest.approx(links)
            paid = [dear.robot[group.robots].sum() - dear.blinded * group.need for group in groups]
            assert all(p <= prices.half_cut(group.robots) + 1e-6 for p, group in zip(paid, groups, strict=True))
            chosen.append(dear.blinded)
        robots = np.array([bool(mask >> i & 1) for i in range(6)])
        groups.append(KnownGroup(robots=robots, need=int(rng.integers(0, 3)), value=0.0))
        prices.add(groups[-1:])
    assert len(set(chosen)) < len(chosen)


def least_cost(problem, plan, threshold, prices, *, connected=False):
    """The cheapest reduced cost by the definition: every set of robots, or every connected one, however blinded."""
    n_robots, least = problem.n_robots, np.inf
    for size in range(1, n_robots + 1):
        for group in combinations(range(n_robots), size):
            crossing = {link for link in problem.communication.links if len(set(group) & set(link)) == 1}
            if crossing & problem.protected_links:
                continue
            if connected and not nx.is_connected(problem.graph.subgraph(group)):
                continue
            free = [i for i in group if i not in problem.protected_robots]
            for blinded in range(min(problem.threat.n_blinded, len(free)) + 1):
                for out in combinations(free, blinded):
                    if problem.objective([plan[i] for i in group if i not in out]) < threshold:
                        cost = len(crossing) / 2 + prices[1] * blinded - prices[0][list(group)].sum()
                        least = min(least, cost)
    return least


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


@pytest.mark.parametrize("seed", range(5))
@pytest.mark.parametrize("seconds", [2.0, 3.0, 7.0])
def test_thresholds_are_within_reach_of_the_seconds_left(seed, seconds, monkeypatch):
    """Each refutation takes a second; the last step is a small one, as one that does not end proves nothing."""
    problem, plan = team_problem(seed, 5)
    clock, asked = [0.0], []

    def decide(_decision, threshold, _budget, _nodes):
        asked.append(threshold)
        clock[0] += 1.0
        return Answer(verdict=Threshold.REFUTED)

    values, nothing, budget = PlanValues(problem, plan), ro.Attack(), Budget(time_limit=seconds)
    monkeypatch.setattr(price_search.ThresholdDecision, "decide", decide)
    checked, start = Budget.__post_init__, budget.started

    def begin(part):
        checked(part)
        part.started = start + clock[0]

    monkeypatch.setattr(Budget, "__post_init__", begin)
    monkeypatch.setattr("ratt_opt.budget.monotonic", lambda: start + clock[0])
    bracket = AttackBracket(nothing, problem.team_value(plan, nothing), 0.0)
    task = AttackTask(problem, values, bracket, budget)
    with pytest.raises(OutOfBudget):
        PriceSearch(task, PricedTeam.of(problem.objective, values.plan)).run()
    steps = np.diff([0.0, *asked]) / (bracket.upper - np.array([0.0, *asked[:-1]]))
    assert len(asked) == seconds
    assert steps[0] == pytest.approx(0.5)
    assert steps[-1] == pytest.approx(0.25)
