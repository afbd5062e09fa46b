"""Searches with workers in a process that may start no others."""

from __future__ import annotations

import multiprocessing
import warnings

import pytest

from ratt_opt import random_scenario, solve_maxmin


def search(_: int) -> tuple[float, float, list[str]]:
    """Search with two workers; the bracket, and what was warned of."""
    problem = random_scenario(5, 4, alpha_s=1, alpha_c=2, seed=0).problem()
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        found = solve_maxmin(problem, workers=2)
    return found.lower, found.upper, [str(warning.message) for warning in caught]


@pytest.mark.parametrize("method", ["fork", "spawn", "forkserver"])
def test_a_pools_worker_searches_alone_and_says_so(method: str):
    if method not in multiprocessing.get_all_start_methods():
        pytest.skip(f"this system does not start processes by {method}")
    alone = solve_maxmin(random_scenario(5, 4, alpha_s=1, alpha_c=2, seed=0).problem())
    with multiprocessing.get_context(method).Pool(1) as pool:
        lower, upper, told = pool.map(search, [0])[0]
    assert (lower, upper) == (alone.lower, alone.upper)
    assert any("daemonic" in text for text in told)
