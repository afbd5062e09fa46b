"""``ratt-opt bench``: run solvers on the open benchmark, verify its records, enter new ones, write the page."""

from pathlib import Path
from typing import Annotated

import typer

from ratt_opt.cli.exit_codes import ExitCode
from ratt_opt.cli.options import JsonFlag, OutFolder
from ratt_opt.cli.terminal import WorkInterrupted, fail, print_json, print_lines, written
from ratt_opt.errors import ProofError, UndecidedError

__all__ = ["list_instances", "page", "run", "submit", "verify"]

LibraryFolder = Annotated[
    str, typer.Argument(help="Folder of the library, or the name of a published one.", show_default=False)
]
Only = Annotated[list[str] | None, typer.Option("--only", help="First letters of a name or a class; may be repeated.")]
Curated = Annotated[bool, typer.Option("--curated", help="Only the ten of a first look.")]


def run(
    library: LibraryFolder,
    out: OutFolder,
    solver: Annotated[
        str,
        typer.Option("--solver", help='"CMD {instance} {out} --time {s}", planner:NAME, attacker:NAME or cuts:NAME.'),
    ],
    name: Annotated[str | None, typer.Option("--name", help="Of the solver in tables; made of --solver.")] = None,
    seconds: Annotated[float, typer.Option("--time", help="Seconds for each instance.")] = 10.0,
    grace: Annotated[float, typer.Option("--grace", help="Seconds after these until it is killed.")] = 2.0,
    only: Only = None,
    curated: Curated = False,
    workers: Annotated[int, typer.Option("--workers", min=1, help="Instances at a time.")] = 1,
    cluster: Annotated[str | None, typer.Option("--cluster", help="Address of a Dask scheduler.")] = None,
    accept_old_rows: Annotated[bool, typer.Option("--accept-old-rows", help="Keep rows that other code made.")] = False,
    as_json: JsonFlag = False,
) -> int:
    """Run a solver on the instances of a library; every answer is valued again, every bound needs its certificate.

    The solver prints JSON lines {"elements", "lower", "upper"}; of attacks {"sensing", "links", ...}, of cuts
    {"cut", ...}; and {"certificate": "FILE"} for a file in {out}. The same command goes on where it stopped.

    Exit 1: workers were lost; the rows so far are kept.
    """
    from contextlib import nullcontext
    from dataclasses import asdict

    from ratt_opt.benchmark.instances.library import BenchmarkLibrary
    from ratt_opt.benchmark.runs.page import summaries
    from ratt_opt.benchmark.runs.runner import run_benchmark
    from ratt_opt.studies.engine import SweepError
    from ratt_opt.studies.executors import open_executor

    loaded = BenchmarkLibrary.load(_folder(library))
    try:
        with open_executor(cluster, workers) if cluster or workers > 1 else nullcontext() as executor:
            rows = run_benchmark(
                loaded,
                solver,
                out,
                name=name,
                seconds=seconds,
                grace=grace,
                only=only or (),
                curated=curated,
                executor=executor,
                accept_old_rows=accept_old_rows,
            )
    except SweepError as error:
        return fail(str(error), ExitCode.REFUTED)
    except KeyboardInterrupt:
        raise WorkInterrupted("interrupted; finished rows are kept, run the same command to resume") from None
    (found,) = summaries({name or solver: rows})
    if as_json:
        print_json({"format": "ratt-opt bench run", "version": 1, **asdict(found), "rows": rows})
        return 0
    print_lines(
        [
            f"{found.instances} instances: {found.best} with the best known value, {found.close} within 1 %, "
            f"{found.proved} proved optimal, {found.faulty} with faults",
            f"mean gap {100 * found.gap:.2f} %, gap integral {100 * found.integral:.2f} %, PAR10 {found.par10:.3g} s",
            *(f"{row['instance']}: {row['faults']}" for row in rows if row["faults"]),
        ]
    )
    return 0


def verify(
    library: LibraryFolder,
    sample: Annotated[
        int | None, typer.Option("--sample", min=1, help="Number of lines, drawn; all by default.")
    ] = None,
    seed: Annotated[int, typer.Option("--seed", help="Of the sample.")] = 0,
    time_limit: Annotated[float, typer.Option("--time-limit", help="Seconds for each certificate and value.")] = 300.0,
    as_json: JsonFlag = False,
) -> None:
    """Verify the table of records: every answer valued again, every bound by its certificate, every hash.

    Exit 0: all hold; 1: the first fault is named; 4: a line was not decided in its time.
    """
    from dataclasses import asdict

    from ratt_opt.benchmark.instances.library import BenchmarkLibrary
    from ratt_opt.benchmark.proofs.records import verify_benchmark
    from ratt_opt.running.progress import Step

    loaded = BenchmarkLibrary.load(_folder(library))
    with Step("verifying records"):
        found = verify_benchmark(loaded, sample=sample, seed=seed, seconds=time_limit)
    wrong = [line for line in found if line.fault]
    if as_json:
        lines = [asdict(line) | {"bound": line.bound if abs(line.bound) < float("inf") else None} for line in found]
        print_json({"format": "ratt-opt bench verification", "version": 1, "lines": lines})
    elif not wrong:
        closed = sum(loaded.best[line.instance].is_closed for line in found)
        print_lines([f"{len(found)} records hold, {closed} of them closed, of {len(loaded.entries)} instances"])
    if refuted := [line for line in wrong if not line.undecided]:
        first = refuted[0]
        raise ProofError(f"{len(refuted)} of {len(found)} records do not hold; {first.instance}: {first.fault}")
    if wrong:
        first = wrong[0]
        raise UndecidedError(f"{len(wrong)} of {len(found)} records undecided; {first.instance}: {first.fault}")


def submit(
    library: LibraryFolder,
    file: Annotated[Path, typer.Argument(help="Record file.", show_default=False)],
    who: Annotated[str, typer.Option("--who", help="Who found it, for the table.")],
) -> None:
    """Enter a record, if it verifies and betters the known one."""
    from ratt_opt.benchmark.instances.library import BenchmarkLibrary
    from ratt_opt.benchmark.proofs.records import read_record, submit_record

    _, row = submit_record(BenchmarkLibrary.load(_folder(library)), read_record(file), who=who)
    print_lines([f"{row.instance}: value {row.value:.12g}, bound {row.bound:.12g}, entered"])


def page(
    out: Annotated[Path, typer.Argument(help="Folder of results, as bench run --out.", show_default=False)],
) -> None:
    """Write one page of all solvers in a folder of results: tables, profiles, gaps over time, faults."""
    from ratt_opt.benchmark.runs.page import write_page

    print_lines([written(write_page(out))])


def list_instances(
    library: LibraryFolder, only: Only = None, curated: Curated = False, as_json: JsonFlag = False
) -> None:
    """List the instances of a library with what is known of them."""
    from dataclasses import asdict

    from ratt_opt.benchmark.instances.library import BenchmarkLibrary

    loaded = BenchmarkLibrary.load(_folder(library))
    lines = []
    for name in loaded.chosen(only or (), curated=curated):
        best = loaded.best.get(name)
        known = {} if best is None else {"value": best.value, "bound": best.bound if abs(best.bound) < 1e300 else None}
        lines.append({**asdict(loaded.entries[name]), **known})
    if as_json:
        print_json({"format": "ratt-opt bench list", "version": 1, "instances": lines})
        return
    shown = [f"{'name':34} {'class':5} {'robots':>6} {'hardness':8} {'value':>14} {'bound':>14}"]
    for line in lines:
        ends = (f"{line[end]:>14.9g}" if line.get(end) is not None else f"{'none':>14}" for end in ("value", "bound"))
        shown.append(f"{line['name']:34} {line['code']:5} {line['robots']:>6} {line['hardness']:8} {' '.join(ends)}")
    print_lines(shown)


def _folder(library: str) -> Path:
    from ratt_opt.benchmark.instances.published import library_folder

    return library_folder(library)
