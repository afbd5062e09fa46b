"""The one loop that runs every study."""

from __future__ import annotations

from concurrent.futures import CancelledError, Future, as_completed
from concurrent.futures.process import BrokenProcessPool
from typing import TYPE_CHECKING

from analysis.studies.store import open_journal
from analysis.studies.study import run_trial

if TYPE_CHECKING:
    from collections.abc import Mapping
    from concurrent.futures import Executor
    from pathlib import Path

    from analysis.studies.progress import Progress
    from analysis.studies.store import Journal
    from analysis.studies.study import Cell, Study

__all__ = ["SweepError", "run"]


class SweepError(Exception):
    """A sweep could not go on; finished rows are kept, and the text is one line that says what to do."""


def run(study: Study, folder: Path, executor: Executor, *, trials: int, progress: Progress) -> Path:
    """Run the trials of ``study`` that ``folder`` does not hold yet, and return the path of the sorted table.

    Trials already in ``folder`` are never run again, also when there are more of them than ``trials``.

    Raises
    ------
    InputError : ``folder`` holds something else.
    SweepError : a trial failed or the workers were lost; the rows so far are kept.
    """
    with open_journal(study, folder) as journal:
        done = journal.done
        # All cases of a trial before the next trial: an interrupted sweep is balanced.
        every = [(case, trial) for trial in range(trials) for case in range(len(study.cases))]
        missing = [(case, trial) for case, trial in every if (study.cases[case].name, trial) not in done]
        futures = {executor.submit(run_trial, study, case, trial): (case, trial) for case, trial in missing}
        with progress.task(study.name, total=len(every), done=len(every) - len(missing)) as advance:
            for future in as_completed(futures):
                try:
                    row = _result(future, study, *futures[future])
                except SweepError:
                    _keep_finished(journal, futures, study)
                    raise
                journal.append(row)
                advance()
        return journal.write_table()


def _keep_finished(journal: Journal, futures: Mapping[Future[dict[str, Cell]], tuple[int, int]], study: Study) -> None:
    """Append what else has finished by now: futures that end together are met in any order."""
    for future, (case, trial) in futures.items():
        finished = future.done() and not future.cancelled() and future.exception() is None
        if finished and (study.cases[case].name, trial) not in journal.done:
            journal.append(future.result())


def _result(future: Future[dict[str, Cell]], study: Study, case: int, trial: int) -> dict[str, Cell]:
    """Return a finished trial, or say in one line why there is none."""
    again = "finished rows are kept, run the same command to resume"
    try:
        failure = future.exception()
    except CancelledError:
        raise SweepError(f"the cluster dropped the trials; {again}") from None
    if failure is None:
        return future.result()
    shown = f"{type(failure).__name__}: {' '.join(str(failure).split())}"
    if isinstance(failure, BrokenProcessPool):
        raise SweepError(f"a worker process died; {again}") from None
    if isinstance(failure, ModuleNotFoundError):
        raise SweepError(f"a worker lacks the package ({shown}); {again}") from None
    where = f"study {study.name}, case {study.cases[case].name}, trial {trial}"
    raise SweepError(f"{where} failed ({shown}); {again}") from failure
