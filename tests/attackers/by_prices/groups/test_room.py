"""How many robots more may see at a node, and their weights, against all sets of robots by the definition."""

from __future__ import annotations

from itertools import combinations

import networkx as nx
import numpy as np
import pytest

from ratt_opt.attack.links import Links
from ratt_opt.attackers.by_prices.groups.compiled import add, copy
from ratt_opt.attackers.by_prices.groups.member_bounds import weigh
from ratt_opt.attackers.by_prices.groups.member_sets import MemberStack
from ratt_opt.attackers.by_prices.groups.room import bound_room
from ratt_opt.attackers.by_prices.groups.size_forms import ELSE, INSIDE, OPEN, OUTSIDE, SEEING
from ratt_opt.attackers.by_prices.team import PricedTeam
from tests.strategies import team_problem

N_ROBOTS = 8


def node_of(seed):
    """A node of a random team, all criteria and dimensions: problem, plan, team, threshold, stack."""
    rng = np.random.default_rng(seed)
    problem, plan = team_problem(seed, N_ROBOTS, graph=nx.gnp_random_graph(N_ROBOTS, 0.5, seed=seed))
    team = PricedTeam.of(problem.objective, plan)
    stack = MemberStack.of(team.prior, N_ROBOTS)
    copy(stack.sums[0], team.prior)
    stack.part[0] = rng.choice([OPEN, INSIDE, ELSE, OUTSIDE], N_ROBOTS, p=[0.5, 0.3, 0.1, 0.1])
    for i in rng.permutation(N_ROBOTS)[: rng.integers(0, 3)]:
        stack.part[0, i] = SEEING
        add(stack.sums[0], stack.sums[0], 1.0, team, i)
    stack.position[0], stack.room[0], stack.grown[0] = 0, N_ROBOTS, True
    seeing = problem.objective([plan[i] for i in np.flatnonzero(stack.part[0] == SEEING)])
    threshold = seeing + rng.uniform(0.1, 1.0) * (problem.objective(plan) - seeing)
    return problem, plan, team, threshold, stack


@pytest.mark.parametrize("first", range(0, 240, 40))
def test_no_weak_set_has_more_robots_than_the_room_or_weighs_more(first):
    """Also, robots are closed only if no weak set has them, and often the room and the weights are all taken."""
    full, heavy = 0, 0
    for seed in range(first, first + 40):
        problem, plan, team, threshold, stack = node_of(seed)
        seeing = np.flatnonzero(stack.part[0] == SEEING).tolist()
        if problem.objective([plan[i] for i in seeing]) >= threshold * (1 - 1e-9):
            continue  # no node of a search
        free = np.flatnonzero(np.isin(stack.part[0], [OPEN, INSIDE])).tolist()
        closed, weight = np.zeros(N_ROBOTS, dtype=np.bool_), np.empty(N_ROBOTS)
        bound_room(team, Links.of(problem.threat), threshold, stack, 0, closed)
        weigh(team, threshold, stack, weight)
        room, most, heaviest = int(stack.room[0]), 0, 0.0
        for size in range(1, len(free) + 1):
            for more in combinations(free, size):
                if problem.objective([plan[i] for i in (*seeing, *more)]) < threshold * (1 - 1e-9):
                    assert not closed[list(more)].any()
                    assert size <= room
                    assert weight[list(more)].sum() <= room * (1 + 1e-9)
                    most, heaviest = max(most, size), max(heaviest, weight[list(more)].sum())
        full += most == room > 0
        heavy += heaviest > 0.8 * room > 0
    assert full > 5
    assert heavy > 2
