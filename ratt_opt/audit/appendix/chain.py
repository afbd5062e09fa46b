"""From a chain to ledger entries: every line as a step, as written, and from the chain's start."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING

from ratt_opt.audit.appendix.entry import Case, Chain, Detour, Entry, Line, SizedClaim
from ratt_opt.audit.engine.claim import Claim, FunctionClass, Inequality, Linear
from ratt_opt.audit.engine.polynomial import ONE

if TYPE_CHECKING:
    from collections.abc import Iterator

__all__ = ["AS_WRITTEN", "entries_of"]

AS_WRITTEN = "step as equality"


def entries_of(chain: Chain) -> Iterator[Entry]:
    """Yield the entries of a chain, line by line: step, step as equality (where written ``=``), cumulative."""
    for number, line in enumerate(chain.cases[0].lines):
        readings = list(line.readings) or [""]
        for reading in readings:
            yield _entry(chain, number, "step", reading)
            if line.relation == "=":
                yield _entry(chain, number, AS_WRITTEN, reading)
            yield _entry(chain, number, "cumulative", reading)


def _entry(chain: Chain, number: int, kind: str, reading: str) -> Entry:
    line = chain.cases[0].lines[number]
    last = chain.cases[0].lines[-1].label
    claims = tuple(claim for case in chain.cases for claim in _claims(chain.kind, case, number, kind, reading))
    origin = (
        "the start of its chain" if kind == "cumulative" else ("the line before" if number else "the left-hand side")
    )
    relation = "=" if kind == AS_WRITTEN else ">="
    return Entry(
        label=line.label,
        kind=kind,
        chain=chain.name,
        statement=f"from {origin}: {relation} {line.statement}",
        hypotheses=_hypotheses(chain, line, kind),
        claims=claims,
        reading=reading,
        survives_by="" if kind == "cumulative" else f"{last}/cumulative",
        serves_by=_serves_by(line, kind, reading),
        detours=partial(_detours, chain, number, reading) if kind == "step" and number > 1 else None,
    )


def _hypotheses(chain: Chain, line: Line, kind: str) -> str:
    if kind == "cumulative" or line.cited is None:
        return chain.hypotheses
    return f"only what the stated reason uses: {'; '.join(premise.reason for premise in line.cited)}"


def _serves_by(line: Line, kind: str, reading: str) -> str:
    """A paper's "=" may serve as ">="; a line with too few premises follows from all of RATT's choices."""
    if kind == AS_WRITTEN:
        return f"{line.label}/step"
    return f"{line.label}/cumulative/{reading}" if kind == "step" and line.cited is not None else ""


def _detours(chain: Chain, number: int, reading: str) -> Iterator[Detour]:
    """Yield the line from each earlier line but the one before, latest first, with all of RATT's choices given."""
    for start in range(number - 2, -1, -1):
        claims = []
        for case in chain.cases:
            before, line = case.lines[start], case.lines[number]
            premises = case.team.premises + line.readings.get(reading, ())
            left, right = before.expression * line.denominator, line.expression * before.denominator
            claims.append(_sized(chain.kind, case, premises, left, right))
        yield Detour(chain.cases[0].lines[start].label, tuple(claims))


def _claims(kind: FunctionClass, case: Case, number: int, form: str, reading: str) -> Iterator[SizedClaim]:
    line = case.lines[number]
    if form == "cumulative" or number == 0:
        left, left_denominator = case.start, ONE
    else:
        left, left_denominator = case.lines[number - 1].expression, case.lines[number - 1].denominator
    extra = line.readings.get(reading, ())
    premises = case.team.premises if form == "cumulative" or line.cited is None else line.cited
    first, second = left * line.denominator, line.expression * left_denominator
    yield _sized(kind, case, premises + extra, first, second)
    if form == AS_WRITTEN:
        yield _sized(kind, case, premises + extra, second, first)


def _sized(
    kind: FunctionClass, case: Case, premises: tuple[Inequality, ...], left: Linear, right: Linear
) -> SizedClaim:
    claim = Claim(kind=kind, ground=case.team.ground, premises=premises, conclusion=(left - right).reduced())
    return SizedClaim(size=case.size, robots=len(case.team.robots), claim=claim, left=left, right=right, team=case.team)
