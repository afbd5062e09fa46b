"""Write a bound report to a folder: for programs, for readers, for robots."""

from __future__ import annotations

import shutil
import warnings
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

from ratt_opt._files import output_directory, write_atomically, write_json, write_together
from ratt_opt.certificates.certification import CERTIFICATE
from ratt_opt.report.csv_file import write_csv
from ratt_opt.report.document import report_document
from ratt_opt.report.figure import draw_or_remark, plan_figure, save_figure
from ratt_opt.report.page.map_svg import page_maps
from ratt_opt.report.page.page import report_page
from ratt_opt.report.picture import picture_of
from ratt_opt.report.plan_rows import PLAN_COLUMNS, plan_rows

if TYPE_CHECKING:
    from collections.abc import Callable

    from ratt_opt.findings import Findings

__all__ = ["FIGURES", "FILES", "write_figures", "write_numbers", "write_report", "write_verdict"]

PAGE = "report.html"
NUMBERS, FIGURES = ("report.json", PAGE, "plan.csv"), ("plan.png", "plan.svg")
FILES = (*NUMBERS, *FIGURES)
"""All that :func:`write_report` writes beside the certificate."""


def write_report(report: Findings, folder: str | Path) -> list[Path]:
    """Write ``report.json``, ``report.html``, ``plan.csv``, ``plan.png``, ``plan.svg`` and return the files.

    The certificate, if there is one, is copied beside them. Drawing takes a second or two and comes last: an interrupt
    of it leaves the rest. If the figures cannot be drawn, the report says why among its remarks, and a warning does.

    Raises
    ------
    InputError : the folder cannot be written.
    """
    numbers = write_numbers(report, folder)
    out = Path(folder)
    proof = report.certificate.certificate
    copies = []
    if proof is not None:
        copies = [out / CERTIFICATE]
        if not (copies[0].exists() and copies[0].samefile(proof.path)):
            write_atomically(copies[0], lambda file: shutil.copyfile(proof.path, file))
    figures, remarks = write_figures(report, out)
    for remark in remarks:
        warnings.warn(remark, RuntimeWarning, stacklevel=3)
    return [*numbers, *figures, *copies]


def write_numbers(report: Findings, folder: str | Path) -> list[Path]:
    """Write all but the figures, and remove those of an earlier report: milliseconds."""
    page = report_page(report)
    writers = (
        lambda file: write_json(file, report_document(report)),
        lambda file: file.write_text(page, encoding="utf-8"),
        lambda file: write_csv(file, PLAN_COLUMNS, plan_rows(report)),
    )
    return write_together(output_directory(folder), dict(zip(NUMBERS, writers, strict=True)), outdated=FIGURES)


def write_figures(report: Findings, folder: Path) -> tuple[list[Path], tuple[str, ...]]:
    """Draw the figures of a report whose numbers are there, and the maps of its page: a few seconds.

    If that fails, no file is written, and what is returned beside the files is said in the report too.
    """

    def draw() -> list[Path]:
        figure = plan_figure(report, picture_of(report.source, report))
        page = report_page(report, page_maps(report))
        writers: dict[str, Callable[[Path], object]] = dict.fromkeys(FIGURES, lambda file: save_figure(figure, file))
        writers[PAGE] = lambda file: file.write_text(page, encoding="utf-8")
        return write_together(folder, writers)[: len(FIGURES)]

    files, remarks = draw_or_remark(draw)
    if remarks:
        write_verdict(replace(report, remarks=(*report.remarks, *remarks)), folder)
    return files, remarks


def write_verdict(report: Findings, folder: Path) -> None:
    """Write again what shows the certificate's verdict and the remarks: ``report.json`` and ``report.html``."""
    page = report_page(report)
    writers = (
        lambda file: write_json(file, report_document(report)),
        lambda file: file.write_text(page, encoding="utf-8"),
    )
    write_together(folder, dict(zip(NUMBERS[: len(writers)], writers, strict=True)))
