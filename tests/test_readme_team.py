"""The team of the README's ten lines: both attacks bite, by the rule that the README states."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

import ratt_opt as ro

README = Path(__file__).parent.parent / "README.md"


def loss_by_links(seed: int) -> float:
    """Share of the best plan's worst case under blinding alone that cutting links takes away."""
    scenario = ro.limited_view_scenario(
        6, 6, alpha_s=2, alpha_c=4, seed=seed, view=60, reach=40, communication_range=45
    )
    problem = scenario.problem("trace")
    best = ro.solve_maxmin(problem)
    assert best.lower == pytest.approx(best.upper, rel=1e-6)
    blinding_alone = ro.Problem(problem.objective, problem.robot, problem.graph, 2, 0)
    return 1 - best.lower / ro.worst_case_attack(blinding_alone, best.elements).upper


def test_the_seed_is_the_first_in_which_links_matter() -> None:
    seed = int(re.search(r"limited_view_scenario\(.*seed=(\d+)", README.read_text(encoding="utf-8")).group(1))  # type: ignore[union-attr]
    assert next(k for k in range(100) if loss_by_links(k) >= 0.1) == seed
