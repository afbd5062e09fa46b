"""``ratt-opt track``: a whole mission in simulation."""

import warnings
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Literal

import typer

from ratt_opt.cli.options import Attacker, JsonFlag, Objective, OutFolder, Planner
from ratt_opt.cli.terminal import WorkInterrupted, print_json, print_lines, written
from ratt_opt.errors import InputError, printable
from ratt_opt.running.progress import Step

if TYPE_CHECKING:
    from collections.abc import Iterator

    from ratt_opt.missions.mission import Mission

__all__ = ["track"]

JOURNAL = "journal.jsonl"
"""Every step's decisions, in the folder of the results: run the same command again after a kill, and it goes on."""


def track(
    file: Annotated[Path, typer.Argument(help="Scenario file.", show_default=False)],
    steps: Annotated[int, typer.Option("--steps", help="Steps of the mission.")],
    out: OutFolder,
    planner: Annotated[Planner, typer.Option("--planner", help="Who plans.")] = "ratt",
    attacker: Annotated[Attacker, typer.Option("--attacker", help="Who attacks.")] = "worst",
    attacks: Annotated[
        Literal["renewed", "persistent", "permanent"], typer.Option("--attacks", help="How long attacks last.")
    ] = "renewed",
    sharing: Annotated[
        Literal["best group", "all surviving"] | None,
        typer.Option(
            "--sharing",
            help="Whose estimates the next step starts from; all surviving groups' if messages plan, else the best's.",
        ),
    ] = None,
    horizon: Annotated[int, typer.Option("--horizon", help="Steps that a plan looks ahead.")] = 1,
    beam: Annotated[
        int | None, typer.Option("--beam", min=1, help="Control sequences of a robot to plan with; all if absent.")
    ] = None,
    objective: Annotated[
        Objective,
        typer.Option("--objective", help="Criterion of plans; no logdet several steps ahead."),
    ] = "trace",
    motion: Annotated[
        Literal["known velocity", "constant velocity", "constant velocity 3d", "coordinated turn"],
        typer.Option("--motion", help="How targets move; all estimate velocities, except the first."),
    ] = "known velocity",
    sensor: Annotated[
        str | None,
        typer.Option(
            "--sensor",
            help="Part of the file's sensors that is measured (range, bearing), or a registered kind; all by default.",
            show_default=False,
        ),
    ] = None,
    linearisation: Annotated[
        Literal["first order", "second order", "iterated"],
        typer.Option("--linearisation", help="First order is the textbook EKF, without the second-order term."),
    ] = "second order",
    time_limit: Annotated[
        float | None,
        typer.Option("--time-limit", help="Seconds a step for refined or maxmin; else limited by kicks or nodes."),
    ] = None,
    rms: Annotated[
        float | None, typer.Option("--rms", help="Accuracy wanted [m]: say in how many steps the RMS error keeps it.")
    ] = None,
    params: Annotated[
        Path | None, typer.Option("--params", help="TOML file of other parameters of the mission.", show_default=False)
    ] = None,
    seed: Annotated[int, typer.Option("--seed", help="Seed of everything random.")] = 0,
    seeds: Annotated[int, typer.Option("--seeds", min=1, help="Missions for the figures' intervals.")] = 1,
    as_json: JsonFlag = False,
) -> None:
    """Fly a mission under attack in simulation; write tables, figures, an animation and a player.

    An interrupt (Ctrl-C) keeps the steps flown and exits with 130; the same command goes on from there.
    """
    from ratt_opt._files import output_directory
    from ratt_opt._params import read_params
    from ratt_opt._validation import check_number
    from ratt_opt.missions.drawing.write import FILES
    from ratt_opt.missions.params import MissionParams
    from ratt_opt.missions.players.planners import MaxMinPlanner, RefinedPlanner
    from ratt_opt.missions.run import run_mission
    from ratt_opt.missions.world import MissionModel
    from ratt_opt.scenario.files import load_scenario

    if time_limit is not None and planner not in {"maxmin", "refined"}:
        raise InputError("--time-limit", "must come with --planner maxmin or refined", planner)
    if rms is not None:
        check_number("--rms", rms, low=0.0)
    scenario = load_scenario(file)
    folder = output_directory(out, *FILES)
    model = MissionModel(
        motion=motion,
        sensor=sensor,
        linearisation=linearisation,
        objective=objective,
        beam=beam,
        params=read_params(params, MissionParams()),
    )
    chosen: str | MaxMinPlanner | RefinedPlanner = planner
    if time_limit is not None and planner == "maxmin":
        chosen = MaxMinPlanner(time_limit=time_limit, max_nodes=None)
    elif time_limit is not None:
        chosen = RefinedPlanner(time_limit=time_limit, max_kicks=None)
    missions = []
    with Step("flying") as shown, _resumable(folder):
        for k in range(seeds):
            journal = folder / (JOURNAL if k == 0 else f"{k}.{JOURNAL}")

            def say(step: int, of: int, number: int = k) -> None:
                shown.say(f"mission {number + 1} of {seeds}, step {step} of {of}")

            mission = run_mission(
                scenario,
                steps=steps,
                planner=chosen,
                attacker=attacker,
                attacks=attacks,
                sharing=sharing,
                horizon=horizon,
                seed=seed + k,
                model=model,
                journal=journal,
                progress=say,
            )
            missions.append(mission)
    with Step("tables, figures and animation"), _resumable(folder):
        files, remarks = _written(missions, folder)
    if as_json:
        print_json(missions[0].to_dict() | ({} if rms is None else {"accuracy": _accuracy(missions[0], rms)}))
    else:
        kept = [] if rms is None else [_kept(missions, rms)]
        print_lines([*_summary(missions), *kept, *missions[0].remarks, *remarks, written(files)])


def _accuracy(mission: "Mission", rms: float) -> dict[str, object]:
    """The accuracy asked for, and the steps that keep it."""
    return {"rms": rms, "within": mission.within(rms).tolist()}


def _kept(missions: "list[Mission]", rms: float) -> str:
    """Number of steps of each mission whose error is as small as asked, in words."""
    counts = ", ".join(str(int(mission.within(rms).sum())) for mission in missions)
    return f"steps with an RMS error of at most {rms:g} m: {counts} of {len(missions[0].steps)}"


def _written(missions: "list[Mission]", folder: Path) -> "tuple[list[Path], list[str]]":
    """The files of the first mission, and what is to be said of them."""
    from ratt_opt.missions.drawing.write import write_mission

    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always", RuntimeWarning)
        files = write_mission(missions[0], folder, missions[1:])
    return files, [str(warning.message) for warning in caught if warning.category is RuntimeWarning]


@contextmanager
def _resumable(folder: Path) -> "Iterator[None]":
    """Say of an interrupt inside that the journal keeps what was flown."""
    try:
        yield
    except KeyboardInterrupt:
        if not (folder / JOURNAL).exists():
            raise
        text = f"interrupted; {printable(str(folder / JOURNAL))} holds the steps flown: the same command goes on"
        raise WorkInterrupted(text) from None


def _summary(missions: "list[Mission]") -> list[str]:
    first = missions[0]
    low, high = first.nees_band()
    rmse = ", ".join(f"{mission.rmse.mean():.4g}" for mission in missions)
    nees = ", ".join(f"{mission.nees.mean():.3g}" for mission in missions)
    short = [sum(step.links_short > 0 for step in mission.steps) for mission in missions]
    capped = f"steps with fewer links than may be cut (all of them may): {', '.join(map(str, short))}"
    return [
        f"{len(first.steps)} steps, {first.scenario.n_robots} robots, {first.scenario.n_targets} targets",
        f"RMSE [m], mean over the steps: {rmse}",
        f"NEES, mean over the steps: {nees} (consistent: {first.dimension}; one step in [{low:.3g}, {high:.3g}])",
        *([capped] if any(short) else []),
    ]
