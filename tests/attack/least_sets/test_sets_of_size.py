"""Sets of one size below a threshold, against all sets: found once each, listed, bounded, with costs, in pieces."""

from itertools import combinations
from time import process_time

import numpy as np
import pytest

from ratt_opt.attack.least_sets.sets_of_size import BoundedSets, SetSearch
from ratt_opt.attack.team import Team
from ratt_opt.budget import Budget
from tests.strategies import OBJECTIVES, information_data

ROUNDING = 1e-9


def drawn(name, seed):
    """A team of up to nine robots; some tell nothing, some tell the same."""
    rng = np.random.default_rng(seed)
    n_robots, dimension = int(rng.integers(2, 10)), int(rng.choice([2, 2, 3, 4]))
    prior, information = information_data(rng, n_robots, int(rng.integers(1, 4)), dimension)
    if seed % 3 == 0:
        information[rng.integers(n_robots)] = 0.0
    if seed % 4 == 0:
        information[0] = information[-1]
    team = Team.of(OBJECTIVES[name](prior, information), np.arange(n_robots))
    return rng, team, n_robots


def found_by(search, pause):
    found = []
    while (one := search.next(pause)) is not False:
        if one is not None:
            found.append(frozenset(np.flatnonzero(one).tolist()))
    return found


@pytest.mark.parametrize("name", OBJECTIVES)
@pytest.mark.parametrize("seed", range(60))
def test_every_set_below_is_found_once(name, seed):
    rng, team, n_robots = drawn(name, seed)
    robots = rng.permutation(n_robots)
    inside, among = robots[: rng.integers(0, 3)], robots[3:] if n_robots > 4 else robots[2:]
    among = among[~np.isin(among, inside)]
    costs = rng.normal(size=n_robots) if seed % 2 else None
    for size in range(1, len(among) + 1):
        sets = [frozenset([*one, *inside.tolist()]) for one in combinations(among.tolist(), size)]
        values = {one: team.value(one) for one in sets}
        paid = {one: 0.0 if costs is None else costs[list(one - set(inside.tolist()))].sum() for one in sets}
        threshold = float(rng.choice([*values.values(), 2 * max(values.values())])) * float(
            rng.choice([1.0, 1.0 + 1e-6])
        )
        limit = np.inf if costs is None else float(np.median(list(paid.values())))
        search = SetSearch(
            team, size, threshold, among=among, inside=np.isin(np.arange(n_robots), inside), costs=costs,
            limit=limit, in_order=seed % 5 == 0,
        )  # fmt: skip
        found = found_by(search, int(rng.choice([1, 3, 10**6])))
        assert len(found) == len(set(found))
        sure = {one for one in sets if values[one] < threshold - ROUNDING and paid[one] < limit - ROUNDING}
        assert sure <= set(found)
        assert all(values[one] < threshold + ROUNDING and paid[one] < limit + ROUNDING for one in found)


@pytest.mark.parametrize("name", OBJECTIVES)
@pytest.mark.parametrize("seed", range(30))
def test_what_is_open_is_worth_what_is_said(name, seed):
    """However far a search has come, and with a threshold that falls."""
    rng, team, n_robots = drawn(name, seed)
    for size in range(2, n_robots + 1):
        values = {frozenset(one): team.value(one) for one in combinations(range(n_robots), size)}
        threshold = float(np.quantile(list(values.values()), rng.uniform(0.3, 1.0)))
        search, found = SetSearch(team, size, threshold), set()
        while (one := search.next(1)) is not False:
            if one is not None:
                found.add(frozenset(np.flatnonzero(one).tolist()))
                if seed % 2:
                    threshold = team.value(max(found, key=values.__getitem__))
                    search.lower(threshold)
            left = [value for one, value in values.items() if one not in found]
            assert min(search.least_open, threshold) <= min([*left, np.inf]) + ROUNDING
        assert search.least_open == np.inf


@pytest.mark.parametrize("name", OBJECTIVES)
@pytest.mark.parametrize("seed", range(20))
def test_lists_hold_the_same_sets(name, seed):
    rng, team, n_robots = drawn(name, seed)
    size = int(rng.integers(1, n_robots + 1))
    values = {sum(1 << i for i in one): team.value(one) for one in combinations(range(n_robots), size)}
    threshold = float(np.median(list(values.values()))) + 1e-6
    search, masks, listed, count = SetSearch(team, size, threshold), np.zeros(200, np.uint64), np.zeros(200), 0
    finished = False
    while not finished:
        count, finished = search.fill(2, masks, listed, count)
    assert sorted(masks[:count].tolist()) == sorted(one for one, value in values.items() if value < threshold)
    assert all(
        value == pytest.approx(values[mask]) for mask, value in zip(masks[:count].tolist(), listed, strict=False)
    )


@pytest.mark.parametrize("seed", range(20))
def test_an_underestimator_leaves_out_no_set_below(seed):
    """Any affine function that is nowhere above the value."""
    rng, team, n_robots = drawn("logdet", seed)
    size = int(rng.integers(1, n_robots + 1))
    values = {frozenset(one): team.value(one) for one in combinations(range(n_robots), size)}
    scores = rng.uniform(size=n_robots) * max(values.values()) / size
    constant = min(value - scores[list(one)].sum() for one, value in values.items())
    threshold = float(np.median(list(values.values()))) + 1e-6
    order = rng.permutation(n_robots)
    sets, found = BoundedSets(team, order, (), size, threshold, (constant, scores[order])), set()
    while (one := sets.next(threshold, 10**6, Budget())) is not False:
        if one is not None:
            found.add(one)
    assert found == {one for one, value in values.items() if value < threshold}


def test_a_limit_is_met_however_long_a_value_takes():
    """Values of the largest eigenvalue of six coordinates: a count of partial sets took 15 s between two looks."""
    rng = np.random.default_rng(0)
    team = Team.of(OBJECTIVES["maxeig"](*information_data(rng, 40, 4, 6)), np.arange(40))
    threshold = 0.97 * min(team.value(rng.choice(40, 34, replace=False)) for _ in range(200))
    sets, began = BoundedSets(team, np.arange(40), [], 34, threshold), process_time()
    assert sets.next(threshold, 10**6, Budget(0.05)) is None
    assert process_time() - began < 0.35
