"""Certificates of teams in which few robots may choose: proved, checked against all plans, and corrupted."""

import json
import subprocess
from dataclasses import replace

import pytest

import ratt_opt as ro
from tests.formal.verified import ratt_check
from tests.solvers.test_at_most import drawn


def certified(seed, path):
    problem = drawn(seed, robots=4, kind=("trace", "logdet", "maxeig")[seed % 3])
    certificate = ro.certify(problem, ro.solve_maxmin(problem), path)
    assert certificate.verified.lower_proved
    assert certificate.verified.at_most == problem.at_most
    return problem, json.loads(path.read_text())


@pytest.mark.parametrize("seed", range(18))
def test_a_certificate_holds_and_one_of_more_busy_robots_is_refused_if_it_is_false(seed, tmp_path):
    problem, document = certified(seed, tmp_path / "certificate.json")
    claim = document["claim"]
    assert claim["lower"] <= ro.exhaustive_optimum(problem).lower + 1e-9 <= claim["upper"] + 2e-9
    for most in range(problem.at_most + 1, problem.n_robots + 1):
        document["problem"]["at_most"] = most
        (tmp_path / "more.json").write_text(json.dumps(document))
        if ro.exhaustive_optimum(replace(problem, at_most=most)).lower > claim["upper"] + 1e-9:
            with pytest.raises(ro.ProofError, match=r"more than the claim|weights are negative or all zero"):
                ro.verify_certificate(tmp_path / "more.json")


def without_limit(document):
    del document["problem"]["at_most"]


def lower_limit(document):
    document["problem"]["at_most"] = 0


def no_idle(document):
    document["problem"]["information"][0] = document["problem"]["information"][1]


def text(document):
    document["problem"]["at_most"] = "2"


def too_many(document):
    document["problem"]["at_most"] = 5


@pytest.mark.parametrize(
    ("change", "fault"),
    [
        (without_limit, "more than the claim|weights are negative or all zero"),
        (lower_limit, "plan: more robots are busy than at_most"),
        (no_idle, "a robot has no element without information"),
        (text, "at_most"),
        (too_many, "at_most"),
    ],
)
def test_each_corruption_is_named(change, fault, tmp_path):
    _, document = certified(3, tmp_path / "certificate.json")
    change(document)
    (tmp_path / "bad.json").write_text(json.dumps(document))
    with pytest.raises((ro.ProofError, ro.FileFormatError), match=fault):
        ro.verify_certificate(tmp_path / "bad.json")


def test_the_formal_checker_refuses_the_limit_by_name(tmp_path):
    checker, path = ratt_check(), tmp_path / "certificate.json"
    certified(3, path)
    done = subprocess.run([checker, str(path)], capture_output=True, text=True, check=False)
    assert done.stdout.startswith("2 ")
    assert "problem has at_most (few robots may be busy), which this checker does not know" in done.stdout
