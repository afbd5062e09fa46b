"""Places of robots on a map: after their controls, now, or by a layout of the communication graph."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from ratt_opt._validation import FloatArray, IntArray
    from ratt_opt.problem import Problem
    from ratt_opt.report.description import Description

__all__ = ["robot_places"]


def robot_places(problem: Problem, elements: IntArray, known: Description) -> FloatArray:
    """(N, 2) where to draw the robots of a plan (N,); a circle if every link is there and no place is known."""
    if known.poses_after is not None:
        return known.poses_after[elements][:, :2]
    if known.poses is not None:
        return known.poses[:, :2]
    import networkx as nx

    n, links = problem.n_robots, sorted(problem.communication.links)
    graph = nx.Graph(links)
    graph.add_nodes_from(range(n))
    laid = nx.circular_layout(graph) if len(links) == n * (n - 1) // 2 else nx.spring_layout(graph, seed=0)
    return np.array([laid[i] for i in range(n)], dtype=np.float64)
