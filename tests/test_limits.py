"""Every public search keeps its time limit and answers interrupts: one row each, and none is missing."""

import inspect
import random
import signal
import time
import weakref
from dataclasses import dataclass
from functools import cache

import networkx as nx
import numpy as np
import pytest

import ratt_opt as ro
from ratt_opt.graph import survivor_sizes
from tests.strategies import Opaque, information_data

ROWS = {
    "attack_survey": lambda c, t: ro.attack_survey(c.problem, c.plan, time_limit=t),
    "bound": lambda c, t: ro.bound(c.problem, time_limit=t),
    "bound with certificate": lambda c, t: ro.bound(c.problem, time_limit=t, certificate=c.folder / "bound.json"),
    "breaking_budgets": lambda c, t: ro.breaking_budgets(c.problem, c.plan, c.half, time_limit=t),
    "certify": lambda c, t: ro.certify(c.problem, c.result, c.folder / "one.json", time_limit=t),
    "certify_cuts": lambda c, t: ro.certify_cuts(c.graph, c.cuts, c.folder / "cuts.json", time_limit=t),
    "criticality_ranking": lambda c, t: ro.criticality_ranking(c.problem, c.plan, time_limit=t),
    "curvature": lambda c, t: ro.curvature(c.f, c.problem.robot, time_limit=t),
    "curvature of a plan": lambda c, t: ro.curvature(c.f, plan=c.plan, time_limit=t),
    "curvature of any function": lambda c, t: ro.curvature(c.own, time_limit=t),
    "decentralised_ratt": lambda c, t: ro.decentralised_ratt(c.problem, time_limit=t),
    "decentralised_refined": lambda c, t: ro.decentralised_refined(c.problem, time_limit=t),
    "exhaustive_optimum": lambda c, t: ro.exhaustive_optimum(c.small, time_limit=t),
    "fewest_cuts": lambda c, t: ro.fewest_cuts(c.graph, c.robots // 4, time_limit=t),
    "find_modularity_violation": lambda c, t: ro.find_modularity_violation(c.table, time_limit=t),
    "find_monotonicity_violation": lambda c, t: ro.find_monotonicity_violation(c.own, time_limit=t),
    "find_negativity": lambda c, t: ro.find_negativity(c.own, time_limit=t),
    "find_subadditivity_violation": lambda c, t: ro.find_subadditivity_violation(c.table, time_limit=t),
    "find_submodularity_violation": lambda c, t: ro.find_submodularity_violation(c.f, time_limit=t),
    "find_submodularity_violation in a table": lambda c, t: ro.find_submodularity_violation(c.table, time_limit=t),
    "generalised_curvature": lambda c, t: ro.generalised_curvature(c.f, c.problem.robot, time_limit=t),
    "generalised_curvature of a plan": lambda c, t: ro.generalised_curvature(c.f, plan=c.plan[:22], time_limit=t),
    "instance_bound": lambda c, t: ro.instance_bound(c.problem, c.plan, c=c.total, time_limit=t),
    "link_losses": lambda c, t: ro.link_losses(c.on_graph, time_limit=t),
    "links_to_add": lambda c, t: ro.links_to_add(c.on_graph, c.plan, 3, time_limit=t),
    "robots_to_protect": lambda c, t: ro.robots_to_protect(c.on_graph, c.plan, 2, time_limit=t),
    "links_to_protect": lambda c, t: ro.links_to_protect(c.on_graph, c.plan, 3, time_limit=t),
    "nonrobust_optimum": lambda c, t: ro.nonrobust_optimum(c.problem, time_limit=t),
    "relaxation_bound": lambda c, t: ro.relaxation_bound(c.problem, [c.result.worst_case.attack], time_limit=t),
    "relaxation_bounds": lambda c, t: list(ro.relaxation_bounds(c.small, time_limit=t)),
    "run_audit": lambda c, t: ro.run_audit(c.folder, time_limit=t),
    "smallest_largest_group": lambda c, t: ro.smallest_largest_group(c.graph, c.cut, time_limit=t),
    "smallest_largest_group by programs": lambda c, t: ro.smallest_largest_group(
        c.graph, c.cut, method="milp", time_limit=t
    ),
    "refined": lambda c, t: ro.refined(c.problem, time_limit=t),
    "refined on any graph": lambda c, t: ro.refined(c.on_graph, time_limit=t),
    "solve_maxmin": lambda c, t: ro.solve_maxmin(c.problem, gap=0, time_limit=t),
    "solve_maxmin on any graph": lambda c, t: ro.solve_maxmin(c.on_graph, gap=0, time_limit=t),
    "solve_maxmin of any function": lambda c, t: ro.solve_maxmin(c.any_problem, time_limit=t),
    "submodularity_ratio": lambda c, t: ro.submodularity_ratio(c.f, c.problem.robot, time_limit=t),
    "submodularity_ratio of a plan": lambda c, t: ro.submodularity_ratio(c.f, plan=c.plan[:16], time_limit=t),
    "total_curvature": lambda c, t: ro.total_curvature(c.f, c.problem.robot, time_limit=t),
    "total_curvature of a plan": lambda c, t: ro.total_curvature(c.f, plan=c.plan[:22], time_limit=t),
    "verify_certificate": lambda c, t: ro.verify_certificate(c.certificate, time_limit=max(t, 1e-6)),
    "worst_case_attack": lambda c, t: ro.worst_case_attack(c.problem, c.plan, time_limit=t),
    "worst_case_attack on any graph": lambda c, t: ro.worst_case_attack(c.on_graph, c.plan, time_limit=t),
    "worst_case_attack of any function": lambda c, t: ro.worst_case_attack(c.any_problem, c.plan, time_limit=t),
    "worst_case_ratio": lambda _, t: ro.worst_case_ratio(
        4, 1, 2, curvature=0.5, family="nondecreasing", time_limit=t, use_theorem=False
    ),
}
"""Name of the function (and a case) -> one call of it with a time limit."""

NO_SEARCH = {
    "all_bait_group_bound",
    "all_guarantees",
    "bounded_rational_attack",
    "caa",
    "communication_graph",
    "count_outcomes",
    "find_normalisation_violation",
    "fit_sensor",
    "from_mrclam",
    "graph_scenario",
    "greedy",
    "greedy_attack",
    "group_size_bound",
    "heard_sets_bound",
    "inapplicable_guarantees",
    "limited_view_scenario",
    "load_input",
    "load_plan",
    "load_scenario",
    "measured_coordinates",
    "myopic",
    "network_scenario",
    "non_dominated_outcomes",
    "pattern_free_bound",
    "problem_document",
    "read_params",
    "random_attack",
    "random_plan",
    "random_scenario",
    "ratt",
    "read_instance",
    "read_mrclam",
    "realise",
    "reference",
    "register_sensor",
    "remark1_bound",
    "replay_bag",
    "replay_mrclam",
    "run_benchmark",
    "run_mission",
    "save_scenario",
    "scenario_schema",
    "sensing_only_bound",
    "sensor_kinds",
    "simulate_tracking",
    "submit_record",
    "survivor_bound",
    "theorem1_bound",
    "undominated",
    "verify_benchmark",
}
"""Formulas, files, planners and heuristics of polynomial time, flights and fits as long as their arguments say, and
generators that their caller may leave."""

UNDECIDED = (ro.ProofError, ro.InputError)
"""What says that there was no time: for a certificate, there is no bracket."""


class Cover(ro.SetFunction):
    """A coverage function that takes its time over every value."""

    is_submodular = True

    def __init__(self, n):
        rng = np.random.default_rng(0)
        self._seen, self._worth = rng.random((n, 12)) < 0.2, rng.random(12)

    @property
    def n(self):
        return len(self._seen)

    def evaluate(self, membership):
        time.sleep(0.001 * len(membership))
        return np.array([self._worth[self._seen[row].any(axis=0)].sum() for row in membership])


@dataclass
class Case:
    """One team, and what the rows need of it."""

    robots: int
    folder: object

    def __post_init__(self):
        n, rng = self.robots, np.random.default_rng(self.robots)
        prior, information = information_data(rng, 3 * n, 4, 2)
        self.f = ro.TraceObjective(prior, information)
        owners, self.cut = np.repeat(np.arange(n), 3), n
        self.problem = ro.Problem(self.f, owners, None, n // 6, n * (n - 1) // 5)
        self.graph = nx.gnp_random_graph(n, min(0.5, 12 / n), seed=1)
        links = self.graph.number_of_edges()
        self.on_graph = ro.Problem(self.f, owners, self.graph, n // 6, links // 5)
        self.cuts = ro.fewest_cuts(self.graph, n // 4, time_limit=2)
        self.plan = ro.myopic(self.problem).elements
        self.half = 0.5 * self.f(self.plan)
        self.own = Cover(3 * n)
        self.any_problem = ro.Problem(self.own, owners, None, 1, n)
        self.table = ro.TableFunction(np.sqrt(np.bitwise_count(np.arange(2**17))))
        small, more = information_data(rng, 24, 3, 2)
        self.small = ro.Problem(ro.TraceObjective(small, more), np.repeat(np.arange(8), 3), None, 2, 9)
        self.total = ro.total_curvature(self.f, owners, time_limit=0)
        self.result = ro.solve_maxmin(self.problem, time_limit=2)
        self.certificate = self.folder / "certificate.json"
        ro.certify(self.small, ro.solve_maxmin(self.small, time_limit=5), self.certificate)


@pytest.fixture(scope="module")
def case_of(tmp_path_factory):
    return cache(lambda robots: Case(robots, tmp_path_factory.mktemp(str(robots))))


def call(row, case, limit):
    """What a search returns; ``None`` where it says that there was no time. Every bracket is one."""
    try:
        result = ROWS[row](case, limit)
    except UNDECIDED:
        return None
    lower, upper = getattr(result, "lower", None), getattr(result, "upper", None)
    if lower is not None and upper is not None:
        assert lower <= upper + 1e-9 * abs(upper)
    return result


def test_every_public_function_is_a_row_or_no_search():
    functions = {name for name in ro.__all__ if inspect.isfunction(getattr(ro, name))}
    searches = {row.split()[0] for row in ROWS}
    assert searches | NO_SEARCH == functions
    assert not searches & NO_SEARCH
    for name in searches:
        assert "time_limit" in inspect.signature(getattr(ro, name)).parameters, name


def overrun(row, case, limit):
    """Processor seconds beyond the limit (which a busy machine does not stretch); the least of three calls."""
    call(row, case, 0.3)  # loads modules
    times = []
    for _ in range(3):
        began = time.process_time()
        call(row, case, limit)
        times.append(time.process_time() - began - limit)
        if times[-1] <= 0.4:
            break
    return min(times)


@pytest.mark.parametrize("limit", [0, 0.2])
@pytest.mark.parametrize("row", ROWS)
def test_limits_are_kept(row, limit, case_of):
    assert overrun(row, case_of(24), limit) <= 0.5 + 0.05 * limit


@pytest.mark.slow
@pytest.mark.parametrize("robots", [60, 100])
@pytest.mark.parametrize("row", ROWS)
def test_limits_are_kept_by_larger_teams(row, robots, case_of):
    for limit in (0, 1):
        assert overrun(row, case_of(robots), limit) <= 0.5 + 0.05 * limit


def test_what_is_not_looked_at_in_between_is_not_begun():
    """All sets of 14 robots take half a second to list: no plan of a short search waits for that."""
    robots = 14
    graph, owners = nx.gnp_random_graph(robots, 0.7, seed=0), np.repeat(np.arange(robots), 6)
    problem = ro.Problem(ro.Modular(np.linspace(1, 2, len(owners))), owners, graph, 4, 18)
    ro.solve_maxmin(problem, time_limit=0.3)  # loads
    assert ro.smallest_largest_group(graph, 18, time_limit=0.05).lower >= 1
    assert ro.solve_maxmin(problem, time_limit=0.3).lower > 0


@pytest.mark.parametrize("share", [0.5, 0.65, 0.8, 0.95])
@pytest.mark.parametrize("own", [False, True])
def test_sizes_of_groups_of_large_teams_are_not_all_gone_through(share, own, monkeypatch):
    """416,000 vectors of 200 robots, and more than can be listed of 300, were, whatever the limit."""
    robots, steps = 300, iter(range(1_000_000))
    counted = survivor_sizes.links_within
    monkeypatch.setattr(survivor_sizes, "links_within", lambda *sizes: (next(steps), counted(*sizes))[1])
    f = ro.TraceObjective(*information_data(np.random.default_rng(0), 2 * robots, 1, 2))
    links = int(share * robots * (robots - 1) / 2)
    problem = ro.Problem(Opaque(f) if own else f, np.repeat(np.arange(robots), 2), None, 0, links)
    found = ro.solve_maxmin(problem, time_limit=0)
    assert found.lower <= found.upper
    assert next(steps) > 0


def test_sizes_of_groups_are_listed_once_for_all_plans(monkeypatch):
    """Of a thousand robots they were half a second late for each plan that was attacked."""
    robots, lists = 61, []
    listed = survivor_sizes.iterate_non_dominated_sizes
    monkeypatch.setattr(survivor_sizes, "iterate_non_dominated_sizes", lambda *of: lists.append(of) or listed(*of))
    f = ro.TraceObjective(*information_data(np.random.default_rng(0), 2 * robots, 1, 2))
    problem = ro.Problem(f, np.repeat(np.arange(robots), 2), None, 3, 1200)
    ro.solve_maxmin(problem, time_limit=0.2)
    ro.worst_case_attack(problem, 2 * np.arange(robots), time_limit=0)
    assert lists == [(robots, 3, 1200)]


class Interrupt:
    """A ``KeyboardInterrupt`` after some seconds, as Ctrl-C gives it."""

    def __init__(self, seconds):
        self._seconds = seconds

    def __enter__(self):
        self._before = signal.signal(signal.SIGALRM, self._interrupt)
        signal.setitimer(signal.ITIMER_REAL, self._seconds)
        self.happened = None
        return self

    def _interrupt(self, _, frame):
        # Python drops what is raised while it collects garbage: in a callback of Hypothesis, or of a weak reference.
        if frame is not None and (
            frame.f_code.co_name == "gc_callback" or frame.f_code.co_filename == weakref.__file__
        ):
            signal.setitimer(signal.ITIMER_REAL, 0.01)
            return
        self.happened = time.process_time()
        signal.getsignal(signal.SIGINT)(signal.SIGINT, frame)  # whoever handles interrupts there

    def __exit__(self, *_):
        signal.setitimer(signal.ITIMER_REAL, 0)
        signal.signal(signal.SIGALRM, self._before)


def answer(row, case, seconds):
    """Processor seconds from an interrupt to the answer, and what came back; ``None`` where it propagated."""
    with Interrupt(seconds) as interrupt:
        try:
            result = call(row, case, 30)
        except KeyboardInterrupt:
            result = None
    late = 0.0 if interrupt.happened is None else time.process_time() - interrupt.happened
    return late, result if interrupt.happened else None


def check_interrupted(row, case, seconds):
    call(row, case, 0.3)
    late, result = answer(row, case, seconds)
    assert late <= 1.0
    if hasattr(result, "stop"):
        assert result.stop in {ro.Stop.INTERRUPTED, ro.Stop.CLOSED, ro.Stop.EXHAUSTED, ro.Stop.GAP}


@pytest.mark.parametrize("row", ROWS)
def test_interrupts_are_answered(row, case_of):
    check_interrupted(row, case_of(24), 0.05)


@pytest.mark.slow
@pytest.mark.parametrize("robots", [24, 100])
@pytest.mark.parametrize("row", ROWS)
def test_interrupts_are_answered_at_any_moment(row, robots, case_of):
    rng = random.Random(f"{row} {robots}")
    for _ in range(5):
        check_interrupted(row, case_of(robots), rng.expovariate(2) + 0.001)
