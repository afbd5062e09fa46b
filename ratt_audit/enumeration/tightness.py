"""Tightness of the bounds: no instance attains Theorem 1's; the pattern-free and size bounds are compared.

The paper leaves the tightness of ``(1-c)^3`` open. It is not tight: ``(1-c)^2`` always holds. Over all teams nothing
larger does: ``1-k`` and ``(1-c)^2`` are infima, the first attained if ties go against RATT, both approached without.
For given budgets the survivor and group-size bounds say more.
"""

from __future__ import annotations

from fractions import Fraction
from functools import partial
from typing import TYPE_CHECKING

from ratt_audit.appendix.entry import Counted, EntryKind, EntryName, EnumeratedEntry
from ratt_audit.appendix.roles import CUBED, KEPT, KEPT_OVER_ONE_PLUS_K, SQUARED, Factor, every_group
from ratt_audit.engine.decide import Verdict, decide
from ratt_opt.bounds.survivors import survivor_share
from ratt_opt.budget import uninterrupted
from ratt_opt.worst_ratio.closed_form import sensing_ratio
from ratt_opt.worst_ratio.families import link_only_instance, pair_instance, sensing_instance
from ratt_opt.worst_ratio.function_class import FunctionClass
from ratt_opt.worst_ratio.ratio import worst_case_ratio
from ratt_opt.worst_ratio.witness import attaining_instance, limit_instance, limit_ratio, replay

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

    from ratt_opt.worst_ratio.witness import RatioWitness

__all__ = ["tightness_entries"]

LARGEST_TEAM = 4
REPLAYED = tuple((size, Fraction(part, 4)) for size, part in ((1, 2), (2, 1), (2, 2), (2, 3), (3, 2)))
"""Sizes g and total curvatures c."""
ATTAINED = tuple((size, Fraction(*k)) for size, k in ((2, (1, 4)), (2, (1, 2)), (3, (3, 5)), (3, (2, 3))))
"""Sizes m and curvatures k."""
SHRINKING = (Fraction(1, 10), Fraction(1, 100))
SENSING = tuple((g, p, Fraction(*c)) for g, p, c in ((2, 1, (1, 4)), (3, 1, (1, 4)), (4, 1, (1, 4)), (3, 2, (9, 10))))
"""Robots left, robots blinded, and total curvatures."""
SUB_TIGHT, ND_TIGHT = (EntryName(f"pattern_free_{name}_tight", EntryKind.CLAIM) for name in ("sub", "nd"))
GIVEN = "all set functions of the class, complete graph"
_claim = partial(EnumeratedEntry, kind=EntryKind.CLAIM, chain="tightness", hypotheses=GIVEN)


def tightness_entries() -> Iterator[EnumeratedEntry]:
    """Yield whether each bound is attained or approached."""
    text = "some instance with 0 < c < 1 attains Theorem 1's bound min[(1-c)^3, (1-c)^2/alpha_cs]"
    run = partial(_exceeded, FunctionClass.TOTAL_CURVATURE, SQUARED, CUBED)
    yield _claim(label="theorem1_nd_tight", statement=text, enumerate_cases=run, serves_by=ND_TIGHT)
    text = "some instance with 0 < k < 1 attains Theorem 1's bound min[(1-k)/(1+k), (1-k)/alpha_cs]"
    run = partial(_exceeded, FunctionClass.CURVATURE, KEPT, KEPT_OVER_ONE_PLUS_K)
    yield _claim(label="theorem1_sub_tight", statement=text, enumerate_cases=run, serves_by=SUB_TIGHT)
    text = "for every k < 1 some team has worst ratio 1-k exactly if ties go against RATT (N = 3m, m >= 1/(1-k))"
    yield _claim(label=SUB_TIGHT.label, statement=text, enumerate_cases=_attained_by_family)
    text = "without ties RATT's ratio comes as close to 1-k as wanted: at most 1-k + 3/2 epsilon"
    yield _claim(label=f"{SUB_TIGHT.label}_no_ties", statement=text, enumerate_cases=_attained_without_ties)
    text = "links alone are enough for 1-k: N = 7, nobody blinded, alpha_c = 11, k = 1/2 and 2/5"
    yield _claim(label=f"{SUB_TIGHT.label}_links", statement=text, enumerate_cases=_attained_by_links)
    text = "RATT's worst ratio can be 1-k exactly with four robots"
    yield _claim(label=f"{SUB_TIGHT.label}_n4", statement=text, enumerate_cases=_attained)
    text = "RATT's worst ratio comes as close to (1-c)^2 as wanted, as N grows"
    yield _claim(label=ND_TIGHT.label, statement=text, enumerate_cases=_approached)
    text = (
        "without links cut RATT's worst ratio for total curvature c is (1+th)/(1+h/t), h = min(g-1, p (1+1/t)), t = 1-c"
    )
    yield _claim(label="sensing_nd_exact", statement=text, enumerate_cases=_sensing_attained)
    text = "without links cut the survivor bound is attained for curvature k and groups of two: (1 + (1-k)^2)/2"
    yield _claim(label="survivors_sub_tight", statement=text, enumerate_cases=_pairs_attained)


def _exceeded(function_class: FunctionClass, proved: Factor, printed: Factor) -> Counted:
    """``proved`` always holds and is larger than ``printed`` strictly inside (0, 1): nothing attains the latter.

    A polynomial whose coefficients as a form in t and 1-t are non-negative, and not all zero, is positive inside.
    """
    claims = list(every_group(function_class, proved, largest=LARGEST_TEAM))
    holds = all(decide(sized.claim).verdict is Verdict.PROVED for sized in claims)
    gap = proved.above * printed.below - printed.above * proved.below
    form = gap.form(gap.degree)
    exceeded = holds and min(form) >= 0 and max(form) > 0
    symbol = function_class.symbol
    keeps = f"RATT has at least {proved.above.text(symbol)} of the optimum"
    text = f"{keeps}, more than Theorem 1 says for 0 < {symbol} < 1"
    return Counted(
        verdict=Verdict.REFUTED if exceeded else Verdict.UNDECIDED,
        sizes=f"up to {LARGEST_TEAM} robots in play by machine; the pattern-free theorem's proof holds for any number",
        detail=f"{len(claims)} cases of the pattern-free bound decided",
        cases=(text,) if exceeded else (),
    )


def _attained() -> Counted:
    """N = 4, three links cut: one robot is isolated."""
    k = Fraction(3, 10)
    found = uninterrupted(worst_case_ratio(4, 0, 3, curvature=k, family="submodular"))
    verdict = Verdict.PROVED if found.exact_upper == 1 - k else Verdict.UNDECIDED
    detail = f"exact worst ratio {found.exact_upper} at k = {k}, replayed through the library"
    return Counted(verdict=verdict, sizes="N = 4, alpha_s = 0, alpha_c = 3, one value of k", detail=detail)


def _attained_by_family() -> Counted:
    for size, k in ATTAINED:
        ratio = replay(attaining_instance(size, k))
        if ratio != 1 - k:
            return Counted(verdict=Verdict.UNDECIDED, sizes=f"m = {size}, k = {k}", detail=f"replayed ratio {ratio}")
    detail = f"{len(ATTAINED)} weighted coverage functions replayed through the library; the ratio is 1-k each time"
    sizes = f"replayed for (m, k) in {', '.join(f'({m}, {k})' for m, k in ATTAINED)}; any m by its proof"
    return Counted(verdict=Verdict.PROVED, sizes=sizes, detail=detail)


def _attained_without_ties() -> Counted:
    found = {(size, k, e): replay(attaining_instance(size, k, e)) for size, k in ATTAINED for e in SHRINKING}
    wrong = [case for case, ratio in found.items() if ratio > 1 - case[1] + Fraction(3, 2) * case[2]]
    detail = f"{len(found)} instances replayed, epsilon {' and '.join(map(str, SHRINKING))}; {len(wrong)} above"
    verdict = Verdict.UNDECIDED if wrong else Verdict.PROVED
    return Counted(verdict=verdict, sizes="replayed for the same (m, k); any m by its proof", detail=detail)


def _attained_by_links() -> Counted:
    return _replayed({f"k = {k}": (link_only_instance(k), 1 - k) for k in (Fraction(1, 2), Fraction(2, 5))})


def _sensing_attained() -> Counted:
    cases = {
        f"(g, p, c) = ({g}, {p}, {c})": (sensing_instance(g, p, c), sensing_ratio(g, p, 1 - c)) for g, p, c in SENSING
    }
    return _replayed(cases)


def _pairs_attained() -> Counted:
    shares = (Fraction(1, 4), Fraction(1, 2), Fraction(9, 10))
    return _replayed({f"k = {k}": (pair_instance(k), survivor_share(2, 1 - k, submodular=True)) for k in shares})


def _replayed(cases: Mapping[str, tuple[RatioWitness, Fraction]]) -> Counted:
    """Instances against the ratio each must have."""
    found = {name: (replay(witness), ratio) for name, (witness, ratio) in cases.items()}
    attained = all(got == ratio for got, ratio in found.values())
    detail = f"replayed through the library: {', '.join(f'{name}: {got}' for name, (got, _) in found.items())}"
    verdict = Verdict.PROVED if attained else Verdict.UNDECIDED
    return Counted(verdict=verdict, sizes="the cases replayed; any by the family's proof", detail=detail)


def _approached() -> Counted:
    reached = []
    for size, c in REPLAYED:
        ratio = replay(limit_instance(size, c))
        if ratio != limit_ratio(size, c):
            return Counted(verdict=Verdict.UNDECIDED, sizes=f"g = {size}, c = {c}", detail=f"replayed ratio {ratio}")
        reached.append(ratio)
    detail = (
        f"{len(reached)} instances replayed through the library; with g robots left of N = 2g, alpha_s = g, the ratio "
        "is (1+(g-1)(1-c))/(1+(g-1)/(1-c)), which tends to (1-c)^2"
    )
    sizes = f"replayed for (g, c) in {', '.join(f'({g}, {c})' for g, c in REPLAYED)}; any g by its proof"
    return Counted(verdict=Verdict.PROVED, sizes=sizes, detail=detail)
