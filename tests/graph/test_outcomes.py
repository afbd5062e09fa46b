import networkx as nx
import numpy as np
import pytest

from ratt_opt import InputError, count_outcomes, non_dominated_outcomes, realise
from ratt_opt.graph.communication import CommunicationGraph
from ratt_opt.graph.threat import Threat
from tests.oracles import brute_force_outcomes, groups_left
from tests.strategies import random_problem


@pytest.mark.parametrize(
    ("n_robots", "alpha_s", "alpha_c", "count"),
    [(4, 1, 3, 12), (4, 1, 4, 12), (4, 2, 3, 6), (4, 2, 4, 6), (10, 3, 11, 840), (10, 5, 15, 1260), (10, 6, 22, 1260)],
)
def test_counts_of_the_paper_s_settings(n_robots, alpha_s, alpha_c, count):
    threat = Threat(CommunicationGraph.complete(n_robots), alpha_s, alpha_c)
    outcomes = list(non_dominated_outcomes(threat))
    assert count_outcomes(threat) == len(outcomes) == len(set(outcomes)) == count


@pytest.mark.parametrize("seed", range(150))
def test_outcomes_are_those_of_the_definition(seed):
    problem = random_problem(np.random.default_rng(seed), kind="logdet")
    outcomes = list(non_dominated_outcomes(problem.threat))
    assert len(outcomes) == len(set(outcomes))
    assert {frozenset(o) for o in outcomes} == brute_force_outcomes(problem)
    for outcome in outcomes:
        assert list(outcome) == sorted(outcome, key=lambda g: min(g, default=0))
    if problem.threat.links_alike:
        assert count_outcomes(problem.threat) == len(outcomes)


@pytest.mark.parametrize("seed", range(60))
def test_every_outcome_is_realised_within_budget(seed):
    problem = random_problem(np.random.default_rng(1000 + seed), kind="logdet")
    threat = problem.threat
    for outcome in non_dominated_outcomes(threat):
        blinded, cut = realise(threat, outcome)
        assert len(blinded) <= threat.alpha_s
        assert len(cut) <= threat.alpha_c
        assert not blinded & threat.protected_robots
        assert not cut & threat.protected_links
        left = {rest for group in groups_left(problem, cut) if (rest := group - blinded)}
        assert left == {group for group in outcome if group}


def test_everyone_blinded_leaves_one_empty_outcome():
    threat = Threat(CommunicationGraph.complete(3), 3, 2)
    assert list(non_dominated_outcomes(threat)) == [(frozenset(),)]
    assert realise(threat, (frozenset(),)) == (frozenset(range(3)), frozenset())
    assert count_outcomes(threat) == 1


def test_a_graph_too_large_names_the_method_that_would_do():
    graph = CommunicationGraph.from_networkx(nx.path_graph(13), 13)
    with pytest.raises(InputError, match="use worst_case_attack"):
        non_dominated_outcomes(Threat(graph, 1, 1))
    with pytest.raises(InputError, match="enumerate them"):
        count_outcomes(Threat(graph, 1, 1))


def test_a_large_complete_graph_is_enumerated_lazily():
    threat = Threat(CommunicationGraph.complete(30), 15, 145)
    first = next(iter(non_dominated_outcomes(threat)))
    assert sorted(map(len, first), reverse=True) in ([10, 1, 1, 1, 1, 1], [9, 6])
    assert count_outcomes(threat) > 10**9
