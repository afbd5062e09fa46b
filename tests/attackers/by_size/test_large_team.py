from __future__ import annotations

from contextlib import suppress
from dataclasses import replace
from itertools import combinations

import numpy as np
import pytest

import ratt_opt as ro
from ratt_opt.attackers.by_size import (
    group_exchanges,
    largest_first,
    low_lists,
    packing,
    size_vector_search,
    vector_search,
    weak_families,
)
from ratt_opt.attackers.by_size.size_vector_search import SizeVectorSearch
from ratt_opt.attackers.first_bound import first_bound
from ratt_opt.attackers.task import AttackBracket, AttackTask, PlanValues
from ratt_opt.attackers.weakest_set import branch_and_bound
from ratt_opt.attackers.weakest_set.branch_and_bound import WeakestSetSearch
from ratt_opt.attackers.weakest_set.enumeration import Enumeration
from ratt_opt.attackers.weakest_set.exchanges import exchanged, weak_sets_of_size
from ratt_opt.attackers.weakest_set.linear_descent import descended
from ratt_opt.attackers.weakest_set.minorant import affine_minorant
from ratt_opt.attackers.weakest_set.packed_team import PackedTeam
from ratt_opt.attackers.weakest_set.weakest_axis import weakest_axis
from ratt_opt.budget import Budget, OutOfBudget
from tests.brackets import attained, attains, worst_value
from tests.strategies import OBJECTIVES, information_data, random_elements, range_bearing


def team_problem(seed, n_robots, name, *, protect=False):
    rng = np.random.default_rng(seed)
    data = range_bearing(rng, n_robots, 4, 3) if seed % 2 else information_data(rng, 3 * n_robots, 3)
    links = n_robots * (n_robots - 1) // 2
    protected = frozenset(i for i in range(n_robots) if protect and rng.random() < 0.3)
    owners = np.repeat(np.arange(n_robots), 3)
    budgets = int(rng.integers(0, n_robots)), int(rng.integers(0, links + 1))
    weights = rng.uniform(0.2, 3, len(data[0])) if seed % 4 == 0 else None
    problem = ro.Problem(OBJECTIVES[name](*data, weights), owners, None, *budgets, protected)
    return problem, random_elements(rng, problem)


def run_large(problem, elements, max_nodes=None):
    """The large-team search, also where ``worst_case_attack`` would use the one for small teams."""
    values = PlanValues(problem, elements)
    start = ro.bounded_rational_attack(problem, elements)
    bracket, budget = AttackBracket(start.attack, attained(problem, elements, start), 0.0), Budget(max_nodes=max_nodes)
    team = PackedTeam.planar(problem.objective, values.plan)
    try:
        stop = SizeVectorSearch(AttackTask(problem, values, bracket, budget), team).run()
    except OutOfBudget as out:
        stop = out.stop
    return bracket, budget.nodes, stop


def only_branch(monkeypatch):
    """No lists and hardly any enumeration, so that bounds and branches decide."""
    monkeypatch.setattr(size_vector_search, "MAYBE_SHORT", -1)
    monkeypatch.setattr(size_vector_search, "LISTED_WHOLE", 0)
    monkeypatch.setattr(size_vector_search, "LONGEST_LIST", -1)
    monkeypatch.setattr(branch_and_bound, "AT_ONCE", 0)
    monkeypatch.setattr(branch_and_bound, "SHORTEST_ENUMERATION", 1)
    monkeypatch.setattr(branch_and_bound, "LONGEST_ENUMERATION", 1)


def pack_again(monkeypatch):
    """The same, and no list for the other groups either: what is packed around a largest one is given up at first."""
    only_branch(monkeypatch)
    monkeypatch.setattr(packing, "LONGEST_PACKING", -1)
    monkeypatch.setattr(largest_first, "FIRST_EFFORT", 3)
    monkeypatch.setattr(largest_first, "MORE_EFFORT", 4)


@pytest.mark.parametrize("name", OBJECTIVES)
@pytest.mark.parametrize("seed", range(25))
@pytest.mark.parametrize("way", ["at once", "lists", "divided", "branches", "packed"])
def test_agrees_with_the_threshold_search(name, seed, way, monkeypatch):
    """By one list; by lists and a search for disjoint sets; by divided nodes and bounds alone; by branches with hardly
    any list; by packing the largest of the other groups first."""
    if way == "lists":
        monkeypatch.setattr(size_vector_search, "MAYBE_SHORT", -1)
    if way == "branches":
        only_branch(monkeypatch)
    if way == "packed":
        pack_again(monkeypatch)
    if way == "divided":
        monkeypatch.setattr(vector_search, "LOOKS", 0)
        monkeypatch.setattr(vector_search, "FEW_CHOICES", seed % 3)
        monkeypatch.setattr(vector_search, "FEW_SETS", 10)
        monkeypatch.setattr(weak_families, "SHAKEN", 0)
    problem, elements = team_problem(seed, 4 + seed % 6, name, protect=seed % 3 == 0)
    expected = worst_value(problem, elements)
    bracket, _, stop = run_large(problem, elements)
    assert bracket.upper == pytest.approx(expected, rel=2e-10, abs=1e-12)
    assert bracket.lower <= expected + 1e-12
    assert bracket.upper - bracket.lower <= 1.1e-10 * abs(bracket.upper) + 1e-12
    assert stop is ro.Stop.CLOSED
    assert attained(problem, elements, bracket) == bracket.upper


@pytest.mark.parametrize("name", OBJECTIVES)
@pytest.mark.parametrize("seed", range(40))
def test_shares_that_end_anywhere_lose_no_set(name, seed, monkeypatch):
    """Where a share ended while the groups around sets were packed, the next one closed the bracket without them."""
    pack_again(monkeypatch)
    problem, elements = team_problem(seed, 6 + seed % 4, name, protect=seed % 3 == 0)
    expected, values = worst_value(problem, elements), PlanValues(problem, elements)
    start = ro.bounded_rational_attack(problem, elements)
    bracket, team = (
        AttackBracket(start.attack, attained(problem, elements, start), 0.0),
        PackedTeam.planar(problem.objective, values.plan),
    )
    search = SizeVectorSearch(AttackTask(problem, values, bracket, Budget()), team)
    search.bounds = dict.fromkeys(search.vectors, -np.inf)
    stop, nodes = None, 1
    while stop is not ro.Stop.CLOSED and nodes < 1e5:
        with suppress(OutOfBudget):
            search.task = replace(search.task, budget=Budget(max_nodes=int(nodes)))
            stop = search.decide_by_largest()
        assert bracket.lower <= expected + 1e-12
        nodes *= 1.3
    assert bracket.upper == pytest.approx(expected, rel=2e-10, abs=1e-12)


@pytest.mark.parametrize("name", OBJECTIVES)
@pytest.mark.parametrize("seed", range(30))
def test_first_bounds_hold(name, seed):
    problem, elements = team_problem(seed, 3 + seed % 6, name, protect=seed % 2 == 0)
    assert (
        first_bound(problem.objective, elements, problem.threat)
        <= ro.worst_case_attack(problem, elements).upper + 1e-12
    )


@pytest.mark.parametrize("name", OBJECTIVES)
@pytest.mark.parametrize("blinded", [0, 2])
def test_many_equal_groups_close(name, blinded):
    """The class of budgets between the paper's: several groups of the same size, hardly anybody blinded."""
    rng = np.random.default_rng(blinded)
    n_robots = 14 + blinded
    data = range_bearing(rng, n_robots, 6, 1)
    groups = 14 * 3 // 2 + 2 * blinded
    links = n_robots * (n_robots - 1) // 2
    problem = ro.Problem(OBJECTIVES[name](*data), np.arange(n_robots), None, blinded, links - groups)
    result = ro.worst_case_attack(problem, np.arange(n_robots), time_limit=60)
    assert result.stop is ro.Stop.CLOSED
    assert result.upper - result.lower <= 1e-9 * result.upper
    assert result.upper <= ro.greedy_attack(problem, np.arange(n_robots)).upper


@pytest.mark.parametrize("name", OBJECTIVES)
@pytest.mark.parametrize("seed", [1, 2])
@pytest.mark.parametrize("limits", [None, only_branch, pack_again])
def test_the_bracket_is_valid_at_every_node_count(name, seed, limits, monkeypatch):
    if limits is not None:
        limits(monkeypatch)
    monkeypatch.setattr(low_lists, "NODES_OF_A_LOOK", 3)
    problem, elements = team_problem(seed, 8, name)
    problem = ro.Problem(problem.objective, problem.robot, None, 2, 9)
    expected = worst_value(problem, elements)
    _, nodes, _ = run_large(problem, elements)
    previous = 0.0
    for limit in [*range(min(nodes, 150)), nodes, nodes + 1]:
        bracket, used, stop = run_large(problem, elements, limit)
        assert used <= limit
        assert bracket.lower <= expected * (1 + 1e-12) + 1e-12
        assert bracket.upper >= expected * (1 - 2e-10)
        assert bracket.lower >= previous
        previous = bracket.lower
        assert (stop is ro.Stop.NODES) == (limit < nodes)


@pytest.mark.parametrize("name", ["trace", "logdet"])
@pytest.mark.parametrize("seed", range(12))
def test_minorants_lie_below_every_set(name, seed):
    """Also where robots repeat, see nothing, or see along one line only."""
    rng = np.random.default_rng(seed)
    n_robots, size = 9, int(rng.integers(1, 9))
    data = range_bearing(rng, n_robots, 4, 1) if seed % 2 else information_data(rng, n_robots, 4)
    data[1][3] = data[1][2]
    data[1][4] = 0.0
    team = PackedTeam.planar(OBJECTIVES[name](*data), np.arange(n_robots))
    minorant = affine_minorant(team.family(np.arange(n_robots), size), 2, np.inf)
    slack = [
        team.value(chosen) - minorant.constant - minorant.scores[list(chosen)].sum()
        for chosen in combinations(range(n_robots), size)
    ]
    assert min(slack) >= -1e-9
    # Not vacuous on sensor data (rank-one information can defeat the outer polytopes; the bound is then weak).
    best = min(team.value(chosen) for chosen in combinations(range(n_robots), size))
    bound = minorant.constant + np.sort(minorant.scores)[:size].sum()
    assert bound <= best + 1e-9
    assert seed % 2 == 0 or bound >= 0.3 * best - 1e-9


@pytest.mark.parametrize("name", OBJECTIVES)
@pytest.mark.parametrize("seed", range(10))
def test_all_sets_below_a_threshold_are_enumerated(seed, name):
    rng = np.random.default_rng(seed)
    team = PackedTeam.planar(OBJECTIVES[name](*information_data(rng, 8, 3)), np.arange(8))
    values = {frozenset(s): team.value(s) for s in combinations(range(8), 4)}
    threshold = float(np.median(list(values.values())))
    sets, found = Enumeration(team, np.arange(8), frozenset(), 4), set()
    while not sets.finished:
        one = sets.next_below(threshold, sets.nodes + 7)
        if one is not None:
            found.add(one)
    assert found == {s for s, value in values.items() if value < threshold}


@pytest.mark.parametrize("name", OBJECTIVES)
def test_a_team_of_twenty_closes_and_is_beaten_by_no_local_search(name):
    rng = np.random.default_rng(5)
    problem = ro.Problem(OBJECTIVES[name](*range_bearing(rng, 20, 20)), np.repeat(np.arange(20), 12), None, 10, 63)
    plan = ro.ratt(problem).elements
    result = ro.worst_case_attack(problem, plan)
    assert result.stop is ro.Stop.CLOSED
    assert result.upper - result.lower <= 1e-9 * result.upper
    assert result.upper <= ro.greedy_attack(problem, plan).upper
    team = PackedTeam.planar(problem.objective, plan)
    weakest = min(team.value(rng.choice(20, 7, replace=False)) for _ in range(3000))
    assert result.lower <= weakest
    again = ro.worst_case_attack(problem, plan)
    assert (again.attack, again.nodes) == (result.attack, result.nodes)


def test_everyone_blinded():
    rng = np.random.default_rng(0)
    problem = ro.Problem(OBJECTIVES["trace"](*range_bearing(rng, 14, 2, 1)), np.arange(14), None, 14, 3)
    result = ro.worst_case_attack(problem, np.arange(14))
    assert (result.lower, result.upper, result.stop) == (0.0, 0.0, ro.Stop.CLOSED)


@pytest.mark.parametrize("seed", range(20))
def test_the_weakest_axis_is_the_weakest_set(seed):
    rng = np.random.default_rng(seed)
    n_robots, size = 8, int(rng.integers(0, 9))
    data = range_bearing(rng, n_robots, 3, 1) if seed % 2 else information_data(rng, n_robots, 3)
    team = PackedTeam.planar(ro.MaxEigenvalueObjective(*data, rng.uniform(0.5, 2, 3)), np.arange(n_robots))
    axis = weakest_axis(team.family(np.arange(n_robots), size))
    weakest = min(team.value(chosen) for chosen in combinations(range(n_robots), size))
    assert axis.bound <= weakest + 1e-12
    assert axis.bound == pytest.approx(weakest, rel=1e-8, abs=1e-8)
    assert team.value(axis.chosen.tolist()) == pytest.approx(weakest, rel=1e-8, abs=1e-8)


@pytest.mark.parametrize("calls", range(1, 6))
def test_an_interrupt_returns_the_bracket_reached(calls, monkeypatch):
    """Wherever the interrupt lands: at the first bound, deep in the tree, or never."""
    only_branch(monkeypatch)
    rng = np.random.default_rng(2)
    problem = ro.Problem(OBJECTIVES["trace"](*range_bearing(rng, 13, 4, 1)), np.arange(13), None, 3, 20)
    expected = ro.worst_case_attack(problem, np.arange(13))
    assert expected.stop is ro.Stop.CLOSED
    left = [calls]

    def interrupted(*arguments):
        left[0] -= 1
        if left[0] == 0:
            raise KeyboardInterrupt
        return affine_minorant(*arguments)

    monkeypatch.setattr(branch_and_bound, "affine_minorant", interrupted)
    result = ro.worst_case_attack(problem, np.arange(13))
    assert result.stop is (ro.Stop.CLOSED if left[0] > 0 else ro.Stop.INTERRUPTED)
    assert result.lower <= expected.upper <= result.upper * (1 + 1e-9)
    assert attains(problem, np.arange(13), result)


def searched_in_pieces(name, n_robots, nodes, growth):
    """The search for some twenty weak sets of five robots, in budgets each so many times the last; how many it took."""
    objective = OBJECTIVES[name](*range_bearing(np.random.default_rng(5), n_robots, 4, 1))
    team = PackedTeam.planar(objective, np.arange(n_robots))
    values = {frozenset(one): team.value(one) for one in combinations(range(n_robots), 5)}
    threshold = float(np.mean(sorted(values.values())[20:22]))
    search, found, runs = WeakestSetSearch(team, 5, threshold), set(), 0
    while search.lower < np.inf:
        with suppress(OutOfBudget):
            for one in search.run(Budget(max_nodes=int(nodes * growth**runs))):
                found |= {one} if one is not None else set()
        left = [value for one, value in values.items() if value < threshold and one not in found]
        assert search.lower <= min(left, default=np.inf) + 1e-9
        runs += 1
    assert found == {one for one, value in values.items() if value < threshold}
    return search, runs


@pytest.mark.parametrize("name", ["trace", "logdet"])
def test_a_search_of_weak_sets_goes_on_where_it_ended(name, monkeypatch):
    only_branch(monkeypatch)
    _, runs = searched_in_pieces(name, 13, 2, 1.0)
    assert runs > 2


@pytest.mark.parametrize("whole", [0, 500, 20_000, 10**9])
@pytest.mark.parametrize("name", ["trace", "logdet"])
def test_a_small_team_is_enumerated_whole_only_before_it_is_divided(name, whole, monkeypatch):
    """Enumerated again after that, from one of its parts, sets of the others were lost; after the end it raised."""
    for limit, value in {"WHOLE_ENUMERATION": whole, "SHORTEST_ENUMERATION": 1, "LONGEST_ENUMERATION": 1}.items():
        monkeypatch.setattr(branch_and_bound, limit, value)
    search, _ = searched_in_pieces(name, 12, 1.2, 1.2)
    assert not list(search.run(Budget()))


@pytest.mark.parametrize("protected", [frozenset(), frozenset({0, 5, 9})])
def test_relabelling_a_large_team_changes_nothing(protected):
    rng = np.random.default_rng(8)
    data = range_bearing(rng, 15, 5, 1)
    order = rng.permutation(15)
    values = []
    for new in (np.arange(15), order):
        information = np.empty_like(data[1])
        information[new] = data[1]
        kept = frozenset(int(new[i]) for i in protected)
        problem = ro.Problem(ro.LogDetObjective(data[0], information), np.arange(15), None, 4, 26, kept)
        values.append(ro.worst_case_attack(problem, np.arange(15)).upper)
    assert values[0] == pytest.approx(values[1], rel=1e-9)


@pytest.mark.parametrize("name", OBJECTIVES)
@pytest.mark.parametrize("seed", range(8))
def test_no_exchange_lowers_a_weak_set(name, seed):
    rng = np.random.default_rng(seed)
    n_robots, size = 11, int(rng.integers(1, 11))
    data = range_bearing(rng, n_robots, 4, 1) if seed % 2 else information_data(rng, n_robots, 3)
    team = PackedTeam.planar(OBJECTIVES[name](*data), np.arange(n_robots))
    found = weak_sets_of_size(team, size)
    values = [team.value(robots) for robots in found]
    assert values == sorted(values)
    assert found == weak_sets_of_size(team, size)
    for robots, value in zip(found, values, strict=True):
        others = set(range(n_robots)) - robots
        lowest = min(team.value(robots - {i} | {e}) for i in robots for e in others)
        assert len(robots) == size
        assert lowest >= value - 1e-9 * max(abs(value), 1.0)
    best = min(team.value(robots) for robots in combinations(range(n_robots), size))
    assert values[0] <= best + 0.05 * abs(best), "one of many starts comes near the weakest set"


@pytest.mark.parametrize("name", OBJECTIVES)
@pytest.mark.parametrize("seed", range(8))
def test_exchanges_keep_fixed_robots_and_stay_among_those_allowed(name, seed):
    rng = np.random.default_rng(seed)
    team = PackedTeam.planar(OBJECTIVES[name](*range_bearing(rng, 12, 4, 1)), np.arange(12))
    among = frozenset(rng.permutation(12)[:9].tolist())
    start = frozenset(sorted(among)[:5])
    fixed = frozenset(sorted(start)[:2])
    reached = exchanged(team, start, among=among, fixed=fixed)
    assert fixed <= reached <= among
    assert len(reached) == len(start)
    assert team.value(reached) <= team.value(start) + 1e-12
    lowest = min(team.value(reached - {i} | {e}) for i in reached - fixed for e in among - reached)
    assert lowest >= team.value(reached) - 1e-9 * max(team.value(reached), 1.0)
    assert exchanged(team, start, among=start) == start


@pytest.mark.parametrize("name", OBJECTIVES)
@pytest.mark.parametrize("seed", range(6))
def test_linear_descent_ends_no_higher_and_where_no_step_leads_on(name, seed):
    problem, elements = team_problem(seed, 14, name)
    team = PackedTeam.planar(problem.objective, elements)
    rng = np.random.default_rng(seed)
    start = rng.permutation(14)[: int(rng.integers(1, 14))]
    found = descended(team, start)
    assert len(set(found.tolist())) == len(start)
    assert team.value(found) <= team.value(start)
    assert team.value(descended(team, found)) == team.value(found)


@pytest.mark.parametrize("name", ["trace", "logdet"])
def test_large_teams_start_from_where_linear_descent_ends(name, monkeypatch):
    """With time for one exchange only, that is much of what the attack is."""
    monkeypatch.setattr(group_exchanges, "AT_ONCE", 0)
    found = {0: 0.0, 10**9: 0.0}
    for seed in range(4):
        problem = ro.random_scenario(40, 12, alpha_s=4, alpha_c=40, seed=seed).problem(name)
        values = PlanValues(problem, ro.ratt(problem).elements)
        team = PackedTeam.planar(problem.objective, values.plan)
        task = AttackTask(problem, values, AttackBracket(ro.Attack(), np.inf, 0.0), Budget(time_limit=0))
        sizes = SizeVectorSearch(task, team).vectors[0]
        for large in found:
            monkeypatch.setattr(weak_families, "AT_ONCE", large)
            found[large] += weak_families.WeakFamilies(task, team)._settled(sizes, task.budget).value
    assert found[0] < found[10**9]


def test_exchanges_that_do_not_end_leave_time_for_bounds(monkeypatch):
    monkeypatch.setattr(group_exchanges, "_exchange", lambda *_: (1e9, False))
    problem = ro.random_scenario(40, 4, alpha_s=4, alpha_c=40, seed=1).problem("logdet")
    values = PlanValues(problem, ro.ratt(problem).elements)
    team = PackedTeam.planar(problem.objective, values.plan)
    task = AttackTask(problem, values, AttackBracket(ro.Attack(), np.inf, 0.0), Budget(time_limit=2.0))
    search = SizeVectorSearch(task, team)
    assert search.weak.exchanged(search.vectors)
    assert not task.budget.is_over
