"""Worker processes on this machine, as executors: one pool, or processes of which each may be lost alone."""

from __future__ import annotations

import multiprocessing
import os
import signal
import threading
from concurrent.futures import Executor, Future, ProcessPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from contextlib import contextmanager, suppress
from functools import partial
from typing import TYPE_CHECKING, Any, TypeVar

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

__all__ = ["SeparateProcesses", "local_processes", "may_start_processes"]

T = TypeVar("T")

THREAD_VARIABLES = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS")


class _Pool(ProcessPoolExecutor):
    """One that ends although its processes died while a call was being sent to them.

    Before 3.12 the thread that sends it, and with it shutting down and the interpreter's exit, waits for ever
    (python/cpython#94777). If nobody holds the reading end any more it gets an error, and ends.
    """

    def submit(self, fn: Callable[..., T], /, *args: Any, **kwargs: Any) -> Future[T]:
        """Run a call on one of the processes."""
        future = super().submit(fn, *args, **kwargs)
        future.add_done_callback(partial(_stop_sending, vars(self).get("_call_queue")))
        return future


def _stop_sending(calls: Any, future: Future[Any]) -> None:
    """Close the reading end of the queue of ``calls`` if the future is lost with its process."""
    if calls is not None and not future.cancelled() and isinstance(future.exception(), BrokenProcessPool):
        with suppress(OSError):  # closed already
            calls._reader.close()


def may_start_processes() -> bool:
    """Whether this process may start others; a worker of a ``multiprocessing.Pool`` may not (it is daemonic)."""
    return not multiprocessing.current_process().daemon


@contextmanager
def local_processes(workers: int | None) -> Iterator[Executor]:
    """Start local processes by spawn (fork deadlocks with threads), with one BLAS thread each.

    Leaving the block by an exception stops them at once.
    """
    known = set(multiprocessing.active_children())
    with _one_thread_each():
        executor = _Pool(workers, multiprocessing.get_context("spawn"), initializer=_follow_parent)
        try:
            with _uninterrupted():
                executor.submit(os.getpid)  # starts all of them
            yield executor
        except BaseException:
            # Not cancelled first: the pool would then report its cancelled trials as broken, with a traceback.
            for process in set(multiprocessing.active_children()) - known:
                process.terminate()
            raise
        finally:
            executor.shutdown()


class SeparateProcesses(Executor):
    """That many pools of one process each, started at first use: one that dies takes no other's work along.

    Unlike a pool of several processes it goes on after that: the next call starts another one. Shutting down ends
    them at once, whatever they are at.
    """

    def __init__(self, workers: int) -> None:
        self._pools: list[_Pool | None] = [None] * workers
        self._running: list[list[Future[Any]]] = [[] for _ in range(workers)]
        self._processes: list[Any] = []

    def submit(self, fn: Callable[..., T], /, *args: Any, **kwargs: Any) -> Future[T]:
        """Run a call on the process that has the fewest left."""
        for futures in self._running:
            futures[:] = [future for future in futures if not future.done()]
        k = min(range(len(self._pools)), key=lambda i: len(self._running[i]))
        try:
            future = self._pool(k).submit(fn, *args, **kwargs)
        except BrokenProcessPool:  # it died since
            self._pools[k] = None
            future = self._pool(k).submit(fn, *args, **kwargs)
        self._running[k].append(future)
        return future

    def _pool(self, k: int) -> _Pool:
        pool = self._pools[k]
        if pool is None:
            known = set(multiprocessing.active_children())
            pool = _Pool(1, multiprocessing.get_context("spawn"), initializer=_follow_parent)
            with _one_thread_each(), _uninterrupted():
                pool.submit(os.getpid)  # starts it
            self._pools[k] = pool
            self._processes += set(multiprocessing.active_children()) - known
        return pool

    def shutdown(self, wait: bool = True, *, cancel_futures: bool = False) -> None:  # noqa: ARG002  (nothing waits)
        """End all processes now."""
        for process in self._processes:
            with suppress(ValueError):  # closed already
                process.terminate()
        for pool in self._pools:
            if pool is not None:
                pool.shutdown()


@contextmanager
def _one_thread_each() -> Iterator[None]:
    """Processes started meanwhile use one BLAS thread."""
    before = {name: os.environ.get(name) for name in THREAD_VARIABLES}
    os.environ.update(dict.fromkeys(THREAD_VARIABLES, "1"))
    try:
        yield
    finally:
        for name, value in before.items():
            os.environ.pop(name) if value is None else os.environ.update({name: value})


@contextmanager
def _uninterrupted() -> Iterator[None]:
    """Processes started meanwhile never see Ctrl-C, not even before they can say so; here it comes afterwards."""
    if not hasattr(signal, "pthread_sigmask"):
        yield
        return
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


def _follow_parent() -> None:
    """Leave Ctrl-C to the parent, and end with it even when it is killed without a word."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    parent = multiprocessing.parent_process()
    assert parent is not None

    def watch() -> None:
        parent.join()
        os._exit(1)

    threading.Thread(target=watch, daemon=True).start()
