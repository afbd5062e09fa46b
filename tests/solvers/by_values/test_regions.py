"""Sums of best elements whose robots may be exchanged: mean losses, blinded regions and their tree, by definition."""

from itertools import combinations, combinations_with_replacement

import numpy as np
import pytest

import ratt_opt as ro
from ratt_opt.solvers.by_values.mean_losses import MeanLosses
from ratt_opt.solvers.by_values.region_rows import RegionRows
from tests.attack.engine import NO_TABLES
from tests.solvers.maxmin.engine import NO_PLANS_LISTED
from tests.ways import go


def left_in(plans, utility, robots, lost):
    """(plans, sets lost, parts) the best utility that each set of lost robots leaves of each plan."""
    kept = list(combinations(range(robots), robots - lost))
    return np.array([[utility[:, np.array(plan)[list(k)]].max(axis=1, initial=0.0) for k in kept] for plan in plans])


def counts_of(plans, columns):
    return np.array([[plan.count(c) for c in range(columns)] for plan in plans], dtype=float)


@pytest.mark.parametrize(("robots", "lost"), [(4, 0), (4, 1), (5, 2), (4, 3), (3, 3)])
def test_mean_values_after_losses_are_bounded_for_every_plan(robots, lost):
    """By definition: each plan of some robots, columns chosen twice too, and each set of robots that may be lost."""
    rng = np.random.default_rng([robots, lost])
    utility = np.round(rng.random((2, 5)), 1)
    plans = list(combinations_with_replacement(range(5), robots))
    counts, means = counts_of(plans, 5), left_in(plans, utility, robots, lost).mean(axis=1)
    losses = MeanLosses(utility, robots, lost, 100)
    everything = np.ones(5, dtype=np.bool_)
    for share in (*counts[::7], *(rng.random((6, 5)) * 2)):
        constants, gains = losses.bounds(share)
        assert (gains >= 0).all()
        assert (constants + counts @ gains.T - means).min() >= -1e-15
        value = losses.values(share, everything[None], np.zeros(1, dtype=int))
        assert value == pytest.approx((constants + gains @ share).sum())
    for plan, mean in zip(counts, means, strict=True):
        constants, gains = losses.bounds(plan)
        assert constants + gains @ plan == pytest.approx(mean)


@pytest.mark.parametrize(("robots", "lost"), [(4, 1), (5, 2), (4, 3)])
def test_no_plan_that_chooses_little_in_a_region_keeps_more_than_its_loss_leaves(robots, lost):
    rng = np.random.default_rng([robots, lost, 1])
    utility = np.round(rng.random((3, 5)), 1)
    plans = list(combinations_with_replacement(range(5), robots))
    counts, worst = counts_of(plans, 5), left_in(plans, utility, robots, lost).sum(axis=2).min(axis=1)
    losses = MeanLosses(utility, robots, lost, 7)
    for kept in rng.random((8, 5)) < 0.6:
        for wiped in range(1, lost + 1):
            few = counts[:, ~kept].sum(axis=1) <= wiped
            for share in (*counts[few][::5], *(rng.random((4, 5)) * 2)):
                constants, gains = losses.bounds(share, kept, wiped)
                assert not gains[:, ~kept].any()
                assert (constants.sum() + counts[few] @ gains.sum(axis=0) - worst[few]).min(initial=0.0) >= -1e-14
                value = losses.values(share, kept[None], np.array([wiped]))
                assert value == pytest.approx(constants.sum() + gains.sum(axis=0) @ share)


def exchangeable(rng):
    """A small team of robots with equal elements, or of two kinds of them, and its utilities."""
    robots, sites = int(rng.integers(2, 6)), int(rng.integers(3, 7))
    utility = rng.random((sites, 7)) * (rng.random((sites, 7)) < 0.5)
    if rng.random() < 0.5:
        points = rng.uniform(0, 100, (sites, 2))
        distance = np.round(np.linalg.norm(points[:, None] - points[None], axis=-1))
        utility = distance.max() - distance
    choices = [np.arange(sites)] * robots
    if robots > 2 and rng.random() < 0.3:
        choices[0] = choices[1] = rng.permutation(sites)[: sites // 2]
    owner = np.repeat(np.arange(robots), [len(choice) for choice in choices])
    f = ro.FacilityLocation(utility[np.concatenate(choices)])
    return ro.Problem(f, owner, None, int(rng.integers(0, robots + 1)), 0)


def best_by_definition(problem):
    """The best worst case: of plans that choose the same sites one is looked at."""
    utility, robots = problem.objective.utility, problem.n_robots
    kept = list(combinations(range(robots), robots - problem.alpha_s))
    best, met = 0.0, set()
    for plan in np.stack(np.meshgrid(*problem.choices, indexing="ij"), axis=-1).reshape(-1, robots):
        rows = utility[plan]
        key = rows[np.lexsort(rows.T)].tobytes()
        if key not in met:
            met.add(key)
            best = max(best, min(rows[list(k)].max(axis=0, initial=0.0).sum() for k in kept))
    return best


def check(monkeypatch, seeds):
    go(monkeypatch, NO_PLANS_LISTED)
    go(monkeypatch, NO_TABLES)
    plain, divided = RegionRows.children, []

    def children(rows, *arguments):
        found = plain(rows, *arguments)
        divided.append(any(child.within or child.beyond for child in found))
        return found

    monkeypatch.setattr(RegionRows, "children", children)
    for seed in seeds:
        rng = np.random.default_rng(seed)
        problem = exchangeable(rng)
        limit = [{}, {"max_nodes": 1}, {"max_nodes": 9}][seed % 3]
        found, best = ro.solve_maxmin(problem, **limit), best_by_definition(problem)
        slack = 1e-12 * max(best, 1.0)
        assert found.lower - slack <= best <= found.upper + slack, seed
        if not limit:
            assert found.stop is ro.Stop.CLOSED, seed
    return divided


def test_both_ends_of_robots_that_may_be_exchanged_hold_against_brute_force(monkeypatch):
    assert sum(check(monkeypatch, range(24))) > 10


@pytest.mark.slow
def test_both_ends_of_robots_that_may_be_exchanged_hold_against_brute_force_on_many(monkeypatch):
    assert sum(check(monkeypatch, range(100, 1100))) > 300
