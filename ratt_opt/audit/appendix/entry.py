"""Entries of the ledger: what the paper says at one label, and how to decide it."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from ratt_opt.audit.engine.polynomial import ONE, Polynomial

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from ratt_opt.audit.appendix.roles import Team
    from ratt_opt.audit.engine.claim import Claim, FunctionClass, Inequality, Linear
    from ratt_opt.audit.engine.decide import Verdict

__all__ = ["Case", "Chain", "Counted", "Detour", "Entry", "EnumeratedEntry", "Line", "SizedClaim"]


@dataclass(frozen=True, slots=True, kw_only=True)
class SizedClaim:
    """One linear claim of an entry: a size, who is attacked, and the question.

    ``left``, ``right`` : the two sides of ``left >= right`` where a best factor makes sense.
    ``team`` : the roles, where the elements have any.
    """

    size: str
    robots: int
    claim: Claim
    left: Linear | None = None
    right: Linear | None = None
    team: Team | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class Entry:
    """A statement of the paper (or ours) decided by the cone, size by size.

    ``label`` : the paper's without ``eq:``; ours where it has none.
    ``kind`` : ``step``, ``step as equality``, ``cumulative``, ``lemma``, ``reading``, ``claim`` or ``theorem``.
    ``survives_by`` : the entry (label/kind or label/kind/reading) that shows the conclusion without this step.
    ``serves_by`` : the entry of a weaker statement that the proof could use in its place.
    ``detours`` : the same line from earlier ones: (label, claims), the latest first.
    """

    label: str
    kind: str
    chain: str
    statement: str
    hypotheses: str
    claims: tuple[SizedClaim, ...]
    reading: str = ""
    survives_by: str = ""
    serves_by: str = ""
    detours: Callable[[], Iterator[Detour]] | None = None


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
class EnumeratedEntry:
    """A statement about sizes, groups or counts, decided by running ``enumerate_cases``."""

    label: str
    kind: str
    chain: str
    statement: str
    hypotheses: str
    enumerate_cases: Callable[[], Counted]
    reading: str = ""
    survives_by: str = ""
    serves_by: str = ""


@dataclass(frozen=True, slots=True, kw_only=True)
class Line:
    """One numbered line of a chain: ``previous (relation) expression / denominator``.

    ``readings`` : name -> extra premises, where the text admits several.
    ``cited`` : the only premises the stated reason uses, where they are fewer than all roles.
    """

    label: str
    relation: str
    expression: Linear
    statement: str
    denominator: Polynomial = ONE
    readings: dict[str, tuple[Inequality, ...]] = field(default_factory=dict)
    cited: tuple[Inequality, ...] | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class Case:
    """One size of a chain: the roles, who is attacked, where the chain starts, and its lines."""

    size: str
    team: Team
    start: Linear
    lines: tuple[Line, ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class Chain:
    """A chain of (in)equalities, given at several sizes with the same lines, smallest first."""

    name: str
    kind: FunctionClass
    hypotheses: str
    cases: tuple[Case, ...]
