"""The short tier: what pytest leaves out, how it is chosen, and the faults that it must find."""

import ast
import json
import os
import re
import shutil
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import numpy as np
import pytest

from analysis.test_tier.c_mutants import c_mutants
from analysis.test_tier.campaign import Campaign, Measured, draw, family_of, read_rows
from analysis.test_tier.choose import (
    AGAIN,
    CASES,
    CHECKERS,
    EVERY,
    OF_CHECKERS,
    ONE,
    Cost,
    chosen,
    parts_of,
    read_costs,
    read_list,
    summary,
    write_costs,
    write_list,
)
from analysis.test_tier.mutants import Mutant, python_mutants
from analysis.test_tier.reached_lines import Reach, collect, load, merged, save
from tests.documents import ROOT

TESTS_OF_EACH_KIND = """
import pathlib

import pytest


def test_kept():
    pathlib.Path("kept").touch()


def test_left_out():
    pathlib.Path("left_out").touch()


@pytest.mark.parametrize("name", ["first", "second", "third", "fourth"])
def test_some(name):
    pathlib.Path(name).touch()


@pytest.mark.slow
def test_slowly():
    pathlib.Path("slowly").touch()
"""
PARTS = """
def f(x, rows: list[int | None]) -> int:
    if x < 3 and rows:
        rows.append(-x)
        return min(x + 1, 2)
    raise ValueError(x * 2)
"""


def test_faults_are_those_of_each_kind() -> None:
    """None in an annotation or in the message of an error."""
    given = {(one.kind, PARTS[one.begin : one.end], one.text) for one in python_mutants("f.py", PARTS)}
    assert given == {
        ("condition", "x < 3 and rows", "(not (x < 3 and rows))"),
        ("logic", "x < 3 and rows", "((x < 3) or (rows))"),
        ("comparison", "x < 3", "((x) <= (3))"),
        ("constant", "3", "(3 + 1)"),
        ("statement", "rows.append(-x)", "pass"),
        ("function", "rows.append", "rows.remove"),
        ("sign", "-x", "(x)"),
        ("function", "min", "max"),
        ("arithmetic", "x + 1", "((x) - (1))"),
        ("constant", "1", "(1 + 1)"),
        ("constant", "2", "(2 + 1)"),
    }


def test_faults_of_c_are_in_its_code_only() -> None:
    source = (
        "/* a < b */\n#define N 3\nint f(int a) {\n    if (a <= 4) {\n        a += 2;\n    }\n    return a; // 1 + 1\n"
    )
    given = {(one.line, one.kind, source[one.begin : one.end], one.text) for one in c_mutants("f.c", source)}
    assert given == {
        (4, "comparison", " <= ", " < "),
        (4, "condition", "a <= 4", "!(a <= 4)"),
        (4, "constant", "4", "(4 + 1)"),
        (5, "arithmetic", " += ", " -= "),
        (5, "constant", "2", "(2 + 1)"),
        (5, "statement", "        a += 2;", "    ;"),
    }


def test_every_fault_drawn_can_be_read_and_all_families_have_some() -> None:
    drawn = draw(ROOT, seed=5, count=60)
    folders = {path.parent.relative_to(ROOT).parts[:2] for path in (ROOT / "ratt_opt").rglob("*.py")}
    assert {("ratt_opt", *family_of(one.file).split("/")[1:]) for one in drawn} >= folders
    for mutant in drawn:
        text = (ROOT / mutant.file).read_text(encoding="utf-8")
        assert text != mutant.apply(text)
        if mutant.file.endswith(".py"):
            ast.parse(mutant.apply(text))


def costs(*seconds: float, tests: int = 1) -> list[Cost]:
    return [Cost(tests, one) for one in seconds]


def test_the_tier_takes_what_reaches_most_for_its_seconds() -> None:
    units = [np.array(one) for one in ([0, 1], [0], [1, 2], [2])]
    worth = np.array([10.0, 1.0, 8.0])
    assert chosen(parts_of("abcd", costs(2, 2, 2, 2)), units, worth, 4.0) == {0: 1, 2: 1}
    assert chosen(parts_of("abcd", costs(2, 2, 200, 2)), units, worth, 6.0) == {
        0: 1,
        1: 1,
        3: 1,
    }  # the third is too dear
    assert 0 < AGAIN < 1


def test_a_function_of_many_cases_may_join_with_some() -> None:
    (cost,) = costs(1000, tests=10 * CASES)
    units, worth = [np.array([0])], np.array([5.0])
    assert chosen(parts_of("a", [cost]), units, worth, 90.0) == {}
    assert chosen(parts_of("a", [cost]), units, worth, 150.0) == {0: CASES}
    assert chosen(parts_of("a", [cost]), units, worth, 1001.0) == {0: 10 * CASES}


def test_every_function_has_some_cases_in_the_tier_and_checkers_have_more() -> None:
    """And one if that takes longer than the seconds of a function, but not too long."""
    names = [f"tests/a.py::{name}" for name in ("quick", "longer", "long")]
    names += [f"{OF_CHECKERS}b.py::{name}" for name in ("faults", "long")]
    each = (EVERY / 3.5, 0.9 * ONE, 1.1 * ONE, CHECKERS / 8.5, 1.5 * CHECKERS)
    parts = parts_of(names, [Cost(9, 9 * one) for one in each])
    assert chosen(parts, [np.array([0])] * 5, np.array([1.0]), 0.0) == {0: 3, 1: 1, 3: 8}


def test_functions_of_a_file_share_the_seconds_of_its_fixture() -> None:
    given = [Cost(1, 0.1, shared=4.0), Cost(1, 0.1, shared=4.0), Cost(1, 0.1)]
    parts = parts_of(["f::a", "f::b", "g::c"], given)
    assert [part.seconds for part in parts] == pytest.approx([2.1, 2.1, 0.1])
    assert [part.always for part in parts] == [False, False, True]


def test_the_list_says_what_is_left_out(tmp_path: Path) -> None:
    write_list(tmp_path / "list.txt", {"b": 3, "a": 0})
    assert (tmp_path / "list.txt").read_text(encoding="utf-8") == "a 0\nb 3\n"
    assert read_list(tmp_path / "list.txt") == {"a": 0, "b": 3}
    known = dict(zip("abc", costs(2, 4, 1, tests=4), strict=True))
    assert summary(known, {"a": 0, "b": 3}) == [("short", 2, 7, 4.0), ("whole", 3, 12, 7.0)]


@pytest.fixture
def package(tmp_path: Path) -> Path:
    """A package of one loop in C, a constant, and what calls it."""
    (tmp_path / "ratt_opt" / "native" / "src").mkdir(parents=True)
    (tmp_path / "ratt_audit").mkdir()
    loop = "static int more(int x) {\n    return x + 1;\n}\n\nEXPORTED int loop(int x) {\n    return more(x);\n}\n"
    (tmp_path / "ratt_opt" / "native" / "src" / "loops.c").write_text(loop, encoding="utf-8")
    (tmp_path / "ratt_opt" / "limits.py").write_text("\nLIMIT = 3\n", encoding="utf-8")
    call = "def call(x):\n    if x < LIMIT:\n        return function('loop')(x)\n    return 0\n"
    calls = f"from ratt_opt.limits import LIMIT\n\n\n{call}"
    (tmp_path / "ratt_opt" / "calls.py").write_text(calls, encoding="utf-8")
    return tmp_path


def test_compiled_lines_are_reached_by_what_reaches_their_callers(package: Path) -> None:
    lines = {5: frozenset({"a", "b"}), 6: frozenset({"a"}), 7: frozenset({"b"})}
    save(package / "reach.json", {"ratt_opt/calls.py": lines})
    reach = Reach(package, load(package / "reach.json"))
    assert reach.tests("ratt_opt/calls.py", 7) == {"b"}
    assert reach.tests("ratt_opt/native/src/loops.c", 6) == {"a"}
    assert reach.tests("ratt_opt/native/src/loops.c", 2) == {"a"}
    assert reach.tests("ratt_opt/limits.py", 2) == {"a", "b"}
    assert json.loads((package / "reach.json").read_text())["tests"] == ["a", "b"]


class _Tree:
    """Runs nothing: a test fails if it is told so for a fault that is made."""

    def __init__(self, finds: dict[str, set[str]]) -> None:
        self._finds = finds
        self._made: list[str] = []

    @contextmanager
    def with_faults(self, mutants: list[Mutant]) -> Iterator[bool]:
        self._made = [one.text for one in mutants]
        yield "no code" not in self._made
        self._made = []

    def run(self, limits: dict[str, float], cases: dict[str, int]) -> tuple[str, str]:
        del cases
        failed = [test for test in limits if any(test in self._finds[text] for text in self._made) or "bad" in test]
        return ("failed", f"{failed[0]}[0]") if failed else ("passed", "")


def test_each_fault_is_found_by_the_tier_that_has_its_test(package: Path) -> None:
    """Faults that near tests leave over are made at once, and halved for a test that fails until one is left."""
    short, long, other, dear, bad = tests = [
        f"tests/test_{name}" for name in ("x::a", "y::b", "y::c", "z::d", "y::bad")
    ]
    reach = Reach(package, {"ratt_opt/calls.py": {7: frozenset(tests)}})
    finds = {"one": {short}, "two": {long}, "three": set(), "four": {other}, "five": {dear, long}, "six": {dear}}
    texts = [*finds, "no code"]
    mutants = [Mutant("ratt_opt/calls.py", 7, "constant", 0, 0, text) for text in texts]
    cases = {test: 1 if test == dear else 0 for test in tests[1:]}
    measured = Measured(reach, dict(zip(tests, costs(1, 1, 1, 7, 1), strict=True)), cases)
    file, said = package / "rows.csv", list[str]()
    for step in (Campaign.near, Campaign.near, Campaign.together):  # each goes on with what is in the file
        step(Campaign(_Tree(finds), measured, mutants, file, said.append), np.inf)
    rows = read_rows(file)
    found = [rows[number].found for number in range(len(texts))]
    assert found == ["short", "whole", "none", "whole", "short", "short", "none"]
    assert rows[1].test == f"{long}[0] failed"
    assert f"{bad}[0] failed: not by one fault alone" in said
    measured = Measured(reach, measured.costs, {short: 0, long: 1, other: 0, dear: 0, bad: 0})
    Campaign(_Tree(finds), measured, mutants, file, said.append).again(np.inf)
    found = [row.found for _, row in sorted(read_rows(file).items())]
    assert found == ["whole", "short", "none", "whole", "short", "whole", "none"]


def test_nothing_is_tried_once_the_time_is_over(package: Path) -> None:
    reach = Reach(package, {})
    campaign = Campaign(_Tree({}), Measured(reach, {}, {}), [], package / "rows.csv", print)
    campaign.near(-np.inf)
    campaign.together(-np.inf)
    assert read_rows(package / "rows.csv") == {}


def test_costs_and_lines_of_a_test_are_measured(tmp_path: Path) -> None:
    """By the plug-in, in a process of its own; what is known of other tests stays."""
    pytest.importorskip("coverage")
    name = "tests/test_aliases.py"
    environment = os.environ | {"PYTHONPATH": str(ROOT), "TIER_FOLDER": str(tmp_path)}
    command = [sys.executable, "-m", "pytest", "-n0", "-p", "no:cacheprovider", "-p", "analysis.test_tier.reach", name]
    done = subprocess.run(command, cwd=ROOT, env=environment, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout
    measured = read_costs(tmp_path / "measured.csv")
    assert measured.keys() == {
        f"{name}::{function}" for function in re.findall(r"def (test_\w+)", (ROOT / name).read_text())
    }
    assert all(cost.tests > 0 and cost.seconds > 0 for cost in measured.values())
    lines = collect(tmp_path, ROOT, measured)
    assert any(found & measured.keys() for found in lines["ratt_opt/__init__.py"].values())
    write_costs(tmp_path / "again.csv", measured)
    assert read_costs(tmp_path / "again.csv") == measured


def test_what_is_measured_again_replaces_what_was_known() -> None:
    old = {"a.py": {1: frozenset({"x", "y"}), 2: frozenset({"x"})}}
    new = {"a.py": {1: frozenset({"x"}), 3: frozenset({"x"})}, "b.py": {1: frozenset({"x"})}}
    of_a = {1: frozenset({"x", "y"}), 2: frozenset(), 3: frozenset({"x"})}
    assert merged(old, new, {"x"}) == {"a.py": of_a, "b.py": new["b.py"]}


SOME = ["first", "third"]


@pytest.mark.parametrize(
    ("arguments", "run"),
    [
        ((), ["kept", *SOME]),
        (("-n", "2"), ["kept", *SOME]),
        (("--whole",), ["kept", "left_out", "first", "second", "third", "fourth"]),
        (("tests/test_it.py::test_left_out",), ["left_out"]),
        (("-k", "left_out"), ["left_out"]),
        (("-m", "slow"), ["slowly"]),
    ],
    ids=" ".join,
)
def test_pytest_runs_the_short_tier_unless_tests_are_named(
    arguments: tuple[str, ...], run: list[str], tmp_path: Path
) -> None:
    (tmp_path / "tests").mkdir()
    shutil.copy(ROOT / "tests" / "conftest.py", tmp_path / "tests")
    shutil.copy(ROOT / "pyproject.toml", tmp_path)
    (tmp_path / "tests" / "test_it.py").write_text(TESTS_OF_EACH_KIND, encoding="utf-8")
    listed = "tests/test_it.py::test_left_out 0\ntests/test_it.py::test_some 2\n"
    (tmp_path / "tests" / "short_tier.txt").write_text(listed, encoding="utf-8")
    given = arguments if "-n" in arguments else ("-n0", *arguments)
    command = [sys.executable, "-m", "pytest", "-p", "no:cacheprovider", *given]
    environment = {name: value for name, value in os.environ.items() if not name.startswith("PYTEST_")}
    done = subprocess.run(command, cwd=tmp_path, env=environment, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout
    assert {path.name for path in tmp_path.iterdir() if path.suffix == "" and path.is_file()} == set(run)
