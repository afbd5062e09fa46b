"""A contributor adds a stage with one file and one line: the page "Your first stage", done in a temporary module."""

import importlib.util
import re
from dataclasses import replace

import numpy as np
import pytest

import ratt_opt as ro
from tests.attack.engine import add_stage
from tests.documents import ROOT
from tests.oracles import brute_force_worst_case
from tests.strategies import random_elements, random_problem
from tests.ways import with_params

LARGE_TEAM = {(ro.AttackParams, "criterion.small"): 0}
"""Small teams go on after the first thresholds."""
PAGE = ROOT / "docs" / "contributors" / "first_stage.md"


@pytest.fixture
def added(tmp_path, monkeypatch):
    """The page's file, written and listed after the single robots."""
    text = PAGE.read_text(encoding="utf-8")
    name, source = re.search(r"<!-- file: (\S+) -->\n```python\n(.*?)```", text, re.DOTALL).groups()
    path = tmp_path / name
    path.write_text(source, encoding="utf-8")
    spec = importlib.util.spec_from_file_location(path.stem, path)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    stage = module.ProtectedRobotsStage()
    add_stage(monkeypatch, stage, after="single robots")
    return stage


def test_brackets_are_true_with_the_stage_and_results_tell_of_it(added):
    ran = 0
    for seed in range(120):
        rng = np.random.default_rng([seed, 12])
        problem = random_problem(rng, int(rng.integers(3, 6)), kind=str(rng.choice(["trace", "logdet", "maxeig"])))
        protected = frozenset({int(rng.integers(problem.n_robots))}) if seed % 2 else frozenset()
        problem = replace(problem, protected_robots=protected)
        plan = random_elements(rng, problem)
        found = ro.worst_case_attack(problem, plan, params=with_params(ro.AttackParams(), LARGE_TEAM))
        worst = brute_force_worst_case(problem, plan)
        assert found.lower <= worst + 1e-9 * abs(worst) + 1e-10
        assert found.upper >= worst - 1e-9 * abs(worst) - 1e-10
        rows = [row.name for row in found.stages]
        assert added.name not in rows or protected
        ran += added.name in rows
        if added.name in rows:
            assert rows.index(added.name) == rows.index("single robots") + 1
    assert ran > 10


@pytest.mark.parametrize("bound", [1e6, float("nan")])
def test_a_bound_above_an_attack_ends_the_search(added, monkeypatch, bound):
    monkeypatch.setattr(added, "run", lambda attack: attack.task.bracket.raise_lower(bound))
    refused = 0
    for seed in range(30):
        rng = np.random.default_rng([seed, 12])
        problem = random_problem(rng, int(rng.integers(3, 6)), kind="trace")
        problem = replace(problem, protected_robots=frozenset({int(rng.integers(problem.n_robots))}))
        plan = random_elements(rng, problem)
        try:
            found = ro.worst_case_attack(problem, plan, params=with_params(ro.AttackParams(), LARGE_TEAM))
        except ro.ProofError as error:
            assert "says a bound, but one leaves" in str(error)  # noqa: PT017  (only some attacks reach the stage)
            refused += 1
        else:
            assert added.name not in [row.name for row in found.stages]
    assert refused > 2
