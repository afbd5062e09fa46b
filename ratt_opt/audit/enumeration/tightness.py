"""What the bounds are worth: Theorem 1's are attained by no instance, the pattern-free ones are.

The paper leaves the tightness of ``(1-c)^3`` open. It is not tight: ``(1-c)^2`` always holds. That cannot be
improved for all N: the family of ``limit_instance`` has ratios that tend to it. For submodular functions ``1-k``
cannot be improved either: the family of ``attaining_instance`` attains it for every ``k < 1``.
"""

from __future__ import annotations

from fractions import Fraction
from functools import partial
from typing import TYPE_CHECKING

from ratt_opt.audit.appendix.entry import Counted, EntryKind, EnumeratedEntry, Reference
from ratt_opt.audit.appendix.roles import CUBED, KEPT, KEPT_OVER_ONE_PLUS_K, SQUARED, Factor, every_group
from ratt_opt.audit.engine.claim import FunctionClass
from ratt_opt.audit.engine.decide import Verdict, decide
from ratt_opt.audit.worst_ratio.ratio import worst_case_ratio
from ratt_opt.audit.worst_ratio.witness import attaining_instance, limit_instance, limit_ratio, replay
from ratt_opt.stopping import Stop

if TYPE_CHECKING:
    from collections.abc import Iterator

__all__ = ["tightness_entries"]

LARGEST_TEAM = 4
REPLAYED = tuple((size, Fraction(part, 4)) for size, part in ((1, 2), (2, 1), (2, 2), (2, 3), (3, 2)))
"""Sizes g and total curvatures c."""
ATTAINED = tuple((size, Fraction(*k)) for size, k in ((2, (1, 4)), (2, (1, 2)), (3, (3, 5)), (3, (2, 3))))
"""Sizes m and curvatures k."""
SUB_TIGHT, ND_TIGHT = (Reference(f"pattern_free_{name}_tight", EntryKind.CLAIM) for name in ("sub", "nd"))
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
    text = "for every k < 1 RATT's worst ratio is 1-k exactly once N is large enough: N = 3m with m >= 1/(1-k)"
    yield _claim(label=SUB_TIGHT.label, statement=text, enumerate_cases=_attained_by_family)
    text = "RATT's worst ratio can be 1-k exactly with four robots"
    yield _claim(label=f"{SUB_TIGHT.label}_n4", statement=text, enumerate_cases=_attained)
    text = "RATT's worst ratio comes as close to (1-c)^2 as wanted, as N grows"
    yield _claim(label=ND_TIGHT.label, statement=text, enumerate_cases=_approached)


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
    keeps = f"RATT keeps at least {proved.above.text(symbol)} of the optimum"
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
    found = worst_case_ratio(4, 0, 3, curvature=k, family="submodular")
    if found.stop is Stop.INTERRUPTED:
        raise KeyboardInterrupt
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
