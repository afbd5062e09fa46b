"""More families of instances on which RATT is exactly as bad as its bounds allow; ``witness.py`` replays each.

Robots are named as in ``search.py``: bait first, then greedy robots in greedy order; ties go by that order.
"""

from __future__ import annotations

from fractions import Fraction
from itertools import combinations
from typing import TYPE_CHECKING

import numpy as np

from ratt_opt._validation import readonly
from ratt_opt.audit.worst_ratio.class_rows import NonDecreasing
from ratt_opt.audit.worst_ratio.witness import RatioQuestion, RatioWitness, scaled_values
from ratt_opt.errors import InputError

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping

__all__ = ["is_attained", "link_only_instance", "pair_instance", "sensing_instance", "shared_plan_instance"]


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
    """Return an instance with ``N = 2g``, ``alpha_s = g = size`` on which three planners keep ``(1 + (g-1) t) / g``.

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
    Isolating r1 and r2 leaves ``4 t + t^2``; the elements o share nothing, so five of them keep at least ``4 + t``.

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


def is_attained(size: int, swapped: int, kept: Fraction) -> bool:
    """Whether ``g - 1 <= p (1 + 1/t)`` for g, p and t: see :func:`sensing_instance`."""
    return (size - 1) * kept <= swapped * (kept + 1)


def sensing_instance(size: int, swapped: int, curvature: Fraction) -> RatioWitness:
    """Return the instance with ``N = g + p``, ``alpha_s = p``, no link cut, on which RATT attains the survivor bound.

    ``g = size`` robots are left, ``1 <= p = swapped <= g``, ``t = 1-c``. Largest marginals are 1 for the p bait
    elements and the last ``g - p`` greedy ones, ``1/t`` for the first p greedy ones and the others. Prescribed: the
    first i greedy elements are worth i, with one element of another greedy robot ``i + 1``; bait and the last ``g - p``
    greedy ones together ``1 + (g-1) t``; ``d >= 1`` others ``1 + (d-1)/t``; single elements 1. Ties go to RATT's
    elements. Blinding the first p greedy robots leaves ``1 + (g-1) t``; the others keep ``1 + (g-1)/t`` after every
    attack. Such values extend to a function of total curvature c (see ``NonDecreasing``) if ``g - 1 <= p (1 + 1/t)``:
    that is the pair of all greedy elements and the set left, the other pairs hold for every g.

    Conversely, with ``alpha_c = 0 < alpha_s`` no instance attains the bound, for 0 < c < 1, unless
    ``g - 1 <= min(alpha_s, g) (1 + 1/t)``. Equality in the bound's proof, for the set S left with p baits and
    ``x = 1``, needs ``m_(o_i) = 1/t`` for all but one robot of S, ``m_(u_i) = 1`` for the same, and ``phi(u_S) = 1 +
    (g-1) t``. So every greedy element up to the last one of S adds at least ``t/t = 1`` when it is picked. Let q of
    these be outside S; ``q <= p``, as g robots are greedy. None is worth more than 1, so none has marginals above
    ``1/t``. Taking them away and putting the p baits in, ``phi(u_S) >= g - p + q - q/t + p t >= g - p/t + p t``, and
    that this is at most ``1 + (g-1) t`` is the condition. (A set left without bait holds all greedy robots, and keeps
    ``g / (1 + (g-1)/t)``, which is more.) With more than g blinded robots, g of them are as here and the rest are bait
    of any value, the same in both plans.

    Raises
    ------
    InputError : the condition fails, or ``swapped`` or ``curvature`` is out of range.
    """
    kept = 1 - curvature
    if not 1 <= swapped <= size:
        raise InputError("swapped", f"must be in [1, {size}]", swapped)
    if not 0 <= curvature < 1 or not is_attained(size, swapped, kept):
        raise InputError("curvature", "must be in [0, 1) with g - 1 <= p (1 + 1/(1-c))", curvature)
    n = size + swapped
    bait, greedy, others = range(swapped), range(swapped, n), range(n, 2 * n)
    known = {1 << e: Fraction(1) for e in range(2 * n)}
    for count in range(1, n + 1):
        for chosen in combinations(others, count):
            known[_mask(chosen)] = 1 + (count - 1) / kept
    for count in range(1, size + 1):
        first, rest = greedy[:count], (*greedy[count:], *others[swapped + count :])
        known[_mask(first)] = Fraction(count)
        known |= {_mask((*first, other)): Fraction(count + 1) for other in rest}
    known[_mask((*bait, *greedy[swapped:]))] = 1 + (size - 1) * kept
    largest = [Fraction(1)] * swapped + [1 / kept] * swapped + [Fraction(1)] * (size - swapped) + [1 / kept] * n
    part = NonDecreasing(n, curvature, list(known))
    values = scaled_values(part.table([Fraction(0), *largest, *known.values()], list(known)))
    assert values is not None, "small integers"
    question = RatioQuestion(n_robots=n, alpha_s=swapped, alpha_c=0, curvature=curvature, family="nondecreasing")
    return question.witness(values)


def _mask(elements: Iterable[int]) -> int:
    return sum(1 << e for e in elements)
