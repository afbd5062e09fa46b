"""``ratt-opt verify`` and ``ratt-opt audit``: is a certificate's claim proved, and is the paper's proof?"""

from dataclasses import asdict
from pathlib import Path
from typing import Annotated

import typer

from ratt_opt.certificates.verifier.work import SECONDS
from ratt_opt.cli.options import JsonFlag, Objective, OutFolder
from ratt_opt.cli.terminal import WorkInterrupted, print_json, print_lines, print_tables
from ratt_opt.errors import printable
from ratt_opt.progress import Step

__all__ = ["audit", "verify"]

UPPER_ONLY = 3
"""Exit code of ``verify`` where the lower end is stated, not proved."""


def verify(
    file: Annotated[Path, typer.Argument(help="Certificate file.", show_default=False)],
    problem: Annotated[
        Path | None, typer.Option("--problem", help="Scenario or information file the certificate must be about.")
    ] = None,
    objective: Annotated[Objective, typer.Option("--objective", help="Criterion, with --problem.")] = "trace",
    time_limit: Annotated[float, typer.Option("--time-limit", help="Seconds before it counts as undecided.")] = SECONDS,
    as_json: JsonFlag = False,
) -> int:
    """Check a certificate without trusting what wrote it, and say what it proves.

    Exit 0: both ends are proved; 1: the first fault is named; 2: the file is no certificate; 3: only the upper end is
    proved; 4: neither proved nor refuted within the limits. None of these where the output cannot be written (74).
    """
    from ratt_opt.certificates.verifier.verify import verify_certificate

    expected = None
    if problem is not None:
        from ratt_opt.certificates.agreement import same_problem
        from ratt_opt.scenario.files import load_input

        expected = same_problem(load_input(problem), objective)
    with Step("checking the certificate"):
        verified = verify_certificate(file, expected_problem=expected, time_limit=time_limit)
    if as_json:
        print_json(asdict(verified))
    else:
        print_lines(verified.lines())
    return 0 if verified.lower_proved else UPPER_ONLY


def audit(
    out: OutFolder,
    quick: Annotated[bool, typer.Option("--quick", help="Only the sizes that take seconds.")] = False,
    as_json: JsonFlag = False,
) -> None:
    """Decide the paper's proof line by line; write audit.json, audit.html and audit.md.

    An interrupt (Ctrl-C) writes what is decided so far, marked incomplete, and exits with 130.
    """
    from ratt_opt.audit.ledger import run_audit
    from ratt_opt.report.tables import audit_table

    ledger = run_audit(out, quick=quick)
    if as_json:
        print_json({**ledger.document(), "entries": len(ledger.records)})
    else:
        print_tables([audit_table(ledger.per_chain())])
        found = (f"{part.heading} {' '.join(part.sentences)}" for part in ledger.findings() if part.sentences)
        names = ", ".join(printable(str(out / name)) for name in ("audit.json", "audit.html", "audit.md"))
        print_lines([*found, f"written: {names}"])
    if not ledger.complete:
        raise WorkInterrupted(f"interrupted after {len(ledger.records)} entries, which were written")
