# Every public name, once: type checkers read this file, and so does the package (see __init__.py).

from ._version import __version__ as __version__
from .attackers.criticality import (
    BreakingBudget as BreakingBudget,
    Criticality as Criticality,
    breaking_budgets as breaking_budgets,
    criticality_ranking as criticality_ranking,
)
from .attackers.exact import attack_survey as attack_survey, worst_case_attack as worst_case_attack
from .attackers.heuristics.bounded_rational import bounded_rational_attack as bounded_rational_attack
from .attackers.heuristics.greedy import greedy_attack as greedy_attack
from .attackers.heuristics.random_attack import random_attack as random_attack
from .attackers.task import AttackResult as AttackResult
from .audit.ledger import Ledger as Ledger, run_audit as run_audit
from .audit.worst_ratio.ratio import WorstCaseRatio as WorstCaseRatio, worst_case_ratio as worst_case_ratio
from .audit.worst_ratio.witness import RatioWitness as RatioWitness
from .bounds.group_size import group_size_bound as group_size_bound
from .bounds.applicable import (
    all_guarantees as all_guarantees,
    inapplicable_guarantees as inapplicable_guarantees,
)
from .bounds.guarantees import (
    Guarantee as Guarantee,
    all_bait_group_bound as all_bait_group_bound,
    pattern_free_bound as pattern_free_bound,
    remark1_bound as remark1_bound,
    sensing_only_bound as sensing_only_bound,
    theorem1_bound as theorem1_bound,
)
from .bounds.instance import instance_bound as instance_bound
from .bounds.relaxation import (
    RelaxationBound as RelaxationBound,
    relaxation_bound as relaxation_bound,
    relaxation_bounds as relaxation_bounds,
)
from .certificates.verifier.verified import Verified as Verified
from .certificates.verifier.verify import verify_certificate as verify_certificate
from .certificates.write import Certificate as Certificate, certify as certify, problem_document as problem_document
from .curvatures.curvature import Curvature as Curvature, curvature as curvature, total_curvature as total_curvature
from .curvatures.ratios import (
    GeneralisedCurvature as GeneralisedCurvature,
    SubmodularityRatio as SubmodularityRatio,
    generalised_curvature as generalised_curvature,
    submodularity_ratio as submodularity_ratio,
)
from .errors import FileFormatError as FileFormatError, InputError as InputError, ProofError as ProofError
from .graph.largest_group.counting import LargestGroup as LargestGroup
from .graph.largest_group.smallest import smallest_largest_group as smallest_largest_group
from .graph.outcomes import (
    count_outcomes as count_outcomes,
    non_dominated_outcomes as non_dominated_outcomes,
    realise as realise,
)
from .graph.survivor_sizes import CaaResult as CaaResult, caa as caa
from .main_job.bound import bound as bound
from .main_job.result import BoundReport as BoundReport, PlanAssessment as PlanAssessment
from .problem import Attack as Attack, Plan as Plan, Problem as Problem
from .scenario.files import (
    load_input as load_input,
    load_scenario as load_scenario,
    save_scenario as save_scenario,
    scenario_schema as scenario_schema,
)
from .scenario.generator import random_scenario as random_scenario
from .scenario.information_input import InformationInput as InformationInput
from .scenario.model import Robot as Robot, Scenario as Scenario, Target as Target
from .scenario.mrclam import from_mrclam as from_mrclam
from .scenario.networks import network_scenario as network_scenario
from .scenario.plan_file import load_plan as load_plan
from .scenario.sensor import Sensor as Sensor
from .scenario.simulation import Tracking as Tracking, simulate_tracking as simulate_tracking
from .setfunctions.base import SetFunction as SetFunction, TableFunction as TableFunction
from .setfunctions.criteria.logdet import LogDetObjective as LogDetObjective
from .setfunctions.criteria.maxeig import MaxEigenvalueObjective as MaxEigenvalueObjective
from .setfunctions.criteria.trace import TraceObjective as TraceObjective
from .setfunctions.properties import (
    find_modularity_violation as find_modularity_violation,
    find_monotonicity_violation as find_monotonicity_violation,
    find_negativity as find_negativity,
    find_normalisation_violation as find_normalisation_violation,
    find_subadditivity_violation as find_subadditivity_violation,
    find_submodularity_violation as find_submodularity_violation,
)
from .setfunctions.reference import (
    ConcaveOfModular as ConcaveOfModular,
    Coverage as Coverage,
    Cut as Cut,
    FacilityLocation as FacilityLocation,
    Modular as Modular,
    PartitionMatroidRank as PartitionMatroidRank,
)
from .setfunctions.sampling import NotFound as NotFound, Violation as Violation
from .setfunctions.zoo import REFERENCE_FAMILIES as REFERENCE_FAMILIES, Reference as Reference, reference as reference
from .solvers.exhaustive import exhaustive_optimum as exhaustive_optimum
from .solvers.maxmin.solve import nonrobust_optimum as nonrobust_optimum, solve_maxmin as solve_maxmin
from .solvers.ratt import greedy as greedy, myopic as myopic, random_plan as random_plan, ratt as ratt
from .solvers.result import MaxMinResult as MaxMinResult
from .stopping import Stop as Stop
