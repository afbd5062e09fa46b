"""Theorem 1, the lines that close its proof, the stronger pattern-free theorem, and the cited lemmas."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import partial
from typing import TYPE_CHECKING

from ratt_audit.appendix.entry import ClaimEntry, EntryKind, EntryName
from ratt_audit.appendix.roles import (
    CUBED,
    KEPT,
    KEPT_OVER_ONE_PLUS_K,
    ONE_PLUS_K,
    SQUARED,
    Factor,
    Side,
    SizedClaim,
    attacks_on,
    every_group,
    one_group,
    team_of,
    worst_for,
)
from ratt_audit.appendix.team_lines import OPT, TEAM
from ratt_audit.engine.claim import Claim, Ground, Inequality, Linear
from ratt_audit.engine.polynomials import ONE, T, constant
from ratt_opt.worst_ratio.function_class import FunctionClass

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator

__all__ = ["PATTERN_FREE_ND", "PATTERN_FREE_SUB", "THEOREM1", "THEOREM1_SUB", "closing_lines", "lemmas", "theorems"]

ND, SUB = FunctionClass.TOTAL_CURVATURE, FunctionClass.CURVATURE
STEP, CUMULATIVE, CLAIM = EntryKind.STEP, EntryKind.CUMULATIVE, EntryKind.CLAIM
THEOREM1 = EntryName("eqn:appro_non_descrease", EntryKind.THEOREM)
THEOREM1_SUB = EntryName("eqn:appro_submodular", EntryKind.THEOREM)
PATTERN_FREE_ND = EntryName("pattern_free_nd", EntryKind.THEOREM)
PATTERN_FREE_SUB = EntryName("pattern_free_sub", EntryKind.THEOREM)
GROUPS = "the class and RATT's choices only; every set S of surviving robots, hence every graph, attack and budget"
LARGEST_GROUP, LARGEST_TEAM = 4, 5
"""Baits in a group of baits only; robots in play in a group of any pattern: with six the sets of a claim are 4,096."""
SURVIVING = "f(u on S) >= {} f(u* on S)"
_theorem = partial(ClaimEntry, kind=EntryKind.THEOREM, chain="theorems")


def closing_lines() -> Iterator[ClaimEntry]:
    """Yield nd1, nd2, nd, sub2 and sub: the cumulative claims, and the steps that are linear."""
    every_nd = tuple(every_group(ND, CUBED, largest=LARGEST_TEAM))
    every_sub = tuple(every_group(SUB, KEPT_OVER_ONE_PLUS_K, largest=LARGEST_TEAM))
    nd, sub = SURVIVING.format("(1-c)^3"), SURVIVING.format("(1-k)/(1+k)")
    yield from _all_bait("nd2", "f(u) >= (1-c)^2 f(u*) in every group", ND, SQUARED)
    for label in ("nd1", "nd"):
        text = f"{nd}, which gives min[(1-c)^3, (1-c)^2/alpha_cs] for the team"
        yield _line(label, CUMULATIVE, text, every_nd, GROUPS)
    parts = dict.fromkeys(("Pattern 1", "Pattern 2", "any other pattern"), CUBED)
    given = "the bounds of Patterns 1 and 2 and of the patterns left out"
    joined = _line("nd1", STEP, "all patterns together", _joined(ND, parts), given)
    yield replace(joined, reading="with the omitted patterns")
    text = f"in every other pattern too, {nd}: 'the same approximation bound or a better one'"
    yield _line("nd_other_patterns", EntryKind.CLAIM, text, every_nd, GROUPS)
    yield from _all_bait("sub2", "f(u) >= (1-k) f(u*) in every group", SUB, KEPT)
    text = f"in every other pattern and distribution too, {sub}"
    yield _line("sub_other_patterns", EntryKind.CLAIM, text, every_sub, GROUPS)
    text = f"{sub}, which gives min[(1-k)/(1+k), (1-k)/alpha_cs] for the team"
    yield _line("sub", CUMULATIVE, text, every_sub, GROUPS)
    given = "the bounds of N > alpha and N <= alpha"
    for label, kind, more, fewer in (("nd", ND, CUBED, SQUARED), ("sub", SUB, KEPT_OVER_ONE_PLUS_K, KEPT)):
        claims = _joined(kind, {"N > alpha": more, "N <= alpha": fewer})
        yield _line(label, STEP, "both cases together", claims, given)


def _line(label: str, kind: EntryKind, text: str, claims: Iterable[SizedClaim], given: str) -> ClaimEntry:
    return ClaimEntry(label=label, kind=kind, chain=label, statement=text, hypotheses=given, claims=tuple(claims))


def _all_bait(label: str, text: str, function_class: FunctionClass, factor: Factor) -> Iterator[ClaimEntry]:
    claims = tuple(one_group(function_class, [factor] * LARGEST_GROUP, all_bait=True))
    for kind in (STEP, CUMULATIVE):
        yield _line(label, kind, text, claims, "every robot is bait (N <= alpha)")


def _joined(function_class: FunctionClass, parts: dict[str, Factor]) -> Iterator[SizedClaim]:
    """The first part's bound follows from each part's (opt >= 0)."""
    weakest = next(iter(parts.values())).gap(TEAM, OPT)
    for name, factor in parts.items():
        given = (Inequality(f"the bound for {name}", factor.gap(TEAM, OPT)), Inequality("opt >= 0", OPT))
        ground = Ground(("u",), (0,))
        claim = Claim(function_class=function_class, ground=ground, premises=given, conclusion=weakest)
        yield SizedClaim(size=name, robots=1, claim=claim)


def theorems() -> Iterator[ClaimEntry]:
    """Yield Theorem 1, the pattern-free theorem, and the better bounds of groups of baits."""
    first = "Theorem 1: at least {0} >= min[{0}, {1}/alpha_cs]"
    for name, kind, factor, text in (
        (THEOREM1, ND, CUBED, first.format("(1-c)^3", "(1-c)^2")),
        (THEOREM1_SUB, SUB, KEPT_OVER_ONE_PLUS_K, first.format("(1-k)/(1+k)", "(1-k)")),
        (PATTERN_FREE_ND, ND, SQUARED, "pattern-free: at least (1-c)^2 of the optimum"),
        (PATTERN_FREE_SUB, SUB, KEPT, "pattern-free: at least 1-k of the optimum"),
    ):
        statement = f"{text}: f(u on S) >= factor f(o on S) for every S and every plan o"
        claims = tuple(every_group(kind, factor, largest=LARGEST_TEAM))
        yield _theorem(label=name.label, statement=statement, claims=claims, hypotheses=GROUPS)
    shares = [(ONE + constant(g - 1) * T, g) for g in range(1, LARGEST_GROUP + 1)]
    better_sub = [Factor(share, constant(g)) for share, g in shares]
    better_nd = [Factor(share * T, T + constant(g - 1)) for share, g in shares]
    for label, kind, better, share in (
        ("all_bait_sub", SUB, better_sub, "(1+(g-1)(1-k))/g"),
        ("all_bait_nd", ND, better_nd, "(1+(g-1)(1-c))/(1+(g-1)/(1-c))"),
    ):
        text = f"an all-bait group of g robots keeps {share} of the optimum"
        kept = one_group(kind, better, all_bait=True)
        yield _theorem(label=label, statement=text, claims=tuple(kept), hypotheses="all surviving robots are bait")


SIZES = (2, 3, 4)
LARGEST_GREEDY = 4
WEAK_SUBADDITIVITY = EntryName("weak_subadditivity", EntryKind.LEMMA)
LEMMA9_IN_USE = EntryName("nd_p1d1v1_8", EntryKind.CUMULATIVE)


@dataclass(frozen=True, slots=True)
class _Values:
    """The values that lemmas about the class alone speak of: all elements, each alone, the first, the others."""

    whole: Linear
    alone: Linear
    first: Linear
    others: Linear


_lemma = partial(ClaimEntry, kind=EntryKind.LEMMA, chain="lemmas")
_of_the_class = partial(_lemma, hypotheses="the class alone")


def lemmas() -> Iterator[ClaimEntry]:
    """Yield the cited lemmas and the remarks on the classes, in the order in which the proof meets them."""
    yield from _about_the_class()
    for label, kind, factor, text in (
        ("sviridenko2017_theorem8_1", ND, KEPT, "greedy keeps 1-c of any plan"),
        ("conforti1984_theorem2_3", SUB, Factor(ONE, ONE_PLUS_K), "greedy keeps 1/(1+k) of any plan (the formula)"),
        ("conforti1984_in_words", SUB, KEPT, "greedy keeps 1-k of any plan (the words)"),
    ):
        claims = tuple(one_group(kind, [factor] * LARGEST_GREEDY, all_bait=False))
        yield _lemma(label=label, statement=text, claims=claims, hypotheses="all robots greedy, in greedy order")
    for side, reading in ((Side.RATT, "A* hurts RATT's plan most"), (Side.OPTIMUM, "A* hurts the optimum most")):
        yield _lemma(
            label="tzoumas2018_lemma9",
            statement="f(u* on W) >= f(u* on V1\\A*) for the |V1|-|A*| greedy robots W (Lemma 9 as used)",
            claims=tuple(_lemma9(side)),
            hypotheses="bait and greedy roles",
            reading=reading,
            survives_by=LEMMA9_IN_USE,
            serves_by=LEMMA9_IN_USE,
        )
    text = "for submodular f, c <= k"
    yield _of_the_class(label="curvature_is_total_curvature", statement=text, claims=tuple(_marginals()))


def _about_the_class() -> Iterator[ClaimEntry]:
    parts = "f(X) + f(Y) >= {}f(X and Y) for disjoint X, Y"
    weak = f"{parts.format('(1-c) ')}: the rest of the subadditivity used"
    rows: tuple[tuple[str, FunctionClass, str, Callable[[_Values], Linear]], ...] = (
        ("tzoumas2018_lemma4", ND, "f(S) >= (1-c) sum of f(s)", lambda f: f.whole - f.alone * T),
        ("tzoumas2018_corollary1", ND, "sum of f(s) >= (1-c) f(S)", lambda f: f.alone - f.whole * T),
        ("tzoumas2018_lemma2", SUB, "f(S) >= (1-k) sum of f(s)", lambda f: f.whole - f.alone * T),
        ("submodular_subadditive", SUB, "sum of f(s) >= f(S)", lambda f: f.alone - f.whole),
        (WEAK_SUBADDITIVITY.label, ND, weak, lambda f: f.first + f.others - f.whole * T),
    )
    for label, kind, text, conclusion in rows:
        yield _of_the_class(label=label, statement=text, claims=tuple(_sizes(kind, conclusion)))
    yield _of_the_class(
        label="subadditivity_as_used",
        statement=f"{parts.format('')} and a non-decreasing f",
        claims=tuple(_sizes(ND, lambda f: f.first + f.others - f.whole)),
        survives_by=EntryName("nd_p1d2v1_9", EntryKind.CUMULATIVE),
        serves_by=WEAK_SUBADDITIVITY,
    )


def _sizes(function_class: FunctionClass, conclusion: Callable[[_Values], Linear]) -> Iterator[SizedClaim]:
    for size in SIZES:
        full = (1 << size) - 1
        alone = sum((Linear.of(1 << x) for x in range(size)), Linear())
        values = _Values(Linear.of(full), alone, Linear.of(1), Linear.of(full ^ 1))
        claim = Claim(function_class=function_class, ground=_free(size), conclusion=conclusion(values))
        yield SizedClaim(size=f"{size} elements", robots=size, claim=claim)


def _free(size: int) -> Ground:
    """Elements of as many robots."""
    return Ground(tuple("abcd"[:size]), tuple(range(size)))


def _lemma9(side: Side) -> Iterator[SizedClaim]:
    for n_bait, n_greedy in ((1, 1), (2, 1), (1, 2)):
        team = team_of(n_bait, n_greedy)
        for attacked in attacks_on(team.robots, n_bait):
            left = [r for r in team.robots if r not in attacked]
            premises = team.premises + worst_for(team, team.robots, attacked, side=side)
            claim = team.claim(ND, team.compared(team.greedy) - team.compared(left), premises)
            yield SizedClaim(size=team.text(attacked), robots=len(team.robots), claim=claim, team=team)


def _marginals() -> Iterator[SizedClaim]:
    """Submodular with curvature k has total curvature at most k: every marginal is at least (1-k) of every other."""
    for size in SIZES:
        ground = _free(size)
        for base in range(1, 1 << size, 2):
            for other in range(1, 1 << size, 2):
                low = Linear.of(base) - Linear.of(base ^ 1)
                high = Linear.of(other) - Linear.of(other ^ 1)
                claim = Claim(function_class=SUB, ground=ground, conclusion=low - high * T)
                at, against = (ground.text(mask ^ 1)[1:] for mask in (base, other))
                text = f"{size} elements, marginals of a at {at} and {against}"
                yield SizedClaim(size=text, robots=size, claim=claim)
