"""Pattern 1 of the non-decreasing proof: one group holds all greedy robots and alpha_s baits.

Source: ratt.tex, appendix, eq:nd_p1d1v1_1 to eq:nd_p1.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from ratt_opt.audit.appendix.bounds import T2, T3
from ratt_opt.audit.appendix.chain import Case, Chain, Line
from ratt_opt.audit.appendix.roles import Team, attacks_on, optimum, team_of, whose_worst
from ratt_opt.audit.engine.claim import FunctionClass
from ratt_opt.audit.engine.polynomial import T

if TYPE_CHECKING:
    from collections.abc import Iterator

    from ratt_opt.audit.appendix.roles import Robots

__all__ = ["ROLES", "chains"]

ROLES = "f normalised, non-decreasing, total curvature <= c; baits and greedy robots as RATT chooses them"


def chains() -> tuple[Chain, ...]:
    """The chains of Pattern 1, in the paper's order."""
    cases = {
        "nd_p1d1v1": _all_attacked(),
        "nd_p1d1vk": _all_bait(attacked=0),
        "nd_p1d2v1": _none_attacked(),
        "nd_p1d2vk": _all_bait(attacked=1),
        "nd_p1d3v1": _part_attacked(),
        "nd_p1d3vk": _other_groups(),
    }
    kind = FunctionClass.TOTAL_CURVATURE
    return tuple(
        Chain(name=name, function_class=kind, hypotheses=ROLES, cases=tuple(case)) for name, case in cases.items()
    )


def _all_attacked() -> Iterator[Case]:
    """Distribution 1: all alpha_s blinded robots are in V1."""
    for n_bait, n_greedy in ((1, 1), (1, 2), (2, 1), (2, 2), (1, 3)):
        team = team_of(n_bait, n_greedy)
        for attacked in attacks_on(team.robots, n_bait):
            yield _case_d1(team, attacked)


def _case_d1(team: Team, attacked: Robots) -> Case:
    greedy = team.greedy
    left = [robot for robot in team.robots if robot not in attacked]
    hit, kept = [g for g in greedy if g in attacked], [g for g in greedy if g not in attacked]
    split = team.singles(r for r in left if r in team.bait) + team.singles(kept)
    lines = (
        Line("=", team.chosen(left), "f(u) on V1b\\A* and V1g\\A*"),
        Line(">=", team.singles(left) * T, "(1-c) sum of f(u_i)"),
        Line("=", split * T, "(1-c) [sum over surviving baits + sum over surviving greedy robots]"),
        Line(
            ">=",
            (team.singles(hit) + team.singles(kept)) * T,
            "(1-c) [attacked greedy robots' f(u_i) + surviving ones']",
        ),
        Line("=", team.singles(greedy) * T, "(1-c) sum over V1g"),
        Line(">=", team.chosen(greedy) * T2, "(1-c)^2 f(u on V1g)"),
        Line(">=", team.compared(greedy) * T3, "(1-c)^3 f(u* on V1g)"),
        Line(
            ">=", team.compared(left) * T3, "(1-c)^3 f(u* on V1\\A*)", readings=whose_worst(team, team.robots, attacked)
        ),
    )
    return Case(size=team.text(attacked), team=team, start=team.chosen(left), lines=lines)


def _all_bait(*, attacked: int) -> Iterator[Case]:
    """A group of baits only, of which the last ``attacked`` are blinded."""
    for survivors in range(1, 5 - attacked):
        team = team_of(survivors + attacked, 0)
        left = team.bait[:survivors]
        lines = [
            Line("=", team.chosen(left), "f(bait on the survivors)"),
            Line(">=", team.singles(left) * T, "(1-c) sum of f(bait_i)"),
            Line("=", team.singles(map(optimum, left)) * T, "(1-c) sum of f(u*_i)"),
            Line(">=", team.compared(left) * T2, "(1-c)^2 f(u*)"),
        ]
        if not attacked:
            lines.append(Line("=", team.compared(left) * T2, "the same (A* empty)"))
        yield Case(size=team.text(team.bait[survivors:]), team=team, start=team.chosen(left), lines=tuple(lines))


def _other_groups() -> Iterator[Case]:
    """Distribution 3, other groups: the single line that quotes Distribution 2."""
    for survivors, attacked in ((1, 1), (2, 1), (2, 2), (3, 1)):
        team = team_of(survivors + attacked, 0)
        left = team.bait[:survivors]
        line = Line(">=", team.compared(left) * T2, "(1-c)^2 f(u*)")
        yield Case(size=team.text(team.bait[survivors:]), team=team, start=team.chosen(left), lines=(line,))


def _none_attacked() -> Iterator[Case]:
    """Distribution 2: all blinded robots are elsewhere."""
    for n_bait, n_greedy in ((1, 1), (1, 2), (2, 1), (2, 2)):
        team = team_of(n_bait, n_greedy)
        b, g, everyone = team.bait, team.greedy, team.robots
        swapped = team.singles(map(optimum, b)) + team.singles(g)
        both = team.compared(b) + team.compared(g)
        cubed = team.compared(everyone) * T3
        lines = (
            Line("=", team.chosen(everyone), "f(u on V1)"),
            Line(">=", team.singles(everyone) * T, "(1-c) sum of f(u_i)"),
            Line("=", (team.singles(b) + team.singles(g)) * T, "(1-c) [sum over baits + sum over greedy robots]"),
            Line("=", swapped * T, "(1-c) [sum of f(u*_i) over baits + sum over greedy]"),
            Line(">=", (team.compared(b) + team.chosen(g)) * T2, "(1-c)^2 [f(u* on V1b) + f(u on V1g)]"),
            Line(">=", team.compared(b) * T2 + team.compared(g) * T3, "(1-c)^2 f(u* on V1b) + (1-c)^3 f(u* on V1g)"),
            Line(">=", both * T3, "(1-c)^3 [f(u* on V1b) + f(u* on V1g)]"),
            Line(">=", cubed, "(1-c)^3 f(u* on V1): subadditivity of a non-decreasing f"),
            Line("=", cubed, "the same (A* empty)"),
        )
        yield Case(size=team.text(), team=team, start=team.chosen(everyone), lines=lines)


def _part_attacked() -> Iterator[Case]:
    """Distribution 3: alpha_s = 2, and one of them in V1."""
    for n_greedy in (1, 2):
        team = team_of(2, n_greedy)
        for attacked in attacks_on(team.robots, 1):
            yield _case_d3(team, attacked)


def _case_d3(team: Team, attacked: Robots) -> Case:
    """V1b1 is the last bait, which is never blinded here."""
    safe, rest = team.bait[-1:], team.bait[:-1]
    left = tuple(r for r in team.robots if r not in attacked)
    kept = [r for r in rest if r not in attacked]
    greedy_left = [g for g in team.greedy if g not in attacked]
    split = team.singles(safe) + team.singles(kept) + team.singles(greedy_left)
    a, b = team.compared(safe), team.compared(team.greedy)
    whole = team.compared((*safe, *team.greedy))
    lines = (
        Line("=", team.chosen(left), "f(u) on V1b\\A* and V1g\\A*"),
        Line(">=", team.singles(left) * T, "(1-c) sum of f(u_i)"),
        Line("=", split * T, "(1-c) [sum over V1b1 + sum over V1b2\\A* + sum over V1g\\A*]"),
        Line(">=", a * T2 + b * T3, "(1-c)^2 f(u* on V1b1) + (1-c)^3 f(u* on V1g)"),
        Line(">=", (a + b) * T3, "(1-c)^3 [f(u* on V1b1) + f(u* on V1g)]"),
        Line(">=", whole * T3, "(1-c)^3 f(u* on V1b1 and V1g): subadditivity of a non-decreasing f"),
        Line(
            ">=", team.compared(left) * T3, "(1-c)^3 f(u* on V1\\A*)", readings=whose_worst(team, team.robots, attacked)
        ),
    )
    return Case(size=team.text(attacked), team=team, start=team.chosen(left), lines=lines)
