"""Proofs in words: the guide's example as it is printed, long trees cut short, every conclusion and node."""

from __future__ import annotations

import json
import re
from pathlib import Path

import networkx as nx
import numpy as np
import pytest

from ratt_opt import Problem, TraceObjective, certify, random_scenario, solve_maxmin
from ratt_opt.certificates import explanation
from ratt_opt.certificates.explanation import explained
from ratt_opt.cli import run
from tests.certificates.engine import ENUMERATED, drawn, proof

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


def test_every_conclusion_is_told(monkeypatch, tmp_path):
    problem = random_scenario(5, 3, alpha_s=1, alpha_c=4, seed=1).problem()
    document = json.loads(certify(problem, solve_maxmin(problem), tmp_path / "c.json").path.read_text())
    told = {"forced": explained(document), "enumerated": explained(document | {"lower": ENUMERATED})}
    for seed in range(60):
        drawn_problem, plan, worst = drawn(seed)
        for kind in ("cover", "sizes"):
            part = proof(kind, drawn_problem, plan, worst * (1 - 1e-7))
            if part is not None:
                record = {**document["problem"], "alpha_s": drawn_problem.alpha_s, "alpha_c": drawn_problem.alpha_c}
                record["owners"] = drawn_problem.robot.tolist()
                told.setdefault(part["conclusion"], explained({**document, "problem": record, "lower": part}))
    assert set(told) == set(explanation.CONCLUSIONS)
    assert all(len(lines) >= 3 for lines in told.values())
    monkeypatch.setattr(explanation, "MOST_LINES", 1)
    assert explained(document)[-1] == f"  ... and {len(document['lower']['sets']['tree']) - 1:,} nodes more"
