"""What the bounds are worth: Theorem 1's are attained by no instance, the pattern-free ones are.

The paper leaves the tightness of ``(1-c)^3`` open. It is not tight: ``(1-c)^2`` always holds. That cannot be
improved for all N: the family of :func:`limit_instance` has ratios that tend to it. For submodular functions ``1-k``
cannot be improved either: the family of :func:`attaining_instance` attains it for every ``k < 1``.
"""

from __future__ import annotations

from fractions import Fraction
from functools import partial
from itertools import combinations
from typing import TYPE_CHECKING

import numpy as np

from ratt_opt._validation import readonly
from ratt_opt.audit.appendix.entry import Counted, EnumeratedEntry
from ratt_opt.audit.appendix.team_lines import every_group
from ratt_opt.audit.engine.claim import FunctionClass
from ratt_opt.audit.engine.decide import Verdict, decide
from ratt_opt.audit.engine.polynomial import ONE, Polynomial, T, constant
from ratt_opt.audit.worst_ratio.class_rows import NonDecreasing
from ratt_opt.audit.worst_ratio.ratio import worst_case_ratio
from ratt_opt.audit.worst_ratio.witness import RatioWitness, replay, scaled_values
from ratt_opt.errors import InputError

if TYPE_CHECKING:
    from collections.abc import Iterator

__all__ = ["attaining_instance", "limit_instance", "limit_ratio", "tightness_entries"]

LARGEST_TEAM = 4
REPLAYED = tuple((size, Fraction(part, 4)) for size, part in ((1, 2), (2, 1), (2, 2), (2, 3), (3, 2)))
"""Sizes g and total curvatures c."""
ATTAINED = tuple((size, Fraction(*k)) for size, k in ((2, (1, 4)), (2, (1, 2)), (3, (3, 5)), (3, (2, 3))))
"""Sizes m and curvatures k."""


def tightness_entries() -> Iterator[EnumeratedEntry]:
    """Yield whether each bound is attained or approached."""
    total, submodular = FunctionClass.TOTAL_CURVATURE, FunctionClass.CURVATURE
    one_plus_k = constant(2) - T
    rows = (
        (
            "theorem1_nd_tight",
            "pattern_free_nd_tight/claim",
            "some instance with 0 < c < 1 attains Theorem 1's bound min[(1-c)^3, (1-c)^2/alpha_cs]",
            partial(_exceeded, total, T * T, ONE, T * T * T, ONE),
        ),
        (
            "theorem1_sub_tight",
            "pattern_free_sub_tight/claim",
            "some instance with 0 < k < 1 attains Theorem 1's bound min[(1-k)/(1+k), (1-k)/alpha_cs]",
            partial(_exceeded, submodular, T, ONE, T, one_plus_k),
        ),
        (
            "pattern_free_sub_tight",
            "",
            "for every k < 1 RATT's worst ratio is 1-k exactly once N is large enough: N = 3m with m >= 1/(1-k)",
            _attained_by_family,
        ),
        ("pattern_free_sub_tight_n4", "", "RATT's worst ratio can be 1-k exactly with four robots", _attained),
        (
            "pattern_free_nd_tight",
            "",
            "RATT's worst ratio comes as close to (1-c)^2 as wanted, as N grows",
            _approached,
        ),
    )
    for label, instead, statement, run in rows:
        yield EnumeratedEntry(
            label=label,
            kind="claim",
            chain="tightness",
            statement=statement,
            hypotheses="all set functions of the class, complete graph",
            enumerate_cases=run,
            serves_by=instead,
        )


def _exceeded(
    kind: FunctionClass, above: Polynomial, below: Polynomial, over: Polynomial, under: Polynomial
) -> Counted:
    """``above/below`` is proved and larger than ``over/under`` strictly inside (0, 1): nothing attains the latter.

    A polynomial whose coefficients as a form in t and 1-t are non-negative, and not all zero, is positive inside.
    """
    claims = list(every_group(kind, above, below, largest=LARGEST_TEAM))
    proved = all(decide(sized.claim).verdict is Verdict.PROVED for sized in claims)
    gap = above * under - over * below
    form = gap.form(gap.degree)
    exceeded = proved and min(form) >= 0 and max(form) > 0
    symbol = kind.symbol
    text = f"RATT keeps at least {above.text(symbol)} of the optimum, more than Theorem 1 says for 0 < {symbol} < 1"
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
    fine = found.exact_upper == 1 - k
    detail = f"exact worst ratio {found.exact_upper} at k = {k}, replayed through the library"
    return Counted(
        verdict=Verdict.PROVED if fine else Verdict.UNDECIDED,
        sizes="N = 4, alpha_s = 0, alpha_c = 3, one value of k",
        detail=detail,
    )


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


def attaining_instance(size: int, curvature: Fraction) -> RatioWitness:
    """Return the instance with ``N = 3 size`` robots, ``alpha_s = size`` on which RATT keeps exactly ``1 - curvature``.

    Let ``t = 1-k`` and m = ``size``. A weighted coverage function, hence submodular and non-decreasing. Each element
    covers an item of its own, and some share items: robots ``b`` (m of them), ``r`` (m) and ``v`` (m) have

    - ``b_i``: own t, and shared items ``W_1 .. W_m`` of weight ``k/m`` each; ``o(b_i)``: own 1;
    - ``r_j``: own t, and a shared item of weight k; ``o(r_j)``: own 1;
    - ``v_j``: own ``t - k/m``, and ``W_j``; ``o(v_j)``: own t, and the shared item of ``r_j``.

    *Class.* The own part of an element is its smallest marginal: t times its value 1, or for ``v_j``, worth t,
    ``t - k/m >= t^2`` as ``m t >= 1``. So the curvature is k.
    *RATT.* All robots' best single values are 1, so the first m robots, b, are the bait (ties by index). Greedy then
    takes the r, whose marginals stay 1 (no element has more), and then the v: ``v_j`` adds t, and so does
    ``o(v_j)`` beside ``r_j``. *Attack.* Blinding the r leaves ``m t + k + m (t - k/m) = 2 m t``. *Optimum.* The
    other plan covers no item twice: it is additive, 1 each, and keeps 2m whatever m robots are blinded. So the ratio
    is at most t, and the pattern-free theorem says at least t.

    Parameters
    ----------
    size : m >= 1; curvature : k in [0, 1 - 1/m]

    Raises
    ------
    InputError : ``curvature`` is larger, where ``v_j`` would exceed it.
    """
    if not 0 <= curvature <= 1 - Fraction(1, size):
        raise InputError("curvature", f"must be in [0, {1 - Fraction(1, size)}]", curvature)
    n, whole = 3 * size, curvature.denominator * size
    part = int(whole * curvature) // size
    kept = whole - size * part
    own = [kept] * (2 * size) + [kept - part] * size + [whole] * (2 * size) + [kept] * size
    bait, removed, victims = range(size), range(size, 2 * size), range(2 * size, n)
    items: list[tuple[int, tuple[int, ...]]] = [(weight, (element,)) for element, weight in enumerate(own)]
    items += [(part, (*bait, v)) for v in victims]
    items += [(size * part, (r, n + v)) for r, v in zip(removed, victims, strict=True)]
    masks = np.arange(1 << 2 * n)
    values = sum(weight * (masks & _mask(covers) != 0).astype(np.int64) for weight, covers in items)
    return RatioWitness(
        values=readonly(np.asarray(values)),
        n_robots=n,
        alpha_s=size,
        alpha_c=0,
        curvature=curvature,
        family="submodular",
        domain="elements",
        planner="ratt",
    )


def limit_ratio(size: int, curvature: Fraction) -> Fraction:
    """``(1 + (g-1)(1-c)) / (1 + (g-1)/(1-c))`` for ``g = size`` robots left."""
    kept = 1 - curvature
    return (1 + (size - 1) * kept) / (1 + (size - 1) / kept)


def limit_instance(size: int, curvature: Fraction) -> RatioWitness:
    """Return the instance with ``N = 2 size`` robots, ``alpha_s = size`` on which RATT has :func:`limit_ratio`.

    Let ``t = 1-c``. Largest marginals are 1 for RATT's elements and ``1/t`` for the others. Prescribed: any number
    ``a >= 1`` of bait elements is worth ``1 + (a-1) t``; ``b`` greedy elements are worth ``b``, and with one other
    element ``b + 1``; ``d >= 1`` others are worth ``1 + (d-1)/t``. All single values are 1, so RATT picks its own
    elements by the tie rule. Blinding the greedy half leaves it ``1 + (g-1) t``; the other plan keeps
    ``1 + (g-1)/t`` whatever ``g`` robots are left.

    Such values extend to a function of total curvature c if for all prescribed sets ``f(X) - f(Y)`` is at most
    ``m(X-Y) - t m(Y-X)`` (see ``NonDecreasing``). Two sets of a kind differ by the difference of their sizes times t,
    1 or 1/t, within those bounds. Between kinds (first X, then Y; ``M`` is b greedy elements and one other):
    others, bait: ``t - 1/t <= 0``; bait, others: ``(a-1)(t-1) - (d-1)(1/t-1) <= 0``;
    others, greedy: ``1 - 1/t <= b(1-t)``; greedy, others: ``(d-1)(1-1/t) <= 0``;
    bait, greedy: ``(a-1)(t-1) <= b(1-t)``; greedy, bait: ``t <= 1``;
    others, M: ``b(t-1) <= 0`` with the same other, else ``1 - 1/t <= b(1-t)``; M, others: ``(d-1)(1-1/t) <= 0``, else
    ``d(1-1/t) <= 0``; M, bait: ``t <= 1/t``; bait, M: ``(a-1)(t-1) <= b(1-t)``; M and greedy: ``1 <= 1/t``.

    Parameters
    ----------
    size : g >= 1; curvature : c in [0, 1)
    """
    n, kept = 2 * size, 1 - curvature
    bait, greedy, others = range(size), range(size, n), range(n, 2 * n)
    known: dict[int, Fraction] = {}
    for count in range(1, n + 1):
        for chosen in combinations(others, count):
            known[_mask(chosen)] = 1 + (count - 1) / kept
        for chosen in combinations(bait, count):
            known[_mask(chosen)] = 1 + (count - 1) * kept
        for chosen in combinations(greedy, count):
            known[_mask(chosen)] = Fraction(count)
            for other in others:
                known[_mask((*chosen, other))] = Fraction(count + 1)
    part = NonDecreasing(n, curvature, list(known))
    point = [Fraction(0), *[Fraction(1)] * n, *[1 / kept] * n, *known.values()]
    values = scaled_values(part.table(point, list(known)))
    assert values is not None, "small integers"
    return RatioWitness(
        values=values,
        n_robots=n,
        alpha_s=size,
        alpha_c=0,
        curvature=curvature,
        family="nondecreasing",
        domain="elements",
        planner="ratt",
    )


def _mask(elements: tuple[int, ...]) -> int:
    return sum(1 << e for e in elements)
