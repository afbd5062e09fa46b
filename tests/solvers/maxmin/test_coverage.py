"""Coverage and facility location as a trace: values of all sets, and both ends against the exhaustive optimum."""

import numpy as np
import pytest

import ratt_opt as ro
from ratt_opt.solvers.maxmin.coverage import CoverageTrace
from ratt_opt.solvers.maxmin.params import CoverageParams


def drawn_sum(rng: np.random.Generator, n: int, parts: int) -> ro.Coverage | ro.FacilityLocation:
    """Coverage with whole or other weights, or a facility location with few levels, zeros and equal items."""
    if rng.random() < 0.5:
        covers = rng.random((n, parts)) < 0.3
        covers[:, -1] = covers[:, 0]
        weights = rng.integers(0, 5, parts) * 2.0 if rng.random() < 0.5 else rng.uniform(0, 3, parts)
        return ro.Coverage(covers, weights)
    return ro.FacilityLocation(rng.integers(0, 4, size=(n, parts)) * (1.0 if rng.random() < 0.5 else 0.37))


@pytest.mark.parametrize("seed", range(40))
def test_the_trace_brackets_the_value_of_every_set(seed: int) -> None:
    rng = np.random.default_rng([81, seed])
    f = drawn_sum(rng, 6, int(rng.integers(2, 12)))
    trace = CoverageTrace.of(ro.Problem(f, [0, 0, 1, 1, 2, 2], None, 1, 0))
    if trace is None:
        assert not any(f.table())
        return
    values, below = f.table(), trace.problem.objective.table()
    assert (below <= values * trace.rounding + 1e-12).all()
    assert (values <= below * trace.factor + 1e-9 * values.max()).all()
    if trace.unit > 0:
        assert (values % trace.unit == 0).all()


@pytest.mark.parametrize("seed", range(25))
def test_both_ends_hold_the_exhaustive_optimum(seed: int) -> None:
    rng = np.random.default_rng([82, seed])
    robots, controls = int(rng.integers(2, 6)), int(rng.integers(1, 4))
    f = drawn_sum(rng, robots * controls, int(rng.integers(2, 15)))
    links = rng.random() < 0.5
    problem = ro.Problem(
        f, np.repeat(np.arange(robots), controls), None, int(rng.integers(0, 2)), robots - 1 if links else 0
    )
    trace = CoverageTrace.of(problem)
    if trace is None:
        return
    found = trace.carried_over(ro.solve_maxmin(trace.problem, gap=trace.gap(1e-9)))
    best = ro.exhaustive_optimum(problem)
    assert found.lower <= best.lower + 1e-9
    assert best.upper <= found.upper + 1e-9 * (1 + best.upper)
    if trace.unit > 0:
        assert found.lower == best.lower == found.upper
    kept = ro.worst_case_attack(problem, found.elements).lower
    assert kept >= found.lower - 1e-9


def test_a_team_too_large_to_enumerate_closes_exactly() -> None:
    rng = np.random.default_rng(83)
    covers = rng.random((10 * 6, 30)) < 0.1
    problem = ro.Problem(ro.Coverage(covers, np.ones(30)), np.repeat(np.arange(10), 6), None, 2, 0)
    found = ro.solve_maxmin(problem, time_limit=60)
    assert found.stop is ro.Stop.CLOSED
    assert found.lower == found.upper == ro.worst_case_attack(problem, found.elements).lower


def test_other_functions_and_large_sums_have_no_trace() -> None:
    table = ro.TableFunction(np.arange(4.0))
    assert CoverageTrace.of(ro.Problem(table, [0, 1], None, 0, 0)) is None
    large = ro.FacilityLocation(np.random.default_rng(0).random((40, 200)))
    assert CoverageTrace.of(ro.Problem(large, np.arange(40), None, 0, 0), CoverageParams(most_entries=10_000)) is None
