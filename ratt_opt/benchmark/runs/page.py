"""One page of results: a table of solvers, figures, faults by name, and every row."""

from __future__ import annotations

import base64
import math
from dataclasses import dataclass
from html import escape
from typing import TYPE_CHECKING

import numpy as np

from ratt_opt._files import output_directory, write_atomically
from ratt_opt._values import counted
from ratt_opt.benchmark.runs.figures import CLOSE, gap_figure, profile_figure, steps_of
from ratt_opt.benchmark.runs.measures import par10, time_to
from ratt_opt.benchmark.runs.runner import read_rows
from ratt_opt.studies.plots import save

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence
    from pathlib import Path

    from ratt_opt.benchmark.runs.runner import SolverRows

__all__ = ["PAGE", "Summary", "summaries", "write_page"]

PAGE = "page.html"
SAME = 1e-6
"""Gap to the best known value that counts as none."""
STYLE = """body{font:15px/1.5 system-ui,sans-serif;color:#1c1c1c;max-width:72rem;margin:2rem auto;padding:0 1rem}
table{border-collapse:collapse;margin:1rem 0;font-variant-numeric:tabular-nums}
th,td{padding:.25rem .6rem;text-align:right;border-bottom:1px solid #ddd}th:first-child,td:first-child{text-align:left}
td.words{text-align:left;max-width:34rem}img{max-width:100%}.wide{overflow-x:auto}summary{cursor:pointer}"""


@dataclass(frozen=True, slots=True, kw_only=True)
class Summary:
    """One solver over the instances that all solvers of its track tried.

    ``best`` : instances with the best known value; ``close`` : within one per cent; ``gap``, ``integral`` : means;
    ``par10`` [s] : of the time to within one per cent; ``proved`` : optimal by a certificate of its own; ``false`` :
    rows with a claim that is false; ``faulty`` : rows with any fault
    """

    solver: str
    instances: int
    best: int
    close: int
    gap: float
    integral: float
    par10: float
    proved: int
    faulty: int


def summaries(rows: Mapping[str, SolverRows]) -> list[Summary]:
    """Summaries of all solvers, the best mean gap integral first."""
    found = [_summary(solver, some) for solver, some in rows.items()]
    return sorted(found, key=lambda one: (one.integral, one.solver))


def write_page(out: Path) -> list[Path]:
    """Write ``page.html`` and its two figures into a folder of results.

    Raises
    ------
    InputError : the folder holds no results, or cannot be written.
    """
    rows = read_rows(out)
    figures = {"profile": profile_figure(rows), "gaps": gap_figure(rows)}
    folder = output_directory(out, PAGE, *(f"{name}.{kind}" for name in figures for kind in ("png", "svg")))
    for name, figure in figures.items():
        save(figure, folder, name)
    html = _page(rows, {name: _embedded(folder / f"{name}.png") for name in figures})
    page = write_atomically(folder / PAGE, lambda file: file.write_text(html, encoding="utf-8"))
    return [page, *(folder / f"{name}.{kind}" for name in figures for kind in ("png", "svg"))]


def _summary(solver: str, rows: SolverRows) -> Summary:
    gaps, limit = [float(row["gap"]) for row in rows], float(rows[0]["limit"])
    times = [time_to(steps_of(row), CLOSE) for row in rows]
    return Summary(
        solver=solver,
        instances=len(rows),
        best=sum(gap <= SAME for gap in gaps),
        close=sum(gap <= CLOSE for gap in gaps),
        gap=float(np.mean(gaps)),
        integral=float(np.mean([float(row["integral"]) for row in rows])),
        par10=par10(times, limit),
        proved=sum(_is_proved(row) for row in rows),
        faulty=sum(bool(row["faults"]) for row in rows),
    )


def _is_proved(row: Mapping[str, str]) -> bool:
    """True if the row's own answer and its own certificate meet."""
    if not row["proved"] or not row["value"]:
        return False
    value, bound = float(row["value"]), float(row["proved"])
    return abs(bound - value) <= SAME * max(abs(value), abs(bound))


def _embedded(picture: Path) -> str:
    return f"data:image/png;base64,{base64.b64encode(picture.read_bytes()).decode()}"


def _page(rows: Mapping[str, SolverRows], pictures: Mapping[str, str]) -> str:
    head = (
        "solver",
        "instances",
        "best value",
        "within 1 %",
        "mean gap",
        "gap integral",
        "PAR10 [s]",
        "proved",
        "faulty",
    )
    lines = [
        (
            s.solver,
            s.instances,
            s.best,
            s.close,
            _share(s.gap),
            _share(s.integral),
            f"{s.par10:.3g}",
            s.proved,
            s.faulty,
        )
        for s in summaries(rows)
    ]
    columns = ("instance", "class", "value", "known value", "proved", "claimed", "gap", "best at", "seconds")
    every = "".join(
        f"<details><summary>{escape(solver)}: {counted(len(some), 'row')}</summary><div class=wide>"
        f"{_table(columns, [[_short(row[column]) for column in columns] for row in some])}</div></details>"
        for solver, some in rows.items()
    )
    notes = (
        "Values are found again by the exact attack, not taken from solvers. A bound counts as proved only if its "
        "certificate verifies; others are claimed. Gaps are distances to the best value known, over the larger of the "
        "two. The integral is the mean gap over the time limit, 1 before the first answer. PAR10 is the mean time to "
        "within 1 %, an instance that is not reached counting ten limits. Times are of the clock; solvers that ran "
        "beside others were slowed by them."
    )
    figures = "".join(
        f'<h2>{escape(title)}</h2><img alt="{escape(title)}" src="{pictures[name]}">'
        for name, title in (("profile", "Performance profile"), ("gaps", "Gap over time"))
    )
    return (
        '<!DOCTYPE html><html lang="en"><head><meta charset="utf-8"><title>Benchmark</title>'
        f"<style>{STYLE}</style></head><body><h1>Benchmark</h1><p>{notes}</p>"
        f"<div class=wide>{_table(head, lines)}</div>{figures}"
        f"<h2>Faults</h2>{_faults(rows)}<h2>Rows</h2>{every}</body></html>\n"
    )


def _faults(rows: Mapping[str, SolverRows]) -> str:
    found = [(solver, row["instance"], row["faults"]) for solver, some in rows.items() for row in some if row["faults"]]
    if not found:
        return "<p>None.</p>"
    cells = "".join(
        f"<tr><td>{escape(solver)}</td><td class=words>{escape(name)}</td><td class=words>{escape(text)}</td></tr>"
        for solver, name, text in found
    )
    return f"<div class=wide><table><tr><th>solver</th><th>instance</th><th>fault</th></tr>{cells}</table></div>"


def _table(head: Sequence[str], lines: Sequence[Sequence[object]]) -> str:
    top = "".join(f"<th>{escape(name)}</th>" for name in head)
    rest = "".join("<tr>" + "".join(f"<td>{escape(str(cell))}</td>" for cell in line) + "</tr>" for line in lines)
    return f"<table><tr>{top}</tr>{rest}</table>"


def _share(value: float) -> str:
    return f"{100 * value:.2f} %"


def _short(cell: str) -> str:
    """A number by nine digits; other cells as they are."""
    try:
        number = float(cell)
    except ValueError:
        return cell
    return f"{number:.9g}" if math.isfinite(number) else cell
