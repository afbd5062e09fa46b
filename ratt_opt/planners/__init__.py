"""Planners that others published, one file each, with guarantee and source: baselines for studies and missions.

Open ``registry.py`` first: every planner by name, with what is proved of it. ``greedy_sets.py`` is the loop that they
share. ``resilient_selection.py``, ``sensing_only.py``, ``uniform_buckets.py`` and ``partitioned_robust.py`` prepare for
lost robots; ``sequential_greedy.py`` and ``resource_aware_greedy.py`` for few messages; ``scenario_program.py`` is the
integer program of the field.
"""

from ratt_opt.planners.partitioned_robust import partitioned_robust
from ratt_opt.planners.registry import PUBLISHED, Published
from ratt_opt.planners.resilient_selection import resilient_selection
from ratt_opt.planners.resource_aware_greedy import resource_aware_greedy
from ratt_opt.planners.scenario_program import ScenarioPlan, scenario_program
from ratt_opt.planners.sensing_only import sensing_only
from ratt_opt.planners.sequential_greedy import sequential_greedy
from ratt_opt.planners.uniform_buckets import uniform_buckets

__all__ = [
    "PUBLISHED",
    "Published",
    "ScenarioPlan",
    "partitioned_robust",
    "resilient_selection",
    "resource_aware_greedy",
    "scenario_program",
    "sensing_only",
    "sequential_greedy",
    "uniform_buckets",
]
