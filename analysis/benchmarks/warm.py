"""Warm starts: a scenario that moves step by step, planned anew cold and from the plan before.

Run as ``python -m analysis.benchmarks.warm [--robots 10 20] [--objectives ...] [--steps 50] [--gap G] [--seed S]``;
with ``--leaves`` it says what proofs of the step before still prove. Robots carry out the best plan of each step and
targets move as their motion says; what is believed of the targets stays the same.
"""

from __future__ import annotations

import argparse
from time import process_time
from typing import TYPE_CHECKING, Any

import numpy as np

from analysis.tables import print_table
from ratt_opt import random_scenario, solve_maxmin
from ratt_opt.bounds.cuts import combined_bound, tangent_cut
from ratt_opt.budget import Budget
from ratt_opt.solvers.maxmin.elements import with_choice
from ratt_opt.solvers.maxmin.proof import ElementBranch, Leaf, WinnerBranch
from ratt_opt.solvers.maxmin.solve import proved_by_tangents

if TYPE_CHECKING:
    from ratt_opt import MaxMinResult, Problem, Scenario
    from ratt_opt._validation import FloatArray, IntArray
    from ratt_opt.solvers.maxmin.proof import UpperProof

BUDGETS = {10: (3, 11), 20: (6, 47)}
TARGETS = {10: 15, 20: 20}


def moved(scenario: Scenario, plan: IntArray) -> Scenario:
    """The scenario one period later, each robot having carried out its element of the plan."""
    poses = scenario.predicted_poses[plan]
    robots = [
        robot.replace(x=float(x), y=float(y), heading=float(np.arctan2(np.sin(angle), np.cos(angle))))
        for robot, (x, y, angle) in zip(scenario.robots, poses.tolist(), strict=True)
    ]
    targets = [
        target.replace(x=float(x), y=float(y), heading=target.heading + scenario.sampling_period * target.turn_rate)
        for target, (x, y) in zip(scenario.targets, scenario.predicted_targets.tolist(), strict=True)
    ]
    return scenario.replace(robots=tuple(robots), targets=tuple(targets))


def timed(problem: Problem, gap: float, start: MaxMinResult | None) -> tuple[MaxMinResult, float]:
    """A result and its processor seconds."""
    began = process_time()
    result = solve_maxmin(problem, gap=gap, start=start)
    return result, process_time() - began


def measure(scenario: Scenario, name: str, steps: int, gap: float) -> dict[str, Any]:
    """Medians over the steps, of seconds and of the speed-up of each step."""
    before = solve_maxmin(scenario.problem(name), gap=gap)
    seconds, nodes, worst = [], [], 0.0
    for _ in range(steps):
        scenario = moved(scenario, before.elements)
        problem = scenario.problem(name)
        (cold, slow), (warm, fast) = (timed(problem, gap, start) for start in (None, before))
        seconds.append((slow, fast))
        nodes.append((cold.nodes, warm.nodes))
        worst = max(worst, warm.lower - cold.upper, cold.lower - warm.upper)
        before = warm
    times = np.array(seconds)
    row: dict[str, Any] = {f"{kind}_s": float(np.median(times[:, k])) for k, kind in enumerate(("cold", "warm"))}
    row |= {"speedup": float(np.median(times[:, 0] / times[:, 1]))}
    row |= {f"{kind}_nodes": int(np.sum(nodes, axis=0)[k]) for k, kind in enumerate(("cold", "warm"))}
    return row | {"brackets_apart": worst}


def leaves_that_close(problem: Problem, proof: UpperProof, level: float, gap: float) -> FloatArray:
    """Return the excess of each leaf of an earlier proof, relative to ``level``: if at most ``gap``, it closes.

    The cuts touch where they did, and leaves keep their weights.
    """
    cuts = [tangent_cut(problem, cut.group, cut.point, cut.target) for cut in proof.cuts]
    constants, scores = np.array([cut.constant for cut in cuts]), np.array([cut.scores for cut in cuts])
    places, bounds = [problem.choices], []
    for node in proof.tree:
        choices = places.pop()
        if isinstance(node, Leaf):
            used = list(node.cuts)
            bounds.append(combined_bound(constants[used], scores[used], np.array(node.weights), choices)[0])
        elif isinstance(node, ElementBranch):
            places += [with_choice(choices, node.robot, np.array(part)) for part in reversed(node.parts)]
        else:
            assert isinstance(node, WinnerBranch)  # robots see every target: no covers
            places += [choices] * len(node.parts)
    return (np.array(bounds) - level) / abs(level) - gap


def _solved(problem: Problem, gap: float) -> MaxMinResult:
    """The best plan, its upper end proved by tangents."""
    return proved_by_tangents(problem, solve_maxmin(problem, gap=gap), Budget())


def measure_leaves(scenario: Scenario, name: str, steps: int, gap: float) -> list[dict[str, Any]]:
    """Measure what the proof of each step still proves of the next one."""
    before, rows = _solved(scenario.problem(name), gap), []
    for step in range(steps):
        earlier = scenario.problem(name)
        scenario = moved(scenario, before.elements)
        found = _solved(scenario.problem(name), gap)
        if before.proof is not None:
            spare = -leaves_that_close(earlier, before.proof, before.lower, gap)
            missing = leaves_that_close(scenario.problem(name), before.proof, found.lower, gap)
            rows.append(
                {
                    "step": step,
                    "leaves": len(missing),
                    "close": float(np.mean(missing <= 0)),
                    "median_spare": float(np.median(spare)),
                    "median_missing": float(np.median(missing)),
                    "robots_changed": int((found.elements != before.elements).sum()),
                    "nodes": found.nodes,
                }
            )
        before = found
    return rows


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--robots", type=int, nargs="*", default=sorted(BUDGETS), choices=sorted(BUDGETS))
    parser.add_argument("--objectives", nargs="*", default=["trace", "logdet", "maxeig"])
    parser.add_argument("--steps", type=int, default=50)
    parser.add_argument("--gap", type=float, default=1e-6)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--leaves", action="store_true", help="what earlier proofs still prove, in place of times")
    options = parser.parse_args()
    rows: list[dict[str, object]] = []
    for robots in options.robots:
        alpha_s, alpha_c = BUDGETS[robots]
        for name in options.objectives:
            scenario = random_scenario(robots, TARGETS[robots], alpha_s=alpha_s, alpha_c=alpha_c, seed=options.seed)
            if options.leaves:
                title = f"What proofs of the step before still prove: {robots} robots, {name}"
                print_table(title, measure_leaves(scenario, name, options.steps, options.gap))
                continue
            rows.append({"robots": robots, "objective": name} | measure(scenario, name, options.steps, options.gap))
    if rows:
        print_table(f"Steps of a moving team, medians over {options.steps}", rows)


if __name__ == "__main__":
    main()
