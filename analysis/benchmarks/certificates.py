"""Certificates: the time to write and to verify one against the search it certifies, their size, and what is proved.

Run as ``python -m analysis.benchmarks.certificates [--robots 10 20 30] [--seeds K] [--gap G] [--seconds S]``.
Times are processor time, the worst over the seeds; the ratio is verification over the search, in the same run.
"""

from __future__ import annotations

import argparse
import tempfile
import time
from pathlib import Path
from typing import TYPE_CHECKING

from analysis.benchmarks.attack import SETTINGS, processor_seconds
from analysis.tables import print_table
from ratt_opt._rounding import relative_gap
from ratt_opt.certificates.verifier.verify import verify_certificate
from ratt_opt.certificates.write import certify
from ratt_opt.scenario.generator import random_scenario
from ratt_opt.solvers.maxmin.solve import solve_maxmin

if TYPE_CHECKING:
    from ratt_opt.problem import Problem

KILOBYTE = 1000


def measure(problem: Problem, gap: float, seconds: float, path: Path) -> dict[str, float]:
    """Search, certify and verify once."""
    began = time.process_time()
    optimum = solve_maxmin(problem, gap=gap, time_limit=seconds)
    search = time.process_time() - began
    write = processor_seconds(lambda: certify(problem, optimum, path))
    verified = []
    verify = processor_seconds(lambda: verified.append(verify_certificate(path)))
    return {
        "search [s]": search,
        "write and verify [s]": write,
        "verify [s]": verify,
        "verify / search": verify / search,
        "size [kB]": path.stat().st_size / KILOBYTE,
        "proved gap": relative_gap(verified[0].lower, verified[0].upper),
        "lower end unproved": float(not verified[0].lower_proved),
    }


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--robots", type=int, nargs="+", default=[10, 20, 30], choices=sorted(SETTINGS))
    parser.add_argument("--seeds", type=int, default=3)
    parser.add_argument("--gap", type=float, default=1e-9, help="gap at which each search stops")
    parser.add_argument("--seconds", type=float, default=60.0, help="time limit of each search")
    options = parser.parse_args()
    for n_robots in options.robots:
        rows: list[dict[str, object]] = []
        n_targets, budgets = SETTINGS[n_robots]
        for alpha_s, alpha_c in budgets:
            for objective in ("trace", "logdet", "maxeig"):
                runs = []
                for seed in range(options.seeds):
                    scenario = random_scenario(n_robots, n_targets, alpha_s=alpha_s, alpha_c=alpha_c, seed=seed)
                    with tempfile.TemporaryDirectory() as folder:
                        path = Path(folder) / "certificate.json"
                        runs.append(measure(scenario.problem(objective), options.gap, options.seconds, path))
                worst = {name: max(run[name] for run in runs) for name in runs[0]}
                unproved = int(sum(run["lower end unproved"] for run in runs))
                rows.append(
                    {
                        "budgets": f"{alpha_s}, {alpha_c}",
                        "objective": objective,
                        **worst,
                        "lower end unproved": f"{unproved} of {options.seeds}",
                    }
                )
        said = f"gap {options.gap:g}, worst of {options.seeds} seeds"
        print_table(f"certificates, N = {n_robots}, M = {n_targets}, {said}", rows)


if __name__ == "__main__":
    main()
