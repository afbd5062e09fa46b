"""Worker processes on this machine, as an executor."""

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

__all__ = ["local_processes"]

T = TypeVar("T")

THREAD_VARIABLES = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS")


class _ProcessPool(ProcessPoolExecutor):
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


@contextmanager
def local_processes(workers: int | None) -> Iterator[Executor]:
    """Start local processes by spawn (fork deadlocks with threads), with one BLAS thread each.

    Leaving the block by an exception stops them at once.
    """
    known = set(multiprocessing.active_children())
    with _one_thread_each():
        executor = _ProcessPool(workers, multiprocessing.get_context("spawn"), initializer=_follow_parent)
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
