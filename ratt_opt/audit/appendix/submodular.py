"""The submodular proof: Pattern 2', Distribution 1'.

Source: ratt.tex, appendix, eq:sub_p2vk_1 to eq:sub_p2d1v2_9.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from ratt_opt.audit.appendix.entry import Case, Chain, Line
from ratt_opt.audit.appendix.pattern1 import attacks_on, numbered, readings, size_text, team_of
from ratt_opt.audit.appendix.pattern2 import few_baits_chain
from ratt_opt.audit.appendix.roles import Team, optimum
from ratt_opt.audit.engine.claim import FunctionClass, Linear
from ratt_opt.audit.engine.polynomial import ONE, Polynomial, T, constant

if TYPE_CHECKING:
    from collections.abc import Iterator

__all__ = ["chains"]

KIND = FunctionClass.CURVATURE
ROLES = "f normalised, non-decreasing, submodular, curvature <= k; baits and greedy robots as RATT chooses them"
ONE_PLUS_K = constant(2) - T
"""``1 + k`` with ``t = 1 - k``."""


def chains() -> tuple[Chain, ...]:
    """The chains of the submodular proof, in the paper's order."""
    return (
        Chain(name="sub_p2vk", kind=KIND, hypotheses=ROLES, cases=tuple(_all_bait())),
        Chain(name="sub_p2d1v1", kind=KIND, hypotheses=ROLES, cases=tuple(_many_baits())),
        few_baits_chain("sub_p2d1v2", KIND, ROLES),
    )


def _all_bait() -> Iterator[Case]:
    for survivors, attacked in ((1, 0), (1, 1), (2, 0), (2, 1), (3, 0), (4, 0)):
        team = team_of(survivors + attacked, 0)
        left = team.bait[:survivors]
        rows = (
            ("=", team.chosen(left), "f(bait on the survivors)"),
            (">=", team.singles(left) * T, "(1-k) sum of f(bait_i)"),
            ("=", team.singles(map(optimum, left)) * T, "(1-k) sum of f(u*_i)"),
            (">=", team.compared(left) * T, "(1-k) f(u*)"),
        )
        yield numbered("sub_p2vk", team, rows, size_text(team, team.bait[survivors:]))


def _many_baits() -> Iterator[Case]:
    """V1 holds b1, b2 (alpha_s = 1, |V2g| = 1) and g1; x1 is the greedy robot in V2."""
    for order in (("g1", "x1"), ("x1", "g1")):
        team = Team(("b1", "b2"), order)
        for attacked in attacks_on(("b1", "b2", "g1"), 1):
            yield _case(team, attacked)


def _case(team: Team, attacked: tuple[str, ...]) -> Case:
    group = ("b1", "b2", "g1")
    left = tuple(r for r in group if r not in attacked)
    first = [r for r in ("b1",) if r not in attacked]
    kept = [r for r in ("g1",) if r not in attacked]
    hit = [r for r in ("g1",) if r in attacked]
    greedy = team.greedy
    bound = T, ONE_PLUS_K
    rows: tuple[tuple[str, Linear, Polynomial, str], ...] = (
        ("=", team.chosen(left), ONE, "f(u) on V1b\\A* and V1g\\A*"),
        (">=", team.singles(left) * T, ONE, "(1-k) sum of f(u_i)"),
        ("=", team.singles([*first, "b2", *kept]) * T, ONE, "(1-k) [V1b2\\A* + V1b1 + V1g\\A*]"),
        (">=", team.singles([*first, "x1", *kept]) * T, ONE, "(1-k) [V1b2\\A* + V2g + V1g\\A*]"),
        ("=", team.singles([*first, "x1", *kept]) * T, ONE, "(1-k) [V1b2\\A* + Vg\\A*]"),
        (">=", (team.singles(hit) + team.singles(["x1", *kept])) * T, ONE, "(1-k) [attacked of Vg + the rest of Vg]"),
        ("=", team.singles(greedy) * T, ONE, "(1-k) sum over Vg of f(u_i)"),
        (">=", team.chosen(greedy) * T, ONE, "(1-k) f(u on Vg)"),
        (">=", team.compared(greedy) * bound[0], bound[1], "(1-k)/(1+k) f(u* on Vg)"),
        (">=", team.compared(left) * bound[0], bound[1], "(1-k)/(1+k) f(u* on V1\\A*)"),
    )
    lines = [
        Line(label=f"sub_p2d1v1_{i + 1}", relation=relation, expression=e, denominator=d, statement=text)
        for i, (relation, e, d, text) in enumerate(rows)
    ]
    last = lines[-1]
    lines[-1] = Line(
        label=last.label,
        relation=last.relation,
        expression=last.expression,
        denominator=last.denominator,
        statement=last.statement,
        readings=readings(team, group, attacked),
    )
    text = f"{size_text(team, attacked)}; x1 in V2, chosen {'after' if greedy[0] == 'g1' else 'before'} g1"
    return Case(size=text, team=team, start=team.chosen(left), lines=tuple(lines))
