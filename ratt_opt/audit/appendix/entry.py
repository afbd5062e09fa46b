"""Entries of the ledger: what the paper says at one label, and how to decide it."""

from __future__ import annotations

from dataclasses import dataclass, field
from enum import StrEnum
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from ratt_opt.audit.appendix.roles import Team
    from ratt_opt.audit.engine.claim import Claim
    from ratt_opt.audit.engine.decide import Verdict

__all__ = ["ClaimEntry", "Counted", "Detour", "Entry", "EntryKind", "EnumeratedEntry", "Reference", "SizedClaim"]


class EntryKind(StrEnum):
    """In which sense a statement is decided; the texts are those of the ledger."""

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
class Reference:
    """Another entry: one reading of it, or all of them (``None``)."""

    label: str
    kind: EntryKind
    reading: str | None = None

    def __str__(self) -> str:
        return "/".join(part for part in (self.label, self.kind, self.reading) if part is not None)

    @staticmethod
    def parse(text: str) -> Reference:
        """Read what ``str`` writes."""
        label, kind, *reading = text.split("/", 2)
        return Reference(label, EntryKind(kind), *reading)


@dataclass(frozen=True, slots=True, kw_only=True)
class SizedClaim:
    """One linear claim of an entry: a size and who is attacked in words, robots in play, the question.

    ``team`` : the roles, where the elements have any.
    """

    size: str
    robots: int
    claim: Claim
    team: Team | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class Entry:
    """A statement of the paper (or ours).

    ``label`` : the paper's without ``eq:``; ours where it has none.
    ``reading`` : in which sense the text is read, where it admits several.
    ``survives_by`` : the entry that shows the conclusion without this step.
    ``serves_by`` : the entry of a weaker statement that the proof could use in its place.
    """

    label: str
    kind: EntryKind
    chain: str
    statement: str
    hypotheses: str
    reading: str = ""
    survives_by: Reference | None = None
    serves_by: Reference | None = None

    @property
    def names(self) -> tuple[Reference, Reference]:
        """The two references that mean this entry: with all its readings, and alone."""
        return Reference(self.label, self.kind), Reference(self.label, self.kind, self.reading)


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
