"""Proofs that every attack leaves a group worth a threshold, by the sizes of the groups that an attack can leave.

Bounds on the scores of groups of each size give a least number of unblinded robots in the largest group. Either any
set of that size reaches the threshold, or any a little larger, and the sizes between them have a tree each.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from ratt_opt.budget import Budget
from ratt_opt.certificates.group_sizes.largest_tree import Found, grow_tree
from ratt_opt.certificates.group_sizes.score_bounds import ScoreBounds
from ratt_opt.certificates.group_tree import sets_proof
from ratt_opt.certificates.plan_sets import NotClosedError
from ratt_opt.certificates.verifier.sizes import largest_groups
from ratt_opt.certificates.verifier.work import seconds_left

if TYPE_CHECKING:
    from ratt_opt.certificates.plan_sets import PlanSets

__all__ = ["group_size_proof"]


def group_size_proof(sets: PlanSets, max_nodes: int) -> dict[str, Any]:
    """Return the record of a proof of the sets' threshold.

    Raises
    ------
    NotClosedError : a group that bounds do not rule out is worth less, or a tree is too large.
    """
    threat, seconds, params = sets.problem.threat, seconds_left(), sets.params.sizes
    n_robots, n_blinded = threat.graph.n_robots, threat.n_blinded
    if n_robots > params.robots or n_blinded == n_robots:
        raise NotClosedError
    bounds = ScoreBounds(threat.graph, threat.alpha_c, Budget(None if seconds == np.inf else seconds), params)
    least = largest_groups(bounds.costs, n_blinded, n_robots + 1)[0].sensing
    found = Found({}, min(params.numbers, max_nodes * n_robots))
    lemma = _lemma(sets, least, min(params.few, max_nodes))
    try:
        groups = largest_groups(bounds.costs, n_blinded, lemma["size"])
        trees = [grow_tree(sets, bounds, group, found) for group in groups]
    except NotClosedError:
        lemma, trees = sets_proof(sets, least, max_nodes), []
        found.bounds.clear()
    return {
        "conclusion": "sizes",
        "sets": lemma,
        "duals": bounds.duals,
        "forms": bounds.forms,
        "bounds": [{"duals": vector, "diagonal": list(diagonal)} for vector, diagonal in found.bounds],
        "trees": trees,
    }


def _lemma(sets: PlanSets, least: int, max_nodes: int) -> dict[str, Any]:
    """The first size from the least one on of which all sets are worth the threshold, and its tree.

    A size that no set has if those that can sense in a group do not do.
    """
    threat = sets.problem.threat
    for size in range(least, threat.graph.n_robots - threat.n_blinded + 1):
        try:
            return sets_proof(sets, size, max_nodes)
        except NotClosedError:
            continue
    return {"size": threat.graph.n_robots + 1, "tree": ["budget"]}
