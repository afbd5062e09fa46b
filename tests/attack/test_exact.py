import pickle
from itertools import count

import networkx as nx
import numpy as np
import pytest

import ratt_opt as ro
from ratt_opt.budget import Budget
from tests.brackets import attained, attains, is_exact, worst_value
from tests.oracles import brute_force_worst_case
from tests.strategies import random_elements, random_problem, range_bearing


@pytest.mark.parametrize("seed", range(200))
def test_value_is_the_definition_s(seed):
    rng = np.random.default_rng(seed)
    problem = random_problem(rng)
    elements = random_elements(rng, problem)
    result = ro.worst_case_attack(problem, elements)
    assert is_exact(problem, elements, result)
    assert worst_value(problem, elements) == pytest.approx(
        brute_force_worst_case(problem, elements), rel=1e-12, abs=1e-12
    )
    assert result.stop in (ro.Stop.EXHAUSTED, ro.Stop.CLOSED)  # both say that the lower end is proved


@pytest.mark.parametrize("seed", range(30))
def test_value_is_the_definition_s_for_any_set_function(seed):
    """Nothing is assumed of the objective: random tables, monotone or not, normalised or not."""
    rng = np.random.default_rng(seed)
    draft = random_problem(rng, kind="logdet", controls=2)
    table = ro.TableFunction(rng.normal(size=2**draft.objective.n))
    problem = ro.Problem(
        table, draft.robot, draft.graph, draft.alpha_s, draft.alpha_c, draft.protected_robots, draft.protected_links
    )
    elements = random_elements(rng, problem)
    result = ro.worst_case_attack(problem, elements)
    assert result.upper == brute_force_worst_case(problem, elements)


@pytest.mark.parametrize("seed", range(8))
def test_the_bracket_is_valid_wherever_the_search_stops(seed):
    rng = np.random.default_rng(seed)
    problem = random_problem(rng, 6)
    elements = random_elements(rng, problem)
    full = ro.worst_case_attack(problem, elements)
    for nodes in range(full.nodes + 2):
        part = ro.worst_case_attack(problem, elements, max_nodes=nodes, brief=True)
        assert part.lower <= full.upper <= part.upper
        assert attains(problem, elements, part)
        assert part.nodes <= nodes
        is_closed = part.lower >= part.upper - 1e-9 * abs(part.upper)  # what is known at once may do
        assert (part.stop is ro.Stop.NODES) == (nodes < full.nodes and not is_closed)


def test_budgets_are_checked_and_kept():
    rng = np.random.default_rng(3)  # what is known at once does not close it
    problem = random_problem(rng, 5, kind="trace", complete=True)
    elements = random_elements(rng, problem)
    assert ro.worst_case_attack(problem, elements, time_limit=0).stop is ro.Stop.TIME
    with pytest.raises(ro.InputError, match="max_nodes"):
        ro.worst_case_attack(problem, elements, max_nodes=-1, brief=True)
    with pytest.raises(ro.InputError, match="time_limit"):
        ro.worst_case_attack(problem, elements, time_limit=float("nan"))


@pytest.mark.parametrize("n_robots", [6, 14, 24])
@pytest.mark.parametrize("complete", [True, False])
def test_an_outer_budget_counts_too(n_robots, complete):
    """Its seconds are over, or its user interrupted: the attack ends at once with what the first heuristic found."""
    rng = np.random.default_rng(n_robots)
    graph = None if complete else nx.cycle_graph(n_robots)
    plan = np.arange(n_robots)
    problem = ro.Problem(ro.TraceObjective(*range_bearing(rng, n_robots, 3, 1)), plan, graph, 2, 4)
    interrupted = Budget()
    interrupted.interrupt()
    for outer, stop in ((Budget(0.0), ro.Stop.TIME), (interrupted, ro.Stop.INTERRUPTED)):
        result = ro.worst_case_attack(problem, plan, time_limit=60.0, budget=outer)
        assert (result.stop, result.nodes) == (stop, 0)
        assert result.lower <= attained(problem, plan, result)
        assert attains(problem, plan, result)


@pytest.mark.parametrize("family", [None, "disk-6", "dense"])
@pytest.mark.parametrize("n_robots", [8, 14, 21])
def test_an_attack_that_meets_the_aim_ends_the_search(family, n_robots):
    scenario = ro.random_scenario(n_robots, 5, alpha_s=2, alpha_c=12, seed=1)
    if family is not None:
        scenario = ro.network_scenario(family, n_robots, 5, alpha_s=2, alpha_c=6, seed=1)
    problem = scenario.problem()
    plan = ro.ratt(problem).elements
    worst = ro.worst_case_attack(problem, plan)
    for aim in (worst.upper * (1 + 1e-6), problem.team_value(plan, ro.Attack())):
        result = ro.worst_case_attack(problem, plan, aim=aim)
        assert result.stop in {ro.Stop.GAP, worst.stop}
        assert result.lower <= worst.upper <= result.upper <= aim
        assert attains(problem, plan, result)
    assert result.stop is ro.Stop.GAP
    assert ro.worst_case_attack(problem, plan, aim=worst.lower * (1 - 1e-6)) == worst
    with pytest.raises(ro.InputError, match="aim"):
        ro.worst_case_attack(problem, plan, aim=np.nan)


@pytest.mark.parametrize("n_robots", [8, 21])
def test_no_result_is_better_for_the_team_than_a_known_attack(n_robots):
    problem = ro.network_scenario("disk-6", n_robots, 5, alpha_s=2, alpha_c=6, seed=1).problem()
    plan = ro.ratt(problem).elements
    worst = ro.worst_case_attack(problem, plan)
    for seed in range(3):
        known = ro.random_attack(problem, plan, seed=seed).attack
        result = ro.worst_case_attack(problem, plan, known=known, max_nodes=0, brief=True)
        assert result.lower <= worst.upper <= result.upper <= problem.team_value(plan, known)
    assert ro.worst_case_attack(problem, plan, known=worst.attack, max_nodes=0, brief=True).upper == worst.upper
    with pytest.raises(ro.InputError, match="attack robot"):
        ro.worst_case_attack(problem, plan, known=ro.Attack(frozenset({n_robots})))


@pytest.mark.parametrize("n_robots", [5, 14])
def test_results_are_plain_values(n_robots):
    rng = np.random.default_rng(1)
    plan = np.arange(n_robots)
    problem = ro.Problem(ro.LogDetObjective(*range_bearing(rng, n_robots, 3, 1)), plan, None, 2, n_robots)
    result = ro.worst_case_attack(problem, plan)
    assert result == ro.worst_case_attack(problem, plan)
    assert pickle.loads(pickle.dumps(result)) == result
    assert result != ro.greedy_attack(problem, plan)
    assert [type(x) for x in (result.lower, result.upper, result.nodes, result.evaluations)] == [float, float, int, int]
    assert len(repr(result)) < 150
    assert f"{len(result.attack.links)} links cut" in repr(result)


class Impatient(ro.SetFunction):
    """Raises a keyboard interrupt at the k-th batch of evaluations."""

    def __init__(self, inner, batches):
        self.inner, self.left = inner, batches

    @property
    def n(self):
        return self.inner.n

    def evaluate(self, membership):
        self.left -= 1
        if self.left == 0:
            raise KeyboardInterrupt
        return self.inner.evaluate(membership)


def interruptible(n_robots, graph, batches):
    prior, information = range_bearing(np.random.default_rng(3), n_robots, 4, 1)
    objective = Impatient(ro.LogDetObjective(prior, information), batches)
    return ro.Problem(objective, np.arange(n_robots), graph, 2, 5)


@pytest.mark.parametrize("graph", [None, nx.cycle_graph(6)])
def test_an_interrupt_at_any_batch_returns_the_bracket(graph):
    """How many batches there are depends on the clock: a slow function has smaller ones."""
    plan = np.arange(6)
    expected = ro.worst_case_attack(interruptible(6, graph, 0), plan)
    for batches in count(1):
        problem = interruptible(6, graph, batches)
        result = ro.worst_case_attack(problem, plan)
        if problem.objective.left > 0:
            break
        assert result.stop is ro.Stop.INTERRUPTED
        assert 0.0 <= result.lower <= expected.upper <= result.upper
        assert attains(problem, plan, result)
    assert batches > 5
    assert result == expected


def test_an_interrupt_is_heard_by_the_searches_around():
    problem = interruptible(6, None, 2)
    outer = Budget()
    assert ro.worst_case_attack(problem, np.arange(6), budget=outer).stop is ro.Stop.INTERRUPTED
    assert outer.stop() is ro.Stop.INTERRUPTED


def test_a_search_that_is_stopped_relies_on_no_property_of_the_objective():
    """The value of no measurement is no lower bound here: the table's least value is."""
    values = np.random.default_rng(0).normal(size=2**4)
    values[0] = values.max() + 1
    problem = ro.Problem(ro.TableFunction(values), np.arange(4), None, 1, 2)
    expected = brute_force_worst_case(problem, np.arange(4))
    for nodes in range(4):
        result = ro.worst_case_attack(problem, np.arange(4), max_nodes=nodes, brief=True)
        assert result.lower <= expected <= result.upper
