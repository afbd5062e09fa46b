"""Divisions that no leaf below relies on are taken back; what is left proves as much, wherever the search stops."""

import pytest

from ratt_opt import Problem, exhaustive_optimum, random_scenario, solve_maxmin
from ratt_opt.solvers.maxmin.frontier import Backjumps
from ratt_opt.solvers.maxmin.proof import nodes_below
from tests.solvers.maxmin.engine import LISTED, NO_GROUPS, TREES_SOON, UNLISTED
from tests.solvers.maxmin.proofs import proved_upper
from tests.strategies import small_team
from tests.ways import go


@pytest.fixture(autouse=True)
def depth_first(monkeypatch: pytest.MonkeyPatch) -> None:
    """Small teams, searched as large ones are: nothing is listed, and further trees come soon."""
    go(monkeypatch, NO_GROUPS, UNLISTED, TREES_SOON)


@pytest.fixture
def taken_back(monkeypatch: pytest.MonkeyPatch) -> dict[bool, int]:
    """How often a division by winners (True), and one by elements (False), was taken back."""
    counts = {True: 0, False: 0}
    replace = Backjumps._replace

    def counted(self, parent, split, node):
        replace(self, parent, split, node)
        counts[split.by_winner] += 1
        assert node.is_dropped
        assert not parent.is_dropped
        assert all(child.parent is parent for _, child in (parent.split.parts if parent.split else ()))
        below = list(nodes_below(parent))
        assert not any(one.is_dropped for one in below)
        if split.by_winner:
            assert not any(split.subject in one.winners for one in below if one is not parent)
            used = {k for one in below if one.split is None for k in one.leaf.cuts}
            assert split.subject not in self.cuts.outcomes[sorted(used)]

    monkeypatch.setattr(Backjumps, "_replace", counted)
    return counts


def checked(problem: Problem, optimum: float, max_nodes: int | None) -> int:
    """Nodes of the proof of a valid bracket."""
    found = solve_maxmin(problem, gap=0, max_nodes=max_nodes)
    slack = 1e-9 * optimum + 16 * problem.objective.rounding
    assert found.lower <= optimum + slack
    assert found.upper >= optimum - slack
    assert proved_upper(problem, found.proof) <= found.upper + slack
    assert max_nodes is not None or found.upper <= optimum + slack
    return len(found.proof.tree)


def test_what_is_left_is_a_proof_of_small_teams(taken_back: dict[bool, int]) -> None:
    for seed in range(12):
        problem = small_team(seed)
        checked(problem, exhaustive_optimum(problem).upper, None)
    assert taken_back[False]


def test_what_is_left_is_a_proof_wherever_the_search_stops(taken_back: dict[bool, int]) -> None:
    """Several equal groups may win; the optimum is that of a search that knows all outcomes beforehand."""
    for seed in range(3):
        problem = random_scenario(9, 6, alpha_s=0, alpha_c=24, seed=seed).problem("maxeig")
        with pytest.MonkeyPatch.context() as patch:
            go(patch, LISTED)
            optimum = solve_maxmin(problem).upper
        for max_nodes in (3, 9, None):
            checked(problem, optimum, max_nodes)
    assert taken_back[True]


def test_proofs_are_shorter_for_it(monkeypatch: pytest.MonkeyPatch) -> None:
    problems = [small_team(seed) for seed in range(12)]
    optima = [exhaustive_optimum(problem).upper for problem in problems]
    shorter = [checked(*pair, None) for pair in zip(problems, optima, strict=True)]
    monkeypatch.setattr(Backjumps, "follow", lambda self: self.frontier.fresh.clear())
    longer = [checked(*pair, None) for pair in zip(problems, optima, strict=True)]
    assert sum(shorter) < sum(longer)
