"""Decide one entry: its verdict, the evidence for each of its claims, and what is left where it is refuted."""

from __future__ import annotations

import time
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np

from ratt_opt.audit.appendix.entry import ClaimEntry, EntryKind, EnumeratedEntry
from ratt_opt.audit.engine.best_factor import best_factors
from ratt_opt.audit.engine.decide import Verdict, decide
from ratt_opt.audit.real_objectives.search import search_real_objectives
from ratt_opt.problem import Problem
from ratt_opt.solvers.ratt import bait_and_greedy

if TYPE_CHECKING:
    from collections.abc import Iterator

    from ratt_opt.audit.appendix.entry import Counted, Detour, Entry, SizedClaim
    from ratt_opt.audit.appendix.roles import Team
    from ratt_opt.audit.engine.best_factor import BestFactor
    from ratt_opt.audit.engine.counterexample import Witness
    from ratt_opt.audit.engine.decide import Decision
    from ratt_opt.audit.real_objectives.search import RealSearch

__all__ = ["DecidedClaim", "DecidedEntry", "Remains", "decide_one", "ratt_chooses_the_roles"]

QUICK_ROBOTS = 3


@dataclass(frozen=True, slots=True)
class DecidedClaim:
    """One size of an entry with its decision.

    ``chooses_roles`` : whether RATT itself, run on the counterexample, picks the elements that the claim calls its
    own; ``None`` without a counterexample or without roles.
    """

    sized: SizedClaim
    decision: Decision
    chooses_roles: bool | None


@dataclass(frozen=True, slots=True, kw_only=True)
class Remains:
    """What was looked for beyond the verdict.

    ``factors`` : best factors of the refuted claims, at each curvature
    ``real`` : what trying the claims on EKF objectives found; ``None`` where they cannot be cast
    ``follows_from`` : the latest earlier line that proves a refuted one directly; ``None`` where none does
    ``has_detours`` : whether earlier lines were tried
    """

    factors: tuple[BestFactor, ...]
    real: RealSearch | None
    follows_from: str | None
    has_detours: bool


@dataclass(frozen=True, slots=True, kw_only=True)
class DecidedEntry:
    """An entry with its verdict: by its claims and what remains of them, or by an enumeration."""

    entry: Entry
    verdict: Verdict
    claims: tuple[DecidedClaim, ...] = field(default=(), repr=False)
    remains: Remains | None = field(default=None, repr=False)
    counted: Counted | None = None
    seconds: float


def decide_one(entry: Entry, *, quick: bool = False) -> DecidedEntry:
    """Decide one entry.

    ``quick`` keeps the sizes with at most three robots, else the smallest size, and one case of more than four robots;
    it leaves out best factors and the search on EKF objectives.
    """
    start = time.perf_counter()
    if isinstance(entry, EnumeratedEntry):
        counted = entry.enumerate_cases()
        seconds = time.perf_counter() - start
        return DecidedEntry(entry=entry, verdict=counted.verdict, counted=counted, seconds=seconds)
    assert isinstance(entry, ClaimEntry)
    claims = tuple(_decided(sized) for sized in (_quick_claims(entry) if quick else entry.claims))
    return DecidedEntry(
        entry=entry,
        verdict=_verdict(claims),
        claims=claims,
        remains=None if quick else _remains(entry, claims),
        seconds=time.perf_counter() - start,
    )


def _quick_claims(entry: ClaimEntry) -> tuple[SizedClaim, ...]:
    smallest = min(sized.robots for sized in entry.claims)
    claims = tuple(sized for sized in entry.claims if sized.robots <= max(QUICK_ROBOTS, smallest))
    return claims[:1] if smallest > QUICK_ROBOTS + 1 else claims


def _decided(sized: SizedClaim) -> DecidedClaim:
    decision, team = decide(sized.claim), sized.team
    if decision.witness is None or team is None:
        return DecidedClaim(sized, decision, None)
    return DecidedClaim(sized, decision, ratt_chooses_the_roles(team, decision.witness))


def ratt_chooses_the_roles(team: Team, witness: Witness) -> bool:
    """Run RATT's bait and greedy rules on the witness: are its choices the elements named as such?"""
    problem = Problem(witness.function(), np.array(team.ground.owner), None, 0, 0)
    plan = bait_and_greedy(problem, len(team.bait))
    return bool((plan.elements == np.arange(len(team.robots))).all())


def _verdict(claims: tuple[DecidedClaim, ...]) -> Verdict:
    """One refuted size refutes; all sizes must be proved to prove."""
    found = {claim.decision.verdict for claim in claims}
    order = (Verdict.REFUTED, Verdict.UNDECIDED, Verdict.NO_VIOLATION)
    return next((verdict for verdict in order if verdict in found), Verdict.PROVED)


def _remains(entry: ClaimEntry, claims: tuple[DecidedClaim, ...]) -> Remains:
    broken = [decided.sized.claim for decided in claims if decided.decision.witness is not None]
    has_detours = bool(broken) and entry.detours is not None
    return Remains(
        factors=() if entry.kind is EntryKind.AS_WRITTEN else best_factors(broken),
        real=search_real_objectives(entry.claims, refuted=bool(broken)),
        follows_from=_latest(entry.detours()) if broken and entry.detours is not None else None,
        has_detours=has_detours,
    )


def _latest(detours: Iterator[Detour]) -> str | None:
    """The latest earlier line from which the refuted one is proved directly, at every size."""
    for detour in detours:
        if all(decide(sized.claim).verdict is Verdict.PROVED for sized in detour.claims):
            return detour.start
    return None
