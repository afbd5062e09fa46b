"""Convex forms of half the links that groups of a few sizes cut, and what they prove of a node."""

from __future__ import annotations

from itertools import product

import networkx as nx
import numpy as np
import pytest

from ratt_opt.attackers.by_prices.convex_forms import ConvexForms
from ratt_opt.attackers.by_prices.groups.columns import Prices, Question
from ratt_opt.attackers.by_prices.groups.size_forms import (
    BLINDED,
    ELSE,
    OPEN,
    OUTSIDE,
    SEEING,
    FormPoints,
    open_form,
)
from ratt_opt.budget import Budget, OutOfBudget
from ratt_opt.graph.communication import CommunicationGraph
from ratt_opt.graph.threat import Threat

MAY_BE = {OPEN: (SEEING, BLINDED, OUTSIDE), ELSE: (BLINDED, OUTSIDE)}


def forms_of(graph: nx.Graph, prices: np.ndarray) -> ConvexForms:
    forms = ConvexForms(Threat(CommunicationGraph(len(graph), frozenset(graph.edges)), 0, 0))
    forms.fit(prices, len(prices), Budget())
    return forms


@pytest.mark.parametrize("n_robots", [2, 5, 9])
@pytest.mark.parametrize("density", [0.0, 0.5, 1.0])
def test_forms_are_convex_and_at_most_half_the_links_cut(n_robots, density):
    rng = np.random.default_rng(n_robots)
    graph = nx.gnp_random_graph(n_robots, density, seed=7)
    groups = np.array(list(product((0.0, 1.0), repeat=n_robots)))
    half = np.array([0.5 * nx.cut_size(graph, np.flatnonzero(group).tolist()) for group in groups])
    forms = forms_of(graph, rng.uniform(0, 2, n_robots))
    for other in (np.ones(n_robots), rng.uniform(0, 3, n_robots)):  # multipliers from other prices go on
        known, sizes = forms.known, groups.sum(axis=1)
        assert known.low[0] == 1
        assert known.high[-1] == n_robots
        np.testing.assert_array_equal(known.low[1:], known.high[:-1] + 1)
        for k in range(forms.n_forms):
            assert np.linalg.eigvalsh(known.form[k])[0] > 0
            at_least = 0.5 * np.einsum("gi,ij,gj->g", groups, known.form[k], groups)
            at_least += groups @ known.linear[k] + known.constant[k]
            ends = np.isin(sizes, (known.low[k], known.high[k]))
            np.testing.assert_allclose(at_least[ends], half[ends], atol=1e-9)
            within = (sizes >= known.low[k]) & (sizes <= known.high[k])
            assert np.all(at_least[within] <= half[within] + 1e-9)
        forms.fit(other, n_robots, Budget())


def least_costs(graph, prices, part, most, sizes):
    """The least cost of a group of a node, for each form's sizes, by definition; ``most`` that see, are blinded."""
    least = np.full(len(sizes.low), np.inf)
    for states in product(*(MAY_BE.get(int(now), (int(now),)) for now in part)):
        seeing, blinded = states.count(SEEING) - np.sum(part == SEEING), states.count(BLINDED)
        group = [i for i, state in enumerate(states) if state != OUTSIDE]
        if group and seeing <= most[0] and blinded <= most[1]:
            cost = 0.5 * nx.cut_size(graph, group) + prices.blinded * blinded - prices.robot[group].sum()
            k = np.searchsorted(sizes.high, len(group))
            least[k] = min(least[k], cost)
    return least


@pytest.mark.parametrize("seed", range(12))
def test_a_form_is_done_with_only_where_no_group_of_its_sizes_costs_as_little(seed):
    rng = np.random.default_rng(seed)
    graph = nx.gnp_random_graph(7, 0.5, seed=seed)
    robot = rng.uniform(0, 2, 7)
    known = forms_of(graph, robot).known
    prices = Prices(robot, rng.uniform(0, 2), np.ones(7), 7.0, 0.0, np.ones(1), known)
    done, n_sharp = 0, 0
    for _ in range(6):
        part = rng.choice([OPEN, OPEN, OPEN, SEEING, ELSE, BLINDED, OUTSIDE], 7).astype(np.int8)
        room, budget = int(rng.integers(4)), int(rng.integers(np.sum(part == BLINDED), 5))
        least = least_costs(graph, prices, part, (room, budget), known)
        for slack in (-1e-6, 0.3, 2.0):
            for k in range(len(known.low)):
                one = type(known)(*(field[k : k + 1] for field in known))
                limit = min(least[k] - slack, 1e6)
                question = Question(0.0, budget, limit, np.arange(7), 0, 0)
                points, work = FormPoints.of(2, 1, 7), (*np.zeros((3, 7)), np.arange(7))
                points.at[0, 0] = rng.uniform(0, 1, 7)  # any point will do
                state = 0, part, room, int(np.sum(part == BLINDED))
                proved = open_form(prices._replace(forms=one), question, points, state, work) == 1
                assert proved == bool(points.done[0, 0])
                assert not (proved and slack < 0 and np.isfinite(least[k]))
                done, n_sharp = done + proved, n_sharp + (slack == 2.0)
    assert done >= n_sharp / 2  # two links below the least cost, most nodes are ruled out


def test_without_forms_nothing_is_proved():
    none = ConvexForms(Threat(CommunicationGraph(3, frozenset({(0, 1), (1, 2)})), 0, 0)).known
    prices = Prices(np.zeros(3), 1.0, np.ones(3), 3.0, 0.0, np.ones(1), none)
    question = Question(0.0, 1, -1e-6, np.arange(3), 0, 0)
    work = (*np.zeros((3, 3)), np.arange(3))
    state = (0, np.zeros(3, dtype=np.int8), 3, 0)
    assert open_form(prices, question, FormPoints.of(2, 2, 3), state, work) == -1


def test_a_budget_that_is_over_leaves_the_forms_as_they_were():
    forms = forms_of(nx.path_graph(5), np.ones(5))
    known = forms.known
    with pytest.raises(OutOfBudget):
        forms.fit(np.zeros(5), 5, Budget(time_limit=0))
    assert forms.known is known
