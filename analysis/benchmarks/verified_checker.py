"""``ratt-check``, extracted from its proof, against the Python verifier: the same certificates, processor time of each.

Run as ``python -m analysis.benchmarks.verified_checker [--robots 10 20 30] [--objectives trace logdet maxeig]
[--networks complete small-world limited-view moving] [--budgets 0] [--seeds K] [--seconds S]``. The program is found as
``ratt-opt verify --verified`` finds it. ``moving``: the complete graph, targets that also have a velocity, and their
positions count (trace, max-eigenvalue; up to 12 robots). If the two decide differently the command ends with an error.
"""

from __future__ import annotations

import argparse
import resource
import tempfile
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from analysis.benchmarks.attack import SETTINGS, processor_seconds
from analysis.tables import print_table
from ratt_opt.certificates.extracted import check_extracted
from ratt_opt.certificates.verifier.verify import verify_certificate
from ratt_opt.certificates.write import certify
from ratt_opt.scenario.generator import random_scenario
from ratt_opt.scenario.limited_view import limited_view_scenario
from ratt_opt.scenario.networks import network_scenario
from ratt_opt.setfunctions.criteria.maxeig import MaxEigenvalueObjective
from ratt_opt.setfunctions.criteria.trace import TraceObjective
from ratt_opt.solvers.maxmin.solve import solve_maxmin

if TYPE_CHECKING:
    from ratt_opt.problem import Problem

WITH_OUTPUT = {"trace": TraceObjective, "maxeig": MaxEigenvalueObjective}


def team(network: str, n_robots: int, budget: int, objective: str, seed: int) -> tuple[str, Problem]:
    """Budgets in words, and the problem.

    The paper's (of limited views or with moving targets, too), or a network, budgets N/10 and N/5.
    """
    n_targets, budgets = SETTINGS[n_robots]
    is_complete = network in ("complete", "limited-view", "moving")
    alpha_s, alpha_c = budgets[budget] if is_complete else (n_robots // 10, n_robots // 5)
    if network == "limited-view":
        scenario = limited_view_scenario(n_robots, n_targets, alpha_s=alpha_s, alpha_c=alpha_c, seed=seed)
    elif is_complete:
        scenario = random_scenario(n_robots, n_targets, alpha_s=alpha_s, alpha_c=alpha_c, seed=seed)
    else:
        scenario = network_scenario(network, n_robots, n_targets, alpha_s=alpha_s, alpha_c=alpha_c, seed=seed)
    problem = scenario.problem(objective)
    return f"{alpha_s}, {alpha_c}", moving(problem, objective) if network == "moving" else problem


def moving(problem: Problem, objective: str) -> Problem:
    """The same robots, whose targets move: a second of a velocity that is known to 1 m/s on each axis."""
    f = problem.information_objective
    m, entries, one = len(f.prior), len(f.information), np.eye(2)
    prior = np.broadcast_to(np.block([[one, one], [one, one]]), (m, 4, 4)).copy()
    prior[:, :2, :2] += f.prior
    information = np.zeros((entries, m, 4, 4))
    information[:, :, :2, :2] = f.information
    return replace(problem, objective=WITH_OUTPUT[objective](prior, information, f.weights, output=np.eye(2, 4)))


def children_seconds() -> float:
    """Processor time of all programs run so far [s]."""
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def measure(problem: Problem, seconds: float, path: Path) -> dict[str, object]:
    """Search and certify, then check with both."""
    certify(problem, solve_maxmin(problem, time_limit=seconds), path)
    verified = []
    python = processor_seconds(lambda: verified.append(verify_certificate(path)))
    began = children_seconds()
    extracted = check_extracted(path)
    checked = children_seconds() - began
    if extracted.lower_proved != verified[0].lower_proved:
        raise SystemExit(f"{path}: the checkers disagree: {extracted.text}")
    return {
        "lower end": verified[0].lower_method if verified[0].lower_proved else "not proved",
        "leaves, upper": verified[0].upper_leaves,
        "lower": verified[0].lower_leaves,
        "ratt-check [s]": checked,
        "Python [s]": python,
        "ratio": checked / python,
    }


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--robots", type=int, nargs="+", default=[10, 20, 30], choices=sorted(SETTINGS))
    parser.add_argument("--objectives", nargs="+", default=["trace", "logdet", "maxeig"])
    parser.add_argument("--networks", nargs="+", default=["complete", "small-world"])
    parser.add_argument("--budgets", type=int, nargs="+", default=[0], help="which of the budgets of the setting")
    parser.add_argument("--seeds", type=int, default=1)
    parser.add_argument("--seconds", type=float, default=60.0, help="time limit of each search")
    options = parser.parse_args()
    rows: list[dict[str, object]] = []
    with tempfile.TemporaryDirectory() as folder:
        for network in options.networks:
            for n_robots in options.robots:
                for budget in options.budgets:
                    for objective in options.objectives:
                        for seed in range(options.seeds):
                            budgets, problem = team(network, n_robots, budget, objective, seed)
                            found = measure(problem, options.seconds, Path(folder) / "certificate.json")
                            named = {"links": network, "N": n_robots, "budgets": budgets, "objective": objective}
                            rows.append({**named, "seed": seed, **found})
                            print_table("so far", rows[-1:])
    print_table("the two checkers, processor time", rows)


if __name__ == "__main__":
    main()
