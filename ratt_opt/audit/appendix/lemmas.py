"""The cited lemmas as the proof uses them, and the remarks on the classes."""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING

from ratt_opt.audit.appendix.bounds import KEPT, ONE_PLUS_K, Factor, one_group
from ratt_opt.audit.appendix.entry import ClaimEntry, EntryKind, Reference, SizedClaim
from ratt_opt.audit.appendix.roles import Side, attacks_on, team_of, worst_for
from ratt_opt.audit.engine.claim import Claim, FunctionClass, Ground, Linear
from ratt_opt.audit.engine.polynomial import ONE, T

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

__all__ = ["lemmas"]

ND, SUB = FunctionClass.TOTAL_CURVATURE, FunctionClass.CURVATURE
SIZES = (2, 3, 4)
LARGEST_GREEDY = 4
WEAK_SUBADDITIVITY = Reference("weak_subadditivity", EntryKind.LEMMA)
LEMMA9_IN_USE = Reference("nd_p1d1v1_8", EntryKind.CUMULATIVE)


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
    weak = f"{parts.format('(1-c) ')}: what is left of the subadditivity used"
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
        survives_by=Reference("nd_p1d2v1_9", EntryKind.CUMULATIVE),
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
                yield SizedClaim(
                    size=f"{size} elements, marginals of a at {at} and {against}", robots=size, claim=claim
                )
