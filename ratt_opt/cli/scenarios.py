"""``ratt-opt new`` and ``ratt-opt schema``: scenario files, and what they must look like."""

from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal

import typer

from ratt_opt.cli.options import JsonFlag
from ratt_opt.cli.terminal import print_json, print_lines
from ratt_opt.errors import InputError, printable
from ratt_opt.report.schemas import OUTPUTS, output_schema

if TYPE_CHECKING:
    from collections.abc import Mapping

    from ratt_opt.scenario.model import Scenario

__all__ = ["new", "schema"]

if TYPE_CHECKING:
    Kind = str
else:
    Kind = Literal[("scenario", "information", *OUTPUTS)]


def new(
    out: Annotated[Path, typer.Option("--out", help="Scenario file to write.")],
    sensing_attacks: Annotated[int, typer.Option("--sensing-attacks", help="Robots that may be blinded.")],
    link_attacks: Annotated[int, typer.Option("--link-attacks", help="Links that may be cut.")],
    robots: Annotated[int | None, typer.Option("--robots", help="Number of robots of a random scenario.")] = None,
    targets: Annotated[int | None, typer.Option("--targets", help="Number of targets of a random scenario.")] = None,
    seed: Annotated[int | None, typer.Option("--seed", help="Seed of a random scenario.")] = None,
    view: Annotated[
        float | None,
        typer.Option("--view", help="Cameras that turn, with this field of view [degrees]; else all see everything."),
    ] = None,
    reach: Annotated[
        float | None, typer.Option("--range", help="With --view: how far a camera sees [m]; no limit if absent.")
    ] = None,
    headings: Annotated[
        int | None,
        typer.Option("--headings", help="With --view: directions that a camera can turn to; 8 if absent."),
    ] = None,
    sensor: Annotated[str | None, typer.Option("--sensor", help="With --view: camera (the default) or radar.")] = None,
    communication_range: Annotated[
        float | None,
        typer.Option("--communication-range", help="Link robots within this distance [m]; all if absent."),
    ] = None,
    graph: Annotated[
        str | None,
        typer.Option(
            "--graph",
            help="Family of a random network: dense, disk-12, disk-6, small-world or hubs. "
            "Or a graph file, whose nodes are the robots: .graphml, .gml, .gexf, .json (node-link), "
            ".edgelist, .edges, .txt.",
        ),
    ] = None,
    mrclam: Annotated[Path | None, typer.Option("--mrclam", help="Folder of the MRCLAM dataset.")] = None,
    time: Annotated[
        float | None, typer.Option("--time", help="Instant of the dataset: seconds since its start, or Unix time.")
    ] = None,
    label_correction: Annotated[
        bool, typer.Option(help="Exchange labels if the dataset's sightings say so, or keep all.")
    ] = True,
    corrections: Annotated[
        str | None,
        typer.Option("--corrections", help="Labels to exchange whatever the sightings say, as 11=17,17=11."),
    ] = None,
    as_json: JsonFlag = False,
) -> None:
    """Write a scenario file: random (--robots, --targets, --seed), on the graph of a file (--graph, --targets, --seed),
    or from real robots (--mrclam, --time).

    With --view the robots see only a part of what is around them, and a plan says what each looks at.
    """
    from ratt_opt._files import output_file
    from ratt_opt.scenario.files import save_scenario

    output_file(out)
    budgets = (sensing_attacks, link_attacks)
    drawn = {"robots": robots, "targets": targets, "seed": seed}
    limits = {"range": reach, "headings": headings, "sensor": sensor}
    if mrclam is not None:
        _refuse({**drawn, "graph": graph, "view": view, **limits}, wants="no --mrclam")
        if not label_correction:
            _refuse({"corrections": corrections}, wants="no --no-label-correction")
        given = _corrections(corrections) if label_correction else {}
        scenario = _from_mrclam(mrclam, time, budgets, given)
    else:
        _refuse({"time": time, "corrections": corrections}, wants="--mrclam")
        if graph is not None:
            _refuse({"range": reach, "view": view, "communication-range": communication_range}, wants="no --graph")
        if view is None:
            _refuse(limits, wants="--view")
        scenario = _random(drawn, budgets, graph) if view is None else _limited(drawn, budgets, view, limits)
    if communication_range is not None:
        scenario = scenario.replace(communication_range=communication_range)
    save_scenario(scenario, out)
    if as_json:
        size = {"n_robots": scenario.n_robots, "n_targets": scenario.n_targets}
        print_json({"format": "ratt-opt new", "version": 1, "file": str(out), **size, "notes": list(scenario.notes)})
        return
    head = f"{printable(str(out))}: {scenario.n_robots} robots, {scenario.n_targets} targets"
    print_lines([head, *(f"  {note}" for note in scenario.notes)])


def schema(
    kind: Annotated[Kind, typer.Argument(help="Which input file, or which output.")] = "scenario",
) -> None:
    """Print the JSON Schema of an input file, of a certificate, or of what a command prints with --json."""
    from ratt_opt.scenario.files import scenario_schema

    print_json(output_schema(kind) if kind in OUTPUTS else scenario_schema(kind))


def _random(drawn: "Mapping[str, int | None]", budgets: tuple[int, int], graph: str | None) -> "Scenario":
    from ratt_opt.scenario.generator import random_scenario
    from ratt_opt.scenario.networks import NETWORK_FAMILIES, network_scenario

    if graph is not None and graph not in NETWORK_FAMILIES and Path(graph).suffix:
        return _on_graph(dict(drawn), budgets, Path(graph))
    robots, targets, seed = _given(drawn)
    draw = random_scenario if graph is None else partial(network_scenario, graph)
    return draw(robots, targets, alpha_s=budgets[0], alpha_c=budgets[1], seed=seed)


def _on_graph(drawn: "dict[str, int | None]", budgets: tuple[int, int], file: Path) -> "Scenario":
    from ratt_opt.scenario.graph_files import read_graph
    from ratt_opt.scenario.on_graph import graph_scenario

    _refuse({"robots": drawn.pop("robots")}, wants="no --graph file, whose nodes are the robots")
    targets, seed = _given(drawn)
    return graph_scenario(read_graph(file), targets, alpha_s=budgets[0], alpha_c=budgets[1], seed=seed)


def _limited(
    drawn: "Mapping[str, int | None]", budgets: tuple[int, int], view: float, limits: "Mapping[str, Any]"
) -> "Scenario":
    from ratt_opt.scenario.limited_view import limited_view_scenario

    robots, targets, seed = _given(drawn)
    names = {"range": "reach"}
    given = {names.get(name, name): value for name, value in limits.items() if value is not None}
    alpha_s, alpha_c = budgets
    return limited_view_scenario(robots, targets, alpha_s=alpha_s, alpha_c=alpha_c, seed=seed, view=view, **given)


def _given(drawn: "Mapping[str, int | None]") -> list[int]:
    """Robots, targets and seed, all of which a random scenario needs."""
    for name, value in drawn.items():
        if value is None:
            raise InputError(f"--{name}", "must be given for a random scenario (or give --mrclam)", "nothing")
    return [int(value) for value in drawn.values() if value is not None]


def _from_mrclam(
    folder: Path, time: float | None, budgets: tuple[int, int], corrections: "Mapping[int, int] | None"
) -> "Scenario":
    from ratt_opt.scenario.mrclam import from_mrclam

    if time is None:
        raise InputError("--time", "must be given with --mrclam", "nothing")
    return from_mrclam(folder, time, alpha_s=budgets[0], alpha_c=budgets[1], corrections=corrections)


def _corrections(text: str | None) -> dict[int, int] | None:
    """Pairs of numbers as in ``11=17,17=11``; ``None`` if nothing is given."""
    if text is None:
        return None
    try:
        return {int(named): int(meant) for named, meant in (pair.split("=") for pair in text.split(","))}
    except ValueError:
        raise InputError("--corrections", "must be pairs of subjects, as 11=17,17=11", text) from None


def _refuse(given: "Mapping[str, float | str | None]", wants: str) -> None:
    for name, value in given.items():
        if value is not None:
            raise InputError(f"--{name}", f"must come with {wants}", value)
