"""Which robots of a group can sense below a threshold: answers and limits against all sets of small teams."""

import numpy as np
import pytest

from ratt_opt.attack.least_sets.max_cardinality import NONE, MaxCardinalityBelow
from ratt_opt.attack.team import Team
from ratt_opt.attack.thresholds.columns import Columns, IntegerDuals
from ratt_opt.budget import Budget, OutOfBudget
from ratt_opt.graph.communication import CommunicationGraph
from ratt_opt.graph.threat import Threat
from tests.strategies import random_problem

ROBOTS = 8


def asked(seed):
    """A team, its values by bit mask, a threshold between them, and the protected robots."""
    rng = np.random.default_rng(seed)
    kind = ["trace", "logdet", "maxeig"][seed % 3]
    problem = random_problem(rng, ROBOTS, kind=kind, controls=1, complete=True, protect=False)
    plan = np.arange(ROBOTS)
    members = (np.arange(2**ROBOTS)[:, None] >> np.arange(ROBOTS) & 1).astype(bool)
    values = np.array([problem.objective(plan[inside]) for inside in members])
    protected = int(rng.integers(2**ROBOTS) & rng.integers(2**ROBOTS)) if seed % 2 else 0
    return Team.of(problem.objective, plan), values, float(np.quantile(values, rng.uniform(0.1, 0.9))), protected


def most(values, threshold, protected, group):
    """By the definition."""
    sets = np.arange(len(values))
    inside = (sets & ~group == 0) & (group & protected & ~sets == 0) & (values < threshold)
    return int(np.bitwise_count(sets[inside]).astype(int).max(initial=NONE))


@pytest.mark.parametrize("seed", range(30))
def test_answers_and_limits_are_those_of_all_sets(seed):
    team, values, threshold, protected = asked(seed)
    answers = MaxCardinalityBelow(team, threshold, protected)
    rng, budget = np.random.default_rng(seed), Budget()
    answers.limit_strongest(budget)
    for k, (group, count) in enumerate(answers.limits):
        assert all(count < before + (group & ~other).bit_count() for other, before in [(0, 0), *answers.limits[:k]])
    for group in rng.permutation(np.arange(1, 2**ROBOTS))[:60].tolist():
        truth = most(values, threshold, protected, group)
        assert answers.known(group) >= truth
        assert answers.of(group, budget) == truth
        if truth > 0:
            seeing = sum(1 << i for i in answers.set_below(group, truth))
            assert seeing.bit_count() == truth
            assert seeing & ~group == 0
            assert group & protected & ~seeing == 0
            assert values[seeing] < threshold
        if truth < group.bit_count():
            answers.limit(group, truth, budget)
            assert answers.known(group) <= truth
    for group in range(2**ROBOTS):
        assert answers.known(group) >= most(values, threshold, protected, group)


@pytest.mark.parametrize("seed", range(6))
def test_what_a_budget_ends_goes_on(seed):
    team, values, threshold, protected = asked(seed)
    answers, group, pieces = MaxCardinalityBelow(team, threshold, protected), 2**ROBOTS - 1, 0
    truth, found = most(values, threshold, protected, group), None
    while found is None:
        try:
            found = answers.of(group, Budget(max_nodes=3))
            answers.limit(group, found, Budget(max_nodes=pieces))
        except OutOfBudget:
            pieces += 1
        assert all(answers.known(some) >= most(values, threshold, protected, some) for some in range(1, 2**ROBOTS, 7))
    assert found == truth


@pytest.mark.parametrize("robots", [5, 20, 32, 33, 60])
def test_columns_of_narrow_and_wide_masks_are_restricted_and_priced_as_by_hand(robots):
    rng = np.random.default_rng(robots)
    members = rng.random((200, robots)) < rng.uniform(0.1, 0.9, (200, 1))
    members[np.arange(200), rng.integers(0, robots, 200)] = True
    masks = [sum(1 << i for i in np.flatnonzero(one).tolist()) for one in members]
    threat = Threat(CommunicationGraph(robots, frozenset()), 4, 0, frozenset({1, 3}))
    cuts, left = rng.integers(0, 200, 200).astype(np.uint8), dict.fromkeys(range(200), 0)
    kind = np.uint32 if robots <= 32 else np.int64
    columns = Columns(robots, np.array(masks, dtype=kind), cuts.copy(), np.zeros(200, np.uint8))
    for _ in range(6):
        some = sum(1 << i for i in np.flatnonzero(rng.random(robots) < 0.6).tolist())
        size = int(rng.integers(0, robots))
        columns.restrict(some, size, threat)
        for k in list(left):
            if not some & 0b1010 & ~masks[k]:
                left[k] = max(left[k], (masks[k] & some).bit_count() - size)
            if left[k] > threat.n_blinded:
                del left[k]
        assert columns.groups.tolist() == [masks[k] for k in left]
        assert columns.cuts.tolist() == [int(cuts[k]) for k in left]
        assert columns.blinded.tolist() == list(left.values())
    duals = IntegerDuals(rng.integers(-(10**6), 10**7, robots), 7)
    costs = [(int(cuts[k]) << 20) + 7 * left[k] - int(duals.robots[members[k]].sum()) for k in left]
    least, cheapest = columns.cheapest(duals)
    assert least == min(costs, default=0)
    assert all(costs[k] < 0 for k in cheapest)
    gap = int(np.median(costs)) if costs else 0
    _, paid = columns.within(duals, gap, 200)
    assert paid.tolist() == sorted(cost for cost in costs if cost <= gap)
