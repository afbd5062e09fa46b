"""All entries of the ledger, in the paper's order."""

from __future__ import annotations

from itertools import chain
from typing import TYPE_CHECKING

from ratt_audit.appendix.entry import entries_of
from ratt_audit.appendix.patterns import pattern1_chains, pattern2_chains, submodular_chains
from ratt_audit.appendix.readings import dominance_entries, readings_of_sets, readings_of_the_attack
from ratt_audit.appendix.size_theorems import size_theorems
from ratt_audit.appendix.team_lines import team_lines
from ratt_audit.appendix.theorems import closing_lines, lemmas, theorems
from ratt_audit.enumeration.arrangement_claims import arrangement_entries, smallest_team_entries
from ratt_audit.enumeration.clean_witness import clean_witness_entries
from ratt_audit.enumeration.running_time import running_time_entries
from ratt_audit.enumeration.size_claims import size_entries
from ratt_audit.enumeration.tightness import tightness_entries

if TYPE_CHECKING:
    from collections.abc import Iterator

    from ratt_audit.appendix.entry import Entry

__all__ = ["all_entries"]


def all_entries() -> Iterator[Entry]:
    """Yield every entry in the paper's order: readings, Pattern 1, Pattern 2, closing lines, the rest."""
    yield from readings_of_the_attack()
    for one in (*pattern1_chains(), *pattern2_chains(), *submodular_chains()):
        yield from entries_of(one)
    yield from chain(readings_of_sets(), team_lines(), closing_lines(), dominance_entries())
    yield from chain(theorems(), size_theorems(), lemmas())
    yield from chain(arrangement_entries(), smallest_team_entries(), size_entries(), clean_witness_entries())
    yield from chain(tightness_entries(), running_time_entries())
