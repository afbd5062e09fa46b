"""``verify --verified``: both checkers must accept, and without the second there is no verdict."""

import json
import stat

import numpy as np
import pytest

from ratt_opt.cli import run
from tests.certificates.cases import certified
from tests.formal.verified import ratt_check
from tests.strategies import random_problem


@pytest.fixture
def document(tmp_path):
    problem = random_problem(np.random.default_rng(7), 3, kind="trace", controls=2)
    return certified(problem, tmp_path / "certificate.json")[1]


@pytest.fixture
def code(tmp_path):
    def decided(changed, *options):
        path = tmp_path / "x.json"
        path.write_text(json.dumps(changed))
        return run(["verify", str(path), "--verified", *options])

    return decided


@pytest.fixture
def answering(tmp_path, monkeypatch):
    """Put a program in ratt-check's place that answers as told."""

    def put(script):
        program = tmp_path / "checker"
        program.write_text(f"#!/bin/sh\n{script}\n")
        program.chmod(program.stat().st_mode | stat.S_IEXEC)
        monkeypatch.setenv("RATT_CHECK", str(program))

    return put


def test_the_real_checker_and_the_verifier_decide_together(document, code, monkeypatch, capsys):
    monkeypatch.setenv("RATT_CHECK", ratt_check())
    assert code(document) == 0
    assert "ratt-check, whose proof is checked: both ends proved" in capsys.readouterr().out
    assert code(document, "--json") == 0
    second = json.loads(capsys.readouterr().out)["verified"]
    assert second["lower_proved"] is True
    assert code(document | {"lower": {"conclusion": "enumerated"}}) == 3
    assert code(document | {"claim": document["claim"] | {"upper": document["claim"]["upper"] * (1 - 1e-9)}}) == 1
    assert code(document | {"version": 7}) == 2


@pytest.mark.parametrize("kind", ["logdet", "maxeig"])
def test_every_criterion_is_covered(tmp_path, monkeypatch, kind):
    monkeypatch.setenv("RATT_CHECK", ratt_check())
    path = tmp_path / "c.json"
    certified(random_problem(np.random.default_rng(8), 3, kind=kind, controls=2), path)
    assert run(["verify", str(path), "--verified"]) == 0


def test_without_the_program_there_is_one_line_and_no_verdict(document, code, monkeypatch, capsys, tmp_path):
    monkeypatch.setenv("PATH", str(tmp_path))
    for named in ("", str(tmp_path / "absent")):
        monkeypatch.setenv("RATT_CHECK", named)
        assert code(document) == 2
        answer = capsys.readouterr()
        assert answer.out == ""
        assert answer.err.startswith("error: ratt-check must be on the search path or named by RATT_CHECK")
        assert answer.err.count("\n") == 1


@pytest.mark.parametrize(
    "case",
    [
        ('echo "0 $1: both ends proved"', 0, ""),
        ('echo "3 $1: only the upper end proved"; exit 3', 3, ""),
        ('echo "1 $1: not proved"; exit 1', 1, "ratt-check: not proved"),
        ('echo "2 $1: no certificate"; exit 2', 2, "no certificate"),
        ('echo "0 $1: both ends proved"; exit 1', 2, "must answer as it is written to"),
        ("exit 0", 2, "must answer as it is written to"),
        ("echo Segmentation fault; exit 139", 2, "must answer as it is written to"),
        ("sleep 60", 4, "not decided within"),
    ],
)
def test_every_answer_of_the_program_has_its_exit_code(document, code, answering, capsys, case):
    script, expected, says = case
    answering(script)
    assert code(document, "--time-limit", "2") == expected
    assert says in capsys.readouterr().err
