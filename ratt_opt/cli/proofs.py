"""``ratt-opt verify`` and ``ratt-opt audit``: is a certificate's claim proved, and is the paper's proof?"""

from dataclasses import asdict
from pathlib import Path
from typing import Annotated

import typer

from ratt_opt.certificates.verifier.limits import DEFAULT as LIMITS
from ratt_opt.certificates.verifier.limits import SECONDS
from ratt_opt.cli.exit_codes import ExitCode
from ratt_opt.cli.options import JsonFlag, LatexFlag, Objective, OutFolder, check_output
from ratt_opt.cli.terminal import WorkInterrupted, print_json, print_lines, print_tables, written
from ratt_opt.errors import InputError
from ratt_opt.running.progress import Step

__all__ = ["audit", "verify"]

SUMMARY = ("complete", "quick", "counts", "seconds")
"""Fields that ``audit --json`` repeats of ``audit.json``."""


def verify(
    file: Annotated[Path, typer.Argument(help="Certificate file.", show_default=False)],
    problem: Annotated[
        Path | None, typer.Option("--problem", help="Scenario or information file the certificate must be about.")
    ] = None,
    objective: Annotated[Objective, typer.Option("--objective", help="Criterion, with --problem.")] = "trace",
    motion: Annotated[
        str | None,
        typer.Option("--motion", help="Of the targets, as given to bound; with --problem.", show_default=False),
    ] = None,
    time_limit: Annotated[float, typer.Option("--time-limit", help="Seconds before it counts as undecided.")] = SECONDS,
    limits: Annotated[
        Path | None,
        typer.Option("--limits", help="TOML file of other limits of the work on one file.", show_default=False),
    ] = None,
    verified: Annotated[
        bool, typer.Option("--verified", help="Ask ratt-check too, the checker extracted from its Coq proof.")
    ] = False,
    explain: Annotated[bool, typer.Option("--explain", help="Tell the proofs of both ends in words, too.")] = False,
    as_json: JsonFlag = False,
) -> int:
    """Check a certificate without trusting what wrote it, and say what it proves.

    With --verified an end counts as proved if ratt-check says so too; that program is looked for on the search path,
    or where RATT_CHECK says.

    Exit 0: both ends are proved; 1: the first fault is named; 2: the file is no certificate; 3: only the upper end is
    proved; 4: neither proved nor refuted within the limits. None of these if the output cannot be written (74).
    """
    from ratt_opt._params import read_params
    from ratt_opt.certificates.verifier.edge_cuts import CUTS_FORMAT, verify_cuts
    from ratt_opt.certificates.verifier.limits import within
    from ratt_opt.certificates.verifier.reading import load
    from ratt_opt.certificates.verifier.verify import verify_document
    from ratt_opt.certificates.verifier.work import watched

    checker, allowed = None, None if limits is None else read_params(limits, LIMITS, "limits")
    if verified:
        from ratt_opt.certificates.extracted import check_extracted, find_checker

        checker = find_checker()
    given = expected = None
    if problem is not None:
        from ratt_opt.certificates.agreement import differences
        from ratt_opt.scenario.files import load_input

        given = load_input(problem)
        if motion is not None:
            from ratt_opt.missions.first_step import first_step
            from ratt_opt.missions.world import MissionModel

            given = first_step(given, MissionModel(motion=motion, objective=objective))
        expected = differences(given, objective)
    with Step("checking the certificate") as step, watched(step.say), within(allowed):
        document = load(file)
        if document["format"] == CUTS_FORMAT:
            if problem is not None or verified or explain:
                raise InputError("file", "must be no certificate of cuts with --problem, --verified or --explain", file)
            proved = verify_cuts(document, time_limit=time_limit)
            if as_json:
                print_json({"format": "ratt-opt cut verification", "version": 1, **asdict(proved)})
            else:
                print_lines(proved.lines())
            return 0
        found = verify_document(document, expected_problem=expected, time_limit=time_limit)
        second = None if checker is None else check_extracted(file, program=checker, time_limit=time_limit)
    story = []
    if explain:
        from ratt_opt.certificates.explanation import explained

        story = explained(document)
    if as_json:
        about = {} if given is None else {"given": given.digest}
        checked = {} if second is None else {"verified": asdict(second)}
        told = {"explanation": story} if explain else {}
        print_json({"format": "ratt-opt verification", "version": 1, **asdict(found), **about, **checked, **told})
    else:
        about_given = [] if given is None else [_about(given.digest, found.made_from)]
        checked_lines = [] if second is None else [f"ratt-check, whose proof is checked: {second.text}"]
        print_lines([*found.lines(), *about_given, *checked_lines, *story])
    return 0 if found.lower_proved and (second is None or second.lower_proved) else ExitCode.UPPER_ONLY


def _about(given: str, made_from: str | None) -> str:
    """Say of a file which problem it holds: that of the certificate, made from it or from another one."""
    if given == made_from:
        return "the given file: the very input that it was made from"
    return f"the given file: the same problem, its matrices up to rounding (the input's SHA-256 {given})"


def audit(
    out: OutFolder,
    quick: Annotated[bool, typer.Option("--quick", help="Only the sizes that take seconds.")] = False,
    search_whole: Annotated[
        bool,
        typer.Option(
            "--search-whole", help="Search whole instances anew (ten minutes) instead of re-checking known ones."
        ),
    ] = False,
    as_json: JsonFlag = False,
    as_latex: LatexFlag = False,
) -> None:
    """Decide the paper's proof line by line; write audit.json, audit.html and audit.md.

    An interrupt (Ctrl-C) writes what is decided so far, marked incomplete, and exits with 130.
    """
    from ratt_audit.ledger import FILES, run_audit
    from ratt_opt.report.tables import audit_table

    check_output(as_json=as_json, as_latex=as_latex)
    ledger = run_audit(out, quick=quick, search_whole=search_whole)
    files = [str(out / name) for name in FILES]
    if as_json:
        kept = {name: value for name, value in ledger.document().items() if name in SUMMARY}
        head = {"format": "ratt-opt audit summary", "version": 1}
        print_json({**head, **kept, "entries": len(ledger.records), "files": files})
    else:
        found = (f"{part.heading} {' '.join(part.sentences)}" for part in ledger.findings() if part.sentences)
        print_tables([audit_table(ledger.per_chain())], [*found, written(files)], latex=as_latex)
    if not ledger.complete:
        raise WorkInterrupted(f"interrupted after {len(ledger.records)} entries, which were written")
