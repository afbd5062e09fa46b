"""Winners decided for all plans on the word of a plan that turned out worse: the search divides on them after all."""

from __future__ import annotations

from typing import TYPE_CHECKING

import networkx as nx
import numpy as np
import pytest

from ratt_opt import Problem, exhaustive_optimum, solve_maxmin
from ratt_opt.solvers.maxmin.candidates import Candidates
from ratt_opt.solvers.maxmin.stages.proof import ProofStage
from ratt_opt.solvers.maxmin.winners import Winners
from tests.solvers.maxmin.engine import UNLISTED
from tests.solvers.maxmin.proofs import proved_upper
from tests.strategies import OBJECTIVES, information_data
from tests.ways import go

if TYPE_CHECKING:
    from ratt_opt.budget import Budget
    from ratt_opt.solvers.maxmin.plan_stage import LowerEnd

TOO_MUCH = 1.3
"""Times what it is worth that a plan seems to be worth until the search ends for the first time."""


def two_triangles(rng: np.random.Generator, kind: str) -> Problem:
    """Six robots of three elements each; a link joins two triangles that are worth about the same."""
    graph = nx.Graph([(0, 1), (1, 2), (0, 2), (2, 3), (3, 4), (4, 5), (3, 5)])
    objective = OBJECTIVES[kind](*information_data(rng, 18, 3))
    alpha_s, alpha_c = int(rng.integers(0, 3)), int(rng.integers(1, 4))
    return Problem(objective, np.repeat(np.arange(6), 3), graph, alpha_s, alpha_c)


@pytest.mark.parametrize("seed", [17, 29, 32, 35, 39, 41, 48, 65])
def test_the_upper_end_still_comes_down(seed: int, monkeypatch: pytest.MonkeyPatch) -> None:
    hopeful, reopened = True, 0
    level, applies, prove = Candidates.level.fget, ProofStage.applies, ProofStage.run
    reopen = Winners.reopen

    def hoped_for(plans: Candidates) -> float:
        return level(plans) * (TOO_MUCH if hopeful else 1.0)

    def disappointed(stage: ProofStage, state: LowerEnd, budget: Budget) -> bool:
        nonlocal hopeful
        was, hopeful = hopeful, False
        return (applies(stage, state) and prove(stage, state, budget)) or was

    def counted(winners: Winners, *about: object) -> None:
        nonlocal reopened
        reopened += 1
        reopen(winners, *about)

    monkeypatch.setattr(Candidates, "level", property(hoped_for))
    monkeypatch.setattr(ProofStage, "applies", lambda *_: True)
    monkeypatch.setattr(ProofStage, "run", disappointed)
    monkeypatch.setattr(Winners, "reopen", counted)
    go(monkeypatch, UNLISTED)
    problem = two_triangles(np.random.default_rng([9, seed]), list(OBJECTIVES)[seed % 3])
    result = solve_maxmin(problem)
    expected = exhaustive_optimum(problem).lower
    assert result.lower == pytest.approx(expected, rel=1e-8)
    assert result.upper == pytest.approx(expected, rel=1e-8)
    assert proved_upper(problem, result.proof) <= result.upper * (1 + 1e-10)
    assert reopened
