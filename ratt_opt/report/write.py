"""Write a bound report to a folder: ``report.json``, ``plan.png``, ``plan.svg``."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ratt_opt._files import output_directory, write_json
from ratt_opt.report.figure import plan_figure, save_figure
from ratt_opt.report.picture import picture_of
from ratt_opt.scenario.model import Scenario

if TYPE_CHECKING:
    from pathlib import Path

    from ratt_opt.main_job.result import BoundReport

__all__ = ["write_report"]


def write_report(report: BoundReport, folder: str | Path, source: object = None) -> list[Path]:
    """Write the report and return the files; ``source`` is the scenario, if there is one to draw.

    Raises
    ------
    InputError : the folder cannot be written.
    """
    out = output_directory(folder)
    picture = picture_of(source, report) if isinstance(source, Scenario) else None
    figure = plan_figure(report, picture)
    for name in ("plan.png", "plan.svg"):
        save_figure(figure, out / name)
    write_json(out / "report.json", report.to_dict())
    return [out / "report.json", out / "plan.png", out / "plan.svg"]
