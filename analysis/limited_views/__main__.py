"""All studies of limited views, and their pages: ``python -m analysis.limited_views --trials 60 --out DIR``."""

import sys

from analysis.limited_views import bite, flights, one_step
from analysis.limited_views.page import write_page
from ratt_opt.studies.command import main

if __name__ == "__main__":
    ENTRIES = [bite.ENTRY, one_step.ENTRY, *flights.ENTRIES]
    sys.exit(main("Where robust planning pays.", ENTRIES, trials=60, after=write_page))
