"""Places where trials run: local processes, or a Dask cluster."""

from __future__ import annotations

import logging
from contextlib import contextmanager
from typing import TYPE_CHECKING

from ratt_opt.errors import InputError
from ratt_opt.running.processes import local_processes
from ratt_opt.studies.versions import VERSIONS, file_of

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator
    from concurrent.futures import Executor

    from distributed import Client

__all__ = ["dask_cluster", "has_workers", "local_processes", "open_executor", "share_modules"]


@contextmanager
def open_executor(cluster: str | None, workers: int | None) -> Iterator[Executor]:
    """Open the Dask cluster at address ``cluster``, or ``workers`` local processes (one per core by default)."""
    with local_processes(workers) if cluster is None else dask_cluster(cluster) as executor:
        yield executor


def share_modules(executor: Executor | None, names: Iterable[str]) -> None:
    """Send the modules of a study that are one file each to the workers of a cluster, which may run in other folders.

    Modules inside packages are not sent: workers have to have the package installed.
    """
    client = getattr(executor, "_client", None)
    if client is None:
        return
    for name in names:
        file = file_of(name)
        if file and "." not in name and name != "__main__":  # functions of a script travel with their text
            client.upload_file(file)


def has_workers(executor: Executor) -> bool:
    """Tell whether anybody runs trials; a cluster that does not answer fails its trials."""
    client = getattr(executor, "_client", None)
    if client is None:
        return True
    try:
        return bool(client.nthreads())
    except (OSError, ValueError, RuntimeError, TimeoutError):
        return False


@contextmanager
def dask_cluster(address: str, patience: float = 10.0) -> Iterator[Executor]:
    """Use the workers of a running Dask scheduler; a worker that dies has its trials run elsewhere.

    ``patience`` : seconds to wait for it to answer, and for its first worker.

    Raises
    ------
    InputError : no scheduler answers there, it has no worker, or a worker's package is missing or another version.
    """
    try:
        from distributed import Client
    except ImportError:
        raise InputError("cluster", "needs Dask: install the extra 'cluster'", "no module 'distributed'") from None
    try:
        client = Client(address, timeout=patience, set_as_default=False)
    except (OSError, ValueError, TypeError):
        rule = f"must be the address of a Dask scheduler that answers within {patience:g} s"
        raise InputError("cluster", rule, address) from None
    # The engine says in one line what it would log of a lost scheduler.
    with _silenced("distributed", "tornado"), client:
        _check_workers(client, address, patience)
        yield client.get_executor(pure=False)


@contextmanager
def _silenced(*packages: str) -> Iterator[None]:
    """Let packages log only what is critical; their loggers may each have a level of their own."""
    logs = [logging.getLogger(name) for name in logging.root.manager.loggerDict if name.split(".")[0] in packages]
    before = [log.level for log in logs]
    for log in logs:
        log.setLevel(logging.CRITICAL)
    try:
        yield
    finally:
        for log, level in zip(logs, before, strict=True):
            log.setLevel(level)


def _check_workers(client: Client, address: str, patience: float) -> None:
    """Ask every worker for the versions its rows would carry."""
    try:
        client.wait_for_workers(1, timeout=patience)
    except TimeoutError:
        raise InputError("cluster", f"must have a worker within {patience:g} s", f"none at {address}") from None
    # A standard-library function, so that a worker without the package can still be asked.
    from pkgutil import resolve_name

    answers = client.run(resolve_name, "ratt_opt.studies.versions:VERSIONS", on_error="return")
    for worker, answer in sorted(answers.items()):
        if answer != VERSIONS:
            shown = f"{type(answer).__name__}: {answer}" if isinstance(answer, Exception) else answer
            raise InputError(f"worker {worker}", f"must import the same package ({VERSIONS})", shown)
