"""Attacks and max-min searches at any budget: which of 64 budgets close in time on complete graphs, and what is left.

Run as ``python -m analysis.benchmarks.budgets [attack maxmin] [--robots 10 20 30] [--objectives trace logdet maxeig]
[--draw grid random] [--seconds S] [--processor] [--patience S] [--every K] [--seed S] [--log FILE] [--details]``.
``grid`` takes ``alpha_s`` from 0 to N - 2 and ``alpha_c`` from 5 % to 95 % of the links, in 8 steps each; ``random``
draws 64 budgets. Every case is one call with a time limit, in a process of its own, which is ended if the call does
not come back within ``--patience`` seconds after its limit. Uses public names only, to measure any edition with.
"""

from __future__ import annotations

import argparse
import time
from dataclasses import asdict, dataclass
from multiprocessing import get_context
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

import ratt_opt as ro
from analysis.benchmarks.timing import count_processor_time
from analysis.tables import append_csv, print_table

if TYPE_CHECKING:
    from collections.abc import Iterator
    from multiprocessing.connection import Connection

    from ratt_opt import Problem

TARGETS = {10: 15, 20: 20, 30: 25, 60: 40, 100: 100}
"""Robots -> targets."""
STEPS = 8
CLOSED = {"attack": 1e-6, "maxmin": 1e-4}
"""Relative width that counts as closed."""
GAP = 5e-5
"""Names a max-min search."""
BUSY = 10
"""Wall seconds that a processor second may take on a busy machine before a call counts as lost."""
SMALL = 13
"""Robots of the problems that a new process solves first, not counted: modules are loaded then."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Case:
    """One call to measure."""

    what: str
    draw: str
    robots: int
    alpha_s: int
    alpha_c: int
    objective: str
    seed: int

    def problem(self) -> Problem:
        """The problem of a random scenario."""
        n_targets = TARGETS.get(self.robots, 5)
        seed, cut = self.seed, self.alpha_c
        scenario = ro.random_scenario(self.robots, n_targets, alpha_s=self.alpha_s, alpha_c=cut, seed=seed)
        return scenario.problem(self.objective)


def budgets(draw: str, robots: int, seed: int) -> list[tuple[int, int]]:
    """64 pairs (alpha_s, alpha_c)."""
    links = robots * (robots - 1) // 2
    if draw == "random":
        rng = np.random.default_rng([seed, robots])
        pairs = zip(rng.integers(0, robots - 1, STEPS**2), rng.integers(0, links + 1, STEPS**2), strict=True)
        return [(int(blinded), int(cut)) for blinded, cut in pairs]
    return budget_grid(robots, STEPS)


def budget_grid(robots: int, steps: int) -> list[tuple[int, int]]:
    """``steps`` numbers of blinded robots, from none to all but two, by ``steps`` of cut links, from 5 to 95 %."""
    links = robots * (robots - 1) // 2
    blinded = np.round(np.linspace(0, robots - 2, steps)).astype(int).tolist()
    cut = np.round(np.linspace(0.05, 0.95, steps) * links).astype(int).tolist()
    return [(one, other) for one in blinded for other in cut]


def prepare(case: Case) -> tuple[Problem, Any]:
    """Return the inputs made before the clock starts: the problem, and RATT's plan if that is attacked."""
    problem = case.problem()
    return problem, ro.ratt(problem).elements if case.what == "attack" else None


def measure(problem: Problem, plan: Any, seconds: float) -> dict[str, Any]:
    """Bracket, wall and processor time of one call: an attack on the plan, or a max-min search if there is none."""
    began, spent = time.monotonic(), time.process_time()
    if plan is not None:
        attack = ro.worst_case_attack(problem, plan, time_limit=seconds)
        lower, upper, stop = attack.lower, attack.upper, attack.stop
    else:
        found = ro.solve_maxmin(problem, gap=GAP, time_limit=seconds)
        lower, upper, stop = found.lower, found.upper, found.stop
    times = {"seconds": time.monotonic() - began, "processor": time.process_time() - spent}
    return times | {"lower": lower, "upper": upper, "stop": stop.value}


def work(connection: Connection, seconds: float, processor: bool) -> None:
    """Measure the cases that come through ``connection``, after some that do not count."""
    if processor:
        count_processor_time()
    for name in ("trace", "logdet", "maxeig"):
        for what, cut in (("attack", 40), ("attack", 50), ("attack", 60), ("maxmin", 40)):
            small = Case(what=what, draw="", robots=SMALL, alpha_s=1, alpha_c=cut, objective=name, seed=0)
            measure(*prepare(small), min(seconds, 2.0))
    connection.send(None)
    while True:
        prepared = prepare(connection.recv())
        connection.send(None)  # the clock of the call starts about here
        connection.send(measure(*prepared, seconds))


class Worker:
    """A process that measures cases, replaced by a new one if a call does not come back."""

    def __init__(self, seconds: float, patience: float, *, processor: bool) -> None:
        self.seconds, self.processor = seconds, processor
        self.patience = (BUSY * (seconds + patience) if processor else seconds + patience) - seconds
        self._start()

    def _start(self) -> None:
        context = get_context("spawn")
        self.connection, other = context.Pipe()
        self.process = context.Process(target=work, args=(other, self.seconds, self.processor), daemon=True)
        self.process.start()
        self.connection.recv()

    def measure(self, case: Case) -> dict[str, Any]:
        """The measurement, or one that says that the call did not come back."""
        self.connection.send(case)
        self.connection.recv()
        if self.connection.poll(self.seconds + self.patience):
            return dict(self.connection.recv())
        self.stop()
        self._start()
        lost = {"lower": 0.0, "upper": np.inf, "stop": "did not come back"}
        return {"seconds": self.seconds + self.patience, "processor": np.nan, **lost}

    def stop(self) -> None:
        """End the process."""
        self.process.kill()
        self.process.join()


def run(cases: Iterator[Case], options: argparse.Namespace) -> list[dict[str, Any]]:
    """Measure every case; each is appended to the log as it ends."""
    worker, rows = Worker(options.seconds, options.patience, processor=options.processor), []
    for case in cases:
        row = asdict(case) | worker.measure(case)
        width = (row["upper"] - row["lower"]) / max(abs(row["upper"]), 1e-300) if np.isfinite(row["upper"]) else 1.0
        row |= {"gap": float(width), "open": bool(width > CLOSED[case.what])}
        row |= {"overrun": max(row["seconds"] - options.seconds, 0.0), "empty": bool(row["lower"] <= 0 < row["upper"])}
        rows.append(row)
        if options.log is not None:
            append_csv(options.log, row)
    worker.stop()
    return rows


def summary(rows: list[dict[str, Any]]) -> list[dict[str, object]]:
    """One line for each team size, objective and draw."""
    keys = ("what", "robots", "objective", "draw")
    lines = []
    for key in dict.fromkeys(tuple(row[k] for k in keys) for row in rows):
        own = [row for row in rows if tuple(row[k] for k in keys) == key]
        line: dict[str, object] = dict(zip(keys, key, strict=True))
        line |= {"budgets": len(own), "open": sum(row["open"] for row in own)}
        line |= {"over_1_%": sum(row["gap"] > 0.01 for row in own), "empty": sum(row["empty"] for row in own)}
        line |= {"worst_gap": max(row["gap"] for row in own), "worst_s": max(row["seconds"] for row in own)}
        lines.append(line | {"median_s": float(np.median([row["seconds"] for row in own]))})
    return lines


def _cases(options: argparse.Namespace) -> Iterator[Case]:
    for what in options.what:
        for robots in options.robots:
            for objective in options.objectives:
                for draw in options.draw:
                    for alpha_s, alpha_c in budgets(draw, robots, options.seed)[:: options.every]:
                        shared = {"robots": robots, "objective": objective, "draw": draw, "seed": options.seed}
                        yield Case(what=what, alpha_s=alpha_s, alpha_c=alpha_c, **shared)


def _options() -> argparse.Namespace:
    parser = argparse.ArgumentParser(description=__doc__)
    names = ("trace", "logdet", "maxeig")
    parser.add_argument("what", nargs="*", default=list(CLOSED), help="attack, maxmin")
    parser.add_argument("--robots", type=int, nargs="*", default=[10, 20, 30], choices=sorted(TARGETS))
    parser.add_argument("--objectives", nargs="*", default=names, choices=names)
    parser.add_argument("--draw", nargs="*", default=("grid", "random"), choices=("grid", "random"))
    parser.add_argument("--seconds", type=float, default=5.0, help="time limit of one call")
    parser.add_argument("--processor", action="store_true", help="count seconds of the processor, on a busy machine")
    parser.add_argument("--patience", type=float, default=15.0, help="seconds after the limit to wait for a call")
    parser.add_argument("--every", type=int, default=1, help="take every K-th budget only")
    parser.add_argument("--seed", type=int, default=0, help="of the scenarios and the random budgets")
    parser.add_argument("--log", type=Path, help="CSV file to which every case is appended as it ends")
    parser.add_argument("--details", action="store_true", help="print every case that is open, empty or late")
    return parser.parse_args()


def main() -> None:
    """Print the tables."""
    options = _options()
    rows = run(_cases(options), options)
    print_table(f"Any budget, limit {options.seconds:g} s", summary(rows))
    late = 0.5 + 0.05 * options.seconds
    bad = [row for row in rows if row["open"] or row["empty"] or row["overrun"] > late]
    if options.details and bad:
        print_table("Open, empty or late", bad)


if __name__ == "__main__":
    main()
