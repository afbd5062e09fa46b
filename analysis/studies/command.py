"""The command line that all studies share."""

from __future__ import annotations

import argparse
import sys
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING

from analysis.studies.engine import SweepError, run
from analysis.studies.executors import open_executor
from analysis.studies.progress import Progress
from analysis.studies.store import read_table
from ratt_opt.errors import InputError, printable

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from analysis.studies.study import Study

    Draw = Callable[[list[dict[str, str]], Path], object]

__all__ = ["Entry", "main"]


@dataclass(frozen=True, slots=True)
class Entry:
    """A study and what to make of its rows: ``draw(rows, folder)`` writes figures into ``folder``, if anything."""

    study: Study
    draw: Draw | None = None


def main(
    description: str, entries: Sequence[Entry], *, trials: int, after: Callable[[Path], object] | None = None
) -> int:
    """Run studies from the command line and return the exit code.

    2 for bad input, 1 for a lost sweep or where the system refuses, 130 interrupted.
    ``after(out)`` runs when all results are there.
    """
    options = _parse(description, entries, trials)
    chosen = [entry for entry in entries if not options.only or entry.study.name in options.only]
    try:
        with open_executor(options.cluster, options.workers) as executor:
            for entry in chosen:
                study = replace(entry.study, seed=options.seed)
                folder = options.out / study.name
                trials_wanted = study.fixed_trials or options.trials
                old = options.accept_old_rows
                run(study, folder, executor, trials=trials_wanted, progress=Progress(), accept_old_rows=old)
                if entry.draw is not None:
                    entry.draw(read_table(folder), folder)
        if after is not None and len(chosen) == len(entries):
            after(options.out)
    except InputError as error:
        return _say(error, 2)
    except SweepError as error:
        return _say(error, 1)
    except OSError as error:  # no processes, no room, no folder to be in
        return _say(f"the system refuses: {error}; finished rows are kept", 1)
    except KeyboardInterrupt:
        return _say("interrupted; finished rows are kept, run the same command to resume", 130)
    return 0


def _parse(description: str, entries: Sequence[Entry], trials: int) -> argparse.Namespace:
    names = [entry.study.name for entry in entries]
    parser = argparse.ArgumentParser(description=description)
    parser.add_argument("--trials", type=_positive, default=trials, help="trials of every case (default %(default)s)")
    parser.add_argument("--out", type=Path, required=True, help="folder of the results; run again to resume")
    parser.add_argument("--only", nargs="+", choices=names, help="run these studies only")
    parser.add_argument("--workers", type=_positive, help="local processes (default: one per core)")
    parser.add_argument(
        "--accept-old-rows", action="store_true", help="keep rows that other code made; each says which in 'versions'"
    )
    parser.add_argument("--cluster", metavar="ADDRESS", help="address of a Dask scheduler to use instead")
    parser.add_argument(
        "--seed", type=_not_negative, default=entries[0].study.seed, help="root seed (default %(default)s)"
    )
    return parser.parse_args()


def _positive(text: str) -> int:
    return _whole(text, low=1)


def _not_negative(text: str) -> int:
    return _whole(text, low=0)


def _whole(text: str, *, low: int) -> int:
    if not text.isdecimal() or int(text) < low:
        raise argparse.ArgumentTypeError(f"must be an integer >= {low}; got {text}")
    return int(text)


def _say(message: object, code: int) -> int:
    print(f"error: {printable(str(message))}", file=sys.stderr)
    return code
