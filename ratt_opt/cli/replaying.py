"""``ratt-opt replay``: the tracker over a recorded bag."""

from pathlib import Path
from typing import Annotated

import typer

from ratt_opt.cli.options import OutFolder, Planner
from ratt_opt.cli.terminal import print_lines, written
from ratt_opt.running.progress import Step

__all__ = ["replay"]


def replay(
    bag: Annotated[Path, typer.Argument(help="ROS 1 bag, or folder of a ROS 2 bag.", show_default=False)],
    mapping: Annotated[Path, typer.Option("--map", help="Which topic is which robot's.", show_default=False)],
    out: OutFolder,
    planner: Annotated[Planner, typer.Option("--planner", help="Who plans.")] = "ratt",
    gate: Annotated[float, typer.Option("--gate", help="Probability with which a good measurement passes.")] = 0.999,
) -> None:
    """Run the tracker over a ROS bag, plan at every step; write tables, figures and a log for viewers."""
    from ratt_opt._files import output_directory
    from ratt_opt.missions.bags.loop import replay_bag
    from ratt_opt.missions.bags.written import FILES

    folder = output_directory(out, *FILES)
    with Step("replaying") as shown:
        done = replay_bag(bag, mapping, planner=planner, gate=gate, progress=lambda k: shown.say(f"step {k}"))
        files = done.save(folder)
    skipped = [one.reason for step in done.steps for one in step.plan.skipped]
    counts = [f"{reason} {skipped.count(reason)}" for reason in sorted(set(skipped))]
    n_robots, left = done.scenario.n_robots, len(done.steps[-1].targets)
    measured = sum(step.measured for step in done.steps)
    print_lines(
        [
            f"{len(done.steps)} steps, {n_robots} robots, {left} targets at the end",
            f"{measured} detections, {len(skipped)} skipped{': ' if counts else ''}{', '.join(counts)}",
            written(files),
        ]
    )
