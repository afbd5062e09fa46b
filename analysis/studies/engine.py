"""The one loop that runs every study."""

from __future__ import annotations

from concurrent.futures import CancelledError, Future, as_completed
from concurrent.futures.process import BrokenProcessPool
from time import monotonic
from typing import TYPE_CHECKING

from analysis.studies.executors import has_workers
from analysis.studies.store import open_journal
from analysis.studies.study import run_trial

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping
    from concurrent.futures import Executor
    from pathlib import Path

    from analysis.studies.progress import Progress
    from analysis.studies.store import Journal
    from analysis.studies.study import Cell, Study

__all__ = ["SweepError", "run"]


class SweepError(Exception):
    """A sweep could not go on; finished rows are kept, and the text is one line that says what to do."""


AGAIN = "finished rows are kept, run the same command to resume"
PATIENCE = 60.0
"""Seconds that a cluster may be without any worker before the sweep ends; one that restarts is back by then."""
LOOKS = 5.0
"""Seconds between two looks at the cluster while no trial ends."""


def run(
    study: Study,
    folder: Path,
    executor: Executor,
    *,
    trials: int,
    progress: Progress,
    accept_old_rows: bool = False,
) -> Path:
    """Run the trials of ``study`` that ``folder`` does not hold yet, and return the path of the sorted table.

    Trials already in ``folder`` are never run again, also when there are more of them than ``trials``.
    ``accept_old_rows`` : also rows that other code made count as such; each says which.

    Raises
    ------
    InputError : ``folder`` holds something else.
    SweepError : a trial failed or the workers were lost; the rows so far are kept.
    """
    with open_journal(study, folder, accept_old_rows=accept_old_rows) as journal:
        done = journal.done
        # All cases of a trial before the next trial: an interrupted sweep is balanced.
        every = [(case, trial) for trial in range(trials) for case in range(len(study.cases))]
        missing = [(case, trial) for case, trial in every if (study.cases[case].name, trial) not in done]
        futures = {executor.submit(run_trial, study, case, trial): (case, trial) for case, trial in missing}
        with progress.task(study.name, total=len(every), done=len(every) - len(missing)) as advance:
            try:
                for future in _finished(futures, executor):
                    journal.append(_result(future, study, *futures[future]))
                    advance()
            except SweepError:
                _keep_finished(journal, futures, study)
                raise
        return journal.write_table()


def _finished(futures: Iterable[Future[dict[str, Cell]]], executor: Executor) -> Iterator[Future[dict[str, Cell]]]:
    """Yield trials as they end; a cluster whose workers are all gone for long is a :class:`SweepError`."""
    waiting, seen_at = set(futures), monotonic()
    while waiting:
        try:
            for future in as_completed(waiting, timeout=LOOKS):
                waiting.discard(future)
                seen_at = monotonic()
                yield future
        except TimeoutError:
            if has_workers(executor):
                seen_at = monotonic()
            elif monotonic() - seen_at > PATIENCE:
                raise SweepError(f"the cluster has had no worker for {PATIENCE:g} s; {AGAIN}") from None


def _keep_finished(journal: Journal, futures: Mapping[Future[dict[str, Cell]], tuple[int, int]], study: Study) -> None:
    """Append what else has finished by now: futures that end together are met in any order."""
    for future, (case, trial) in futures.items():
        finished = future.done() and not future.cancelled() and future.exception() is None
        if finished and (study.cases[case].name, trial) not in journal.done:
            journal.append(future.result())


def _result(future: Future[dict[str, Cell]], study: Study, case: int, trial: int) -> dict[str, Cell]:
    """Return a finished trial, or say in one line why there is none."""
    try:
        failure = future.exception()
    except CancelledError:
        raise SweepError(f"the cluster dropped the trials; {AGAIN}") from None
    if failure is None:
        return future.result()
    shown = f"{type(failure).__name__}: {' '.join(str(failure).split())}"
    if isinstance(failure, BrokenProcessPool):
        raise SweepError(f"a worker process died; {AGAIN}") from None
    if isinstance(failure, ModuleNotFoundError):
        raise SweepError(f"a worker lacks the package ({shown}); {AGAIN}") from None
    where = f"study {study.name}, case {study.cases[case].name}, trial {trial}"
    raise SweepError(f"{where} failed ({shown}); {AGAIN}") from failure
