"""Random teams, random faults, and what they must lead to by the definition: RATT for each component that is left."""

import networkx as nx
import numpy as np

import ratt_opt as ro
from ratt_opt import Faults, Problem, RadioParams
from tests.strategies import OBJECTIVES, information_data


def team(rng, n_robots=None, *, objective=None, most=7):
    """A connected team: shuffled elements, budgets from nothing to everything; every second one is full of ties."""
    n = n_robots or int(rng.integers(1, most + 1))
    targets = int(rng.integers(1, 4))
    owner = rng.permutation(np.repeat(np.arange(n), rng.integers(1, 4, n)))
    prior, information = information_data(rng, len(owner), targets)
    if rng.random() < 0.5:
        rows = rng.integers(-1, 2, (len(owner), targets, 2)).astype(float)
        prior, information = np.tile(np.eye(2), (targets, 1, 1)), rows[..., :, None] * rows[..., None, :]
    f = OBJECTIVES[objective or str(rng.choice(sorted(OBJECTIVES)))](prior, information)
    graph = connected_graph(rng, n, rng.uniform(0, 1))
    links = sorted(tuple(sorted(link)) for link in graph.edges)
    kept = [link for link in links if rng.random() < 0.2]
    return Problem(f, owner, graph, int(rng.integers(0, n + 1)), int(rng.integers(0, len(links) + 1)), (), kept)


def connected_graph(rng, n, density):
    """A random tree, and other links at random."""
    graph = nx.empty_graph(n)
    order = rng.permutation(n)
    graph.add_edges_from((int(order[k]), int(order[rng.integers(k)])) for k in range(1, n))
    graph.add_edges_from((i, j) for i in range(n) for j in range(i) if rng.random() < density)
    return graph


def radio_faults(rng, **more):
    """Losses, duplicates, and delays so different that packets overtake."""
    delay = (0.001, float(rng.choice([0.001, 0.1, 1.0])))
    loss, duplicates = float(rng.choice([0.0, 0.2, 0.6])), float(rng.choice([0.0, 0.4]))
    return Faults(loss=loss, duplicates=duplicates, radio=RadioParams(delay=delay), **more)


def breaking_faults(rng, problem, rounds=12):
    """Cuts, blindings and crashes at random rounds."""
    links = sorted(problem.communication.links)
    at = lambda: int(rng.integers(0, rounds))  # noqa: E731
    cuts = [(at(), *links[k]) for k in range(len(links)) if rng.random() < rng.choice([0.0, 0.2, 0.6])]
    robots = range(problem.n_robots)
    blinded = [(at(), i) for i in robots if rng.random() < 0.2]
    crashed = [(at(), i) for i in robots if rng.random() < rng.choice([0.0, 0.2])]
    return radio_faults(rng, cuts=tuple(cuts), blinded=tuple(blinded), crashed=tuple(crashed))


def parts(problem, plan):
    """Each component that is left without crashed robots: its robots, its elements, and its problem, by definition."""
    crashed = {who[0] for _, kind, who in plan.faults_met if kind == "crashed"}
    blind = [who[0] for _, kind, who in plan.faults_met if kind == "blinded"]
    cut = {tuple(sorted(who)) for _, kind, who in plan.faults_met if kind == "cut"}
    f = problem.objective
    seen = np.where(np.isin(problem.robot, blind)[:, None, None, None], 0.0, f.information)
    for group in plan.components:
        if set(group) & crashed:
            continue
        own = np.flatnonzero(np.isin(problem.robot, group))
        place = {robot: k for k, robot in enumerate(group)}
        links = [link for link in problem.communication.links if set(link) <= set(group) and link not in cut]
        graph = nx.empty_graph(len(group))
        graph.add_edges_from((place[i], place[j]) for i, j in links)
        kept = [(place[i], place[j]) for i, j in problem.protected_links if (i, j) in links]
        alone = Problem(
            f.with_information(seen[own]),
            [place[int(i)] for i in problem.robot[own]],
            graph,
            min(problem.alpha_s, len(group)),
            min(problem.alpha_c, len(links)),
            [place[i] for i in problem.protected_robots if i in place],
            kept,
        )
        yield group, own, alone


def expected(problem, plan):
    """RATT's element of each robot in its component, by the definition; ``None`` for crashed robots."""
    elements, bait = [None] * problem.n_robots, []
    for group, own, alone in parts(problem, plan):
        planned = ro.ratt(alone)
        for k, robot in enumerate(group):
            elements[robot] = int(own[planned.elements[k]])
        bait += [group[k] for k in planned.bait]
    return elements, tuple(sorted(bait))
