"""Write a bound report to a folder: ``report.json``, ``plan.png``, ``plan.svg``."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ratt_opt._files import output_directory, write_json, write_together
from ratt_opt.report.figure import plan_figure, save_figure
from ratt_opt.report.picture import picture_of
from ratt_opt.scenario.model import Scenario

if TYPE_CHECKING:
    from pathlib import Path

    from ratt_opt.main_job.result import BoundReport

__all__ = ["FILES", "write_report"]

FILES = ("report.json", "plan.png", "plan.svg")
"""All that :func:`write_report` writes."""


def write_report(report: BoundReport, folder: str | Path, source: object = None) -> list[Path]:
    """Write the report and return the files; ``source`` is the scenario, if there is one to draw.

    Raises
    ------
    InputError : the folder cannot be written.
    """
    out = output_directory(folder)
    picture = picture_of(source, report) if isinstance(source, Scenario) else None
    figure = plan_figure(report, picture)
    writers = (
        lambda file: write_json(file, report.to_dict()),
        lambda file: save_figure(figure, file),
        lambda file: save_figure(figure, file),
    )
    return write_together(out, dict(zip(FILES, writers, strict=True)))
