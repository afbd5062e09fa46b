# Every public name, once: type checkers read this file, and so does the package (see __init__.py), which takes the
# topics from the headings.

from ._version import __version__ as __version__

# == The main job
from .main_job.bound import bound as bound
from .main_job.job_params import JobParams as JobParams
from ._params import read_params as read_params
from .main_job.result import BoundReport as BoundReport, PlanAssessment as PlanAssessment
from .report.map_style import MapStyle as MapStyle
from .budget import Stop as Stop

# == Problems
from .problem import Problem as Problem, Plan as Plan, Attack as Attack
from .coordinates.measured import measured_coordinates as measured_coordinates
from .coordinates.changed import ChangedProblem as ChangedProblem

# == Scenarios and files
from .scenario.generator import random_scenario as random_scenario
from .scenario.model import Scenario as Scenario, Robot as Robot, Target as Target
from .scenario.sensor import Sensor as Sensor
from .scenario.sensors.kinds import register_sensor as register_sensor, sensor_kinds as sensor_kinds
from .scenario.information_input import InformationInput as InformationInput
from .scenario.files import (
    load_input as load_input,
    load_scenario as load_scenario,
    save_scenario as save_scenario,
    scenario_schema as scenario_schema,
)
from .scenario.limited_view import limited_view_scenario as limited_view_scenario
from .scenario.networks import NetworkShape as NetworkShape, network_scenario as network_scenario
from .scenario.on_graph import graph_scenario as graph_scenario
from .scenario.plan_file import load_plan as load_plan
from .scenario.mrclam import from_mrclam as from_mrclam
from .scenario.mrclam_reader import MrclamData as MrclamData, read_mrclam as read_mrclam
from .scenario.simulation import simulate_tracking as simulate_tracking, Tracking as Tracking

# == Planners
from .solvers.refined import RefinedParams as RefinedParams, RefinedPlan as RefinedPlan, refined as refined
from .solvers.ratt import ratt as ratt, greedy as greedy, myopic as myopic, random_plan as random_plan
from .solvers.maxmin.params import MaxMinParams as MaxMinParams
from .solvers.maxmin.solve import nonrobust_optimum as nonrobust_optimum, solve_maxmin as solve_maxmin
from .solvers.exhaustive import exhaustive_optimum as exhaustive_optimum
from .solvers.result import MaxMinResult as MaxMinResult
from .solvers.undominated import undominated as undominated, UndominatedProblem as UndominatedProblem

# == Planning by messages
from .decentralised.plan import (
    DecentralisedPlan as DecentralisedPlan,
    decentralised_ratt as decentralised_ratt,
    decentralised_refined as decentralised_refined,
)
from .decentralised.knowledge import ExchangeParams as ExchangeParams
from .decentralised.links import link_losses as link_losses, LinkLoss as LinkLoss, LinkLosses as LinkLosses
from .decentralised.faults import Faults as Faults, RadioParams as RadioParams

# == Attackers
from .attack.exact import worst_case_attack as worst_case_attack
from .attack.survey import attack_survey as attack_survey
from .attack.heuristics import bounded_rational_attack as bounded_rational_attack
from .attack.heuristics import greedy_attack as greedy_attack
from .attack.heuristics import random_attack as random_attack
from .attack.params import AttackParams as AttackParams
from .curvatures.params import CurvatureParams as CurvatureParams
from .attack.task import AttackResult as AttackResult
from .attack.protection.criticality import (
    criticality_ranking as criticality_ranking,
    Criticality as Criticality,
    breaking_budgets as breaking_budgets,
    BreakingBudget as BreakingBudget,
)
from .attack.protection.robot_choice import BestRobots as BestRobots, robots_to_protect as robots_to_protect
from .attack.protection.best_links import (
    links_to_protect as links_to_protect,
    links_to_add as links_to_add,
    BestLinks as BestLinks,
)

# == Missions
from .missions.players.attack_models import (
    AttackModel as AttackModel,
    PermanentFailures as PermanentFailures,
    PersistentAttacks as PersistentAttacks,
)
from .missions.params import MissionParams as MissionParams
from .missions.belief import Belief as Belief
from .scenario.sensors.model import SensorModel as SensorModel
from .scenario.sensors.range_bearing import (
    BearingOnly as BearingOnly,
    RangeBearing as RangeBearing,
    RangeOnly as RangeOnly,
)
from .scenario.sensors.position import PositionSensor as PositionSensor
from .scenario.sensors.doppler import DopplerRadar as DopplerRadar
from .scenario.sensors.spatial import SphericalSensor as SphericalSensor, TiltedCamera as TiltedCamera
from .missions.models.robots import RobotMotion as RobotMotion
from .missions.models.targets import (
    ConstantVelocity as ConstantVelocity,
    ConstantVelocity3D as ConstantVelocity3D,
    CoordinatedTurn as CoordinatedTurn,
    KnownVelocity as KnownVelocity,
    TargetMotion as TargetMotion,
)
from .missions.players.attackers import WorstAttacker as WorstAttacker
from .missions.players.planners import (
    DecentralisedPlanner as DecentralisedPlanner,
    MaxMinPlanner as MaxMinPlanner,
    RandomPlanner as RandomPlanner,
    RefinedPlanner as RefinedPlanner,
)
from .missions.replay.fit_sensor import (
    FitParams as FitParams,
    FittedSensor as FittedSensor,
    fit_sensor as fit_sensor,
)
from .missions.replay.replay import (
    Replay as Replay,
    ReplaySettings as ReplaySettings,
    replay_mrclam as replay_mrclam,
)
from .missions.mission import Mission as Mission
from .missions.result import MissionStep as MissionStep
from .missions.run import run_mission as run_mission
from .missions.live.tracker import Tracker as Tracker
from .missions.live.team import TeamStep as TeamStep, TeamTrackers as TeamTrackers
from .missions.live.gate import Gate as Gate
from .missions.live.packets import (
    MeasurementInnovation as MeasurementInnovation,
    Skipped as Skipped,
    TrackerPlan as TrackerPlan,
)
from .scenario.planner_world import PlannerWorld as PlannerWorld
from .missions.live.view import LiveView as LiveView
from .missions.live.state import Measurement as Measurement, Moment as Moment, TrackerState as TrackerState
from .missions.world import MissionModel as MissionModel
from .missions.bags.loop import BagReplay as BagReplay, replay_bag as replay_bag

# == Studies
from . import studies as studies
from . import planners as planners

# == The open benchmark
from .benchmark.instances.instance import BenchmarkInstance as BenchmarkInstance, read_instance as read_instance
from .benchmark.instances.library import BenchmarkLibrary as BenchmarkLibrary
from .benchmark.proofs.records import submit_record as submit_record, verify_benchmark as verify_benchmark
from .benchmark.runs.runner import run_benchmark as run_benchmark

# == Guarantees and bounds
from .bounds.guarantees import (
    Guarantee as Guarantee,
    theorem1_bound as theorem1_bound,
    pattern_free_bound as pattern_free_bound,
    sensing_only_bound as sensing_only_bound,
    remark1_bound as remark1_bound,
    all_bait_group_bound as all_bait_group_bound,
)
from .bounds.group_size import group_size_bound as group_size_bound
from .bounds.heard_sets import heard_sets_bound as heard_sets_bound
from .bounds.survivors import survivor_bound as survivor_bound
from .bounds.instance import instance_bound as instance_bound
from .bounds.applicable import (
    all_guarantees as all_guarantees,
    inapplicable_guarantees as inapplicable_guarantees,
)
from .bounds.params import BoundParams as BoundParams
from .bounds.relaxation import (
    relaxation_bound as relaxation_bound,
    relaxation_bounds as relaxation_bounds,
    RelaxationBound as RelaxationBound,
)

# == Certificates
from .certificates.params import CertificateParams as CertificateParams, ExplanationParams as ExplanationParams
from .certificates.verifier.limits import VerifierLimits as VerifierLimits
from .certificates.stated_problem import problem_document as problem_document
from .certificates.write import certify as certify
from .certificates.certification import Certificate as Certificate
from .certificates.verifier.verify import verify_certificate as verify_certificate
from .certificates.verifier.verified import Verified as Verified

# == Set functions
from .setfunctions.base import SetFunction as SetFunction, TableFunction as TableFunction
from .setfunctions.criteria.trace import TraceObjective as TraceObjective
from .setfunctions.criteria.logdet import LogDetObjective as LogDetObjective
from .setfunctions.criteria.maxeig import MaxEigenvalueObjective as MaxEigenvalueObjective
from .setfunctions.sums import SumFunction as SumFunction, Part as Part
from .setfunctions.best_elements import Coverage as Coverage, FacilityLocation as FacilityLocation
from .setfunctions.reference import (
    Modular as Modular,
    ConcaveOfModular as ConcaveOfModular,
    Cut as Cut,
    PartitionMatroidRank as PartitionMatroidRank,
)
from .setfunctions.zoo import (
    reference as reference,
    Reference as Reference,
    REFERENCE_FAMILIES as REFERENCE_FAMILIES,
)

# == Properties with witnesses
from .setfunctions.properties import (
    find_normalisation_violation as find_normalisation_violation,
    find_negativity as find_negativity,
    find_monotonicity_violation as find_monotonicity_violation,
    find_submodularity_violation as find_submodularity_violation,
    find_modularity_violation as find_modularity_violation,
    find_subadditivity_violation as find_subadditivity_violation,
)
from .setfunctions.property_params import PropertyParams as PropertyParams
from .setfunctions.sampling import Violation as Violation, NotFound as NotFound

# == Curvatures and ratios
from .curvatures.curvature import (
    curvature as curvature,
    total_curvature as total_curvature,
    Curvature as Curvature,
)
from .curvatures.ratios import (
    submodularity_ratio as submodularity_ratio,
    SubmodularityRatio as SubmodularityRatio,
    generalised_curvature as generalised_curvature,
    GeneralisedCurvature as GeneralisedCurvature,
)

# == The communication graph
from .graph.any_networkx import communication_graph as communication_graph
from .graph.survivor_sizes import caa as caa, CaaResult as CaaResult
from .attack.edge_cuts.smallest import SizeParams as SizeParams, smallest_largest_group as smallest_largest_group
from .graph.largest_group.counting import LargestGroup as LargestGroup
from .attack.edge_cuts.fewest import fewest_cuts as fewest_cuts
from .attack.edge_cuts.fewest import FewestCuts as FewestCuts
from .certificates.edge_cuts import certify_cuts as certify_cuts
from .graph.outcomes import (
    non_dominated_outcomes as non_dominated_outcomes,
    count_outcomes as count_outcomes,
    realise as realise,
)

# == The audit of the paper's proof
from .audit import run_audit as run_audit, Ledger as Ledger
from .worst_ratio.params import WorstRatioParams as WorstRatioParams
from .worst_ratio.ratio import worst_case_ratio as worst_case_ratio, WorstCaseRatio as WorstCaseRatio
from .worst_ratio.witness import RatioWitness as RatioWitness

# == Errors
from .errors import InputError as InputError, FileFormatError as FileFormatError, ProofError as ProofError

TOPICS: dict[str, tuple[str, ...]]
