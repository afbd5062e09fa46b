"""More families of instances on which RATT is exactly as bad as its bounds allow; ``witness.py`` replays each.

Robots are named as in ``ratio_search.py``: bait first, then greedy robots in greedy order; ties go by that order.
"""

from __future__ import annotations

from fractions import Fraction
from itertools import combinations
from typing import TYPE_CHECKING

import numpy as np

from ratt_opt._validation import readonly
from ratt_opt.errors import InputError
from ratt_opt.worst_ratio.class_rows import NonDecreasing
from ratt_opt.worst_ratio.witness import RatioQuestion, RatioWitness, scaled_values

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping

__all__ = ["link_only_instance", "pair_instance", "sensing_instance", "shared_plan_instance"]


def pair_instance(curvature: Fraction) -> RatioWitness:
    """Return the instance with ``N = 3``, ``alpha_s = 1`` on which RATT keeps ``(1 + t^2) / 2``, ``t = 1 - curvature``.

    The survivor bound for groups of two. A weighted coverage function: bait ``b`` and the second greedy robot ``g``
    share ``t k``, the first one ``r`` and ``o(g)`` share ``k``; each covers alone what makes ``b, r`` and all ``o``
    worth 1 and ``g`` worth t, which is at least t times its value. ``r`` comes first; beside it ``g`` and ``o(g)`` add
    t each. Blinding ``r`` leaves ``1 + t^2``, and any two ``o`` are worth 2.
    """
    k, t = curvature, 1 - curvature
    own = (1 - t * k, t, t**2, 1, 1, t)
    shared: dict[tuple[int, ...], Fraction] = {(0, 2): t * k, (1, 5): k}
    return _coverage(RatioQuestion(n_robots=3, alpha_s=1, alpha_c=0, curvature=k, family="submodular"), own, shared)


def shared_plan_instance(size: int, curvature: Fraction) -> RatioWitness:
    """Return an instance, ``N = 2g``, ``alpha_s = g = size``, on which three planners have ``(1 + (g-1) t) / g``.

    RATT, the myopic planner and Greedy return one plan, so the best of them is no better: over all teams it keeps no
    share above ``t = 1 - curvature`` either. A weighted coverage function: each bait element covers t alone and all
    of them ``k`` together, each greedy element t alone and ``k`` with the other element of one bait robot, which covers
    t alone, and the other elements of greedy robots 1. All are worth 1 alone. Greedy takes one bait element, then the
    greedy robots' (1 each), then the other bait elements, which add t as their rivals do by then. Blinding the greedy
    robots leaves ``g t + k``; the other plan shares nothing and keeps g.
    """
    g, k, t = size, curvature, 1 - curvature
    own = [t] * (3 * g) + [Fraction(1)] * g
    shared: dict[tuple[int, ...], Fraction] = {tuple(range(g)): k} if g > 1 else {}
    shared |= {(g + i, 2 * g + i): k for i in range(g)}
    if g == 1:
        own[0] = Fraction(1)
    question = RatioQuestion(n_robots=2 * g, alpha_s=g, alpha_c=0, curvature=k, family="submodular")
    return _coverage(question, own, shared)


def link_only_instance(curvature: Fraction) -> RatioWitness:
    """Return the instance with ``N = 7``, ``alpha_c = 11``, nobody blinded, on which RATT keeps ``1 - curvature``.

    Links alone are enough for ``1-k``. CAA gives ``n_max = 5``: bait b1, b2, and greedy robots r1, r2, v1, v2, v3. Let
    ``t = 1-k``. A weighted coverage function with, beside what each element covers alone: ``k^2`` on b1, b2, v1,
    o(r1); ``t k`` on b1, b2, v2, o(v3); ``k (t-k)`` on v1, o(r1); ``t^2 k`` on v3, o(r1); ``k`` on r1, o(v1) and on
    r2, o(v2). The values are 1, but t for v1, v2, o(v3) and ``t^2`` for v3, and the parts covered alone at least t
    times that, as ``t^2 <= k <= 1/2``. Greedy takes r1, r2 (1), v1, v2 (t, as each o(v) then adds) and v3 (``t^2``).
    Isolating r1 and r2 leaves ``4 t + t^2``; the elements o share nothing, so five of them are worth at least ``4 +
    t``.

    Raises
    ------
    InputError : ``curvature`` is not in ``[(3 - sqrt(5)) / 2, 1/2]``.
    """
    k, t = curvature, 1 - curvature
    if k > Fraction(1, 2) or t**2 > k:
        raise InputError("curvature", "must be in [(3 - sqrt(5))/2, 1/2]", curvature)
    own = (t, t, t, t, t**2, t**2, t**3, 1, 1, 1 - t * k - t**2 * k, 1, t, t, t**2)
    shared = {
        (0, 1, 4, 9): k**2,
        (0, 1, 5, 13): t * k,
        (4, 9): k * (t - k),
        (6, 9): t**2 * k,
        (2, 11): k,
        (3, 12): k,
    }
    return _coverage(RatioQuestion(n_robots=7, alpha_s=0, alpha_c=11, curvature=k, family="submodular"), own, shared)


def _coverage(
    question: RatioQuestion, own: Iterable[Fraction | int], shared: Mapping[tuple[int, ...], Fraction]
) -> RatioWitness:
    """The weighted coverage function of items that one element covers (``own``, in order) or several share."""
    items: list[tuple[tuple[int, ...], Fraction]] = [((e,), Fraction(weight)) for e, weight in enumerate(own)]
    items += shared.items()
    masks = np.arange(4**question.n_robots)
    weights = scaled_values([weight for _, weight in items])
    assert weights is not None, "small fractions"
    values = sum(int(w) * (masks & _mask(covers) != 0) for (covers, _), w in zip(items, weights, strict=True))
    return question.witness(readonly(np.asarray(values, dtype=np.int64)))


def sensing_instance(size: int, swapped: int, curvature: Fraction) -> RatioWitness:
    """Return the instance with ``N = g + p``, ``alpha_s = p``, no link cut, on which RATT keeps :func:`sensing_ratio`.

    ``g = size`` robots are left, ``p = swapped <= g``, ``t = 1-c``, ``h = min(g-1, p (1 + 1/t))`` or ``g - 1`` if p
    is 0. Robots have weights w: 1, but the last ``g - p`` greedy ones, in order, as much as leaves them ``h + 1 - p``
    in all, so at most one is between 0 and 1. Largest marginals are w for bait and for those greedy elements, ``1/t``
    for the first p greedy ones, and ``w/t`` for the others'. Prescribed: an element alone is worth w; the first greedy
    elements are worth their weight, and with one element of a later robot its weight more; bait and the last ``g - p``
    greedy ones together ``1 + t h`` (for ``p > 0``); others of weight W in all ``1 + (W-1)/t``, or W if none of them
    has weight 1. Ties go to RATT's elements. Blinding the first p greedy robots leaves ``1 + t h``, without any ``g``;
    blinding any p leaves the others a weight of at least ``h + 1``, hence ``1 + h/t``.

    Such values extend to a function of total curvature c if ``f(X) - f(Y) <= m(X-Y) - t m(Y-X)`` for all prescribed X,
    Y (see ``NonDecreasing``). Two sets of a kind differ by elements that add at least t and at most 1 times their m.
    Let G be r of the first p greedy elements and others of weight j, L the set left, of weight ``h + 1``, D others of
    weight W. G, L: ``(j-1)(1-t) <= r (1/t - 1)``, as ``j <= 1 + p/t``, and j is 0 unless r is p; this is what bounds
    the weights. L, G: ``1 + t h <= h + 1``. D, L: ``t <= 1/t``. L, D: ``(W-1)(1-1/t) <= h (1-t)``. D, G: ``1 - 1/t <=
    j (1-t)``. G, D: ``r (1-1/t) + (W-1)(1-1/t) <= 0``. G with one more element e of weight w adds w on the left, and w
    or ``w/t`` on the right; D with e in it, the same but w: ``(1-w)(1-1/t) <= j (1-t)``. Single elements are among
    these or simpler, and so is D without weight 1.

    Raises
    ------
    InputError : ``swapped`` is not in ``[0, g]`` or ``curvature`` not in [0, 1).
    """
    kept, n = 1 - curvature, size + swapped
    if not 0 <= swapped <= size:
        raise InputError("swapped", f"must be in [0, {size}]", swapped)
    if not 0 <= curvature < 1:
        raise InputError("curvature", "must be in [0, 1)", curvature)
    whole = 1 + swapped / kept if swapped else Fraction(size)
    last = [max(min(Fraction(1), whole - i), Fraction(0)) for i in range(size - swapped)]
    weight = [Fraction(1)] * (2 * swapped) + last
    left = (*range(swapped), *range(2 * swapped, n))
    known = {1 << e: weight[e % n] for e in range(2 * n)}
    for count in range(1, n + 1):
        for chosen in combinations(range(n), count):
            total = sum((weight[i] for i in chosen), Fraction(0))
            all_light = max(weight[i] for i in chosen) < 1
            known[_mask(n + i for i in chosen)] = total if all_light else 1 + (total - 1) / kept
    for end in range(swapped + 1, n + 1):
        first = range(swapped, end)
        value = sum((weight[i] for i in first), Fraction(0))
        known[_mask(first)] = value
        known |= {_mask((*first, e)): value + weight[i] for i in range(end, n) for e in (i, n + i)}
    if swapped:
        known[_mask(left)] = 1 + (sum((weight[i] for i in left), Fraction(-1))) * kept
    largest = weight[:swapped] + [1 / kept] * swapped + last + [w / kept for w in weight]
    part = NonDecreasing(n, curvature, list(known))
    values = scaled_values(part.table([Fraction(0), *largest, *known.values()], list(known)))
    assert values is not None, "small integers"
    question = RatioQuestion(n_robots=n, alpha_s=swapped, alpha_c=0, curvature=curvature, family="nondecreasing")
    return question.witness(values)


def _mask(elements: Iterable[int]) -> int:
    return sum(1 << e for e in elements)
