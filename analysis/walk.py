"""Walk as a stranger does: a fresh copy, a fresh environment, and only what the pages say.

Run as ``python -m analysis.walk [--offline] [--out DIR]``. It clones the repository, installs the clone in a new
environment, and does the jobs of ``docs/guides/three_jobs.md``: it writes the page's files, runs its commands outside
of the clone, and checks what each job should leave. It prints the lines of code and the seconds of each job, and
returns 1 if a job fails or takes more lines than ``AIMS`` says. Then it walks as a reviewer does (``REVIEW``): the
numbers of the README, measured again or named with the command that is slow; a certificate before the second checker;
and the whole witnesses of the lines that fail. The notebooks have a walk of their own, ``analysis.notebooks --check``.
With ``--offline`` the dependencies are those of the running environment; otherwise pip gets them.
"""

import argparse
import ast
import csv
import json
import os
import re
import subprocess
import sys
import tempfile
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from time import monotonic

from analysis.fresh import installed, run_alone

__all__ = ["AIMS", "CHECKS", "REVIEW", "Job", "code_lines", "jobs_of", "main", "run_job"]

ROOT = Path(__file__).parents[1]
PAGE = Path("docs/guides/three_jobs.md")
AIMS = {"drones": 12, "planner": 12, "doubt": 15}
"""Lines of code that each job may take. Before the third edition the drones took 35, and LaTeX and CSV were by hand."""
JOB = re.compile(r"^## \d+\. (?P<title>.*?)\n(?P<body>.*?)(?=^## |\Z)", re.MULTILINE | re.DOTALL)
BLOCK = re.compile(
    r"(?:^<!-- file: (?P<file>\S+) -->\n)?^```(?:python|bash)\n(?P<code>.*?)^```$", re.MULTILINE | re.DOTALL
)

REVIEW = """
(cd "$CLONE" && python -m analysis.measurements --check)
ratt-opt new --robots 3 --targets 2 --sensing-attacks 1 --link-attacks 1 --seed 1 --out tiny.json
ratt-opt bound tiny.json --out tiny
ratt-opt verify tiny/certificate.json --explain
python "$CLONE/tests/certificates/independent_checker.py" tiny/certificate.json
python -c "
from ratt_audit.appendix.roles import Side
from ratt_audit.whole_lines import whole_instance
for label in ('nd_p1d2v1_8', 'nd_p1d3v1_6', 'sub_p2d1v1_10'):
    for side in Side:
        print(label, whole_instance(label, side).whole.text())
"
"""
"""Commands of a reviewer, in a folder of their own; ``CLONE`` is the copy of the repository."""


@dataclass(frozen=True, slots=True)
class Job:
    """A section of the page: its blocks in order, each with the name of its file or, for commands, without."""

    name: str
    title: str
    blocks: tuple[tuple[str | None, str], ...]

    @property
    def lines(self) -> int:
        """Lines of Python that a user has to write."""
        return sum(code_lines(code) for file, code in self.blocks if file is not None)


def main(arguments: Sequence[str] | None = None) -> int:
    """Do the jobs and print a row for each; return 1 if one fails or is too long."""
    options = _parse(arguments)
    with tempfile.TemporaryDirectory(prefix="ratt-opt-walk-") as temporary:
        place = Path(temporary)
        began = monotonic()
        try:
            run_alone(["git", "clone", "--quiet", ROOT, place / "clone"])
            commands = installed(place / "clone", place / "environment", offline=options.offline)
        except subprocess.CalledProcessError as error:
            print(f"{' '.join(map(str, error.cmd))}\n{error.stdout}{error.stderr}", file=sys.stderr)
            return 1
        print(f"cloned and installed in {monotonic() - began:.0f} s", flush=True)
        folder = (options.out or place / "work").resolve()
        folder.mkdir(parents=True, exist_ok=True)
        faults = 0
        for job in jobs_of((place / "clone" / PAGE).read_text(encoding="utf-8")):
            began = monotonic()
            fault = run_job(job, folder, commands)
            faults += fault is not None
            said = fault or f"done in {monotonic() - began:.0f} s"
            print(f"{job.title}: {job.lines} lines of code (at most {AIMS[job.name]}), {said}", flush=True)
        began = monotonic()
        done = _ran(REVIEW, folder, commands, {"CLONE": str(place / "clone")})
        faults += done.returncode != 0
        said = f"failed\n{done.stderr}" if done.returncode else f"done in {monotonic() - began:.0f} s"
        print(f"{done.stdout}A reviewer: {said}", flush=True)
    return int(faults > 0)


def jobs_of(page: str) -> Iterator[Job]:
    """Yield the jobs of the page; a job is called after its first file."""
    for section in JOB.finditer(page):
        blocks = tuple((block["file"], block["code"]) for block in BLOCK.finditer(section["body"]))
        name = next(Path(file).stem for file, _ in blocks if file is not None)
        yield Job(name, section["title"], blocks)


def code_lines(code: str) -> int:
    """Lines of Python, one for each statement: no blank lines, comments or docstrings."""
    tree = ast.parse(code)
    for node in ast.walk(tree):
        body = getattr(node, "body", None)
        if isinstance(body, list):
            node.body = [one for one in body if not _is_text(one)]  # type: ignore[attr-defined]
    return sum(bool(line.strip()) for line in ast.unparse(tree).splitlines())


def _is_text(node: ast.AST) -> bool:
    value = node.value if isinstance(node, ast.Expr) else None
    return isinstance(value, ast.Constant) and isinstance(value.value, str)


def run_job(job: Job, folder: Path, commands: Path) -> str | None:
    """Do a job in ``folder`` with the programs of ``commands`` and return what is wrong, or ``None``."""
    for file, code in job.blocks:
        if file is not None:
            (folder / file).write_text(code, encoding="utf-8")
            continue
        if fault := _failure(code, folder, commands):
            return fault
    if job.lines > AIMS[job.name]:
        return "too many lines"
    return CHECKS[job.name](folder)


def _failure(code: str, folder: Path, commands: Path) -> str | None:
    """Run commands; return what they print if one fails."""
    done = _ran(code, folder, commands, {})
    return f"failed: {code.strip()}\n{done.stdout}{done.stderr}" if done.returncode else None


def _ran(code: str, folder: Path, commands: Path, more: Mapping[str, str]) -> subprocess.CompletedProcess[str]:
    """Run commands with the programs of ``commands`` alone, up to the first that fails."""
    environment = {name: value for name, value in os.environ.items() if name not in {"PYTHONPATH", "VIRTUAL_ENV"}}
    environment |= {"PATH": f"{commands}:{environment['PATH']}", "MPLBACKEND": "Agg", **more}
    shell = ["bash", "-euo", "pipefail", "-c", code]
    return subprocess.run(shell, cwd=folder, env=environment, capture_output=True, text=True, check=False)


def _drones_are_planned(folder: Path) -> str | None:
    report = json.loads((folder / "drones" / "report.json").read_text(encoding="utf-8"))
    bracket = report["optimum"]
    is_proved = (folder / "drones" / "certificate.json").exists() and 0 < bracket["lower"] <= bracket["upper"]
    if report["n_robots"] != 6 or not is_proved:
        return "no plan with a certificate for six drones"
    mission = json.loads((folder / "flight" / "mission.json").read_text(encoding="utf-8"))
    return None if mission["n_robots"] == 6 else "no mission of six drones"


def _planner_is_compared(folder: Path) -> str | None:
    with (folder / "mine" / "means.csv").open(newline="", encoding="utf-8") as file:
        planners = {row["planner"] for row in csv.DictReader(file)}
    latex = (folder / "mine" / "means.tex").read_text(encoding="utf-8")
    has_all = planners == {"ratt", "greedy", "nearest"} and latex.count("nearest") == 2  # two cases
    return None if has_all and (folder / "mine" / "means.png").exists() else "no table of the planner's means"


def _doubt_is_settled(folder: Path) -> str | None:
    report = json.loads((folder / "drones" / "report.json").read_text(encoding="utf-8"))["recommended"]["worst_case"]
    forged = json.loads((folder / "forged.json").read_text(encoding="utf-8"))["claim"]["lower"]
    inside = report["lower"] <= forged / 1.01 <= report["upper"]
    return None if inside else "the worst of all attacks is outside the bracket"


CHECKS: dict[str, Callable[[Path], str | None]] = {
    "drones": _drones_are_planned,
    "planner": _planner_is_compared,
    "doubt": _doubt_is_settled,
}


def _parse(arguments: Sequence[str] | None) -> argparse.Namespace:
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("--offline", action="store_true", help="take the dependencies of the running environment")
    parser.add_argument("--out", type=Path, help="folder for what the jobs write (default: a temporary one)")
    return parser.parse_args(arguments)


if __name__ == "__main__":
    sys.exit(main())
