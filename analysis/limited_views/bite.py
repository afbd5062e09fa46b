"""Choice of the study's main cell: the kind of team in which both attacks bite.

In the first step of 60 missions two robots are blinded, or four links cut, by exact attacks on RATT's plan. An attack
*bites* if the worst-case value is at most nine tenths of the unattacked value on average. The main cell is the cell
with the longest links in which both bite, and among these the one with the widest reach: the team nearest to the easy
one, in which every robot reaches every other and sees any distance.
"""

from collections.abc import Mapping, Sequence
from pathlib import Path

from analysis.limited_views.flights import COMPLETE, UNLIMITED, case_of, scenario_of
from ratt_opt.attack.exact import worst_case_attack
from ratt_opt.problem import Problem
from ratt_opt.solvers.ratt import ratt
from ratt_opt.studies.cases import Case, Cell, Seeds
from ratt_opt.studies.command import Entry
from ratt_opt.studies.statistics import Estimate, column, estimate, select
from ratt_opt.studies.study import Study

__all__ = ["BITES", "ENTRY", "LINKS", "REACHES", "STUDY", "chosen", "measured", "shares"]

BITES = 0.1
"""Part of a plan's value that an attack must cost."""
LINKS = (COMPLETE, 60, 45, 30)
"""Networks from many links to few: complete, or the range of a disk network [m]."""
REACHES = (UNLIMITED, 60, 40, 30)
"""Reaches of a camera, widest first [m]."""


def measured(_: Study, case: Case, seeds: Seeds) -> dict[str, Cell]:
    """Worst-case value of RATT's plan over its unattacked value: blinding alone, cutting alone, both [%]."""
    problem = scenario_of(case, seeds).problem(case.objective)
    plan = ratt(problem).elements
    whole = problem.objective(plan)
    budgets = {
        "blinded": (problem.alpha_s, 0),
        "cut": (0, problem.alpha_c),
        "both": (problem.alpha_s, problem.alpha_c),
    }
    row: dict[str, Cell] = {}
    for name, (alpha_s, alpha_c) in budgets.items():
        attacked = Problem(problem.objective, problem.robot, problem.graph, alpha_s, alpha_c)
        row[f"kept/{name}"] = 100 * worst_case_attack(attacked, plan).lower / whole
    return row


def _nothing(rows: list[dict[str, str]], folder: Path) -> None:
    """Leave the rows to the page."""


STUDY = Study(
    name="limited_views_bite",
    cases=tuple(case_of(links=links, reach=reach) for links in LINKS for reach in REACHES),
    measure=measured,
)
ENTRY = Entry(STUDY, _nothing)


def shares(rows: Sequence[Mapping[str, str]], case: Case) -> dict[str, Estimate]:
    """Mean shares of a cell [%]: ``blinded``, ``cut``, ``both``."""
    kept = select(rows, case=case.name)
    return {name: estimate(column(kept, f"kept/{name}")) for name in ("blinded", "cut", "both")}


def chosen(rows: Sequence[Mapping[str, str]]) -> Case:
    """Return the first cell, in the order of ``LINKS`` and then of ``REACHES``, in which both attacks bite."""
    return next(
        case
        for case in STUDY.cases
        if all(shares(rows, case)[name].mean <= 100 * (1 - BITES) for name in ("blinded", "cut"))
    )
