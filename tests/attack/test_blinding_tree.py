"""Blinded robots on submodular functions: both ends against all attacks, any limit, and false words refuted."""

from itertools import combinations

import numpy as np
import pytest

import ratt_opt as ro
from tests.oracles import brute_force_worst_case
from tests.strategies import Opaque, Submodular, information_data
from tests.ways import go


class Roots(Submodular):
    """Known by its values alone."""

    is_non_decreasing = True


def problem(seed: int) -> ro.Problem:
    """One element a robot: coverage with whole or other weights, facilities, a concave function of a sum."""
    rng = np.random.default_rng([91, seed])
    n = int(rng.integers(4, 10))
    covers = rng.random((n, 12)) < rng.uniform(0.1, 0.5)
    f = [
        ro.Coverage(covers, rng.integers(1, 4, 12).astype(float)),
        ro.Coverage(covers, rng.random(12)),
        ro.FacilityLocation(rng.random((n, 6)) * covers[:, :6]),
        Roots(ro.ConcaveOfModular(rng.random(n))),
    ][seed % 4]
    held = [int(rng.integers(n))] if rng.random() < 0.3 else []
    return ro.Problem(f, np.arange(n), None, int(rng.integers(1, n)), 0, held)


@pytest.fixture
def by_minorants(monkeypatch):
    go(monkeypatch, {(ro.AttackParams, "stages.blinded_sets"): 0})


@pytest.mark.usefixtures("by_minorants")
@pytest.mark.parametrize("limit", [{}, {"time_limit": 600}, {"max_evaluations": 40}, {"max_nodes": 3}])
def test_both_ends_hold_against_all_attacks(limit) -> None:
    closed = 0
    for seed in range(24):
        one = problem(seed)
        found, worst = (
            ro.worst_case_attack(one, np.arange(one.n_robots), **limit),
            brute_force_worst_case(one, np.arange(one.n_robots)),
        )
        slack = 1e-9 * max(worst, 1.0)
        assert found.lower - slack <= worst <= found.upper + slack, seed
        assert one.team_value(np.arange(one.n_robots), found.attack) == pytest.approx(found.upper)
        closed += found.upper - found.lower <= slack
    assert closed == 24 if limit in ({}, {"time_limit": 600}) else closed > 5


def test_teams_of_thirty_close() -> None:
    """Coverage by 30 robots of which ten are lost: 30 million attacks."""
    rng = np.random.default_rng(3)
    covers = np.zeros((30, 200), dtype=np.bool_)
    for row in covers:
        row[rng.integers(0, 200, int(rng.integers(5, 16)))] = True
    one = ro.Problem(ro.Coverage(covers, np.ones(200)), np.arange(30), None, 10, 0)
    found = ro.worst_case_attack(one, np.arange(30), max_evaluations=20_000)
    assert found.stop is ro.Stop.CLOSED
    assert found.lower == found.upper


class Claims(ro.SetFunction):
    """Says that it is submodular, and is not."""

    is_submodular = is_non_decreasing = True

    @property
    def n(self) -> int:
        return 24

    def evaluate(self, membership):
        return membership.sum(axis=1) ** 2.0


def test_a_false_word_is_refuted_with_its_sets() -> None:
    one = ro.Problem(Claims(), np.arange(24), None, 8, 0)
    with pytest.raises(ro.InputError, match=r"must be submodular, as it says.*A = \[.*B = \["):
        ro.worst_case_attack(one, np.arange(24), time_limit=20)


@pytest.mark.usefixtures("by_minorants")
def test_functions_that_fall_are_not_bounded_so() -> None:
    """Of a cut function, blinding fewer robots than allowed may leave less."""
    for seed in range(10):
        rng = np.random.default_rng(seed)
        upper = np.triu(rng.random((6, 6)), 1)
        f = ro.Cut(upper + upper.T)
        found = ro.worst_case_attack(ro.Problem(f, np.arange(6), None, 3, 0), np.arange(6))
        least = min(f([e for e in range(6) if e not in gone]) for k in range(4) for gone in combinations(range(6), k))
        assert found.lower <= least + 1e-12


def test_attacks_say_what_they_rely_on() -> None:
    """On a submodular function only if a bound of submodular ones raised the lower end; on no word of a criterion."""
    rng = np.random.default_rng(2)
    f = ro.FacilityLocation(rng.random((30, 12)))
    own, values = (ro.Problem(g, np.arange(30), None, 10, 0) for g in (f, Opaque(f)))
    plan = np.arange(30)
    assert ro.worst_case_attack(own, plan, time_limit=0.2).relies_on == ("non-decreasing", "submodular")
    found = ro.worst_case_attack(values, plan, max_evaluations=500)
    assert found.relies_on == ("non-decreasing",)
    assert found.to_dict()["relies_on"] == ["non-decreasing"]
    prior, information = information_data(rng, 4, 2)
    measured = ro.Problem(ro.TraceObjective(prior, information), np.arange(4), None, 1, 0)
    assert ro.worst_case_attack(measured, np.arange(4)).relies_on == ()
