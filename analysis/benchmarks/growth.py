"""From ten robots to a thousand: ``python -m analysis.benchmarks.growth [--robots 10 100] [--seconds 60]
[--searches attack maxmin] [--processor] [--out DIR]``.

With ``--earlier FOLDER`` RATT of the edition in FOLDER beside it, to the first size at which it takes ``PATIENCE``.

Complete graph, 12 controls, 0.3 targets a robot, a tenth of the robots blinded, a twentieth of the links cut. RATT
(processor seconds) beside the ``O(N^2)`` evaluations of Theorem 2; then the bracket of its worst case, and of the
optimum, after that many seconds, and the memory of the process. ``--out`` writes the growth as a figure; with
``--processor`` limits are of the processor, which other work on the machine does not stretch.
"""

from __future__ import annotations

import argparse
import json
import os
import resource
import subprocess
import sys
import time
from pathlib import Path
from typing import TYPE_CHECKING, Any

import ratt_opt as ro
from analysis.benchmarks.timing import count_processor_time
from analysis.tables import print_table
from ratt_opt._rounding import relative_gap
from ratt_opt.studies.plots import IN_TURN, new_figure

if TYPE_CHECKING:
    from ratt_opt import Problem

SIZES = (10, 20, 50, 100, 200, 500, 1000)
OBJECTIVES = ("trace", "logdet", "maxeig")
WARM = 200
"""Robots of a problem that loads what larger ones need, not counted."""
PATIENCE = 1.0
"""Processor seconds of an earlier edition's RATT after which larger teams are not asked for."""
EARLIER = """
import json, sys, time
import ratt_opt
robots, targets, alpha_s, alpha_c, objective = json.loads(sys.argv[1])
scenario = ratt_opt.random_scenario(robots, targets, alpha_s=alpha_s, alpha_c=alpha_c, seed=0)
problem = scenario.problem(objective)
ratt_opt.ratt(ratt_opt.random_scenario(4, 2, alpha_s=1, alpha_c=0, seed=0).problem(objective))
began = time.process_time()
ratt_opt.ratt(problem)
print(time.process_time() - began)
"""
"""What another edition runs, in names of the public contract."""


def sizes_of(robots: int) -> tuple[int, int, int, int]:
    """Robots, targets, blinded, cut."""
    return robots, max(3, 3 * robots // 10), robots // 10, robots * (robots - 1) // 40


def problem_of(robots: int, objective: str) -> Problem:
    """The problem of one size."""
    _, targets, alpha_s, alpha_c = sizes_of(robots)
    return ro.random_scenario(robots, targets, alpha_s=alpha_s, alpha_c=alpha_c, seed=0).problem(objective)


def measure(robots: int, objective: str, seconds: float, searches: list[str]) -> dict[str, Any]:
    """One row: RATT's processor seconds and evaluations, and relative widths of the brackets after some seconds."""
    problem = problem_of(robots, objective)
    began = time.process_time()
    plan = ro.ratt(problem)
    row: dict[str, Any] = {"robots": robots, "objective": objective, "ratt_s": time.process_time() - began}
    row["evaluations"] = plan.evaluations
    for name in searches if seconds else ():
        began = time.monotonic()
        if name == "attack":
            attack = ro.worst_case_attack(problem, plan.elements, time_limit=seconds)
            gap = relative_gap(attack.lower, attack.upper)
        else:
            found = ro.solve_maxmin(problem, gap=1e-4, time_limit=seconds)
            gap = relative_gap(found.lower, found.upper)
        row |= {f"{name}_s": time.monotonic() - began, f"{name}_gap": gap}
    return row | {"memory_GiB": resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 2**20}


def earlier_seconds(edition: Path, robots: list[int], objective: str) -> dict[int, float]:
    """Processor seconds of RATT of the edition in a folder, by size, as far as patience goes."""
    found: dict[int, float] = {}
    environment = {**os.environ, "PYTHONPATH": str(edition)}
    for size in sorted(robots):
        asked = [sys.executable, "-c", EARLIER, json.dumps([*sizes_of(size), objective])]
        done = subprocess.run(asked, env=environment, cwd=edition, capture_output=True, check=True, text=True)
        found[size] = float(done.stdout)
        if found[size] > PATIENCE:
            break
    return found


def draw(rows: list[dict[str, Any]], path: Path) -> None:
    """RATT's seconds over the number of robots, and its evaluations scaled to the first criterion's last point."""
    figure = new_figure(8.0, 4.0)
    axes = figure.subplots()
    for objective, marker, colour in zip(OBJECTIVES, "os^", IN_TURN, strict=False):
        own = [row for row in rows if row["objective"] == objective]
        axes.loglog(
            [row["robots"] for row in own], [row["ratt_s"] for row in own], marker=marker, color=colour, label=objective
        )
        earlier = [(row["robots"], row["earlier_ratt_s"]) for row in own if row.get("earlier_ratt_s") is not None]
        if earlier:
            axes.loglog(*zip(*earlier, strict=True), marker=marker, color=colour, linestyle="-.",
                        markerfacecolor="none", label=f"{objective}, first edition")  # fmt: skip
    own = [row for row in rows if row["objective"] == rows[0]["objective"]]
    sizes, last = [row["robots"] for row in own], own[-1]
    square = [last["ratt_s"] * (n / last["robots"]) ** 2 for n in sizes]
    axes.loglog(sizes, square, "k--", linewidth=1, label="$N^2$ (evaluations, Theorem 2)")
    axes.loglog(sizes, [s * n / last["robots"] for s, n in zip(square, sizes, strict=True)], "k:", linewidth=1,
                label="$N^3$ (with 0.3 N targets a value)")  # fmt: skip
    axes.set(xlabel="robots N", ylabel="RATT, processor seconds", title="12 controls, 0.3 N targets, complete graph")
    axes.grid(visible=True, which="both", linewidth=0.3)
    axes.set_ylim(bottom=min(row["ratt_s"] for row in rows) / 5)  # the lines to compare with may leave
    figure.legend(loc="outside right upper", frameon=False)
    figure.savefig(path, dpi=110)


def main() -> None:
    """Print the table; draw the figure if asked."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--robots", type=int, nargs="*", default=list(SIZES))
    parser.add_argument("--objectives", nargs="*", default=list(OBJECTIVES), choices=OBJECTIVES)
    parser.add_argument("--seconds", type=float, default=0.0, help="limit of each search; 0 plans only")
    parser.add_argument("--searches", nargs="*", default=["attack", "maxmin"], choices=("attack", "maxmin"))
    parser.add_argument("--processor", action="store_true", help="count seconds of the processor, on a busy machine")
    parser.add_argument("--out", type=Path, help="folder for growth.png")
    parser.add_argument("--earlier", type=Path, help="folder of an earlier edition")
    options = parser.parse_args()
    if options.processor:
        count_processor_time()
    for objective in options.objectives:
        ro.ratt(ro.random_scenario(WARM, WARM, alpha_s=1, alpha_c=0, seed=0).problem(objective))
    rows = []
    for objective in options.objectives:
        for robots in options.robots:
            rows.append(measure(robots, objective, options.seconds, options.searches))
            print(rows[-1], file=sys.stderr, flush=True)
    if options.earlier is not None:
        for objective in options.objectives:
            found = earlier_seconds(options.earlier, options.robots, objective)
            for row in (row for row in rows if row["objective"] == objective):
                row["earlier_ratt_s"] = found.get(row["robots"])
    print_table("Growth", rows)
    if options.out is not None:
        draw(rows, options.out / "growth.png")


if __name__ == "__main__":
    main()
