"""Studies: planners against attackers over seeds, with tables, intervals and figures; resumed where they stopped.

Open ``study.py`` first: the cases a study compares and what it measures. ``engine.py`` runs the trials where
``executors.py`` says, ``store.py`` keeps the rows; ``instance.py``, ``comparison.py`` and ``quantities.py`` are what a
trial measures, ``missions.py`` the study of missions by one call; ``results.py``, ``statistics.py``, ``plots.py`` what
is made of all; ``command.py`` the command line.
"""

from ratt_opt.studies.cases import Case, Seeds
from ratt_opt.studies.command import Entry, main
from ratt_opt.studies.engine import SweepError, run
from ratt_opt.studies.instance import ATTACKERS, GRAPHS, PLANNERS, Instance
from ratt_opt.studies.missions import MISSION_METRICS, mission_study
from ratt_opt.studies.results import Results
from ratt_opt.studies.statistics import Estimate, Mean, estimate
from ratt_opt.studies.store import read_table
from ratt_opt.studies.study import Study

__all__ = [
    "ATTACKERS",
    "GRAPHS",
    "MISSION_METRICS",
    "PLANNERS",
    "Case",
    "Entry",
    "Estimate",
    "Instance",
    "Mean",
    "Results",
    "Seeds",
    "Study",
    "SweepError",
    "estimate",
    "main",
    "mission_study",
    "read_table",
    "run",
]
