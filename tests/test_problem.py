"""Problem, attack and plan: meanings and refusals."""

import copy
import json
import pickle
from dataclasses import replace
from functools import partial

import networkx as nx
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import ratt_opt as ro
from ratt_opt import Attack, InputError, Plan, Problem, TableFunction, TraceObjective
from ratt_opt._validation import check_integer, integer_array
from ratt_opt.graph.communication import CommunicationGraph

MODULAR = TableFunction([bin(mask).count("1") for mask in range(16)])
WEIGHTED = TableFunction([sum(10.0**i for i in range(4) if mask >> i & 1) for mask in range(16)])


def _line(n: int) -> nx.Graph:
    return nx.path_graph(n)


def test_team_value_is_the_best_group() -> None:
    problem = Problem(WEIGHTED, np.arange(4), _line(4), 1, 1)
    assert problem.team_value([0, 1, 2, 3], Attack()) == 1111
    assert problem.team_value([0, 1, 2, 3], Attack(links=frozenset({(1, 2)}))) == 1100
    assert problem.team_value([0, 1, 2, 3], Attack(sensing=frozenset({3}))) == 111
    assert problem.team_value([0, 1, 2, 3], Attack(frozenset({3}), frozenset({(1, 2)}))) == 100


def test_a_blinded_robot_still_relays() -> None:
    problem = Problem(WEIGHTED, np.arange(4), _line(4), 1, 0)
    assert problem.team_value([0, 1, 2, 3], Attack(sensing=frozenset({1}))) == 1101


def test_no_survivor_is_worth_the_empty_set() -> None:
    problem = Problem(WEIGHTED, np.arange(4), None, 4, 0)
    assert problem.team_value([0, 1, 2, 3], Attack(sensing=frozenset(range(4)))) == 0


def test_attributes_are_kept() -> None:
    graph = _line(2)
    problem = Problem(MODULAR, [0, 0, 1, 1], graph, 1, 1)
    assert problem.objective is MODULAR
    assert problem.graph is not None
    assert sorted(problem.graph.edges) == sorted(graph.edges)
    assert (problem.alpha_s, problem.alpha_c, problem.n_robots) == (1, 1, 2)
    assert problem.robot.tolist() == [0, 0, 1, 1]
    assert [c.tolist() for c in problem.choices] == [[0, 1], [2, 3]]
    assert Problem(MODULAR, [0, 0, 1, 1], None, 0, 0).graph is None


def test_interleaved_and_ragged_owners() -> None:
    problem = Problem(MODULAR, [1, 0, 1, 1], None, 0, 0)
    assert [c.tolist() for c in problem.choices] == [[1], [0, 2, 3]]
    assert problem.team_value([1, 3], Attack()) == 2


@pytest.mark.parametrize(
    ("change", "text"),
    [
        ({"alpha_s": 3}, r"alpha_s must be an integer in \[0, 2\]; got 3"),
        ({"alpha_s": -1}, r"alpha_s must be"),
        ({"alpha_c": 2}, r"alpha_c must be an integer in \[0, 1\]; got 2"),
        ({"alpha_c": True}, r"alpha_c must be"),
        ({"robot": [0, 0, 2, 2]}, "none for robot 1"),
        ({"robot": [0, 0, 1]}, r"robot must have shape \(4,\)"),
        ({"robot": [0.5, 0, 1, 1]}, "robot must hold integers"),
        ({"robot": [0, False, 1, 1]}, "robot must hold integers"),
        ({"robot": [0, 0, True, 1]}, "robot must hold integers"),
        ({"robot": [[0], [0, 1], 1, 1]}, "robot must hold integers"),
        ({"robot": [-1, 0, 1, 1]}, "robot must hold robots >= 0"),
        ({"objective": 3}, "objective must be a SetFunction; got int"),
        ({"graph": nx.path_graph(3)}, r"graph must have the nodes 0..1; got \[0, 1, 2\]"),
        (
            {"graph": nx.Graph([(0, 1), (1, 1)])},
            r"graph must have no self-loop \(communication_graph makes one\); got",
        ),
        ({"graph": nx.Graph([("a", "b")])}, r"the nodes 0..1 \(communication_graph makes one\); got"),
        (
            {"graph": nx.DiGraph([(0, 1)])},
            r"graph must be an undirected networkx.Graph \(communication_graph makes one\); got DiGraph",
        ),
        (
            {"graph": nx.MultiGraph([(0, 1)])},
            r"graph must be an undirected networkx.Graph \(communication_graph makes one\); got MultiGraph",
        ),
        (
            {"graph": "complete"},
            "graph must be an undirected networkx.Graph; got str",
        ),
        ({"protected_robots": {5}}, "protected robot must be an integer in"),
        ({"protected_links": {(0, 3)}}, "protected link must be a link of the graph"),
    ],
)
def test_bad_problems_are_refused(change: dict[str, object], text: str) -> None:
    arguments: dict[str, object] = {
        "objective": MODULAR,
        "robot": [0, 0, 1, 1],
        "graph": None,
        "alpha_s": 0,
        "alpha_c": 0,
    }
    with pytest.raises(InputError, match=text) as caught:
        Problem(**(arguments | change))  # type: ignore[arg-type]
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize(
    ("elements", "text"),
    [
        ([0, 1], r"elements\[1\] must be an element of robot 1; got 1 of robot 0"),
        ([0], "one element per robot"),
        ([0, 4], r"elements\[1\] must be an integer in \[0, 3\]"),
        ([0.5, 2.0], r"elements\[0\] must be an integer"),
        ([[0, 2]], "one element per robot"),
        ([True, 2], r"elements\[0\] must be an integer in \[0, 3\]; got True"),
        ([0, 2**70], r"elements\[1\] must be an integer in \[0, 3\]"),
        ([np.zeros((2, 2)), np.zeros((2, 3))], "one element per robot"),
    ],
)
def test_bad_plans_are_refused(elements: object, text: str) -> None:
    problem = Problem(MODULAR, [0, 0, 1, 1], None, 1, 1)
    with pytest.raises(InputError, match=text):
        problem.team_value(elements, Attack())  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("attack", "text"),
    [
        (Attack(frozenset({2})), "attack robot must be an integer in"),
        (Attack(frozenset({0, 1})), "must blind at most alpha_s = 1 robots; got 2"),
        (Attack(links=frozenset({(0, 5)})), "attack link must be a link of the graph"),
        (Attack(frozenset({1})), "attack robot must not be protected"),
        (Attack(links=frozenset({(0, 1)})), "attack link must not be protected"),
    ],
)
def test_attacks_outside_the_threat_are_refused(attack: Attack, text: str) -> None:
    protected = (
        {"protected_robots": frozenset({1}), "protected_links": frozenset({(0, 1)})} if "protected" in text else {}
    )
    problem = Problem(MODULAR, [0, 0, 1, 1], None, 1, 1, **protected)  # type: ignore[arg-type]
    with pytest.raises(InputError, match=text):
        problem.team_value([0, 2], attack)


def test_a_link_is_given_lowest_first() -> None:
    with pytest.raises(InputError, match="i < j"):
        Attack(links=frozenset({(2, 1)}))


def test_plans_are_values() -> None:
    plan = Plan(elements=np.array([0, 3]), evaluations=4, bait=(1,), alpha_cs=1)
    other = pickle.loads(pickle.dumps(plan))
    assert plan == other
    assert len({plan, other, copy.deepcopy(plan)}) == 1
    assert plan != replace(plan, elements=np.array([0, 2]))
    assert plan != replace(plan, alpha_cs=None)
    assert repr(plan) == "Plan(elements=[0, 3], evaluations=4, bait=(1,), alpha_cs=1)"
    assert repr(replace(plan, elements=np.arange(20))).startswith(
        "Plan(elements=[0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, ... 8 more], "
    )


def test_groups_left_are_the_non_blinded_robots_of_each_component() -> None:
    problem = Problem(MODULAR, [0, 0, 1, 2], nx.path_graph(3), 1, 1)
    assert problem.groups_left(Attack(frozenset({0}), frozenset({(0, 1)}))) == [frozenset(), frozenset({1, 2})]


def test_robots_and_links_are_integers_of_any_kind_given_once() -> None:
    one, three = np.int32(1), np.uint8(3)
    assert Attack([one, 2], [(one, three)]) == Attack({1, 2}, {(1, 3)})  # type: ignore[arg-type]
    for wrong in (True, np.True_, 1.5, "1", None):
        with pytest.raises(InputError, match="attack robot must be an integer"):
            Attack([wrong])  # type: ignore[arg-type]
        with pytest.raises(InputError, match="attack link must be an integer"):
            Attack(links=[(wrong, 3)])  # type: ignore[arg-type]
        with pytest.raises(InputError, match="protected link must be an integer"):
            Problem(MODULAR, range(4), None, 1, 1, protected_links=[(wrong, 3)])  # type: ignore[arg-type]
    for pair in ((1,), (1, 2, 3), 1):
        with pytest.raises(InputError, match="attack link must be a pair of robots"):
            Attack(links=[pair])  # type: ignore[arg-type, list-item]
    with pytest.raises(InputError, match="attack robot must not be repeated; got 2"):
        Attack([1, 2, np.int64(2)])  # type: ignore[arg-type]
    with pytest.raises(InputError, match=r"attack link must not be repeated; got \(0, 1\)"):
        Attack(links=[(0, 1), (0, 1)])  # type: ignore[arg-type]
    with pytest.raises(InputError, match="protected robot must not be repeated; got 1"):
        Problem(MODULAR, range(4), None, 1, 1, protected_robots=[1, 1])  # type: ignore[arg-type]
    with pytest.raises(InputError, match=r"protected link must not be repeated; got \(0, 1\)"):
        Problem(MODULAR, range(4), None, 1, 1, protected_links=[(0, 1), (1, 0)])  # type: ignore[arg-type]


def test_graphs_may_have_numpy_nodes_but_no_booleans() -> None:
    many = nx.Graph((np.int64(i), np.int64(i + 1)) for i in range(69))
    graph = CommunicationGraph.from_networkx(many, 70)
    assert graph.groups(cut=[(34, 35)]) == (frozenset(range(35)), frozenset(range(35, 70)))
    with pytest.raises(InputError, match="graph must have the nodes"):
        CommunicationGraph.from_networkx(nx.Graph([(False, True)]), 2)


@pytest.mark.parametrize(
    ("prior", "information", "text"),
    [
        ([[1e-200]], [[1.0]], r"prior\[0\] must have eigenvalues of at least 1e-100"),
        ([[1e200]], [[1.0]], r"prior must have entries of size at most 1e\+100"),
        ([[1.0]], [[1e300]], r"information must have entries of size at most 1e\+100"),
        ([[1e7]], [[3e7]], r"information\[0, 0\] must be at most 2e\+14 times the inverse of prior\[0\]"),
        ([[1e9, 0.0], [0.0, 1.0]], [[1.0, 1.0], [1.0, 1 - 1e-9]], "must not be negative anywhere by more than 0.01"),
    ],
)
def test_numbers_that_floating_point_loses_beside_each_other_are_refused(
    prior: list[list[float]], information: list[list[float]], text: str
) -> None:
    with pytest.raises(InputError, match=text):
        TraceObjective([prior], [[information]])
    with pytest.raises(InputError, match=r"weights must be in \[1e-100, 1e\+100\]"):
        TraceObjective([[[1.0]]], [[[[1.0]]]], [1e-200])


@pytest.mark.parametrize("given", [ro.random_scenario(2, 1, alpha_s=0, alpha_c=0, seed=0), None])
def test_planners_and_attackers_say_that_they_want_a_problem(given: object) -> None:
    planners = (ro.ratt, ro.greedy, ro.myopic, ro.nonrobust_optimum, ro.solve_maxmin, ro.exhaustive_optimum)
    attackers = (ro.worst_case_attack, ro.greedy_attack, ro.bounded_rational_attack, ro.criticality_ranking)
    calls = [*planners, partial(ro.random_plan, seed=0), *(partial(f, elements=[0, 12]) for f in attackers)]
    for call in calls:
        with pytest.raises(InputError, match=r"problem must be a Problem, as scenario.problem\(\) returns; got"):
            call(given)


@given(st.lists(st.integers(0, 2**40), max_size=8))
def test_a_plan_iterates_as_python_integers(elements: list[int]) -> None:
    plan = Plan(elements=np.array(elements, dtype=np.int64), evaluations=0)
    assert json.loads(json.dumps(list(plan))) == elements


@given(st.integers(0, 2**53), st.sampled_from([float, np.float64]))
def test_a_float_that_is_an_integer_counts_as_it(number: int, kind: type) -> None:
    assert check_integer("k", kind(number), low=0) == number
    assert type(check_integer("k", kind(number), low=0)) is int
    assert integer_array([kind(number), 1]).tolist() == [number, 1]


@given(st.floats().filter(lambda x: not (x.is_integer() and abs(x) <= 2**53)))
def test_a_float_that_may_be_rounded_is_no_integer(number: float) -> None:
    with pytest.raises(InputError, match="must be an integer"):
        check_integer("k", number, low=-(2**1030))
    assert integer_array([number]).dtype == object


@pytest.mark.parametrize("seed", range(5))
def test_a_problem_does_not_change_with_what_it_was_made_of(seed: int) -> None:
    """The owner goes on writing to the graph and the arrays: every copy and every search answers as before."""
    rng = np.random.default_rng(seed)
    graph = nx.path_graph(5)
    prior, information, owners = np.ones((2, 1, 1)) * 4, rng.exponential(size=(10, 2, 1, 1)), np.repeat(np.arange(5), 2)
    problem = Problem(ro.TraceObjective(prior, information), owners, graph, 1, 1)
    plan = [0, 2, 4, 6, 8]

    def answers() -> tuple[object, ...]:
        ranking = ro.criticality_ranking(problem, plan)
        attack = ro.worst_case_attack(problem, plan)
        return attack.upper, replace(problem, alpha_c=0).communication.links, ranking, ro.solve_maxmin(problem).upper

    before = answers()
    graph.add_edges_from([(0, 2), (0, 3), (0, 4), (1, 4)])
    prior *= 100
    information *= 0.01
    owners[:] = 0
    assert answers() == before
    with pytest.raises(nx.NetworkXError, match="rozen"):
        problem.graph.add_edge(0, 2)


def test_a_plan_or_a_result_stands_for_its_elements():
    problem = ro.random_scenario(4, 3, alpha_s=1, alpha_c=1, seed=0).problem()
    for plan in (ro.ratt(problem), ro.solve_maxmin(problem), ro.refined(problem, time_limit=None, max_kicks=2)):
        known = ro.worst_case_attack(problem, plan.elements)
        assert ro.worst_case_attack(problem, plan) == known
        assert problem.team_value(plan, known.attack) == problem.team_value(plan.elements, known.attack)
        assert ro.criticality_ranking(problem, plan) == ro.criticality_ranking(problem, plan.elements)
        assert np.asarray(plan).tolist() == plan.elements.tolist()
