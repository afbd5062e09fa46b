"""Robust sensor management in Stone Soup: a manager that plans for the worst, and the worst.

Read ``manager.py`` first. ``nodes.py`` says who takes part and what they can do, ``information.py`` (with
``closed_forms.py`` and ``generic.py``) what each combination of actions tells, ``network.py`` who can talk to whom,
and ``problem.py`` makes a :class:`ratt_opt.Problem` of it.
"""

from __future__ import annotations

try:
    import stonesoup as _stonesoup  # noqa: F401
except ImportError as _missing:
    _rule = "ratt_opt.interop.stonesoup needs Stone Soup 1.9.1 or newer: pip install 'ratt-opt[stonesoup]'"
    raise ImportError(_rule, name="stonesoup") from _missing

from ratt_opt.interop.stonesoup.attacker import Aftermath, SurvivingGroup, WorstCaseAttacker
from ratt_opt.interop.stonesoup.baselines import CriterionReward, SequentialGreedySensorManager
from ratt_opt.interop.stonesoup.group_trackers import GroupTrackers
from ratt_opt.interop.stonesoup.manager import RobustSensorManager

__all__ = [
    "Aftermath",
    "CriterionReward",
    "GroupTrackers",
    "RobustSensorManager",
    "SequentialGreedySensorManager",
    "SurvivingGroup",
    "WorstCaseAttacker",
]
