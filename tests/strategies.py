"""Seeded random instances shared by the tests."""

from __future__ import annotations

import networkx as nx
import numpy as np

from ratt_opt.problem import Problem
from ratt_opt.setfunctions.criteria.logdet import LogDetObjective
from ratt_opt.setfunctions.criteria.maxeig import MaxEigenvalueObjective
from ratt_opt.setfunctions.criteria.trace import TraceObjective
from ratt_opt.setfunctions.table import TableFunction

OBJECTIVES = {"trace": TraceObjective, "logdet": LogDetObjective, "maxeig": MaxEigenvalueObjective}


def information_data(rng, n_elements, n_targets, dimension=2):
    """Random priors (M, d, d) and positive semidefinite information (E, M, d, d), some of it rank one or zero."""
    root = rng.normal(size=(n_targets, dimension, dimension))
    prior = root @ root.swapaxes(-1, -2) + 0.3 * np.eye(dimension)
    factor = rng.normal(size=(n_elements, n_targets, dimension, dimension))
    factor[rng.random((n_elements, n_targets)) < 0.3, :, 1:] = 0.0
    factor *= rng.choice([0.0, 0.3, 1.0, 3.0], size=(n_elements, n_targets, 1, 1), p=[0.1, 0.3, 0.4, 0.2])
    return prior, factor @ factor.swapaxes(-1, -2)


def range_bearing(rng, n_robots, n_targets, n_controls=12, side=20.0):
    """Priors and information of robots with range-and-bearing sensors in a square [m], as in Section VI."""
    robots = rng.uniform(0, side, (n_robots, 2))
    targets = rng.uniform(0, side, (n_targets, 2))
    speed = np.array([1.0, -1.0, 3.0, -3.0])[np.arange(n_controls) % 4]
    heading = rng.uniform(0, 2 * np.pi, (n_robots, 1)) + np.array([0.0, 1.0, 3.0])[np.arange(n_controls) // 4 % 3]
    move = speed[None, :, None] * np.stack([np.cos(heading), np.sin(heading)], axis=-1)
    sight = targets - (robots[:, None] + move).reshape(-1, 2)[:, None]
    distance = np.maximum(np.linalg.norm(sight, axis=-1), 0.5)
    unit = sight / distance[..., None]
    across = np.stack([-unit[..., 1], unit[..., 0]], axis=-1)
    bearing = np.abs(np.angle(np.exp(1j * (np.arctan2(sight[..., 1], sight[..., 0]) - heading.reshape(-1, 1)))))
    precision_range = 1 / (0.1 + 0.1 * distance)
    precision_across = 1 / ((0.02 + 0.05 * bearing) * distance**2)
    information = precision_range[..., None, None] * unit[..., :, None] * unit[..., None, :]
    information = information + precision_across[..., None, None] * across[..., :, None] * across[..., None, :]
    prior = np.eye(2) * rng.uniform(1, 5, (n_targets, 1, 1))
    return prior, information


def monotone_table(rng, n):
    """(2**n,) normalised non-decreasing values, otherwise arbitrary; with many ties now and then."""
    steps = rng.integers(0, 3, 2**n).astype(float) if rng.random() < 0.5 else rng.random(2**n)
    values = np.zeros(2**n)
    for mask in range(1, 2**n):
        values[mask] = max(values[mask & ~(1 << i)] for i in range(n) if mask >> i & 1) + steps[mask] * (mask % 3 > 0)
    return values


def random_objective(rng, n_elements, kind=None):
    """An objective over ``n_elements``; ``kind`` is one of OBJECTIVES, or "table" (at most 12 elements)."""
    kinds = [*OBJECTIVES, "table"] if n_elements <= 12 else list(OBJECTIVES)
    kind = kind or str(rng.choice(kinds))
    if kind == "table":
        return TableFunction(monotone_table(rng, n_elements))
    prior, information = information_data(rng, n_elements, int(rng.integers(1, 4)), int(rng.integers(1, 4)))
    return OBJECTIVES[kind](prior, information)


def random_graph(rng, n_robots):
    """A random graph on ``0..N-1``, connected or not, complete now and then."""
    density = rng.choice([0.0, 0.3, 0.5, 0.8, 1.0])
    graph = nx.Graph()
    graph.add_nodes_from(range(n_robots))
    graph.add_edges_from((i, j) for j in range(n_robots) for i in range(j) if rng.random() < density)
    return graph


def random_problem(rng, n_robots=None, *, kind=None, protect=True, complete=None, controls=3):
    """A small random problem: ragged controls, shuffled owners, any graph, any budget, protected parts."""
    n_robots = n_robots or int(rng.integers(1, 6))
    counts = rng.integers(1, controls + 1, n_robots)
    owners = rng.permutation(np.repeat(np.arange(n_robots), counts))
    graph = random_graph(rng, n_robots)
    if complete or (complete is None and rng.random() < 0.3):
        graph = nx.complete_graph(n_robots)
    links = sorted((min(e), max(e)) for e in graph.edges)
    protect = protect and rng.random() < 0.4
    return Problem(
        random_objective(rng, len(owners), kind),
        owners,
        None if complete and rng.random() < 0.5 else graph,
        int(rng.integers(0, n_robots + 1)),
        int(rng.integers(0, len(links) + 1)),
        frozenset(i for i in range(n_robots) if protect and rng.random() < 0.3),
        frozenset(link for link in links if protect and rng.random() < 0.3),
    )


def random_elements(rng, problem):
    """A random plan."""
    return np.array([rng.choice(choice) for choice in problem.choices])
