"""All figures and numbers of Section VI: ``python -m analysis.paper --trials T --out DIR``."""

import sys

from analysis.paper import caa, large_scale, qualitative, small_scale
from analysis.paper.claims import write_claims
from ratt_opt.studies.command import main

if __name__ == "__main__":
    ENTRIES = [caa.ENTRY, qualitative.ENTRY, small_scale.ENTRY, large_scale.ENTRY]
    sys.exit(main("Every figure and number of Section VI of the paper.", ENTRIES, trials=10, after=write_claims))
