"""Groups, what they need and what they cost at prices, by the definition."""

from itertools import combinations

import networkx as nx
import numpy as np

from ratt_opt.attack.thresholds.pricing import BLINDED


def paying_groups(problem, plan, question, prices):
    """Connected groups that an attack may leave, and the fewest blinded robots they need, by the definition."""
    (threshold, limit), (robot, blinded), answer = question, prices, {}
    graph, protected = problem.communication, problem.protected_robots
    for group in (s for k in range(1, 8) for s in combinations(range(7), k)):
        crossing = [link for link in graph.links if (link[0] in group) != (link[1] in group)]
        if len(graph.groups_among(frozenset(group))) > 1 or set(crossing) & problem.protected_links:
            continue
        if len(crossing) > problem.alpha_c:
            continue
        free = [i for i in group if i not in protected]
        needs = (
            k
            for k in range(min(len(free), problem.threat.n_blinded) + 1)
            if any(
                problem.objective([plan[i] for i in group if i not in out]) < threshold for out in combinations(free, k)
            )
        )
        need = next(needs, None)
        if need is not None and len(crossing) / 2 + blinded * need - robot[list(group)].sum() <= limit:
            answer[group] = need
    return answer


def reduced_cost(problem, part, prices):
    """By the definition, of a group given as what each robot is to it."""
    inside = set(np.flatnonzero(part).tolist())
    crossing = [link for link in problem.communication.links if len(inside & set(link)) == 1]
    return len(crossing) / 2 + prices[1] * int((part == BLINDED).sum()) - prices[0][sorted(inside)].sum()


def least_cost(problem, plan, threshold, prices, *, connected=False):
    """The cheapest reduced cost by the definition: every set of robots, or every connected one, however blinded."""
    n_robots, least = problem.n_robots, np.inf
    for size in range(1, n_robots + 1):
        for group in combinations(range(n_robots), size):
            crossing = {link for link in problem.communication.links if len(set(group) & set(link)) == 1}
            if crossing & problem.protected_links or len(crossing) > problem.alpha_c:
                continue
            if connected and not nx.is_connected(problem.graph.subgraph(group)):
                continue
            free = [i for i in group if i not in problem.protected_robots]
            for blinded in range(min(problem.threat.n_blinded, len(free)) + 1):
                for out in combinations(free, blinded):
                    if problem.objective([plan[i] for i in group if i not in out]) < threshold:
                        cost = len(crossing) / 2 + prices[1] * blinded - prices[0][list(group)].sum()
                        least = min(least, cost)
    return least
