"""Proofs of the worst case of RATT's plan that the exact attacker finds, on the networks that radio teams have.

Run as ``python -m analysis.benchmarks.network_certificates [--best] [--robots 24 30] [--families disk-6 ...]
[--seeds K] [--objective trace] [--seconds S]``. For each team there are three pairs of budgets (a fifth of the robots
and 15 % of the links, a third and 30 %, random ones). A row has the attacker's bracket within the limit and the kind of
proof found for its lower end within as much again. If there is none, it has the largest lower value that is proved
within as much once more. Then come the seconds of the processor for building and checking the proof.

``--best`` certifies best plans instead: whether the search closes within the limit, and if so, whether the certificate
proves both ends, and how far they are apart.
"""

from __future__ import annotations

import argparse
import json
import time
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING, Any

from flint import fmpq

import ratt_opt as ro
from analysis.benchmarks.networks import GAP, instances
from analysis.tables import print_table
from ratt_opt._rounding import relative_gap
from ratt_opt.attack.exact import worst_case_attack
from ratt_opt.budget import Stop
from ratt_opt.certificates.lower import ENUMERATED, lower_proof, weaker_lower_proof
from ratt_opt.certificates.verifier.lower import check_lower
from ratt_opt.certificates.verifier.statement import Statement
from ratt_opt.certificates.verifier.work import limited
from ratt_opt.certificates.write import problem_document
from ratt_opt.scenario.networks import NETWORK_FAMILIES
from ratt_opt.solvers.ratt import ratt

if TYPE_CHECKING:
    from ratt_opt.problem import Problem

BUILT, CHECKED = 1e-11, 2e-11
"""Relative amounts by which the lower bounds built and proved are below the attacker's."""


def measured(problem: Problem, seconds: float) -> dict[str, object]:
    """The bracket of RATT's plan, the proof of its lower end, and what they cost."""
    plan = ratt(problem).elements
    began = time.process_time()
    found = worst_case_attack(problem, plan, time_limit=seconds)
    attacked = time.process_time()
    threshold = found.lower * (1 - BUILT)
    with limited(seconds):
        part: dict[str, Any] = lower_proof(problem, plan, threshold)
    if part is ENUMERATED:
        with limited(seconds):
            threshold, part = weaker_lower_proof(problem, plan, threshold)
    built = time.process_time()
    if part is not ENUMERATED:
        about = Statement(problem_document(problem), plan.tolist(), [])
        check_lower(about, part, fmpq(*(threshold * (1 - CHECKED)).as_integer_ratio()))
    row: dict[str, object] = {"alpha_s": problem.alpha_s, "alpha_c": problem.alpha_c}
    row |= {"gap": relative_gap(found.lower, found.upper), "proof": part["conclusion"]}
    row["below"] = 1 - threshold / found.lower if part is not ENUMERATED else 1.0
    row |= {"nodes": len(part.get("tree", ())), "kB": len(json.dumps(part)) / 1000}
    spent = {"attack [s]": attacked - began, "build [s]": built - attacked, "check [s]": time.process_time() - built}
    return row | spent


def certified(problem: Problem, seconds: float) -> dict[str, object]:
    """The best plan's bracket, and what its certificate proves if it is closed."""
    began = time.perf_counter()
    best = ro.solve_maxmin(problem, gap=GAP, time_limit=seconds)
    row: dict[str, object] = {"alpha_s": problem.alpha_s, "alpha_c": problem.alpha_c}
    row |= {"gap": relative_gap(best.lower, best.upper), "search [s]": time.perf_counter() - began}
    if best.stop not in (Stop.CLOSED, Stop.EXHAUSTED, Stop.GAP):
        return row
    began = time.perf_counter()
    with TemporaryDirectory() as folder:
        written = ro.certify(problem, best, Path(folder) / "certificate.json")
    row |= {"both ends": written.verified.lower_proved, "certificate [s]": time.perf_counter() - began}
    return row | {
        "proved gap": relative_gap(written.verified.lower, written.verified.upper),
        "kB": written.size / 1000,
    }


def main() -> None:
    """Print a row as soon as it is known, then the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--robots", type=int, nargs="*", default=[24, 30])
    parser.add_argument("--families", nargs="*", default=list(NETWORK_FAMILIES), choices=list(NETWORK_FAMILIES))
    parser.add_argument("--best", action="store_true", help="certify best plans")
    parser.add_argument("--objective", default="trace", choices=["trace", "logdet", "maxeig"])
    parser.add_argument("--seeds", type=int, default=1)
    parser.add_argument("--seconds", type=float, default=60.0, help="time limit of one attack, and of one proof")
    options = parser.parse_args()
    rows: list[dict[str, object]] = []
    what = certified if options.best else measured
    drawn = instances(options.robots, options.families, range(options.seeds), options.objective)
    for n_robots, family, seed, problem in drawn:
        row = {"robots": n_robots, "family": family, "seed": seed} | what(problem, options.seconds)
        rows.append(row)
        print(row, flush=True)
    print_table("Certificates of best plans" if options.best else "Proofs of worst cases on networks", rows)


if __name__ == "__main__":
    main()
