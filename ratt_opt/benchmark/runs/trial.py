"""One solver on one instance: run it, value its answers again, check what it claims, and measure."""

from __future__ import annotations

import json
import math
import shlex
import sys
import tempfile
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ratt_opt.benchmark.instances.instance import canonical, read_document
from ratt_opt.benchmark.instances.library import BenchmarkLibrary
from ratt_opt.benchmark.proofs.answers import AnswerWorth, worth_of
from ratt_opt.benchmark.proofs.verification import proved_bound
from ratt_opt.benchmark.runs.measures import gap_integral, gap_of
from ratt_opt.benchmark.runs.output import read_output
from ratt_opt.benchmark.runs.process import Limits, run_command
from ratt_opt.errors import InputError, ProofError, UndecidedError

if TYPE_CHECKING:
    from ratt_opt.benchmark.instances.instance import BenchmarkInstance
    from ratt_opt.benchmark.instances.library import Best
    from ratt_opt.benchmark.runs.output import Output, Report
    from ratt_opt.benchmark.runs.process import Run
    from ratt_opt.studies.cases import Case, Cell, Seeds
    from ratt_opt.studies.study import Study

__all__ = ["BenchTrial", "command_words"]

INSTANCE_FILE = "instance.json"
HOLES = ("{instance}", "{out}", "{s}")


@dataclass(frozen=True, slots=True)
class _Valued:
    """An answer, when it came [s], and what it is worth for certain."""

    at: float
    value: float
    answer: dict[str, Any]


@dataclass(frozen=True, slots=True)
class BenchTrial:
    """The measure of a study whose cases are instances of a library.

    ``command`` : with the holes ``{instance}``, ``{out}`` and ``{s}``, or ``planner:NAME``; ``library`` : its folder;
    ``seconds``, ``grace`` : as in :class:`Limits`; ``valuing`` : seconds for the exact worst case of one plan and for
    one certificate; ``most_valued`` : answers of a run that are valued, the last ones and the first
    """

    command: str
    library: str
    seconds: float
    grace: float = 2.0
    valuing: float = 30.0
    most_valued: int = 40

    def __call__(self, study: Study, case: Case, seeds: Seeds) -> dict[str, Cell]:  # noqa: ARG002  (a study's measure)
        """One row: whatever the solver does, it costs only this row."""
        library = BenchmarkLibrary.load(self.library)
        name = str(dict(case.options)["instance"])
        instance = library.instance(name)
        with tempfile.TemporaryDirectory(prefix="ratt-opt-bench-") as place:
            folder = Path(place)
            (folder / INSTANCE_FILE).write_bytes(canonical(instance.document) + b"\n")
            out = folder / "out"
            out.mkdir()
            words = command_words(self.command, folder / INSTANCE_FILE, out, self.seconds)
            run = run_command(words, folder, Limits(seconds=self.seconds, grace=self.grace))
            output = read_output(instance, run)
            return self._row(instance, library.best.get(name), (run, output, out))

    def _row(self, instance: BenchmarkInstance, known: Best | None, ran: tuple[Run, Output, Path]) -> dict[str, Cell]:
        run, output, out = ran
        steps, faults = self._valued(instance, output)
        sign = 1.0 if instance.maximises else -1.0
        best = max(steps, key=lambda step: sign * step.value, default=None)
        value = None if best is None else best.value
        ends = [r.upper if instance.maximises else r.lower for r in output.reports]
        claims = [end for end in ends if end is not None]
        claimed = (min(claims) if instance.maximises else max(claims)) if claims else None
        proved, more = self._proved(instance, output, out)
        faults += more
        # An attained value refutes a bound that it passes.
        attained = [v for v in (value, None if known is None else known.value) if v is not None]
        if claimed is not None and any(sign * v > sign * claimed + _slack(v) for v in attained):
            faults.append(f"claims that nobody passes {claimed:.9g}, but {_best(attained, sign):.9g} is attained")
        reference = _best(attained, sign) if attained else None
        timed = [(step.at, 1.0 if reference is None else gap_of(step.value, reference)) for step in steps]
        return {
            "instance": instance.name,
            "class": instance.class_code,
            "value": _cell(value),
            "answer": "" if best is None else json.dumps(best.answer),
            "proved": _cell(proved),
            "claimed": _cell(claimed),
            "known value": _cell(None if known is None else known.value),
            "known bound": _cell(None if known is None or math.isinf(known.bound) else known.bound),
            "gap": 1.0 if value is None or reference is None else gap_of(value, reference),
            "integral": gap_integral(timed, self.seconds),
            "best at": _cell(None if best is None else best.at),
            "steps": json.dumps([[round(at, 4), gap] for at, gap in timed]),
            "faults": "; ".join([*output.faults, *faults]),
            "seconds": run.seconds,
            "processor": run.processor,
            "limit": self.seconds,
        }

    def _valued(self, instance: BenchmarkInstance, output: Output) -> tuple[list[_Valued], list[str]]:
        """Value the answers again; and the first false claim about one of them."""
        answered = [report for report in output.reports if report.answer is not None]
        if len(answered) > self.most_valued:
            answered = [answered[0], *answered[1 - self.most_valued :]]
        steps, faults, known = list[_Valued](), list[str](), dict[str, AnswerWorth]()
        for report in answered:
            assert report.answer is not None
            key = json.dumps(report.answer)
            if key not in known:
                known[key] = worth_of(instance, report.answer, self.valuing)
            worth = known[key]
            steps.append(_Valued(report.at, worth.lower if instance.maximises else worth.upper, report.answer))
            if not faults:
                faults += _false_value(instance, report, worth)
        return steps, faults

    def _proved(self, instance: BenchmarkInstance, output: Output, out: Path) -> tuple[float | None, list[str]]:
        """The end that the last certificate proves, and why it proves none."""
        named = [report.certificate for report in output.reports if report.certificate is not None]
        if not named:
            return None, []
        try:
            bound, _ = proved_bound(instance, read_document(out / named[-1]), seconds=self.valuing)
        except (InputError, ProofError, UndecidedError) as error:
            return None, [f"certificate {named[-1]}: {error}"]
        return bound, []


def command_words(command: str, instance: Path, out: Path, seconds: float) -> list[str]:
    """The words of a command with its holes filled.

    Raises
    ------
    InputError : it cannot be split into words, or does not name the instance.
    """
    own = command.startswith(("planner:", "attacker:", "cuts:"))
    text = (
        f"{shlex.quote(sys.executable)} -m ratt_opt.benchmark.runs.solvers {command} {{instance}} {{out}} --time {{s}}"
    )
    try:
        words = shlex.split(text if own else command)
    except ValueError as error:
        raise InputError("--solver", f"must be words as a shell splits them ({error})", command) from None
    if not any("{instance}" in word for word in words):
        raise InputError("--solver", "must hold {instance}, or be planner:NAME, attacker:NAME or cuts:NAME", command)
    filled = dict(zip(HOLES, (str(instance), str(out), f"{seconds:g}"), strict=True))
    for hole, text in filled.items():
        words = [word.replace(hole, text) for word in words]
    return words


def _false_value(instance: BenchmarkInstance, report: Report, worth: AnswerWorth) -> list[str]:
    """Name a claim about an answer's worth that is better than the truth."""
    claim = report.lower if instance.maximises else report.upper
    truth = worth.upper if instance.maximises else worth.lower
    if claim is None or (claim - truth if instance.maximises else truth - claim) <= _slack(truth):
        return []
    return [f"claims that its answer is worth {claim:.9g}, but it is worth {truth:.9g}"]


def _slack(value: float) -> float:
    """Rounding that nobody is blamed for."""
    return 1e-6 * max(abs(value), 1e-9)


def _best(values: list[float], sign: float) -> float:
    return max(values, key=lambda value: sign * value)


def _cell(value: float | None) -> Cell:
    return "" if value is None else float(value)
