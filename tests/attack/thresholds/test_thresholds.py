"""The attack engine on all sets: every part against its definition, the whole against the plain threshold test."""

import networkx as nx
import numpy as np
import pytest

import ratt_opt as ro
from ratt_opt.attack.params.groups import MasterParams
from ratt_opt.attack.stages.all_sets import decide
from ratt_opt.attack.team import Team
from ratt_opt.attack.thresholds import exact_cover
from ratt_opt.attack.thresholds.columns import UNIT, Columns, best_duals
from ratt_opt.attack.thresholds.exact_cover import ExactCover
from ratt_opt.attack.thresholds.sets_below import SetsBelow
from ratt_opt.budget import Budget, OutOfBudget
from ratt_opt.graph import group_list
from ratt_opt.graph.threat import Threat
from ratt_opt.graph.threshold import ThresholdTest
from ratt_opt.setfunctions.criteria.registry import CRITERIA
from tests.strategies import random_problem


def members(mask):
    return [i for i in range(mask.bit_length()) if mask >> i & 1]


def check_attack(threat, values, answer, threshold):
    """Connected groups that partition the robots, within the budgets, all below the threshold."""
    n_robots = threat.graph.n_robots
    assert sum(answer.groups) == 2**n_robots - 1
    home = {i: k for k, group in enumerate(answer.groups) for i in members(group)}
    cut = {(i, j) for i, j in threat.graph.links if home[i] != home[j]}
    assert len(cut) <= threat.alpha_c
    assert not cut & threat.protected_links
    assert sorted(sum(1 << i for i in g) for g in threat.graph.groups(cut)) == sorted(answer.groups)
    assert answer.blinded.bit_count() <= threat.alpha_s
    assert not set(members(answer.blinded)) & threat.protected_robots
    assert max(values[group & ~answer.blinded] for group in answer.groups) < threshold


def asked(threat, below, threshold, **options):
    return decide(threat, below, group_list.groups_of(threat), threshold, Budget(), steps=10**9, **options)


@pytest.mark.parametrize("seed", range(150))
def test_any_values_against_the_plain_test(seed, monkeypatch):
    """Values in any order, so that nothing is inherited from set to set; everything in one piece and in many."""
    if seed % 2:
        for module, few in ((group_list, 3), (exact_cover, 2)):
            monkeypatch.setattr(module, "STEPS", few)
    rng = np.random.default_rng(seed)
    n_robots = int(rng.integers(1, 9))
    threat = random_problem(rng, n_robots, kind="logdet", controls=1).threat
    values = rng.normal(size=2**n_robots)
    below = SetsBelow(values, threat.protected_robots, at_once=8 if seed % 2 else 1 << 18)
    plain = ThresholdTest(threat, values)
    for threshold in np.quantile(values, [0.0, 0.1, 0.3, 0.5, 0.7, 0.9, 1.0]):
        split = plain.split(float(np.nextafter(threshold, -np.inf)))
        answer = asked(threat, below, float(threshold))
        assert answer.is_reachable == (split is not None)
        if split is not None:
            check_attack(threat, values, answer, threshold)
        else:
            assert values[answer.following] == values[values >= threshold].min()


@pytest.mark.parametrize("dimension", [1, 2, 3, 4])
@pytest.mark.parametrize("kind", ["trace", "logdet", "maxeig"])
@pytest.mark.parametrize("seed", range(12))
def test_sets_of_a_team_against_their_values(seed, kind, dimension):
    """The tree over sets, which skips most of them, marks what a table of their values does."""
    rng = np.random.default_rng([seed, dimension])
    n_robots, targets = int(rng.integers(1, 15)), int(rng.integers(1, 21))
    roots = rng.normal(size=(n_robots, targets, dimension, dimension)) * 10.0 ** rng.uniform(-2, 2, (n_robots, 1, 1, 1))
    prior = np.eye(dimension) * 10.0 ** rng.uniform(-2, 2, (targets, 1, 1))
    weights = rng.uniform(0.1, 9, targets) if seed % 2 else None
    f = CRITERIA[kind](prior, roots @ np.swapaxes(roots, -1, -2), weights)
    team = Team.of(f, np.arange(n_robots))
    values = np.concatenate(list(f.table_blocks()))
    guarded = [i for i in range(n_robots) if rng.random() < 0.2]
    assert team.all_values() == pytest.approx(values, rel=1e-8, abs=1e-8 * float(values[-1]))
    tree, table = SetsBelow(team, guarded), SetsBelow(values, guarded)
    for share in (0.0, 0.2, 0.5, 0.9, 1.1):
        threshold = share * float(values[-1]) + 1e-7 * float(values[-1])  # not within rounding of a value
        _, following = tree.mark(threshold, Budget())
        _, expected = table.mark(threshold, Budget())
        assert np.array_equal(tree.sizes, table.sizes)
        assert (following is None) == (expected is None)
        assert following is None or values[following] == pytest.approx(values[expected], rel=1e-9)
        for group in rng.integers(0, 2**n_robots, 20).tolist():
            if tree.sizes[group]:
                inside = tree.largest_inside(group)
                assert inside & ~group == 0
                assert inside.bit_count() == tree.sizes[group] - 1
                assert all(inside >> i & 1 for i in guarded if group >> i & 1)
                assert values[inside] < threshold


@pytest.mark.parametrize("seed", range(60))
def test_what_no_attack_leaves_is_skipped(seed):
    """What must be blinded in a group is found where the budget has it."""
    rng = np.random.default_rng(seed)
    n_robots, n_blinded = int(rng.integers(1, 16)), int(rng.integers(0, 5))
    roots = rng.normal(size=(n_robots, 3, 2, 2))
    f = CRITERIA["trace"](np.eye(2) * np.ones((3, 1, 1)), roots @ np.swapaxes(roots, -1, -2))
    values, team = np.concatenate(list(f.table_blocks())), Team.of(f, np.arange(n_robots))
    groups = rng.integers(1, 2**n_robots, int(rng.integers(1, 6))).astype(np.uint32)
    some, every = SetsBelow(team, (), groups, n_blinded), SetsBelow(team)
    left = np.zeros(2**n_robots, np.bool_)
    for group in groups.tolist():
        inside = np.arange(2**n_robots)[np.arange(2**n_robots) & ~group == 0]
        left[inside[group.bit_count() - np.bitwise_count(inside) <= n_blinded]] = True
    for share in (0.1, 0.4, 0.8, 1.1):
        threshold = share * float(values[-1]) + 1e-9
        _, following = some.mark(threshold, Budget())
        every.mark(threshold, Budget())
        for group in groups.tolist():
            blinded = group.bit_count() + 1 - int(every.sizes[group])
            if every.sizes[group] and blinded <= n_blinded:
                assert some.sizes[group] == every.sizes[group]
            else:
                assert not some.sizes[group] or group.bit_count() + 1 - int(some.sizes[group]) > n_blinded
        follow = values[left & (values >= threshold)]
        if len(follow):
            assert threshold <= values[following] <= follow.min() + 1e-12


def random_columns(rng, robots, count):
    masks = rng.integers(1, 2**robots, count).astype(np.uint32)
    return Columns(
        robots, masks, rng.integers(0, 9, count).astype(np.uint8), rng.integers(0, 4, count).astype(np.uint8)
    )


@pytest.mark.parametrize("seed", range(60))
def test_duals_and_covers_against_all_covers(seed):
    """Duals claim no more than any cover costs, and a cover within the gap is found exactly where there is one."""
    rng = np.random.default_rng(seed)
    robots, count = int(rng.integers(1, 15)), int(rng.integers(0, 40))
    columns = random_columns(rng, robots, count)
    n_blinded, most_cut = int(rng.integers(0, 6)), int(rng.integers(0, 20))

    def covers(left, blinded, cut):
        if left == 0:
            yield cut
            return
        for k in range(count):
            mask = int(columns.groups[k])
            if mask & (left & -left) and mask & ~left == 0 and columns.blinded[k] <= blinded:
                yield from covers(left ^ mask, blinded - int(columns.blinded[k]), cut + int(columns.cuts[k]))

    costs = list(covers(2**robots - 1, n_blinded, 0))
    duals = best_duals(columns, n_blinded, most_cut, Budget(), MasterParams()).duals
    reduced = [
        UNIT * int(cut) + duals.blinding * int(blind) - sum(int(duals.robots[i]) for i in members(int(mask)))
        for mask, cut, blind in zip(columns.groups, columns.cuts, columns.blinded, strict=True)
    ]
    assert min(reduced, default=0) >= 0
    assert all(duals.claim(n_blinded) <= cost * UNIT for cost in costs)
    gap = most_cut * UNIT - duals.claim(n_blinded)
    if gap < 0:
        assert all(cost > most_cut for cost in costs)
        return
    chosen = columns.within(duals, gap, 1000)
    assert sorted(chosen[1].tolist()) == sorted(cost for cost in reduced if cost <= gap)
    few, paid = chosen[0], np.column_stack([chosen[1], chosen[0].blinded, chosen[0].cuts]).astype(np.int64)
    search = ExactCover(robots, few.groups[:, None].astype(np.uint64), paid, (gap, n_blinded, most_cut))
    found = search.next(Budget(), 10**9)
    assert bool(found) == any(cost <= most_cut for cost in costs)


def test_a_search_that_its_budget_ends_goes_on():
    rng = np.random.default_rng(7)
    columns = random_columns(rng, 12, 4000)
    masks, costs = columns.groups[:, None].astype(np.uint64), np.zeros((4000, 3), np.int64)
    costs[:, 1], costs[:, 2] = columns.blinded, columns.cuts
    whole = ExactCover(12, masks, costs, (0, 40, 12 * 9)).next(Budget(), 10**12)
    parts, found = ExactCover(12, masks, costs, (0, 40, 12 * 9)), None
    with pytest.raises(OutOfBudget):
        parts.next(Budget(max_nodes=0), 10**12)
    while found is None:
        found = parts.next(Budget(), 1)
    assert found == whole


class Spent(Budget):
    """Ends at the third look."""

    def check(self):
        self.looks = getattr(self, "looks", 0) + 1
        if self.looks == 3:
            raise OutOfBudget(ro.Stop.TIME)


def test_the_budget_is_asked_on_the_way(monkeypatch):
    monkeypatch.setattr(group_list, "STEPS", 4)
    problem = random_problem(np.random.default_rng(4), 12, kind="trace", controls=1, complete=True, protect=False)
    threat = Threat(problem.communication, 3, 30)
    team = Team.of(problem.objective, np.arange(12))
    with pytest.raises(OutOfBudget):
        group_list.groups_of(threat).all(Spent())
    with pytest.raises(OutOfBudget):
        SetsBelow(team).mark(1.0, Spent())


def of_unit_matrices(dimension):
    """A trace criterion of two targets."""
    unit = np.broadcast_to(np.eye(dimension), (2, dimension, dimension))
    return ro.TraceObjective(unit.copy(), unit[None].copy())


def test_what_c_may_not_read_is_refused():
    criterion, prior, information = of_unit_matrices(2), np.ones((2, 3)), np.ones((4, 2, 3))
    Team(criterion, prior, information)
    bad = [
        (prior.astype(np.float32), information),
        (np.ones((3, 3)), information),
        (prior, np.ones((4, 2, 6))[:, :, ::2]),
        (np.ones((2, 4)), information),
        (prior.tolist(), information),
    ]
    for arrays in bad:
        with pytest.raises(ro.InputError):
            Team(criterion, *arrays)
    with pytest.raises(ro.InputError):
        Team(of_unit_matrices(65), np.ones((2, 2145)), np.ones((4, 2, 2145)))
    with pytest.raises(ro.InputError):
        SetsBelow(Team(criterion, prior, np.ones((33, 2, 3))))
    for values in (np.ones(3), np.ones(4, np.float32), np.ones(8)[::2], np.empty(0)):
        with pytest.raises(ro.InputError):
            SetsBelow(values)


def test_the_example_of_the_page_of_the_engine():
    """Five robots in a row, one blinded, one link cut; a group is worth the robots that sense in it."""
    threat = ro.Problem(ro.TableFunction(np.zeros(32)), np.arange(5), nx.path_graph(5), 1, 1).threat
    below = SetsBelow(np.bitwise_count(np.arange(32)).astype(np.float64))
    three, two = asked(threat, below, 3.0), asked(threat, below, 2.0)
    assert three.is_reachable
    check_attack(threat, below.source, three, 3.0)
    assert not two.is_reachable
    assert below.source[two.following] == 2.0


@pytest.mark.parametrize("robots", [0, 1])
def test_the_smallest_teams(robots):
    information = np.ones((robots, 2, 3)) * np.array([1.0, 0.0, 1.0])
    team = Team(of_unit_matrices(2), np.ones((2, 3)) * np.array([1.0, 0.0, 1.0]), information)
    below = SetsBelow(team)
    assert below.mark(0.5, Budget())[1] == (None if robots == 0 else 1)
    assert below.sizes.tolist() == [1] + [1] * robots
