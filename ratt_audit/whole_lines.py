"""Refuted lines of the appendix among whole instances: searched, or re-checked from an earlier search."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ratt_audit.appendix.entry import ClaimEntry, EntryKind
from ratt_audit.appendix.readings import LEFT_SIDE
from ratt_audit.engine.decide import Verdict, decide
from ratt_audit.entries import all_entries
from ratt_audit.report.records import whole_record
from ratt_audit.whole.recorded import recorded_decisions
from ratt_audit.whole.search import WholeSearch, smallest_instance
from ratt_opt.errors import InputError

if TYPE_CHECKING:
    from collections.abc import Sequence

    from ratt_audit.appendix.entry import Entry
    from ratt_audit.appendix.roles import Side, SizedClaim
    from ratt_audit.report.records import EntryRecord, WholeRecord
    from ratt_audit.whole.replay import WholeInstance

__all__ = ["decide_whole_line", "refuted_lines", "whole_instance"]


def refuted_lines(entries: Sequence[Entry], records: Sequence[EntryRecord]) -> dict[tuple[str, str], list[ClaimEntry]]:
    """Refuted lines about a plan and an attack, by label and kind, of the entries that have records; with readings."""
    kinds = (EntryKind.STEP, EntryKind.AS_WRITTEN)
    lines: dict[tuple[str, str], list[ClaimEntry]] = {}
    for entry, record in zip(entries, records, strict=False):
        is_line = entry.kind in kinds or entry.label == LEFT_SIDE
        if isinstance(entry, ClaimEntry) and is_line and record["verdict"] == Verdict.REFUTED.value:
            lines.setdefault((entry.label, entry.kind.value), []).append(entry)
    return lines


def decide_whole_line(
    readings: Sequence[ClaimEntry], worst_for: Side, search: WholeSearch, *, searches: bool
) -> WholeRecord:
    """Decide one refuted line among whole instances in which A* is a worst attack on the plan of ``worst_for``.

    ``searches`` : else an earlier search's decision is re-checked, if there is one.
    """
    first, cases, known = readings[0], _broken(readings), None
    if not searches:
        known = recorded_decisions(
            first.label, first.kind.value, first.chain, cases, worst_for=worst_for, search=search
        )
    if known is None:
        known = smallest_instance(first.chain, cases, worst_for, search)
    return whole_record(first, worst_for.value, known)


def whole_instance(label: str, worst_for: Side, *, kind: EntryKind = EntryKind.STEP) -> WholeInstance:
    """Return the smallest known whole instance on which a line of the appendix fails, re-checked.

    ``label`` : the paper's, such as ``nd_p1d2v1_8``; ``worst_for`` : whose worst attack A* is.

    Raises
    ------
    InputError : none is known.
    """
    readings = [e for e in all_entries() if isinstance(e, ClaimEntry) and (e.label, e.kind) == (label, kind)]
    known = None
    if readings:
        chain_of = readings[0].chain
        known = recorded_decisions(
            label, kind.value, chain_of, _broken(readings), worst_for=worst_for, search=WholeSearch()
        )
    found = known[-1].instance if known else None
    if found is None:
        raise InputError("label", "must be of a line with a known whole instance", label)
    return found


def _broken(readings: Sequence[ClaimEntry]) -> tuple[SizedClaim, ...]:
    """Sizes of a line that are refuted, once each."""
    sizes = (sized for entry in readings for sized in entry.claims)
    broken = (sized for sized in sizes if decide(sized.claim).verdict is Verdict.REFUTED)
    return tuple({(sized.team, sized.attacked, sized.claim.conclusion): sized for sized in broken}.values())
