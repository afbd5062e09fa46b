"""Exchanges that a robot proposes: better elements for itself and its neighbours beside what the others have."""

from __future__ import annotations

from math import inf
from typing import TYPE_CHECKING

import networkx as nx
import numpy as np

from ratt_opt.attack.exact import worst_case_attack
from ratt_opt.problem import Problem
from ratt_opt.setfunctions.information import from_triangles
from ratt_opt.solvers.refined import refined

if TYPE_CHECKING:
    from collections.abc import Mapping

    from ratt_opt.budget import Budget
    from ratt_opt.decentralised.messages import Choice
    from ratt_opt.decentralised.view import ComponentView
    from ratt_opt.setfunctions.information import InformationObjective

__all__ = ["best_exchange"]


def best_exchange(  # noqa: PLR0917
    view: ComponentView,
    objective: InformationObjective,
    chosen: Mapping[int, Choice],
    menus: Mapping[int, tuple[Choice, ...]],
    kicks: int,
    budget: Budget,
) -> tuple[float, tuple[Choice, ...]]:
    """Search for elements of the robots with a menu that raise the component's worst case.

    An exchange counts if its worst case is proved to be above the present one: both are bracketed by attacks on the
    component, for all that the robot has heard. Neither end relies on what other robots computed.

    Returns
    -------
    What is proved of the worst case, and the elements that change; ``-inf`` and nothing if no exchange was found.
    """
    offered = {choice.element: choice for i in view.members for choice in (*menus.get(i, ()), chosen[i])}
    told = [offered[element] for element in sorted(offered)]
    place = {robot: k for k, robot in enumerate(view.members)}
    matrices = from_triangles(np.stack([c.information for c in told]).reshape(len(told), len(objective.prior), -1))
    threat, graph = view.threat, nx.empty_graph(len(view.members))
    graph.add_edges_from(threat.graph.links)
    problem = Problem(
        objective.with_information(matrices),
        [place[choice.robot] for choice in told],
        graph,
        threat.alpha_s,
        threat.alpha_c,
        threat.protected_robots,
        threat.protected_links,
    )
    number = {choice.element: k for k, choice in enumerate(told)}
    present = [number[chosen[i].element] for i in view.members]
    most = worst_case_attack(problem, present, budget=budget, brief=True).upper
    found = refined(problem, start=present, max_kicks=kicks, time_limit=None, budget=budget)
    if not found.lower > most:
        return -inf, ()
    return found.lower, tuple(told[k] for k in sorted(set(found.elements.tolist()).difference(present)))
