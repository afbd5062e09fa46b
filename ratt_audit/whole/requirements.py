"""Requirements that make an attack a worst one and a plan optimal, as choices between linear inequalities.

Let ``opt`` be a number. The compared plan is optimal with worst case ``opt`` if (1) every outcome leaves it a group
worth at least ``opt``, and (2) every other plan has an outcome that leaves all its groups at most ``opt``. A* is a
worst attack on a plan if (3) every outcome leaves that plan a group worth at least each group that A* leaves. (1) and
(3) choose a group for each outcome, (2) an outcome for each plan. A robot whose two elements are worth the same stands
for one that both plans give the same element, so two elements a robot are enough.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import product
from typing import TYPE_CHECKING

from ratt_audit.appendix.roles import Side, optimum
from ratt_audit.engine.claim import Inequality, Linear

if TYPE_CHECKING:
    from collections.abc import Iterator

    from ratt_audit.appendix.roles import Robots
    from ratt_audit.whole.teams import WholeTeam

__all__ = ["OPT", "Requirement", "requirements"]

OPT = Linear.of("opt")
"""Worst-case value of the optimal plan."""


@dataclass(frozen=True, slots=True)
class Requirement:
    """Alternatives of which at least one holds, each a conjunction of inequalities."""

    alternatives: tuple[tuple[Inequality, ...], ...]


def requirements(whole: WholeTeam, worst_for: Side) -> Iterator[Requirement]:
    """Yield all requirements: A* is a worst attack on ``worst_for``, and the compared plan is optimal."""
    outcomes = whole.outcomes()
    for outcome in outcomes:
        yield Requirement(tuple(_reaches_all(whole, worst_for, group) for group in outcome))
    for outcome in outcomes:
        yield Requirement(tuple((_at_least_opt(whole, group),) for group in outcome))
    for plan in _plans(whole):
        yield Requirement(tuple(_at_most_opt(whole, plan, outcome) for outcome in outcomes))


def _reaches_all(whole: WholeTeam, side: Side, group: Robots) -> tuple[Inequality, ...]:
    """The group of another outcome is worth at least every group that A* leaves."""
    reached = whole.team.value(side, group)
    return tuple(
        Inequality(f"{{{','.join(group)}}} of {side.value} reaches {{{','.join(left)}}} under A*", reached - below)
        for left in whole.left
        for below in (whole.team.value(side, left),)
        if set(left) - set(group)
    )


def _at_least_opt(whole: WholeTeam, group: Robots) -> Inequality:
    return Inequality(f"the optimum on {{{','.join(group)}}} reaches opt", whole.team.compared(group) - OPT)


def _plans(whole: WholeTeam) -> Iterator[dict[str, str]]:
    """Yield all plans as robot -> element, RATT's first, without the compared plan itself."""
    robots = whole.team.robots
    for choice in product((False, True), repeat=len(robots)):
        if not all(choice):
            yield {
                robot: optimum(robot) if is_compared else robot
                for robot, is_compared in zip(robots, choice, strict=True)
            }


def _at_most_opt(whole: WholeTeam, plan: dict[str, str], outcome: tuple[Robots, ...]) -> tuple[Inequality, ...]:
    values = (whole.team.f(plan[robot] for robot in group) for group in outcome)
    return tuple(Inequality(f"plan {','.join(plan.values())} keeps at most opt", OPT - value) for value in values)
