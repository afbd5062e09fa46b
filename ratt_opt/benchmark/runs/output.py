"""Output of a solver: one JSON object a line, each read, checked and timed by us; faults are named."""

from __future__ import annotations

import json
import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from ratt_opt.benchmark.proofs.answers import answer_of
from ratt_opt.errors import InputError

if TYPE_CHECKING:
    from ratt_opt.benchmark.instances.instance import BenchmarkInstance
    from ratt_opt.benchmark.runs.process import Line, Run

__all__ = ["Output", "Report", "read_output"]


@dataclass(frozen=True, slots=True, kw_only=True)
class Report:
    """One line of a solver: an answer, the ends that it claims, and the name of a certificate; each may be missing.

    ``at`` : when it came [s], by our clock
    """

    at: float
    answer: dict[str, Any] | None
    lower: float | None
    upper: float | None
    certificate: str | None


@dataclass(frozen=True, slots=True, kw_only=True)
class Output:
    """Reports in the order in which they came, and the faults met, each in words."""

    reports: tuple[Report, ...]
    faults: tuple[str, ...]


def read_output(instance: BenchmarkInstance, run: Run, most_faults: int = 5) -> Output:
    """Read what a run printed; a line that is none, or an answer that is none, is a fault and costs only itself.

    ``most_faults`` : of the run that are listed; more are counted.
    """
    reports, faults = [], []
    for number, line in enumerate(run.lines, start=1):
        if not line.text.strip():
            continue
        is_last = number == len(run.lines)
        try:
            reports.append(_report(instance, line))
        except InputError as error:
            faults.append(f"line {number}: {error}")
        except (ValueError, RecursionError):
            cut_off = "output stops in the middle of a line" if run.torn and is_last else "is no JSON object"
            faults.append(f"line {number} {cut_off}" if "is no" in cut_off else f"{cut_off}, line {number}")
    if run.killed:
        faults.append(run.killed)
    elif run.exit_code is None:
        faults.append(run.errors or "cannot be started")
    elif run.exit_code != 0:
        last = (run.errors.strip().splitlines() or ["nothing on standard error"])[-1]
        faults.append(f"ended with exit code {run.exit_code}: {last[:200]}")
    if run.left_behind:
        faults.append("left processes behind, which were killed")
    if not any(report.answer for report in reports):
        faults.append("printed no answer")
    more = [f"and {len(faults) - most_faults} more faults"] if len(faults) > most_faults else []
    return Output(reports=tuple(reports), faults=(*faults[:most_faults], *more))


def _report(instance: BenchmarkInstance, line: Line) -> Report:
    """Read one line. ValueError : no JSON object. InputError : a field breaks its rule."""
    document = json.loads(line.text)
    if not isinstance(document, dict):
        raise ValueError("no object")
    name = document.get("certificate")
    if name is not None and (not isinstance(name, str) or "/" in name or "\\" in name or name.startswith(".")):
        raise InputError("certificate", "must be the plain name of a file in {out}", name)
    return Report(
        at=line.at,
        answer=answer_of(instance, document),
        lower=_number(document, "lower"),
        upper=_number(document, "upper"),
        certificate=name,
    )


def _number(document: dict[str, Any], name: str) -> float | None:
    value = document.get(name)
    if value is None:
        return None
    if isinstance(value, bool) or not isinstance(value, (int, float)) or math.isnan(value):
        raise InputError(name, "must be a number", value)
    return None if math.isinf(value) else float(value)
