"""Is verifying as fast as in another version of the package? Both in turns on the same certificates.

Run as ``python -m analysis.benchmarks.verification --against FOLDER [--robots 4 10 20 30] [--seeds K] [--repeats R]``:
FOLDER holds the other version's source. Certificates are made here (and must be ones that the other version
reads), or are those of ``--files``. Processor time of ``ratt-opt verify`` as a whole process, and of
``verify_certificate`` alone, each the least of R runs taken in turns; a ratio is this version over the other one.
"""

from __future__ import annotations

import argparse
import os
import resource
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from analysis.benchmarks.attack import SETTINGS
from analysis.tables import print_table
from ratt_opt import certify, random_scenario, solve_maxmin

if TYPE_CHECKING:
    from collections.abc import Iterator

HERE = Path(__file__).parents[2]
PROGRAM = "from ratt_opt.cli import main; main()"
ALONE = """
import pathlib, sys, time
import ratt_opt
assert pathlib.Path(ratt_opt.__file__).is_relative_to(sys.argv[1]), "another package is in the way"
times = []
while len(times) < 3 or sum(times) < 0.5:
    began = time.process_time()
    ratt_opt.verify_certificate(sys.argv[2])
    times.append(time.process_time() - began)
print(min(times[1:]))
"""
"""The first run, which loads what is needed, is not counted; short ones are repeated for half a second."""


def certificates(folder: Path, robots: list[int], seeds: int, seconds: float) -> Iterator[Path]:
    """Certificates of the paper's problems, the three criteria at each team's first budgets."""
    for n_robots in robots:
        n_targets, budgets = SETTINGS.get(n_robots, (n_robots, [(1, 3)]))
        for objective in ("trace", "logdet", "maxeig"):
            for seed in range(seeds):
                alpha_s, alpha_c = budgets[0]
                scenario = random_scenario(n_robots, n_targets, alpha_s=alpha_s, alpha_c=alpha_c, seed=seed)
                problem, path = scenario.problem(objective), folder / f"{n_robots}-{objective}-{seed}.json"
                certify(problem, solve_maxmin(problem, gap=1e-4, time_limit=seconds), path)
                yield path


def process_seconds(source: Path, path: Path) -> float:
    """Processor time of one ``ratt-opt verify`` [s]."""
    before = _children_seconds()
    _run(source, PROGRAM, "verify", str(path))
    return _children_seconds() - before


def alone_seconds(source: Path, path: Path) -> float:
    """Least processor time of ``verify_certificate`` in one process [s]."""
    return float(_run(source, ALONE, str(source), str(path)))


def _children_seconds() -> float:
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def _run(source: Path, program: str, *arguments: str) -> str:
    environment = os.environ | {"PYTHONPATH": str(source)}
    command = [sys.executable, "-c", program, *arguments]
    return subprocess.run(command, cwd=source, env=environment, capture_output=True, text=True, check=True).stdout


def compare(path: Path, other: Path, repeats: int) -> dict[str, object]:
    """Both versions on one certificate, in turns."""
    whole = np.array([[process_seconds(source, path) for source in (HERE, other)] for _ in range(repeats)])
    alone = np.array([[alone_seconds(source, path) for source in (HERE, other)] for _ in range(repeats)])
    row: dict[str, object] = {"certificate": path.stem, "kB": path.stat().st_size // 1000}
    for name, times in (("process", whole), ("alone", alone)):
        mine, theirs = times.min(axis=0).tolist()
        row |= {f"{name} [s]": mine, f"{name}, other [s]": theirs, f"{name}, ratio": mine / theirs}
    return row


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--against", type=Path, required=True, help="folder with the other version's source")
    parser.add_argument("--files", type=Path, nargs="+", help="certificates; made here if absent")
    parser.add_argument("--robots", type=int, nargs="+", default=[4, 10, 20, 30])
    parser.add_argument("--seeds", type=int, default=1)
    parser.add_argument("--seconds", type=float, default=60.0, help="time limit of each search")
    parser.add_argument("--repeats", type=int, default=5)
    options = parser.parse_args()
    rows = []
    with tempfile.TemporaryDirectory() as folder:
        made = certificates(Path(folder), options.robots, options.seeds, options.seconds)
        for path in options.files or made:
            rows.append(compare(path.resolve(), options.against.resolve(), options.repeats))
            print(".", end="", file=sys.stderr, flush=True)
    print_table("verifying, this version and the other one", rows)


if __name__ == "__main__":
    main()
