"""Pattern 2: two groups hold the greedy robots; the chains for the group with few baits, V2.

The same chain serves both classes: total curvature (factor ``(1-c)^2``) and submodular
(factor ``1-k``), as the paper says.

Source: ratt.tex, appendix, eq:nd_p2d1v2_1 to _9 and eq:sub_p2d1v2_1 to _9.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from ratt_opt.audit.appendix.bounds import T2, T3
from ratt_opt.audit.appendix.chain import Case, Chain, Line
from ratt_opt.audit.appendix.pattern1 import ROLES
from ratt_opt.audit.appendix.roles import Team, optimum, own_best, team_of, whose_worst
from ratt_opt.audit.engine.claim import FunctionClass, Inequality
from ratt_opt.audit.engine.polynomial import T, constant

if TYPE_CHECKING:
    from collections.abc import Iterator

    from ratt_opt.audit.appendix.roles import Robots

__all__ = ["beside_v2", "chains", "few_baits_chain", "x1_text"]

FEW_BAITS = ((1, 1, 0, 2), (1, 1, 0, 3), (1, 1, 1, 2), (2, 1, 0, 3), (1, 2, 0, 3))
"""Baits and greedy robots of V2, greedy robots of V1 chosen before them, alpha_cs."""


def chains() -> tuple[Chain, ...]:
    """The chains of Pattern 2, in the paper's order; single lines are chains of one."""
    return (
        _single("nd_p2d1v1", _many_baits(alpha_s=1, attacked=1)),
        few_baits_chain("nd_p2d1v2", FunctionClass.TOTAL_CURVATURE, ROLES),
        _single("nd_p2d2v1", _many_baits(alpha_s=1, attacked=0)),
        _single("nd_p2d2v2", _few_baits_attacked()),
        _single("nd_p2d3v1", _many_baits(alpha_s=2, attacked=1)),
        _single("nd_p2d3v2", _few_baits_attacked()),
    )


def _single(name: str, cases: Iterator[Case]) -> Chain:
    kind = FunctionClass.TOTAL_CURVATURE
    return Chain(name=name, function_class=kind, hypotheses=ROLES, cases=tuple(cases))


def few_baits_chain(name: str, function_class: FunctionClass, hypotheses: str) -> Chain:
    """The chain for V2 (at least one bait, at least one greedy robot, none blinded), at several |V2| and alpha_cs."""
    cases = tuple(_few_baits(function_class, *size) for size in FEW_BAITS)
    return Chain(name=name, function_class=function_class, hypotheses=hypotheses, cases=cases)


def _few_baits(function_class: FunctionClass, n_bait: int, n_greedy: int, earlier: int, alpha_cs: int) -> Case:
    """Build one size; b1 is the best bait."""
    first = tuple(f"e{i + 1}" for i in range(earlier))
    bait, greedy = team_of(n_bait, n_greedy).bait, team_of(n_bait, n_greedy).greedy
    team = Team(bait, first + greedy, with_own_best=True, without_optimum=frozenset(first))
    group, best = bait + greedy, team.f(bait[:1])
    bests = team.singles([*bait, *map(own_best, greedy)]) * T
    size = constant(len(group))
    bound = team.compared(group) * (T2 if function_class is FunctionClass.TOTAL_CURVATURE else T)
    lines = (
        Line("=", team.chosen(group), "f(u on V2)"),
        Line(">=", team.singles(group) * T, "(1-curvature) sum of f(u_i)"),
        Line("=", (best + team.singles(group[1:])) * T, "(1-curvature) [best bait + the others]"),
        Line(">=", bests, "(1-curvature)/|V2| [sum of every robot's own best control]", size),
        Line("=", bests, "the same, as one sum", size),
        Line(">=", team.singles(map(optimum, group)) * T, "(1-curvature)/|V2| sum of f(u*_i)", size),
        Line(">=", bound, "bound/|V2| f(u* on V2)", size),
        Line(">=", bound, "bound/alpha_cs f(u* on V2), |V2| <= alpha_cs", constant(alpha_cs)),
        Line("=", bound, "the same (A* empty)", constant(alpha_cs)),
    )
    star = f"f({bait[0]}) is the largest bait value in V2"
    return Case(
        size=f"{team.text()}; {earlier} greedy robots of V1 chosen before, alpha_cs = {alpha_cs}",
        team=team,
        start=team.chosen(group),
        lines=lines,
        given=tuple(Inequality(star, best - team.f([b])) for b in bait[1:]),
    )


def beside_v2(bait: Robots) -> Iterator[Team]:
    """The team with one greedy robot ``g1`` in V1 and one, ``x1``, in V2, which is chosen after or before it."""
    yield Team(bait, ("g1", "x1"))
    yield Team(bait, ("x1", "g1"))


def _many_baits(*, alpha_s: int, attacked: int) -> Iterator[Case]:
    """V1 with alpha_s + 1 baits and one greedy robot; one greedy robot ``x1`` sits in V2, before or after it."""
    bait = team_of(alpha_s + 1, 0).bait
    for team in beside_v2(bait):
        for hit in ((bait[0],), ("g1",)) if attacked else ((),):
            yield _substituted(team, (*bait, "g1"), hit)


def _substituted(team: Team, group: Robots, hit: Robots) -> Case:
    """The stated reason: replace a safe bait by ``x1``, quote Pattern 1's bound there, compare individual values."""
    left = [r for r in group if r not in hit]
    swapped = [*(r for r in left if r != team.bait[-1]), "x1"]
    quoted = Inequality(
        "Pattern 1's bound for the substituted group", team.chosen(swapped) - team.compared(swapped) * T3
    )
    order = tuple(Inequality(f"f({b}) >= f(x1)", team.f([b]) - team.f(["x1"])) for b in team.bait)
    line = Line(
        ">=",
        team.compared(left) * T3,
        "(1-c)^3 f(u* on V1\\A*), by substituting baits for the greedy robots of V2",
        cited=(quoted, *order),
        readings=whose_worst(team, group, hit) if hit else {},
    )
    return Case(size=x1_text(team, hit), team=team, start=team.chosen(left), lines=(line,))


def x1_text(team: Team, attacked: Robots) -> str:
    """Roles, attack and the greedy order in words."""
    return f"{team.text(attacked)}; x1 in V2, chosen {'after' if team.greedy[0] == 'g1' else 'before'} g1"


def _few_baits_attacked() -> Iterator[Case]:
    """V2 with one blinded bait: survivors are greedy only, or bait and greedy."""
    for n_bait, n_greedy in ((1, 1), (2, 1), (1, 2)):
        team = team_of(n_bait, n_greedy)
        left, alpha_cs = team.robots[1:], n_bait + n_greedy
        line = Line(">=", team.compared(left) * T2, "(1-c)^2/alpha_cs f(u* on V2\\A*)", constant(alpha_cs))
        text = f"{team.text(team.bait[:1])}; alpha_cs = {alpha_cs}"
        yield Case(size=text, team=team, start=team.chosen(left), lines=(line,))
