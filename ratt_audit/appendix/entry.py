"""Entries of the ledger: what the paper says at one label, and how to decide it.

A chain of (in)equalities gives three entries a line: as a step, as written, and from the chain's start.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from enum import StrEnum
from functools import partial
from typing import TYPE_CHECKING

from ratt_audit.appendix.roles import SizedClaim
from ratt_audit.engine.polynomials import ONE, Polynomial

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from ratt_audit.appendix.roles import Robots, Team
    from ratt_audit.engine.claim import Inequality, Linear
    from ratt_audit.engine.decide import Verdict
    from ratt_opt.worst_ratio.function_class import FunctionClass

__all__ = ["Case", "Chain", "ClaimEntry", "Counted", "Detour", "Entry", "EntryKind", "EntryName", "EnumeratedEntry",
           "Line", "entries_of"]  # fmt: skip


class EntryKind(StrEnum):
    """Sense in which a statement is decided; the texts are those of the ledger."""

    STEP = "step"
    """A line from the line before it."""
    AS_WRITTEN = "step as equality"
    """A line that the paper writes with ``=``, in both directions."""
    CUMULATIVE = "cumulative"
    """A line from the start of its chain."""
    LEMMA = "lemma"
    CLAIM = "claim"
    THEOREM = "theorem"
    MEASUREMENT = "measurement"


@dataclass(frozen=True, slots=True)
class EntryName:
    """Reference to another entry: one reading of it, or all of them (``None``)."""

    label: str
    kind: EntryKind
    reading: str | None = None

    def __str__(self) -> str:
        return "/".join(part for part in (self.label, self.kind, self.reading) if part is not None)

    @staticmethod
    def parse(text: str) -> EntryName:
        """Read what ``str`` writes."""
        label, kind, *reading = text.split("/", 2)
        return EntryName(label, EntryKind(kind), *reading)


@dataclass(frozen=True, slots=True, kw_only=True)
class Entry:
    """A statement of the paper (or ours).

    ``label`` : the paper's without ``eq:``; ours if it has none.
    ``reading`` : in which sense the text is read, if it admits several.
    ``survives_by`` : the entry that shows the conclusion without this step.
    ``serves_by`` : the entry of a weaker statement that the proof could use in its place.
    """

    label: str
    kind: EntryKind
    chain: str
    statement: str
    hypotheses: str
    reading: str = ""
    survives_by: EntryName | None = None
    serves_by: EntryName | None = None

    @property
    def names(self) -> tuple[EntryName, EntryName]:
        """The two references that mean this entry: with all its readings, and alone."""
        return EntryName(self.label, self.kind), EntryName(self.label, self.kind, self.reading)


@dataclass(frozen=True, slots=True, kw_only=True)
class ClaimEntry(Entry):
    """An entry decided by the cone, size by size.

    ``detours`` : the same line from earlier ones, the latest first.
    """

    claims: tuple[SizedClaim, ...] = field(repr=False)
    detours: Callable[[], Iterator[Detour]] | None = field(default=None, repr=False)


@dataclass(frozen=True, slots=True)
class Detour:
    """The claims that lead from line ``start`` of a chain directly to a later one."""

    start: str
    claims: tuple[SizedClaim, ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class Counted:
    """Outcome of an enumeration or search: the verdict, what was tried, and the explicit cases found."""

    verdict: Verdict
    sizes: str
    detail: str
    cases: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True, kw_only=True)
class EnumeratedEntry(Entry):
    """An entry about sizes, groups or counts, decided by running ``enumerate_cases``."""

    enumerate_cases: Callable[[], Counted] = field(repr=False)


STEP, AS_WRITTEN, CUMULATIVE = EntryKind.STEP, EntryKind.AS_WRITTEN, EntryKind.CUMULATIVE


@dataclass(frozen=True, slots=True)
class Line:
    """One line of a chain: ``previous (relation) expression / denominator``.

    ``readings`` : name -> extra premises, if the text admits several.
    ``as_written`` : the same for a printed ``=``, if its readings differ from those of the step.
    ``cited`` : the only premises the stated reason uses, if they are fewer than all roles. The step itself is
    judged with all of RATT's choices, as every line is.
    """

    relation: str
    expression: Linear
    statement: str
    denominator: Polynomial = ONE
    readings: dict[str, tuple[Inequality, ...]] = field(default_factory=dict, kw_only=True)
    as_written: dict[str, tuple[Inequality, ...]] = field(default_factory=dict, kw_only=True)
    cited: tuple[Inequality, ...] | None = field(default=None, kw_only=True)


@dataclass(frozen=True, slots=True, kw_only=True)
class Case:
    """One size of a chain: the roles, its first line, its lines, what holds beside the roles, who is blinded."""

    size: str
    team: Team
    start: Linear
    lines: tuple[Line, ...]
    given: tuple[Inequality, ...] = ()
    attacked: Robots = ()


@dataclass(frozen=True, slots=True)
class Chain:
    """A chain of (in)equalities, given at several sizes with the same lines, smallest first."""

    name: str
    function_class: FunctionClass
    cases: tuple[Case, ...]

    @property
    def lines(self) -> tuple[Line, ...]:
        """The lines at the smallest size: relations, statements and readings are the same at all."""
        return self.cases[0].lines

    def label(self, number: int) -> str:
        """The paper's label of a line, counted from 0 (from the end if negative)."""
        return self.name if len(self.lines) == 1 else f"{self.name}_{number % len(self.lines) + 1}"


def entries_of(chain: Chain) -> Iterator[ClaimEntry]:
    """Yield the entries of a chain, line by line: step, step as equality (if written ``=``), cumulative.

    A stated reason that uses less than RATT's choices is an entry of its own, a claim.
    """
    for number, line in enumerate(chain.lines):
        for reading in line.readings or ("",):
            yield _entry(chain, number, STEP, reading)
            if line.cited is not None:
                yield _entry(chain, number, EntryKind.CLAIM, reading)
            if line.relation == "=":
                for equality in line.as_written or (reading,):
                    yield _entry(chain, number, AS_WRITTEN, equality)
            yield _entry(chain, number, CUMULATIVE, reading)


def _entry(chain: Chain, number: int, kind: EntryKind, reading: str) -> ClaimEntry:
    line, label, is_whole = chain.lines[number], chain.label(number), kind is CUMULATIVE
    origin = "the start of its chain" if is_whole else "the line before" if number else "the left-hand side"
    submodular = "submodular, curvature <= k" if chain.function_class.is_submodular else "total curvature <= c"
    hypotheses = f"f normalised, non-decreasing, {submodular}; baits and greedy robots as RATT chooses them"
    if line.cited is not None and kind is EntryKind.CLAIM:
        hypotheses = f"only what the stated reason uses: {'; '.join(premise.reason for premise in line.cited)}"
    return ClaimEntry(
        label=label,
        kind=kind,
        chain=chain.name,
        statement=f"from {origin}: {'=' if kind is AS_WRITTEN else '>='} {line.statement}",
        hypotheses=hypotheses,
        claims=tuple(claim for case in chain.cases for claim in _claims(chain, case, number, kind, reading)),
        reading=reading,
        survives_by=None if is_whole else EntryName(chain.label(-1), CUMULATIVE),
        serves_by=_serves_by(label, kind, reading),
        detours=partial(_detours, chain, number, reading) if kind is STEP and number > 1 else None,
    )


def _serves_by(label: str, kind: EntryKind, reading: str) -> EntryName | None:
    """A paper's "=" may serve as ">="; a reason with too few premises follows from all of RATT's choices."""
    if kind is AS_WRITTEN:
        return EntryName(label, STEP)
    return EntryName(label, STEP, reading) if kind is EntryKind.CLAIM else None


def _detours(chain: Chain, number: int, reading: str) -> Iterator[Detour]:
    """Yield the line from each earlier line but the one before, latest first, with all of RATT's choices given."""
    for start in range(number - 2, -1, -1):
        both = (_both_ways(chain, case, case.lines[start], case.lines[number], reading) for case in chain.cases)
        yield Detour(chain.label(start), tuple(there for there, _ in both))


def _claims(chain: Chain, case: Case, number: int, kind: EntryKind, reading: str) -> tuple[SizedClaim, ...]:
    line, before = case.lines[number], Line("", case.start, "")
    if kind is not CUMULATIVE and number:
        before = case.lines[number - 1]
    both = _both_ways(chain, case, before, line, reading, cited=line.cited if kind is EntryKind.CLAIM else None)
    return both if kind is AS_WRITTEN else both[:1]


def _both_ways(
    chain: Chain, case: Case, before: Line, line: Line, reading: str, *, cited: tuple[Inequality, ...] | None = None
) -> tuple[SizedClaim, SizedClaim]:
    """``before >= line`` and the reverse, from all of RATT's choices unless the premises are cited."""
    team, robots = case.team, len(case.team.robots)
    named = line.readings | line.as_written
    premises = (team.premises if cited is None else cited) + case.given + named.get(reading, ())
    left, right = before.expression * line.denominator, line.expression * before.denominator
    there = team.comparison(chain.function_class, left, right, premises)
    back = team.comparison(chain.function_class, right, left, premises)
    first = SizedClaim(size=case.size, robots=robots, claim=there, team=team, attacked=case.attacked)
    return first, replace(first, claim=back)
