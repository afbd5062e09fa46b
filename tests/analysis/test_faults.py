"""A seeded sample of the fault campaign, and that the campaign finds the faults it looks for."""

import json
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from flint import arb

import ratt_opt as ro
from analysis.faults import __main__ as command_line
from analysis.faults import campaign as faults
from analysis.faults import inside
from analysis.faults.kinds import KINDS
from analysis.faults.processes import PROCESSES
from analysis.faults.results import check_results, earlier_results
from analysis.faults.truth import truth

SAMPLED = {"full disk in bound": 2, "interrupt of bound": 2} | dict.fromkeys(PROCESSES, 2)
"""How many cases of the kinds that take long; 20 of the others."""


def _only(kind: str) -> dict[str, tuple[float, faults.Kind]]:
    return {kind: (1.0, KINDS[kind][1])}


@pytest.fixture(scope="module")
def campaign(tmp_path_factory: pytest.TempPathFactory) -> faults.Campaign:
    made = faults.Campaign(seed=7, folder=tmp_path_factory.mktemp("faults"))
    made.prepare()
    return made


@pytest.mark.parametrize(
    "kind", [pytest.param(kind, marks=pytest.mark.slow) if kind == "disturbed sweep" else kind for kind in KINDS]
)
def test_a_sample_of_the_campaign_finds_nothing(kind: str, campaign: faults.Campaign) -> None:
    cases = SAMPLED.get(kind, 20)
    for number in range(cases):
        campaign.run_case(number, _only(kind))
    assert campaign.faults == {}
    assert sum(count for name, count in campaign.counts.items() if name.startswith(f"{kind}: ")) == cases


@pytest.mark.parametrize(
    ("code", "said", "found"),
    [
        (70, "error: x", "exit code 70"),
        (2, "a\nTraceback", "traceback"),
        (2, "error: \x1b", "unprintable"),
        (2, "", "0 error"),
    ],
)
def test_the_campaign_sees_a_faulty_program(
    code: int, said: str, found: str, campaign: faults.Campaign, monkeypatch: pytest.MonkeyPatch
) -> None:
    def run(arguments: list[str]) -> int:
        del arguments
        sys.stderr.write(said)
        return code

    monkeypatch.setattr(faults, "run", run)
    campaign.faults.clear()
    campaign.run_case(0, _only("flags"))
    assert found in campaign.faults.pop(0)


def test_the_campaign_sees_a_false_certificate(campaign: faults.Campaign, monkeypatch: pytest.MonkeyPatch) -> None:
    """A verifier that believes twice what was proved."""
    real: Any = inside.truth

    def twice(document: Any, elements: list[int]) -> tuple[float, float]:
        lower, upper = real(document, elements)
        return lower, 2 * upper

    monkeypatch.setattr(inside, "truth", twice)
    monkeypatch.setattr(inside, "damaged", lambda data, _: data)
    campaign.run_case(0, _only("certificate"))
    assert "false upper end" in campaign.faults.pop(0)


@pytest.mark.parametrize("objective", ["trace", "logdet", "maxeig"])
def test_the_truth_is_what_the_library_finds(objective: str, campaign: faults.Campaign, tmp_path: Path) -> None:
    document = json.loads(campaign.files[f"{objective}.json"])
    problem = ro.load_scenario(campaign.put(tmp_path, "scenario.json")).problem(objective)
    best, attack = ro.exhaustive_optimum(problem), ro.worst_case_attack(problem, [0, 3, 5])
    lower, upper = truth(document, [0, 3, 5])
    assert float(lower) == pytest.approx(attack.lower, rel=1e-9)
    assert float(upper) == pytest.approx(best.upper, rel=1e-9)
    safe = {"protected_robots": [0, 1], "protected_links": [[0, 2], [1, 2]]}
    safer = ro.Problem(problem.objective, problem.robot, None, 1, 1, {0, 1}, {(0, 2), (1, 2)})
    lower, _ = truth({"problem": document["problem"] | safe}, [0, 3, 5])
    assert float(lower) == pytest.approx(ro.worst_case_attack(safer, [0, 3, 5]).lower, rel=1e-9)


def test_the_truth_holds_where_the_library_refuses_to_search(campaign: faults.Campaign) -> None:
    """A smallest float for a weight loses nothing: all values are that many times as large."""
    document = json.loads(campaign.files["trace.json"])
    usual = truth(document, [0, 3, 5])
    document["problem"]["weights"] = [5e-324, 5e-324]
    tiny = truth(document, [0, 3, 5])
    assert all(small > 0 and small.overlaps(value * arb(5e-324)) for small, value in zip(tiny, usual, strict=True))


def test_the_campaign_sees_files_of_two_runs(campaign: faults.Campaign, tmp_path: Path) -> None:
    folder = earlier_results(campaign, tmp_path)
    check_results(campaign, folder)
    (folder / "plan.csv").write_bytes(b"another run's")
    with pytest.raises(AssertionError, match="files of two runs without a mark"):
        check_results(campaign, folder)
    (folder / "incomplete.txt").touch()
    check_results(campaign, folder)


def test_a_stopped_campaign_goes_on(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """In two pieces it finds what it finds in one, and a fault is its exit code."""

    def faulty(_: Any, rng: np.random.Generator, __: Any) -> str:
        if rng.random() < 0.9:
            return "done"
        raise AssertionError("seldom")

    monkeypatch.setattr(command_line, "KINDS", {"flags": (1.0, faulty)})
    monkeypatch.setattr(faults.Campaign, "prepare", lambda _: None)

    def run(folder: str, *options: str) -> tuple[int, Any]:
        monkeypatch.setattr(sys, "argv", ["faults", "--seed", "3", "--out", str(tmp_path / folder), *options])
        code = command_line.main()
        found = json.loads((tmp_path / folder / "faults.json").read_text())
        return code, {name: found[name] for name in ("cases", "counts", "faults")}

    once = run("a", "--cases", "40")
    assert run("b", "--cases", "40", "--time-limit", "0")[1]["cases"] == 1
    assert run("b", "--cases", "40") == once
    assert once[0] == 1
    assert sum(once[1]["counts"].values()) == 40
    capsys.readouterr()
    first = next(iter(once[1]["faults"]))
    run("c", "--cases", "1")
    assert run("c", "--case", first)[0] == 1
    assert "seldom" in capsys.readouterr().out
