"""Answers straight from the definitions, for small instances; share no algorithm with the library."""

from itertools import combinations, product

import networkx as nx


def all_attacks(problem):
    """Every set of blinded robots and of cut links within the budgets (not only the full ones)."""
    graph = problem.communication
    robots = [i for i in range(graph.n_robots) if i not in problem.protected_robots]
    links = sorted(graph.links - problem.protected_links)
    blinded = [set(b) for k in range(problem.alpha_s + 1) for b in combinations(robots, k)]
    cuts = [set(c) for k in range(problem.alpha_c + 1) for c in combinations(links, k)]
    return product(blinded, cuts)


def groups_left(problem, cut):
    """Connected components once the links of ``cut`` are gone."""
    graph = nx.Graph()
    graph.add_nodes_from(range(problem.n_robots))
    graph.add_edges_from(problem.communication.links - set(cut))
    return [frozenset(group) for group in nx.connected_components(graph)]


def brute_force_worst_case(problem, elements):
    """The smallest team value over every raw attack."""
    known = {}
    families = {}

    def worth(robots):
        if robots not in known:
            known[robots] = problem.objective([elements[i] for i in robots])
        return known[robots]

    worst = float("inf")
    for blinded, cut in all_attacks(problem):
        key = frozenset(cut)
        if key not in families:
            families[key] = groups_left(problem, cut)
        worst = min(worst, max(worth(group - blinded) for group in families[key]))
    return worst


def refines(fine, coarse):
    """Whether every group of one outcome lies in a group of the other."""
    return all(any(group <= other for other in coarse) for group in fine)


def brute_force_outcomes(problem):
    """All outcomes of raw attacks that no other outcome refines, as sets of groups."""
    found = {
        frozenset(rest for group in groups_left(problem, cut) if (rest := group - blinded)) or frozenset([frozenset()])
        for blinded, cut in all_attacks(problem)
    }
    return {o for o in found if not any(other != o and refines(other, o) for other in found)}


def brute_force_optimum(problem):
    """The largest worst-case value of any plan: every plan against every raw attack."""
    return max(brute_force_worst_case(problem, plan) for plan in product(*(c.tolist() for c in problem.choices)))
