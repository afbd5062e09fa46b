"""Every attack leaves a group of so many seeing robots: on the complete graph by sizes, on any graph by trees.

For a tree of links from a root, the root's group keeps every robot of the tree that sees and whose path to the root is
whole. So its seeing robots are at least

    |R| - sum over blinded robots of [robot in R] - sum over cut links of |R behind the link|

for any robots R of the tree. The mean of these over trees, with weights, is least where the attack takes the robots and
the links of the largest coefficients; no group is larger than the largest one.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from ratt_opt.certificates.verifier.reading import array, fields, index, indices, need
from ratt_opt.certificates.verifier.work import tick

if TYPE_CHECKING:
    from ratt_opt.certificates.verifier.statement import Statement

__all__ = ["is_forced", "is_forced_by_trees"]

LARGEST = 2**53
"""Of weights."""


def is_forced(n: int, alpha_s: int, alpha_c: int, size: int) -> bool:
    """Whether every attack on the complete graph of n robots leaves a group with ``size`` seeing robots.

    Otherwise groups n_1 + ... = n have (n^2 - sum n_k^2) / 2 <= alpha_c links between them and, to bring each below
    ``size``, sum max(0, n_k - size + 1) <= alpha_s. ``best[r][x]``: largest sum n_k^2 of r robots, blinding x.
    """
    best = [[0] * (alpha_s + 1)]
    for r in range(1, n + 1):
        tick()
        options = [range(1, min(r, size - 1 + x) + 1) for x in range(alpha_s + 1)]
        part = [[k * k + best[r - k][x - max(0, k - size + 1)] for k in ks] for x, ks in enumerate(options)]
        best.append([max(values, default=-n * n - 1) for values in part])
    return size == 0 or n * n - best[n][alpha_s] > 2 * alpha_c


def is_forced_by_trees(about: Statement, size: int, trees: object) -> bool:
    """Whether the trees show that every attack on the graph leaves a group with ``size`` seeing robots."""
    robots, links = dict.fromkeys(range(about.n), 0), dict.fromkeys(about.links, 0)
    kept = weights = 0
    for tree in array("trees", trees):
        tick()
        given, root, steps, counted = fields("tree", tree, "weight root links robots")
        weight, inside = index("tree weight", given, LARGEST), set(indices("tree robots", counted, about.n))
        for i in inside:
            robots[i] += weight
        for link, behind in _behind(about, index("tree root", root, about.n), array("tree links", steps), inside):
            links[link] += weight * behind
        kept, weights = kept + weight * len(inside), weights + weight
    for loads, safe, most in ((robots, about.safe_robots, about.alpha_s), (links, about.safe_links, about.alpha_c)):
        kept -= sum(sorted((load for key, load in loads.items() if key not in safe), reverse=True)[:most])
    return size == 0 or kept > (size - 1) * weights


def _behind(about: Statement, root: int, steps: list[Any], inside: set[int]) -> list[tuple[tuple[int, int], int]]:
    """The links of a tree, and how many of the robots ``inside`` are behind each; checks that it is a tree."""
    before, order = {root: root}, []
    for step in steps:
        i, j = (index("tree links", end, about.n) for end in array("tree links", step, 2))
        need(i in before and j not in before and j in about.near[i], "lower proof: links are no tree of the graph")
        before[j] = i
        order.append(j)
    need(inside <= before.keys(), "lower proof: a robot is in no tree")
    behind = {i: int(i in inside) for i in before}
    for j in reversed(order):
        behind[before[j]] += behind[j]
    return [((min(j, before[j]), max(j, before[j])), behind[j]) for j in order]
