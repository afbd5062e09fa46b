"""``ratt-opt decentralise``: the plan that robots make by messages, and its price."""

from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from ratt_opt.cli.options import InputFile, JsonFlag, ObjectiveOption, OutFolder
from ratt_opt.cli.terminal import WorkInterrupted, print_json, print_lines, written
from ratt_opt.errors import InputError

if TYPE_CHECKING:
    from ratt_opt.decentralised.links import LinkLosses
    from ratt_opt.decentralised.plan import DecentralisedPlan
    from ratt_opt.problem import Problem

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
    refined: Annotated[bool, typer.Option("--refined", help="Go on with exchanges that neighbours propose.")] = False,
    hops: Annotated[
        int | None, typer.Option("--hops", help="Links over which a choice is told; all by default.")
    ] = None,
    links_time: Annotated[
        float, typer.Option("--links-time", help="Seconds to see which links matter, one after the other; 0 for none.")
    ] = 5.0,
    curvature_time: Annotated[
        float, typer.Option("--curvature-time", help="Seconds for the curvature of the guarantee.")
    ] = 2.0,
    as_json: JsonFlag = False,
) -> None:
    """Plan by messages between neighbours, in a simulation of their radios, and draw who heard whom.

    Writes decentralised.json, decentralised.png and decentralised.svg. On a connected network the plan is RATT's; with
    --refined one whose worst case is no less; with --hops choices are told only so far. An interrupt (Ctrl-C) writes
    the choices so far and exits with 130.
    """
    from ratt_opt._files import output_directory, write_json
    from ratt_opt._validation import check_integer, check_number
    from ratt_opt.budget import Stop
    from ratt_opt.curvatures.curvature import curvature, total_curvature
    from ratt_opt.decentralised.faults import Faults, RadioParams
    from ratt_opt.decentralised.links import link_losses
    from ratt_opt.decentralised.plan import decentralised_ratt, decentralised_refined
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
    if refined and hops is not None:
        raise InputError("--hops", "must be left out with --refined, for which all choices are told", hops)
    way = partial(decentralised_refined) if refined else partial(decentralised_ratt, hops=hops)
    if hops is not None:
        check_integer("--hops", hops, low=1)
    if check_number("--links-time", links_time) < 0:
        raise InputError("--links-time", "must be at least 0", links_time)
    folder = output_directory(out, "decentralised.json", "decentralised.png", "decentralised.svg")
    kind, measure = ("k", curvature) if problem.objective.is_submodular else ("c", total_curvature)
    known = measure(problem.objective, problem.robot, gap=0.01, time_limit=curvature_time)
    planner = partial(way, seed=seed, **{kind: known})
    plan, links = planner(problem, faults=faults), None
    if links_time > 0 and plan.stop is not Stop.INTERRUPTED:
        links = link_losses(problem, planner, faults=faults, time_limit=links_time)
    document = _document(plan, {kind: known.upper}, links)
    write_json(folder / "decentralised.json", document)

    def draw() -> list[Path]:
        figure = heard_figure(problem, plan, describe(problem, source), links)
        names = [folder / "decentralised.png", folder / "decentralised.svg"]
        for name in names:
            save_figure(figure, name)
        return names

    files, remarks = ([], ()) if plan.stop is Stop.INTERRUPTED else draw_or_remark(draw)
    if as_json:
        print_json(document)
    else:
        print_lines(
            [*_lines(plan), *_link_lines(problem, links), *remarks, written([folder / "decentralised.json", *files])]
        )
    if Stop.INTERRUPTED in {plan.stop, links.stop if links else None}:
        raise WorkInterrupted("interrupted; printed is what robots had chosen until then")


def _numbers(option: str, text: str, count: int) -> tuple[int, ...]:
    try:
        found = tuple(int(part) for part in text.replace("-", ":").split(":"))
    except ValueError:
        found = ()
    if len(found) != count:
        raise InputError(option, f"must be {'ROUND:I-J' if count == 3 else 'ROUND:I'}", text)
    return found


def _document(plan: "DecentralisedPlan", curvature: "dict[str, float]", links: "LinkLosses | None") -> dict[str, Any]:
    return {
        "format": "ratt-opt decentralised plan",
        "version": 1,
        "elements": list(plan),
        "bait": list(plan.bait),
        "components": [list(group) for group in plan.components],
        "exchanges": list(plan.exchanges),
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
        "worst_case": None if links is None else {"lower": links.worst_case.lower, "upper": links.worst_case.upper},
        "links": [
            {
                "link": list(loss.link),
                "worst_case": {"lower": loss.lower, "upper": loss.upper},
                "cost": loss.cost,
                "delay": loss.delay,
                "changed": loss.changed,
                "parts": loss.parts,
            }
            for loss in (() if links is None else links.losses)
        ],
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
        *([f"exchanges taken: {sum(plan.exchanges)}"] if sum(plan.exchanges) else []),
        f"{plan.rounds} rounds, {plan.messages} messages, {plan.bytes} bytes, decided after {plan.decision_time:.3f} s",
        f"guarantee: {share} of the optimum after any attack ({needs})",
        *([f"faults: {met}"] if met else []),
    ]


def _link_lines(problem: "Problem", links: "LinkLosses | None", most: int = 3) -> list[str]:
    """Say which ``most`` links' losses cost most, as far as they were seen; all are in the file."""
    if links is None or not links.losses:
        return []
    worst = links.worst_case
    all_seen = len(problem.communication.links)
    seen = "" if len(links.losses) == all_seen else f" (of {len(links.losses)} of {all_seen} links, until time was up)"
    told = "; ".join(
        f"{i}-{j}: {loss.cost:+.4g}, {loss.delay:+.2f} s{f', {loss.parts} parts' if loss.parts > 1 else ''}"
        for loss in links.losses[:most]
        for i, j in [loss.link]
    )
    return [
        f"worst case of the plan: {worst.lower:.6g}" + ("" if worst.lower == worst.upper else f" to {worst.upper:.6g}"),
        f"links whose loss while planning costs most of it, and delays the decision{seen}: {told}",
    ]
