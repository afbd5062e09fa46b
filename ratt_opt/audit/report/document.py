"""The JSON data of ``audit.json``, typed: what pages and tables may ask of a ledger, also of one read from disk."""

from __future__ import annotations

from typing import Any, NotRequired, TypedDict

__all__ = [
    "ClaimRecord",
    "EntryHead",
    "EntryRecord",
    "FactorRecord",
    "LedgerDocument",
    "OtherEntry",
    "ProofRecord",
    "RealRecord",
    "WitnessRecord",
    "WorstRecord",
]


class ProofRecord(TypedDict):
    """A proof; a step is [multiplier, reason, inequality], and the steps sum to the claim.

    ``curvature`` : the one value it holds for, ``None`` for all; ``curvature_domain`` : feasible sets or all sets.
    """

    curvature: str | None
    curvature_domain: str
    steps: list[list[str]]


class WitnessRecord(TypedDict):
    """A function that breaks a claim: its values on all subsets, by bit mask over ``elements``.

    ``ratt_chooses_the_roles`` : whether RATT itself, run on the function with this many baits,
    picks the elements named as its choices (``None`` where the elements have no roles).
    """

    elements: list[str]
    robot: list[int]
    values: list[int]
    values_in_play: dict[str, int]
    auxiliary: dict[str, str]
    curvature: str | None
    violation: str
    premises: list[str]
    ratt_chooses_the_roles: bool | None


class ClaimRecord(TypedDict):
    """One size of an entry with its proof or counterexample."""

    size: str
    robots: int
    claim: str
    premises: int
    verdict: str
    scope: str
    proofs: list[ProofRecord]
    witness: WitnessRecord | None


FactorRecord = TypedDict(
    "FactorRecord", {"curvature": "str | None", "factor": "str", "cannot_exceed_by_1/1000": "bool"}
)
"""Best factor of a refuted step at one curvature."""


class WorstRecord(TypedDict):
    """The worst EKF instance, complete: the scenario file's content, the roles, and the sign of the violation."""

    origin: str
    claim: str
    relative_violation: float
    violated_exactly: bool
    elements: dict[str, int]
    scenario: dict[str, Any]


class RealRecord(TypedDict):
    """What trying an entry on EKF objectives found."""

    objective: str
    section_vi_instances: int
    section_vi_violations: int
    worst: WorstRecord | None


class OtherEntry(TypedDict):
    """Another entry, ``label/kind`` or ``label/kind/reading``, and its verdict (``None`` where readings differ)."""

    entry: str
    verdict: str | None


class EntryHead(TypedDict):
    """What an entry states, and how it was decided."""

    label: str
    kind: str
    chain: str
    reading: str
    statement: str
    hypotheses: str
    decided_by: str
    verdict: str


class EntryRecord(EntryHead):
    """One entry with its evidence.

    ``detail``, ``counterexamples`` : of entries decided by enumeration; ``function_class``, ``curvature`` : of the
    others, and, where they were looked for, ``best_factors``, ``realistic`` and ``follows_from``.
    """

    sizes: str
    claims: list[ClaimRecord]
    seconds: float
    detail: NotRequired[str]
    counterexamples: NotRequired[list[str]]
    function_class: NotRequired[str]
    curvature: NotRequired[list[str]]
    best_factors: NotRequired[list[FactorRecord]]
    realistic: NotRequired[RealRecord | None]
    follows_from: NotRequired[str | None]
    conclusion_without_it: NotRequired[OtherEntry]
    weaker_step_that_serves: NotRequired[OtherEntry]


class LedgerDocument(TypedDict):
    """The whole file."""

    format: str
    complete: bool
    quick: bool
    curvature_grid: list[str]
    counts: dict[str, int]
    seconds: float
    entries: list[EntryRecord]
