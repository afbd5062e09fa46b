"""Every number of an input at every end of its range: the commands handle it, or refuse it by its name.

Refused is one line that names the field; handled is a bracket whose certificate ``verify`` accepts, and attacks on its
plan.
"""

import json
from collections.abc import Iterator
from copy import deepcopy
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import ratt_opt as ro
from ratt_opt.cli import run

OBJECTIVES = ("trace", "logdet", "maxeig")
ENDS = [0, 5e-324, 1e-100, 1e-12, 1e-10, 1e-6, 1e-3, 1e3, 1e6, 1e8, 1e10, 1e12, 2e14, 1e100]
"""The ends of what fields accept, what is beyond them, and sizes between at which digits are lost."""
SHAPES = ("entry", "field everywhere", "matrix")


def _scenario() -> Any:
    """Two robots and two targets, every optional number there."""
    made = ro.random_scenario(2, 2, alpha_s=1, alpha_c=1, seed=3)
    document = made.model_dump(mode="json")
    for robot in document["robots"]:
        robot["controls"] = robot["controls"][:2]
    document["sensor"] |= {"max_range": 80.0, "field_of_view": 6.0}
    document["communication_range"] = 200.0
    return document


def _information() -> Any:
    a, b, c = [[2.0, 0.5], [0.5, 1.0]], [[1.0, 0.0], [0.0, 0.2]], [[0.5, -0.5], [-0.5, 0.5]]
    return {
        "format": "ratt-opt information", "version": 1, "alpha_s": 1, "alpha_c": 0, "robot": [0, 0, 1, 2],
        "prior": [a, b], "information": [[b, c], [c, b], [a, a], [c, c]], "weights": [1.0, 2.0],
    }  # fmt: skip


DOCUMENTS = {"scenario": _scenario(), "information": _information()}


def _numbers(value: Any, at: tuple[Any, ...] = ()) -> Iterator[tuple[Any, ...]]:
    """The places of all numbers."""
    if isinstance(value, (dict, list)):
        for key, item in value.items() if isinstance(value, dict) else enumerate(value):
            yield from _numbers(item, (*at, key))
    elif isinstance(value, (int, float)) and not isinstance(value, bool) and at[-1] != "version":
        yield at


def _changed(document: Any, at: tuple[Any, ...], shape: str, end: float, sign: int) -> Any:
    """The document with one number, all of its name, or the whole matrix around it, at an end."""
    changed = deepcopy(document)
    names = [key for key in at if isinstance(key, str)]
    for place in _numbers(document):
        same = [key for key in place if isinstance(key, str)] == names
        near = place[:-1] == at[:-1] or place[:-2] == at[:-2]
        if place == at or (same and (shape == "field everywhere" or (shape == "matrix" and near))):
            holder = changed
            for key in place[:-1]:
                holder = holder[key]
            old = holder[place[-1]]
            in_matrix = shape != "entry" and isinstance(place[-1], int)
            new = old * end if in_matrix else sign * end  # so that matrices keep their shape
            holder[place[-1]] = int(new) if isinstance(old, int) and new == int(new) else new
    return changed


def extremes() -> list[tuple[str, Any, str]]:
    """All changes of both documents, each once: (kind and place in words, document, criterion)."""
    found: dict[str, tuple[str, Any, str]] = {}
    for kind, document in DOCUMENTS.items():
        for at in _numbers(document):
            for shape in SHAPES if isinstance(at[-1], int) else SHAPES[:2]:
                for end in ENDS:
                    for sign in (1, -1) if shape == "entry" and end >= 1 else (1,):
                        words = f"{kind} {at} {shape} {sign * end:g}"
                        changed = _changed(document, at, shape, end, sign)
                        found.setdefault(json.dumps(changed), (words, changed, OBJECTIVES[len(found) % 3]))
    return list(found.values())


def check(document: Any, objective: str, folder: Path, capsys: pytest.CaptureFixture[str]) -> bool:
    """Run the commands; return whether the input was taken."""
    file, out = folder / "input.json", folder / "out"
    file.write_text(json.dumps(document))
    code = run(["bound", str(file), "--out", str(out), "--objective", objective, "--time-limit", "5"])
    said = capsys.readouterr()
    assert code in {0, 2}, said.err
    if code == 2:
        assert said.err.startswith("error: ")
        assert said.err.count("\n") == 1
        assert not out.exists() or not list(out.iterdir())
        return False
    report = json.loads((out / "report.json").read_text())
    optimum = report["optimum"]
    assert 0 <= optimum["lower"] <= optimum["upper"]
    assert run(["attack", str(file), "--plan", str(out / "report.json"), "--objective", objective]) == 0
    proof = out / "certificate.json"
    assert proof.exists(), report["certificate"]["reason"]
    code = run(["verify", str(proof), "--problem", str(file), "--objective", objective])
    assert code in {0, 3}, capsys.readouterr().err
    return True


CASES = extremes()
QUICK = np.random.default_rng(16).permutation(len(CASES))[:10]


@pytest.mark.parametrize("number", QUICK)
def test_a_sample_of_the_extremes(number: int, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    check(*CASES[number][1:], tmp_path, capsys)


def test_an_extreme_whose_tangents_need_all_their_digits(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """Shortened to nine digits they would not be positive definite."""
    (found,) = (case for case in CASES if case[0] == "information ('information', 0, 1, 0, 0) matrix 1e+12")
    assert check(found[1], "logdet", tmp_path, capsys)


@pytest.mark.slow
@pytest.mark.parametrize("part", range(20))
def test_all_extremes(part: int, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    taken, faults = 0, []
    for number, (words, document, objective) in enumerate(CASES[part::20]):
        folder = tmp_path / str(number)
        folder.mkdir()
        try:
            taken += check(document, objective, folder, capsys)
        except AssertionError as fault:
            faults.append(f"{words}, {objective}: {fault}")
    assert not faults, "\n".join(faults)
    assert taken
