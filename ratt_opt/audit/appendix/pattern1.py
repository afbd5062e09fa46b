"""Pattern 1 of the non-decreasing proof: one group holds all greedy robots and alpha_s baits.

Source: ratt.tex, appendix, eq:nd_p1d1v1_1 to eq:nd_p1.
"""

from __future__ import annotations

from itertools import combinations
from typing import TYPE_CHECKING

from ratt_opt.audit.appendix.entry import Case, Chain, Line
from ratt_opt.audit.appendix.roles import Team, optimum, worst_for
from ratt_opt.audit.engine.claim import FunctionClass
from ratt_opt.audit.engine.polynomial import T

if TYPE_CHECKING:
    from collections.abc import Iterator

    from ratt_opt.audit.engine.claim import Inequality, Linear

__all__ = ["attacks_on", "chains", "numbered", "readings", "size_text", "team_of"]

T2, T3 = T * T, T * T * T
ND = FunctionClass.TOTAL_CURVATURE
ROLES = "f normalised, non-decreasing, total curvature <= c; baits and greedy robots as RATT chooses them"
PLAN_WORST = "A* hurts RATT's plan most in its group"
OPTIMUM_WORST = "A* hurts the optimum most in its group"
ANY_ATTACK = "A* worst for the team only, so any attack on a group that is not the best"


def team_of(n_bait: int, n_greedy: int) -> Team:
    """Baits b1.. and greedy robots g1.. in greedy order."""
    return Team(tuple(f"b{i + 1}" for i in range(n_bait)), tuple(f"g{i + 1}" for i in range(n_greedy)))


def attacks_on(group: tuple[str, ...], count: int) -> Iterator[tuple[str, ...]]:
    """Attacks on ``count`` robots of a group, one per symmetry class: baits are alike, the first are attacked first."""
    baits = [robot for robot in group if robot.startswith("b")]
    for attacked in combinations(group, count):
        used = [robot for robot in attacked if robot.startswith("b")]
        if used == baits[: len(used)]:
            yield attacked


def readings(team: Team, group: tuple[str, ...], attacked: tuple[str, ...]) -> dict[str, tuple[Inequality, ...]]:
    """Whose worst attack A* is: the plan's in the group, the optimum's in the group, or the team's."""
    return {
        PLAN_WORST: worst_for(team, group, attacked, plan="chosen"),
        OPTIMUM_WORST: worst_for(team, group, attacked, plan="compared"),
        ANY_ATTACK: (),
    }


def chains() -> tuple[Chain, ...]:
    """The chains of Pattern 1, in the paper's order."""
    return (
        Chain(name="nd_p1d1v1", kind=ND, hypotheses=ROLES, cases=tuple(_all_attacked())),
        Chain(name="nd_p1d1vk", kind=ND, hypotheses=ROLES, cases=tuple(_all_bait("nd_p1d1vk", attacked=0))),
        Chain(name="nd_p1d2v1", kind=ND, hypotheses=ROLES, cases=tuple(_none_attacked())),
        Chain(name="nd_p1d2vk", kind=ND, hypotheses=ROLES, cases=tuple(_all_bait("nd_p1d2vk", attacked=1))),
        Chain(name="nd_p1d3v1", kind=ND, hypotheses=ROLES, cases=tuple(_part_attacked())),
        Chain(name="nd_p1d3vk", kind=ND, hypotheses=ROLES, cases=tuple(_other_groups())),
    )


def _all_attacked() -> Iterator[Case]:
    for n_bait, n_greedy in ((1, 1), (1, 2), (2, 1), (2, 2), (1, 3)):
        team = team_of(n_bait, n_greedy)
        for attacked in attacks_on(team.robots, n_bait):
            yield _case_d1(team, attacked)


def _case_d1(team: Team, attacked: tuple[str, ...]) -> Case:
    greedy = team.greedy
    left = [robot for robot in team.robots if robot not in attacked]
    hit = [g for g in greedy if g in attacked]
    kept = [g for g in greedy if g not in attacked]
    worst = readings(team, team.robots, attacked)
    label = "nd_p1d1v1"
    lines = (
        Line(label=f"{label}_1", relation="=", expression=team.chosen(left), statement="f(u) on V1b\\A* and V1g\\A*"),
        Line(label=f"{label}_2", relation=">=", expression=team.singles(left) * T, statement="(1-c) sum of f(u_i)"),
        Line(
            label=f"{label}_3",
            relation="=",
            expression=(team.singles(r for r in left if r in team.bait) + team.singles(kept)) * T,
            statement="(1-c) [sum over surviving baits + sum over surviving greedy robots]",
        ),
        Line(
            label=f"{label}_4",
            relation=">=",
            expression=(team.singles(hit) + team.singles(kept)) * T,
            statement="(1-c) [attacked greedy robots' f(u_i) + surviving ones']",
        ),
        Line(label=f"{label}_5", relation="=", expression=team.singles(greedy) * T, statement="(1-c) sum over V1g"),
        Line(label=f"{label}_6", relation=">=", expression=team.chosen(greedy) * T2, statement="(1-c)^2 f(u on V1g)"),
        Line(
            label=f"{label}_7", relation=">=", expression=team.compared(greedy) * T3, statement="(1-c)^3 f(u* on V1g)"
        ),
        Line(
            label=f"{label}_8",
            relation=">=",
            expression=team.compared(left) * T3,
            statement="(1-c)^3 f(u* on V1\\A*)",
            readings=worst,
        ),
    )
    return Case(size=size_text(team, attacked), team=team, start=team.chosen(left), lines=lines)


def size_text(team: Team, attacked: tuple[str, ...]) -> str:
    """Roles and attack of a case in words."""
    blinded = ",".join(attacked) or "none"
    return f"{len(team.bait)} bait, {len(team.greedy)} greedy, blinded: {blinded}"


def _all_bait(label: str, *, attacked: int) -> Iterator[Case]:
    """A group of baits only, of which the last ``attacked`` are blinded."""
    for survivors in (1, 2, 3, 4):
        team = team_of(survivors + attacked, 0)
        left = team.bait[:survivors]
        lines = [
            Line(label=f"{label}_1", relation="=", expression=team.chosen(left), statement="f(bait on the survivors)"),
            Line(
                label=f"{label}_2", relation=">=", expression=team.singles(left) * T, statement="(1-c) sum of f(bait_i)"
            ),
            Line(
                label=f"{label}_3",
                relation="=",
                expression=team.singles(map(optimum, left)) * T,
                statement="(1-c) sum of f(u*_i)",
            ),
            Line(label=f"{label}_4", relation=">=", expression=team.compared(left) * T2, statement="(1-c)^2 f(u*)"),
        ]
        if label == "nd_p1d1vk":
            lines.append(
                Line(
                    label=f"{label}_5",
                    relation="=",
                    expression=team.compared(left) * T2,
                    statement="the same (A* empty)",
                )
            )
        if survivors + attacked <= 4:
            yield Case(
                size=size_text(team, team.bait[survivors:]), team=team, start=team.chosen(left), lines=tuple(lines)
            )


def _other_groups() -> Iterator[Case]:
    """Distribution 3, other groups: the single line that quotes Distribution 2."""
    for survivors, attacked in ((1, 1), (2, 1), (2, 2), (3, 1)):
        team = team_of(survivors + attacked, 0)
        left = team.bait[:survivors]
        line = Line(label="nd_p1d3vk", relation=">=", expression=team.compared(left) * T2, statement="(1-c)^2 f(u*)")
        size = size_text(team, team.bait[survivors:])
        yield Case(size=size, team=team, start=team.chosen(left), lines=(line,))


def _none_attacked() -> Iterator[Case]:
    for n_bait, n_greedy in ((1, 1), (1, 2), (2, 1), (2, 2)):
        team = team_of(n_bait, n_greedy)
        yield _case_d2(team)


def _case_d2(team: Team) -> Case:
    b, g, everyone = team.bait, team.greedy, team.robots
    label = "nd_p1d2v1"
    both = team.compared(b) + team.compared(g)
    rows = (
        ("=", team.chosen(everyone), "f(u on V1)"),
        (">=", team.singles(everyone) * T, "(1-c) sum of f(u_i)"),
        ("=", (team.singles(b) + team.singles(g)) * T, "(1-c) [sum over baits + sum over greedy robots]"),
        (
            "=",
            (team.singles(map(optimum, b)) + team.singles(g)) * T,
            "(1-c) [sum of f(u*_i) over baits + sum over greedy]",
        ),
        (">=", (team.compared(b) + team.chosen(g)) * T2, "(1-c)^2 [f(u* on V1b) + f(u on V1g)]"),
        (">=", team.compared(b) * T2 + team.compared(g) * T3, "(1-c)^2 f(u* on V1b) + (1-c)^3 f(u* on V1g)"),
        (">=", both * T3, "(1-c)^3 [f(u* on V1b) + f(u* on V1g)]"),
        (">=", team.compared(everyone) * T3, "(1-c)^3 f(u* on V1): subadditivity of a non-decreasing f"),
        ("=", team.compared(everyone) * T3, "the same (A* empty)"),
    )
    return numbered(label, team, rows, size_text(team, ()))


def numbered(label: str, team: Team, rows: tuple[tuple[str, Linear, str], ...], size: str) -> Case:
    """One case whose lines are ``label_1``, ``label_2``, ...; the chain starts at the first line."""
    lines = tuple(
        Line(label=f"{label}_{i + 1}", relation=relation, expression=expression, statement=statement)
        for i, (relation, expression, statement) in enumerate(rows)
    )
    return Case(size=size, team=team, start=lines[0].expression, lines=lines)


def _part_attacked() -> Iterator[Case]:
    team = team_of(2, 1)
    for attacked in attacks_on(team.robots, 1):
        yield _case_d3(team, attacked)
    team = team_of(2, 2)
    for attacked in attacks_on(team.robots, 1):
        yield _case_d3(team, attacked)


def _case_d3(team: Team, attacked: tuple[str, ...]) -> Case:
    """alpha_s = 2 and one blinded robot; V1b1 is the last bait, which is never blinded here."""
    safe, rest = team.bait[-1:], team.bait[:-1]
    left = tuple(r for r in team.robots if r not in attacked)
    outer = (*safe, *team.greedy)
    kept = [r for r in rest if r not in attacked]
    greedy_left = [g for g in team.greedy if g not in attacked]
    split = team.singles(safe) + team.singles(kept) + team.singles(greedy_left)
    rows = (
        ("=", team.chosen(left), "f(u) on V1b\\A* and V1g\\A*"),
        (">=", team.singles(left) * T, "(1-c) sum of f(u_i)"),
        ("=", split * T, "(1-c) [sum over V1b1 + sum over V1b2\\A* + sum over V1g\\A*]"),
        (
            ">=",
            team.compared(safe) * T2 + team.compared(team.greedy) * T3,
            "(1-c)^2 f(u* on V1b1) + (1-c)^3 f(u* on V1g)",
        ),
        (">=", (team.compared(safe) + team.compared(team.greedy)) * T3, "(1-c)^3 [f(u* on V1b1) + f(u* on V1g)]"),
        (">=", team.compared(outer) * T3, "(1-c)^3 f(u* on V1b1 and V1g): subadditivity of a non-decreasing f"),
        (">=", team.compared(left) * T3, "(1-c)^3 f(u* on V1\\A*)"),
    )
    case = numbered("nd_p1d3v1", team, rows, size_text(team, attacked))
    last = case.lines[-1]
    final = Line(
        label=last.label,
        relation=last.relation,
        expression=last.expression,
        statement=last.statement,
        readings=readings(team, team.robots, attacked),
    )
    return Case(size=case.size, team=team, start=case.start, lines=(*case.lines[:-1], final))
