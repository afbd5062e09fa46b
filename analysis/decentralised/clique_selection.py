"""Resilient selection in cliques: robots that all hear each other plan as one, every clique alone.

Cliques are taken greedily, the largest one among the robots left (they are given, and cost nothing here). Each robot
sends all of its elements to the others of its clique; each clique prepares for ``alpha_s`` lost robots of its own.

Source: the division into cliques of DRM: Zhou, Tzoumas, Pappas, Tokekar, Distributed attack-robust submodular
maximization for multi-robot planning, 2020.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import networkx as nx
import numpy as np

from analysis.decentralised.radio import RADIO, element_bytes, sending
from ratt_opt.problem import Problem
from ratt_opt.solvers.ratt import bait_and_greedy

if TYPE_CHECKING:
    from ratt_opt._validation import IntArray

__all__ = ["clique_selection", "cliques_of"]


def cliques_of(problem: Problem) -> list[list[int]]:
    """Disjoint cliques that hold all robots: each the largest one left, the lowest robots among equals."""
    graph = nx.empty_graph(problem.n_robots)
    graph.add_edges_from(problem.communication.links)
    found: list[list[int]] = []
    while len(graph):
        largest = max(map(sorted, nx.find_cliques(graph)), key=lambda clique: (len(clique), [-i for i in clique]))
        found.append(largest)
        graph.remove_nodes_from(largest)
    return found


def clique_selection(problem: Problem) -> tuple[IntArray, float]:
    """Return the plan (N,) and its decision time [s]."""
    elements, slowest = np.zeros(problem.n_robots, dtype=np.int64), 0.0
    for clique in cliques_of(problem):
        own = np.flatnonzero(np.isin(problem.robot, clique))
        owner = np.searchsorted(clique, problem.robot[own])
        alone = Problem(problem.information_objective.restricted_to(own), owner, None, 0, 0)
        elements[clique] = own[bait_and_greedy(alone, problem.alpha_s).elements]
        if len(clique) > 1:
            most = max(len(problem.choices[i]) for i in clique)
            time = (len(clique) - 1) * sending(element_bytes(problem, most)) + RADIO.delay[1]
            slowest = max(slowest, time)
    return elements, slowest
