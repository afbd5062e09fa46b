"""Proofs in words: the guide's example as it is printed, long trees cut short, every conclusion and node."""

import json
import re
from pathlib import Path

import networkx as nx
import numpy as np
import pytest
from flint import fmpq

from ratt_opt import (
    ExplanationParams,
    Problem,
    TraceObjective,
    certify,
    limited_view_scenario,
    random_scenario,
    solve_maxmin,
    verify_certificate,
)
from ratt_opt.certificates import lower_explanation
from ratt_opt.certificates.explanation import explained
from ratt_opt.certificates.lower_explanation import LowerStory, Wording
from ratt_opt.cli import run
from tests.certificates import lemmas
from tests.certificates.engine import ENUMERATED, drawn, proof, statement

GUIDE = Path(__file__).parents[2] / "docs" / "guides" / "certificates.md"


@pytest.fixture
def row(tmp_path):
    objective = TraceObjective(prior=np.array([[[1.0]]]), information=np.ones((5, 1, 1, 1)))
    problem = Problem(objective, range(5), nx.path_graph(5), alpha_s=1, alpha_c=1)
    return certify(problem, solve_maxmin(problem), tmp_path / "row.json").path


def plain(text):
    return re.sub(r"-?\d+(\.\d+)?", "#", text)


def test_the_guide_has_what_the_command_prints(row, capsys):
    assert run(["verify", str(row), "--explain"]) == 0
    printed = capsys.readouterr().out
    story = printed[printed.index("Why this plan") :]
    # Which duals are found is the linear program's choice: numbers are those of one version of its solver.
    assert plain(f"```text\n{story}```") in plain(GUIDE.read_text(encoding="utf-8"))


def test_in_json(row, capsys):
    assert run(["verify", str(row), "--explain", "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["explanation"][1].startswith("Why this plan")


def test_every_conclusion_is_told(tmp_path):
    problem = random_scenario(5, 3, alpha_s=1, alpha_c=4, seed=1).problem()
    document = json.loads(certify(problem, solve_maxmin(problem), tmp_path / "c.json").path.read_text())
    told = {"forced": explained(document), "enumerated": explained(document | {"lower": ENUMERATED})}
    for seed in range(60):
        drawn_problem, plan, worst = drawn(seed)
        lower = worst * (1 - 1e-7)
        for kind in ("cover", "sizes"):
            part = proof(kind, drawn_problem, plan, lower)
            if part is not None and part["conclusion"] not in told:
                told[part["conclusion"]] = story(drawn_problem, plan, lower, part)
    assert set(told) == set(lower_explanation.CONCLUSIONS)
    assert all(len(lines) >= 3 for lines in told.values())
    more = [line for line in explained(document, ExplanationParams(lines=1)) if "nodes more" in line]
    assert more[0] == f"  ... and {len(document['lower']['sets']['tree']) - 1:,} nodes more"


def story(problem, plan, lower, part):
    wording = Wording(ExplanationParams())
    return LowerStory(statement(problem, plan), fmpq(*lower.as_integer_ratio()), wording).lines(part)


def test_numbers_of_leaves_are_those_of_the_definition():
    """Every worth that is told of robots is that of the criterion, rounded down."""
    told = 0
    for seed in range(40):
        problem, plan, worst = drawn(seed)
        if not isinstance(problem.objective, TraceObjective):
            continue
        part = proof("cover", problem, plan, worst * (1 - 1e-7))
        for line in story(problem, plan, worst * (1 - 1e-7), part) if part else []:
            for robots, worth in re.findall(r"robots ([\d, ]+) are worth ([\d.e-]+)$", line):
                members = [int(plan[int(i)]) for i in robots.split(", ")]
                assert float(worth) <= problem.objective(members) * (1 + 1e-9)
                assert float(worth) >= problem.objective(members) * (1 - 1e-5)
                told += 1
    assert told > 10


def test_a_team_is_not_said_to_have_more_robots_than_it_has(tmp_path):
    scenario = limited_view_scenario(6, 6, alpha_s=2, alpha_c=4, seed=1, view=60, communication_range=45)
    problem = scenario.problem()
    file = certify(problem, solve_maxmin(problem), tmp_path / "c.json").path
    lines = explained(json.loads(file.read_text()), ExplanationParams(lines=10_000))
    sizes = [int(n) for line in lines for n in re.findall(r"Any (\d+) robots", line)]
    assert sizes
    assert max(sizes) <= 6
    lemmas = lines[: lines.index("Take any group of such an attack:")]
    assert not [line for line in lemmas if "no attack" in line]
    claim = json.loads(file.read_text())["claim"]["upper"]
    leaves = [float(x) for line in lines for x in re.findall(r": at most ([\d.e-]+)[:,]", line)]
    assert len(leaves) == verify_certificate(file).upper_leaves
    assert max(leaves) <= claim * (1 + 1e-5)


def test_sums_of_tangents_are_their_bounds(row):
    lines = [line for line in explained(json.loads(row.read_text())) if "by the tangent" in line]
    assert lines
    for line in lines:
        bound, summed = re.search(r"at most ([\d.]+), by .*?: (.*)$", line).groups()
        parts = [float(part.split(" (")[0]) for part in summed.split(" + ")]
        assert sum(parts) == pytest.approx(float(bound), abs=1e-5)


def test_rows_lemmas_and_spaced_values_are_told(tmp_path, capsys):
    problem = lemmas.covering(np.random.default_rng(70), robots=2, targets=3)
    lemmas.certified_by_rows(problem, lemmas.spaced(problem), tmp_path / "spaced.json")
    assert run(["verify", str(tmp_path / "spaced.json"), "--explain"]) == 0
    printed = capsys.readouterr().out
    for words in (
        "no set is worth more for target 0 than 0.999943, by one tangent",
        "A row adds up one inequality of each target",
        "So a plan that is worth less than 2.99943 is worth at most 1.99989",
        "by the row of attack",
        "so at most 1.99989, as values are spaced",
    ):
        assert words in printed
