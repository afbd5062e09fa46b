"""The worst attack on one plan, or the best plan, by the edition of ``ratt_opt`` on the path, compared in the same run.

Run by ``analysis.benchmarks.networks`` as a process of its own: reads the plan's data from a file, prints a line of
JSON. Only names of the public contract are used, which every edition has.
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
import tempfile
import time
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from ratt_opt import Problem
    from ratt_opt._validation import IntArray

__all__ = ["earlier_bracket"]

SPARE = 120.0
"""Seconds beyond the limit before an earlier edition is given up: many compile at first use, and some overrun."""
BUSY = 3
"""Wall seconds that a processor second may take on a busy machine."""
WARM = 1.0
"""Seconds of a first search, with no budgets to speak of, not counted: modules and compiled code are loaded then."""


def earlier_bracket(
    tree: Path,
    problem: Problem,
    objective: str,
    plan: IntArray | None = None,
    *,
    seconds: float,
    gap: float = 0.0,
    processor: bool = False,
) -> dict[str, Any]:
    """``lower``, ``upper``, ``stop`` and ``seconds`` of the edition in ``tree``; ``stop`` "none" if nothing came.

    ``plan`` : attacked; without one the best plan is searched for
    ``gap`` : present for a search for the best plan
    ``processor`` : count seconds of the processor
    """
    patience = BUSY * seconds + SPARE if processor else seconds + SPARE
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder, "plan.npz")
        team: Any = problem.objective
        links = np.array(sorted(problem.communication.links)).reshape(-1, 2)
        budgets = np.array([problem.alpha_s, problem.alpha_c])
        elements = np.arange(team.n) if plan is None else plan
        chosen = {"information": team.information[elements], "robot": problem.robot[elements]}
        np.savez(path, prior=team.prior, links=links, budgets=budgets, **chosen)
        what = "plan" if plan is None else "attack"
        asked = [sys.executable, __file__, what, str(path), objective, str(seconds), str(gap), str(processor)]
        environment = {
            **os.environ,
            "PYTHONPATH": str(tree),
            "NUMBA_CACHE_DIR": str(Path(tempfile.gettempdir(), "numba")),  # of editions that compiled with it
        }
        try:
            done = subprocess.run(
                asked, env=environment, cwd=tree, capture_output=True, check=True, timeout=patience, text=True
            )
        except subprocess.TimeoutExpired:
            return {"lower": 0.0, "upper": np.inf, "stop": "none", "seconds": patience}
        answer: dict[str, Any] = json.loads(done.stdout.splitlines()[-1])
        return answer


def _main(what: str, path: str, objective: str, seconds: float, gap: float, *, processor: bool) -> None:
    if processor:
        time.monotonic = time.perf_counter = time.process_time  # before the edition reads either
    import networkx as nx

    import ratt_opt

    data = np.load(path)
    robot = data["robot"]
    graph: nx.Graph[int] = nx.Graph()
    graph.add_nodes_from(range(robot.max() + 1))
    graph.add_edges_from(data["links"].tolist())
    kinds = {"trace": "TraceObjective", "logdet": "LogDetObjective", "maxeig": "MaxEigenvalueObjective"}
    team = getattr(ratt_opt, kinds[objective])(data["prior"], data["information"])
    problem = ratt_opt.Problem(team, robot, graph, *data["budgets"].tolist())

    def search(problem: Problem, limit: float) -> Any:
        if what == "attack":
            return ratt_opt.worst_case_attack(problem, np.arange(len(robot)), time_limit=limit)
        return ratt_opt.solve_maxmin(problem, gap=gap, time_limit=limit)

    search(replace(problem, alpha_s=1, alpha_c=1), WARM)
    began = time.perf_counter()
    result = search(problem, seconds)
    spent = time.perf_counter() - began
    ends = {"lower": result.lower, "upper": result.upper, "stop": result.stop.value, "seconds": spent}
    sys.stdout.write(json.dumps(ends) + "\n")


if __name__ == "__main__":
    what, path, objective, seconds, gap, processor = sys.argv[1:]
    _main(what, path, objective, float(seconds), float(gap), processor=processor == "True")
