"""Claims as data, each judged by paired differences with their intervals, and the tables that report them."""

import csv
import io
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from ratt_opt._files import write_atomically
from ratt_opt._validation import FloatArray
from ratt_opt.report.latex import latex_table
from ratt_opt.studies.statistics import Estimate, Verdict, column, estimate, judge, select
from ratt_opt.studies.store import read_table

__all__ = ["Claim", "write_claims"]

HEAD = ["| figure | command `python -m` | claim | our result | verdict |", "| --- | --- | --- | --- | --- |"]
AVERAGE = "average over cases"
COLUMNS = ("figure", "claim", "case", "mean", "low", "high", "trials", "verdict of the claim")


@dataclass(frozen=True, slots=True, kw_only=True)
class Claim:
    """The mean of column ``left`` is below that of ``right`` in every case, trial by trial.

    With ``share``, the claim is instead that ``left / right - 1`` is below ``share``.
    ``command`` : what makes the results: a module ``package.study``, or ``package.module --only study``.
    """

    figure: str
    command: str
    statement: str
    left: str
    right: str
    share: float | None = None
    unit: str = "m²"

    @property
    def study(self) -> str:
        """Folder of the results."""
        return self.command.split()[-1].rpartition(".")[2]

    def measured(self, rows: Sequence[Mapping[str, str]]) -> dict[str, FloatArray]:
        """(T,) per case: the paired differences (or excess shares), trial by trial."""
        found = {}
        for case in dict.fromkeys(row["case"] for row in rows):
            kept = select(rows, case=case)
            left, right = column(kept, self.left), column(kept, self.right)
            found[case] = left - right if self.share is None else left / right - 1
        return found


def write_claims(out: Path, claims: Sequence[Claim], first: Sequence[str] = (), *, name: str = "claims") -> None:
    """Write and print ``name.md``, and write it as ``name.tex`` and ``name.csv`` with every interval behind it.

    ``first`` : Markdown rows that come before those of ``claims``.
    """
    lines, table = [*HEAD, *first], [COLUMNS]
    for claim in claims:
        measured = claim.measured(read_table(out / claim.study))
        cases = {case: estimate(values) for case, values in measured.items()}
        # Trials are paired over cases, so the mean over cases is one independent number per trial.
        average = estimate(np.mean(list(measured.values()), axis=0))
        verdict = judge(cases.values(), average, below=claim.share or 0.0)
        lines.append(_line(claim, list(cases.values()), average, verdict))
        for case, e in {**cases, AVERAGE: average}.items():
            numbers = (repr(e.mean), repr(e.low), repr(e.high), str(e.n))
            table.append((claim.figure, claim.statement, case, *numbers, verdict.value))
    stream = io.StringIO()
    csv.writer(stream, lineterminator="\n").writerows(table)
    text = "\n".join(lines) + "\n"
    write_atomically(out / f"{name}.csv", lambda file: file.write_bytes(stream.getvalue().encode()))
    write_atomically(out / f"{name}.md", lambda file: file.write_text(text, encoding="utf-8"))
    header, _, *cells = [line.strip("| ").replace("`", "").split(" | ") for line in lines]
    latex = latex_table(header, cells, caption="Claims, and what was found")
    write_atomically(out / f"{name}.tex", lambda file: file.write_text(latex, encoding="utf-8"))
    print(text, end="")


def _line(claim: Claim, cases: Sequence[Estimate], average: Estimate, verdict: Verdict) -> str:
    scale, unit = (1.0, claim.unit) if claim.share is None else (100.0, "%")
    what = "difference" if claim.share is None else "excess" if claim.share else "relative difference"
    limit = claim.share or 0.0
    holds, fails = sum(e.high < limit for e in cases), sum(e.among(len(cases)).low > limit for e in cases)
    count = f"holds in {holds} of {len(cases)} cases" + (f", fails in {fails}" if fails else "")
    result = f"{what} {average.show(scale)} {unit} on average; {count}; {average.n} trials"
    return f"| {claim.figure} | `{claim.command}` | {claim.statement} | {result} | {verdict.value} |"
