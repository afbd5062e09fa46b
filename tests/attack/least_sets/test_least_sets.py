"""Bounds, lists and exchanges of sets of one size, against all of them."""

from __future__ import annotations

from contextlib import suppress
from itertools import combinations

import numpy as np
import pytest

import ratt_opt as ro
from ratt_opt import AttackParams
from ratt_opt.attack.least_sets.exchanges import descended, exchanged, weak_sets_of_size
from ratt_opt.attack.least_sets.least_set_search import LeastSetSearch
from ratt_opt.attack.least_sets.sets_of_size import SetFamily
from ratt_opt.attack.least_sets.underestimator import affine_underestimator
from ratt_opt.attack.least_sets.weakest_axis import weakest_axis
from ratt_opt.attack.params.least_sets import SetSearchParams
from ratt_opt.attack.team import Team
from ratt_opt.budget import Budget, OutOfBudget
from tests.attack.engine import NO_LISTS
from tests.strategies import OBJECTIVES, information_data, range_bearing
from tests.ways import with_params


@pytest.mark.parametrize("name", OBJECTIVES)
@pytest.mark.parametrize("dimension", [1, 3, 4, 5])
def test_bounds_lists_and_exchanges_of_sets_of_one_size(name, dimension):
    rng = np.random.default_rng(dimension)
    for _ in range(6):
        objective = OBJECTIVES[name](*information_data(rng, 9, 3, dimension), rng.uniform(0.2, 3, 3))
        team, chosen = Team.of(objective, np.arange(9)), (2,)
        assert team.single == pytest.approx(objective.singletons())
        assert team.traces == pytest.approx(np.trace(objective.information, axis1=-2, axis2=-1))
        others = [i for i in range(9) if i not in chosen]
        for size in range(1, 6):
            values = {frozenset(s): objective([*chosen, *s]) for s in combinations(others, size)}
            threshold = float(np.median(list(values.values())))
            outside = frozenset(range(9)) - {*others, *chosen}
            search, found = LeastSetSearch(team, size + 1, threshold, inside=frozenset(chosen), outside=outside), set()
            found = {one - set(chosen) for one in search.run(Budget()) if one is not None}
            near = {s for s, value in values.items() if abs(value - threshold) <= 1e-9 * abs(threshold)}
            assert found - near == {s for s, value in values.items() if value < threshold} - near
            weakest = weak_sets_of_size(team, size)[0]
            assert objective(sorted(weakest)) >= min(map(objective, combinations(range(9), size))) - 1e-9
            start = np.arange(size)
            assert objective(sorted(descended(team, start).tolist())) <= objective(start) + 1e-9


@pytest.mark.parametrize("name", ["trace", "logdet"])
@pytest.mark.parametrize("seed", range(5))
def test_division_loses_no_set_where_robots_see_few_targets(name, seed):
    """Multipliers grow without bound there, and what cancels in sums of them is rounding."""
    rng = np.random.default_rng(seed)
    prior, information = range_bearing(rng, 9, 8, 1)
    information[rng.random((9, 8)) < 0.7] = 0.0
    divided = AttackParams(set_search=SetSearchParams(whole=((10**9, 3),), most=2))
    team, size = Team.of(OBJECTIVES[name](prior, information), np.arange(9), divided), 4
    values = {frozenset(one): team.value(one) for one in combinations(range(9), size)}
    threshold = float(np.quantile(list(values.values()), rng.uniform(0.2, 1)))
    found = {one for one in LeastSetSearch(team, size, threshold).run(Budget()) if one is not None}
    near = {s for s, value in values.items() if abs(value - threshold) <= 1e-9 * abs(threshold)}
    assert found - near == {s for s, value in values.items() if value < threshold} - near


@pytest.mark.parametrize("name", ["trace", "logdet"])
@pytest.mark.parametrize("seed", range(12))
def test_underestimators_lie_below_every_set(name, seed):
    """Also where robots repeat, see nothing, or see along one line only."""
    rng = np.random.default_rng(seed)
    n_robots, size = 9, int(rng.integers(1, 9))
    data = range_bearing(rng, n_robots, 4, 1) if seed % 2 else information_data(rng, n_robots, 4)
    data[1][3] = data[1][2]
    data[1][4] = 0.0
    team = Team.of(OBJECTIVES[name](*data), np.arange(n_robots))
    underestimator = affine_underestimator(SetFamily.of(team, np.arange(n_robots), size), 2, np.inf)
    slack = [
        team.value(chosen) - underestimator.constant - underestimator.scores[list(chosen)].sum()
        for chosen in combinations(range(n_robots), size)
    ]
    assert min(slack) >= -1e-9
    # Not vacuous on sensor data (rank-one information can defeat the outer polytopes; the bound is then weak).
    best = min(team.value(chosen) for chosen in combinations(range(n_robots), size))
    bound = underestimator.constant + np.sort(underestimator.scores)[:size].sum()
    assert bound <= best + 1e-9
    assert seed % 2 == 0 or bound >= 0.3 * best - 1e-9


@pytest.mark.parametrize("seed", range(20))
def test_the_weakest_axis_is_the_weakest_set(seed):
    rng = np.random.default_rng(seed)
    n_robots, size = 8, int(rng.integers(0, 9))
    data = range_bearing(rng, n_robots, 3, 1) if seed % 2 else information_data(rng, n_robots, 3)
    team = Team.of(ro.MaxEigenvalueObjective(*data, rng.uniform(0.5, 2, 3)), np.arange(n_robots))
    axis = weakest_axis(SetFamily.of(team, np.arange(n_robots), size))
    weakest = min(team.value(chosen) for chosen in combinations(range(n_robots), size))
    assert axis.bound <= weakest + 1e-12
    assert axis.bound == pytest.approx(weakest, rel=1e-8, abs=1e-8)
    assert team.value(axis.chosen.tolist()) == pytest.approx(weakest, rel=1e-8, abs=1e-8)


def searched_in_pieces(name, n_robots, nodes, growth, params):
    """The search for some twenty weak sets of five robots, in budgets each so many times the last; how many it took."""
    objective = OBJECTIVES[name](*range_bearing(np.random.default_rng(5), n_robots, 4, 1))
    team = Team.of(objective, np.arange(n_robots), params)
    values = {frozenset(one): team.value(one) for one in combinations(range(n_robots), 5)}
    threshold = float(np.mean(sorted(values.values())[20:22]))
    search, found, runs = LeastSetSearch(team, 5, threshold), set(), 0
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
def test_a_search_of_weak_sets_goes_on_where_it_ended(name):
    _, runs = searched_in_pieces(name, 13, 2, 1.0, with_params(AttackParams(), NO_LISTS))
    assert runs > 2


@pytest.mark.parametrize("whole", [0, 10, 50, 10**9])
@pytest.mark.parametrize("name", OBJECTIVES)
def test_a_small_team_is_searched_whole_only_before_it_is_divided(name, whole):
    """Searched again after that, from one of its parts, sets of the others would be lost."""
    params = AttackParams(set_search=SetSearchParams(whole=((10**9, whole),), fewest=1, most=1))
    search, _ = searched_in_pieces(name, 12, 1.2, 1.2, params)
    assert not list(search.run(Budget()))


@pytest.mark.parametrize("name", OBJECTIVES)
@pytest.mark.parametrize("seed", range(8))
def test_no_exchange_lowers_a_weak_set(name, seed):
    rng = np.random.default_rng(seed)
    n_robots, size = 11, int(rng.integers(1, 11))
    data = range_bearing(rng, n_robots, 4, 1) if seed % 2 else information_data(rng, n_robots, 3)
    team = Team.of(OBJECTIVES[name](*data), np.arange(n_robots))
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
    team = Team.of(OBJECTIVES[name](*range_bearing(rng, 12, 4, 1)), np.arange(12))
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
    rng = np.random.default_rng(seed)
    data = range_bearing(rng, 14, 4, 1) if seed % 2 else information_data(rng, 14, 3)
    team = Team.of(OBJECTIVES[name](*data), np.arange(14))
    start = rng.permutation(14)[: int(rng.integers(1, 14))]
    found = descended(team, start)
    assert len(set(found.tolist())) == len(start)
    assert team.value(found) <= team.value(start)
    assert team.value(descended(team, found)) == team.value(found)
