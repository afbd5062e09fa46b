"""The extended study: ``python -m analysis.extended --trials T --out DIR``."""

from __future__ import annotations

import sys

from analysis.extended import budgets, exact_attack, graphs, guarantees, objectives, sensitivity
from analysis.extended.claims import write_claims
from ratt_opt.studies.command import main

if __name__ == "__main__":
    ENTRIES = [exact_attack.ENTRY, guarantees.ENTRY, objectives.ENTRY, graphs.ENTRY, budgets.ENTRY, sensitivity.ENTRY]
    sys.exit(main("What the paper could not show.", ENTRIES, trials=200, after=write_claims))
