"""Upper ends by rows of parts, against brute force; plans by values, against greedy ones and their exchanges."""

import networkx as nx
import numpy as np
import pytest

import ratt_opt as ro
from tests.attack.engine import NO_TABLES
from tests.oracles import brute_force_optimum, brute_force_worst_case
from tests.solvers.maxmin.engine import NO_PLANS_LISTED, TRACE_INTERRUPTED
from tests.strategies import Submodular
from tests.ways import go


class OwnSum(ro.SumFunction):
    """Each part counts what touches it, up to two: a sum of one's own, in two methods."""

    is_submodular = is_non_decreasing = True

    def __init__(self, touches):
        super().__init__(len(touches), touches.shape[1], 1.0 + np.arange(touches.shape[1]))
        self.touches = touches

    def touching(self, part):
        return np.flatnonzero(self.touches[:, part])

    def part_values(self, part, membership):  # noqa: ARG002
        return np.minimum(membership.sum(axis=1), 2.0)


def function(rng, n):
    kind = int(rng.integers(6))
    if kind == 0:
        return ro.FacilityLocation(rng.random((n, 5)))
    if kind == 1:
        return ro.Coverage(rng.random((n, 7)) < 0.4, rng.integers(1, 4, 7).astype(float))
    if kind == 2:
        return OwnSum(rng.random((n, 4)) < 0.6)
    if kind == 3:
        return Submodular(ro.ConcaveOfModular(rng.random(n)))
    if kind == 4:
        return Submodular(ro.FacilityLocation(rng.random((n, 4))))
    parts = []
    for _ in range(4):
        k = int(rng.integers(0, min(n, 4) + 1))
        table = rng.random(2**k)
        for e in range(k):  # the largest of all smaller sets: non-decreasing, not submodular
            steps = table.reshape(-1, 2, 1 << e)
            steps[:, 1] = np.maximum(steps[:, 1], steps[:, 0])
        parts.append(ro.Part(rng.permutation(n)[:k], table - table[0], weight=rng.random()))
    return ro.SumFunction(n, parts)


def problem(rng):
    """A small team; one time in two its robots have equal elements, so that columns are merged."""
    robots, each = int(rng.integers(2, 5)), int(rng.integers(2, 4))
    f = function(rng, robots * each)
    if rng.random() < 0.5:
        f = ro.FacilityLocation(np.tile(rng.integers(0, 6, (each, 5)).astype(float), (robots, 1)))
    graph = None if rng.random() < 0.6 else nx.path_graph(robots)
    links = robots * (robots - 1) // 2 if graph is None else robots - 1
    alpha_c = 0 if rng.random() < 0.6 else int(rng.integers(0, links + 1))
    held = [0] if rng.random() < 0.2 else []
    return ro.Problem(f, np.repeat(np.arange(robots), each), graph, int(rng.integers(0, robots)), alpha_c, held)


def check(seeds):
    closed = 0
    for seed in seeds:
        rng = np.random.default_rng(seed)
        one = problem(rng)
        limit = [{}, {"max_nodes": 1}, {"max_evaluations": 60}, {"time_limit": 600}][seed % 4]
        found, best = ro.solve_maxmin(one, **limit), brute_force_optimum(one)
        slack = 1e-12 * max(best, 1.0)
        assert found.lower <= brute_force_worst_case(one, found.elements) + slack, seed
        assert found.lower - slack <= best <= found.upper + slack, seed
        closed += found.upper <= best + 1e-9 * max(best, 1.0)
    return closed


@pytest.fixture
def nothing_is_enumerated(monkeypatch):
    go(monkeypatch, NO_PLANS_LISTED)
    go(monkeypatch, NO_TABLES)


@pytest.mark.usefixtures("nothing_is_enumerated")
def test_both_ends_hold_against_brute_force():
    assert check(range(30)) > 15


@pytest.mark.usefixtures("nothing_is_enumerated")
def test_rows_close_sums_of_ones_own():
    """Seven robots, two of them lost: rows of parts and the tree below them end, whatever the parts are."""
    rng = np.random.default_rng(7)
    utility = rng.random((21, 8)) * (rng.random((21, 8)) < 0.25)
    for f in (ro.FacilityLocation(utility), OwnSum(utility > 0)):
        one = ro.Problem(f, np.repeat(np.arange(7), 3), None, 2, 0)
        found = ro.solve_maxmin(one, max_nodes=400)
        assert found.stop is ro.Stop.CLOSED
        assert found.lower == worst(one, found.elements)


@pytest.mark.usefixtures("nothing_is_enumerated")
@pytest.mark.parametrize("alpha_s", [0, 1, 2])
def test_plans_of_robots_that_may_be_exchanged_close(alpha_s):
    """Sites are chosen whatever robot has them; an attack takes the robots of any sites that one robot has each."""
    one = facilities(np.random.default_rng(4), 7, 3, alpha_s)
    found = ro.solve_maxmin(one, max_nodes=1000)
    assert found.stop is ro.Stop.CLOSED
    assert found.lower == worst(one, found.elements)


def test_an_upper_end_is_known_before_the_search_of_the_trace_begins(monkeypatch):
    go(monkeypatch, TRACE_INTERRUPTED)
    covers = np.random.default_rng(1).random((105, 150)) < 0.07
    found = ro.solve_maxmin(ro.Problem(ro.Coverage(covers, np.ones(150)), np.repeat(np.arange(15), 7), None, 6, 0))
    assert found.stop is ro.Stop.INTERRUPTED
    assert found.upper == int(found.upper) <= 1.3 * found.lower


def test_what_a_search_of_the_trace_proved_is_claimed_of_its_own_plan():
    """The next plan that was attacked once took the place of the trace's, which had kept more."""
    rng = np.random.default_rng(1)
    f = ro.Coverage(rng.random((60, 60)) < 0.12, rng.integers(1, 4, 60).astype(float))
    one = ro.Problem(f, np.repeat(np.arange(10), 6), None, 3, 0)
    found = ro.solve_maxmin(one, max_nodes=2)
    assert found.lower <= worst(one, found.elements)


@pytest.mark.slow
@pytest.mark.usefixtures("nothing_is_enumerated")
def test_both_ends_hold_against_brute_force_on_many():
    assert check(range(100, 2100)) > 1000


def facilities(rng, sites, facilities, alpha_s):
    """Choose facilities among sites in a square; ``alpha_s`` of them are lost."""
    points = rng.uniform(0, 100, (sites, 2))
    distance = np.linalg.norm(points[:, None] - points[None], axis=-1)
    utility = np.tile(distance.max() - distance, (facilities, 1))
    return ro.Problem(ro.FacilityLocation(utility), np.repeat(np.arange(facilities), sites), None, alpha_s, 0)


def worst(problem, plan):
    return ro.worst_case_attack(problem, plan).lower


def exchanged(problem, plan):
    """The plan that exchanges of one element reach, one after the other, by the exact worst case."""
    plan, value, better = np.array(plan), worst(problem, plan), True
    while better:
        better = False
        for i, choice in enumerate(problem.choices):
            for e in choice:
                other = plan.copy()
                other[i] = e
                if worst(problem, other) > value + 1e-9:
                    plan, value, better = other, worst(problem, other), True
    return value


@pytest.mark.parametrize("seed", range(3))
@pytest.mark.parametrize(("sites", "count", "alpha_s"), [(60, 4, 0), (60, 4, 2), (40, 8, 0), (40, 8, 1)])
def test_twice_the_values_of_the_greedy_plan_are_enough_for_its_worst_case(sites, count, alpha_s, seed):
    problem = facilities(np.random.default_rng(seed), sites, count, alpha_s)
    greedy = ro.greedy(problem)
    found = ro.solve_maxmin(problem, max_evaluations=2 * greedy.evaluations)
    assert found.lower >= worst(problem, greedy) * (1 - 1e-12)
    if alpha_s == 0:
        nobody = ro.nonrobust_optimum(problem, max_evaluations=2 * greedy.evaluations)
        assert nobody.lower >= problem.objective(list(greedy)) * (1 - 1e-12)


@pytest.mark.parametrize("seed", range(2))
@pytest.mark.parametrize("alpha_s", [0, 1])
def test_a_search_is_no_worse_than_exchanges_from_the_first_plans(seed, alpha_s):
    problem = facilities(np.random.default_rng([seed, 1]), 15, 3, alpha_s)
    found = ro.solve_maxmin(problem, max_evaluations=20_000)
    for planner in (ro.greedy, ro.myopic, ro.ratt):
        assert found.lower >= exchanged(problem, planner(problem).elements) - 1e-9


@pytest.mark.parametrize("seed", range(3))
def test_rows_close_what_their_fractional_plans_solve(seed):
    """Choosing sites when nobody attacks: the linear program is nearly whole, and its end is within 1 %."""
    problem = facilities(np.random.default_rng([seed, 2]), 50, 5, 0)
    found = ro.solve_maxmin(problem, time_limit=10)
    assert found.upper - found.lower <= 0.01 * found.lower


class Claims(ro.SetFunction):
    """Says that it is submodular, and is not."""

    is_submodular = is_non_decreasing = True

    def __init__(self, n):
        self.size = n

    @property
    def n(self):
        return self.size

    def evaluate(self, membership):
        count = membership.sum(axis=1).astype(float)
        return count + np.where(membership[:, 0] & membership[:, 3], 5.0, 0.0)


@pytest.mark.parametrize(("robots", "alpha_s"), [(3, 1), (20, 0)])
def test_a_false_word_on_submodularity_is_refuted_with_its_sets(robots, alpha_s):
    f = Claims(3 * robots)
    problem = ro.Problem(f, np.repeat(np.arange(robots), 3), None, alpha_s, 0)
    with pytest.raises(ro.InputError, match=r"must be submodular, as it says.*A = \[.*B = \["):
        ro.solve_maxmin(problem, time_limit=20)


def test_results_say_what_they_rely_on():
    problem = facilities(np.random.default_rng(0), 60, 8, 1)  # too many plans to value one and all
    found = ro.solve_maxmin(problem, time_limit=0.5)
    assert found.relies_on == ("non-decreasing", "submodular")
    assert found.to_dict()["relies_on"] == ["non-decreasing", "submodular"]


@pytest.mark.parametrize("alpha_s", [0, 1])
def test_refined_plans_of_own_functions_are_no_worse_than_first_plans_and_their_exchanges(alpha_s):
    problem = facilities(np.random.default_rng(3), 15, 3, alpha_s)
    found = ro.refined(problem, max_kicks=3, time_limit=None)
    for planner in (ro.greedy, ro.myopic, ro.ratt):
        assert found.lower >= exchanged(problem, planner(problem).elements) - 1e-9
    assert found.lower <= worst(problem, found.elements) <= found.upper
    assert found.unattacked == problem.objective(found.elements.tolist())
    assert np.array_equal(found.elements, ro.refined(problem, max_kicks=3, time_limit=None).elements)
    start = ro.random_plan(problem, seed=1)
    assert ro.refined(problem, start=start, max_kicks=0, time_limit=None).lower >= worst(problem, start) - 1e-9
