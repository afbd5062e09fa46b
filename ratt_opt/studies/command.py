"""The command line that all studies share."""

from __future__ import annotations

import argparse
import sys
from dataclasses import dataclass, replace
from pathlib import Path
from pkgutil import resolve_name
from typing import TYPE_CHECKING, Any, cast

from ratt_opt.errors import InputError, printable
from ratt_opt.studies.engine import SweepError, run
from ratt_opt.studies.executors import open_executor
from ratt_opt.studies.store import TABLE

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from rich.table import Table

    from ratt_opt.studies.results import Results
    from ratt_opt.studies.study import Study

    Draw = Callable[[list[dict[str, str]], Path], object]

__all__ = ["Entry", "main"]


@dataclass(frozen=True, slots=True)
class Entry:
    """A study and what to make of its rows: ``draw(rows, folder)`` writes figures into ``folder``.

    Without ``draw`` the means are printed as a table, and saved as ``means.csv``, ``means.tex`` and a figure.
    """

    study: Study
    draw: Draw | None = None


def main(
    description: str, entries: Sequence[Entry], *, trials: int, after: Callable[[Path], object] | None = None
) -> int:
    """Run studies from the command line and return the exit code.

    2 for bad input, 1 for a lost sweep or if the system refuses, 130 interrupted.
    ``after(out)`` runs when all results are there.
    """
    options = _parse(description, entries, trials)
    chosen = [entry for entry in entries if not options.only or entry.study.name in options.only]
    try:
        with open_executor(options.cluster, options.workers) as executor:
            for entry in chosen:
                study = _with_own(replace(entry.study, seed=options.seed), options)
                folder = options.out / study.name
                trials_wanted = study.fixed_trials or options.trials
                old = options.accept_old_rows
                results = run(study, folder, executor, trials=trials_wanted, accept_old_rows=old)
                _deliver(results, entry, folder, latex=options.latex)
        if after is not None:
            _finish(after, options.out, [entry.study.name for entry in entries])
    except InputError as error:
        return _say(error, 2)
    except SweepError as error:
        return _say(error, 1)
    except OSError as error:  # no processes, no room, no folder to be in
        return _say(f"the system refuses: {error}; finished rows are kept", 1)
    except KeyboardInterrupt:
        return _say("interrupted; finished rows are kept, run the same command to resume", 130)
    return 0


def _finish(after: Callable[[Path], object], out: Path, names: Sequence[str]) -> None:
    """Renew what is made of all studies, so that it speaks of the tables beside it; say what is missing for it."""
    missing = [name for name in names if not (out / name / TABLE).exists()]
    if not missing:
        after(out)
        return
    print(f"what is made of all studies waits for {', '.join(missing)}", file=sys.stderr)


def _deliver(results: Results, entry: Entry, folder: Path, *, latex: bool) -> None:
    """Make of the rows what the entry says; print the means if that is nothing, as LaTeX with ``--latex``."""
    if entry.draw is not None:
        entry.draw(list(results.rows), folder)
    else:
        results.save(folder)
    if latex:
        print(results.to_latex(caption=f"Study {results.study.name}"))
    elif entry.draw is None:
        from rich.console import Console

        width = None if sys.stdout.isatty() else 160
        Console(width=width, markup=False, emoji=False).print(means_table(results))


def means_table(results: Results) -> Table:
    """The means as a table for the terminal."""
    from rich import box
    from rich.table import Table

    header, rows = results.mean_rows()
    table = Table(title=f"study {results.study.name}", box=box.SIMPLE_HEAD, title_justify="left", title_style="bold")
    for name in header:
        table.add_column(name)
    for row in rows:
        table.add_row(*row)
    table.caption, table.caption_justify = results.note(), "left"
    return table


def _with_own(study: Study, options: argparse.Namespace) -> Study:
    """The study with the planners and attackers that the command line adds. InputError : one cannot be loaded."""
    if not (options.planner or options.attacker):
        return study
    for kind in ("planner", "attacker"):
        if getattr(options, kind) and not getattr(study, f"{kind}_names"):
            raise InputError(f"--{kind}", f"must come with --only and studies of {kind}s", study.name)
    added = {kind: {f.__name__: f for f in map(_loaded, getattr(options, kind))} for kind in ("planner", "attacker")}
    planners, attackers = study.named_planners | added["planner"], study.named_attackers | added["attacker"]
    return replace(study, planners=planners, attackers=attackers)


def _loaded(path: str) -> Callable[..., Any]:
    """The function ``module:function``."""
    try:
        found = resolve_name(path)
    except (ImportError, AttributeError, ValueError) as error:
        raise InputError(path, "must be module:function that can be imported from here", error) from None
    if not callable(found):
        raise InputError(path, "must name a function", type(found).__name__)
    return cast("Callable[..., Any]", found)


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
    for kind in ("planner", "attacker"):
        parser.add_argument(
            f"--{kind}",
            action="append",
            default=[],
            metavar="MODULE:FUNCTION",
            help=f"compare a {kind} of your own too",
        )
    parser.add_argument("--latex", action="store_true", help="print the means as LaTeX tables (booktabs)")
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
