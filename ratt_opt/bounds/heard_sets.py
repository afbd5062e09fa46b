"""The guarantee of a team whose robots chose after hearing some of the others, or nobody."""

from __future__ import annotations

from ratt_opt._validation import check_integer
from ratt_opt.bounds.guarantees import Curvatures, Guarantee, needs_of, one_curvature

__all__ = ["heard_sets_bound"]


def heard_sets_bound(cliques: int, *, k: Curvatures = None, c: Curvatures = None) -> Guarantee:
    """``(1-k)(1-k+k/Q)`` for submodular functions, ``(1-c)^2`` for all non-decreasing ones, with ``Q = cliques``.

    Each robot is bait (its individually best element), or its element has the largest marginal beside the choices of
    the robots that it heard. Any robots may have been heard; one that heard nobody counts as bait. ``Q`` is a number of
    cliques that cover the greedy robots: of any two in a clique one has heard the other. Components that plan alone
    are one clique each.

    Proof, submodular with curvature ``k``. Let ``S`` be any set of robots, ``o`` any plan, ``H_i`` the choices that
    robot ``i`` heard, ``w(T) = sum of phi(o_i) over i in T``. A greedy robot has ``marg(u_i | H_i) >= marg(o_i | H_i)
    >= (1-k) phi(o_i)``. For a clique ``T`` in the order of hearing, ``H_i`` holds all earlier ones of ``T``, so by
    submodularity ``phi(u_T) >= sum_T marg(u_i | H_i) >= (1-k) w(T)``. Take the clique of ``S`` with the largest ``w``,
    at least ``w(greedy)/Q``. To any set every other greedy robot adds at least ``(1-k) phi(u_i) >= (1-k) marg(u_i |
    H_i) >= (1-k)^2 phi(o_i)``, and every bait at least ``(1-k) phi(u_b) >= (1-k) phi(o_b)``. Hence ``phi(u_S) >=
    (1-k) [w(greedy)/Q + (1-k)(1 - 1/Q) w(greedy) + w(bait)] >= (1-k)(1-k+k/Q) w(S)``, and ``w(S) >= phi(o_S)``.

    Proof, total curvature ``c``. With ``m_x`` the largest marginal of ``x``, all its marginals lie in ``[(1-c) m_x,
    m_x]``. Greedy or bait, ``m_(u_i) >= (1-c) m_(o_i)``, whatever was heard. Hence ``phi(u_S) >= (1-c) sum m_(u_i) >=
    (1-c)^2 sum m_(o_i) >= (1-c)^2 phi(o_S)``. This needs no message.

    As this holds for every ``S``, it holds for every group that an attack leaves.

    Raises
    ------
    InputError : neither or both curvatures, one outside [0, 1], or ``cliques < 1``.

    Source: this library; ``Q = 1`` is :func:`pattern_free_bound`. The first is attained by two components of two robots
    with a shared item of weight ``1-k`` and ties against the plan (0.375 at k = 0.5). Compare arXiv 2602.19366 and
    2407.10382, whose bounds for partial knowledge are without attacks.
    """
    cliques = check_integer("cliques", cliques, low=1)
    kind, value = one_curvature(k, c)
    keep = 1 - value
    bound = keep * (keep + value / cliques) if kind == "k" else keep**2
    needs = needs_of(kind, f"number of cliques of heard robots: {cliques}")
    proof = f"heard_sets_bound; in Coq {'split_submodular' if kind == 'k' else 'split_total_curvature'}"
    return Guarantee(bound, needs, "heard-sets bound (this library)", proof)
