from __future__ import annotations

import numpy as np
import pytest

from ratt_opt import Stop
from ratt_opt.budget import Budget, OutOfBudget
from ratt_opt.graph import compiled_threshold
from ratt_opt.graph.compiled_threshold import CompiledThresholdTest
from ratt_opt.graph.threshold import ThresholdTest
from tests.strategies import random_problem


def check_split(threat, values, split, threshold):
    """Connected groups that partition the robots, within the budgets, all within the threshold."""
    n_robots = threat.graph.n_robots
    assert sum(split.groups) == 2**n_robots - 1
    home = {i: k for k, group in enumerate(split.groups) for i in range(n_robots) if group >> i & 1}
    cut = {(i, j) for i, j in threat.graph.links if home[i] != home[j]}
    assert len(cut) <= threat.alpha_c
    assert not cut & threat.protected_links
    assert sorted(sum(1 << i for i in g) for g in threat.graph.groups(cut)) == sorted(split.groups)
    blinded = {i for i in range(n_robots) if not split.survivors[home[i]] >> i & 1}
    assert len(blinded) <= threat.alpha_s
    assert not blinded & threat.protected_robots
    assert max(values[s] for s in split.survivors) <= threshold


@pytest.mark.parametrize("seed", range(60))
def test_compiled_and_plain_tests_agree(seed, monkeypatch):
    """Filled in one piece and in many."""
    monkeypatch.setattr(compiled_threshold, "AT_ONCE", [compiled_threshold.AT_ONCE, 20][seed % 2])
    rng = np.random.default_rng(seed)
    n_robots = int(rng.integers(1, 9))
    threat = random_problem(rng, n_robots, kind="logdet", controls=1).threat
    values = rng.normal(size=2**n_robots)
    plain, compiled = ThresholdTest(threat, values), CompiledThresholdTest(threat, values)
    for threshold in np.quantile(values, [0.0, 0.1, 0.3, 0.5, 0.7, 0.9, 1.0]):
        first, second = plain.split(threshold), compiled.split(threshold)
        assert (first is None) == (second is None)
        for split in (first, second):
            if split is not None:
                check_split(threat, values, split, threshold)


@pytest.mark.parametrize("kind", [ThresholdTest, CompiledThresholdTest])
def test_the_budget_is_asked_on_the_way(kind, monkeypatch):
    """A test of 18 robots took three seconds of a processor in one piece, which no limit and no interrupt ended."""
    monkeypatch.setattr(compiled_threshold, "AT_ONCE", 1000)
    threat = random_problem(np.random.default_rng(4), 8, kind="logdet", controls=1).threat
    test, asked = kind(threat, np.random.default_rng(5).normal(size=2**8)), []

    class Spent(Budget):
        def check(self):
            asked.append(self)
            if len(asked) == 3:
                raise OutOfBudget(Stop.TIME)

    with pytest.raises(OutOfBudget):
        test.split(0.0, Spent())
    assert len(asked) == 3
