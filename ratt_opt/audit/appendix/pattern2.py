"""Pattern 2: two groups hold the greedy robots; the chains for the group with few baits, V2.

The same chain serves both classes: total curvature (factor ``(1-c)^2``) and submodular
(factor ``1-k``), as the paper says.

Source: ratt.tex, appendix, eq:nd_p2d1v2_1 to _9 and eq:sub_p2d1v2_1 to _9.
"""

from __future__ import annotations

from fractions import Fraction
from typing import TYPE_CHECKING

from ratt_opt.audit.appendix.entry import Case, Chain, Line
from ratt_opt.audit.appendix.pattern1 import readings, size_text
from ratt_opt.audit.appendix.roles import Team, optimum
from ratt_opt.audit.engine.claim import FunctionClass, Inequality, Linear
from ratt_opt.audit.engine.polynomial import ONE, Polynomial, T, constant

if TYPE_CHECKING:
    from collections.abc import Iterator

__all__ = ["chains", "few_baits_chain"]

T2, T3 = T * T, T * T * T
ROLES = "f normalised, non-decreasing, total curvature <= c; baits and greedy robots as RATT chooses them"


def few_baits_chain(label: str, kind: FunctionClass, hypotheses: str) -> Chain:
    """The chain for V2 (at least one bait, at least one greedy robot, none blinded), at several |V2| and alpha_cs."""
    sizes = ((1, 1, 0, 2), (1, 1, 0, 3), (1, 1, 1, 2), (2, 1, 0, 3), (1, 2, 0, 3))
    cases = [_few_baits(label, kind, size) for size in sizes]
    return Chain(name=label, kind=kind, hypotheses=hypotheses, cases=tuple(cases))


def _few_baits(label: str, kind: FunctionClass, sizes: tuple[int, int, int, int]) -> Case:
    """Build one size: baits and greedy robots of V2, earlier greedy robots of V1, alpha_cs; b1 is the best bait."""
    n_bait, n_greedy, earlier, alpha_cs = sizes
    first = tuple(f"e{i + 1}" for i in range(earlier))
    bait, greedy = tuple(f"b{i + 1}" for i in range(n_bait)), tuple(f"g{i + 1}" for i in range(n_greedy))
    team = Team(bait, first + greedy, with_own_best=True, without_optimum=frozenset(first))
    group = bait + greedy
    bests = [*bait, *(f"h({g})" for g in greedy)]
    star = f"f({bait[0]}) is the largest bait value in V2"
    largest = tuple(Inequality(star, team.f([bait[0]]) - team.f([b])) for b in bait[1:])
    size = len(group)
    last = T2 if kind is FunctionClass.TOTAL_CURVATURE else T
    rows: tuple[tuple[str, Linear, Polynomial, str], ...] = (
        ("=", team.chosen(group), ONE, "f(u on V2)"),
        (">=", team.singles(group) * T, ONE, "(1-curvature) sum of f(u_i)"),
        ("=", (team.f([bait[0]]) + team.singles(group[1:])) * T, ONE, "(1-curvature) [best bait + the others]"),
        (">=", team.singles(bests) * T, constant(size), "(1-curvature)/|V2| [sum of every robot's own best control]"),
        ("=", team.singles(bests) * T, constant(size), "the same, as one sum"),
        (">=", team.singles(map(optimum, group)) * T, constant(size), "(1-curvature)/|V2| sum of f(u*_i)"),
        (">=", team.compared(group) * last, constant(size), "bound/|V2| f(u* on V2)"),
        (">=", team.compared(group) * last, constant(alpha_cs), "bound/alpha_cs f(u* on V2), |V2| <= alpha_cs"),
        ("=", team.compared(group) * last, constant(alpha_cs), "the same (A* empty)"),
    )
    lines = tuple(
        Line(
            label=f"{label}_{i + 1}",
            relation=relation,
            expression=expression,
            denominator=denominator,
            statement=statement,
            readings={"": largest},
        )
        for i, (relation, expression, denominator, statement) in enumerate(rows)
    )
    text = f"{size_text(team, ())}; {earlier} greedy robots of V1 chosen before, alpha_cs = {alpha_cs}"
    return Case(size=text, team=team, start=team.chosen(group), lines=lines)


def chains() -> tuple[Chain, ...]:
    """The chains of Pattern 2, in the paper's order; single lines are chains of one."""
    kind = FunctionClass.TOTAL_CURVATURE
    return (
        _single("nd_p2d1v1", tuple(_many_baits("nd_p2d1v1", alpha_s=1, attacked=1))),
        few_baits_chain("nd_p2d1v2", kind, ROLES),
        _single("nd_p2d2v1", tuple(_many_baits("nd_p2d2v1", alpha_s=1, attacked=0))),
        _single("nd_p2d2v2", tuple(_few_baits_attacked("nd_p2d2v2", attacked=1))),
        _single("nd_p2d3v1", tuple(_many_baits("nd_p2d3v1", alpha_s=2, attacked=1))),
        _single("nd_p2d3v2", tuple(_few_baits_attacked("nd_p2d3v2", attacked=1))),
    )


def _single(label: str, cases: tuple[Case, ...]) -> Chain:
    return Chain(name=label, kind=FunctionClass.TOTAL_CURVATURE, hypotheses=ROLES, cases=cases)


def _many_baits(label: str, *, alpha_s: int, attacked: int) -> Iterator[Case]:
    """V1 with alpha_s + 1 baits and one greedy robot; one greedy robot ``x1`` sits in V2, before or after it."""
    bait = tuple(f"b{i + 1}" for i in range(alpha_s + 1))
    for order in (("g1", "x1"), ("x1", "g1")):
        team = Team(bait, order)
        group = (*bait, "g1")
        hits = [(), (bait[0],), ("g1",)] if attacked else [()]
        for hit in (h for h in hits if len(h) == attacked):
            yield _substituted(label, team, group, hit)


def _substituted(label: str, team: Team, group: tuple[str, ...], hit: tuple[str, ...]) -> Case:
    """The stated reason: replace a safe bait by ``x1``, quote Pattern 1's bound there, compare individual values."""
    left = [r for r in group if r not in hit]
    swapped = [*(r for r in left if r != team.bait[-1]), "x1"]
    quoted = Inequality(
        "Pattern 1's bound for the substituted group", team.chosen(swapped) - team.compared(swapped) * T3
    )
    order = tuple(Inequality(f"f({b}) >= f(x1)", team.f([b]) - team.f(["x1"])) for b in team.bait)
    extra: dict[str, tuple[Inequality, ...]] = readings(team, group, hit) if hit else {}
    line = Line(
        label=label,
        relation=">=",
        expression=team.compared(left) * T3,
        statement="(1-c)^3 f(u* on V1\\A*), by substituting baits for the greedy robots of V2",
        cited=(quoted, *order),
        readings=extra,
    )
    text = f"{size_text(team, hit)}; x1 in V2, chosen {'after' if team.greedy[0] == 'g1' else 'before'} g1"
    return Case(size=text, team=team, start=team.chosen(left), lines=(line,))


def _few_baits_attacked(label: str, *, attacked: int) -> Iterator[Case]:
    """V2 with one blinded bait: survivors are greedy only, or bait and greedy."""
    for n_bait, n_greedy in ((1, 1), (2, 1), (1, 2)):
        bait, greedy = tuple(f"b{i + 1}" for i in range(n_bait)), tuple(f"g{i + 1}" for i in range(n_greedy))
        team = Team(bait, greedy)
        left = [r for r in team.robots if r not in bait[:attacked]]
        alpha_cs = n_bait + n_greedy
        line = Line(
            label=label,
            relation=">=",
            expression=team.compared(left) * T2,
            denominator=constant(Fraction(alpha_cs)),
            statement="(1-c)^2/alpha_cs f(u* on V2\\A*)",
        )
        text = f"{size_text(team, bait[:attacked])}; alpha_cs = {alpha_cs}"
        yield Case(size=text, team=team, start=team.chosen(left), lines=(line,))
