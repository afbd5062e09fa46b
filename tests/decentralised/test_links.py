"""Links by what their loss while planning costs: the plans without them, made and attacked again."""

from functools import partial

import networkx as nx
import numpy as np

import ratt_opt as ro
from ratt_opt import Faults, Stop, decentralised_ratt, link_losses
from tests.decentralised.teams import team


def test_losses_are_those_of_the_plans_without_the_links():
    cameras = ro.limited_view_scenario(6, 6, alpha_s=0, alpha_c=0, seed=3, headings=4).problem()
    problem = ro.Problem(cameras.objective, cameras.robot, nx.path_graph(6), 1, 0)
    found = link_losses(problem)
    assert found.stop is Stop.EXHAUSTED
    assert {loss.link for loss in found.losses} == problem.communication.links
    for loss in found.losses:
        plan = decentralised_ratt(problem, faults=Faults(cuts=((0, *loss.link),)))
        worst = ro.worst_case_attack(problem, plan.elements)
        assert (loss.lower, loss.upper, loss.parts) == (worst.lower, worst.upper, 2)
        assert loss.delay == plan.decision_time - found.plan.decision_time
        lost = found.worst_case.lower - worst.upper
        assert loss.cost == (lost if lost > 0 else min(found.worst_case.upper - worst.lower, 0.0))
    costs = [loss.cost for loss in found.losses]
    assert costs == sorted(costs, reverse=True)
    assert len(set(costs)) > 1


def test_a_limit_keeps_the_plan_and_the_links_seen():
    problem = team(np.random.default_rng(22), 4, objective="trace")
    found = link_losses(problem, partial(decentralised_ratt, hops=1), time_limit=0.0)
    assert found.stop is Stop.TIME
    assert not found.losses
    assert found.plan == decentralised_ratt(problem, hops=1)
