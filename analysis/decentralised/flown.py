"""Missions planned by messages: ``python -m analysis.decentralised.flown --trials 12 --out DIR``.

Eight cameras in a disk network track six targets; the adversary finds the worst attack anew in every step. Robots go
on with what they measured and heard. Printed are mean errors, and their differences to those without messages.
"""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import TYPE_CHECKING

from analysis.decentralised.radio import LONG
from ratt_opt.scenario.limited_view import limited_view_scenario
from ratt_opt.studies.missions import mission_study

if TYPE_CHECKING:
    from ratt_opt.scenario.model import Scenario

__all__ = ["PLANNERS", "table", "team"]

PLANNERS = ("myopic", "sequential_greedy", "resource_aware_greedy", "decentralised", "decentralised_refined", "refined")
STEPS = 12


def team(seed: int) -> Scenario:
    """Eight cameras of 60 degrees in a square of 60 m, linked within 45 m; two blinded robots, two cut links."""
    return limited_view_scenario(8, 6, alpha_s=2, alpha_c=2, seed=seed, communication_range=LONG)


def table(trials: int, folder: Path | None) -> list[str]:
    """Rows of a Markdown table."""
    found = mission_study(
        team,
        planners=PLANNERS,
        steps=STEPS,
        trials=trials,
        metrics=("rmse", "largest"),
        sharing="all surviving",
        folder=folder,
        workers=1,
        name="flown",
    )
    lines = ["| planner | RMSE [m] | less that of myopic [m] | largest error [m] |", "| --- | --- | --- | --- |"]
    mean = {(one.metric, one.planner): one.estimate.text() for one in found.means()}
    less = {one.planner: one.estimate.text() for one in found.means(metric="rmse", minus=PLANNERS[0])}
    for name in PLANNERS:
        lines.append(f"| {name} | {mean['rmse', name]} | {less.get(name, '')} | {mean['largest', name]} |")
    return lines


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description="Missions planned by messages")
    parser.add_argument("--trials", type=int, default=12, help="missions of each planner")
    parser.add_argument("--out", type=Path, help="folder of the missions' rows; run again to resume")
    arguments = parser.parse_args()
    print("\n".join(table(arguments.trials, arguments.out)))


if __name__ == "__main__":
    main()
