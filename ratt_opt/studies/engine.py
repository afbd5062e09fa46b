"""The one loop that runs every study."""

from __future__ import annotations

from concurrent.futures import CancelledError, Future, as_completed
from concurrent.futures.process import BrokenProcessPool
from contextlib import contextmanager
from pathlib import Path
from tempfile import TemporaryDirectory
from time import monotonic
from typing import TYPE_CHECKING

from ratt_opt._validation import check_integer
from ratt_opt.running.processes import local_processes
from ratt_opt.studies.executors import has_workers, share_modules
from ratt_opt.studies.progress import Progress
from ratt_opt.studies.results import Results
from ratt_opt.studies.store import open_journal, read_table
from ratt_opt.studies.study import run_trial

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping
    from concurrent.futures import Executor

    from ratt_opt.studies.cases import Cell
    from ratt_opt.studies.store import TrialJournal
    from ratt_opt.studies.study import Study

__all__ = ["SweepError", "run"]


class SweepError(Exception):
    """A sweep could not go on; finished rows are kept, and the text is one line that says what to do."""


AGAIN = "finished rows are kept, run the same command to resume"


def run(
    study: Study,
    folder: str | Path | None = None,
    executor: Executor | None = None,
    *,
    trials: int | None = None,
    workers: int | None = 1,
    progress: Progress | None = None,
    accept_old_rows: bool = False,
) -> Results:
    """Run the trials of ``study`` that ``folder`` does not hold yet, and return the results.

    Trials already in ``folder`` are never run again, also when there are more of them than ``trials``. An interrupt
    (Ctrl-C) keeps the finished trials; the same call goes on from there.

    Parameters
    ----------
    folder : where each finished trial is kept as a row; ``None`` keeps them in memory only
    executor : where trials run, if not here
    trials : trials of every case; by default the study's ``fixed_trials``, or 20
    workers : processes, if there is no executor: 1 is this process, ``None`` one for each core. Several processes need
        the functions of a study in a module, and a script that begins with ``if __name__ == "__main__":``
    progress : what tells where the work stands; by default a bar on a terminal, lines elsewhere
    accept_old_rows : also rows that other code made count as such; each says which

    Raises
    ------
    InputError : an argument breaks its rule, or ``folder`` holds something else.
    SweepError : a trial failed or the workers were lost; the rows so far are kept.
    """
    wanted = check_integer("trials", study.fixed_trials or 20 if trials is None else trials, low=1)
    if workers is not None:
        check_integer("workers", workers, low=1)
    with _somewhere(folder) as kept, _running(executor, workers) as running:
        with open_journal(study, kept, accept_old_rows=accept_old_rows) as journal:
            share_modules(running, study.modules())
            _run_missing(study, journal, running, wanted, progress or Progress())
            path = journal.write_table()
        return Results(study=study, rows=tuple(read_table(kept)), path=None if folder is None else path)


@contextmanager
def _somewhere(folder: str | Path | None) -> Iterator[Path]:
    """The folder, or one that is gone afterwards."""
    if folder is not None:
        yield Path(folder)
        return
    with TemporaryDirectory(prefix="ratt-opt-study-") as temporary:
        yield Path(temporary)


@contextmanager
def _running(executor: Executor | None, workers: int | None) -> Iterator[Executor | None]:
    """Place where trials run; ``None`` is this process."""
    if executor is not None or workers == 1:
        yield executor
        return
    with local_processes(workers) as processes:
        yield processes


def _run_missing(
    study: Study, journal: TrialJournal, executor: Executor | None, trials: int, progress: Progress
) -> None:
    """Run what the journal lacks, and append each trial as it ends."""
    done = journal.done
    # All cases of a trial before the next trial: an interrupted sweep is balanced.
    every = [(case, trial) for trial in range(trials) for case in range(len(study.cases))]
    missing = [(case, trial) for case, trial in every if (study.cases[case].name, trial) not in done]
    with progress.task(study.name, total=len(every), done=len(every) - len(missing)) as advance:
        if executor is None:
            for case, trial in missing:
                journal.append(_result(_run_here(study, case, trial), study, case, trial))
                advance()
            return
        futures = {executor.submit(run_trial, study, case, trial): (case, trial) for case, trial in missing}
        try:
            for future in _finished(futures, executor):
                journal.append(_result(future, study, *futures[future]))
                advance()
        except SweepError:
            _keep_finished(journal, futures, study)
            raise


def _run_here(study: Study, case: int, trial: int) -> Future[dict[str, Cell]]:
    """A finished trial, as an executor would hand it over."""
    future: Future[dict[str, Cell]] = Future()
    try:
        future.set_result(run_trial(study, case, trial))
    except Exception as error:  # noqa: BLE001  (whatever a planner of the user's raises is named in one line)
        future.set_exception(error)
    return future


def _finished(
    futures: Iterable[Future[dict[str, Cell]]], executor: Executor, patience: float = 60.0, look: float = 5.0
) -> Iterator[Future[dict[str, Cell]]]:
    """Yield trials as they end; a cluster whose workers are all gone for long is a :class:`SweepError`.

    ``patience`` : seconds that it may be without any worker; one that restarts is back by then.
    ``look`` : seconds between two looks at the cluster while no trial ends.
    """
    waiting, seen_at = set(futures), monotonic()
    while waiting:
        try:
            for future in as_completed(waiting, timeout=look):
                waiting.discard(future)
                seen_at = monotonic()
                yield future
        except TimeoutError:
            if has_workers(executor):
                seen_at = monotonic()
            elif monotonic() - seen_at > patience:
                raise SweepError(f"the cluster has had no worker for {patience:g} s; {AGAIN}") from None


def _keep_finished(
    journal: TrialJournal, futures: Mapping[Future[dict[str, Cell]], tuple[int, int]], study: Study
) -> None:
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
        rule = "install it there, or keep the study's functions in one file beside your script"
        raise SweepError(f"a worker lacks a package ({shown}): {rule}; {AGAIN}") from None
    where = f"study {study.name}, case {study.cases[case].name}, trial {trial}"
    raise SweepError(f"{where} failed ({shown}); {AGAIN}") from failure
