"""Writing and checking a certificate say how far they are."""

import re
from pathlib import Path

import pytest

from ratt_opt import VerifierLimits, random_scenario
from ratt_opt.certificates.verifier import work
from ratt_opt.certificates.verifier.limits import within
from ratt_opt.cli import run
from ratt_opt.running.progress import Step
from tests.certificates.cases import certified


def test_every_part_of_the_work_counts_its_cases(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    said: list[str] = []
    monkeypatch.setattr(Step, "say", lambda _, detail: said.append(detail))
    problem = random_scenario(3, 2, alpha_s=1, alpha_c=1, seed=0).problem()
    with within(VerifierLimits(told=1)):
        written, document = certified(problem, tmp_path / "c.json")
    trees = {"upper": document["upper"]["tree"], "lower": document["lower"]["sets"]["tree"]}
    nodes = {name: len(tree) for name, tree in trees.items()}
    parts = list(dict.fromkeys(re.sub(r", [\d,]+ (of|cases)", r" \1", line) for line in said))
    upper, lower = (f"{name} proof of {count:,} cases" for name, count in nodes.items())
    assert parts == [upper, "covering all attacks cases", lower]
    assert said[-1] == f"lower proof, {nodes['lower'] - 1:,} of {nodes['lower']:,} cases"
    said.clear()
    with within(VerifierLimits(told=1)):
        assert run(["verify", str(written.path)]) == 0
    assert said[0] == f"upper proof, 0 of {nodes['upper']:,} cases"
    assert said[-1] == f"lower proof, {nodes['lower'] - 1:,} of {nodes['lower']:,} cases"


def test_without_anybody_who_waits_nothing_is_said() -> None:
    work.tell("counting", 0)
    said: list[str] = []
    with work.watched(said.append):
        for done in range(2 * VerifierLimits().told):
            work.tell("counting", done)
    work.tell("counting", 0)
    assert said == ["counting, 0 cases", "counting, 100 cases"]
