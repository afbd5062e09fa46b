"""Plans against rivals, on families of instances that others published: processor seconds, one run, one row a seed.

Run as ``python -m analysis.benchmarks.rivals [--only WORD] [--seconds S] [--seeds K] [--first SEED] [--out FILE]``;
the file is a table (CSV) that gets each row as it comes. Rivals are HiGHS's scenario program (``scenario_program`` of
``ratt_opt.planners``; its bound is a claim) and the greedy plan with exchanges. ``open`` is
``(upper - lower) / upper``; of the p-median rows all ends are costs, and ``open`` is a share of the cost of the plan.

- Resilient coverage (Shi, Zhou, Tokekar and others 2021): R robots, each of P paths covers 5 to 15 of T targets, A
  robots are lost.
- p-median (OR-Library, Beasley 1990): choose p of n sites, A of them are lost.
- Cameras: teams of ``limited_view.py`` on complete and disk networks, log-det and trace, against ``tangent_milp.py``
  and greedy with exchanges by exact attacks; ``seconds`` of 50 cameras count double.
"""

from __future__ import annotations

import argparse
import csv
import time
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from analysis.benchmarks.timing import count_processor_time

count_processor_time()

from scipy.sparse.csgraph import shortest_path  # noqa: E402

import ratt_opt as ro  # noqa: E402
from analysis.benchmarks.exchanges import RivalBracket, exchanges  # noqa: E402
from analysis.benchmarks.instances import team  # noqa: E402
from analysis.benchmarks.tangent_milp import attacked_exchanges, tangent_milp  # noqa: E402
from ratt_opt.planners import scenario_program  # noqa: E402

if TYPE_CHECKING:
    from collections.abc import Callable

    from ratt_opt._validation import BoolArray, FloatArray

__all__ = ["FAMILIES", "Case", "Family", "scenario_bracket"]

GAP = 1e-4
"""Relative gap that counts as closed: HiGHS's own default."""
ORLIB = Path(__file__).parents[2].parent / "shared" / "data" / "orlib"


@dataclass(frozen=True, slots=True, kw_only=True)
class Case:
    """One instance: ``asked`` of the library, and the same as a sum of best elements, which the rivals take.

    ``rivals`` : ``None`` if there is no such form
    ``cameras`` : whether the rivals are those of criteria
    ``most`` : shown is ``most`` less the value, if it is not ``None``: a cost
    """

    asked: ro.Problem
    rivals: ro.Problem | None = None
    most: float | None = None
    cameras: bool = False


@dataclass(frozen=True, slots=True, kw_only=True)
class Family:
    """Instances of one name and size; ``draw`` makes that of a seed, or ``None`` if there is none.

    ``longer`` : factor of the seconds
    """

    name: str
    draw: Callable[[int], Case | None]
    longer: float = 1.0


def coverage(robots: int, paths: int, targets: int, lost: int) -> Family:
    """Resilient coverage as the trace criterion of prior 1 and information 1e6."""

    def draw(seed: int) -> Case:
        covers = resilient_coverage(robots, paths, targets, seed)
        owner = np.repeat(np.arange(robots), paths)
        trace = ro.TraceObjective(np.ones((targets, 1, 1)), 1e6 * covers[:, :, None, None])
        plain = ro.Coverage(covers, np.ones(targets))
        return Case(asked=ro.Problem(trace, owner, None, lost, 0), rivals=ro.Problem(plain, owner, None, lost, 0))

    return Family(name=f"coverage {robots}, {paths}, {targets}, {lost}", draw=draw)


def resilient_coverage(robots: int, paths: int, targets: int, seed: int) -> BoolArray:
    """(robots * paths, targets) whether each path covers each target."""
    rng = np.random.default_rng(seed)
    covers = np.zeros((robots * paths, targets), dtype=np.bool_)
    for row in covers:
        row[rng.integers(0, targets, size=rng.integers(5, 16))] = True
    return covers


def p_median(number: int, lost: int, folder: Path = ORLIB) -> Family:
    """One instance of OR-Library, whatever the seed."""

    def draw(seed: int) -> Case | None:
        if seed > 0 or not (folder / f"pmed{number}.txt").exists():
            return None
        distance, facilities = read_p_median(folder / f"pmed{number}.txt")
        sites, far = len(distance), float(distance.max())
        f = ro.FacilityLocation(np.tile(far - distance, (facilities, 1)))
        problem = ro.Problem(f, np.repeat(np.arange(facilities), sites), None, lost, 0)
        return Case(asked=problem, rivals=problem, most=far * sites)

    return Family(name=f"pmed{number}, {lost} lost", draw=draw)


def read_p_median(path: Path) -> tuple[FloatArray, int]:
    """(n, n) shortest paths between sites, and the number of facilities; of parallel links the last one counts."""
    numbers = np.array(path.read_text(encoding="ascii").split(), dtype=np.int64)
    sites, facilities = int(numbers[0]), int(numbers[2])
    lengths = np.zeros((sites, sites))
    for i, j, length in numbers[3:].reshape(-1, 3):
        lengths[i - 1, j - 1] = lengths[j - 1, i - 1] = length
    return np.asarray(shortest_path(lengths, method="D")), facilities


def cameras(robots: int, network: str, objective: str, longer: float = 1.0) -> Family:
    """Cameras that must choose what to look at."""

    def draw(seed: int) -> Case:
        problem = team(robots, robots, network, seed).problem(objective)
        return Case(asked=problem, rivals=problem, cameras=True)

    return Family(name=f"{robots} cameras, {objective}, {network}", draw=draw, longer=longer)


FAMILIES: tuple[Family, ...] = (
    coverage(10, 7, 100, 3),
    coverage(15, 7, 150, 6),
    *(p_median(number, lost) for lost in (0, 1, 2) for number in (1, 2, 3, 4, 6)),
    *(cameras(robots, n, o) for robots in (10, 20) for o in ("logdet", "trace") for n in ("complete", "disk")),
    *(cameras(50, n, o, longer=2.0) for o in ("logdet", "trace") for n in ("complete", "disk")),
)


def main(arguments: list[str] | None = None) -> None:
    """Print a row for each instance."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--only", default="", help="families whose name holds this word")
    parser.add_argument("--seconds", type=float, default=60.0, help="processor seconds of each search and rival")
    parser.add_argument("--seeds", type=int, default=10, help="seeds of each family")
    parser.add_argument("--first", type=int, default=0, help="first seed")
    parser.add_argument("--without-rivals", action="store_true")
    parser.add_argument("--out", type=Path, help="CSV that the rows are added to")
    options = parser.parse_args(arguments)
    seeds = range(options.first, options.first + options.seeds)
    table = Table(options.out)
    for family in FAMILIES:
        for seed in seeds if options.only in family.name else ():
            case = family.draw(seed)
            if case is not None:
                row = Row(table=table, instance=family.name, seed=seed, most=case.most)
                compare(row, case, family.longer * options.seconds, rivals=not options.without_rivals)


class Table:
    """Rows that are printed, and added to a CSV file if there is one."""

    titles = ("instance", "seed", "who", "lower", "upper", "open", "seconds")

    def __init__(self, out: Path | None = None) -> None:
        self._out = out
        print(f"{'instance':28} {'seed':>4} {'':>10} {'lower':>12} {'upper':>12} {'open':>8} {'seconds':>8}")
        if out is not None and not out.exists():
            self._write(self.titles)

    def add(self, row: tuple[str, int, str, float, float, float, float]) -> None:
        """Add one row, in the order of ``titles``."""
        instance, seed, who, lower, upper, share, seconds = row
        numbers = f"{lower:12.6g} {upper:12.6g} {share:8.2%} {seconds:8.1f}"
        print(f"{instance:28} {seed:4} {who:>10} {numbers}", flush=True)
        if self._out is not None:
            self._write(row)

    def _write(self, cells: tuple[object, ...]) -> None:
        assert self._out is not None
        with self._out.open("a", encoding="utf-8", newline="") as file:
            csv.writer(file).writerow(cells)


@dataclass(frozen=True, slots=True, kw_only=True)
class Row:
    """Row of the brackets of one instance; ``most`` : of its case."""

    table: Table
    instance: str
    seed: int
    most: float | None

    def show(self, who: str, found: RivalBracket) -> None:
        """Add the bracket of the library or a rival."""
        lower, upper, most = found.lower, found.upper, self.most
        least = upper if most is None else most - lower
        share = (upper - lower) / least if np.isfinite(upper) and least > 0 else np.inf
        if most is not None:
            lower, upper = most - upper, most - lower
        self.table.add((self.instance, self.seed, who, lower, upper, share, found.seconds))


def compare(row: Row, case: Case, seconds: float, *, rivals: bool) -> None:
    """Add the rows of one instance: the library's, then the rivals'."""
    began = time.process_time()
    found = ro.solve_maxmin(case.asked, gap=GAP, time_limit=seconds)
    row.show("solve", RivalBracket(lower=found.lower, upper=found.upper, seconds=_since(began)))
    if case.rivals is not None and rivals:
        began = time.process_time()
        walk = attacked_exchanges if case.cameras else exchanges
        walked = walk(case.rivals, ro.greedy(case.rivals), seconds)
        row.show("exchanges", RivalBracket(lower=walked.lower, upper=np.inf, seconds=_since(began)))
        program = tangent_milp if case.cameras else scenario_bracket
        row.show("HiGHS", program(case.rivals, seconds))


def scenario_bracket(problem: ro.Problem, seconds: float) -> RivalBracket:
    """The bracket of HiGHS's scenario program after its processor seconds."""
    began = time.process_time()
    found = scenario_program(problem, time_limit=seconds)
    return RivalBracket(lower=found.lower, upper=found.claimed_upper, seconds=_since(began))


def _since(began: float) -> float:
    return time.process_time() - began


if __name__ == "__main__":
    main()
