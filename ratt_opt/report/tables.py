"""The bound report and attack results as tables a person reads."""

from __future__ import annotations

import math
from fractions import Fraction
from typing import TYPE_CHECKING, Any

from ratt_opt._rounding import bracket_text, down, up
from ratt_opt.report.description import describe

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Mapping, Sequence

    from rich.table import Table

    from ratt_opt.attack.protection.best_links import BestLinks
    from ratt_opt.attack.protection.criticality import BreakingBudget, Criticality
    from ratt_opt.attack.protection.robot_choice import BestRobots
    from ratt_opt.attack.task import AttackResult
    from ratt_opt.certificates.certification import Certification, CutsCertification
    from ratt_opt.findings import Findings
    from ratt_opt.problem import Attack

__all__ = [
    "attack_tables",
    "audit_table",
    "guarantee_text",
    "omitted_texts",
    "report_tables",
    "share_text",
    "verdict_text",
]

PROVED_OPTIMAL = Fraction("1e-9")
"""A plan is called optimal if at most this share of the best possible value is lost."""


def report_tables(report: Findings) -> Iterable[Table]:
    """Yield the tables of a bound report: planners, plan, bracket, guarantees."""
    yield _planners(report)
    yield _plan(report)
    yield _bracket(report)
    if "guarantees" not in report.omitted:
        yield _guarantees(report)


def attack_tables(
    results: Mapping[str, AttackResult],
    critical: Iterable[Criticality] | None,
    budgets: Iterable[BreakingBudget] | None,
    goal: str,
    *,
    best_links: Mapping[str, BestLinks] | None = None,
    best_robots: BestRobots | None = None,
    params: Mapping[str, Any] | None = None,
    names: Sequence[str] = (),
) -> Iterable[Table]:
    """Yield the attacks on a plan, and, if wanted, what to protect or add and what pushes it past the ``goal``.

    ``names`` : (N,) robots for people, by their numbers where empty
    ``best_links`` : by what is done with them, "protect" and "add"; ``best_robots`` : to protect
    ``params`` : of the exact attack that are not as by default; then also which stages ran, and what each did
    """
    yield _attacks(results)
    if params is not None:
        yield _stages(results["worst"], params)
    if critical is not None:
        yield _critical(critical, names)
    if budgets is not None:
        yield _budgets(budgets, goal)
    if best_robots:
        yield _best_robots(best_robots, names)
    if best_links:
        yield _best_links(best_links, names)


def audit_table(chains: Mapping[str, Mapping[str, int]]) -> Table:
    """One row a chain of the proof: how many of its entries have each verdict."""
    verdicts = list(next(iter(chains.values())))
    table = _table("proof ledger", "chain", *verdicts)
    for name, counts in chains.items():
        table.add_row(name, *(str(counts[verdict] or "") for verdict in verdicts))
    return table


def share_text(lower: float, upper: float) -> str:
    """The proved share ``lower / upper`` in words; rounded down, so that what is printed is no more than was proved."""
    share = Fraction(float(lower)) / Fraction(float(upper)) if upper > 0 else Fraction(1)
    if share >= 1 - PROVED_OPTIMAL:
        return "optimal to 1e-9"
    return f"at least {down(share, 6)}"


def _attacks(results: Mapping[str, AttackResult]) -> Table:
    """One row an attacker: the value its attack leaves, and the attack."""
    table = _table("attacks on the plan", "attacker", "value left", "proved worst case", "blinded robots", "cut links")
    for name, result in results.items():
        proved = bracket_text(result.lower, result.upper) if name == "worst" else ""
        table.add_row(name, up(result.upper, 8), proved, _robots(result.attack), _links(result.attack))
    return table


def _stages(exact: AttackResult, params: Mapping[str, Any]) -> Table:
    """One row a stage that ran: how long, and which ends of the bracket it moved; ``params`` not as by default."""
    table = _table("how the exact attack came to this", "stage", "seconds", "nodes", "worst case at least", "at most")
    for row in exact.stages:
        lower, upper = _moved(row.lower_before, row.lower, down), _moved(row.upper_before, row.upper, up)
        table.add_row(row.name, f"{row.seconds:.3f}", f"{row.nodes:,}", lower, upper)
    told = ", ".join(f"{place} = {value}" for place, value in params.items()) or "all as by default"
    table.caption = (
        "stages that do not apply to this problem are not shown; within the search, before rounding outward"
        f"\nparameters: {told}"
    )
    return table


def _moved(before: float, after: float, rounded: Callable[[float, int], str]) -> str:
    """An end of a bracket, and what it was if it moved; a dash if it is not known."""
    old, new = (rounded(end, 8) if math.isfinite(end) else "-" for end in (before, after))
    return new if old == new else f"{old} → {new}"


def _critical(ranking: Iterable[Criticality], names: Sequence[str]) -> Table:
    """One row a robot or link: what protecting it alone gains, and what losing it alone costs."""
    table = _table("what to protect", "robot or link", "worst case gained if protected", "value lost if attacked alone")
    for row in ranking:
        target = row.target
        name = f"robot {_named(target, names)}" if isinstance(target, int) else f"link {_link(target, names)}"
        table.add_row(name, bracket_text(row.gain_lower, row.gain_upper), f"{row.loss:.8g}")
    return table


def _budgets(budgets: Iterable[BreakingBudget], goal: str) -> Table:
    """One row a smallest pair of budgets that pushes the plan below a value."""
    table = _table(f"smallest budgets that {goal}", "blinded", "links cut", "value left", "proved")
    for row in budgets:
        table.add_row(str(row.alpha_s), str(row.alpha_c), up(row.value, 8), "yes" if row.is_proved else "no")
    if not table.row_count:
        table.caption = "no attack on what is not protected does"
    return table


def _best_links(found: Mapping[str, BestLinks], names: Sequence[str]) -> Table:
    """One row a kind of change: the best links, and the worst case with them."""
    table = _table("the best links", "what to do", "links", "worst case with them", "no choice is better than")
    for what, best in found.items():
        links = ", ".join(_link(link, names) for link in best.links) or "none gains anything"
        table.add_row(what, links, bracket_text(best.lower, best.after.upper), up(best.upper, 8))
        table.caption = f"without them {bracket_text(best.before.lower, best.before.upper)}; the plan is the same"
    return table


def _best_robots(best: BestRobots, names: Sequence[str]) -> Table:
    """The best robots to protect from blinding, and the worst case with them."""
    table = _table("the best robots to protect", "robots", "worst case with them", "no choice is better than")
    robots = ", ".join(_named(robot, names) for robot in best.robots) or "none gains anything"
    table.add_row(robots, bracket_text(best.lower, best.after.upper), up(best.upper, 8))
    table.caption = f"without them {bracket_text(best.before.lower, best.before.upper)}; the plan is the same"
    return table


def _named(robot: int, names: Sequence[str]) -> str:
    return names[robot] if names else f"{robot}"


def _link(link: tuple[int, int], names: Sequence[str]) -> str:
    """A link by its robots' numbers, or by their names if there are any: "0 ada - 1 bob"."""
    i, j = (_named(robot, names) for robot in link)
    return f"{i} - {j}" if " " in i + j else f"{i}-{j}"


def _planners(report: Findings) -> Table:
    value = f"worst-case value{_unit(report)}"
    table = _table("planners under their worst attacks", "planner", value, "share of the best possible", "evaluations")
    for plan in report.plans:
        share = share_text(plan.worst_case.lower, report.upper)
        name = f"{plan.planner} *" if plan.planner == report.recommended.planner else plan.planner
        table.add_row(name, bracket_text(plan.worst_case.lower, plan.worst_case.upper), share, f"{plan.evaluations:,}")
    lines = ["* recommended: the best proved worst case", *omitted_texts(report), *report.remarks]
    table.caption = "\n".join(lines)
    return table


def _unit(report: Findings) -> str:
    """The unit of the values in brackets, after a space; empty if the criterion has none."""
    return f" [{report.unit}]" if report.unit else ""


def omitted_texts(report: Findings) -> list[str]:
    """List the parts that were left out, each with its reason."""
    return [f"left out: {name} ({why})" for name, why in report.omitted.items()]


def _plan(report: Findings) -> Table:
    plan, known = report.recommended, describe(report.problem, report.source)
    table = _table(f"the {plan.planner} plan and its worst attack", "robot", "element", "control", "under attack")
    home = {i: k for k, group in enumerate(plan.groups) for i in group}
    for i, element in enumerate(plan.elements.tolist()):
        group = f", group {home[i]} of {len(plan.groups)}" if len(plan.groups) > 1 else ""
        control = known.labels[element] if known.labels else ""
        table.add_row(known.robot(i), str(element), control, plan.role(i) + group)
    table.caption = f"cut links: {_links(plan.worst_case.attack)}"
    return table


def _bracket(report: Findings) -> Table:
    table = _table("how good that is", "quantity", "result")
    optimum, problem = report.optimum, report.problem
    table.add_row(f"best possible worst-case value{_unit(report)}", bracket_text(optimum.lower, report.upper))
    if optimum.posterior_gap is not None:
        table.add_row("gap, of the criterion left after measuring", up(optimum.posterior_gap, 3))
    table.add_row("search stopped because", optimum.stop.value)
    table.add_row("certificate", verdict_text(report.certificate))
    table.add_row("RATT's certified share of the best possible", share_text(report.ratt.worst_case.lower, report.upper))
    table.add_row("budgets (robots blinded, links cut)", f"{problem.alpha_s}, {problem.alpha_c}")
    if problem.at_most is not None:
        table.add_row("robots that may choose another element than idle", f"at most {problem.at_most}")
    is_known = report.n_max == report.n_max_upper  # a bound else, of which RATT is sure
    most = "" if report.n_max_upper is None else f", at most {report.n_max_upper}"
    table.add_row("smallest largest group, n_max", f"{report.n_max}" if is_known else f"at least {report.n_max}{most}")
    table.add_row("equivalent sensing attacks, alpha_cs", f"{'' if is_known else 'at most '}{report.alpha_cs}")
    table.add_row("certificate of n_max", _cuts_text(report.cuts_certificate))
    for name, bracket in (("curvature k", report.curvature), ("total curvature c", report.total_curvature)):
        if bracket is not None:
            table.add_row(f"{name} over {bracket.domain} sets", bracket_text(bracket.lower, bracket.upper))
    return table


def verdict_text(given: Certification) -> str:
    """Say what the verifier proved, or why there is no certificate."""
    if given.certificate is None:
        return f"none: {given.why_not}"
    found = given.certificate.verified
    bracket = bracket_text(found.lower, found.upper)
    if found.lower_proved:
        return f"verified, both ends proved in {found.arithmetic}: {bracket}"
    return f"verified, upper end proved in {found.arithmetic}, lower end searched in floating point: {bracket}"


def _cuts_text(given: CutsCertification) -> str:
    """Say how many links must be cut for smaller groups, or why there is no certificate."""
    if given.verified is None:
        return f"none: {given.why_not}"
    proved = given.verified
    return f"verified, by {proved.proof}: at least {proved.lower} links must be cut for groups of {proved.size}"


def _guarantees(report: Findings) -> Table:
    table = _table("what was guaranteed before planning", "guarantee", "share", "needs", "proved at")
    best = report.guaranteed_share
    for name, guarantee in report.guarantees.items():
        strongest = float(guarantee) == best and best > 0
        needs = "; ".join(guarantee.hypotheses)
        table.add_row(f"{name} *" if strongest else name, down(float(guarantee), 6), needs, guarantee.proof)
    for name, why in report.inapplicable.items():
        table.add_row(name, "none", f"does not apply: {why}", "")
    table.caption = "; ".join(
        filter(None, ["* strongest that applies" if report.guaranteed_share else "", guarantee_text(report)])
    )
    return table


def guarantee_text(report: Findings) -> str:
    """Say what the strongest guarantee means if it guarantees all or nothing, else return an empty text."""
    best = report.guaranteed_share
    if best == 1:
        return "RATT's plan is optimal, and was sure to be before planning"
    return "" if best > 0 else "curvature 1: no guarantee says anything here"


def _robots(attack: Attack) -> str:
    return " ".join(map(str, sorted(attack.sensing))) or "none"


def _links(attack: Attack, most: int = 12) -> str:
    """The first cut links and the number of more than ``most``; the JSON lists all."""
    links = sorted(attack.links)
    shown = " ".join(f"{i}-{j}" for i, j in links[:most]) or "none"
    return f"{shown} ... ({len(links)} in all)" if len(links) > most else shown


def _table(title: str, *columns: str) -> Table:
    from rich import box
    from rich.table import Table

    table = Table(title=title, box=box.SIMPLE_HEAD, title_justify="left", caption_justify="left", title_style="bold")
    for column in columns:
        table.add_column(column)
    return table
