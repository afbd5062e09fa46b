"""Choice of robots whose cameras run when only some may: the planners' ideas under a cardinality limit."""

from __future__ import annotations

from itertools import combinations
from typing import TYPE_CHECKING

import numpy as np

from ratt_opt.attack.exact import worst_case_attack
from ratt_opt.budget import uninterrupted
from ratt_opt.errors import InputError
from ratt_opt.solvers.ratt import equivalent_sensing_attacks

if TYPE_CHECKING:
    from collections.abc import Callable

    from ratt_opt._validation import IntArray
    from ratt_opt.problem import Problem

    Chooser = Callable[[Problem, int, int], IntArray]

__all__ = ["CAMERA_PLANNERS", "camera_planner"]

MOST_SETS = 5_000
"""Sets of cameras that are attacked one and all for the max-min choice; each takes some milliseconds."""


def _plan(problem: Problem, running: set[int] | tuple[int, ...]) -> IntArray:
    """Elements of a problem whose robots choose between off (the first element) and on (the second)."""
    return np.array([choice[int(i in running)] for i, choice in enumerate(problem.choices)])


def _grown(problem: Problem, count: int, bait: int) -> IntArray:
    """RATT's choice: the ``bait`` robots worth most alone, then greedily, as long as cameras are left."""
    alone = problem.objective.singletons()[[int(choice[1]) for choice in problem.choices]]
    order = np.argsort(-alone, kind="stable")
    running = [int(i) for i in order[: min(bait, count)]]
    greedy: list[int] = []
    while len(running) + len(greedy) < count:
        rest = [i for i in range(problem.n_robots) if i not in {*running, *greedy}]
        base = np.array(sorted(int(problem.choices[i][1]) for i in greedy), dtype=np.int64)
        values = problem.objective.extensions(base, np.array([int(problem.choices[i][1]) for i in rest]))
        greedy.append(rest[int(np.argmax(values))])
    return _plan(problem, {*running, *greedy})


def _best_worst(problem: Problem, count: int, _seed: int) -> IntArray:
    """The set of cameras whose exact worst case is best; the first of equal ones."""
    sets = list(combinations(range(problem.n_robots), count))
    if len(sets) > MOST_SETS:
        raise InputError("cameras", f"must leave at most {MOST_SETS} sets for the max-min choice", len(sets))
    plans = [_plan(problem, running) for running in sets]
    return plans[int(np.argmax([uninterrupted(worst_case_attack(problem, plan)).lower for plan in plans]))]


def _ratt(problem: Problem, count: int, _seed: int) -> IntArray:
    return _grown(problem, count, problem.alpha_s + equivalent_sensing_attacks(problem))


CAMERA_PLANNERS: dict[str, Chooser] = {
    "ratt": _ratt,
    "maxmin": _best_worst,
    "greedy": lambda problem, count, _seed: _grown(problem, count, 0),
    "myopic": lambda problem, count, _seed: _grown(problem, count, problem.n_robots),
    "random": lambda problem, count, seed: _plan(
        problem, tuple(np.random.default_rng(seed).permutation(problem.n_robots)[:count].tolist())
    ),
}
"""Choosers by name; each is called with a problem of off and on, the number of cameras, and a seed of the step."""


def camera_planner(name: str) -> Chooser:
    """The planner of that name. InputError : there is none."""
    if name not in CAMERA_PLANNERS:
        raise InputError("planner", f"must be {', '.join(CAMERA_PLANNERS)}", name)
    return CAMERA_PLANNERS[name]
