"""The page: its sections in order. It holds the numbers of ``report.json`` and nothing else."""

from __future__ import annotations

from html import escape
from importlib import resources
from typing import TYPE_CHECKING

from ratt_opt._rounding import bracket_text, down, up
from ratt_opt._values import counted
from ratt_opt._version import CITATION
from ratt_opt.report.bars import bar_ends
from ratt_opt.report.description import describe
from ratt_opt.report.notebook import html_table
from ratt_opt.report.palette import SURVIVING, looks_of
from ratt_opt.report.plan_rows import PLAN_HEADS, plan_rows
from ratt_opt.report.tables import guarantee_text, omitted_texts, share_text, verdict_text

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

    from ratt_opt.findings import AssessedPlan, Findings

__all__ = ["report_page"]

GUARANTEE_COLUMNS = ("guarantee", "share", "needs", "proved at")
VIEW_TITLES = {
    "worst": "worst attack",
    "next worst": "next worst: spares a part of the worst attack",
    "none": "no attack",
}


def report_page(report: Findings, maps: Mapping[str, str] | None = None) -> str:
    """Return the whole page as HTML; ``maps`` : SVG of each view, once they are drawn."""
    folder = resources.files("ratt_opt.report.page")
    style, script = ((folder / name).read_text(encoding="utf-8") for name in ("style.css", "script.js"))
    plan = report.recommended
    title = f"{report.problem.n_robots} robots: the {plan.planner} plan under attack"
    return (
        '<!DOCTYPE html><html lang="en"><head><meta charset="utf-8">'
        '<meta name="viewport" content="width=device-width, initial-scale=1">'
        f"<title>{escape(title)}</title><style>:root{{--seeing:{SURVIVING}}}{style}</style></head><body>"
        f'<a class="skip" href="#planners">Skip the map</a><main><h1>{escape(title)}</h1>'
        f"{''.join(_sections(report, maps or {}))}</main><script>{script}</script></body></html>\n"
    )


def _sections(report: Findings, maps: Mapping[str, str]) -> Iterator[str]:
    plan = report.recommended
    kept = _with_unit(bracket_text(plan.worst_case.lower, plan.worst_case.upper), report)
    share = share_text(plan.worst_case.lower, report.upper)
    yield (
        f"<p>This plan has a worst-case value of <strong>{escape(kept)}</strong> ({escape(report.objective)}), "
        f"under the worst attack that blinds at most {counted(report.problem.alpha_s, 'robot')} and cuts at most "
        f"{counted(report.problem.alpha_c, 'link')}. {escape(_share_sentence(share))} "
        f"No plan has more than {escape(_with_unit(up(report.upper, 10), report))}.</p>"
    )
    yield from _map_section(report, maps)
    yield from _planner_section(report)
    yield from _trust_section(report)
    yield from _plan_section(report)
    seconds = [(name, f"{value:.2f}") for name, value in report.seconds.items()]
    yield html_table("Seconds of each step", ("step", "seconds"), seconds)
    yield f"<footer>Made {escape(report.created)}. Every number in full precision: report.json. "
    yield f"To cite: {escape(CITATION)}.</footer>"


def _share_sentence(share: str) -> str:
    if share.startswith("optimal"):
        return f"It is {share}."
    return f"That is {share} of the best possible."


def _map_section(report: Findings, maps: Mapping[str, str]) -> Iterator[str]:
    """One map for each attack. The page shows one of them; on paper, the worst."""
    yield '<section aria-labelledby="map-h"><h2 id="map-h">Map</h2><fieldset><legend>Show the team under</legend>'
    for k, name in enumerate(report.views):
        checked = " checked" if k == 0 else ""
        key = name.replace(" ", "-")
        yield (
            f'<label><input type="radio" name="view" value="{key}" id="show-{key}"{checked}> '
            f"{escape(VIEW_TITLES[name])}</label>"
        )
    yield "</fieldset>"
    for k, (name, view) in enumerate(report.views.items()):
        hidden = " hidden" if k else ""
        drawn = f'<div class="wide">{maps[name]}</div>' if name in maps else ""
        yield (
            f'<figure class="view" id="view-{name.replace(" ", "-")}"{hidden}>{drawn}'
            f"<figcaption>{escape(_caption(name, view, report))}</figcaption></figure>"
        )
    hint = "Point at a robot or target, or tab to it." if maps else "The maps are not drawn."
    yield f'<p id="hint" role="status" aria-live="polite">{hint}</p></section>'


def _with_unit(value: str, report: Findings) -> str:
    """A value in words with its unit, in brackets if that is words and not a symbol."""
    unit = f"[{report.unit}]" if " " in report.unit else report.unit
    return f"{value} {unit}".rstrip()


def _caption(name: str, view: AssessedPlan, report: Findings) -> str:
    attack, known = view.worst_case.attack, describe(report.problem, report.source)
    blinded = ", ".join(known.robot(i) for i in sorted(attack.sensing)) or "none"
    cut = " ".join(f"{i}-{j}" for i, j in sorted(attack.links)) or "none"
    left = f"value left {_with_unit(up(view.worst_case.upper, 10), report)}"
    return f"{VIEW_TITLES[name]}: {left}; blinded robots: {blinded}; cut links: {cut}"


def _planner_section(report: Findings) -> Iterator[str]:
    """A bar a planner: filled as far as it is sure, half-tone as far as it is not decided."""
    missing, brackets, longest = bar_ends(report)
    what = "shortfall from the best possible" if missing else "worst-case value"
    yield '<section aria-labelledby="planners"><h2 id="planners">Planners under their worst attacks</h2>'
    yield '<div class="wide"><table>'
    unit = escape(f" [{report.unit}]" if report.unit else "")
    looks = looks_of([plan.planner for plan in report.plans])
    yield f'<thead><tr><th scope="col">planner</th><th scope="col">worst-case value{unit}</th>'
    yield '<th scope="col">share of the best possible</th>'
    yield f'<th scope="col">{what} (grey: not decided)</th></tr></thead><tbody>'
    for plan, bracket in zip(report.plans, brackets, strict=True):
        low, high = plan.worst_case.lower, plan.worst_case.upper
        ends = [100 * min(max(x / longest, 0.0), 1.0) for x in bracket]
        mark = " (recommended)" if plan.planner == report.recommended.planner else ""
        bar = (
            f'<svg class="bar" viewBox="0 0 100 8" preserveAspectRatio="none" aria-hidden="true">'
            f'<rect width="100" height="8" class="room"/><rect width="{ends[1]:.3f}" height="8" class="open"/>'
            f'<rect width="{ends[0]:.3f}" height="8" fill="{looks[plan.planner].colour}"/></svg>'
        )
        yield (
            f'<tr><th scope="row">{escape(plan.planner + mark)}</th>'
            f'<td data-column="worst-case value{unit}" data-lower="{low!r}" data-upper="{high!r}">'
            f'{bracket_text(low, high)}</td><td data-column="share of the best possible">'
            f"{escape(share_text(low, report.upper))}</td><td>{bar}</td></tr>"
        )
    yield "</tbody></table></div>"
    for text in (*omitted_texts(report), *report.remarks):
        yield f"<p>{escape(text[0].upper() + text[1:])}.</p>"
    yield "</section>"


def _trust_section(report: Findings) -> Iterator[str]:
    yield '<section aria-labelledby="trust"><h2 id="trust">How far to trust that</h2>'
    yield f"<p>Certificate: {escape(verdict_text(report.certificate))}."
    if report.certificate.certificate is not None:
        yield " Check it again, in a program that shares nothing with the search: "
        yield "<code>ratt-opt verify certificate.json</code>."
    best = escape(_with_unit(bracket_text(report.optimum.lower, report.upper), report))
    yield f"</p><p>Best possible: {best}; the search for it stopped because: {report.optimum.stop.value}.</p>"
    if "guarantees" in report.omitted:
        yield "</section>"
        return
    rows = [(name, down(float(g), 6), "; ".join(g.hypotheses), g.proof) for name, g in report.guarantees.items()]
    rows += [(name, "none", f"does not apply: {why}", "") for name, why in report.inapplicable.items()]
    if said := guarantee_text(report):
        yield f"<p>Guarantees: {escape(said)}.</p>"
    yield f'<div class="wide">{html_table("Guaranteed before planning", GUARANTEE_COLUMNS, rows)}</div>'
    yield "</section>"


def _plan_section(report: Findings) -> Iterator[str]:
    rows = [[f"{x:.4g}" if isinstance(x, float) else x for x in row] for row in plan_rows(report)]
    yield '<section aria-labelledby="plan"><h2 id="plan">The plan</h2><div class="wide">'
    yield html_table("Positions are those after the control", PLAN_HEADS, rows)
    yield "</div></section>"
