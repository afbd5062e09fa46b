"""``ratt-opt decentralise``: the plan that robots make by messages, and its price."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from ratt_opt.cli.options import InputFile, JsonFlag, ObjectiveOption, OutFolder
from ratt_opt.cli.terminal import WorkInterrupted, print_json, print_lines, written
from ratt_opt.errors import InputError

if TYPE_CHECKING:
    from ratt_opt.decentralised.plan import DecentralisedPlan

__all__ = ["decentralise"]


def decentralise(
    file: InputFile,
    out: OutFolder,
    objective: ObjectiveOption = "trace",
    loss: Annotated[float, typer.Option("--loss", help="Share of packets that do not arrive.")] = 0.0,
    duplicates: Annotated[float, typer.Option("--duplicates", help="Share of packets that arrive twice.")] = 0.0,
    cut: Annotated[
        list[str] | None, typer.Option("--cut", help="ROUND:I-J, a link that is cut in that round; repeatable.")
    ] = None,
    blind: Annotated[
        list[str] | None, typer.Option("--blind", help="ROUND:I, a robot that is blinded; repeatable.")
    ] = None,
    crash: Annotated[
        list[str] | None, typer.Option("--crash", help="ROUND:I, a robot that falls silent; repeatable.")
    ] = None,
    bandwidth: Annotated[float, typer.Option("--bandwidth", help="Of each robot's radio [bit/s].")] = 250_000.0,
    seed: Annotated[int, typer.Option("--seed", min=0, help="Seed of losses and duplicates.")] = 0,
    curvature_time: Annotated[
        float, typer.Option("--curvature-time", help="Seconds for the curvature of the guarantee.")
    ] = 2.0,
    as_json: JsonFlag = False,
) -> None:
    """Plan by messages between neighbours, in a simulation of their radios, and draw who heard whom.

    Writes decentralised.json, decentralised.png and decentralised.svg. On a connected network the plan is RATT's. An
    interrupt (Ctrl-C) writes the choices so far and exits with 130.
    """
    from ratt_opt._files import output_directory, write_json
    from ratt_opt.budget import Stop
    from ratt_opt.curvatures.curvature import curvature, total_curvature
    from ratt_opt.decentralised.faults import Faults, RadioParams
    from ratt_opt.decentralised.plan import decentralised_ratt
    from ratt_opt.report.description import describe
    from ratt_opt.report.figure import draw_or_remark, save_figure
    from ratt_opt.report.heard import heard_figure
    from ratt_opt.scenario.files import load_input

    faults = Faults(
        loss=loss,
        duplicates=duplicates,
        cuts=tuple((*_numbers("--cut", text, 3),) for text in cut or ()),  # type: ignore[misc]
        blinded=tuple((*_numbers("--blind", text, 2),) for text in blind or ()),  # type: ignore[misc]
        crashed=tuple((*_numbers("--crash", text, 2),) for text in crash or ()),  # type: ignore[misc]
        radio=RadioParams(bandwidth=bandwidth),
    )
    source = load_input(file)
    problem = source.problem(objective)
    faults.check(problem)
    folder = output_directory(out, "decentralised.json", "decentralised.png", "decentralised.svg")
    kind, measure = ("k", curvature) if problem.objective.is_submodular else ("c", total_curvature)
    known = measure(problem.objective, problem.robot, gap=0.01, time_limit=curvature_time)
    given: Any = {kind: known}
    plan = decentralised_ratt(problem, faults=faults, seed=seed, **given)
    document = _document(plan, {kind: known.upper})
    write_json(folder / "decentralised.json", document)

    def draw() -> list[Path]:
        figure = heard_figure(problem, plan, describe(problem, source))
        names = [folder / "decentralised.png", folder / "decentralised.svg"]
        for name in names:
            save_figure(figure, name)
        return names

    files, remarks = ([], ()) if plan.stop is Stop.INTERRUPTED else draw_or_remark(draw)
    if as_json:
        print_json(document)
    else:
        print_lines([*_lines(plan), *remarks, written([folder / "decentralised.json", *files])])
    if plan.stop is Stop.INTERRUPTED:
        raise WorkInterrupted("interrupted; printed is what robots had chosen until then")


def _numbers(option: str, text: str, count: int) -> tuple[int, ...]:
    try:
        found = tuple(int(part) for part in text.replace("-", ":").split(":"))
    except ValueError:
        found = ()
    if len(found) != count:
        raise InputError(option, f"must be {'ROUND:I-J' if count == 3 else 'ROUND:I'}", text)
    return found


def _document(plan: "DecentralisedPlan", curvature: "dict[str, float]") -> dict[str, Any]:
    return {
        "format": "ratt-opt decentralised plan",
        "version": 1,
        "elements": list(plan),
        "bait": list(plan.bait),
        "components": [list(group) for group in plan.components],
        "heard": [list(others) for others in plan.heard],
        "rounds": plan.rounds,
        "messages": plan.messages,
        "bytes": plan.bytes,
        "decision_time": plan.decision_time,
        "cliques": plan.cliques,
        "curvature": curvature.get("k"),
        "total_curvature": curvature.get("c"),
        "guarantee": {"value": plan.guarantee.value, "hypotheses": list(plan.guarantee.hypotheses)},
        "faults_met": [{"round": at, "kind": kind, "robots": list(who)} for at, kind, who in plan.faults_met],
        "stop": plan.stop.value,
    }


def _lines(plan: "DecentralisedPlan") -> list[str]:
    groups = "; ".join(" ".join(map(str, group)) for group in plan.components)
    met = ", ".join(f"{kind} {'-'.join(map(str, who))} (round {at})" for at, kind, who in plan.faults_met)
    needs = "; ".join(plan.guarantee.hypotheses)
    share = f"{plan.guarantee.value:.4g}" if plan.guarantee.value > 0 else "curvature proves no share"
    return [
        f"elements: {' '.join(map(str, plan))}",
        f"bait: {' '.join(map(str, plan.bait)) or 'none'}",
        f"components that planned together: {groups}",
        f"{plan.rounds} rounds, {plan.messages} messages, {plan.bytes} bytes, decided after {plan.decision_time:.3f} s",
        f"guarantee: {share} of the optimum after any attack ({needs})",
        *([f"faults: {met}"] if met else []),
    ]
