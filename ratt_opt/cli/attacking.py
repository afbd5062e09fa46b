"""``ratt-opt attack``: what the adversary can do to the user's own plan."""

import math
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, TypeVar

import typer

from ratt_opt.cli.options import TIME_LIMIT, InputFile, JsonFlag, LatexFlag, ObjectiveOption, Planner, check_output
from ratt_opt.cli.terminal import WorkInterrupted, print_json, print_tables
from ratt_opt.errors import InputError

if TYPE_CHECKING:
    from collections.abc import Callable

    from ratt_opt.attack.protection.best_links import BestLinks
    from ratt_opt.budget import Budget

__all__ = ["attack"]

T = TypeVar("T")


def attack(
    file: InputFile,
    plan: Annotated[Path, typer.Option("--plan", help='JSON: {"elements": [...]}, {"controls": [...]} or a report.')],
    objective: ObjectiveOption = "trace",
    time_limit: Annotated[float, typer.Option("--time-limit", help="Seconds for the exact attack.")] = TIME_LIMIT,
    seed: Annotated[int, typer.Option("--seed", help="Seed of the random attack.")] = 0,
    rank: Annotated[
        int, typer.Option("--rank", min=0, help="Number of robots and links to rank by what protecting them gains.")
    ] = 0,
    below: Annotated[
        float | None,
        typer.Option("--below", help="Also find the smallest budgets that push the plan below this value."),
    ] = None,
    rms: Annotated[
        float | None,
        typer.Option("--rms", help="Like --below, by accuracy: budgets that push the RMS error above this [m]."),
    ] = None,
    replan: Annotated[
        Planner | None,
        typer.Option("--replan", help="Ask --below or --rms of the plan that this planner makes for each budget."),
    ] = None,
    protect_robots: Annotated[
        int, typer.Option("--protect-robots", min=0, help="Number of robots to choose whose protection gains most.")
    ] = 0,
    protect: Annotated[
        int, typer.Option("--protect", min=0, help="Number of links to choose whose protection gains most.")
    ] = 0,
    add: Annotated[int, typer.Option("--add", min=0, help="Number of new links to choose that gain most.")] = 0,
    reach: Annotated[
        float | None, typer.Option("--reach", help="Longest new link [m]; any by default. Needs robots' positions.")
    ] = None,
    explain: Annotated[
        bool, typer.Option("--explain", help="Also say which stages of the exact attack ran, and what each proved.")
    ] = False,
    params: Annotated[
        Path | None, typer.Option("--params", help="TOML: parameters of the exact attack that are not as by default.")
    ] = None,
    as_json: JsonFlag = False,
    as_latex: LatexFlag = False,
) -> None:
    """Find the exact worst case, and the heuristics' attacks, against your own plan, and what to protect.

    An interrupt (Ctrl-C) prints what was found so far and exits with 130.
    """
    from ratt_opt._params import changed, read_params
    from ratt_opt.attack.params import AttackParams
    from ratt_opt.attack.protection.best_links import links_to_add, links_to_protect
    from ratt_opt.attack.protection.criticality import breaking_budgets, criticality_ranking
    from ratt_opt.attack.protection.robot_choice import robots_to_protect
    from ratt_opt.attack.survey import attack_survey
    from ratt_opt.budget import Budget
    from ratt_opt.missions.players.planners import PLANNERS
    from ratt_opt.report.description import describe
    from ratt_opt.report.document import attack_document
    from ratt_opt.report.tables import attack_tables
    from ratt_opt.scenario.files import load_input
    from ratt_opt.scenario.plan_file import load_plan

    check_output(as_json=as_json, as_latex=as_latex)
    if below is not None and not math.isfinite(below):
        raise InputError("--below", "must be a finite number", below)
    if replan and below is None and rms is None:
        raise InputError("--replan", "must come with --below or --rms", replan)
    chosen = read_params(params, AttackParams())
    source = load_input(file)
    problem = source.problem(objective)
    elements = load_plan(plan, problem)
    budget = Budget()
    within: dict[str, Any] = {"time_limit": time_limit, "budget": budget}
    results = attack_survey(problem, elements, seed=seed, params=chosen, **within)
    critical = _found(budget, lambda: criticality_ranking(problem, elements, **within)[:rank] if rank else None)
    budgets = None
    if below is not None or rms is not None:
        asked = PLANNERS[replan] if replan else elements
        budgets = _found(budget, lambda: breaking_budgets(problem, asked, below, rms=rms, **within))
    robots = None
    if protect_robots:
        robots = _found(budget, lambda: robots_to_protect(problem, elements, protect_robots, **within))
    links: dict[str, BestLinks | None] = {}
    if protect:
        links["protect"] = _found(budget, lambda: links_to_protect(problem, elements, protect, **within))
    if add:
        near = None if reach is None else sorted(set(source.pairs_within(reach)) - problem.communication.links)
        links["add"] = _found(budget, lambda: links_to_add(problem, elements, add, candidates=near, **within))
    beside: dict[str, Any] = {
        "best_links": {name: best for name, best in links.items() if best is not None},
        "best_robots": robots,
        "params": changed(chosen) if explain else None,
    }
    if as_json:
        print_json(attack_document(objective, elements, results, critical, budgets, **beside))
    else:
        known = describe(problem, source)
        names = [known.robot(i) for i in range(problem.n_robots)]
        tables = attack_tables(results, critical, budgets, _goal(below, rms, replan), names=names, **beside)
        print_tables(tables, latex=as_latex)
    if budget.is_over:
        raise WorkInterrupted("interrupted; printed is what was found until then")


def _goal(below: float | None, rms: float | None, replan: str | None) -> str:
    """The words for what the smallest budgets do."""
    goal = f"leave less than {below}" if rms is None else f"leave an RMS error above {rms} m"
    return f"{goal}, if the team plans anew with {replan}" if replan else goal


def _found(budget: "Budget", search: "Callable[[], T]") -> T | None:
    """Result of a search, up to an interrupt; ``None`` if the user interrupted before."""
    if budget.is_over:
        return None
    try:
        return search()
    except KeyboardInterrupt:
        budget.interrupt()
        return None
