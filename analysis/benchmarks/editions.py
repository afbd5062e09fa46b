"""This edition against an earlier one: the rows of the tables of times, in one run, taking turns.

Run as ``python -m analysis.benchmarks.editions FOLDER [--rows ...] [--kinds trace ...] [--rounds 3]``; FOLDER holds
the earlier edition (``git worktree add FOLDER COMMIT``). Every row is a few calls of the public interface that both
know. Each round starts one process of each edition, which makes the calls once uncounted (imports, and what some
editions compile) and once counted in processor seconds; shown is the smallest of the rounds, by which noise of the
machine counts least.
"""

from __future__ import annotations

import argparse
import json
import os
import subprocess
import sys
import tempfile
import time
from functools import partial
from itertools import islice
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

KINDS = ["trace", "logdet", "maxeig"]
"""Criteria that are measured; ``--kinds`` names some of them."""
PAPER = {
    10: (15, ((3, 11), (5, 15), (6, 22))),
    20: (20, ((6, 47), (10, 63), (13, 95))),
    30: (25, ((10, 108), (15, 145), (20, 217))),
}
"""Robots -> targets and budgets (blinded, cut)."""
SLOWER = 1.1
"""Times the earlier edition's seconds from which a row counts as slower."""


def problems(robots: int, seeds: int = 1) -> Iterator[Any]:
    """The paper's teams of one size."""
    import ratt_opt as ro

    targets, budgets = PAPER[robots]
    for alpha_s, alpha_c in budgets:
        for seed in range(seeds):
            scenario = ro.random_scenario(robots, targets, alpha_s=alpha_s, alpha_c=alpha_c, seed=seed)
            yield from (scenario.problem(kind) for kind in KINDS)


def planning() -> list[Callable[[], Any]]:
    """RATT."""
    import ratt_opt as ro

    return [partial(ro.ratt, problem) for problem in problems(30, 4) for _ in range(10)]


def exhaustive() -> list[Callable[[], Any]]:
    """The best plan by exhaustive search."""
    import ratt_opt as ro

    scenario = ro.random_scenario(4, 4, alpha_s=1, alpha_c=3, seed=0)
    return [partial(ro.exhaustive_optimum, scenario.problem(kind)) for kind in KINDS]


def attacks(robots: int) -> list[Callable[[], Any]]:
    """The exact worst attack on RATT's plan."""
    import ratt_opt as ro

    return [partial(ro.worst_case_attack, problem, ro.ratt(problem).elements) for problem in problems(robots, 4)]


def best_plans(robots: int, gap: float) -> list[Callable[[], Any]]:
    """The best plan."""
    import ratt_opt as ro

    return [partial(ro.solve_maxmin, problem, gap=gap) for problem in problems(robots, 2)]


def largest_groups(method: str) -> list[Callable[[], Any]]:
    """``n_max`` of sparse graphs."""
    import networkx as nx

    import ratt_opt as ro

    graph = nx.random_geometric_graph(30, 0.3, seed=1)
    return [partial(ro.smallest_largest_group, graph, cut, method=method) for cut in (5, 10)]


def verifications(robots: int) -> list[Callable[[], Any]]:
    """Verifying certificates, which each edition wrote itself."""
    import ratt_opt as ro

    folder = Path(tempfile.mkdtemp())
    calls: list[Callable[[], Any]] = []
    for k, problem in enumerate(problems(robots, 1)):
        ro.certify(problem, ro.solve_maxmin(problem, gap=1e-6), folder / f"{k}.json")
        calls.append(partial(ro.verify_certificate, folder / f"{k}.json"))
    return calls


def tables() -> list[Callable[[], Any]]:
    """Submodularity and total curvature of a table of 2^18 values."""
    import numpy as np

    import ratt_opt as ro

    sets = np.arange(2**18)
    members = (sets[:, None] >> np.arange(18)) & 1
    table = ro.TableFunction(np.sqrt(members @ np.linspace(1.0, 2.0, 18)))
    return [partial(ro.find_submodularity_violation, table), partial(ro.total_curvature, table)]


def brackets(robots: int) -> list[Callable[[], Any]]:
    """The bracket of total curvature over feasible sets."""
    import ratt_opt as ro

    first = islice(problems(robots), len(KINDS))
    return [partial(ro.total_curvature, problem.objective, problem.robot) for problem in first]


def ratios() -> list[Callable[[], Any]]:
    """Exact worst-case ratios of RATT."""
    import ratt_opt as ro

    budgets = ((0, 3), (1, 0), (1, 3), (2, 2))
    return [partial(ro.worst_case_ratio, 4, *b, curvature=0.5, family="submodular") for b in budgets]


ROWS: dict[str, Callable[[], list[Callable[[], Any]]]] = {
    "RATT, 30 robots": planning,
    "exhaustive search, 4 robots": exhaustive,
    "attack, 10 robots": partial(attacks, 10),
    "attack, 20 robots": partial(attacks, 20),
    "attack, 30 robots": partial(attacks, 30),
    "n_max by enumeration": partial(largest_groups, "enumeration"),
    "n_max by integer program": partial(largest_groups, "milp"),
    "best plan, 10 robots, gap 1e-9": partial(best_plans, 10, 1e-9),
    "best plan, 20 robots, gap 1e-6": partial(best_plans, 20, 1e-6),
    "best plan, 30 robots, gap 1e-6": partial(best_plans, 30, 1e-6),
    "verification, 10 robots": partial(verifications, 10),
    "table of 2^18 values": tables,
    "curvature bracket, 10 robots": partial(brackets, 10),
    "curvature bracket, 30 robots": partial(brackets, 30),
    "worst ratio, 4 robots": ratios,
}


def seconds_of(row: str) -> float:
    """Processor seconds of a row's calls, made a second time."""
    calls = ROWS[row]()
    for call in calls:
        call()
    began = time.process_time()
    for call in calls:
        call()
    return time.process_time() - began


def seconds_in(folder: Path, row: str) -> float | None:
    """The same in a process of the edition in ``folder``; ``None`` if it fails."""
    environment = {**os.environ, "PYTHONPATH": str(folder), "PYTHONDONTWRITEBYTECODE": "1"}
    command = [sys.executable, str(Path(__file__).resolve()), "--child", row, *KINDS]
    done = subprocess.run(command, env=environment, capture_output=True, text=True, check=False, cwd=folder)
    return json.loads(done.stdout) if done.returncode == 0 else None


def compared(earlier: Path, row: str, rounds: int) -> dict[str, Any]:
    """One row of the table."""
    here = Path(__file__).resolve().parents[2]
    times = [(seconds_in(earlier, row), seconds_in(here, row)) for _ in range(rounds)]
    before, now = (min((t for t in one if t is not None), default=None) for one in zip(*times, strict=True))
    ratio = None if before is None or now is None else now / before
    verdict = "failed" if ratio is None else "slower" if ratio > SLOWER else ""
    return {"row": row, "earlier_s": before, "now_s": now, "now_over_earlier": ratio, "verdict": verdict}


def main() -> None:
    """Print the table; exit 1 if a row is slower."""
    from analysis.tables import print_table

    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("earlier", type=Path, help="folder of the earlier edition")
    parser.add_argument("--rows", nargs="+", default=list(ROWS), help="names, or beginnings of them")
    parser.add_argument("--rounds", type=int, default=3)
    parser.add_argument("--kinds", nargs="+", default=list(KINDS), choices=KINDS)
    options = parser.parse_args()
    KINDS[:] = options.kinds
    wanted = [row for row in ROWS if row.startswith(tuple(options.rows))]
    rows = []
    for row in wanted:
        rows.append(compared(options.earlier, row, options.rounds))
        print(rows[-1], file=sys.stderr, flush=True)
    print_table("Processor seconds, the smallest of the rounds", rows)
    sys.exit(any(row["verdict"] for row in rows))


if __name__ == "__main__":
    if sys.argv[1:2] == ["--child"]:
        KINDS[:] = sys.argv[3:]
        print(json.dumps(seconds_of(sys.argv[2])))
    else:
        main()
