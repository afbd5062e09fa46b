"""Worst-case ratios: known values, brute random search from above, exact replay, broken witnesses."""

import pickle
from dataclasses import replace
from fractions import Fraction

import numpy as np
import pytest

from ratt_audit.enumeration.tightness import tightness_entries
from ratt_opt import (
    InputError,
    Problem,
    ProofError,
    Stop,
    TableFunction,
    exhaustive_optimum,
    ratt,
    worst_case_attack,
    worst_case_ratio,
)
from ratt_opt.worst_ratio import witness
from ratt_opt.worst_ratio.closed_form import pattern_free_ratio
from ratt_opt.worst_ratio.witness import replay


@pytest.mark.parametrize(("family", "value"), [("submodular", Fraction(7, 10)), ("nondecreasing", Fraction(28, 45))])
@pytest.mark.parametrize("use_theorem", [True, False])
def test_isolating_one_of_four_robots(family, value, use_theorem):
    result = worst_case_ratio(4, 0, 3, curvature=0.3, family=family, use_theorem=use_theorem)
    assert result.exact_lower == result.exact_upper == value
    assert result.stop is Stop.CLOSED
    assert Fraction(result.lower) <= value <= Fraction(result.upper)
    assert replay(result.witness) == value


def random_table(rng, n_robots, k, family):
    """A table of 2N elements that is of the class by construction, with many ties."""
    n = 2 * n_robots
    masks = np.arange(1 << n)
    bits = masks[:, None] >> np.arange(n) & 1
    if family == "submodular":
        covered = rng.random((n, 4)) < 0.5
        weight = rng.integers(0, 4, 4)
        cover = np.array([(covered[row > 0].any(axis=0) * weight).sum() for row in bits])
        single = cover[1 << np.arange(n)]
        return k * cover + (1 - k) * (bits @ single)
    # Marginals of psi(h(S)) with a slope of psi in [0, 1] lie in [0, h_x]; a modular part makes that [(1-k) h_x, h_x].
    first, second = rng.integers(0, 4, (2, n)).astype(float)
    cap, start = rng.integers(0, 8, 2)
    bent = np.minimum(bits @ first, cap) + np.maximum(bits @ second - start, 0)
    return k * bent + (1 - k) * (bits @ (first + second))


@pytest.mark.parametrize("family", ["submodular", "nondecreasing"])
@pytest.mark.parametrize(("n_robots", "alpha_s", "alpha_c"), [(2, 0, 0), (3, 1, 0), (3, 0, 2), (4, 1, 3)])
def test_no_random_function_is_below(family, n_robots, alpha_s, alpha_c):
    rng = np.random.default_rng(n_robots * 100 + alpha_s * 10 + alpha_c)
    k = 0.5
    lower = worst_case_ratio(n_robots, alpha_s, alpha_c, curvature=k, family=family).lower
    worst = 1.0
    for _ in range(400):
        table = random_table(rng, n_robots, k, family)
        problem = Problem(TableFunction(table), np.tile(np.arange(n_robots), 2), None, alpha_s, alpha_c)
        optimum = exhaustive_optimum(problem).lower
        if optimum > 0:
            worst = min(worst, worst_case_attack(problem, ratt(problem).elements).upper / optimum)
    assert worst >= lower - 1e-12
    assert worst < 1, "the sample should hold at least one bad instance"


@pytest.mark.parametrize("planner", ["ratt", "greedy", "myopic"])
@pytest.mark.parametrize("family", ["submodular", "nondecreasing"])
def test_every_small_case_closes(planner, family):
    for n_robots in (1, 2, 3):
        for alpha_s in range(n_robots):
            for alpha_c in range(n_robots * (n_robots - 1) // 2 + 1):
                result = worst_case_ratio(
                    n_robots, alpha_s, alpha_c, curvature="2/5", family=family, planner=planner, use_theorem=False
                )
                assert result.stop is Stop.CLOSED
                assert result.exact_lower >= pattern_free_ratio(Fraction(2, 5), family)
                assert replay(result.witness) == result.exact_upper


def test_curvature_zero_is_optimal_and_one_can_be_worthless():
    assert worst_case_ratio(3, 0, 0, curvature=0, family="nondecreasing").exact_lower == 1
    assert worst_case_ratio(3, 1, 0, curvature=0, family="submodular").exact_lower == 1
    assert worst_case_ratio(3, 1, 0, curvature=1, family="nondecreasing").exact_upper == 0


def test_greedy_without_attacks_is_one_over_one_plus_k_from_above():
    # Conforti and Cornuejols 1984: greedy on a matroid attains at least 1 / (1 + k).
    for k in (Fraction(1, 4), Fraction(1, 2), Fraction(1)):
        result = worst_case_ratio(4, 0, 0, curvature=k, family="submodular", planner="greedy")
        assert result.stop is Stop.CLOSED
        assert result.exact_lower >= 1 / (1 + k)
    assert result.exact_lower == Fraction(1, 2), "the greedy algorithm's worst ratio does not exceed 1/2"


def test_feasible_curvature_allows_more_functions():
    over_all = worst_case_ratio(3, 0, 0, curvature=0.5, family="submodular")
    feasible = worst_case_ratio(3, 0, 0, curvature=0.5, family="submodular", domain="feasible")
    assert feasible.exact_upper <= over_all.exact_lower
    assert replay(feasible.witness) == feasible.exact_upper


def test_planners_without_bait_or_with_only_bait():
    greedy = worst_case_ratio(3, 0, 0, curvature=0.5, family="submodular", planner="greedy")
    assert greedy.exact_upper == worst_case_ratio(3, 0, 0, curvature=0.5, family="submodular").exact_upper
    myopic = worst_case_ratio(3, 2, 0, curvature=0.5, family="submodular", planner="myopic")
    assert myopic.exact_upper == 1


def test_the_bracket_holds_when_time_is_up():
    result = worst_case_ratio(4, 0, 4, curvature=0.3, family="submodular", time_limit=0.0)
    assert result.stop is Stop.TIME
    assert result.exact_lower <= Fraction(10, 13) <= result.exact_upper
    assert replay(result.witness) == result.exact_upper


@pytest.mark.parametrize("family", ["submodular", "nondecreasing"])
def test_corrupted_witnesses_are_refused(family):
    witness = worst_case_ratio(3, 1, 0, curvature=0.5, family=family).witness
    with pytest.raises(ProofError, match="4\\*\\*N integers"):
        replay(replace(witness, values=witness.values + 1))
    lowered = witness.values.copy()
    lowered[-1] = 0
    with pytest.raises(ProofError, match="negative marginal"):
        replay(replace(witness, values=lowered))
    with pytest.raises(ProofError, match="curvature"):
        replay(replace(witness, curvature=Fraction(1, 10)))
    with pytest.raises(ProofError, match="optimum must be positive"):
        replay(replace(witness, values=np.zeros_like(witness.values)))


def test_a_supermodular_table_is_not_submodular():
    witness = worst_case_ratio(2, 0, 0, curvature=1, family="submodular").witness
    squared = np.bitwise_count(np.arange(16)).astype(np.int64) ** 2
    with pytest.raises(ProofError, match="diminishing returns"):
        replay(replace(witness, values=squared))


@pytest.mark.slow
def test_five_robots_close_where_rounded_multipliers_prove_nothing():
    result = worst_case_ratio(5, 0, 7, curvature=0.5, family="submodular")
    assert result.exact_lower == result.exact_upper == Fraction(6, 11)
    assert result.stop is Stop.CLOSED


@pytest.mark.parametrize(
    ("arguments", "fault"),
    [
        ({"alpha_s": 3}, "alpha_s must be an integer in \\[0, 2\\]"),
        ({"alpha_c": 4}, "alpha_c must be an integer in \\[0, 3\\]"),
        ({"n_robots": 8}, "n_robots"),
        ({"curvature": 1.1}, "curvature must be a number in \\[0, 1\\]"),
        ({"curvature": float("nan")}, "curvature"),
        ({"curvature": True}, "curvature"),
        ({"family": "modular"}, "family must be one of"),
        ({"planner": "best"}, "planner must be one of"),
        ({"domain": "all"}, "domain must be one of"),
        ({"time_limit": -1.0}, "time_limit"),
    ],
)
def test_bad_input(arguments, fault):
    call = {"n_robots": 3, "alpha_s": 0, "alpha_c": 0, "curvature": 0.3, "family": "submodular", **arguments}
    with pytest.raises(InputError, match=fault):
        worst_case_ratio(call.pop("n_robots"), call.pop("alpha_s"), call.pop("alpha_c"), **call)


def test_an_interrupt_within_the_replay_stops_the_search_and_keeps_the_bracket(monkeypatch):
    """The attacker keeps its own bracket when interrupted: it must not be taken for a worst case."""
    interrupted = replace(
        worst_case_attack(Problem(TableFunction([0, 1]), [0], None, 0, 0), [0]), stop=Stop.INTERRUPTED
    )
    monkeypatch.setattr(witness, "worst_case_attack", lambda *_: interrupted)
    result = worst_case_ratio(3, 1, 0, curvature=0.5, family="submodular")
    assert result.stop is Stop.INTERRUPTED
    assert result.exact_lower <= Fraction(5, 8) <= result.exact_upper
    with pytest.raises(KeyboardInterrupt):
        next(entry for entry in tightness_entries() if entry.label.endswith("_n4")).enumerate_cases()


def test_results_are_values():
    result = worst_case_ratio(3, 1, 0, curvature=0.5, family="submodular")
    assert pickle.loads(pickle.dumps(result)) == result
    assert result != replace(result, witness=replace(result.witness, values=result.witness.values * 2))
    assert len(repr(result)) < 500
