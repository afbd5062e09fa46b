"""Curvatures against their definitions, and brackets against exact values."""

import pickle
from itertools import product

import numpy as np
import pytest

import ratt_opt as ro
from ratt_opt.budget import Budget
from ratt_opt.curvatures.params import SeparableParams
from ratt_opt.curvatures.separable.marginal_brackets import other_elements
from tests.curvatures.engine import SEARCHED
from tests.interrupts import interrupted_at
from tests.setfunctions import oracle
from tests.strategies import OBJECTIVES, information_data, monotone_table, random_objective, range_bearing

KINDS = sorted(OBJECTIVES)


def random_owners(rng, n):
    return rng.integers(0, max(n // 2, 1), n) if rng.random() < 0.5 else None


def ratio_shown(f, found, against_own=False):
    """1 - the ratio of the two marginals that the result names."""
    x = found.element

    def marginal(context):
        return f([*context, x]) - f(context)

    return 1 - marginal(found.smallest_context) / marginal(() if against_own else found.largest_context)


def test_total_curvature_is_its_definition_on_random_monotone_tables():
    rng = np.random.default_rng(31)
    for _ in range(1500):
        n = int(rng.integers(1, 5))
        f = ro.TableFunction(monotone_table(rng, n) + rng.integers(-1, 2))
        owners = random_owners(rng, n)
        found = ro.total_curvature(f, owners)
        assert found.lower <= oracle.total_curvature(f.values, owners) + 1e-15
        assert found.lower == pytest.approx(found.upper, abs=1e-12)
        assert found.upper == pytest.approx(oracle.total_curvature(f.values, owners), abs=1e-12)
        assert found.stop is ro.Stop.EXHAUSTED
        if found.element is not None:
            assert ratio_shown(f, found) == pytest.approx(found.lower, abs=1e-12)


def test_curvature_is_its_definition_on_random_submodular_functions():
    rng = np.random.default_rng(32)
    for _ in range(300):
        family = str(rng.choice(["coverage", "matroid rank", "facility location", "concave of modular"]))
        f = ro.reference(family, int(rng.integers(2, 6)), rng).function
        owners = random_owners(rng, f.n)
        k, c = ro.curvature(f, owners), ro.total_curvature(f, owners)
        exact = oracle.curvature(f.table(), owners)
        assert k.lower == pytest.approx(exact, abs=1e-9)
        assert k.upper == pytest.approx(exact, abs=1e-9)
        assert c.upper == pytest.approx(k.upper, abs=1e-9)  # c == k on submodular functions
        if k.element is not None:
            assert ratio_shown(f, k, against_own=True) == pytest.approx(k.lower, abs=1e-9)


def test_any_table_is_measured_or_refused_by_the_definition():
    rng = np.random.default_rng(33)
    refused = 0
    for _ in range(2000):
        values = rng.integers(0, 4, 2 ** int(rng.integers(1, 4))).astype(float)
        f = ro.TableFunction(values)
        falls = oracle.worst_slack(values, "non-decreasing") < 0
        refused += falls
        if falls:
            with pytest.raises(ro.InputError, match="f must be non-decreasing; got adding"):
                ro.total_curvature(f)
        else:
            assert ro.total_curvature(f).upper == pytest.approx(oracle.total_curvature(values), abs=1e-12)
    assert 0 < refused < 2000


def test_curvature_refuses_what_is_not_submodular():
    f = ro.reference("convex of modular", 5, np.random.default_rng(0)).function
    with pytest.raises(ro.InputError, match="f must be submodular"):
        ro.curvature(f)


def test_one_plan_is_the_function_of_its_elements_alone():
    rng = np.random.default_rng(34)
    for kind in KINDS:
        f = random_objective(rng, 7, kind)
        plan = [1, 4, 6]
        masks = [[e for k, e in enumerate(plan) if m >> k & 1] for m in range(8)]
        found = ro.total_curvature(f, plan=plan)
        assert found.domain == "robots"
        assert found.upper == pytest.approx(oracle.total_curvature(np.array([f(s) for s in masks])), abs=1e-9)
        assert found.element is None or found.element in plan


def test_elements_that_add_nothing_are_left_out_and_named():
    prior, information = information_data(np.random.default_rng(36), 4, 2)
    information[2] = 0.0
    for kind in KINDS:
        found = ro.total_curvature(OBJECTIVES[kind](prior, information))
        assert 2 in found.useless
    nothing = ro.total_curvature(ro.TableFunction(np.ones(8)))
    assert (nothing.lower, nothing.upper, nothing.element) == (0.0, 0.0, None)
    assert nothing.useless == (0, 1, 2)


def test_information_that_rounding_hides_leaves_the_upper_end_at_one():
    """Its marginals are computed as 0 and are not: in exact arithmetic the total curvature is positive."""
    prior = 1e6 * np.eye(2)[None]
    for kind in KINDS:
        for scale in (1e-26, 1e-40, 1e-300):
            found = ro.total_curvature(OBJECTIVES[kind](prior, scale * np.eye(2)[None, None].repeat(2, axis=0)))
            assert (found.lower, found.upper, found.useless, found.near_zero) == (0.0, 1.0, (), (0, 1))
            f = OBJECTIVES[kind](prior, scale * np.eye(2)[None, None].repeat(2, axis=0))
            kept, ratio = ro.generalised_curvature(f), ro.submodularity_ratio(f)
            assert (kept.lower, kept.upper) == (0.0, 1.0)
            assert (ratio.lower, ratio.upper) == ((1.0, 1.0) if f.is_submodular else (0.0, 1.0))


def test_information_about_what_does_not_count_is_useless():
    """Coordinates 0 and 1 count; 2 and 3 are independent of them until a prior or an element joins them."""
    prior, output = np.eye(4)[None], np.eye(4)[:2]
    information = np.zeros((3, 1, 4, 4))
    information[0, 0, 0, 0] = information[1, 0, 2, 2] = information[2, 0, 1, 1] = 1.0
    assert ro.total_curvature(ro.TraceObjective(prior, information, output=output)).useless == (1,)
    joined = prior.copy()
    joined[0, 1, 3] = joined[0, 3, 1] = joined[0, 2, 3] = joined[0, 3, 2] = 0.5
    assert ro.total_curvature(ro.TraceObjective(joined, information, output=output)).useless == ()


def test_an_element_within_rounding_decides_only_the_upper_end():
    prior = np.eye(2)[None] * 4.0
    information = np.array([np.eye(2), 2 * np.eye(2), 1e-16 * np.eye(2)])[:, None]
    found = ro.total_curvature(ro.TraceObjective(prior, information))
    assert set(found.near_zero) | set(found.useless) == {2}
    assert found.element in {0, 1}
    two = ro.total_curvature(ro.TraceObjective(prior, information[:2]))
    assert found.lower == pytest.approx(two.lower)


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("seed", range(15))
def test_brackets_hold_the_exact_value(kind, seed):
    rng = np.random.default_rng([seed, 37])
    n, dimension = int(rng.integers(4, 9)), int(rng.integers(1, 4))
    prior, information = information_data(rng, n, int(rng.integers(1, 4)), dimension)
    f = OBJECTIVES[kind](prior, information, rng.uniform(0.5, 2, len(prior)))
    owners = rng.integers(0, 3, n) if rng.random() < 0.7 else None
    exact = ro.total_curvature(f, owners)
    for gap, nodes in ((0.0, 0), (0.1, 40), (0.0, 3000)):
        found = ro.total_curvature(f, owners, gap=gap, max_nodes=nodes, params=SEARCHED)
        assert found.lower - 1e-9 <= exact.upper
        assert exact.lower <= found.upper + 1e-9
        if found.element is not None:
            assert ratio_shown(f, found) == pytest.approx(found.lower, abs=1e-8)
    if kind == "logdet":
        k = ro.curvature(f, owners, gap=0.0, max_nodes=3000, params=SEARCHED)
        assert k.lower == pytest.approx(exact.upper, abs=1e-7)
        assert k.upper == pytest.approx(exact.upper, abs=1e-7)


@pytest.mark.parametrize("kind", ["trace", "logdet"])
def test_minorants_lie_below_every_marginal_and_touch_at_contexts(kind):
    rng = np.random.default_rng(38)
    touched = []
    for trial in range(60):
        n = 7
        dimension = int(rng.integers(1, 4))
        prior, information = information_data(rng, n, 2, dimension)
        if trial % 2:
            information = information + 0.05 * np.eye(dimension)
        f = OBJECTIVES[kind](prior, information, rng.uniform(0.5, 2, 2))
        owners = np.array([0, 1, 1, 2, 2, 2, 3])
        others = other_elements(f, owners, 0)
        vertex = trial % 3 == 0
        raw = rng.random(6) * (rng.random(6) < 0.8) + 1e-9
        share = np.array([1.0, 0, 0, 1, 0, 1]) if vertex else raw / np.bincount(others.owners, raw)[others.owners]
        separable = f.marginal_minorant(f.information[0], others, share)
        groups = [np.flatnonzero(others.owners == i) for i in range(3)]
        for picks in product(*[[None, *g] for g in groups]):
            context = [int(others.elements[p]) for p in picks if p is not None]
            marginal = f([*context, 0]) - f(context)
            paid = sum(separable.absent[i] if p is None else separable.score[p] for i, p in enumerate(picks))
            assert separable.constant - paid <= marginal + 1e-9 * (1 + abs(separable.constant))
            if vertex and trial % 2 and list(picks) == [0, 3, 5]:
                touched.append((separable.constant - paid) / marginal)
    # Exact for log-det; for the trace up to the share of the prior that is kept for absent robots.
    assert min(touched) > (1 - 1e-9 if kind == "logdet" else 0.8)


@pytest.mark.parametrize("kind", ["trace", "logdet"])
@pytest.mark.parametrize("anisotropic", [False, True])
def test_brackets_are_tight_on_range_and_bearing(kind, anisotropic):
    rng = np.random.default_rng(39)
    prior, information = range_bearing(rng, 10, 15)
    if anisotropic:
        stretch = rng.uniform(0.5, 2, (15, 2))
        prior = prior * stretch[:, :, None] * stretch[:, None, :]
    f = OBJECTIVES[kind](prior, information)
    owners = np.repeat(np.arange(10), 12)
    found = ro.total_curvature(f, owners, time_limit=None, max_nodes=4000, gap=0.05)
    assert found.upper < 1
    assert (1 - found.lower) / (1 - found.upper) <= (1.2 if anisotropic and kind == "trace" else 1.05 + 1e-9)


def section_six(kind="trace", n=6):
    problem = ro.random_scenario(n, 5, alpha_s=1, alpha_c=1, seed=3).problem(kind)
    return problem.objective, problem.robot


def test_budgets_stop_the_search_and_keep_the_bracket():
    f, owners = section_six()
    free = ro.total_curvature(f, owners, gap=1e-6, time_limit=None, max_nodes=400, params=SEARCHED)
    hurried = ro.total_curvature(f, owners, gap=1e-6, time_limit=0.0, params=SEARCHED)
    counted = ro.total_curvature(f, owners, gap=1e-6, time_limit=None, max_nodes=f.n, params=SEARCHED)
    assert hurried.stop is ro.Stop.TIME
    assert counted.stop is ro.Stop.NODES
    for found in (hurried, counted):
        assert found.lower <= free.upper + 1e-12
        assert free.lower <= found.upper + 1e-12
    again = ro.total_curvature(f, owners, gap=1e-6, time_limit=None, max_nodes=400, params=SEARCHED)
    assert again == free


def test_an_outer_budget_gives_its_seconds_and_hears_of_interrupts(monkeypatch):
    f, owners = section_six()
    for measure in (ro.total_curvature, ro.curvature, ro.submodularity_ratio, ro.generalised_curvature):
        assert measure(f, owners, budget=Budget(0.0), params=SEARCHED).stop is ro.Stop.TIME
    outer = Budget()
    free = ro.total_curvature(f, owners, time_limit=None, max_nodes=30, budget=outer, params=SEARCHED)
    assert free == ro.total_curvature(f, owners, time_limit=None, max_nodes=30, params=SEARCHED)
    assert (free.stop, outer.nodes, outer.stop()) == (ro.Stop.NODES, 0, None)

    def interrupted(*_):
        raise KeyboardInterrupt

    monkeypatch.setattr(ro.TraceObjective, "marginal_minorant", interrupted)
    assert ro.total_curvature(f, owners, budget=outer, params=SEARCHED).stop is ro.Stop.INTERRUPTED
    assert outer.stop() is ro.Stop.INTERRUPTED


def test_results_are_values():
    f, owners = section_six("maxeig", 3)
    for limit in (2**24, 1):
        params = ro.CurvatureParams(largest_enumeration=limit)
        found, again = (ro.total_curvature(f, owners, time_limit=None, max_nodes=50, params=params) for _ in range(2))
        copied = pickle.loads(pickle.dumps(found))
        assert found == again == copied
        assert found.marginals == again.marginals == copied.marginals
        assert found.marginals != ro.curvature(f, owners, time_limit=None, max_nodes=50, params=params).marginals
        assert {type(found.lower), type(found.upper)} == {float}
        assert {type(e) for e in (found.element, *found.smallest_context, *found.largest_context)} <= {int}
        assert len(repr(found)) < 250
        for ratio in (
            ro.submodularity_ratio(f, owners, params=params),
            ro.generalised_curvature(f, owners, params=params),
        ):
            assert {type(ratio.lower), type(ratio.upper)} == {float}
            assert pickle.loads(pickle.dumps(ratio)) == ratio
    table = ro.total_curvature(ro.TableFunction(monotone_table(np.random.default_rng(1), 4)))
    assert pickle.loads(pickle.dumps(table)).marginals == table.marginals


def test_an_interrupt_returns_the_bracket(monkeypatch):
    f, owners = section_six()
    exact = ro.total_curvature(f, owners, gap=1e-3, time_limit=None, params=SEARCHED)
    plain = ro.TraceObjective.marginal_minorant
    for call in (6, 301, 801):
        monkeypatch.setattr(ro.TraceObjective, "marginal_minorant", interrupted_at(call, plain))
        found = ro.total_curvature(f, owners, gap=1e-9, time_limit=None, params=SEARCHED)
        assert found.stop is ro.Stop.INTERRUPTED
        assert found.lower <= exact.upper
        assert exact.lower <= found.upper
        monkeypatch.setattr(ro.TraceObjective, "marginal_minorant", plain)


@pytest.mark.parametrize(
    ("call", "text"),
    [
        (lambda f: ro.total_curvature(f, [0]), "owners must hold 3 integers"),
        (lambda f: ro.total_curvature(f, [0.5, 1.0, 2.0]), "owners must hold 3 integers"),
        (lambda f: ro.total_curvature(f, plan=[0, 0]), "plan must not repeat"),
        (lambda f: ro.total_curvature(f, plan=[3]), "plan index"),
        (lambda f: ro.total_curvature(f, gap=-1), "gap must be a finite number >= 0"),
        (lambda f: ro.total_curvature(f, time_limit=float("nan")), "time_limit"),
        (lambda f: ro.curvature(f, max_nodes=-1), "max_nodes"),
    ],
)
def test_bad_arguments_are_refused(call, text):
    with pytest.raises(ro.InputError, match=text):
        call(ro.TableFunction(np.arange(8.0)))


@pytest.mark.parametrize(
    ("values", "text"),
    [
        ([0.0, np.nan], "values must be finite"),
        ([0.0, np.inf], "values must be finite"),
        ([0.0, 1.0, 2.0], "power of two"),
        ([], "power of two"),
    ],
)
def test_bad_tables_are_refused(values, text):
    with pytest.raises(ro.InputError, match=text):
        ro.TableFunction(values)


def test_domains_too_large_for_a_table_have_a_bracket_and_no_table():
    f = ro.reference("modular", 30, np.random.default_rng(0)).function
    found = ro.total_curvature(f)
    assert found.lower <= 1e-12  # it has none
    assert found.upper >= 0
    assert found.stop is ro.Stop.HEURISTIC
    with pytest.raises(ro.InputError, match="8 GiB"):
        f.table()
    with pytest.raises(ro.InputError, match="must not repeat"):
        f([1, 1])
    assert ro.curvature(f).upper == 0  # the ends of the lattice need no table


@pytest.mark.parametrize("kind", KINDS)
def test_the_ends_that_a_criterion_states_hold_for_every_context(kind):
    rng = np.random.default_rng(40)
    for trial in range(40):
        owners = np.array([0, 0, 1, 1, 2, 3])
        if trial % 2:
            prior, information = information_data(rng, 6, int(rng.integers(1, 4)), int(rng.integers(1, 4)))
        else:
            prior, information = range_bearing(rng, 2, 3, 3)
        f = OBJECTIVES[kind](prior, information, rng.uniform(0.5, 2, len(prior)))
        floor, ceiling = f.marginal_ends(owners, Budget())
        values, allowed = f.table(), oracle.allowed_sets(6, owners)
        for x in range(6):
            found = oracle.marginals(values, x, allowed)
            assert floor[x] <= min(found) + 1e-9
            assert max(found) <= ceiling[x] + 1e-9


def test_a_max_eigenvalue_marginal_that_is_truly_zero_has_a_witness():
    """Element 0 only sees across; once element 1 has seen along, the other axis is the worst, and 2 alone helps it."""
    prior = np.eye(2)[None] * 4.0
    information = np.array([np.diag([1.0, 0.0]), np.diag([0.0, 1.0]), np.diag([2.0, 0.5])])[:, None]
    found = ro.total_curvature(ro.MaxEigenvalueObjective(prior, information), [0, 1, 2], params=SEARCHED)
    assert found.upper == 1
    assert 1 - 1e-11 < found.lower < 1  # a marginal that is computed as 0 is 0 up to rounding
    assert ratio_shown(ro.MaxEigenvalueObjective(prior, information), found) == 1


@pytest.mark.parametrize("bad", [np.nan, np.inf])
@pytest.mark.parametrize("n", [4, 30])
@pytest.mark.parametrize("measure", [ro.curvature, ro.total_curvature])
def test_values_that_are_no_numbers_are_refused(bad, n, measure):
    f = ro.ConcaveOfModular(np.ones(n), lambda totals: np.where(totals == n, bad, totals))
    with pytest.raises(ro.InputError, match="must have finite values"):
        measure(f)


def test_a_curvature_over_feasible_sets_says_what_it_relies_on():
    f, owners = section_six("trace", 3)
    assert "submodularity relied on, not checked" in ro.curvature(f, owners).how
    assert "relied on" not in ro.curvature(*section_six("logdet", 3)).how


@pytest.mark.parametrize("kind", ["trace", "logdet"])
def test_large_ground_sets_know_one_context_of_every_element_at_once(kind):
    """Where a single search would take too long, elements are judged on top of the strongest others."""

    slow = ro.CurvatureParams(separable=SeparableParams(at_once=0))
    problem = ro.random_scenario(12, 4, alpha_s=0, alpha_c=0, seed=5).problem(kind)
    f = problem.objective
    found = ro.total_curvature(f, problem.robot, time_limit=0, params=slow)
    assert found.nodes == 0
    assert found.lower > 0
    context = found.smallest_context
    assert len(set(problem.robot[[found.element, *context]])) == 12
    gain = f([*context, found.element]) - f(context)
    assert 1 - gain / f([found.element]) == pytest.approx(found.lower, rel=1e-6)
    searched = ro.total_curvature(f, problem.robot, time_limit=2, params=slow)
    assert found.lower <= searched.upper
    assert searched.lower <= found.upper
