"""The appendix's chains: Pattern 1 and Pattern 2 of the non-decreasing proof, Pattern 2' of the submodular one.

In Pattern 1 one group holds all greedy robots and alpha_s baits; in Pattern 2 two groups hold the greedy robots. For
its group with few baits, V2, one chain serves both classes: total curvature (factor ``(1-c)^2``) and submodular
(factor ``1-k``), as the paper says.

Source: ratt.tex, appendix, eq:nd_p1d1v1_1 to eq:nd_p2d3v2, eq:sub_p2vk_1 to eq:sub_p2d1v2_9.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from ratt_audit.appendix.entry import Case, Chain, Line
from ratt_audit.appendix.roles import ONE_PLUS_K, T2, T3, Team, attacks_on, optimum, own_best, team_of, whose_worst
from ratt_audit.engine.claim import Inequality
from ratt_audit.engine.polynomials import T, constant
from ratt_opt.worst_ratio.function_class import FunctionClass

if TYPE_CHECKING:
    from collections.abc import Iterator

    from ratt_audit.appendix.roles import Robots
    from ratt_audit.engine.claim import Linear
    from ratt_audit.engine.polynomials import Polynomial

__all__ = ["BAITS", "GROUP", "beside_v2", "pattern1_chains", "pattern2_chains", "submodular_chains"]


def pattern1_chains() -> tuple[Chain, ...]:
    """The chains of Pattern 1, in the paper's order."""
    cases = {
        "nd_p1d1v1": _all_attacked(),
        "nd_p1d1vk": _all_bait(attacked=0),
        "nd_p1d2v1": _none_attacked(),
        "nd_p1d2vk": _all_bait(attacked=1),
        "nd_p1d3v1": _part_attacked(),
        "nd_p1d3vk": _other_groups(),
    }
    return tuple(Chain(name, FunctionClass.TOTAL_CURVATURE, tuple(case)) for name, case in cases.items())


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
    each, readings = team.singles(hit) + team.singles(kept), whose_worst(team, team.robots, attacked)
    lines = (
        Line("=", team.chosen(left), "f(u) on V1b\\A* and V1g\\A*"),
        Line(">=", team.singles(left) * T, "(1-c) sum of f(u_i)"),
        Line("=", split * T, "(1-c) [sum over surviving baits + sum over surviving greedy robots]"),
        Line(">=", each * T, "(1-c) [attacked greedy robots' f(u_i) + surviving ones']"),
        Line("=", team.singles(greedy) * T, "(1-c) sum over V1g"),
        Line(">=", team.chosen(greedy) * T2, "(1-c)^2 f(u on V1g)"),
        Line(">=", team.compared(greedy) * T3, "(1-c)^3 f(u* on V1g)"),
        Line(">=", team.compared(left) * T3, "(1-c)^3 f(u* on V1\\A*)", readings=readings),
    )
    return Case(size=team.text(attacked), team=team, start=team.chosen(left), lines=lines, attacked=attacked)


def _all_bait(*, attacked: int) -> Iterator[Case]:
    """A group of baits only, of which the last ``attacked`` are blinded."""
    for survivors in range(1, 5 - attacked):
        case = _bait_case(survivors, attacked, "c", T2, "(1-c)^2 f(u*)")
        same = Line("=", case.lines[-1].expression, "the same (A* empty)")
        yield case if attacked else replace(case, lines=(*case.lines, same))


def _bait_case(survivors: int, attacked: int, symbol: str, kept: Polynomial, bound: str) -> Case:
    """``survivors`` baits and as many blinded ones as ``attacked``, and what the former keep."""
    team = team_of(survivors + attacked, 0)
    left = team.bait[:survivors]
    lines = (
        Line("=", team.chosen(left), "f(bait on the survivors)"),
        Line(">=", team.singles(left) * T, f"(1-{symbol}) sum of f(bait_i)"),
        _by_own_best(team, left, team.singles(map(optimum, left)) * T, f"(1-{symbol}) sum of f(u*_i)"),
        Line(">=", team.compared(left) * kept, bound),
    )
    hit = team.bait[survivors:]
    return Case(size=team.text(hit), team=team, start=team.chosen(left), lines=lines, attacked=hit)


OPTIMAL_PLAN = "u*_i is what the optimal plan gives robot i"
OPTIMAL_ALONE = "u*_W is optimal for W, as the Notation paragraph permits, here for W = {i}"


def _by_own_best(team: Team, bait: Robots, expression: Linear, statement: str) -> Line:
    """A printed ``=`` between baits' values and values of ``u*_i``: read with each meaning of the latter."""
    alone = tuple(Inequality(f"u*_i is optimal for {b} alone", team.compared([b]) - team.f([b])) for b in bait)
    return Line("=", expression, statement, as_written={OPTIMAL_PLAN: (), OPTIMAL_ALONE: alone})


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
            _by_own_best(team, b, swapped * T, "(1-c) [sum of f(u*_i) over baits + sum over greedy]"),
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
    whole, readings = team.compared((*safe, *team.greedy)), whose_worst(team, team.robots, attacked)
    lines = (
        Line("=", team.chosen(left), "f(u) on V1b\\A* and V1g\\A*"),
        Line(">=", team.singles(left) * T, "(1-c) sum of f(u_i)"),
        Line("=", split * T, "(1-c) [sum over V1b1 + sum over V1b2\\A* + sum over V1g\\A*]"),
        Line(">=", a * T2 + b * T3, "(1-c)^2 f(u* on V1b1) + (1-c)^3 f(u* on V1g)"),
        Line(">=", (a + b) * T3, "(1-c)^3 [f(u* on V1b1) + f(u* on V1g)]"),
        Line(">=", whole * T3, "(1-c)^3 f(u* on V1b1 and V1g): subadditivity of a non-decreasing f"),
        Line(">=", team.compared(left) * T3, "(1-c)^3 f(u* on V1\\A*)", readings=readings),
    )
    return Case(size=team.text(attacked), team=team, start=team.chosen(left), lines=lines, attacked=attacked)


FEW_BAITS = ((1, 1, 0, 2), (1, 1, 0, 3), (1, 1, 1, 2), (2, 1, 0, 3), (1, 2, 0, 3))
"""Baits and greedy robots of V2, greedy robots of V1 chosen before them, alpha_cs."""


def pattern2_chains() -> tuple[Chain, ...]:
    """The chains of Pattern 2, in the paper's order; single lines are chains of one."""
    return (
        _single("nd_p2d1v1", _many_baits(alpha_s=1, attacked=1)),
        _few_baits_chain("nd_p2d1v2", FunctionClass.TOTAL_CURVATURE),
        _single("nd_p2d2v1", _many_baits(alpha_s=1, attacked=0)),
        _single("nd_p2d2v2", _few_baits_attacked()),
        _single("nd_p2d3v1", _many_baits(alpha_s=2, attacked=1)),
        _single("nd_p2d3v2", _few_baits_attacked()),
    )


def _single(name: str, cases: Iterator[Case]) -> Chain:
    return Chain(name, FunctionClass.TOTAL_CURVATURE, tuple(cases))


def _few_baits_chain(name: str, function_class: FunctionClass) -> Chain:
    """The chain for V2 (at least one bait, at least one greedy robot, none blinded), at several |V2| and alpha_cs."""
    return Chain(name, function_class, tuple(_few_baits(function_class, *size) for size in FEW_BAITS))


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
    bound = team.chosen(swapped) - team.compared(swapped) * T3
    quoted = Inequality("Pattern 1's bound for the substituted group", bound)
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
    order = "" if team.greedy == ("x1",) else f", chosen {'after' if team.greedy[0] == 'g1' else 'before'} g1"
    return f"{team.text(attacked)}; x1 in V2{order}"


def _few_baits_attacked() -> Iterator[Case]:
    """V2 with one blinded bait: survivors are greedy only, or bait and greedy."""
    for n_bait, n_greedy in ((1, 1), (2, 1), (1, 2)):
        team = team_of(n_bait, n_greedy)
        left, alpha_cs = team.robots[1:], n_bait + n_greedy
        line = Line(">=", team.compared(left) * T2, "(1-c)^2/alpha_cs f(u* on V2\\A*)", constant(alpha_cs))
        text = f"{team.text(team.bait[:1])}; alpha_cs = {alpha_cs}"
        yield Case(size=text, team=team, start=team.chosen(left), lines=(line,))


BAITS = ("b1", "b2")
GROUP = (*BAITS, "g1")
"""V1 with alpha_s = 1 and |V2g| = 1; x1 is the greedy robot in V2. V1 may be its baits alone."""


def submodular_chains() -> tuple[Chain, ...]:
    """The chains of the submodular proof, in the paper's order."""
    baits_alone = _case(Team(BAITS, ("x1",)), BAITS, BAITS[:1])
    beside = (_case(team, GROUP, attacked) for team in beside_v2(BAITS) for attacked in attacks_on(GROUP, 1))
    sizes = ((1, 0), (1, 1), (2, 0), (2, 1), (3, 0), (4, 0))
    bait = tuple(_bait_case(survivors, attacked, "k", T, "(1-k) f(u*)") for survivors, attacked in sizes)
    kind = FunctionClass.CURVATURE
    return (
        Chain("sub_p2vk", kind, bait),
        Chain("sub_p2d1v1", kind, (baits_alone, *beside)),
        _few_baits_chain("sub_p2d1v2", kind),
    )


def _case(team: Team, group: Robots, attacked: Robots) -> Case:
    left = tuple(r for r in group if r not in attacked)
    first = [r for r in ("b1",) if r not in attacked]
    kept, hit = [r for r in group[2:] if r not in attacked], [r for r in group[2:] if r in attacked]
    greedy, readings = team.greedy, whose_worst(team, group, attacked)
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
        Line(">=", team.compared(left) * T, "(1-k)/(1+k) f(u* on V1\\A*)", ONE_PLUS_K, readings=readings),
    )
    return Case(size=x1_text(team, attacked), team=team, start=team.chosen(left), lines=lines, attacked=attacked)
