"""The submodular proof: Pattern 2', Distribution 1'.

Source: ratt.tex, appendix, eq:sub_p2vk_1 to eq:sub_p2d1v2_9.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from ratt_opt.audit.appendix.bounds import ONE_PLUS_K
from ratt_opt.audit.appendix.chain import Case, Chain, Line
from ratt_opt.audit.appendix.pattern2 import beside_v2, few_baits_chain, x1_text
from ratt_opt.audit.appendix.roles import Team, attacks_on, optimum, team_of, whose_worst
from ratt_opt.audit.engine.claim import FunctionClass
from ratt_opt.audit.engine.polynomial import T

if TYPE_CHECKING:
    from collections.abc import Iterator

    from ratt_opt.audit.appendix.roles import Robots

__all__ = ["GROUP", "chains"]

KIND = FunctionClass.CURVATURE
ROLES = "f normalised, non-decreasing, submodular, curvature <= k; baits and greedy robots as RATT chooses them"
GROUP = ("b1", "b2", "g1")
"""V1 with alpha_s = 1 and |V2g| = 1; x1 is the greedy robot in V2."""


def chains() -> tuple[Chain, ...]:
    """The chains of the submodular proof, in the paper's order."""
    many = tuple(_case(team, attacked) for team in beside_v2(("b1", "b2")) for attacked in attacks_on(GROUP, 1))
    return (
        Chain(name="sub_p2vk", function_class=KIND, hypotheses=ROLES, cases=tuple(_all_bait())),
        Chain(name="sub_p2d1v1", function_class=KIND, hypotheses=ROLES, cases=many),
        few_baits_chain("sub_p2d1v2", KIND, ROLES),
    )


def _all_bait() -> Iterator[Case]:
    for survivors, attacked in ((1, 0), (1, 1), (2, 0), (2, 1), (3, 0), (4, 0)):
        team = team_of(survivors + attacked, 0)
        left = team.bait[:survivors]
        lines = (
            Line("=", team.chosen(left), "f(bait on the survivors)"),
            Line(">=", team.singles(left) * T, "(1-k) sum of f(bait_i)"),
            Line("=", team.singles(map(optimum, left)) * T, "(1-k) sum of f(u*_i)"),
            Line(">=", team.compared(left) * T, "(1-k) f(u*)"),
        )
        yield Case(size=team.text(team.bait[survivors:]), team=team, start=team.chosen(left), lines=lines)


def _case(team: Team, attacked: Robots) -> Case:
    left = tuple(r for r in GROUP if r not in attacked)
    first = [r for r in ("b1",) if r not in attacked]
    kept, hit = [r for r in ("g1",) if r not in attacked], [r for r in ("g1",) if r in attacked]
    greedy = team.greedy
    split, swapped = team.singles([*first, "b2", *kept]), team.singles([*first, "x1", *kept])
    lines = (
        Line("=", team.chosen(left), "f(u) on V1b\\A* and V1g\\A*"),
        Line(">=", team.singles(left) * T, "(1-k) sum of f(u_i)"),
        Line("=", split * T, "(1-k) [V1b2\\A* + V1b1 + V1g\\A*]"),
        Line(">=", swapped * T, "(1-k) [V1b2\\A* + V2g + V1g\\A*]"),
        Line("=", swapped * T, "(1-k) [V1b2\\A* + Vg\\A*]"),
        Line(">=", (team.singles(hit) + team.singles(["x1", *kept])) * T, "(1-k) [attacked of Vg + the rest of Vg]"),
        Line("=", team.singles(greedy) * T, "(1-k) sum over Vg of f(u_i)"),
        Line(">=", team.chosen(greedy) * T, "(1-k) f(u on Vg)"),
        Line(">=", team.compared(greedy) * T, "(1-k)/(1+k) f(u* on Vg)", ONE_PLUS_K),
        Line(
            ">=",
            team.compared(left) * T,
            "(1-k)/(1+k) f(u* on V1\\A*)",
            ONE_PLUS_K,
            readings=whose_worst(team, GROUP, attacked),
        ),
    )
    return Case(size=x1_text(team, attacked), team=team, start=team.chosen(left), lines=lines)
