"""Workers that are here, and problems worth sharing."""

from __future__ import annotations

import pickle
from concurrent.futures import Executor, Future
from functools import cache

from ratt_opt import Stop, random_scenario, solve_maxmin
from tests.solvers.maxmin.proofs import proved_upper


class Here(Executor):
    """Runs what it is asked at once, and counts it; ``loses`` says which calls fail, by their number."""

    def __init__(self, loses=lambda _: False) -> None:
        self.calls, self._loses, self._max_workers = 0, loses, 2
        self.trees: set[str] = set()

    def submit(self, fn, /, *args, **kwargs):
        self.calls += 1
        self.trees |= {work.tree for work in args if hasattr(work, "tree")}
        future = Future()
        if self._loses(self.calls):
            future.set_exception(ConnectionError("the worker is gone"))
        else:
            future.set_result(pickle.loads(pickle.dumps(fn(*pickle.loads(pickle.dumps(args)), **kwargs))))
        return future


@cache
def hard(kind="trace"):
    """A problem of 20 to 60 nodes, and its result."""
    problem = random_scenario(10, 15, alpha_s=3, alpha_c=11, seed=6).problem(kind)
    return problem, solve_maxmin(problem, gap=1e-6)


def assert_agree(problem, found, alone, gap=1e-6):
    scale = abs(alone.upper)
    assert found.stop in {Stop.GAP, Stop.CLOSED}
    assert found.upper - found.lower <= gap * scale * 1.001
    assert max(found.lower, alone.lower) <= min(found.upper, alone.upper) + 1e-9 * scale
    assert proved_upper(problem, found.proof) <= found.upper + 1e-10 * scale
