"""Chains of (in)equalities, and their ledger entries: every line as a step, as written, and from the chain's start."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import partial
from typing import TYPE_CHECKING

from ratt_opt.audit.appendix.entry import ClaimEntry, Detour, EntryKind, Reference, SizedClaim
from ratt_opt.audit.engine.polynomial import ONE, Polynomial

if TYPE_CHECKING:
    from collections.abc import Iterator

    from ratt_opt.audit.appendix.roles import Team
    from ratt_opt.audit.engine.claim import FunctionClass, Inequality, Linear

__all__ = ["Case", "Chain", "Line", "entries_of"]

STEP, AS_WRITTEN, CUMULATIVE = EntryKind.STEP, EntryKind.AS_WRITTEN, EntryKind.CUMULATIVE


@dataclass(frozen=True, slots=True)
class Line:
    """One line of a chain: ``previous (relation) expression / denominator``.

    ``readings`` : name -> extra premises, where the text admits several.
    ``cited`` : the only premises the stated reason uses, where they are fewer than all roles.
    """

    relation: str
    expression: Linear
    statement: str
    denominator: Polynomial = ONE
    readings: dict[str, tuple[Inequality, ...]] = field(default_factory=dict, kw_only=True)
    cited: tuple[Inequality, ...] | None = field(default=None, kw_only=True)


@dataclass(frozen=True, slots=True, kw_only=True)
class Case:
    """One size of a chain in words: the roles, where the chain starts, its lines, and what holds beside the roles."""

    size: str
    team: Team
    start: Linear
    lines: tuple[Line, ...]
    given: tuple[Inequality, ...] = ()


@dataclass(frozen=True, slots=True, kw_only=True)
class Chain:
    """A chain of (in)equalities, given at several sizes with the same lines, smallest first."""

    name: str
    function_class: FunctionClass
    hypotheses: str
    cases: tuple[Case, ...]

    @property
    def lines(self) -> tuple[Line, ...]:
        """The lines at the smallest size: relations, statements and readings are the same at all."""
        return self.cases[0].lines

    def label(self, number: int) -> str:
        """The paper's label of a line, counted from 0 (from the end where negative)."""
        return self.name if len(self.lines) == 1 else f"{self.name}_{number % len(self.lines) + 1}"


def entries_of(chain: Chain) -> Iterator[ClaimEntry]:
    """Yield the entries of a chain, line by line: step, step as equality (where written ``=``), cumulative."""
    for number, line in enumerate(chain.lines):
        for reading in line.readings or ("",):
            yield _entry(chain, number, STEP, reading)
            if line.relation == "=":
                yield _entry(chain, number, AS_WRITTEN, reading)
            yield _entry(chain, number, CUMULATIVE, reading)


def _entry(chain: Chain, number: int, kind: EntryKind, reading: str) -> ClaimEntry:
    line, label, is_whole = chain.lines[number], chain.label(number), kind is CUMULATIVE
    origin = "the start of its chain" if is_whole else "the line before" if number else "the left-hand side"
    hypotheses = chain.hypotheses
    if line.cited is not None and not is_whole:
        hypotheses = f"only what the stated reason uses: {'; '.join(premise.reason for premise in line.cited)}"
    return ClaimEntry(
        label=label,
        kind=kind,
        chain=chain.name,
        statement=f"from {origin}: {'=' if kind is AS_WRITTEN else '>='} {line.statement}",
        hypotheses=hypotheses,
        claims=tuple(claim for case in chain.cases for claim in _claims(chain, case, number, kind, reading)),
        reading=reading,
        survives_by=None if is_whole else Reference(chain.label(-1), CUMULATIVE),
        serves_by=_serves_by(line, label, kind, reading),
        detours=partial(_detours, chain, number, reading) if kind is STEP and number > 1 else None,
    )


def _serves_by(line: Line, label: str, kind: EntryKind, reading: str) -> Reference | None:
    """A paper's "=" may serve as ">="; a line with too few premises follows from all of RATT's choices."""
    if kind is AS_WRITTEN:
        return Reference(label, STEP)
    return Reference(label, CUMULATIVE, reading) if kind is STEP and line.cited is not None else None


def _detours(chain: Chain, number: int, reading: str) -> Iterator[Detour]:
    """Yield the line from each earlier line but the one before, latest first, with all of RATT's choices given."""
    for start in range(number - 2, -1, -1):
        claims = []
        for case in chain.cases:
            before, line = case.lines[start], case.lines[number]
            premises = case.team.premises + case.given + line.readings.get(reading, ())
            left, right = before.expression * line.denominator, line.expression * before.denominator
            claims.append(_sized(chain.function_class, case, premises, left, right))
        yield Detour(chain.label(start), tuple(claims))


def _claims(chain: Chain, case: Case, number: int, kind: EntryKind, reading: str) -> Iterator[SizedClaim]:
    line, before = case.lines[number], Line("", case.start, "")
    if kind is not CUMULATIVE and number:
        before = case.lines[number - 1]
    roles = case.team.premises if kind is CUMULATIVE or line.cited is None else line.cited
    premises = roles + case.given + line.readings.get(reading, ())
    left, right = before.expression * line.denominator, line.expression * before.denominator
    yield _sized(chain.function_class, case, premises, left, right)
    if kind is AS_WRITTEN:
        yield _sized(chain.function_class, case, premises, right, left)


def _sized(
    function_class: FunctionClass, case: Case, premises: tuple[Inequality, ...], left: Linear, right: Linear
) -> SizedClaim:
    claim = case.team.comparison(function_class, left, right, premises)
    return SizedClaim(size=case.size, robots=len(case.team.robots), claim=claim, team=case.team)
