"""Plan robot teams that keep tracking targets under attack, and prove how good each plan is.

Every public name is loaded on first use: importing ``ratt_opt`` stays light, and the
certificate verifier shares no import with the solvers whose claims it checks.
"""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from ratt_opt.attackers.bounded_rational import bounded_rational_attack
    from ratt_opt.attackers.breaking_budgets import BreakingBudget, breaking_budgets
    from ratt_opt.attackers.criticality import Criticality, criticality_ranking
    from ratt_opt.attackers.exact import worst_case_attack
    from ratt_opt.attackers.greedy import greedy_attack
    from ratt_opt.attackers.random_attack import random_attack
    from ratt_opt.attackers.result import AttackResult
    from ratt_opt.bounds.relaxation import RelaxationBound, relaxation_bound
    from ratt_opt.errors import FileFormatError, InputError, ProofError
    from ratt_opt.graph.caa import CaaResult, caa
    from ratt_opt.graph.largest_group import LargestGroup, smallest_largest_group
    from ratt_opt.problem import Attack, Plan, Problem
    from ratt_opt.scenario.files import load_input, load_scenario, save_scenario, scenario_schema
    from ratt_opt.scenario.generator import random_scenario
    from ratt_opt.scenario.model import Robot, Scenario, Target
    from ratt_opt.scenario.model_free import InformationInput
    from ratt_opt.scenario.mrclam import from_mrclam
    from ratt_opt.scenario.sensor import Sensor
    from ratt_opt.setfunctions.base import SetFunction
    from ratt_opt.setfunctions.information import LogDetObjective, MaxEigenvalueObjective, TraceObjective
    from ratt_opt.setfunctions.table import TableFunction
    from ratt_opt.solvers.baselines import greedy, myopic, nonrobust_optimum, random_plan
    from ratt_opt.solvers.exhaustive import exhaustive_optimum
    from ratt_opt.solvers.maxmin import solve_maxmin
    from ratt_opt.solvers.ratt import ratt
    from ratt_opt.solvers.result import MaxMinResult
    from ratt_opt.stopping import Stop

_HOME = {
    "Attack": "problem",
    "AttackResult": "attackers.result",
    "BreakingBudget": "attackers.breaking_budgets",
    "CaaResult": "graph.caa",
    "Criticality": "attackers.criticality",
    "FileFormatError": "errors",
    "InformationInput": "scenario.model_free",
    "InputError": "errors",
    "LargestGroup": "graph.largest_group",
    "LogDetObjective": "setfunctions.information",
    "MaxEigenvalueObjective": "setfunctions.information",
    "MaxMinResult": "solvers.result",
    "Plan": "problem",
    "Problem": "problem",
    "ProofError": "errors",
    "RelaxationBound": "bounds.relaxation",
    "Robot": "scenario.model",
    "Scenario": "scenario.model",
    "Sensor": "scenario.sensor",
    "SetFunction": "setfunctions.base",
    "Stop": "stopping",
    "TableFunction": "setfunctions.table",
    "Target": "scenario.model",
    "TraceObjective": "setfunctions.information",
    "bounded_rational_attack": "attackers.bounded_rational",
    "breaking_budgets": "attackers.breaking_budgets",
    "caa": "graph.caa",
    "criticality_ranking": "attackers.criticality",
    "exhaustive_optimum": "solvers.exhaustive",
    "from_mrclam": "scenario.mrclam",
    "greedy": "solvers.baselines",
    "greedy_attack": "attackers.greedy",
    "load_input": "scenario.files",
    "load_scenario": "scenario.files",
    "myopic": "solvers.baselines",
    "nonrobust_optimum": "solvers.baselines",
    "random_attack": "attackers.random_attack",
    "random_plan": "solvers.baselines",
    "random_scenario": "scenario.generator",
    "ratt": "solvers.ratt",
    "relaxation_bound": "bounds.relaxation",
    "save_scenario": "scenario.files",
    "scenario_schema": "scenario.files",
    "smallest_largest_group": "graph.largest_group",
    "solve_maxmin": "solvers.maxmin",
    "worst_case_attack": "attackers.exact",
}

__all__ = [  # noqa: PLE0604  (every name of _HOME, loaded by __getattr__)
    "__version__",
    *sorted(_HOME),
]
__version__ = "0.1.0"


def __getattr__(name: str) -> object:
    if name not in _HOME:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    value = getattr(importlib.import_module(f"{__name__}.{_HOME[name]}"), name)
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return sorted({*globals(), *_HOME})
