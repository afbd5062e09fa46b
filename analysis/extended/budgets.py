"""Price of robustness and break-even point: RATT planned for one attack, then attacked more and more.

``python -m analysis.extended.budgets --trials 200 --out DIR``
"""

from __future__ import annotations

import sys
from dataclasses import replace
from typing import TYPE_CHECKING

from ratt_opt.attack.exact import worst_case_attack
from ratt_opt.report.palette import PLANNERS, look_of
from ratt_opt.solvers.ratt import greedy, ratt
from ratt_opt.studies.cases import Case, Cell, Seeds
from ratt_opt.studies.command import Entry, main
from ratt_opt.studies.instance import Instance
from ratt_opt.studies.plots import bands, new_figure, save
from ratt_opt.studies.statistics import column, estimate, select
from ratt_opt.studies.study import Study

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence
    from pathlib import Path

    from ratt_opt.studies.statistics import Estimate

LEVELS = 10
"""Actual attacks blind 0, 1, ..., 9 robots and cut links in proportion to the budget planned for."""
STUDY = Study(
    name="budgets",
    cases=tuple(Case(n_robots=10, n_targets=15, alpha_s=s, alpha_c=c) for s, c in ((3, 11), (5, 15), (6, 22))),
    measure="analysis.extended.budgets:measure",
)
CLAIRVOYANT = "RATT that knows the attack"


def measure(study: Study, case: Case, seeds: Seeds) -> dict[str, Cell]:
    """Return ``planner/level/trace`` [m^2 per target] of three planners under the exact attack of every level."""
    del study
    planned = Instance.of(case, seeds)
    fixed = {"ratt": ratt(planned.problem).elements, "greedy": greedy(planned.problem).elements}
    row: dict[str, Cell] = {"scenario": planned.digest}
    for level in range(LEVELS):
        links = min(round(case.alpha_c * level / case.alpha_s), 45)
        actual = Instance.of(replace(case, alpha_s=level, alpha_c=links), seeds)
        plans = fixed | {"clairvoyant": ratt(actual.problem).elements}
        for planner, plan in plans.items():
            attack = worst_case_attack(actual.problem, plan).attack
            row[f"{planner}/{level}/trace"] = actual.trace(plan, attack)
    return row


def excess(rows: Sequence[Mapping[str, str]], planner: str) -> list[Estimate]:
    """Trace of a planner over Greedy's, less 1 [%], per level of attack; ``rows`` are those of one case."""
    shares = (column(rows, f"{planner}/{k}/trace") / column(rows, f"greedy/{k}/trace") for k in range(LEVELS))
    return [estimate(100 * (share - 1)) for share in shares]


def break_even(rows: Sequence[Mapping[str, str]]) -> str:
    """Return the fewest blinded robots from which on RATT's mean is below Greedy's, and the first sure level."""
    curve = excess(rows, "ratt")
    above = [k for k, e in enumerate(curve) if e.mean >= 0]
    start = above[-1] + 1 if above else 0
    sure = next((k for k, e in enumerate(curve) if e.high < 0), None)
    if start == LEVELS:
        return "never breaks even"
    return f"breaks even at {start} blinded ({'never sure' if sure is None else f'sure at {sure}'})"


def draw(rows: Sequence[Mapping[str, str]], folder: Path) -> None:
    """One panel per budget planned for: RATT's trace over Greedy's, per cent, against the attack that comes."""
    figure = new_figure(11, 4.3)
    for axes, case in zip(figure.subplots(1, len(STUDY.cases), sharey=True), STUDY.cases, strict=True):
        kept = select(rows, case=case.name)
        curve = excess(kept, "ratt")
        bands(axes, range(LEVELS), curve, look=PLANNERS["ratt"], label="ratt")
        bands(
            axes, range(LEVELS), excess(kept, "clairvoyant"), look=look_of(CLAIRVOYANT), label=CLAIRVOYANT, dashed=True
        )
        axes.axhline(0, color=PLANNERS["greedy"].colour, linestyle="--", linewidth=1.4, label="greedy")
        axes.axvline(case.alpha_s, color="black", linestyle=":", linewidth=1, label="attack planned for")
        title = f"planned for $\\alpha_s$={case.alpha_s}, $\\alpha_c$={case.alpha_c}"
        price = f"price without attack {curve[0].mean:+.1f} %"
        axes.set_title(f"{title}\n{price}\n{break_even(kept)}", fontsize="medium")
        axes.set_xlabel("robots blinded (links cut in proportion)")
    figure.axes[0].set_ylabel("trace of covariance against Greedy [%]\n(lower is better)")
    handles, labels = figure.axes[0].get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside upper center", ncols=4, frameon=False)
    note = f"N=10, M=15, exact attack; mean of {len(kept)} paired trials with 95 % confidence band"
    figure.supxlabel(note, fontsize="small")
    save(figure, folder, "budgets")


ENTRY = Entry(STUDY, draw)

if __name__ == "__main__":
    sys.exit(main("Price of robustness and break-even point.", [ENTRY], trials=200))
