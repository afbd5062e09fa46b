"""The main cell of limited views, all planners: ``python -m analysis.limited_views --trials 60 --out DIR``."""

from __future__ import annotations

import sys

from analysis.limited_views.flights import MAIN
from ratt_opt.studies.command import Entry, main

if __name__ == "__main__":
    sys.exit(main("Where robust planning pays.", [Entry(MAIN)], trials=60))
