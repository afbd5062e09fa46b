"""Certificates prove what the exhaustive optimum and brute-force attacks say, and nothing more."""

import json
import math

import numpy as np
import pytest
from flint import arb

import ratt_opt
from ratt_opt import (
    InputError,
    MaxEigenvalueObjective,
    Problem,
    ProofError,
    TableFunction,
    TraceObjective,
    certify,
    exhaustive_optimum,
    network_scenario,
    problem_document,
    random_scenario,
    solve_maxmin,
    verify_certificate,
)
from ratt_opt.certificates.stated_inequalities import round_up
from ratt_opt.certificates.verifier.lower import is_forced
from ratt_opt.graph.survivor_sizes import forced_group_size
from tests.certificates.cases import certified
from tests.certificates.engine import UndecidedError, accepted_leaves, lower_proof, refuse, step
from tests.oracles import brute_force_worst_case
from tests.strategies import OBJECTIVES, information_data, random_problem

KINDS = list(OBJECTIVES)


def closes(written, expected, scale):
    assert written.verified.lower_proved
    assert written.verified.upper >= expected - 1e-9 * scale
    assert written.verified.lower <= expected + 1e-9 * scale
    assert written.verified.upper - written.verified.lower <= 1e-8 * scale


@pytest.mark.parametrize("seed", range(20))
def test_parts_are_named_once_and_may_be_named_again(seed, tmp_path):
    problem = random_problem(np.random.default_rng([22, seed]), 3, kind=KINDS[seed % 3])
    written, document = certified(problem, tmp_path / "c.json")
    before: dict[int, list[list[int]]] = {}
    branches = [node for node in document["upper"]["tree"] if "element" in node]
    assert any("parts" not in node for node in branches)
    for node in branches:
        before[node["element"]] = node.setdefault("parts", before.get(node["element"]))
    (tmp_path / "named.json").write_text(json.dumps(document))
    named = verify_certificate(tmp_path / "named.json")
    assert (named.lower, named.upper) == (written.verified.lower, written.verified.upper)


@pytest.mark.parametrize("seed", range(60))
def test_certifies_the_optimum_without_the_solver(seed, tmp_path):
    rng = np.random.default_rng([21, seed])
    problem = random_problem(rng, int(rng.integers(1, 5)), kind=KINDS[seed % 3])
    written, _ = certified(problem, tmp_path / "c.json")
    value = exhaustive_optimum(problem).lower
    closes(written, value, max(1.0, problem.objective(range(problem.objective.n))))
    worst = brute_force_worst_case(problem, written.verified.elements)
    assert written.verified.lower <= worst + 1e-9 * max(1.0, worst)


@pytest.mark.parametrize("seed", range(60))
def test_certifies_what_the_solver_proves(seed, tmp_path):
    rng = np.random.default_rng([22, seed])
    problem = random_problem(rng, int(rng.integers(1, 6)), kind=KINDS[seed % 3], controls=4)
    result = solve_maxmin(problem)
    written = certify(problem, result, tmp_path / "c.json")
    closes(written, exhaustive_optimum(problem).lower, max(1.0, problem.objective(range(problem.objective.n))))
    assert 0 <= written.upper_raised <= 1e-10 * max(1.0, result.upper)
    assert 0 <= written.lower_shaved <= 1e-10 * max(1.0, result.upper)


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("digits", [10, 7, 4])
def test_lower_ends_far_below_the_prior_s_criterion_are_proved(kind, digits, tmp_path):
    """Such values are differences of larger numbers, and off by more than a share of themselves."""
    for seed in range(4):
        rng = np.random.default_rng([24, seed])
        prior, information = information_data(rng, 6, 2, int(rng.integers(1, 4)))
        information[:, 1] = 0.0
        objective = OBJECTIVES[kind](prior, information * 10.0**-digits)
        budgets = int(rng.integers(0, 4)), int(rng.integers(0, 4))
        problem = Problem(objective, np.repeat(np.arange(3), 2), None, *budgets)
        written = certify(problem, solve_maxmin(problem), tmp_path / "c.json")
        value, slack = exhaustive_optimum(problem).lower, 64 * objective.rounding
        assert written.verified.lower_proved
        assert written.verified.lower <= value * (1 + 1e-9) + slack
        assert written.verified.upper >= value * (1 - 1e-9) - slack
        assert written.verified.upper - written.verified.lower <= 1e-8 * value + slack


def test_the_paper_s_size(tmp_path):
    problem = random_scenario(10, 15, alpha_s=6, alpha_c=22, seed=1).problem("trace")
    written = certify(problem, solve_maxmin(problem), tmp_path / "c.json")
    assert written.verified.lower_proved
    assert written.verified.gap < 1e-9
    assert written.size < 20e6
    assert (written.verified.n_robots, written.verified.n_targets, written.verified.n_elements) == (10, 15, 120)


def test_says_what_was_proved_and_what_was_not(tmp_path):
    problem = random_problem(np.random.default_rng(3), 3, kind="logdet")
    path = tmp_path / "c.json"
    _, document = certified(problem, path)
    text = "\n".join(verify_certificate(path).lines())
    assert "ball arithmetic" in text
    assert "NOT proved" not in text
    document["lower"] = {"conclusion": "enumerated"}
    path.write_text(json.dumps(document))
    verified = verify_certificate(path)
    assert not verified.lower_proved
    assert "NOT proved: this plan has" in "\n".join(verified.lines())
    assert verified.problem_hash in text


def test_refuses_another_problem(tmp_path):
    scenario = random_scenario(3, 2, alpha_s=1, alpha_c=1, seed=1)
    path = tmp_path / "c.json"
    certify(scenario.problem("trace"), solve_maxmin(scenario.problem("trace")), path)
    verify_certificate(path, expected_problem=problem_document(scenario.problem("trace")))
    with pytest.raises(ProofError, match="different problem"):
        verify_certificate(path, expected_problem=problem_document(scenario.problem("logdet")))


def test_refuses_what_cannot_be_certified(tmp_path):
    table = Problem(TableFunction([0.0, 1.0]), np.array([0]), None, 0, 0)
    result = solve_maxmin(table)
    with pytest.raises(InputError, match="proof"):
        certify(table, result, tmp_path / "c.json")
    with pytest.raises(InputError, match="objective"):
        problem_document(table)


@pytest.mark.parametrize("n", range(1, 9))
def test_the_forced_group_size_agrees_with_the_verifier_s_own_argument(n):
    for alpha_s in range(n + 1):
        for alpha_c in range(n * (n - 1) // 2 + 1):
            size = forced_group_size(n, alpha_s, alpha_c)
            assert is_forced(n, alpha_s, alpha_c, size)
            assert size == n or not is_forced(n, alpha_s, alpha_c, size + 1)


def test_large_teams_by_forced_size(tmp_path):
    """Where one forced group decides, the attacker's side is proved at N = 12 as well."""
    problem = random_scenario(12, 6, alpha_s=3, alpha_c=11, seed=4).problem("trace")
    result = solve_maxmin(problem, max_nodes=3)
    verified = certify(problem, result, tmp_path / "c.json").verified
    assert verified.lower_proved
    assert verified.lower_method == "forced"


@pytest.mark.parametrize("seed", range(12))
def test_leaves_that_average_over_the_robots_missing_prove_no_more_than_the_worst_case(seed):
    """With the lower end at the worst case they suffice; a relative 1e-9 above it no tree of theirs is accepted."""
    problem = random_scenario(9, 4, alpha_s=2, alpha_c=0, seed=seed).problem(KINDS[seed % 3])
    elements = ratt_opt.ratt(problem).elements
    worst = brute_force_worst_case(problem, elements)
    part = lower_proof(problem, elements, worst * (1 - 1e-12))
    assert part["conclusion"] == "forced"
    size, tree = part["sets"]["size"], part["sets"]["tree"]
    assert "copies" in tree
    leaves = sum(isinstance(node, str) for node in tree)
    assert accepted_leaves(problem, elements, part, worst * (1 - 1e-11)) == leaves
    refuse(problem, elements, part, worst * (1 + 1e-9), "worth less")
    crude = {**part, "sets": {"size": size, "tree": ["copies"]}}
    singles = problem.objective.prior_information + size * problem.objective.information[elements]
    values = np.sort(problem.objective.value(singles))[:size]
    level = values.mean()
    assert accepted_leaves(problem, elements, crude, level - 1e-9 * abs(level)) == 1
    refuse(problem, elements, crude, level + 1e-9 * abs(level), "worth less")
    assert level <= worst


def test_rank_deficient_and_slightly_indefinite_information(tmp_path):
    """Rounding makes one matrix in five indefinite by 1e-16: the defect is found and the proof still closes."""
    rng = np.random.default_rng(5)
    prior, information = information_data(rng, 6, 2, 3)
    information -= 1e-13 * np.eye(3)  # a visible defect, where the matrices are singular
    accepted = np.maximum(np.linalg.eigvalsh(information)[..., -1], 0) * 1e-9 > 1e-13
    information[~accepted] = 0.0
    for kind in (TraceObjective, MaxEigenvalueObjective):
        problem = Problem(kind(prior, information), np.repeat(np.arange(3), 2), None, 1, 1)
        written, _ = certified(problem, tmp_path / "c.json")
        assert 1e-14 < written.verified.largest_defect < 1e-12
        closes(written, exhaustive_optimum(problem).lower, 1.0)


@pytest.mark.parametrize("kind", KINDS)
def test_where_time_ends_the_upper_end_is_proved_alone(kind, tmp_path, monkeypatch):
    """Verifying both ends took longer than was left, and nothing was written."""
    problem, asked = random_scenario(5, 4, alpha_s=1, alpha_c=4, seed=2).problem(kind), []

    def endless(file, **options):
        asked.append(json.loads(file.read_text())["lower"]["conclusion"])
        if asked[-1] != "enumerated":
            raise UndecidedError("not decided within 1 s")
        return verify_certificate(file, **options)

    step(monkeypatch, "verification", lambda _: endless)
    result = solve_maxmin(problem)
    verified = certify(problem, result, tmp_path / "c.json", time_limit=30).verified
    assert asked[1:] == ["enumerated"]
    assert not verified.lower_proved
    assert verified.upper >= exhaustive_optimum(problem).lower * (1 - 1e-9)
    assert verified.upper == pytest.approx(result.upper, rel=1e-9)


@pytest.mark.parametrize("kind", KINDS)
def test_where_time_ends_a_little_less_is_proved(kind, tmp_path, monkeypatch):
    """If the proof of the whole lower end cannot be verified in time, there is one of a hundredth less."""
    problem, asked = network_scenario("disk-6", 9, 4, alpha_s=1, alpha_c=3, seed=2).problem(kind), []
    result = solve_maxmin(problem)

    def slow(file, **options):
        asked.append(json.loads(file.read_text())["claim"]["lower"])
        if asked[-1] > 0.995 * result.lower:
            raise UndecidedError("not decided within 1 s")
        return verify_certificate(file, **options)

    step(monkeypatch, "verification", lambda _: slow)
    verified = certify(problem, result, tmp_path / "c.json", time_limit=30).verified
    assert len(asked) == 2
    assert verified.lower_proved
    assert verified.lower == pytest.approx(0.99 * result.lower, rel=1e-6)


@pytest.mark.parametrize("ball", [arb(0), arb(0, 1e-70), arb(1, 1e-300), arb(-1, 1e-30)])
def test_a_bound_is_rounded_up_by_a_few_steps(ball):
    """From the middle of a ball around 0 there would be no end of them."""
    found = round_up(ball)
    assert ball <= arb(found)
    assert found - float(ball.upper()) <= 2 * math.ulp(found)
