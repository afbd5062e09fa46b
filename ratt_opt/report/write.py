"""Write a bound report to a folder: for programs, for readers, for robots."""

from __future__ import annotations

import csv
import shutil
from typing import TYPE_CHECKING

from ratt_opt._files import output_directory, write_atomically, write_json, write_together
from ratt_opt.report.figure import plan_figure, save_figure
from ratt_opt.report.page.page import report_page
from ratt_opt.report.picture import picture_of
from ratt_opt.report.plan_rows import PLAN_COLUMNS, plan_rows

if TYPE_CHECKING:
    from pathlib import Path

    from ratt_opt.main_job.result import BoundReport

__all__ = ["FILES", "write_report", "write_verdict"]

FILES = ("report.json", "report.html", "plan.csv", "plan.png", "plan.svg")
"""All that :func:`write_report` writes beside the certificate."""


def write_report(report: BoundReport, folder: str | Path) -> list[Path]:
    """Write ``report.json``, ``report.html``, ``plan.csv``, ``plan.png``, ``plan.svg`` and return the files.

    The certificate, where there is one, is copied beside them.

    Raises
    ------
    InputError : the folder cannot be written.
    """
    out = output_directory(folder)
    figure = plan_figure(report, picture_of(report.source, report))
    page = report_page(report)
    writers = (
        lambda file: write_json(file, report.to_dict()),
        lambda file: file.write_text(page, encoding="utf-8"),
        lambda file: _write_plan(report, file),
        lambda file: save_figure(figure, file),
        lambda file: save_figure(figure, file),
    )
    files = write_together(out, dict(zip(FILES, writers, strict=True)))
    proof = report.certificate.certificate
    if proof is not None:
        copy = out / "certificate.json"
        if not (copy.exists() and copy.samefile(proof.path)):
            write_atomically(copy, lambda file: shutil.copyfile(proof.path, file))
        files.append(copy)
    return files


def write_verdict(report: BoundReport, folder: Path) -> None:
    """Write again what shows the certificate's verdict: ``report.json`` and ``report.html``."""
    page = report_page(report)
    writers = (
        lambda file: write_json(file, report.to_dict()),
        lambda file: file.write_text(page, encoding="utf-8"),
    )
    write_together(folder, dict(zip(FILES[: len(writers)], writers, strict=True)))


def _write_plan(report: BoundReport, path: Path) -> None:
    with path.open("w", encoding="utf-8", newline="") as file:
        table = csv.writer(file, lineterminator="\n")
        table.writerow(PLAN_COLUMNS)
        table.writerows(plan_rows(report))
