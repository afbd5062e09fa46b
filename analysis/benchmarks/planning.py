"""Planning speed: ``python -m analysis.benchmarks.planning``.

RATT at N = 30, M = 25, 12 controls against Algorithm 1 with one evaluation at a time;
exhaustive OPT at N = M = 4 for the paper's budgets against the definition (every plan,
every sensing subset, every link subset; timed on a sample of plans and scaled up);
``ratt-opt demo`` and ``import ratt_opt`` as whole processes.
"""

from __future__ import annotations

import itertools
import subprocess
import sys
import tempfile
import time
from typing import TYPE_CHECKING

import numpy as np

from analysis.benchmarks.timing import best_seconds
from ratt_opt import Attack, exhaustive_optimum, random_scenario, ratt

if TYPE_CHECKING:
    from ratt_opt import Problem

SMALL_BUDGETS = ((1, 3), (1, 4), (2, 3), (2, 4))
SAMPLE = 40
"""Plans on which the definition is timed."""


def main() -> None:
    """Print the table."""
    print(f"{'what':44} {'seconds':>10} {'plain':>12} {'ratio':>10}")
    for alpha_s, alpha_c in ((10, 108), (0, 0)):
        problem = random_scenario(30, 25, alpha_s=alpha_s, alpha_c=alpha_c, seed=0).problem()
        fast = best_seconds(lambda p=problem: ratt(p))  # type: ignore[misc]
        plain = best_seconds(lambda p=problem: plain_ratt(p), repeats=1)  # type: ignore[misc]
        _row(f"RATT N=30 M=25 ({alpha_s}, {alpha_c})", fast, plain)
    for alpha_s, alpha_c in SMALL_BUDGETS:
        problem = random_scenario(4, 4, alpha_s=alpha_s, alpha_c=alpha_c, seed=0).problem()
        fast = best_seconds(lambda p=problem: exhaustive_optimum(p), repeats=3)  # type: ignore[misc]
        _row(f"exhaustive OPT N=M=4 ({alpha_s}, {alpha_c})", fast, definition_seconds(problem))
    _row("import ratt_opt (whole process)", _process("-c", "import ratt_opt"), _process("-c", "pass"))
    with tempfile.TemporaryDirectory() as folder:
        demo = _process("-m", "ratt_opt", "demo", "--out", folder)
    _row("ratt-opt demo (whole process)", demo, _process("-c", "pass"))


def plain_ratt(problem: Problem) -> list[int]:
    """Algorithm 1 with one evaluation of the set function at a time."""
    f, n = problem.objective, problem.n_robots
    plan = ratt(problem)
    single = {e: f([e]) for e in range(f.n)}
    elements = {i: max(problem.choices[i].tolist(), key=single.__getitem__) for i in range(n)}
    chosen: list[int] = []
    left = [i for i in range(n) if i not in plan.bait]
    while left:
        candidates = [int(e) for i in left for e in problem.choices[i]]
        values = {e: f([*chosen, e]) for e in candidates}
        pick = max(candidates, key=values.__getitem__)
        owner = int(problem.robot[pick])
        elements[owner] = pick
        chosen.append(pick)
        left.remove(owner)
    return [elements[i] for i in range(n)]


def definition_seconds(problem: Problem) -> float:
    """Seconds that the definition would take over all plans, from a sample of them."""
    n, links = problem.n_robots, sorted(problem.communication.links)
    attacks = [
        Attack(frozenset(blinded), frozenset(cut))
        for blinded in itertools.combinations(range(n), problem.alpha_s)
        for cut in itertools.combinations(links, problem.alpha_c)
    ]
    rng = np.random.default_rng(0)
    began = time.perf_counter()
    for _ in range(SAMPLE):
        plan = [int(rng.choice(choice)) for choice in problem.choices]
        min(problem.team_value(plan, attack) for attack in attacks)
    plans = float(np.prod([len(choice) for choice in problem.choices]))
    return (time.perf_counter() - began) / SAMPLE * plans


def _process(*arguments: str) -> float:
    command = [sys.executable, *arguments]
    return best_seconds(lambda: subprocess.run(command, check=True, capture_output=True), repeats=3)


def _row(name: str, fast: float, plain: float) -> None:
    print(f"{name:44} {fast:10.4g} {plain:12.4g} {plain / fast:9.1f}x", flush=True)


if __name__ == "__main__":
    main()
