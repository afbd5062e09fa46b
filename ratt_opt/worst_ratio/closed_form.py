"""RATT's exact worst ratio in closed form: what is proved, what an instance attains, what is conjectured."""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from typing import TYPE_CHECKING

from ratt_opt.bounds.group_size import group_size_share
from ratt_opt.bounds.survivors import survivor_share
from ratt_opt.graph.survivor_sizes import forced_group_size, non_dominated_sizes

if TYPE_CHECKING:
    from ratt_opt.worst_ratio.witness import RatioQuestion

__all__ = ["KnownRatio", "known_ratio", "pattern_free_ratio", "proved_ratio", "sensing_ratio", "three_left_ratio"]


@dataclass(frozen=True, slots=True, kw_only=True)
class KnownRatio:
    """Knowledge of one worst ratio without computing it.

    ``lower`` : a share that a written proof guarantees. ``attained`` : whether a written family of instances has it, so
    that it is the ratio. ``conjectured`` : the ratio as conjectured from computed values, if that is more.
    """

    lower: Fraction
    attained: bool
    conjectured: Fraction | None = None


def pattern_free_ratio(curvature: Fraction, family: str) -> Fraction:
    """Return ``1 - k`` or ``(1 - c)**2`` exactly: RATT, Greedy and the myopic planner reach it on any instance.

    Proved in ``bounds.guarantees.pattern_free_bound``: its plan is any whose robots are bait or chosen greedily.
    They are the infima over all teams: ``witness.attaining_instance`` attains the first for every ``k < 1`` if ties
    go against RATT and comes as close as wanted without ties; the ratios of ``witness.limit_instance`` tend to the
    second.
    """
    return 1 - curvature if family == "submodular" else (1 - curvature) ** 2


def proved_ratio(question: RatioQuestion) -> Fraction:
    """Return the largest share that a written proof gives the planner at these budgets, exactly."""
    return known_ratio(question).lower


def known_ratio(question: RatioQuestion) -> KnownRatio:
    """Collect what written proofs, families and conjectures say of one worst ratio on the complete graph.

    For RATT the best of :func:`survivor_bound`, :func:`group_size_bound` (if a bait always survives) and, if no
    cut splits the team, :func:`sensing_ratio`; for the other planners the pattern-free bound.
    """
    kept, submodular = 1 - question.curvature, question.family == "submodular"
    least = pattern_free_ratio(question.curvature, question.family)
    if question.planner != "ratt":
        return KnownRatio(lower=least, attained=least == 1)
    n, blinded = question.n_robots, question.alpha_s
    sizes = non_dominated_sizes(n, blinded, question.alpha_c)
    largest, smallest = sizes[0][0], forced_group_size(n, blinded, question.alpha_c)
    lower = max(least, survivor_share(largest, kept, submodular=submodular))
    if smallest <= 1 or question.n_bait > blinded:
        lower = max(lower, group_size_share(smallest, kept, submodular=submodular))
    if len(sizes[0]) > 1 or question.n_bait > blinded or lower == 1:
        return KnownRatio(lower=lower, attained=lower == 1)
    return _unsplit(question, lower, kept, submodular=submodular)


def _unsplit(question: RatioQuestion, lower: Fraction, kept: Fraction, *, submodular: bool) -> KnownRatio:
    """No cut splits the team: as many greedy robots as see, and bait for those that can be blinded."""
    size, swapped = question.n_robots - question.alpha_s, min(question.alpha_s, question.n_robots - question.alpha_s)
    if submodular:
        if not swapped:
            return KnownRatio(lower=max(lower, 1 / (1 + question.curvature)), attained=False)
        guess = three_left_ratio(kept) if size == 3 else None
        return KnownRatio(lower=lower, attained=size == 2, conjectured=guess)
    found = sensing_ratio(size, swapped, kept)
    return KnownRatio(lower=max(lower, found), attained=kept > 0 or found == 1)


def three_left_ratio(kept: Fraction) -> Fraction:
    """The submodular ratio with three robots left and at least one blinded, unsplit team, ``t = kept``: conjectured.

    ``(2 + t + 3 t^2) / 6`` up to ``t = 1/3``; beyond it the smaller one of ``(1+t) (1+2t) / (4+3t)`` and
    ``(1 + t^2 + t^3) / (2 + t)``, but at least t. Read off from coverage functions that attain it at four robots; the
    computed values agree (``docs/researchers/ratios.md``). From ``t + t^2 = 1`` on it is t, the pattern-free bound.
    """
    t = kept
    if 3 * t <= 1:
        return (2 + t + 3 * t**2) / 6
    return max(t, min((1 + t) * (1 + 2 * t) / (4 + 3 * t), (1 + t**2 + t**3) / (2 + t)))


def sensing_ratio(size: int, swapped: int, kept: Fraction) -> Fraction:
    """``(1 + t h) / (1 + h/t)``, ``h = min(g-1, p (1 + 1/t))``: RATT's ratio for total curvature ``1-t``, unsplit team.

    ``size`` is g, the robots left, ``swapped`` is p, the robots blinded but at most g: as many bait robots can stand
    among those left. Without any (``p = 0``) it is ``g / (1 + (g-1)/t)``, greedy's own. Attained by
    ``families.sensing_instance``.

    With more blinded robots than g the rest is bait worth anything, the same in both plans, and blinded.

    Proof. All greedy robots are g. Let S, g of them and bait, be left, and in the notation of :func:`survivor_bound`
    let ``x = 1``, M the sum of ``m_(o_i)`` over ``S - r``. There ``phi(u_S) >= 1 + t^2 M`` and ``phi(o_S) <= 1 + M``,
    so the ratio is at least the claim if ``M <= h/t``; and ``M <= (g-1)/t``. Let S have q bait robots, ``1 <= q <=
    p``, and leave out q greedy ones. Build all greedy elements, in order: the robots of S add at least ``t m_(o_i)``.
    Take the q others away: each added ``a >= t m`` and takes at most ``m <= phi/t <= 1/t``, a loss of at most ``(1-t)
    m <= 1/t - 1``. Put the bait in: r adds at least t, the others ``t^2 m_(o_i)``. So with ``M = K + B``, K of greedy
    robots and ``B <= (q-1)/t`` of bait, ``phi(u_S) >= t K + t^2 B + t - q (1/t - 1)``. At ``K = 1/t + q/t^2`` this is
    ``1 + t^2 M``, and there ``M <= q (1 + 1/t)/t``. Below, the first bound gives the claim with q; above, what is
    added to K adds t times as much to RATT, and t is more than the claim. The claim falls with h, so p in place of q
    is enough. A set S without bait is all greedy robots: ``phi(u_S) >= 1 + t M`` with ``x = 1``, at least t and ``g /
    (1 + (g-1)/t)``.
    """
    rest = size - 1
    if not rest:
        return kept**0
    if not kept:
        return kept
    if not swapped:
        return size * kept / (kept + rest)
    h = min(Fraction(rest), swapped * (1 + 1 / kept))
    return kept * (1 + kept * h) / (kept + h)
