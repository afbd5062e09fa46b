"""The command line ``ratt-opt``: parse, call, print.

Exit codes: 0 done; 1 a certificate does not prove its claim; 2 bad input, one line on
standard error; 130 interrupted. Results go to standard output, progress to standard error.
"""

from __future__ import annotations

import json
import math
import re
import sys
from contextlib import contextmanager
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal

import typer

from ratt_opt import __version__
from ratt_opt.errors import FileFormatError, InputError, ProofError

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from rich.console import Console

    from ratt_opt.main_job import BoundReport
    from ratt_opt.scenario.model import Scenario
    from ratt_opt.scenario.model_free import InformationInput

__all__ = ["app", "main", "run"]

Objective = Literal["trace", "logdet", "maxeig"]

app = typer.Typer(
    name="ratt-opt",
    help="Plan robot teams that keep tracking targets under attack, and prove how good each plan is.",
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
    rich_markup_mode=None,
)

# Typer's own usage errors (unknown option, missing value, ...) share this base; typer does not export it.
_UsageError: Any = typer.BadParameter.__mro__[1]
DEMO_SEED = 14
"""A scenario on which the planners differ; on many others RATT and greedy find the same plan."""

OutFolder = Annotated[Path, typer.Option("--out", help="Folder for the results; created if absent.")]
JsonFlag = Annotated[bool, typer.Option("--json", help="Print JSON instead of tables.")]
TimeLimit = Annotated[
    float, typer.Option("--time-limit", help="Seconds for all searches; the certificate comes on top.")
]
Gap = Annotated[float, typer.Option("--gap", help="Relative gap at which that search stops.")]
CertificateFlag = Annotated[
    bool, typer.Option(help="Write certificate.json, and verify it before anything is printed.")
]
ObjectiveOption = Annotated[Objective, typer.Option("--objective", help="Criterion of the tracking quality.")]


@app.callback(invoke_without_command=True)
def _version(version: Annotated[bool, typer.Option("--version", help="Print the version and exit.")] = False) -> None:
    if version:
        print(__version__)
        raise typer.Exit


@app.command()
def demo(out: OutFolder = Path("demo"), certificate: CertificateFlag = True, as_json: JsonFlag = False) -> None:
    """Plan, attack and bound the paper's small scenario (4 robots, 4 targets), end to end."""
    from ratt_opt._files import output_directory
    from ratt_opt.scenario.files import save_scenario
    from ratt_opt.scenario.generator import random_scenario

    scenario = random_scenario(4, 4, alpha_s=1, alpha_c=3, seed=DEMO_SEED)
    save_scenario(scenario, output_directory(out) / "scenario.json")
    _bound(scenario, out, "trace", 60.0, 1e-9, certificate=certificate, as_json=as_json)


@app.command()
def new(
    out: Annotated[Path, typer.Option("--out", help="Scenario file to write.")],
    sensing_attacks: Annotated[int, typer.Option("--sensing-attacks", help="Robots that may be blinded.")],
    link_attacks: Annotated[int, typer.Option("--link-attacks", help="Links that may be cut.")],
    robots: Annotated[int | None, typer.Option("--robots", help="Number of robots of a random scenario.")] = None,
    targets: Annotated[int | None, typer.Option("--targets", help="Number of targets of a random scenario.")] = None,
    seed: Annotated[int | None, typer.Option("--seed", help="Seed of a random scenario.")] = None,
    communication_range: Annotated[
        float | None, typer.Option("--range", help="Link robots within this distance [m]; all where absent.")
    ] = None,
    mrclam: Annotated[Path | None, typer.Option("--mrclam", help="Folder of the MRCLAM dataset.")] = None,
    time: Annotated[
        float | None, typer.Option("--time", help="Instant of the dataset: seconds since its start, or Unix time.")
    ] = None,
    label_correction: Annotated[
        bool, typer.Option(help="Exchange the labels 11 and 17, as dataset 1 needs and its sightings confirm.")
    ] = True,
) -> None:
    """Write a scenario file: random (--robots, --targets, --seed) or from real robots (--mrclam, --time)."""
    from ratt_opt.scenario.files import save_scenario

    if mrclam is None:
        _refuse(given={"time": time}, wants="--mrclam")
        numbers = {"robots": robots, "targets": targets, "seed": seed}
        scenario = _random(numbers, sensing_attacks, link_attacks, communication_range)
    else:
        _refuse(given={"robots": robots, "targets": targets, "seed": seed}, wants="no --mrclam")
        scenario = _from_mrclam(mrclam, time, sensing_attacks, link_attacks, label_correction)
        if communication_range is not None:
            scenario = scenario.replace(communication_range=communication_range)
    save_scenario(scenario, out)
    print(f"{out}: {scenario.n_robots} robots, {scenario.n_targets} targets")
    for note in scenario.notes:
        print(f"  {note}")


@app.command()
def bound(
    file: Annotated[Path, typer.Argument(help="Scenario or information file.", show_default=False)],
    out: OutFolder,
    objective: ObjectiveOption = "trace",
    time_limit: TimeLimit = 60.0,
    gap: Gap = 1e-9,
    certificate: CertificateFlag = True,
    as_json: JsonFlag = False,
) -> None:
    """Plan, find the worst attack, bracket the best plan; write report.json, plan.png, plan.svg, certificate.json."""
    from ratt_opt.scenario.files import load_input

    _bound(load_input(file), out, objective, time_limit, gap, certificate=certificate, as_json=as_json)


@app.command()
def attack(
    file: Annotated[Path, typer.Argument(help="Scenario or information file.", show_default=False)],
    plan: Annotated[Path, typer.Option("--plan", help='JSON: {"elements": [...]} or {"controls": [...]}.')],
    objective: ObjectiveOption = "trace",
    time_limit: Annotated[float, typer.Option("--time-limit", help="Seconds for the exact attack.")] = 60.0,
    seed: Annotated[int, typer.Option("--seed", help="Seed of the random attack.")] = 0,
    rank: Annotated[
        int, typer.Option("--rank", min=0, help="Also rank so many robots and links by what protecting them gains.")
    ] = 0,
    below: Annotated[
        float | None,
        typer.Option("--below", help="Also find the smallest budgets that push the plan below this value."),
    ] = None,
    as_json: JsonFlag = False,
) -> None:
    """Find the exact worst case, and the heuristics' attacks, against your own plan, and what to protect."""
    from ratt_opt.attackers.breaking_budgets import breaking_budgets
    from ratt_opt.attackers.criticality import criticality_ranking
    from ratt_opt.attackers.survey import attack_survey
    from ratt_opt.report.document import attack_document
    from ratt_opt.report.tables import attack_table, budget_table, critical_table
    from ratt_opt.scenario.files import load_input
    from ratt_opt.scenario.plan_file import load_plan

    if below is not None and not math.isfinite(below):
        raise InputError("--below", "must be a finite number", below)
    problem = load_input(file).problem(objective)
    elements = load_plan(plan, problem)
    with _progress() as tell:
        tell("attacking")
        results = attack_survey(problem, elements, time_limit=time_limit, seed=seed)
        if rank or below is not None:
            tell("what to protect")
        critical = criticality_ranking(problem, elements, time_limit=time_limit)[:rank] if rank else ()
        budgets = None if below is None else breaking_budgets(problem, elements, below, time_limit=time_limit)
    if as_json:
        document = attack_document(objective, elements, results, critical, budgets)
        print(json.dumps(document, indent=1, allow_nan=False))
        return
    _console().print(attack_table(results))
    if rank:
        _console().print(critical_table(critical))
    if budgets is not None:
        _console().print(budget_table(budgets, f"{below:.8g}"))


@app.command()
def verify(
    file: Annotated[Path, typer.Argument(help="Certificate file.", show_default=False)],
    problem: Annotated[
        Path | None, typer.Option("--problem", help="Scenario or information file the certificate must be about.")
    ] = None,
    objective: Annotated[Objective, typer.Option("--objective", help="Criterion, with --problem.")] = "trace",
    as_json: JsonFlag = False,
) -> None:
    """Check a certificate without trusting what wrote it; exit 0 and say what it proves, or 1 and the first fault."""
    from ratt_opt.certificates.verifier.verify import verify_certificate

    expected = None if problem is None else _problem_record(problem, objective)
    try:
        verified = verify_certificate(file, expected_problem=expected)
    except FileFormatError as error:
        raise ProofError(str(error)) from None
    if as_json:
        print(json.dumps(asdict(verified), indent=1, allow_nan=False))
    else:
        print("\n".join(verified.lines()))


@app.command()
def audit(
    out: OutFolder,
    quick: Annotated[bool, typer.Option("--quick", help="Only the sizes that take seconds.")] = False,
    as_json: JsonFlag = False,
) -> int:
    """Decide the paper's proof line by line; write audit.json, audit.html and audit.md.

    An interrupt (Ctrl-C) writes what is decided so far, marked incomplete, and exits with 130.
    """
    from ratt_opt.audit.ledger import run_audit
    from ratt_opt.report.tables import audit_table

    with _progress() as tell:
        ledger = run_audit(out, quick=quick, progress=lambda done, total, name: tell(f"{done + 1}/{total} {name}"))
    if as_json:
        print(json.dumps({**ledger.document(), "entries": len(ledger.records)}, indent=1, allow_nan=False))
    else:
        _console().print(audit_table(ledger.per_chain()))
        print(
            "\n".join(f"{found.heading} {' '.join(found.sentences)}" for found in ledger.findings() if found.sentences)
        )
        print("written: " + ", ".join(str(out / name) for name in ("audit.json", "audit.html", "audit.md")))
    return 0 if ledger.complete else _fail(f"interrupted after {len(ledger.records)} entries, which were written", 130)


@app.command()
def schema(
    kind: Annotated[Literal["scenario", "information"], typer.Argument(help="Which input file.")] = "scenario",
) -> None:
    """Print the JSON Schema of an input file."""
    from ratt_opt.scenario.files import scenario_schema

    print(json.dumps(scenario_schema(kind), indent=1))


def main() -> None:
    """Run the command line and exit."""
    sys.exit(run(sys.argv[1:]))


def run(arguments: list[str]) -> int:
    """Run one command line and return its exit code; every error is one line on standard error."""
    try:
        code = app(arguments, standalone_mode=False)
        sys.stdout.flush()
    except (InputError, _UsageError) as error:
        return _fail(str(error) if isinstance(error, InputError) else _usage_text(error, arguments), 2)
    except ProofError as error:
        return _fail(str(error), 1)
    except (KeyboardInterrupt, typer.Abort):
        return _fail("interrupted", 130)
    except BrokenPipeError:
        sys.stdout = None  # the reader has left; the interpreter must not flush again
        return 0
    return code if isinstance(code, int) else 0


def _usage_text(error: Any, arguments: list[str]) -> str:
    """Typer's message, with the value it refused where it does not show it."""
    text = str(error.format_message()).rstrip(".")
    option = re.search(r"Invalid value for '(--[\w-]+)'", text)
    if option and option[1] in arguments[:-1]:
        value = arguments[arguments.index(option[1]) + 1]
        return text if value in text else f"{text}; got {value}"
    return text


def _fail(text: str, code: int) -> int:
    print(f"error: {' '.join(text.split())}", file=sys.stderr)
    return code


def _problem_record(file: Path, objective: str) -> dict[str, Any]:
    from ratt_opt.certificates.write import problem_document
    from ratt_opt.scenario.files import load_input

    return problem_document(load_input(file).problem(objective))


def _bound(
    source: Scenario | InformationInput,
    out: Path,
    objective: str,
    time_limit: float,
    gap: float,
    *,
    certificate: bool,
    as_json: bool,
) -> None:
    from ratt_opt._files import output_directory
    from ratt_opt.main_job import bound as main_job
    from ratt_opt.report.document import report_document
    from ratt_opt.report.write import write_report

    proof = output_directory(out) / "certificate.json"
    path = proof if certificate else None
    with _progress() as tell:
        report = main_job(source, objective=objective, time_limit=time_limit, gap=gap, certificate=path, progress=tell)
        tell("report and figure")
        files = write_report(report, out, source)
    if report.certificate.certificate is None:
        proof.unlink(missing_ok=True)  # an earlier run's: it is not about this report
    else:
        files.append(report.certificate.certificate.path)
    if as_json:
        print(json.dumps(report_document(report), indent=1, allow_nan=False))
        return
    _print_report(report, source)
    print("written: " + ", ".join(str(file) for file in files))


def _print_report(report: BoundReport, source: Scenario | InformationInput) -> None:
    from ratt_opt.report.tables import report_tables

    console = _console()
    for table in report_tables(report, source.element_labels):
        console.print(table)


def _random(
    numbers: dict[str, int | None], sensing_attacks: int, link_attacks: int, communication_range: float | None
) -> Scenario:
    from ratt_opt.scenario.generator import random_scenario

    for name, value in numbers.items():
        if value is None:
            raise InputError(f"--{name}", "must be given for a random scenario (or give --mrclam)", "nothing")
    robots, targets, seed = (int(value) for value in numbers.values() if value is not None)
    return random_scenario(
        robots,
        targets,
        alpha_s=sensing_attacks,
        alpha_c=link_attacks,
        seed=seed,
        communication_range=communication_range,
    )


def _from_mrclam(
    folder: Path, time: float | None, sensing_attacks: int, link_attacks: int, label_correction: bool
) -> Scenario:
    from ratt_opt.scenario.mrclam import from_mrclam
    from ratt_opt.scenario.mrclam_reader import DATASET_1_CORRECTIONS

    if time is None:
        raise InputError("--time", "must be given with --mrclam", "nothing")
    corrections = DATASET_1_CORRECTIONS if label_correction else {}
    return from_mrclam(folder, time, alpha_s=sensing_attacks, alpha_c=link_attacks, corrections=corrections)


def _refuse(given: dict[str, Any], wants: str) -> None:
    for name, value in given.items():
        if value is not None:
            raise InputError(f"--{name}", f"must come with {wants}", value)


def _console() -> Console:
    """Standard output; piped, it is plain text as wide as its content needs."""
    from rich.console import Console

    return Console(soft_wrap=False) if sys.stdout.isatty() else Console(width=160, no_color=True)


@contextmanager
def _progress() -> Iterator[Callable[[str], None]]:
    """A spinner with the current line on a terminal, plain lines elsewhere; both on standard error."""
    from rich.console import Console

    if not sys.stderr.isatty():
        yield lambda text: print(text, file=sys.stderr, flush=True)
        return
    with Console(stderr=True).status("") as status:
        yield lambda text: status.update(text.strip())
