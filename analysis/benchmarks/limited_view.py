"""Best plans of teams whose robots must choose what to look at: how much stays open, and for how long.

Run as ``python -m analysis.benchmarks.limited_view [--rows 6,8 10,10 20,20 50,50] [--networks complete disk]
[--objectives trace logdet] [--seeds 10] [--log FILE]``. Each row is searched to 1e-4 within the limit of its size.
Seconds are of the processor. If a row of 6 or 10 robots closes, its certificate is written and verified with
``--certify``. Teams are those of ``limited_view_scenario`` with a view of 57 degrees: 16 controls; on a disk network
robots within 45 m are linked.
"""

from __future__ import annotations

import argparse
import tempfile
from pathlib import Path
from time import process_time
from typing import TYPE_CHECKING, Any

import numpy as np

from analysis.tables import append_csv, print_table
from ratt_opt import InputError, certify, limited_view_scenario, ratt, solve_maxmin, worst_case_attack
from ratt_opt.errors import UndecidedError

if TYPE_CHECKING:
    from collections.abc import Iterator

    from ratt_opt import MaxMinResult, Problem

BUDGETS = {6: (2, 4), 10: (3, 8), 20: (5, 20), 50: (12, 50)}
SECONDS = {("complete", 20): 30.0, ("disk", 20): 60.0, 6: 3.0, 10: 30.0, 50: 120.0}
"""Limits of the processor: of a network and a size, or of a size."""
VIEW, REACH_OF_LINKS = 57.0, 45.0
CLOSED = 1e-4


def team(robots: int, targets: int, network: str, seed: int) -> Any:
    """The scenario of one row and seed; no more links are cut than there are."""
    alpha_s, alpha_c = BUDGETS[robots]
    near = REACH_OF_LINKS if network == "disk" else None
    drawn = limited_view_scenario(
        robots, targets, alpha_s=alpha_s, alpha_c=0, seed=seed, view=VIEW, communication_range=near
    )
    links = len(drawn.problem("trace").communication.links)
    return drawn.replace(alpha_c=min(alpha_c, links))


def measure(problem: Problem, seconds: float, *, certified: bool) -> dict[str, Any]:
    """Measure the open gap, the seconds, and RATT's worst case as a share of the best one."""
    began = process_time()
    found = solve_maxmin(problem, gap=CLOSED, time_limit=seconds)
    row: dict[str, Any] = {
        "lower": found.lower,
        "upper": found.upper,
        "open": (found.upper - found.lower) / found.upper,
        "cpu_s": process_time() - began,
        "by_covers": found.proof is not None and bool(found.proof.covers),
        "ratt": worst_case_attack(problem, ratt(problem).elements, time_limit=seconds).lower / found.lower,
    }
    if certified:
        row |= (
            _certified(problem, found) if row["open"] <= CLOSED else {"certificate_s": np.nan, "certificate_mb": np.nan}
        )
    return row


def _certified(problem: Problem, found: MaxMinResult) -> dict[str, float]:
    began = process_time()
    with tempfile.TemporaryDirectory() as folder:
        try:
            size = certify(problem, found, Path(folder) / "certificate.json").size / 1e6
        except (InputError, UndecidedError):  # it is too long for the verifier
            size = np.inf
    return {"certificate_s": process_time() - began, "certificate_mb": size}


def measured(args: argparse.Namespace) -> Iterator[dict[str, Any]]:
    """All rows, one by one."""
    for pair in args.rows:
        robots, targets = map(int, pair.split(","))
        for network in args.networks:
            seconds = args.seconds or SECONDS.get((network, robots), SECONDS.get(robots, 60.0))
            for name in args.objectives:
                for seed in range(args.seeds):
                    problem = team(robots, targets, network, seed).problem(name)
                    of = {"robots": robots, "targets": targets, "network": network, "objective": name, "seed": seed}
                    yield of | measure(problem, seconds, certified=args.certify and robots <= 10)


def summary(rows: list[dict[str, Any]]) -> list[dict[str, object]]:
    """A line for each size, network and criterion."""
    lines: list[dict[str, object]] = []
    for key in dict.fromkeys((r["robots"], r["targets"], r["network"], r["objective"]) for r in rows):
        own = [r for r in rows if (r["robots"], r["targets"], r["network"], r["objective"]) == key]
        of = dict(zip(("robots", "targets", "network", "objective"), key, strict=True))
        open_, seconds = np.array([r["open"] for r in own]), np.array([r["cpu_s"] for r in own])
        lines.append(
            of
            | {
                "closed": f"{int((open_ <= CLOSED).sum())} of {len(own)}",
                "median_open_%": 100 * float(np.median(open_)),
                "largest_open_%": 100 * float(open_.max()),
                "median_s": float(np.median(seconds)),
                "largest_s": float(seconds.max()),
                "ratt/best": float(np.median([r["ratt"] for r in own])),
            }
        )
    return lines


def main() -> None:
    """Measure, log row by row, and print the table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--rows", nargs="+", default=["6,8", "10,10", "20,20", "50,50"])
    parser.add_argument("--networks", nargs="+", choices=["complete", "disk"], default=["complete", "disk"])
    parser.add_argument("--objectives", nargs="+", choices=["trace", "logdet"], default=["trace", "logdet"])
    parser.add_argument("--seeds", type=int, default=10)
    parser.add_argument("--seconds", type=float, default=None, help="one limit for all rows")
    parser.add_argument("--certify", action="store_true", help="write and verify certificates at 6 and 10 robots")
    parser.add_argument("--log", type=Path, default=None, help="CSV file that takes every row as it is measured")
    args = parser.parse_args()
    rows: list[dict[str, Any]] = []
    for row in measured(args):
        rows.append(row)
        print(*(f"{value:.4g}" if isinstance(value, float) else value for value in row.values()), flush=True)
        if args.log is not None:
            append_csv(args.log, row)
    print_table(
        "Open of the best plan's bracket, processor seconds, and RATT's worst case as a share of it", summary(rows)
    )


if __name__ == "__main__":
    main()
