"""Exchanges by messages against those with a centre: ``python -m analysis.decentralised.exchanges --teams 20``.

Connected teams of ten cameras; each plan is attacked exactly. Printed is a row a range of links.
"""

from __future__ import annotations

import argparse
from itertools import count
from typing import TYPE_CHECKING

import numpy as np

from analysis.decentralised.radio import with_cuts
from ratt_opt.attack.exact import worst_case_attack
from ratt_opt.decentralised.plan import decentralised_ratt, decentralised_refined
from ratt_opt.scenario.limited_view import limited_view_scenario
from ratt_opt.solvers.refined import refined

if TYPE_CHECKING:
    from collections.abc import Iterator

    from ratt_opt.problem import Problem

__all__ = ["compared", "connected_cameras", "table"]

ROBOTS, TARGETS, BLINDED, CUTS, RANGES = 10, 8, 2, 3, (30, 45)
COSTED = 4
"""Teams whose messages are counted: the first ones."""


def connected_cameras(reach: float) -> Iterator[Problem]:
    """Teams of ten cameras of 60 degrees in a square of 60 m, whose network is connected, from seed 0 on."""
    for seed in count():
        scenario = limited_view_scenario(
            ROBOTS, TARGETS, alpha_s=BLINDED, alpha_c=0, seed=seed, communication_range=reach
        )
        problem = with_cuts(scenario.problem(), CUTS)
        if len(problem.communication.groups()) == 1:
            yield problem


def compared(problem: Problem) -> tuple[float, ...]:
    """RATT and exchanges by messages, as shares of what exchanges with a centre keep [1]; exchanges; costs of both."""
    plans = decentralised_ratt(problem), decentralised_refined(problem)
    central = refined(problem, time_limit=None, max_kicks=200)
    shares = (worst_case_attack(problem, plan.elements).lower / central.upper for plan in plans)
    costs = (cost for plan in plans for cost in (plan.messages, plan.bytes / 1e3, plan.decision_time))
    return (*shares, sum(plans[1].exchanges), *costs)


def table(teams: int) -> list[str]:
    """Rows of a Markdown table."""
    lines = [
        "| links within | RATT | with exchanges | least | exchanges | RATT: messages, kB, seconds | with exchanges |",
        "| --- | --- | --- | --- | --- | --- | --- |",
    ]
    for reach in RANGES:
        found = connected_cameras(reach)
        rows = np.array([compared(next(found)) for _ in range(teams)])
        mean, least, cost = rows.mean(axis=0), rows.min(axis=0), rows[:COSTED].mean(axis=0)
        shares = f"{100 * mean[0]:.2f} % | {100 * mean[1]:.2f} % | {100 * least[1]:.2f} % | {mean[2]:.1f}"
        costs = " | ".join(f"{cost[k]:,.0f}, {cost[k + 1]:.0f}, {cost[k + 2]:.2f}" for k in (3, 6))
        lines.append(f"| {reach} m | {shares} | {costs} |")
    return lines


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description="Exchanges by messages against those with a centre")
    parser.add_argument("--teams", type=int, default=20, help="teams of each range of links")
    print("\n".join(table(parser.parse_args().teams)))


if __name__ == "__main__":
    main()
