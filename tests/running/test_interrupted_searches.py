"""One rule for all searches: interrupted at any moment, each returns its bracket and says so."""

import signal
import threading
import time

import numpy as np
import pytest

import ratt_opt as ro
from analysis.faults.moments import interrupted_after, is_answered, searches
from tests.strategies import OwnTrace

LONG = (
    "worst_case_attack, network",
    "worst_case_attack, three dimensions",
    "solve_maxmin",
    "refined",
    "links_to_protect",
    "attack_survey",
    "criticality_ranking",
    "total_curvature",
    "submodularity_ratio",
)


@pytest.mark.parametrize("name", LONG)
@pytest.mark.parametrize("delay", [0.0, 0.06])
def test_searches_answer_an_interrupt_soon_and_with_a_bracket(name, delay):
    search = searches()[name]
    moment = interrupted_after(search, delay)
    assert is_answered(moment), moment
    assert moment.seconds is None or moment.seconds < 0.6  # 0.3 s in the campaign, whose modules are loaded


class Raising(OwnTrace):
    """Raises an interrupt in the ``at``-th value, where Python itself would in a slow function of a user's own."""

    calls, at = 0, None

    def value(self, posterior_information):
        Raising.calls += 1
        if Raising.calls == Raising.at:
            raise KeyboardInterrupt
        return super().value(posterior_information)


def raising_problem() -> ro.Problem:
    rng = np.random.default_rng(0)
    h = rng.normal(size=(12, 2, 1, 2))
    objective = Raising(np.stack([np.eye(2)] * 2), np.swapaxes(h, -1, -2) @ h)
    return ro.Problem(objective, np.repeat(np.arange(4), 3), None, 1, 3)


SEARCHES = {
    "refined": lambda p: ro.refined(p, time_limit=None, max_kicks=2),
    "solve_maxmin": ro.solve_maxmin,
    "exhaustive_optimum": ro.exhaustive_optimum,
    "worst_case_attack": lambda p: ro.worst_case_attack(p, np.arange(4) * 3),
    "links_to_protect": lambda p: ro.links_to_protect(p, np.arange(4) * 3, 2),
    "attack_survey": lambda p: ro.attack_survey(p, np.arange(4) * 3)["worst"],
    "breaking_budgets": lambda p: ro.breaking_budgets(p, np.arange(4) * 3, 1.0),
    "nonrobust_optimum": ro.nonrobust_optimum,
    "total_curvature": lambda p: ro.total_curvature(p.objective, p.robot),
    "submodularity_ratio": lambda p: ro.submodularity_ratio(p.objective, p.robot),
    "generalised_curvature": lambda p: ro.generalised_curvature(p.objective, p.robot),
}


@pytest.mark.parametrize("name", SEARCHES)
def test_an_interrupt_in_any_value_leaves_a_bracket(name):
    """The early and the late ones left as they came, or were lost; every value of some searches, a sample of others."""
    problem, search = raising_problem(), SEARCHES[name]
    Raising.calls, Raising.at = 0, None
    search(problem)
    every = max(Raising.calls // 25, 1)
    for at in range(1, Raising.calls, every):
        problem = raising_problem()
        Raising.calls, Raising.at = 0, at
        found = search(problem)
        if Raising.calls >= at:
            assert found.stop is ro.Stop.INTERRUPTED, at
    Raising.at = None


class Slow(ro.SetFunction):
    """Some values take a minute, in which no loop of the library can look at anything."""

    @property
    def n(self) -> int:
        return 6

    def evaluate(self, membership: np.ndarray) -> np.ndarray:
        if 3 < membership.sum(axis=1).max() < 6:
            until = time.monotonic() + 60
            while time.monotonic() < until:
                time.sleep(0.01)
        return membership.sum(axis=1).astype(float)


def test_a_slow_value_of_a_users_function_is_left():
    problem = ro.Problem(Slow(), np.arange(6), None, 1, 1)
    began = time.monotonic()
    moment = interrupted_after(lambda: ro.worst_case_attack(problem, np.arange(6)), 0.01)
    assert is_answered(moment), moment
    assert moment.found.lower <= 4 <= moment.found.upper
    assert time.monotonic() - began < 30
    assert signal.getsignal(signal.SIGINT) is signal.default_int_handler


def test_other_threads_and_other_handlers_are_left_alone():
    problem, found = raising_problem(), []
    thread = threading.Thread(target=lambda: found.append(ro.worst_case_attack(problem, np.arange(4) * 3)))
    thread.start()
    thread.join()
    assert found[0].stop in {ro.Stop.CLOSED, ro.Stop.EXHAUSTED}
    seen = []
    before = signal.signal(signal.SIGINT, lambda number, _frame: seen.append(number))
    try:
        signal.raise_signal(signal.SIGINT)
        assert ro.worst_case_attack(problem, np.arange(4) * 3).stop in {ro.Stop.CLOSED, ro.Stop.EXHAUSTED}
    finally:
        signal.signal(signal.SIGINT, before)
    assert seen == [signal.SIGINT]


def test_what_was_found_until_an_interrupt_is_kept():
    """The bracket is narrower than what is known at once."""
    search = searches()["solve_maxmin"]
    early, late = (interrupted_after(search, delay) for delay in (0.0, 0.5))
    assert late.found.lower >= early.found.lower
    assert late.found.upper <= early.found.upper
