"""Set functions: ``python -m analysis.benchmarks.setfunctions [--tables] [--brackets]`` (both by default).

Tables: submodularity and total curvature of a table of 2**20 and 2**24 values, each in a process of its own whose
peak memory is measured; against n plain NumPy passes over the same table (one difference and its smallest entry an
element); and the table of a trace objective of 25 targets against one flat NumPy call of the same closed forms.

Brackets: total curvature over feasible sets (log-det: curvature) of Section VI scenarios until
``(1 - lower) / (1 - upper)`` is at most 1.10 (N = 10, M = 15; 1.2 with anisotropic priors) or 1.15 (N = 30, M = 25).
Modules are loaded first.
"""

from __future__ import annotations

import argparse
import resource
import subprocess
import sys
import time

import numpy as np

from analysis.benchmarks.timing import best_seconds
from ratt_opt import (
    TableFunction,
    TraceObjective,
    curvature,
    find_submodularity_violation,
    random_scenario,
    total_curvature,
)
from ratt_opt._rounding import down, up
from ratt_opt.setfunctions.information import InformationObjective

SEEDS = range(5)
NO_LIMIT = 600.0
"""Seconds after which a bracket is given up; far above the figures to reach."""
SIZES = ((10, 15, False, 0.10), (10, 15, True, 0.20), (30, 25, False, 0.15))


def main(arguments: list[str] | None = None) -> None:
    """Print the tables."""
    parser = argparse.ArgumentParser(description=__doc__)
    for part in ("tables", "brackets"):
        parser.add_argument(f"--{part}", action="store_true")
    parser.add_argument("--one", type=int, help=argparse.SUPPRESS)
    options = parser.parse_args(arguments)
    if options.one:
        _measure(options.one)
        return
    if options.tables or not options.brackets:
        tables()
    if options.brackets or not options.tables:
        brackets()


def tables() -> None:
    """Checks of whole tables, and the building of one."""
    print(f"{'what':46} {'seconds':>9} {'plain':>9} {'ratio':>7} {'peak MiB':>9}", flush=True)
    for n in (20, 24):
        command = [sys.executable, "-m", "analysis.benchmarks.setfunctions", "--one", str(n)]
        subprocess.run(command, check=True)
    f = _trace(20, 25)
    ours = best_seconds(f.table, repeats=3)
    _row("table of a trace objective, n = 20, M = 25", ours, best_seconds(lambda: flat_trace(f), repeats=3), "")


def flat_trace(f: TraceObjective) -> np.ndarray[tuple[int], np.dtype[np.float64]]:
    """The closed forms of all ``2**n M`` posterior traces in one flat call; the sums of information are not counted."""
    count = 2**f.n * f.n_targets
    a, b, c = np.full(count, 2.0), np.full(count, 0.5), np.full(count, 3.0)
    return np.asarray(((a + c) / (a * c - b * b)).reshape(-1, f.n_targets).sum(axis=1))


def brackets() -> None:
    """Curvature brackets of Section VI scenarios."""
    small = random_scenario(10, 4, alpha_s=1, alpha_c=1, seed=0).problem("maxeig")
    total_curvature(small.objective, small.robot, gap=0.0, max_nodes=100)  # loads modules
    print(
        f"{'N':>3} {'M':>3} {'prior':>11} {'objective':>9} {'seed':>4} {'lower':>10} {'upper':>10} {'ratio':>7} ",
        end="",
    )
    print(f"{'CPU s':>7} {'wall s':>7} {'parts':>6}", flush=True)
    for robots, targets, stretched, gap in SIZES:
        for kind in ("trace", "logdet", "maxeig"):
            for seed in SEEDS:
                bracket(robots, targets, kind, seed, stretched=stretched, gap=gap)


def bracket(robots: int, targets: int, kind: str, seed: int, *, stretched: bool, gap: float) -> None:
    """Bracket one curvature and print its row."""
    problem = random_scenario(robots, targets, alpha_s=1, alpha_c=1, seed=seed).problem(kind)
    f = problem.objective
    assert isinstance(f, InformationObjective)
    if stretched:
        f = anisotropic(f, seed)
    measure = curvature if f.is_submodular else total_curvature
    busy, began = time.process_time(), time.perf_counter()
    found = measure(f, problem.robot, gap=gap, time_limit=NO_LIMIT)
    busy, wall = time.process_time() - busy, time.perf_counter() - began
    ratio = (1 - found.lower) / (1 - found.upper) if found.upper < 1 else np.inf
    print(f"{robots:3} {targets:3} {'anisotropic' if stretched else 'isotropic':>11} {kind:>9} {seed:4} ", end="")
    ends = f"{down(found.lower, 6):>10} {up(found.upper, 6):>10} {up(ratio, 5):>7}"
    print(f"{ends} {busy:7.2f} {wall:7.2f} {found.nodes:6}", flush=True)


def anisotropic(f: InformationObjective, seed: int) -> InformationObjective:
    """The same sensors with priors stretched by 0.5 to 2 along random axes (variances by 1/4 to 4)."""
    rng = np.random.default_rng([seed, 99])
    angle = rng.uniform(0, np.pi, f.n_targets)
    turn = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]]).transpose(2, 0, 1)
    stretch = turn * rng.uniform(0.5, 2, (f.n_targets, 1, 2)) @ turn.transpose(0, 2, 1)
    return type(f)(stretch @ f.prior @ stretch, f.information, f.weights)


def _measure(n: int) -> None:
    """Both checks of one random monotone table, in this process alone, with its peak memory."""
    warm = TableFunction(np.zeros(16))
    find_submodularity_violation(warm), total_curvature(warm)  # loads modules
    f = TableFunction(_monotone(n))
    plain = best_seconds(lambda: plain_passes(f), repeats=3)
    began = time.perf_counter()
    find_submodularity_violation(f)
    middle = time.perf_counter()
    total_curvature(f)
    ended = time.perf_counter()
    peak = f"{resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024:.0f}"
    _row(f"submodularity of a table, n = {n}", middle - began, plain, peak)
    _row(f"total curvature of a table, n = {n}", ended - middle, plain, peak)
    _row(f"both, n = {n}", ended - began, plain, peak)


def plain_passes(f: TableFunction) -> list[float]:
    """n passes: the smallest marginal of each element."""
    halves = [f.values.reshape(-1, 2, 1 << x) for x in range(f.n)]
    return [float((half[:, 1] - half[:, 0]).min()) for half in halves]


def _monotone(n: int) -> np.ndarray[tuple[int], np.dtype[np.float64]]:
    """A non-decreasing table: a modular function plus noise smaller than its weights."""
    rng = np.random.default_rng(0)
    values = np.zeros(1)
    for weight in rng.uniform(1, 2, n):
        values = np.concatenate([values, values + weight])
    return values + rng.uniform(0, 0.1, len(values)) * (values > 0)


def _trace(n: int, targets: int) -> TraceObjective:
    rng = np.random.default_rng(0)
    factor = rng.normal(size=(n, targets, 2, 2))
    return TraceObjective(np.tile(np.eye(2), (targets, 1, 1)), factor @ factor.swapaxes(-1, -2))


def _row(name: str, seconds: float, plain: float, peak: str) -> None:
    print(f"{name:46} {seconds:9.3f} {plain:9.3f} {seconds / plain:6.1f}x {peak:>9}", flush=True)


if __name__ == "__main__":
    main()
