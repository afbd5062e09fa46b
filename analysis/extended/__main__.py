"""The extended study: ``python -m analysis.extended --trials T --out DIR``."""

from __future__ import annotations

import sys

from analysis.extended import budgets, exact_attack
from analysis.extended.claims import write_claims
from analysis.extended.comparisons import STUDIES
from ratt_opt.studies.command import Entry, main

if __name__ == "__main__":
    ENTRIES = [exact_attack.ENTRY, budgets.ENTRY, *map(Entry, STUDIES)]
    sys.exit(main("What the paper could not show.", ENTRIES, trials=200, after=write_claims))
