"""The exact attacker on the networks that radio teams have, against plain annealing given the same seconds.

Run as ``python -m analysis.benchmarks.networks [--robots 24 30 50 100] [--families dense ...] [--seeds K] [--seconds S]
[--plain-seconds P] [--objective trace] [--earlier TREE] [--log FILE]``. Each team is RATT's plan under three pairs of
budgets: a fifth of the robots and 15 % of the links, a third and 30 %, and random ones. ``--earlier`` attacks the same
plans with the edition in another source tree, too. Limits are wall time; processor time is what a busy machine gave.
"""

from __future__ import annotations

import argparse
import time
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numba
import numpy as np

from analysis.benchmarks.earlier_edition import earlier_attack
from analysis.tables import append_csv, print_table
from ratt_opt._rounding import relative_gap
from ratt_opt.attackers.by_prices.groups.compiled import gather
from ratt_opt.attackers.by_prices.team import Links, PricedTeam
from ratt_opt.attackers.exact import worst_case_attack
from ratt_opt.problem import Attack
from ratt_opt.scenario.networks import NETWORK_FAMILIES, network_scenario
from ratt_opt.solvers.ratt import ratt

if TYPE_CHECKING:
    from collections.abc import Iterator

    from ratt_opt._validation import IntArray
    from ratt_opt.problem import Problem

TARGETS = {24: 25, 30: 25, 50: 30, 100: 100}
SHARES = ((0.2, 0.15), (1 / 3, 0.3), None)
"""Of the robots blinded and of the links cut; ``None`` draws both up to twice a third of them."""

HOT, COLD, MOVES = 0.02, 0.0002, 200_000
"""Temperatures relative to the team's value, and moves of one cooling of plain annealing."""


@numba.njit(cache=True)
def _cool(team: Any, links: Any, group: Any, blind: Any, budget: int, heat: Any, rng: Any) -> float:  # noqa: PLR0917
    """One cooling of plain annealing: the largest group's value, links within ``budget``; best state in place."""
    n_robots, sums = len(group), np.empty_like(team.prior)
    best, best_group, best_blind = np.inf, group.copy(), blind.copy()
    values, cut = np.zeros(n_robots), 0
    for g in range(n_robots):
        values[g] = gather(team, (group == g) & ~blind, sums)
    energy = values.max()
    for move in range(MOVES):
        i, j = int(rng.random() * n_robots), int(rng.random() * n_robots)
        home, target, change, blinds = group[i], group[j], 0, rng.random() < 0.5
        if blinds and (blind[i] or not blind[j] or links.seeing[i]):
            continue
        if blinds:
            blind[i], blind[j] = True, False
        else:
            if rng.random() < 0.1:  # a group of its own
                target = int(rng.random() * n_robots)
            for a in range(links.start[i], links.start[i + 1]):
                other = group[links.robot[a]]
                change += (other == home) * 1 - (other == target) * 1
            if target == home or cut + change > budget:
                continue
            group[i] = target
        old = values[home], values[target]
        values[home] = gather(team, (group == home) & ~blind, sums)
        values[target] = gather(team, (group == target) & ~blind, sums)
        after, temperature = values.max(), heat[0] * (heat[1] / heat[0]) ** (move / MOVES)
        if after <= energy or rng.random() < np.exp((energy - after) / temperature):
            energy, cut = after, cut + change
            if energy < best:
                best, best_group[:], best_blind[:] = energy, group, blind
            continue
        values[home], values[target] = old
        if blinds:
            blind[i], blind[j] = False, True
        else:
            group[i] = home
    group[:], blind[:] = best_group, best_blind
    return float(best)


def plain_annealing(problem: Problem, plan: IntArray, seconds: float, seed: int) -> float:
    """Worst value that annealing from the whole team finds, cooled again and again for so many seconds."""
    team, links, rng = PricedTeam.of(problem.objective, plan), Links.of(problem.threat), np.random.default_rng(seed)
    assert team is not None
    n_robots, whole, best = problem.n_robots, problem.objective(plan), np.inf
    heat, began = np.array([HOT, COLD]) * whole, time.perf_counter()
    while time.perf_counter() - began < seconds:
        group, blind = np.zeros(n_robots, dtype=np.int64), np.zeros(n_robots, dtype=np.bool_)
        blind[rng.permutation(np.flatnonzero(~links.seeing))[: problem.threat.n_blinded]] = True
        _cool(team, links, group, blind, problem.alpha_c, heat, rng)
        cut = frozenset((i, j) for i, j in problem.communication.links if group[i] != group[j])
        best = min(best, problem.team_value(plan, Attack(frozenset(np.flatnonzero(blind).tolist()), cut)))
    return best


def instances(robots: list[int], families: list[str], seeds: int, objective: str) -> Iterator[tuple[Any, ...]]:
    """Yield (robots, family, seed, problem)."""
    for n_robots in robots:
        for family in families:
            for seed in range(seeds):
                for shares in SHARES:
                    rng = np.random.default_rng([n_robots, seed])
                    alpha_s, alpha_c = shares or rng.uniform(0, 2 / 3, 2).tolist()
                    options: dict[str, Any] = {"alpha_s": float(alpha_s), "alpha_c": float(alpha_c), "seed": seed}
                    scenario = network_scenario(family, n_robots, TARGETS[n_robots], **options)
                    yield n_robots, family, seed, scenario.problem(objective)


def attacked(problem: Problem, seed: int, options: argparse.Namespace) -> dict[str, object]:
    """The exact attacker's bracket, what plain annealing finds, and the bracket of an earlier edition where asked."""
    plan = ratt(problem).elements
    began, worked = time.perf_counter(), time.process_time()
    exact = worst_case_attack(problem, plan, time_limit=options.seconds)
    spent, worked = time.perf_counter() - began, time.process_time() - worked
    row: dict[str, object] = {"alpha_s": problem.alpha_s, "alpha_c": problem.alpha_c}
    row |= {"lower": exact.lower, "upper": exact.upper, "gap": relative_gap(exact.lower, exact.upper)}
    row |= {"stop": exact.stop.value, "nodes": exact.nodes, "seconds": spent, "processor_seconds": worked}
    plain = options.seconds if options.plain_seconds is None else options.plain_seconds
    if plain > 0:
        row["plain_over_exact"] = plain_annealing(problem, plan, plain, seed) / exact.upper
    if options.earlier is not None:
        earlier = earlier_attack(options.earlier, problem, plan, options.objective, options.seconds)
        row |= {f"earlier_{name}": value for name, value in earlier.items()}
    return row


def main() -> None:
    """Print the table; every row is appended to the log as it ends."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--robots", type=int, nargs="*", default=[24, 30], choices=sorted(TARGETS))
    parser.add_argument("--families", nargs="*", default=list(NETWORK_FAMILIES), choices=list(NETWORK_FAMILIES))
    parser.add_argument("--seeds", type=int, default=5)
    parser.add_argument("--seconds", type=float, default=60.0, help="time limit of one attack")
    parser.add_argument("--plain-seconds", type=float, help="of plain annealing; as the attack's where absent")
    parser.add_argument("--earlier", type=Path, help="source tree of an earlier edition to attack the same plans with")
    parser.add_argument("--objective", default="trace", choices=("trace", "logdet", "maxeig"))
    parser.add_argument("--log", type=Path, help="CSV file to which every attack is appended as it ends")
    options = parser.parse_args()
    rows: list[dict[str, object]] = []
    for n_robots, family, seed, problem in instances(
        options.robots, options.families, options.seeds, options.objective
    ):
        row = {"robots": n_robots, "family": family, "seed": seed} | attacked(problem, seed, options)
        rows.append(row)
        if options.log is not None:
            append_csv(options.log, row)
    print_table("Exact attacks on networks, and plain annealing in the same seconds", rows)


if __name__ == "__main__":
    main()
