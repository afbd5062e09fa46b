"""Theorem 1, the lines that close its proof, the pattern-free theorem, cited lemmas and readings."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING

from ratt_opt.audit.appendix.entry import Entry, SizedClaim
from ratt_opt.audit.appendix.pattern1 import attacks_on, size_text, team_of
from ratt_opt.audit.appendix.roles import Team, worst_for
from ratt_opt.audit.appendix.team_lines import every_group
from ratt_opt.audit.engine.claim import Claim, FunctionClass, Ground, Inequality, Linear
from ratt_opt.audit.engine.polynomial import ONE, Polynomial, T, constant

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator

    Value = Callable[[Iterable[str]], Linear]

__all__ = ["closing_lines", "lemmas", "readings_of_the_attack", "theorems"]

ND, SUB = FunctionClass.TOTAL_CURVATURE, FunctionClass.CURVATURE
T2, T3 = T * T, T * T * T
ONE_PLUS_K = constant(2) - T
GROUPS = "the class and RATT's choices only; every set S of surviving robots, hence every graph, attack and budget"
LARGEST = 4
LARGEST_TEAM = 5
LARGEST_PATTERN_FREE = 5


SURVIVES_BY = {
    "team_subgroup": "eqn:appro_non_descrease/theorem",
    "opt_team_subgroup": "eqn:appro_non_descrease/theorem",
    "subadditivity_as_used": "nd_p1d2v1_9/cumulative",
    "tzoumas2018_lemma9": "nd_p1d1v1_8/cumulative",
}
SERVES_BY = {
    "team_subgroup": "pattern_free_nd/theorem",
    "opt_team_subgroup": "opt_team_subgroup/step",
    "subadditivity_as_used": "weak_subadditivity/lemma",
    "tzoumas2018_lemma9": "nd_p1d1v1_8/cumulative",
}


def _entry(
    label: str,
    kind: str,
    statement: str,
    claims: Iterable[SizedClaim],
    hypotheses: str,
    *,
    chain: str = "",
    reading: str = "",
) -> Entry:
    return Entry(
        label=label,
        kind=kind,
        chain=chain or label,
        statement=statement,
        hypotheses=hypotheses,
        claims=tuple(claims),
        reading=reading,
        survives_by=SURVIVES_BY.get(label, ""),
        serves_by=SERVES_BY.get(label, ""),
    )


def _all_bait(kind: FunctionClass, above: Polynomial) -> Iterator[SizedClaim]:
    for size in range(1, LARGEST + 1):
        team = team_of(size, 0)
        conclusion = team.chosen(team.bait) - team.compared(team.bait) * above
        claim = Claim(kind=kind, ground=team.ground, premises=team.premises, conclusion=conclusion.reduced())
        yield SizedClaim(size=f"{size} surviving baits", robots=size, claim=claim)


def closing_lines() -> Iterator[Entry]:
    """Yield nd1, nd2, nd, sub2 and sub: the cumulative claims, and the steps that are linear."""
    bait = "every robot is bait (N <= alpha)"
    for form in ("step", "cumulative"):
        yield _entry("nd2", form, "f(u) >= (1-c)^2 f(u*) in every group", _all_bait(ND, T2), bait)
    for label in ("nd1", "nd"):
        text = "f(u on S) >= (1-c)^3 f(u* on S), which gives min[(1-c)^3, (1-c)^2/alpha_cs] for the team"
        yield _entry(label, "cumulative", text, every_group(ND, T3, ONE, largest=LARGEST_TEAM), GROUPS)
    three = tuple((T3, ONE) for _ in range(3))
    given = "the bounds of Patterns 1 and 2 and of the patterns left out"
    names = ("Pattern 1", "Pattern 2", "any other pattern")
    yield _entry(
        "nd1", "step", "all patterns together", _joined(ND, three, names), given, reading="with the omitted patterns"
    )
    text = "in every other pattern too, f(u on S) >= (1-c)^3 f(u* on S): 'the same approximation bound or a better one'"
    yield _entry("nd_other_patterns", "claim", text, every_group(ND, T3, ONE, largest=LARGEST_TEAM), GROUPS)
    for form in ("step", "cumulative"):
        yield _entry("sub2", form, "f(u) >= (1-k) f(u*) in every group", _all_bait(SUB, T), bait)
    text = "f(u on S) >= (1-k)/(1+k) f(u* on S), which gives min[(1-k)/(1+k), (1-k)/alpha_cs] for the team"
    other = "in every other pattern and distribution too, f(u on S) >= (1-k)/(1+k) f(u* on S)"
    claims = tuple(every_group(SUB, T, ONE_PLUS_K, largest=LARGEST_TEAM))
    yield _entry("sub_other_patterns", "claim", other, claims, GROUPS)
    yield _entry("sub", "cumulative", text, claims, GROUPS)
    both = ("N > alpha", "N <= alpha")
    for label, kind, bounds in (("nd", ND, ((T3, ONE), (T2, ONE))), ("sub", SUB, ((T, ONE_PLUS_K), (T, ONE)))):
        yield _entry(
            label, "step", "both cases together", _joined(kind, bounds, both), "the bounds of N > alpha and N <= alpha"
        )


def _joined(
    kind: FunctionClass, bounds: tuple[tuple[Polynomial, Polynomial], ...], names: tuple[str, ...]
) -> Iterator[SizedClaim]:
    """The first case's bound follows from each case's (opt >= 0)."""
    ground, team, opt = Ground(("u",), (0,)), Linear.of("team"), Linear.of("opt")
    weak_above, weak_below = bounds[0]
    positive = Inequality("opt >= 0", opt)
    for (above, below), name in zip(bounds, names, strict=True):
        given = Inequality(f"the bound for {name}", team * below - opt * above)
        conclusion = team * weak_below - opt * weak_above
        claim = Claim(kind=kind, ground=ground, premises=(given, positive), conclusion=conclusion)
        yield SizedClaim(size=name, robots=1, claim=claim)


def theorems() -> Iterator[Entry]:
    """Yield Theorem 1 and the pattern-free theorem that is stronger."""
    rows = (
        ("eqn:appro_non_descrease", ND, T3, ONE, "Theorem 1: at least (1-c)^3 >= min[(1-c)^3, (1-c)^2/alpha_cs]"),
        (
            "eqn:appro_submodular",
            SUB,
            T,
            ONE_PLUS_K,
            "Theorem 1: at least (1-k)/(1+k) >= min[(1-k)/(1+k), (1-k)/alpha_cs]",
        ),
        ("pattern_free_nd", ND, T2, ONE, "pattern-free: at least (1-c)^2 of the optimum"),
        ("pattern_free_sub", SUB, T, ONE, "pattern-free: at least 1-k of the optimum"),
    )
    for label, kind, above, below, text in rows:
        statement = f"{text}: f(u on S) >= factor f(o on S) for every S and every plan o"
        largest = LARGEST_PATTERN_FREE if label.startswith("pattern_free") else LARGEST_TEAM
        claims = every_group(kind, above, below, largest=largest)
        yield _entry(label, "theorem", statement, claims, GROUPS, chain="theorems")
    bait = "all surviving robots are bait"
    text = "an all-bait group of g robots keeps (1+(g-1)(1-k))/g of the optimum"
    yield _entry("all_bait_sub", "theorem", text, _better(SUB), bait, chain="theorems")
    text = "an all-bait group of g robots keeps (1+(g-1)(1-c))/(1+(g-1)/(1-c)) of the optimum"
    yield _entry("all_bait_nd", "theorem", text, _better(ND), bait, chain="theorems")


def _better(kind: FunctionClass) -> Iterator[SizedClaim]:
    for size in range(1, LARGEST + 1):
        team = team_of(size, 0)
        others = constant(size - 1)
        above = ONE + others * T
        below = constant(size) if kind is SUB else T + others
        above = above if kind is SUB else above * T
        conclusion = team.chosen(team.bait) * below - team.compared(team.bait) * above
        claim = Claim(kind=kind, ground=team.ground, premises=team.premises, conclusion=conclusion)
        yield SizedClaim(size=f"{size} surviving baits", robots=size, claim=claim)


def lemmas() -> Iterator[Entry]:
    """Yield the cited lemmas as the proof uses them, and the remarks on the classes."""
    rows: tuple[tuple[str, FunctionClass, str, Callable[[Value, tuple[str, ...]], Linear]], ...] = (
        ("tzoumas2018_lemma4", ND, "f(S) >= (1-c) sum of f(s)", lambda f, s: f(s) - _sum(f, s) * T),
        ("tzoumas2018_corollary1", ND, "sum of f(s) >= (1-c) f(S)", lambda f, s: _sum(f, s) - f(s) * T),
        ("tzoumas2018_lemma2", SUB, "f(S) >= (1-k) sum of f(s)", lambda f, s: f(s) - _sum(f, s) * T),
        ("submodular_subadditive", SUB, "sum of f(s) >= f(S)", lambda f, s: _sum(f, s) - f(s)),
        (
            "weak_subadditivity",
            ND,
            "f(X) + f(Y) >= (1-c) f(X and Y) for disjoint X, Y: what is left of the subadditivity used",
            lambda f, s: f(s[:1]) + f(s[1:]) - f(s) * T,
        ),
        (
            "subadditivity_as_used",
            ND,
            "f(X) + f(Y) >= f(X and Y) for disjoint X, Y and a non-decreasing f",
            lambda f, s: f(s[:1]) + f(s[1:]) - f(s),
        ),
    )
    for label, kind, text, side in rows:
        claims = []
        for size in (2, 3, 4):
            ground = Ground(tuple("abcd"[:size]), tuple(range(size)))
            conclusion = side(partial(_value, ground), ground.names)
            claims.append(
                SizedClaim(
                    size=f"{size} elements", robots=size, claim=Claim(kind=kind, ground=ground, conclusion=conclusion)
                )
            )
        yield _entry(label, "lemma", text, claims, "the class alone", chain="lemmas")
    greedy = "all robots greedy, in greedy order"
    for label, kind, above, below, text in (
        ("sviridenko2017_theorem8_1", ND, T, ONE, "greedy keeps 1-c of any plan"),
        ("conforti1984_theorem2_3", SUB, ONE, ONE_PLUS_K, "greedy keeps 1/(1+k) of any plan (the formula)"),
        ("conforti1984_in_words", SUB, T, ONE, "greedy keeps 1-k of any plan (the words)"),
    ):
        yield _entry(label, "lemma", text, _greedy(kind, above, below), greedy, chain="lemmas")
    for plan, text in (("chosen", "A* hurts RATT's plan most"), ("compared", "A* hurts the optimum most")):
        statement = "f(u* on W) >= f(u* on V1\\A*) for the |V1|-|A*| greedy robots W (Lemma 9 as used)"
        yield _entry(
            "tzoumas2018_lemma9",
            "lemma",
            statement,
            _lemma9(plan),
            "bait and greedy roles",
            chain="lemmas",
            reading=text,
        )
    yield from _curvatures()


def _value(ground: Ground, names: Iterable[str]) -> Linear:
    return Linear.of(ground.mask(names))


def _sum(f: Value, names: Iterable[str]) -> Linear:
    total = Linear()
    for name in names:
        total = total + f([name])
    return total


def _greedy(kind: FunctionClass, above: Polynomial, below: Polynomial) -> Iterator[SizedClaim]:
    for size in (1, 2, 3, 4):
        team = team_of(0, size)
        conclusion = (team.chosen(team.greedy) * below - team.compared(team.greedy) * above).reduced()
        claim = Claim(kind=kind, ground=team.ground, premises=team.premises, conclusion=conclusion)
        yield SizedClaim(size=f"{size} greedy robots", robots=size, claim=claim)


def _lemma9(plan: str) -> Iterator[SizedClaim]:
    for n_bait, n_greedy in ((1, 1), (2, 1), (1, 2)):
        team = team_of(n_bait, n_greedy)
        for attacked in attacks_on(team.robots, n_bait):
            left = [r for r in team.robots if r not in attacked]
            premises = team.premises + worst_for(team, team.robots, attacked, plan=plan)
            conclusion = team.compared(team.greedy) - team.compared(left)
            claim = Claim(kind=ND, ground=team.ground, premises=premises, conclusion=conclusion)
            yield SizedClaim(size=size_text(team, attacked), robots=len(team.robots), claim=claim, team=team)


def _curvatures() -> Iterator[Entry]:
    """Submodular with curvature k has total curvature at most k: every marginal is at least (1-k) of every other."""
    claims = []
    for size in (2, 3, 4):
        ground = Ground(tuple("abcd"[:size]), tuple(range(size)))
        for base in range(1, 1 << size, 2):
            for other in range(1, 1 << size, 2):
                low = Linear.of(base) - Linear.of(base ^ 1)
                high = Linear.of(other) - Linear.of(other ^ 1)
                claim = Claim(kind=SUB, ground=ground, conclusion=low - high * T)
                text = (
                    f"{size} elements, marginals of a at {ground.text(base ^ 1)[1:]} and {ground.text(other ^ 1)[1:]}"
                )
                claims.append(SizedClaim(size=text, robots=size, claim=claim))
    yield _entry(
        "curvature_is_total_curvature", "lemma", "for submodular f, c <= k", claims, "the class alone", chain="lemmas"
    )


def readings_of_the_attack() -> Iterator[Entry]:
    """Yield eq:team_subgroup and eq:opt_team_subgroup under both readings of A*, as used and as written.

    The proof uses "RATT's worst-case value >= its value under A*" and "the optimum's <= its value under A*".
    """
    for plan, reading in (
        ("chosen", "A* is the plan's worst attack"),
        ("compared", "A* is the optimum's worst attack"),
    ):
        for label, value, used, who in (
            ("team_subgroup", "chosen", ">=", "RATT's"),
            ("opt_team_subgroup", "compared", "<=", "the optimum's"),
        ):
            above, below = tuple(_attack_claims(plan, value)), tuple(_below(value))
            as_used = above if used == ">=" else below
            rows = (("step", used, as_used), ("step as equality", "=", above + below), ("cumulative", used, as_used))
            for kind, relation, claims in rows:
                text = f"{who} worst-case value {relation} its value under A*"
                yield _entry(label, kind, text, claims, "RATT's choices", chain="readings", reading=reading)


def _attack_claims(plan: str, value: str) -> Iterator[SizedClaim]:
    """Blind one of two or three robots in one group: is A*'s value the least, for the plan named by ``value``?"""
    for n_bait, n_greedy in ((1, 1), (1, 2)):
        team = team_of(n_bait, n_greedy)
        side = team.chosen if value == "chosen" else team.compared
        for attacked in attacks_on(team.robots, 1):
            premises = team.premises + worst_for(team, team.robots, attacked, plan=plan)
            here = side(set(team.robots) - set(attacked))
            for other in team.robots:
                if other not in attacked:
                    conclusion = side(set(team.robots) - {other}) - here
                    claim = Claim(kind=ND, ground=team.ground, premises=premises, conclusion=conclusion)
                    text = f"{size_text(team, attacked)}, against blinding {other}"
                    yield SizedClaim(size=text, robots=len(team.robots), claim=claim, team=team)


def _below(value: str) -> Iterator[SizedClaim]:
    """A worst-case value, at most every attack's value, is at most A*'s: true for any A*."""
    team: Team = team_of(1, 1)
    side = team.chosen if value == "chosen" else team.compared
    worst = Linear.of("worst")
    bounds = tuple(Inequality(f"worst <= value without {r}", side(set(team.robots) - {r}) - worst) for r in team.robots)
    for attacked in team.robots:
        conclusion = side(set(team.robots) - {attacked}) - worst
        claim = Claim(kind=ND, ground=team.ground, premises=team.premises + bounds, conclusion=conclusion)
        yield SizedClaim(size=size_text(team, (attacked,)), robots=2, claim=claim)
