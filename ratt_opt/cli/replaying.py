"""``ratt-opt replay``: the tracker over a recorded bag."""

from contextlib import nullcontext
from pathlib import Path
from typing import Annotated

import typer

from ratt_opt.cli.options import OutFolder, Planner
from ratt_opt.cli.terminal import print_lines, written
from ratt_opt.running.progress import Step

__all__ = ["replay"]


def replay(
    bag: Annotated[Path, typer.Argument(help="ROS 1 bag, folder of a ROS 2 bag, or MCAP file.", show_default=False)],
    mapping: Annotated[Path, typer.Option("--map", help="Which topic is which robot's.", show_default=False)],
    out: OutFolder,
    planner: Annotated[Planner, typer.Option("--planner", help="Who plans.")] = "ratt",
    gate: Annotated[float, typer.Option("--gate", help="Probability with which a good measurement passes.")] = 0.999,
    live: Annotated[
        bool, typer.Option("--live", help="Show each step in the viewer Rerun as it is planned (extra live).")
    ] = False,
) -> None:
    """Run the tracker over a ROS bag, plan at every step; write tables, figures and a log for viewers."""
    from ratt_opt._files import output_directory
    from ratt_opt.missions.bags.loop import replay_bag
    from ratt_opt.missions.bags.written import FILES
    from ratt_opt.missions.live.view import LiveView

    folder = output_directory(out, *FILES)
    with Step("replaying") as shown, LiveView() if live else nullcontext() as view:
        done = replay_bag(
            bag, mapping, planner=planner, gate=gate, progress=lambda k: shown.say(f"step {k}"), view=view
        )
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
