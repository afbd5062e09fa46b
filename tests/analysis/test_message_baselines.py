"""Baselines of the study of messages, on networks where their plans are known."""

import networkx as nx
import numpy as np

import ratt_opt as ro
from analysis.decentralised.clique_selection import clique_selection, cliques_of
from analysis.decentralised.neighbour_greedy import neighbour_greedy
from analysis.decentralised.worth import STUDY, problem_of
from ratt_opt.planners import PUBLISHED
from ratt_opt.studies import Seeds
from tests.strategies import information_data


def team(graph, seed=0, alpha_s=1):
    rng = np.random.default_rng(seed)
    owner = np.repeat(np.arange(len(graph)), 3)
    return ro.Problem(ro.TraceObjective(*information_data(rng, len(owner), 3)), owner, graph, alpha_s, 0)


def test_without_links_every_baseline_is_myopic_and_takes_no_time():
    problem = team(nx.empty_graph(5), alpha_s=0)
    for way in (neighbour_greedy, clique_selection):
        elements, seconds = way(problem)
        assert list(elements) == list(ro.myopic(problem))
        assert seconds == 0.0


def test_sequential_greedy_on_a_complete_network_is_the_published_planner():
    for seed in range(20):
        problem = team(nx.complete_graph(5), seed)
        assert list(neighbour_greedy(problem)[0]) == list(PUBLISHED["sequential_greedy"].plan(problem))


def test_one_clique_makes_the_plan_against_sensing_attacks():
    for seed in range(20):
        problem = team(nx.complete_graph(5), seed, alpha_s=2)
        assert list(clique_selection(problem)[0]) == list(ro.ratt(problem))


def test_cliques_hold_every_robot_once():
    for seed in range(20):
        graph = nx.gnp_random_graph(9, 0.5, seed=seed)
        cliques = cliques_of(team(graph, seed))
        assert sorted(i for clique in cliques for i in clique) == list(range(9))
        assert all(graph.has_edge(i, j) for clique in cliques for i in clique for j in clique if i < j)


def test_teams_of_the_study_are_the_same_for_the_same_seeds():
    for case in STUDY.cases:
        one, again = (problem_of(case, Seeds.of(0, 1)) for _ in range(2))
        assert one.communication == again.communication
        assert np.array_equal(one.information_objective.information, again.information_objective.information)
