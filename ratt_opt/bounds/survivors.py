"""The guarantee from how many unblinded robots an attack worth making can leave in one group."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ratt_opt._validation import check_integer
from ratt_opt.bounds.guarantees import IN_COQ as PATTERN_FREE_IN_COQ
from ratt_opt.bounds.guarantees import Curvatures, Guarantee, Share, needs_of, one_curvature
from ratt_opt.graph.survivor_sizes import iterate_non_dominated_sizes

if TYPE_CHECKING:
    from ratt_opt.problem import Problem

__all__ = ["largest_survivor_group", "survivor_bound", "survivor_share"]

SOURCE = "survivor bound (this library)"
IN_COQ = {"k": "survivor_submodular", "c": "survivor_total_curvature"}


def survivor_bound(size: int, *, k: Curvatures = None, c: Curvatures = None) -> Guarantee:
    """``max(t, (1 + (s-1) t^2) / s)``, ``t = 1-k``; respectively ``(1 + (s-1) t) / (1 + (s-1)/t)``, ``t = 1-c``.

    ``s = size`` is at least the number of robots that see in any group left by any attack that no other one refines
    (:func:`largest_survivor_group`). Both are above the pattern-free bounds, ``t`` and ``t^2``, to which they fall
    (the first for ``t >= 1/(s-1)``) as ``s`` grows. Any graph, budgets and protected parts.

    Proof. By monotonicity some worst attack on RATT's plan ``u`` is one that no other refines. Let ``S`` be the group
    it leaves that is best for an optimal plan ``o``: ``Phi* <= phi(o_S)``, and ``|S| <= s``. Both bounds fall with
    the size, so they may be shown for ``s = |S|``. Let ``m_e`` be the largest marginal of an element, ``G_i`` the
    elements chosen greedily before robot ``i``'s, ``g_1`` the first greedy robot.

    *S has a bait or g_1.* Let ``r`` be its bait of largest value, else ``g_1``, and ``x = phi(u_r)``. Then ``x >=
    phi(o_i)`` for all ``i`` in ``S``: bait has the largest values of all, and ``g_1`` of those of greedy robots.
    Total curvature: ``m_(u_i) >= t m_(o_i)``, as ``m_(u_i) >= phi(u_i) >= phi(o_i)`` for bait and ``m_(u_i)`` is at
    least ``u_i``'s marginal given ``G_i``, so at least ``o_i``'s, for the others. With ``M`` the sum of ``m_(o_i)``
    over ``S - r``, ``phi(u_S) >= x + t sum m_(u_i) >= x + t^2 M`` and ``phi(o_S) <= x + M`` with ``M <= (s-1) x/t``.
    The ratio falls with ``M``. Submodular: ``phi(u_i) >= t phi(o_i)`` in the same way, so with ``Y <= (s-1) x`` the sum
    of ``phi(o_i)`` over ``S - r``, ``phi(u_S) >= x + t sum phi(u_i) >= x + t^2 Y`` and ``phi(o_S) <= x + Y``; the
    ratio falls with ``Y``. It is at least ``t`` by the pattern-free bound.

    *S has neither.* RATT counts ``alpha_s + N - n`` bait robots, if every cut leaves a group ``C`` of at least
    ``n`` robots, so at most ``n - alpha_s`` are greedy. If ``S`` were what sees in ``C``, at least ``n - alpha_s``
    robots, it would hold all greedy robots, ``g_1`` too. So ``S`` is elsewhere, and of ``C``'s robots at most
    ``n - alpha_s - s`` are greedy and at most ``alpha_s`` blinded: at least ``s`` bait robots see in ``C``. With
    ``w`` the smallest of their values, ``RATT >= w (1 + (s-1) t)``, while all ``phi(o_i) <= w`` in ``S``, so that
    ``Phi* <= w (1 + (s-1)/t)``, respectively ``s w``.

    Parameters
    ----------
    size : number of robots, at least 0
    k, c : curvature of a submodular objective, or total curvature; exactly one of them

    Raises
    ------
    InputError : neither or both curvatures, one outside [0, 1], or ``size < 0``.

    Source: this library. With ``alpha_c = 0 < alpha_s`` the second is RATT's exact worst ratio if
    ``s - 1 <= min(alpha_s, s) (1 + 1/t)`` and no other (``docs/researchers/ratios.md``); the first is for ``s = 2``.
    """
    size = check_integer("size", size, low=0)
    kind, value = one_curvature(k, c)
    bound = survivor_share(size, 1 - value, submodular=kind == "k")
    needs = needs_of(kind, f"no group of more than {size} unblinded robots", "RATT's plan")
    by_size = kind == "c" or bound > 1 - value
    theorem = IN_COQ[kind] if by_size else PATTERN_FREE_IN_COQ[kind]
    return Guarantee(bound, needs, SOURCE, f"survivor_bound; in Coq {theorem}")


def survivor_share(size: int, kept: Share, *, submodular: bool) -> Share:
    """The formula of :func:`survivor_bound` for ``kept = 1-k`` or ``1-c``: a float, or exactly for a rational."""
    rest = max(size - 1, 0)
    if submodular:
        return max(kept, (1 + rest * kept**2) / (rest + 1))
    return kept * (1 + rest * kept) / (kept + rest) if rest else kept**0


def largest_survivor_group(problem: Problem) -> int:
    """A number of unblinded robots that no group exceeds, whatever attack that no other refines.

    The smallest such number on complete graphs without protected links; elsewhere the larger groups that an attack
    could still split count too, which only weakens the guarantee.
    """
    threat = problem.threat
    seeing = problem.n_robots - threat.n_blinded
    if threat.links_alike:
        sizes = next(iterate_non_dominated_sizes(problem.n_robots, threat.n_blinded, problem.alpha_c))
        return sizes[0] if sizes else 0
    return min(seeing, max(len(group) for group in problem.communication.groups()))
