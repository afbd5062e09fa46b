"""Results of a study: its rows, the means with their intervals, and these as data frame, LaTeX and figure."""

from __future__ import annotations

import warnings
from dataclasses import dataclass, fields
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from ratt_opt._files import output_directory, write_together
from ratt_opt.errors import InputError
from ratt_opt.findings import value_unit
from ratt_opt.report.csv_file import write_csv
from ratt_opt.report.latex import latex_table
from ratt_opt.scenario.model import Scenario
from ratt_opt.setfunctions.criteria.registry import CRITERIA
from ratt_opt.studies.cases import Seeds
from ratt_opt.studies.statistics import VALUES, Mean, column, estimate, headed, select

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

    from matplotlib.figure import Figure
    from pandas import DataFrame

    from ratt_opt.studies.cases import Case
    from ratt_opt.studies.study import Study

__all__ = ["Results"]

AT_LEAST_ZERO = ("value", "proved", "trace", "mse", "rmse", "final", "largest", "nees")
"""Metrics that are never negative: neither is what is said of their means."""
TABLES, FIGURES = ("means.csv", "means.tex"), ("means.png", "means.svg")
COLUMNS = ("case", "planner", "attacker", "metric", "mean", "low", "high", "trials")


@dataclass(frozen=True, slots=True, kw_only=True, repr=False)
class Results:
    """The finished trials of a study.

    ``rows`` : one for each case and trial, as text; ``path`` : the table of the same rows, or ``None``.
    """

    study: Study
    rows: tuple[dict[str, str], ...]
    path: Path | None

    def __repr__(self) -> str:
        return f"Results(study {self.study.name!r}, {len(self.study.cases)} cases, {len(self.rows)} rows)"

    @property
    def columns(self) -> dict[str, tuple[str, str, str]]:
        """Planner, attacker and metric of every measured column of numbers, by the column's name."""
        return {name: self._parts(name) for name in self._measured() if _are_numbers(self.rows, name)}

    @property
    def unit(self) -> str:
        """Unit of the values, if it is the same in all cases, else empty."""
        if not {metric for _, _, metric in self.columns.values()} & set(VALUES):
            return ""
        units = {_unit(self.study, case) for case in self.study.cases}
        return units.pop() if len(units) == 1 else ""

    def means(self, *, metric: str | None = None, minus: str | None = None) -> list[Mean]:
        """Mean and 95 % interval (Student's t) over the trials, for each case and measured column.

        Parameters
        ----------
        metric : this one only
        minus : a planner's name: means of the differences from it, trial by trial, of all other planners. Trials
            differ far more than planners do on the same trial, so these are the intervals that decide between planners

        Raises
        ------
        InputError : there is no such metric or planner.
        """
        self._check("metric", metric, sorted({parts[2] for parts in self.columns.values()}))
        self._check("minus", minus, self.study.planner_names)
        return list(self._means(metric, minus))

    def to_dataframe(self, *, means: bool = False, minus: str | None = None) -> DataFrame:
        """The rows as a pandas data frame with numbers as numbers; or the ``means``, with the columns of ``means.csv``.

        ``minus`` : as for :meth:`means`, which it implies

        Raises
        ------
        InputError : pandas is not installed.
        """
        try:
            from pandas import DataFrame
        except ImportError:
            rule = "needs pandas: pip install 'ratt-opt[dataframes]'"
            raise InputError("to_dataframe", rule, "no module 'pandas'") from None
        if means or minus is not None:
            return DataFrame(_records(self.means(minus=minus)), columns=list(COLUMNS))
        return DataFrame({name: _typed([row[name] for row in self.rows]) for name in self.rows[0]})

    def to_latex(self, *, metric: str | None = None, minus: str | None = None, caption: str = "") -> str:
        r"""The means as a LaTeX table: a row for each case, attacker and planner, a column for each metric.

        It needs ``\usepackage{booktabs}``. ``metric``, ``minus`` : as for :meth:`means`
        """
        header, rows = self.mean_rows(metric=metric, minus=minus)
        return latex_table(header, rows, caption=caption, note=self.note(minus) if caption else "")

    def plot(self, metric: str | None = None, *, minus: str | None = None) -> Figure:
        """A matplotlib figure of the means: a panel for each attacker, a group of marks for each case.

        ``metric`` : the study's first by default; ``minus`` : as for :meth:`means`

        Raises
        ------
        InputError : the study compares no planners, or there is no such metric or planner.
        """
        from ratt_opt.studies.plots import comparison  # draws

        if not self.study.planner_names or not self.study.attacker_names:
            raise InputError("plot", "needs a study of planners and attackers", self.study.name)
        chosen = self.study.metrics[0] if metric is None else metric
        found = [mean for mean in self.means(metric=chosen, minus=minus) if mean.planner]
        return comparison(found, self.note(minus), self.unit)

    def save(self, folder: str | Path) -> list[Path]:
        """Write ``means.csv`` and ``means.tex``; of a study of planners also ``means.png`` and ``means.svg``.

        If the figure cannot be drawn, a warning says why, and the tables are written.

        InputError : the folder cannot be written.
        """
        from ratt_opt.report.figure import draw_or_remark, save_figure  # draws

        out = output_directory(Path(folder), *TABLES, *FIGURES)
        caption = f"Study {self.study.name}"
        writers: dict[str, Any] = {
            "means.csv": lambda file: write_csv(file, COLUMNS, [list(row.values()) for row in _records(self.means())]),
            "means.tex": lambda file: file.write_text(self.to_latex(caption=caption), encoding="utf-8"),
        }
        files = write_together(out, writers, outdated=FIGURES)
        if not (self.study.planner_names and self.study.attacker_names and self.study.metrics):
            return files

        def draw() -> list[Path]:
            figure = self.plot()
            return write_together(out, dict.fromkeys(FIGURES, lambda file: save_figure(figure, file)))

        figures, remarks = draw_or_remark(draw)
        for remark in remarks:
            warnings.warn(remark, RuntimeWarning, stacklevel=2)
        return [*files, *figures]

    def mean_rows(self, *, metric: str | None = None, minus: str | None = None) -> tuple[list[str], list[list[str]]]:
        """Header and rows of the means as text: a row for each case, attacker and planner, a column for each metric."""
        means = self.means(metric=metric, minus=minus)
        metrics = list(dict.fromkeys(mean.metric for mean in means if mean.planner))
        other = list(dict.fromkeys(mean.metric for mean in means if not mean.planner))
        shown = {(mean.case, mean.attacker, mean.planner, mean.metric): mean.estimate.text() for mean in means}
        order = [mean.case for mean in means], ["", *self.study.attacker_names]
        keys = sorted(
            dict.fromkeys(key[:3] for key in shown), key=lambda k: (order[0].index(k[0]), order[1].index(k[1]))
        )
        kept = [name for name in (*metrics, *other) if any((*key, name) in shown for key in keys)]
        rows = [[*key, *(shown.get((*key, name), "") for name in kept)] for key in keys]
        heads = [headed(name, self.unit, (minus or "") if name in metrics else "") for name in kept]
        return ["case", "attacker", "planner", *heads], rows

    def note(self, minus: str | None = None) -> str:
        """Description of the numbers of a table or figure."""
        what = "mean" if minus is None else f"mean difference from {minus}, trial by trial,"
        return f"{what} of {len({row['trial'] for row in self.rows})} trials, with its 95 % interval"

    def _means(self, metric: str | None, minus: str | None) -> Iterator[Mean]:
        for case in self.study.cases:
            kept = select(self.rows, case=case.name)
            for name, (planner, attacker, of) in self.columns.items():
                if metric not in {None, of} or (minus is not None and planner in {"", minus}):
                    continue
                values = column(kept, name)
                if minus is not None:
                    values = values - column(kept, f"{minus}/{attacker}/{of}")
                found = estimate(values)
                if minus is None and of in AT_LEAST_ZERO and (values >= 0).all():
                    found = found.at_least(0.0)
                parts = {"case": case.name, "planner": planner, "attacker": attacker, "metric": of}
                yield Mean(**parts, estimate=found, minus=minus or "")

    def _measured(self) -> list[str]:
        """The columns that are neither a factor of the case nor say where a row comes from."""
        case = self.study.cases[0]
        told = {"case", "trial", "seed", "versions", "scenario", *(name for name, _ in case.options)}
        told |= {field.name for field in fields(case)}
        return [name for name in (self.rows[0] if self.rows else {}) if name not in told]

    def _parts(self, name: str) -> tuple[str, str, str]:
        planner, _, rest = name.partition("/")
        attacker, _, metric = rest.partition("/")
        known = planner in self.study.planner_names and attacker in self.study.attacker_names
        return (planner, attacker, metric) if known else ("", "", name)

    def _check(self, argument: str, value: str | None, known: tuple[str, ...] | list[str]) -> None:
        if value is not None and value not in known:
            raise InputError(argument, f"must be {', '.join(known) or 'absent: there is none'}", value)


def _unit(study: Study, case: Case) -> str:
    """The unit of a case's values, asked of the problem of its first trial if the study makes its own."""
    if study.problem is None:
        return getattr(CRITERIA[case.objective], "unit", "")
    made = study.problem(case, Seeds.of(study.seed, 0))
    problem = made.problem(case.objective) if isinstance(made, Scenario) else made
    return value_unit(problem.objective, getattr(made, "units", None))


def _records(means: list[Mean]) -> list[dict[str, object]]:
    """Each mean by the names of ``COLUMNS``."""
    records = []
    for mean in means:
        e = mean.estimate
        ends = (e.low, e.high) if e.n > 1 else (None, None)  # one trial has no interval
        numbers = (mean.case, mean.planner, mean.attacker, mean.metric, e.mean, *ends, e.n)
        records.append(dict(zip(COLUMNS, numbers, strict=True)))
    return records


def _are_numbers(rows: tuple[Mapping[str, str], ...], name: str) -> bool:
    try:
        return bool(np.isfinite(column(rows, name)).all())
    except ValueError:
        return False


def _typed(cells: list[str]) -> list[Any]:
    """A column as integers, else as floats, else as text."""
    for kind in (int, float):
        try:
            return [kind(cell) for cell in cells]
        except ValueError:
            continue
    return list(cells)
