"""The lines that sum up a distribution or a pattern: from groups to the team.

``team`` is RATT's worst-case value and ``opt`` the optimum's. Both are bounds between numbers
that are no function values, so they enter as auxiliary numbers with the facts that define them.
Each claim fixes which group wins for the optimum and uses that group's own factor, which is at
least the minimum the paper writes (opt >= 0).
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import combinations
from typing import TYPE_CHECKING

from ratt_opt.audit.appendix.entry import Entry, SizedClaim
from ratt_opt.audit.appendix.roles import Team
from ratt_opt.audit.engine.claim import Claim, FunctionClass, Inequality, Linear
from ratt_opt.audit.engine.polynomial import ONE, Polynomial, T, constant

if TYPE_CHECKING:
    from collections.abc import Iterator

Groups = tuple[tuple[str, ...], ...]

__all__ = ["Grouping", "every_group", "summaries"]

TEAM, OPT = Linear.of("team"), Linear.of("opt")
PLAN, OPTIMUM = "A* is the plan's worst attack", "A* is the optimum's worst attack"
ND, SUB = FunctionClass.TOTAL_CURVATURE, FunctionClass.CURVATURE
T2, T3 = T * T, T * T * T
SUB_FACTOR = (T, constant(2) - T)
HYPOTHESES = "the class, RATT's choices; team >= its value in every group, opt <= the compared plan's best group"


@dataclass(frozen=True, slots=True, kw_only=True)
class Grouping:
    """Robots left in each group by A* (``left``) and by another attack (``other``), and each group's factor."""

    size: str
    team: Team
    left: tuple[tuple[str, ...], ...]
    other: tuple[tuple[str, ...], ...]
    factors: tuple[tuple[Polynomial, Polynomial], ...]


def _bounds(case: Grouping) -> tuple[Inequality, ...]:
    team = case.team
    return tuple(
        Inequality(f"bound of group {k + 1}", team.chosen(group) * below - team.compared(group) * above)
        for k, (group, (above, below)) in enumerate(zip(case.left, case.factors, strict=True))
    )


def _claims(kind: FunctionClass, case: Grouping, reading: str, *, is_step: bool) -> Iterator[SizedClaim]:
    team = case.team
    given = _bounds(case) if is_step else team.premises
    attained = case.left if reading == PLAN else case.other
    worth = tuple(Inequality("team >= RATT's value in a group", TEAM - team.chosen(group)) for group in attained)
    for winner, group in enumerate(case.left):
        loses = (Inequality("opt <= the optimum's best group", team.compared(group) - OPT),)
        rivals = case.other if reading == OPTIMUM else ((),)
        for rival in rivals:
            more = (Inequality("opt <= its value under another attack", team.compared(rival) - OPT),) if rival else ()
            above, below = case.factors[winner]
            claim = Claim(
                kind=kind,
                ground=team.ground,
                premises=given + worth + loses + more,
                conclusion=TEAM * below - OPT * above,
            )
            size = f"{case.size}; the optimum's best group is V{winner + 1}"
            yield SizedClaim(size=size, robots=len(team.robots), claim=claim, team=team)


def _distribution(label: str, kind: FunctionClass, cases: tuple[Grouping, ...], bound: str) -> Iterator[Entry]:
    for reading in (PLAN, OPTIMUM):
        for form in ("step", "cumulative"):
            origin = "the bounds of its groups" if form == "step" else "RATT's choices alone"
            claims = tuple(c for case in cases for c in _claims(kind, case, reading, is_step=form == "step"))
            yield Entry(
                label=label,
                kind=form,
                chain=label,
                statement=f"from {origin}: RATT's worst-case value >= {bound} of the optimum's",
                hypotheses=HYPOTHESES,
                claims=claims,
                reading=reading,
                survives_by="" if form == "cumulative" else f"{label}/cumulative",
                serves_by=f"{label}/step/{PLAN}" if form == "step" and reading == OPTIMUM else "",
            )


def _pattern1(number: int) -> Grouping:
    cubed, squared = (T3, ONE), (T2, ONE)
    b1, b2, g1 = ("b1",), ("b2",), ("g1",)
    left: Groups
    other: Groups
    if number == 1:
        team = Team(("b1", "b2"), g1)
        return Grouping(
            size="V1 = {b1,g1}, V2 = {b2}, A* = {g1}",
            team=team,
            left=(b1, b2),
            other=(g1, b2),
            factors=(cubed, squared),
        )
    if number == 2:
        team = Team(("b1", "b2", "b3"), g1)
        left, other = (("b1", "g1"), ("b3",)), (g1, ("b2", "b3"))
        text = "V1 = {b1,g1}, V2 = {b2,b3}, A* = {b2}"
        return Grouping(size=text, team=team, left=left, other=other, factors=(cubed, squared))
    team = Team(("b1", "b2", "b3"), g1)
    left, other = (("b2", "g1"), ("b3",)), (("b1", "b2"), ("b3",))
    text = "V1 = {b1,b2,g1}, V2 = {b3,..}, one blinded in each, A* hits b1"
    return Grouping(size=text, team=team, left=left, other=other, factors=(cubed, squared))


def _pattern2(number: int, many: tuple[Polynomial, Polynomial], few: tuple[Polynomial, Polynomial]) -> Grouping:
    """V1 = {b1, b2, g1}, V2 = {b3, x1}; alpha_cs = 2."""
    small = Team(("b1", "b3"), ("x1",))
    left: Groups
    other: Groups
    if number == 1:
        left, other = (("b1",), ("b3", "x1")), (("b1",), ("b3",))
        text = "V1 = {b1,b2}, V2 = {b3,x1}, A* = {b2}, other attack {x1}"
    elif number == 2:
        left, other = (("b1",), ("x1",)), (("b1",), ("b3",))
        text = "V1 = {b1,..}, V2 = {b3,x1}, A* = {b3}, other attack {x1}"
    else:
        left, other = (("b1",), ("b3",)), (("b1",), ("x1",))
        text = "V1 = {b1,..}, V2 = {b3,x1}, one blinded in each, A* hits x1"
    return Grouping(size=text, team=small, left=left, other=other, factors=(many, few))


def summaries() -> Iterator[Entry]:
    """Yield the summing-up entries of the whole appendix, in its order."""
    half = constant(2)
    p1 = [_pattern1(i) for i in (1, 2, 3)]
    p2 = [_pattern2(i, (T3, ONE), (T2, half)) for i in (1, 2, 3)]
    for i in (1, 2, 3):
        yield from _distribution(f"nd_p1_d{i}", ND, (p1[i - 1],), "(1-c)^3")
    yield from _overall("nd_p1", ND, tuple(p1), factor=(T3, ONE), bound="(1-c)^3")
    for i in (1, 2, 3):
        yield from _distribution(f"nd_p2_d{i}", ND, (p2[i - 1],), "min[(1-c)^3, (1-c)^2/alpha_cs]")
    yield from _overall("nd_p2", ND, tuple(p2), factor=(T2, half), bound="min[(1-c)^3, (1-c)^2/alpha_cs]")
    sub = _pattern2(1, SUB_FACTOR, (T, half))
    yield from _distribution("sub_p2_d1", SUB, (sub,), "min[(1-k)/(1+k), (1-k)/alpha_cs]")


def _overall(
    label: str,
    kind: FunctionClass,
    cases: tuple[Grouping, ...],
    *,
    factor: tuple[Polynomial, Polynomial],
    bound: str,
) -> Iterator[Entry]:
    """A line that repeats the bound of its parts: the step is the bound itself; cumulatively, all parts again."""
    above, below = factor
    team = cases[0].team
    bound_holds = Inequality("the bound of the part", TEAM * below - OPT * above)
    same = Claim(kind=kind, ground=team.ground, premises=(bound_holds,), conclusion=TEAM * below - OPT * above)
    step = (SizedClaim(size="each part", robots=len(team.robots), claim=same),)
    again = tuple(c for case in cases for c in _claims(kind, case, PLAN, is_step=False))
    for form, claims, origin in (
        ("step", step, "Distributions 1 to 3"),
        ("cumulative", again, "RATT's choices alone"),
    ):
        yield Entry(
            label=label,
            kind=form,
            chain=label,
            statement=f"from {origin}: worst-case value >= {bound} of the optimum's",
            hypotheses=HYPOTHESES,
            claims=claims,
        )


def every_group(
    kind: FunctionClass, above: Polynomial, below: Polynomial, *, largest: int, smallest: int = 1
) -> Iterator[SizedClaim]:
    """For every set S of surviving robots: ``f(u on S) >= above/below f(o on S)``, whatever the pattern.

    S has any baits and any of the greedy robots; greedy robots outside S were still chosen before
    some in S. Baits outside S and greedy robots chosen later play no part.
    """
    for total in range(smallest, largest + 1):
        for n_greedy in range(total + 1):
            greedy = tuple(f"g{i + 1}" for i in range(n_greedy))
            bait = tuple(f"b{i + 1}" for i in range(total - n_greedy))
            for chosen in _subsets_with_last(greedy):
                outside = frozenset(greedy) - set(chosen)
                team = Team(bait, greedy, without_optimum=outside)
                group = bait + chosen
                conclusion = (team.chosen(group) * below - team.compared(group) * above).reduced()
                claim = Claim(kind=kind, ground=team.ground, premises=team.premises, conclusion=conclusion)
                text = f"S = {{{','.join(group)}}} of {len(bait)} bait, {n_greedy} greedy"
                yield SizedClaim(size=text, robots=total, claim=claim, team=team)


def _subsets_with_last(greedy: tuple[str, ...]) -> Iterator[tuple[str, ...]]:
    if not greedy:
        yield ()
        return
    for size in range(len(greedy)):
        for rest in combinations(greedy[:-1], size):
            yield (*rest, greedy[-1])
