"""Write a bound report to a folder: for programs, for readers, for robots."""

from __future__ import annotations

import csv
import shutil
from typing import TYPE_CHECKING

from ratt_opt._files import output_directory, write_atomically, write_json
from ratt_opt.report.description import describe
from ratt_opt.report.figure import plan_figure, save_figure
from ratt_opt.report.picture import picture_of

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

    from ratt_opt.main_job.result import BoundReport

__all__ = ["plan_rows", "write_report"]

PLAN_COLUMNS = ("robot", "name", "element", "control", "x", "y", "heading", "bait", "under attack", "group")


def write_report(report: BoundReport, folder: str | Path) -> list[Path]:
    """Write ``report.json``, ``plan.csv``, ``plan.png``, ``plan.svg`` and return the files.

    The certificate, where there is one, is copied beside them.

    Raises
    ------
    InputError : the folder cannot be written.
    """
    out = output_directory(folder)
    figure = plan_figure(report, picture_of(report.source, report))
    files = [
        write_json(out / "report.json", report.to_dict()),
        write_atomically(out / "plan.csv", lambda file: _write_plan(report, file)),
    ]
    for name in ("plan.png", "plan.svg"):
        save_figure(figure, out / name)
        files.append(out / name)
    proof = report.certificate.certificate
    if proof is not None:
        copy = out / "certificate.json"
        if not (copy.exists() and copy.samefile(proof.path)):
            write_atomically(copy, lambda file: shutil.copyfile(proof.path, file))
        files.append(copy)
    return files


def plan_rows(report: BoundReport) -> Iterator[tuple[object, ...]]:
    """Yield one row of ``PLAN_COLUMNS`` a robot: the recommended plan, and its role under the worst attack.

    Positions [m] and headings [rad] are those after the control; empty where the source does not tell.
    """
    plan, known = report.recommended, describe(report.problem, report.source)
    home = {i: k for k, group in enumerate(plan.groups) for i in group}
    for i, element in enumerate(plan.elements.tolist()):
        given = known.pose_after(element) or []
        pose: list[object] = [*given, *[""] * (3 - len(given))]
        role = "blinded" if i in plan.worst_case.attack.sensing else "sees" if i in plan.best_group else "cut off"
        yield i, known.robot_names[i], element, known.label(element), *pose, int(i in plan.bait), role, home[i]


def _write_plan(report: BoundReport, path: Path) -> None:
    with path.open("w", encoding="utf-8", newline="") as file:
        table = csv.writer(file, lineterminator="\n")
        table.writerow(PLAN_COLUMNS)
        table.writerows(plan_rows(report))
