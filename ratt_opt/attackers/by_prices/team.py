"""A plan and a communication graph as arrays for the compiled loops."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from ratt_opt.setfunctions.information import InformationObjective, triangles

if TYPE_CHECKING:
    from ratt_opt._validation import BoolArray, FloatArray, IntArray
    from ratt_opt.graph.threat import Threat
    from ratt_opt.setfunctions.base import SetFunction

__all__ = ["Links", "PricedTeam"]


class PricedTeam(NamedTuple):
    """What the robots see under one plan; symmetric matrices packed by rows of the lower triangle, T = d (d + 1) / 2.

    ``code`` : the criterion's ``compiled_code``; ``weights`` : (M,); ``prior`` : (M, T) prior information;
    ``information`` : (N, M, T); ``baseline`` : the criterion without measurements; ``single`` : (N,) individual values
    """

    code: int
    weights: FloatArray
    prior: FloatArray
    information: FloatArray
    baseline: float
    single: FloatArray

    @classmethod
    def of(cls, objective: SetFunction, plan: IntArray) -> PricedTeam | None:
        """The compact form, or ``None`` where the objective has no compiled code."""
        if not isinstance(objective, InformationObjective) or objective.compiled_code is None:
            return None
        prior, information = triangles(objective.prior_information), triangles(objective.information[plan])
        baseline = float(objective.combine(objective.criterion(objective.prior_information)))
        empty = np.zeros(objective.n, dtype=np.bool_)
        single = np.array([objective.evaluate(_only(empty, e))[0] for e in plan])
        return cls(objective.compiled_code, np.array(objective.weights), prior, information, baseline, single)


def _only(empty: BoolArray, element: int) -> BoolArray:
    row = empty[None].copy()
    row[0, element] = True
    return row


class Links(NamedTuple):
    """A threat's graph: robot ``i`` has arcs ``start[i]:start[i + 1]`` to ``robot``.

    ``start`` : (N + 1,); ``robot`` : (A,) the other end; ``back`` : (A,) the same link's arc the other way;
    ``fixed`` : (A,) whether the link cannot be cut; ``seeing`` : (N,) whether the robot cannot be blinded
    """

    start: IntArray
    robot: IntArray
    back: IntArray
    fixed: BoolArray
    seeing: BoolArray

    @classmethod
    def of(cls, threat: Threat) -> Links:
        """The graph of a threat."""
        arcs = sorted([*threat.graph.links, *((j, i) for i, j in threat.graph.links)])
        place = {arc: a for a, arc in enumerate(arcs)}
        n_robots = threat.graph.n_robots
        start = np.searchsorted([i for i, _ in arcs], np.arange(n_robots + 1)) if arcs else np.zeros(n_robots + 1)
        fixed = [(min(arc), max(arc)) in threat.protected_links for arc in arcs]
        return cls(
            start.astype(np.int64),
            np.array([j for _, j in arcs], dtype=np.int64),
            np.array([place[j, i] for i, j in arcs], dtype=np.int64),
            np.array(fixed, dtype=np.bool_),
            np.array([i in threat.protected_robots for i in range(n_robots)], dtype=np.bool_),
        )
