"""One instance on many cores: the same bracket and a valid proof, whoever works, dies, is slow or is interrupted."""

from __future__ import annotations

import os
import signal
import threading
import time
from concurrent.futures import Future, ThreadPoolExecutor
from dataclasses import replace
from multiprocessing import active_children

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import ratt_opt as ro
from ratt_opt import InputError, Stop, random_scenario, solve_maxmin
from tests.oracles import brute_force_optimum
from tests.solvers.maxmin.engine import GRACE, LOSSES, SHARED_AT_ONCE
from tests.solvers.maxmin.proofs import proved_upper
from tests.solvers.maxmin.subtrees.workers import Here, assert_agree, hard
from tests.strategies import OBJECTIVES, random_problem
from tests.ways import go


@pytest.fixture
def shared_at_once(monkeypatch: pytest.MonkeyPatch) -> None:
    """Every search is shared from its first nodes on, in small pieces."""
    go(monkeypatch, SHARED_AT_ONCE)


@pytest.mark.usefixtures("shared_at_once")
@settings(max_examples=12, deadline=None)
@given(st.integers(0, 10**6), st.sampled_from(list(OBJECTIVES)))
def test_the_optimum_is_that_of_brute_force(seed: int, kind: str) -> None:
    rng = np.random.default_rng([9, seed])
    problem = random_problem(rng, int(rng.integers(1, 5)), kind=kind, controls=4)
    expected = brute_force_optimum(problem)
    scale = max(1.0, abs(expected))
    lost = int(rng.integers(0, 4))
    found = solve_maxmin(problem, workers=Here(lambda call: call % 4 < lost))
    assert found.lower == pytest.approx(expected, abs=1e-8 * scale)
    assert found.upper == pytest.approx(expected, abs=1e-8 * scale)
    if found.proof is not None:
        assert proved_upper(problem, found.proof) <= found.upper + 1e-10 * scale


@pytest.mark.usefixtures("shared_at_once")
@pytest.mark.parametrize("kind", OBJECTIVES)
def test_the_bracket_is_that_of_one_core_and_its_certificate_stands(kind, tmp_path):
    problem, alone = hard(kind)
    executor = Here()
    found = solve_maxmin(problem, gap=1e-6, workers=executor)
    assert executor.calls > 0
    assert_agree(problem, found, alone)
    verified = ro.certify(problem, found, tmp_path / "certificate.json").verified
    assert verified.upper == pytest.approx(found.upper, rel=1e-9)


@pytest.mark.usefixtures("shared_at_once")
@pytest.mark.parametrize("workers", [1, 2, 3])
def test_processes_find_the_same_bracket(workers):
    problem, alone = hard()
    assert_agree(problem, solve_maxmin(problem, gap=1e-6, workers=workers), alone)


@pytest.mark.usefixtures("shared_at_once")
def test_threads_find_the_same_bracket():
    problem, alone = hard("logdet")
    with ThreadPoolExecutor(2) as executor:
        assert_agree(problem, solve_maxmin(problem, gap=1e-6, workers=executor), alone)


@pytest.mark.usefixtures("shared_at_once")
def test_when_all_work_is_lost_the_search_goes_on_alone():
    problem, alone = hard()
    executor = Here(lambda _: True)
    assert_agree(problem, solve_maxmin(problem, gap=1e-6, workers=executor), alone)
    assert LOSSES <= executor.calls <= LOSSES + 1


@pytest.mark.usefixtures("shared_at_once")
def test_a_killed_process_costs_only_its_work():
    problem, alone = hard()
    killed = []

    def kill_first(*_):
        children = [c for c in active_children() if c.is_alive()]
        if children and not killed:
            killed.append(children[0].pid)
            os.kill(children[0].pid, signal.SIGKILL)

    found = solve_maxmin(problem, gap=1e-6, workers=2, progress=kill_first)
    assert killed
    assert_agree(problem, found, alone)


@pytest.mark.usefixtures("shared_at_once")
@pytest.mark.parametrize("nodes", [1, 2, 3, 7])
def test_a_limit_of_nodes_is_kept_and_the_bracket_valid(nodes):
    problem, alone = hard()
    found = solve_maxmin(problem, gap=1e-6, max_nodes=nodes, workers=Here())
    assert found.nodes <= nodes
    assert found.lower <= alone.upper * (1 + 1e-9)
    assert alone.lower <= found.upper * (1 + 1e-9)
    assert proved_upper(problem, found.proof) <= found.upper * (1 + 1e-10)


@pytest.mark.usefixtures("shared_at_once")
def test_a_limit_of_time_is_kept_whatever_the_workers_are_at():
    """Also where they never answer."""
    problem, alone = hard()

    class Silent(Here):
        def submit(self, *_, **__):
            return Future()

    began = time.monotonic()
    found = solve_maxmin(problem, gap=0, time_limit=0.5, workers=Silent())
    assert time.monotonic() - began < 0.5 * 1.05 + 0.5 + GRACE
    assert found.stop is Stop.TIME
    assert alone.lower <= found.upper * (1 + 1e-9)
    assert solve_maxmin(problem, time_limit=0, workers=2).stop is Stop.TIME


@pytest.mark.usefixtures("shared_at_once")
def test_an_interrupt_leaves_the_bracket_so_far_and_no_process():
    problem = random_scenario(30, 12, alpha_s=10, alpha_c=108, seed=2).problem()  # a second of search
    before = set(active_children())
    met = []

    def interrupt(*_):
        if active_children() and not met:
            met.append(time.monotonic())
            threading.Timer(0.1, signal.raise_signal, [signal.SIGINT]).start()

    found = solve_maxmin(problem, gap=0, workers=2, progress=interrupt, time_limit=20)
    assert found.stop is Stop.INTERRUPTED
    assert time.monotonic() - met[0] < 1.5
    assert found.lower > 0
    assert proved_upper(problem, found.proof) <= found.upper * (1 + 1e-10)
    assert set(active_children()) <= before


def test_what_cannot_be_sent_is_refused_by_name():
    problem, _ = hard()

    class Hidden(ro.TraceObjective):
        pass

    hidden = replace(problem, objective=Hidden(problem.objective.prior, problem.objective.information))
    with pytest.raises(InputError, match="workers must be None if the problem cannot be pickled"):
        solve_maxmin(hidden, workers=2)
    with ThreadPoolExecutor(1) as executor:  # threads need nothing sent
        assert solve_maxmin(hidden, gap=1e-2, workers=executor).lower > 0


@pytest.mark.parametrize("workers", [0, -1, True, 1.5, "two"])
def test_workers_are_a_number_or_an_executor(workers):
    with pytest.raises(InputError, match="workers"):
        solve_maxmin(hard()[0], workers=workers)
