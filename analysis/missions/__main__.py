"""All studies of missions: ``python -m analysis.missions --trials T --out DIR``."""

from __future__ import annotations

import sys

from analysis.missions import consistency, exact_flights, flights
from analysis.missions.claims import write_claims
from ratt_opt.studies.command import main

if __name__ == "__main__":
    ENTRIES = [*flights.ENTRIES, *exact_flights.ENTRIES, consistency.ENTRY]
    sys.exit(main("Missions under attack.", ENTRIES, trials=100, after=write_claims))
