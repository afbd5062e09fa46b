"""At most so many robots choose an element that is not their idle one: planners against all plans."""

from dataclasses import replace
from functools import partial
from itertools import pairwise, product

import numpy as np
import pytest

import ratt_opt as ro
from ratt_opt.planners import PUBLISHED
from tests.oracles import brute_force_worst_case
from tests.strategies import random_graph

REFINED = partial(ro.refined, time_limit=None, max_kicks=3)
KNOW = (ro.ratt, ro.greedy, ro.myopic, REFINED, ro.exhaustive_optimum)


def drawn(seed, robots=4, kind=None):
    """A team whose first elements are idle: coverage, or a criterion of information."""
    rng = np.random.default_rng(seed)
    owner = np.repeat(np.arange(robots), 3)
    if (kind or ("coverage", "trace", "logdet", "maxeig")[seed % 4]) == "coverage":
        covers = rng.random((3 * robots, 9)) < 0.4
        covers[::3] = False
        f = ro.Coverage(covers, rng.integers(1, 5, 9))
    else:
        half = rng.normal(size=(3 * robots, 2, 2, 2))
        half[::3] = 0.0
        classes = (ro.TraceObjective, ro.LogDetObjective, ro.MaxEigenvalueObjective)
        f = classes[seed % 3](np.tile(np.eye(2), (2, 1, 1)), half @ half.swapaxes(-1, -2))
    graph = random_graph(rng, robots)
    cut = int(rng.integers(0, 1 + graph.number_of_edges()))
    return ro.Problem(f, owner, graph, int(rng.integers(0, 3)), cut, at_most=int(rng.integers(0, robots + 1)))


def best_by_definition(problem):
    plans = product(*(choice.tolist() for choice in problem.choices))
    allowed = [p for p in plans if sum(e != i for e, i in zip(p, problem.idle, strict=True)) <= problem.at_most]
    return max(brute_force_worst_case(problem, plan) for plan in allowed)


@pytest.mark.parametrize("seed", range(40))
def test_the_optimum_is_that_of_all_allowed_plans_and_no_plan_is_above_it(seed):
    problem = drawn(seed, robots=3)
    best = best_by_definition(problem)
    found = ro.exhaustive_optimum(problem)
    assert found.lower <= best + 1e-9 <= found.upper + 2e-9
    for planner in KNOW:
        plan = planner(problem)
        problem.check_plan(plan.elements)
        assert brute_force_worst_case(problem, plan.elements) <= best + 1e-9
    better = REFINED(problem)
    starts = [brute_force_worst_case(problem, planner(problem).elements) for planner in (ro.ratt, ro.greedy, ro.myopic)]
    assert better.lower >= max(starts) - 1e-9
    assert better.lower <= brute_force_worst_case(problem, better.elements) + 1e-9 <= better.upper + 2e-9


@pytest.mark.parametrize("seed", range(30))
def test_ratt_takes_bait_first_and_then_greedily(seed):
    problem = drawn(seed, robots=5)
    f, single = problem.objective, problem.objective.singletons()
    plan = ro.ratt(problem)
    alpha = min(problem.alpha_s + plan.alpha_cs, problem.at_most)
    best = [int(choice[np.argmax(single[choice])]) for choice in problem.choices]
    bait = sorted(sorted(range(5), key=lambda i: (-single[best[i]], i))[:alpha])
    chosen = {}
    while len(bait) + len(chosen) < problem.at_most:
        open_robots = [i for i in range(5) if i not in bait and i not in chosen]
        candidates = [int(e) for i in open_robots for e in problem.choices[i] if e != problem.idle[i]]
        if not candidates:
            break
        values = f.extensions(np.array(list(chosen.values()), dtype=np.int64), np.array(candidates))
        pick = candidates[int(np.argmax(values))] if chosen else candidates[int(np.argmax(single[candidates]))]
        chosen[int(problem.robot[pick])] = pick
    expected = [best[i] if i in bait else chosen.get(i, problem.idle[i]) for i in range(5)]
    assert list(plan) == expected
    assert list(plan.bait) == bait


def test_all_may_choose_is_no_limit():
    for seed in range(12):
        problem = drawn(seed)
        free, full = replace(problem, at_most=None), replace(problem, at_most=problem.n_robots)
        assert ro.exhaustive_optimum(full).lower == pytest.approx(ro.exhaustive_optimum(free).lower)
        assert full.objective(ro.greedy(full)) == pytest.approx(full.objective(ro.greedy(free)))
        nobody = replace(problem, at_most=0)
        assert list(ro.ratt(nobody)) == list(REFINED(nobody)) == nobody.idle.tolist()


def test_published_planners_choose_sets_of_that_size():
    """The setting of their papers: k of n elements, of which some are lost."""
    rng = np.random.default_rng(0)
    covers = np.zeros((40, 30), dtype=np.bool_)
    covers[1::2] = rng.random((20, 30)) < 0.2
    f = ro.Coverage(covers, np.ones(30))
    problem = ro.Problem(f, np.repeat(np.arange(20), 2), None, 2, 0, at_most=8)
    best = ro.refined(problem, time_limit=None, max_kicks=30)
    for name in ("resilient_selection", "sensing_only", "uniform_buckets", "partitioned_robust"):
        plan = problem.check_plan(PUBLISHED[name].plan(problem).elements)
        assert (plan != problem.idle).sum() == 8
        kept = ro.worst_case_attack(problem, plan).lower
        assert 0.387 * best.lower <= kept <= best.lower + 1e-9
    assert list(PUBLISHED["resilient_selection"].plan(problem)) == list(PUBLISHED["sensing_only"].plan(problem))


def test_others_refuse_it_by_name():
    problem = drawn(1, kind="trace")
    plan = ro.ratt(problem)
    for call in (
        lambda: list(ro.relaxation_bounds(problem)),
        lambda: ro.relaxation_bound(problem, [ro.Attack()]),
        lambda: ro.all_guarantees(problem, 0, c=0.5),
        lambda: ro.instance_bound(problem, plan.elements, c=ro.total_curvature(problem.objective)),
        lambda: ro.links_to_protect(problem, plan.elements, 1),
        lambda: PUBLISHED["sequential_greedy"].plan(problem),
        lambda: PUBLISHED["resource_aware_greedy"].plan(problem),
        lambda: PUBLISHED["scenario_program"].plan(problem),
    ):
        with pytest.raises(ro.InputError, match="at_most must be None for this"):
            call()


@pytest.mark.parametrize("seed", range(60))
def test_the_search_brackets_the_best_of_all_allowed_plans(seed):
    """Criteria by relaxations, sums as a trace or by values: each closes on teams of this size."""
    problem = drawn(seed, robots=3 + seed % 2)
    found, best = ro.solve_maxmin(problem), best_by_definition(problem)
    problem.check_plan(found.elements)
    assert found.lower <= best + 1e-9 <= found.upper + 2e-9
    assert found.upper - found.lower <= 1e-6 * max(1.0, found.upper)
    assert found.lower <= brute_force_worst_case(problem, found.elements) + 1e-9


def test_upper_ends_use_the_limit():
    """Sensors of which four are on, two lost: the search closes it, and more on are worth more."""
    rng = np.random.default_rng(1)
    half = rng.normal(size=(20, 5, 2, 2)) * (rng.random((20, 5, 1, 1)) < 0.5)
    half[::2] = 0.0
    f = ro.LogDetObjective(np.tile(np.eye(2), (5, 1, 1)), half @ half.swapaxes(-1, -2))
    brackets = []
    for most in (3, 5):
        problem = ro.Problem(f, np.repeat(np.arange(10), 2), None, 2, 0, at_most=most)
        found = ro.solve_maxmin(problem, gap=1e-3)
        assert found.upper <= found.lower * (1 + 2e-3)
        brackets.append(found)
    assert all(one.upper < more.lower for one, more in pairwise(brackets))


def test_undominated_elements_keep_the_idle_ones():
    problem = drawn(1, kind="trace")
    few = ro.undominated(problem)
    assert few.kept[few.idle].tolist() == problem.idle.tolist()
    assert few.at_most == problem.at_most
    free = ro.exhaustive_optimum(problem).lower
    assert ro.exhaustive_optimum(few).lower == pytest.approx(free)


def test_an_idle_element_has_no_information_even_if_others_are_worth_nothing_alone():
    """Of the largest eigenvalue, an element about the better known target is worth nothing alone, and is no rest."""
    information = np.zeros((4, 2, 1, 1))
    information[0, 1] = information[2, 0] = 1.0
    f = ro.MaxEigenvalueObjective(np.array([[[2.0]], [[1.0]]]), information)
    assert ro.Problem(f, [0, 0, 1, 1], None, 0, 0, at_most=1).idle.tolist() == [1, 3]


def test_bad_limits_and_plans_are_named():
    problem = replace(drawn(4, kind="coverage"), at_most=1)
    with pytest.raises(ro.InputError, match=r"at_most must be an integer in \[0, 4\]; got 5"):
        replace(problem, at_most=5)
    with pytest.raises(ro.InputError, match="elements must choose at most 1 elements that are not idle; got 2"):
        ro.worst_case_attack(problem, [1, 4, 6, 9])
    busy = ro.Problem(ro.Coverage(np.ones((2, 1)), [1]), [0, 1], None, 0, 0)
    with pytest.raises(ro.InputError, match="needs an idle element of every robot, worth 0 alone; got none of robot 0"):
        replace(busy, at_most=1)


def test_a_spent_budget_gives_a_plan():
    problem = drawn(2)
    for limit in (0.0, 0.01):
        plan = ro.refined(problem, time_limit=limit)
        problem.check_plan(plan.elements)
        assert plan.lower <= best_by_definition(problem) + 1e-9


def test_a_relaxed_plan_in_changed_coordinates_is_attacked():
    """A wide prior changes coordinates; relaxed plans of fewer elements than the team has are attacked in these."""
    points = np.repeat(np.linspace(-1, 1, 5), 3)
    rows = np.vander(points, 3)
    information = np.zeros((2 * len(points), 1, 3, 3))
    information[1::2, 0] = rows[:, :, None] * rows[:, None, :]
    f = ro.TraceObjective(1e4 * np.eye(3)[None], information)
    problem = ro.Problem(f, np.repeat(np.arange(15), 2), None, 1, 0, at_most=6)
    found = ro.solve_maxmin(problem, gap=1e-4, max_nodes=30)
    assert 0 < found.lower <= found.upper
    assert [points[e // 2] for e in found.elements.tolist() if e % 2] == [-1, -1, 0, 0, 1, 1]
