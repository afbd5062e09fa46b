"""Who searches lent nodes: an executor of the user's, or processes of one's own; and what became of their work."""

from __future__ import annotations

import os
import pickle
import warnings
from concurrent.futures import FIRST_COMPLETED, Executor, Future, ThreadPoolExecutor, wait
from contextlib import contextmanager
from time import monotonic
from typing import TYPE_CHECKING
from uuid import uuid4

from ratt_opt._validation import check_integer
from ratt_opt.errors import InputError
from ratt_opt.running.processes import SeparateProcesses, may_start_processes
from ratt_opt.solvers.maxmin.subtrees.worker import Searched, Work, search_nodes

if TYPE_CHECKING:
    from collections.abc import Iterator

    from ratt_opt.problem import Problem
    from ratt_opt.solvers.maxmin.proof import TreeNode

__all__ = ["Crew", "check_workers", "open_crew"]

ALONE = "workers: a daemonic process may start no others, so the search goes on alone"
LOSSES = 3
"""Pieces of work lost one after the other, none coming back in between, after which nobody is asked any more."""


class Crew:
    """Pieces of work and their nodes; one that is lost, to whatever failure, comes back without a result.

    ``size`` : how many pieces are worked on at the same time; ``search`` : a name of the search that it is for
    ``since`` : when it was engaged, by the monotonic clock [s].
    """

    def __init__(self, executor: Executor, size: int) -> None:
        self._executor, self.size = executor, size
        self.search, self.since = uuid4().hex, monotonic()
        self._at_work: dict[Future[Searched], tuple[Work, list[TreeNode]]] = {}
        self._lost = 0
        self.has_answered = False
        """Whether anything has come back yet; until then processes may still be starting."""

    @property
    def idle(self) -> int:
        """How many more pieces of work would be begun at once."""
        return self.size - len(self._at_work)

    @property
    def promised(self) -> int:
        """Nodes that those at work may still explore."""
        return sum((work.max_nodes or 0) - work.nodes_before for work, _ in self._at_work.values())

    @property
    def is_gone(self) -> bool:
        """Whether work is lost with every worker."""
        return self._lost >= LOSSES

    def ask(self, work: Work, nodes: list[TreeNode]) -> None:
        """Give away the search of some nodes."""
        try:
            future = self._executor.submit(search_nodes, work)
        except (RuntimeError, OSError, ImportError) as error:  # broken, shut down, no more processes, no semaphores
            future = Future()
            future.set_exception(error)
        self._at_work[future] = work, nodes

    def answers(self, seconds: float) -> Iterator[tuple[list[TreeNode], Searched | None]]:
        """Nodes that came back within that many seconds, and what was found; ``None`` if it was lost."""
        done, _ = wait(self._at_work, timeout=seconds, return_when=FIRST_COMPLETED)
        for future in done:
            _, nodes = self._at_work.pop(future)
            failed = future.cancelled() or future.exception() is not None
            self._lost = self._lost + 1 if failed else 0
            self.has_answered = True
            yield nodes, None if failed else future.result()

    def recall(self) -> list[TreeNode]:
        """Wait for nobody any more; the nodes that are still away."""
        nodes = [node for _, away in self._at_work.values() for node in away]
        for future in self._at_work:
            future.cancel()
        self._at_work.clear()
        return nodes


def check_workers(problem: Problem, workers: int | Executor | None) -> None:
    """Check that a crew can be made of ``workers`` for this problem.

    Raises
    ------
    InputError : ``workers`` is neither a number >= 1 nor an executor, or the problem cannot be sent to processes.
    """
    if workers is None:
        return
    if not isinstance(workers, Executor) and check_integer("workers", workers, low=1) == 1:
        return
    if not isinstance(workers, ThreadPoolExecutor):
        _check_sendable(problem)


@contextmanager
def open_crew(workers: int | Executor | None) -> Iterator[Crew | None]:
    """The crew for one search, ``None`` if it is alone; own processes are ended with the block.

    If this process may start no others, the search is alone, with a warning.
    """
    if isinstance(workers, Executor):
        crew = Crew(workers, _size(workers))
        try:
            yield crew
        finally:
            crew.recall()
    elif workers is None or workers == 1:
        yield None
    elif not may_start_processes():
        warnings.warn(ALONE, RuntimeWarning, stacklevel=2)
        yield None
    else:
        executor = SeparateProcesses(int(workers))
        try:
            yield Crew(executor, int(workers))
        finally:
            executor.shutdown()


def _check_sendable(problem: Problem) -> None:
    try:
        pickle.dumps(problem)
    except (pickle.PicklingError, AttributeError, TypeError) as error:
        rule = "must be None if the problem cannot be pickled (define its classes and functions in a module)"
        raise InputError("workers", rule, f"{type(error).__name__}: {error}") from None


def _size(executor: Executor) -> int:
    """Workers of an executor: of a pool, or of a Dask client's executor; the cores here if it does not say."""
    client = getattr(executor, "_client", None)
    if client is not None:
        return max(sum(map(int, client.nthreads().values())), 1)
    return int(getattr(executor, "_max_workers", None) or os.cpu_count() or 1)
