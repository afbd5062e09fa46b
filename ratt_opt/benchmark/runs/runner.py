"""A solver on a whole library: a study with one case for each instance, so it resumes and runs on a cluster."""

from __future__ import annotations

import json
import re
from pathlib import Path
from typing import TYPE_CHECKING

from ratt_opt._validation import check_number
from ratt_opt.benchmark.instances.forms import NetworkInput
from ratt_opt.benchmark.runs.solvers import find_solver
from ratt_opt.benchmark.runs.trial import BenchTrial, command_words
from ratt_opt.errors import FileFormatError, InputError
from ratt_opt.studies.cases import Case
from ratt_opt.studies.engine import run
from ratt_opt.studies.store import TABLE, read_table
from ratt_opt.studies.study import Study

if TYPE_CHECKING:
    from collections.abc import Sequence
    from concurrent.futures import Executor

    from ratt_opt.benchmark.instances.instance import BenchmarkInstance
    from ratt_opt.benchmark.instances.library import BenchmarkLibrary
    from ratt_opt.studies.progress import Progress

__all__ = ["SolverRows", "read_rows", "run_benchmark", "track_of"]

TRACK_OF = {"planner": "plan", "attacker": "attack", "cuts": "cuts"}


def track_of(command: str) -> str | None:
    """The track of a solver of this library, or ``None`` for a command, which may know all."""
    return TRACK_OF.get(command.partition(":")[0])


def run_benchmark(
    library: BenchmarkLibrary,
    command: str,
    out: str | Path,
    *,
    name: str | None = None,
    seconds: float = 10.0,
    grace: float = 2.0,
    only: Sequence[str] = (),
    curated: bool = False,
    executor: Executor | None = None,
    workers: int | None = 1,
    progress: Progress | None = None,
    accept_old_rows: bool = False,
) -> SolverRows:
    """Run a solver on the instances of a library and keep one row for each in ``out/name``; run again to resume.

    Parameters
    ----------
    command : words with ``{instance}``, ``{out}`` and ``{s}``, or ``planner:NAME``, ``attacker:NAME``, ``cuts:NAME``
    name : of the solver in tables; by default made of the command
    seconds, grace : limit of one run, and when it is killed after that [s]
    only : first letters of names or classes; ``curated`` : the few of a first look
    executor, workers, progress, accept_old_rows : as for :func:`ratt_opt.studies.run`

    Raises
    ------
    InputError : an argument breaks its rule, no instance is chosen, or ``out`` holds other rows.
    SweepError : workers were lost; the rows so far are kept.
    """
    check_number("seconds", seconds, low=0.01)
    check_number("grace", grace, low=0.0)
    command_words(command, Path("i"), Path("o"), seconds)
    track = track_of(command)
    if track is not None:
        kind, _, solver = command.partition(":")
        find_solver(kind, solver)
    called = _slug(command) if name is None else name
    if _slug(called) != called:
        raise InputError("name", "must be letters, digits, '.', '_' and '-'", called)
    cases = tuple(_case(library.instance(one)) for one in library.chosen(only, curated=curated))
    cases = tuple(case for case in cases if track is None or dict(case.options)["track"] == track)
    if not cases:
        raise InputError("--only", "must leave an instance that the solver is for", ", ".join(only) or command)
    trial = BenchTrial(command, str(library.folder.resolve()), seconds, grace)
    study = Study(name=called, cases=cases, measure=trial, fixed_trials=1)
    folder = Path(out) / called
    run(study, folder, executor, workers=workers, progress=progress, accept_old_rows=accept_old_rows)
    return read_rows(Path(out))[called]


SolverRows = list[dict[str, str]]
"""Rows of one solver: column -> cell."""


def read_rows(out: Path) -> dict[str, SolverRows]:
    """Rows of all solvers in a folder of results, by solver.

    Raises
    ------
    FileFormatError : there are none.
    """
    found = {file.parent.name: read_table(file.parent) for file in sorted(out.glob(f"*/{TABLE}"))}
    found = {solver: rows for solver, rows in found.items() if rows and "integral" in rows[0]}
    if not found:
        raise FileFormatError(str(out), f"must hold results of ratt-opt bench run (NAME/{TABLE})", "none")
    for solver, rows in found.items():
        for row in rows:
            try:
                json.loads(row["steps"])
            except ValueError:
                raise FileFormatError(f"{out / solver / TABLE}: steps", "must be JSON", row["steps"][:80]) from None
    return found


def _case(instance: BenchmarkInstance) -> Case:
    robots, elements = instance.sizes
    options = (("instance", instance.name), ("track", instance.track))
    if isinstance(instance.problem, NetworkInput):
        return Case(n_robots=robots, n_targets=0, alpha_s=0, alpha_c=0, objective="cuts", options=options)
    return Case(
        n_robots=robots,
        n_targets=elements,
        alpha_s=instance.problem.alpha_s,
        alpha_c=instance.problem.alpha_c,
        objective=instance.objective,
        options=options,
    )


def _slug(command: str) -> str:
    words = re.sub(r"\{\w+\}|--time", " ", command.removeprefix("planner:"))
    return re.sub(r"[^A-Za-z0-9._-]+", "-", words).strip("-.")[:60] or "solver"
