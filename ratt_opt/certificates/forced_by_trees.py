"""Proofs on any graph that every attack leaves so many seeing robots in a group, and that these are worth a threshold.

The trees are those of ``graph/largest_group/spreading.py``, with their multipliers in integers.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from ratt_opt.budget import Budget
from ratt_opt.certificates.plan_sets import NotClosedError
from ratt_opt.certificates.size_tree import size_tree
from ratt_opt.certificates.verifier.work import seconds_left
from ratt_opt.graph.largest_group.spreading import forced_size_trees

if TYPE_CHECKING:
    from ratt_opt.certificates.plan_sets import PlanSets

__all__ = ["forced_size_proof"]


def forced_size_proof(sets: PlanSets, max_nodes: int) -> dict[str, Any]:
    """Return the record of a proof of the sets' threshold.

    Raises
    ------
    NotClosedError : no such size is forced, as far as trees say, or the tree over sets is too large.
    """
    seconds, threat = seconds_left(), sets.problem.threat
    size, trees = forced_size_trees(threat, Budget(None if seconds == np.inf else seconds))
    if not size or not sets.enough(_weak(sets, size)):
        raise NotClosedError
    n_links = len(threat.graph.links)
    records = [
        {
            "weight": weight,
            "root": tree.root,
            "links": [list(step) for step in tree.steps],
            "robots": sorted((tree.columns[tree.columns >= n_links] - n_links).tolist()),
        }
        for weight, tree in trees
    ]
    return {"kind": "forced_size", "size": size, "tree": size_tree(sets, size, max_nodes), "trees": records}


def _weak(sets: PlanSets, size: int) -> Any:
    """The posterior of the robots that are worth least alone: where they are too weak nothing need be proved."""
    posterior = sets.start()
    for i in sets.order()[-size:]:
        posterior = sets.extend(posterior, i)
    return posterior
