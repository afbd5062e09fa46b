"""``ratt-opt verify`` and ``ratt-opt audit``: is a certificate's claim proved, and is the paper's proof?"""

from dataclasses import asdict
from pathlib import Path
from typing import Annotated

import typer

from ratt_opt.cli.options import JsonFlag, Objective, OutFolder
from ratt_opt.cli.terminal import fail, print_json, print_tables, progress
from ratt_opt.errors import FileFormatError, ProofError

__all__ = ["audit", "verify"]


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

    expected = None
    if problem is not None:
        from ratt_opt.certificates.write import problem_document
        from ratt_opt.scenario.files import load_input

        expected = problem_document(load_input(problem).problem(objective))
    try:
        verified = verify_certificate(file, expected_problem=expected)
    except FileFormatError as error:
        raise ProofError(str(error)) from None
    if as_json:
        print_json(asdict(verified))
    else:
        print("\n".join(verified.lines()))


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

    with progress() as tell:
        ledger = run_audit(out, quick=quick, progress=lambda done, total, name: tell(f"{done + 1}/{total} {name}"))
    if as_json:
        print_json({**ledger.document(), "entries": len(ledger.records)})
    else:
        print_tables([audit_table(ledger.per_chain())])
        for found in ledger.findings():
            if found.sentences:
                print(f"{found.heading} {' '.join(found.sentences)}")
        print("written: " + ", ".join(str(out / name) for name in ("audit.json", "audit.html", "audit.md")))
    return 0 if ledger.complete else fail(f"interrupted after {len(ledger.records)} entries, which were written", 130)
