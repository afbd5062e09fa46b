"""Every block of the README and the documents runs as it stands, and gives what it says it gives.

The blocks of one page share a folder, and its Python blocks their names, in the order in which a reader meets them.
The comment above a block may say: ``file: NAME``, it is the content of a file; ``output: COMMAND``, it is what the
command prints; ``table: COMMAND``, the same for a table; ``elsewhere: FILE``, that test or script runs it; ``slow``, it
takes minutes; ``needs: PACKAGE``, the rest of the page is skipped without that package of an extra.
"""

import ast
import csv
import json
import os
import re
import shlex
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from analysis.limited_views.bite import BITES
from analysis.measurements import AGAIN
from ratt_opt import (
    Problem,
    Scenario,
    greedy,
    ratt,
    smallest_largest_group,
    solve_maxmin,
    worst_case_attack,
)
from tests.documents import ROOT, Block, blocks, documents

RESULT = re.compile(r"^(?P<expression>[^#\s][^#\n]*?)\s+# (?P<numbers>-?[\d.]+(?:, -?[\d.]+)*)(?: \D*)?$", re.MULTILINE)
"""A line such as ``f(x), g(x)  # 0.25, 3``: what the expression gives, to the digits shown."""
NUMBER = re.compile(r"(?<![\w.])-?(?:\d{1,3}(?:,\d{3})+|\d+(?:\.\d+)?(?:e-?\d+)?)\b")
FIRST_HOUR = ROOT / "docs" / "first_hour.md"
NOISE = 1e-9
"""Numbers this small are rounding, and differ between processors."""
DATA = ROOT.parent / "shared" / "data" / "mrclam"
SHOWN_PAGES = ("docs/guides/reading_a_report.md", "docs/commands.md")
"""Whose printed outputs are compared here; those of the evaluation rest on two hundred trials each."""


@pytest.fixture
def folder(tmp_path, monkeypatch):
    """An empty folder where the commands are those of this copy, also by the names that an environment gives them."""
    for place in (tmp_path / ".bin", tmp_path / ".venv" / "bin"):
        place.mkdir(parents=True)
        for name, call in (("python", ""), ("ratt-opt", " -m ratt_opt")):
            (place / name).write_text(f'#!/bin/sh\nexec {shlex.quote(sys.executable)}{call} "$@"\n', encoding="utf-8")
            (place / name).chmod(0o755)
    settings = {
        "PATH": f"{tmp_path / '.bin'}:{os.environ['PATH']}",
        "PYTHONPATH": f"{tmp_path}:{ROOT}",
        "COLUMNS": "80",
    }
    settings |= {"MPLBACKEND": "Agg", "BROWSER": "true", "MRCLAM": str(DATA)}
    for name, value in settings.items():
        monkeypatch.setenv(name, value)
    monkeypatch.chdir(tmp_path)
    return tmp_path


def run_block(block: Block, names: dict[str, object], folder: Path) -> None:
    kind, _, rest = block.mark.partition(": ")
    if kind == "needs":
        pytest.importorskip(rest, reason=f"{rest} is not installed")
    if kind in {"set-up", "elsewhere", "slow", "table"} or kind.startswith("output"):
        return
    if kind == "file":
        (folder / rest).write_text(block.code, encoding="utf-8")
    elif block.language == "bash":
        done = subprocess.run(
            ["bash", "-euo", "pipefail", "-c", block.code], capture_output=True, text=True, check=False
        )
        assert done.returncode == 0, f"{block.code}\n{done.stdout}\n{done.stderr}"
    else:
        assert block.language == "python", block
        exec(compile(block.code, "a block", "exec", dont_inherit=True), names)
        check_results(block.code, names)


def check_results(code: str, names: dict[str, object]) -> None:
    for line in RESULT.finditer(code):
        if "=" in line["expression"].replace("==", "").replace("<=", "").partition("(")[0]:
            continue  # an assignment with a remark, not a value
        given = eval(line["expression"], names)
        for number, shown in zip(
            given if isinstance(given, tuple) else (given,), line["numbers"].split(", "), strict=True
        ):
            digits = len(shown.partition(".")[2])
            assert float(number) == pytest.approx(ast.literal_eval(shown), abs=0.51 * 10**-digits), line[0]


def pages_with_blocks() -> list[Path]:
    return [page for page in documents() if any(True for _ in blocks(page))]


def run_page(page: Path, folder: Path) -> None:
    names: dict[str, object] = {"__name__": "a page"}
    for block in blocks(page):
        run_block(block, names, folder)


@pytest.mark.parametrize("page", [p for p in pages_with_blocks() if p != FIRST_HOUR], ids=lambda page: page.name)
def test_blocks_run(page: Path, folder: Path) -> None:
    run_page(page, folder)


def test_a_newcomer_s_first_hour(folder: Path) -> None:
    """Own robots with names, a report that a browser opens, a checked proof, an own set function, an own planner."""
    run_page(FIRST_HOUR, folder)
    report = json.loads((folder / "boats" / "report.json").read_text(encoding="utf-8"))
    assert report["robot_names"] == ["Ada", "Bob", "Cy"]
    with (folder / "results" / "bays" / "table.csv").open(newline="", encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    assert len(rows) == 5
    assert all(float(row["last/worst/value"]) <= float(row["optimum/upper"]) for row in rows)
    if (browser := shutil.which("chromium")) is None:
        assert not os.environ.get("REQUIRE_BROWSER")
        return
    flags = [
        "--headless",
        "--no-sandbox",
        "--disable-gpu",
        "--disable-dev-shm-usage",
        f"--user-data-dir={folder}/.seen",
    ]
    page = (folder / "boats" / "report.html").as_uri()
    shown = subprocess.run([browser, *flags, "--dump-dom", page], capture_output=True, text=True, check=True).stdout
    assert all(name in shown for name in ("Ada", "Bob", "Cy", "Moby", "Willy", "verified, both ends proved"))


@pytest.mark.parametrize("page", ["README.md", "docs/index.md"])
def test_the_team_of_the_first_example_is_hurt_by_both_attacks(page: str) -> None:
    """The cuts split it, each attack alone costs a tenth of RATT's plan, and greedy plans are far from the best."""
    code = next(block.code for block in blocks(ROOT / page) if "limited_view_scenario" in block.code)
    names: dict[str, object] = {}
    exec("\n".join(line for line in code.splitlines() if line.startswith(("import", "scenario"))), names)
    scenario = names["scenario"]
    assert isinstance(scenario, Scenario)
    problem = scenario.problem()
    assert smallest_largest_group(problem.graph, problem.alpha_c).upper < scenario.n_robots
    plan = ratt(problem)
    for budgets in ((problem.alpha_s, 0), (0, problem.alpha_c)):
        attacked = Problem(problem.objective, problem.robot, problem.graph, *budgets)
        assert worst_case_attack(attacked, plan).upper <= (1 - BITES) * problem.objective(plan.elements)
    best = solve_maxmin(problem, gap=1e-3, max_nodes=1_000)
    assert worst_case_attack(problem, greedy(problem)).upper < 0.9 * best.lower
    assert worst_case_attack(problem, plan).upper == AGAIN["demo"]("demo_ratt")[0], "another team than the demo's"


@pytest.mark.slow
@pytest.mark.parametrize("page", pages_with_blocks(), ids=lambda page: page.name)
def test_slow_blocks_run(page: Path, folder: Path) -> None:
    (folder / "docs" / "researchers").mkdir(parents=True)
    for block in blocks(page):
        if block.mark == "slow":
            run_block(Block(block.language, block.code, ""), {}, folder)


EFFORT = re.compile(r"(?<=  )[\d,]+ *$|\d+ leaves|[0-9a-f]{64}", re.MULTILINE)
"""Evaluations and leaves, which every faster search changes, and hashes of data that processors round differently."""


def same_text(shown: str, printed: str) -> bool:
    """Equal but for effort, for rounding in the last digits of numbers, and for space."""
    (words, values), (other_words, other_values) = map(split_numbers, (shown, printed))
    return words == other_words and values == pytest.approx(other_values, rel=1e-6, abs=NOISE)


def split_numbers(text: str) -> tuple[str, list[float]]:
    text = EFFORT.sub("", text)
    return " ".join(NUMBER.sub("0", text).split()), [float(n.replace(",", "")) for n in NUMBER.findall(text)]


@pytest.mark.usefixtures("folder")
@pytest.mark.parametrize("page", SHOWN_PAGES)
def test_outputs_are_what_the_commands_print(page: str) -> None:
    for block in blocks(ROOT / page):
        kind, _, command = block.mark.partition(": ")
        if kind != "output" or ("robots" in command and not DATA.is_dir()):
            continue
        words = shlex.split(os.path.expandvars(command))
        program = {"ratt-opt": [sys.executable, "-m", "ratt_opt"], "python": [sys.executable]}[words[0]]
        done = subprocess.run([*program, *words[1:]], capture_output=True, text=True, check=True)
        assert same_text(block.code, done.stdout), f"{command}\n{done.stdout}"


def test_texts_are_told_apart() -> None:
    assert same_text("kept 45.9113043, gap 3e-14", "kept  45.9113041, gap 7e-15")
    assert not same_text("kept 45.91", "kept 45.92")
    assert not same_text("kept 45.91", "lost 45.91")
    assert same_text("ratt  45.9  at least 0.998  1,200", "ratt  45.9  at least 0.998  60")


def commands_in_text() -> list[tuple[str, str]]:
    """Commands in the running text, tables and outputs of every page."""
    found = []
    for page in documents():
        text = page.read_text(encoding="utf-8")
        marked = [block.mark.partition(": ")[2] for block in blocks(page) if block.mark.startswith("output")]
        tables = re.findall(r"<!-- table: (.*?) -->", text)
        prose = re.sub(r"^```.*?^```$", "", text, flags=re.MULTILINE | re.DOTALL)
        inline = re.findall(r"`((?:\.venv/bin/)?(?:ratt-opt|python -m analysis)[^`]*)`", prose)
        rows = re.findall(r"^\| `(ratt-opt [a-z]+)[^`]*`(.*)$", prose, flags=re.MULTILINE)
        listed = [f"{command} {option}" for command, row in rows for option in re.findall(r"`(--[a-z-]+)", row)]
        found += [(page.name, command) for command in (*marked, *tables, *inline, *listed)]
    return sorted(set(found))


@pytest.mark.parametrize(("page", "command"), commands_in_text())
def test_commands_in_the_text_exist_with_their_options(page: str, command: str) -> None:
    del page
    words = command.removeprefix(".venv/bin/").split()
    options = [word.rstrip(",") for word in words if word.startswith("--")]
    if words[0] == "ratt-opt":
        known = help_of_command(words[1 : 3 if words[1:2] == ["bench"] else 2])
    else:
        if words[2].endswith("."):  # the first words of several commands
            assert (ROOT / words[2].replace(".", "/")).is_dir()
            return
        module = words[2] if (ROOT / f"{words[2].replace('.', '/')}.py").exists() else f"{words[2]}.__main__"
        known = (ROOT / f"{module.replace('.', '/')}.py").read_text(encoding="utf-8")
        known += (ROOT / "ratt_opt" / "studies" / "command.py").read_text(encoding="utf-8")
    assert [option for option in options if option not in known] == []


def help_of_command(words: list[str]) -> str:
    from typer.testing import CliRunner

    from ratt_opt.cli.program import app

    done = CliRunner().invoke(
        app, [*[word for word in words if not word.startswith("-")], "--help"], env={"COLUMNS": "200"}
    )
    assert done.exit_code == 0, words
    return done.output


def test_every_block_is_run_by_something() -> None:
    """What is not run here names the test or script that does; and there is something to run."""
    seen = set()
    for page in documents():
        for block in blocks(page):
            kind, _, rest = block.mark.partition(": ")
            seen.add(kind or block.language)
            if kind == "elsewhere":
                assert (ROOT / rest).exists(), block.mark
            elif kind == "set-up":
                assert rest in {"demo", "tests"}, block.mark  # tests/test_wheel.py and .ci/run
            elif block.language == "text":
                assert kind.startswith("output"), block.code
    assert seen >= {"python", "bash", "file", "output", "elsewhere"}
    assert RESULT.search((ROOT / "README.md").read_text(encoding="utf-8"))


@pytest.mark.parametrize("path", sorted((ROOT / "docs" / "examples").glob("*.py")), ids=lambda path: path.stem)
def test_examples_run(path: Path, folder: Path) -> None:
    """Each in this process, so that modules are shared; the site runs them too, and shows their figures."""
    from matplotlib.figure import Figure

    names: dict[str, object] = {"__name__": "__main__"}
    exec(compile(path.read_text(encoding="utf-8"), str(path), "exec", dont_inherit=True), names)
    assert any(isinstance(value, Figure) for value in names.values())
    assert not list(folder.glob("[!.]*"))  # an example leaves nothing behind
