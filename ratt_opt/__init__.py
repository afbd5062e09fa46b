"""Plan robot teams that keep tracking targets under attack, and prove how good each plan is.

Every public name is loaded on first use: importing ``ratt_opt`` stays light, and the
certificate verifier shares no import with the solvers whose claims it checks.
"""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from ratt_opt.attackers.breaking_budgets import (
        BreakingBudget as BreakingBudget,
    )
    from ratt_opt.attackers.breaking_budgets import (
        breaking_budgets as breaking_budgets,
    )
    from ratt_opt.attackers.criticality import Criticality as Criticality
    from ratt_opt.attackers.criticality import criticality_ranking as criticality_ranking
    from ratt_opt.attackers.exact import worst_case_attack as worst_case_attack
    from ratt_opt.attackers.heuristics.bounded_rational import bounded_rational_attack as bounded_rational_attack
    from ratt_opt.attackers.heuristics.greedy import greedy_attack as greedy_attack
    from ratt_opt.attackers.heuristics.random_attack import random_attack as random_attack
    from ratt_opt.attackers.result import AttackResult as AttackResult
    from ratt_opt.attackers.survey import attack_survey as attack_survey
    from ratt_opt.audit.ledger import Ledger as Ledger
    from ratt_opt.audit.ledger import run_audit as run_audit
    from ratt_opt.audit.worst_ratio.ratio import WorstCaseRatio as WorstCaseRatio
    from ratt_opt.audit.worst_ratio.ratio import worst_case_ratio as worst_case_ratio
    from ratt_opt.audit.worst_ratio.witness import RatioWitness as RatioWitness
    from ratt_opt.bounds.guarantees import (
        Guarantee as Guarantee,
    )
    from ratt_opt.bounds.guarantees import (
        all_bait_group_bound as all_bait_group_bound,
    )
    from ratt_opt.bounds.guarantees import (
        all_guarantees as all_guarantees,
    )
    from ratt_opt.bounds.guarantees import (
        inapplicable_guarantees as inapplicable_guarantees,
    )
    from ratt_opt.bounds.guarantees import (
        pattern_free_bound as pattern_free_bound,
    )
    from ratt_opt.bounds.guarantees import (
        remark1_bound as remark1_bound,
    )
    from ratt_opt.bounds.guarantees import (
        sensing_only_bound as sensing_only_bound,
    )
    from ratt_opt.bounds.guarantees import (
        theorem1_bound as theorem1_bound,
    )
    from ratt_opt.bounds.instance import instance_bound as instance_bound
    from ratt_opt.bounds.lazy_relaxation import relaxation_bounds as relaxation_bounds
    from ratt_opt.bounds.relaxation import RelaxationBound as RelaxationBound
    from ratt_opt.bounds.relaxation import relaxation_bound as relaxation_bound
    from ratt_opt.certificates.verified import Verified as Verified
    from ratt_opt.certificates.verify import verify_certificate as verify_certificate
    from ratt_opt.certificates.write import (
        Certificate as Certificate,
    )
    from ratt_opt.certificates.write import (
        certify as certify,
    )
    from ratt_opt.certificates.write import (
        problem_document as problem_document,
    )
    from ratt_opt.curvatures.curvature import (
        Curvature as Curvature,
    )
    from ratt_opt.curvatures.curvature import (
        curvature as curvature,
    )
    from ratt_opt.curvatures.curvature import (
        total_curvature as total_curvature,
    )
    from ratt_opt.curvatures.ratios import (
        GeneralisedCurvature as GeneralisedCurvature,
    )
    from ratt_opt.curvatures.ratios import (
        SubmodularityRatio as SubmodularityRatio,
    )
    from ratt_opt.curvatures.ratios import (
        generalised_curvature as generalised_curvature,
    )
    from ratt_opt.curvatures.ratios import (
        submodularity_ratio as submodularity_ratio,
    )
    from ratt_opt.errors import FileFormatError as FileFormatError
    from ratt_opt.errors import InputError as InputError
    from ratt_opt.errors import ProofError as ProofError
    from ratt_opt.graph.caa import CaaResult as CaaResult
    from ratt_opt.graph.caa import caa as caa
    from ratt_opt.graph.largest_group import (
        LargestGroup as LargestGroup,
    )
    from ratt_opt.graph.largest_group import (
        smallest_largest_group as smallest_largest_group,
    )
    from ratt_opt.graph.outcomes import (
        count_outcomes as count_outcomes,
    )
    from ratt_opt.graph.outcomes import (
        non_dominated_outcomes as non_dominated_outcomes,
    )
    from ratt_opt.graph.outcomes import (
        realise as realise,
    )
    from ratt_opt.main_job import BoundReport as BoundReport
    from ratt_opt.main_job import PlanAssessment as PlanAssessment
    from ratt_opt.main_job import bound as bound
    from ratt_opt.problem import Attack as Attack
    from ratt_opt.problem import Plan as Plan
    from ratt_opt.problem import Problem as Problem
    from ratt_opt.scenario.files import (
        load_input as load_input,
    )
    from ratt_opt.scenario.files import (
        load_scenario as load_scenario,
    )
    from ratt_opt.scenario.files import (
        save_scenario as save_scenario,
    )
    from ratt_opt.scenario.files import (
        scenario_schema as scenario_schema,
    )
    from ratt_opt.scenario.generator import random_scenario as random_scenario
    from ratt_opt.scenario.model import Robot as Robot
    from ratt_opt.scenario.model import Scenario as Scenario
    from ratt_opt.scenario.model import Target as Target
    from ratt_opt.scenario.model_free import InformationInput as InformationInput
    from ratt_opt.scenario.mrclam import from_mrclam as from_mrclam
    from ratt_opt.scenario.plan_file import load_plan as load_plan
    from ratt_opt.scenario.sensor import Sensor as Sensor
    from ratt_opt.scenario.simulation import Tracking as Tracking
    from ratt_opt.scenario.simulation import simulate_tracking as simulate_tracking
    from ratt_opt.setfunctions.base import SetFunction as SetFunction
    from ratt_opt.setfunctions.criteria.logdet import LogDetObjective as LogDetObjective
    from ratt_opt.setfunctions.criteria.maxeig import MaxEigenvalueObjective as MaxEigenvalueObjective
    from ratt_opt.setfunctions.criteria.trace import TraceObjective as TraceObjective
    from ratt_opt.setfunctions.properties import (
        find_modularity_violation as find_modularity_violation,
    )
    from ratt_opt.setfunctions.properties import (
        find_monotonicity_violation as find_monotonicity_violation,
    )
    from ratt_opt.setfunctions.properties import (
        find_negativity as find_negativity,
    )
    from ratt_opt.setfunctions.properties import (
        find_normalisation_violation as find_normalisation_violation,
    )
    from ratt_opt.setfunctions.properties import (
        find_subadditivity_violation as find_subadditivity_violation,
    )
    from ratt_opt.setfunctions.properties import (
        find_submodularity_violation as find_submodularity_violation,
    )
    from ratt_opt.setfunctions.reference import (
        ConcaveOfModular as ConcaveOfModular,
    )
    from ratt_opt.setfunctions.reference import (
        Coverage as Coverage,
    )
    from ratt_opt.setfunctions.reference import (
        Cut as Cut,
    )
    from ratt_opt.setfunctions.reference import (
        FacilityLocation as FacilityLocation,
    )
    from ratt_opt.setfunctions.reference import (
        Modular as Modular,
    )
    from ratt_opt.setfunctions.reference import (
        PartitionMatroidRank as PartitionMatroidRank,
    )
    from ratt_opt.setfunctions.sampling import NotFound as NotFound
    from ratt_opt.setfunctions.sampling import Violation as Violation
    from ratt_opt.setfunctions.table import TableFunction as TableFunction
    from ratt_opt.setfunctions.zoo import (
        REFERENCE_FAMILIES as REFERENCE_FAMILIES,
    )
    from ratt_opt.setfunctions.zoo import (
        Reference as Reference,
    )
    from ratt_opt.setfunctions.zoo import (
        reference as reference,
    )
    from ratt_opt.solvers.baselines import (
        greedy as greedy,
    )
    from ratt_opt.solvers.baselines import (
        myopic as myopic,
    )
    from ratt_opt.solvers.baselines import (
        nonrobust_optimum as nonrobust_optimum,
    )
    from ratt_opt.solvers.baselines import (
        random_plan as random_plan,
    )
    from ratt_opt.solvers.exhaustive import exhaustive_optimum as exhaustive_optimum
    from ratt_opt.solvers.maxmin.solve import solve_maxmin as solve_maxmin
    from ratt_opt.solvers.ratt import ratt as ratt
    from ratt_opt.solvers.result import MaxMinResult as MaxMinResult
    from ratt_opt.stopping import Stop as Stop

_HOME = {
    "Attack": "problem",
    "AttackResult": "attackers.result",
    "BoundReport": "main_job",
    "BreakingBudget": "attackers.breaking_budgets",
    "CaaResult": "graph.caa",
    "Certificate": "certificates.write",
    "ConcaveOfModular": "setfunctions.reference",
    "Coverage": "setfunctions.reference",
    "Criticality": "attackers.criticality",
    "Curvature": "curvatures.curvature",
    "Cut": "setfunctions.reference",
    "FacilityLocation": "setfunctions.reference",
    "FileFormatError": "errors",
    "GeneralisedCurvature": "curvatures.ratios",
    "Guarantee": "bounds.guarantees",
    "InformationInput": "scenario.model_free",
    "InputError": "errors",
    "LargestGroup": "graph.largest_group",
    "Ledger": "audit.ledger",
    "LogDetObjective": "setfunctions.criteria.logdet",
    "MaxEigenvalueObjective": "setfunctions.criteria.maxeig",
    "MaxMinResult": "solvers.result",
    "Modular": "setfunctions.reference",
    "NotFound": "setfunctions.sampling",
    "PartitionMatroidRank": "setfunctions.reference",
    "Plan": "problem",
    "PlanAssessment": "main_job",
    "Problem": "problem",
    "ProofError": "errors",
    "REFERENCE_FAMILIES": "setfunctions.zoo",
    "RatioWitness": "audit.worst_ratio.witness",
    "Reference": "setfunctions.zoo",
    "RelaxationBound": "bounds.relaxation",
    "Robot": "scenario.model",
    "Scenario": "scenario.model",
    "Sensor": "scenario.sensor",
    "SetFunction": "setfunctions.base",
    "Stop": "stopping",
    "SubmodularityRatio": "curvatures.ratios",
    "TableFunction": "setfunctions.table",
    "Target": "scenario.model",
    "TraceObjective": "setfunctions.criteria.trace",
    "Tracking": "scenario.simulation",
    "Verified": "certificates.verified",
    "Violation": "setfunctions.sampling",
    "WorstCaseRatio": "audit.worst_ratio.ratio",
    "all_bait_group_bound": "bounds.guarantees",
    "all_guarantees": "bounds.guarantees",
    "attack_survey": "attackers.survey",
    "bound": "main_job",
    "bounded_rational_attack": "attackers.heuristics.bounded_rational",
    "breaking_budgets": "attackers.breaking_budgets",
    "caa": "graph.caa",
    "certify": "certificates.write",
    "count_outcomes": "graph.outcomes",
    "criticality_ranking": "attackers.criticality",
    "curvature": "curvatures.curvature",
    "exhaustive_optimum": "solvers.exhaustive",
    "find_modularity_violation": "setfunctions.properties",
    "find_monotonicity_violation": "setfunctions.properties",
    "find_negativity": "setfunctions.properties",
    "find_normalisation_violation": "setfunctions.properties",
    "find_subadditivity_violation": "setfunctions.properties",
    "find_submodularity_violation": "setfunctions.properties",
    "from_mrclam": "scenario.mrclam",
    "generalised_curvature": "curvatures.ratios",
    "greedy": "solvers.baselines",
    "greedy_attack": "attackers.heuristics.greedy",
    "inapplicable_guarantees": "bounds.guarantees",
    "instance_bound": "bounds.instance",
    "load_input": "scenario.files",
    "load_plan": "scenario.plan_file",
    "load_scenario": "scenario.files",
    "myopic": "solvers.baselines",
    "non_dominated_outcomes": "graph.outcomes",
    "nonrobust_optimum": "solvers.baselines",
    "pattern_free_bound": "bounds.guarantees",
    "problem_document": "certificates.write",
    "random_attack": "attackers.heuristics.random_attack",
    "random_plan": "solvers.baselines",
    "random_scenario": "scenario.generator",
    "ratt": "solvers.ratt",
    "realise": "graph.outcomes",
    "reference": "setfunctions.zoo",
    "relaxation_bound": "bounds.relaxation",
    "relaxation_bounds": "bounds.lazy_relaxation",
    "remark1_bound": "bounds.guarantees",
    "run_audit": "audit.ledger",
    "save_scenario": "scenario.files",
    "scenario_schema": "scenario.files",
    "sensing_only_bound": "bounds.guarantees",
    "simulate_tracking": "scenario.simulation",
    "smallest_largest_group": "graph.largest_group",
    "solve_maxmin": "solvers.maxmin.solve",
    "submodularity_ratio": "curvatures.ratios",
    "theorem1_bound": "bounds.guarantees",
    "total_curvature": "curvatures.curvature",
    "verify_certificate": "certificates.verify",
    "worst_case_attack": "attackers.exact",
    "worst_case_ratio": "audit.worst_ratio.ratio",
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
