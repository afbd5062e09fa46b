"""One function a table: rows of a publication with its values and ours; a row is made once."""

from __future__ import annotations

import csv
import time
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

import ratt_opt as ro
from analysis.benchmarks.fewest_cuts import every_row, published
from analysis.benchmarks.rivals import coverage, p_median, scenario_bracket
from analysis.published.designs import best_design, entropy_design
from analysis.tables import append_csv, read_csv

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from analysis.benchmarks.rivals import Case

__all__ = ["P_MEDIAN", "TABLES", "make"]

P_MEDIAN = {1: 5819, 2: 4093, 3: 4250, 4: 3034, 6: 7824}
"""Published optima of OR-Library without losses."""
TEAMS = ((10, 7, 100, 3), (15, 7, 150, 6))
SEEDS = 3
Row = dict[str, Any]


def make(name: str, data: Path, folder: Path, seconds: float) -> list[dict[str, str]]:
    """Make what is missing of a table, and return all its rows."""
    path = folder / f"{name}.csv"
    known = {row["row"] for row in read_csv(path)} if path.exists() else set[str]()
    for key, build in TABLES[name](data, seconds):
        if key not in known:
            row = {"row": key, **build()}
            append_csv(path, row)
            print(name, row, flush=True)
    return read_csv(path) if path.exists() else []


def _cuts(data: Path, seconds: float) -> Iterator[tuple[str, Callable[[], Row]]]:
    for k, row in enumerate(published(data / "graph_partition")):
        yield f"{k} {row['graph']} {row['size']}", partial(_cut_row, row, seconds)


def _cut_row(row: Row, seconds: float) -> Row:
    (ours,) = every_row([row], seconds)
    return {name: ours[name] for name in ("table", "graph", "size", "published", "ours", "agrees", "s", "gurobi_s")}


def _facilities(data: Path, seconds: float) -> Iterator[tuple[str, Callable[[], Row]]]:
    for lost in (0, 1, 2):
        for number, optimum in P_MEDIAN.items():
            case = p_median(number, lost, data / "orlib").draw(0)
            if case is not None:
                known = optimum if lost == 0 else None
                yield f"pmed{number} {lost}", partial(_beside_highs, case, seconds, known)


def _teams(_data: Path, seconds: float) -> Iterator[tuple[str, Callable[[], Row]]]:
    for size in TEAMS:
        for seed in range(SEEDS):
            case = coverage(*size).draw(seed)
            assert case is not None
            yield f"{size} seed {seed}", partial(_beside_highs, case, seconds, None)


def _beside_highs(case: Case, seconds: float, known: float | None) -> Row:
    """Our bracket and that of the field's scenario program, costs if ``case.most`` is given."""
    began = time.process_time()
    found = ro.solve_maxmin(case.asked, gap=1e-4, time_limit=seconds)
    ours, s = (found.lower, found.upper), time.process_time() - began
    rival = scenario_bracket(case.rivals or case.asked, seconds)
    theirs, other = (rival.lower, rival.upper), rival.seconds
    if case.most is not None:
        ours, theirs = ((case.most - high, case.most - low) for low, high in (ours, theirs))
    head = {"published": "" if known is None else known}
    ends = zip(("ours from", "ours to", "HiGHS from", "HiGHS to"), (*ours, *theirs), strict=True)
    return {**head, **{name: float(value) for name, value in ends}, "s": s, "HiGHS s": other}


def _entropy(data: Path, _seconds: float) -> Iterator[tuple[str, Callable[[], Row]]]:
    from scipy.io import loadmat

    folder = data / "entropy_sampling"
    with Path(folder / "published.csv").open(encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    for n in (63, 90, 124):
        found = loadmat(folder / f"data{n}.mat")
        covariance = next(m for m in found.values() if getattr(m, "shape", None) == (n, n)).astype(np.float64)
        own = [row for row in rows if int(row["n"]) == n]
        for row in own[4::10]:
            yield f"{n} {row['s']}", partial(_entropy_row, row, covariance)


def _entropy_row(row: dict[str, str], covariance: Any) -> Row:
    began = time.process_time()
    found = entropy_design(covariance, int(row["s"]), rounds=1500)
    theirs = {name: float(row[name]) for name in ("heuristic", "linx", "factorization", "complementary")}
    return {"ours": found.lower, **theirs, "our bound": found.upper, "s": time.process_time() - began}


def _designs(data: Path, _seconds: float) -> Iterator[tuple[str, Callable[[], Row]]]:
    for buses in (118, 300):
        gain = np.loadtxt(data / "pmu" / f"gain_matrix_{buses}.csv", delimiter=",", skiprows=1)[:, 1:]
        variance = np.loadtxt(data / "pmu" / f"PMU_variance_{buses}.csv", delimiter=",", skiprows=1)[:, 1]
        start, rows = (gain + gain.T) / 2, np.diag(1 / np.sqrt(variance))
        for s in (5, 10, 20, 40):
            yield f"{buses} {s}", partial(_design_row, start, rows, s)


def _design_row(start: Any, rows: Any, s: int) -> Row:
    began = time.process_time()
    found = best_design(start, rows, s, rounds=1000)
    base = float(np.linalg.slogdet(start)[1])
    return {"ours": found.lower - base, "our bound": found.upper - base, "s": time.process_time() - began}


TABLES = {"cuts": _cuts, "facilities": _facilities, "teams": _teams, "entropy": _entropy, "designs": _designs}
"""Name of a table -> its rows, each by a key and a function that makes it."""
