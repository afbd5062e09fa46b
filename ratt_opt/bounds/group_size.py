"""The guarantee from how few unblinded robots an attack can leave in every group."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ratt_opt._validation import check_integer
from ratt_opt.bounds.guarantees import Curvatures, Guarantee, Share, needs_of, one_curvature
from ratt_opt.bounds.params import DEFAULT
from ratt_opt.budget import Budget
from ratt_opt.graph.largest_group.annealed_cut import annealed_cut
from ratt_opt.graph.largest_group.counting import largest_left
from ratt_opt.graph.largest_group.heuristic_cut import heuristic_cut
from ratt_opt.graph.survivor_sizes import forced_group_size
from ratt_opt.graph.threat import Threat
from ratt_opt.graph.threshold import ThresholdTest

if TYPE_CHECKING:
    from ratt_opt.bounds.params import BoundParams
    from ratt_opt.problem import Problem

__all__ = ["achievable_group_size", "group_size_bound", "group_size_share", "strongest_robots"]

SOURCE = "group-size bound (this library)"
IN_COQ = {"k": "paper_group_size_submodular", "c": "paper_group_size_total_curvature"}


def group_size_bound(g: int, *, k: Curvatures = None, c: Curvatures = None, baits_survive: bool = True) -> Guarantee:
    """``1/g`` for every submodular function, ``t / (g - 1 + t)`` with ``t = 1 - c`` for every non-decreasing one.

    ``g`` is a number of unblinded robots that an attack can keep every group down to while it blinds ``T``, the
    unprotected robots of the ``alpha_s`` largest individual values (:func:`achievable_group_size`). On complete graphs
    without protected parts it is the smallest largest group of unblinded robots. With ``g <= 1`` RATT is optimal.

    Proof. Let ``v`` be the largest individual value of a robot outside ``T`` and ``r`` the first such robot in RATT's
    order; all before it are in ``T``. RATT takes the ``alpha_s + alpha_cs`` robots of the largest individual values
    as bait, with their best elements; if ``alpha_cs >= 1`` that includes ``r``. A protected ``r`` always sees.
    Otherwise the bait includes ``T`` and ``r``, one more than can be blinded, all of value at least ``v``. So some
    bait worth ``v`` sees after every attack, and by monotonicity RATT keeps ``v``. The attack above leaves any plan
    ``o`` only groups ``S`` of at most ``g`` robots outside ``T``. Submodular: ``phi(o_S) <= sum_S phi(o_i) <= g v``.
    Non-decreasing with total curvature ``c``: a marginal of ``x`` is at most ``phi(x) / t``, so ``phi(o_S) <= v + (g
    - 1) v / t``.

    If ``alpha_cs = 0`` (``baits_survive=False``) an attack may blind exactly the bait. No cut then splits the team,
    so that leaves all greedy robots in one group, which keeps ``1 / (1 + k)`` of the optimum (submodular; Fisher,
    Nemhauser, Wolsey 1978; Conforti and Cornuejols 1984), respectively ``1 - c`` (their marginals, chosen greedily,
    are at least ``(1 - c)`` times those of any other choice). Any other attack leaves a bait, as before. The bound is
    then the minimum of both, and 1 if ``g <= 1``: at most one robot is then greedy, and takes its best element.

    Split teams. The bounds hold as well if each component plans alone while links are lost, with at least as many
    baits as can be blinded (or all of its robots), whatever is cut later. Order the robots of a component by individual
    value; among equals bait comes first, then the first greedy robot. That one chooses beside nothing, so it takes
    its best element, worth no less than what any later robot has. Hence the first ``alpha_s + 1`` robots of each
    component have their best elements. Merge these orders by value: each of the first ``alpha_s + 1`` robots of the
    team is among the first ``alpha_s + 1`` of its component. The proof above asks no more of RATT's bait. In Coq
    ``components_submodular``, ``components_total_curvature``.

    Parameters
    ----------
    g : number of robots, at least 0
    k, c : curvature of a submodular objective, or total curvature; exactly one of them

    Raises
    ------
    InputError : neither or both curvatures, one outside [0, 1], or ``g < 0``.

    Source: this library. ``1/g`` is attained by ``k = 1`` at every budget of at most four robots with a bait.
    """
    g = check_integer("g", g, low=0)
    kind, value = one_curvature(k, c)
    keep = 1 - value
    bound = group_size_share(g, keep, submodular=kind == "k")
    greedy = 1.0 if g <= 1 else 1 / (1 + value) if kind == "k" else keep
    uses_curvature = g > 1 and (kind == "c" or not baits_survive)
    of_class, curved, *rest = needs_of(kind, f"groups of at most {g} unblinded robots", "RATT's plan")
    needs = (of_class, *([curved] if uses_curvature else []), *rest)
    theorem = IN_COQ[kind] if g > 1 else "paper_optimal" if baits_survive else None
    proof = f"group_size_bound; in Coq {theorem}" if theorem else "group_size_bound"
    return Guarantee(bound if baits_survive else min(bound, greedy), needs, SOURCE, proof)


def group_size_share(g: int, kept: Share, *, submodular: bool) -> Share:
    """The formula of :func:`group_size_bound` for ``kept = 1-k`` or ``1-c``: a float, or exactly for a rational."""
    one = kept**0
    return one if g <= 1 else one / g if submodular else kept / (g - 1 + kept)


def achievable_group_size(problem: Problem, budget: Budget | None = None, params: BoundParams = DEFAULT) -> int:
    """Unblinded robots that an attack can keep every group down to while it blinds the strongest unprotected robots.

    The smallest such number on complete graphs without protected links (integer partitions) and for few robots
    (``params.listed_robots``) on any graph; it depends on which robots are the strongest. Otherwise two cuts are tried,
    one that makes the largest group small and one that makes the most unblinded robots few, and the better one is
    annealed, up to ``params.annealed_links``: the number returned is achievable, and a larger one only weakens the
    guarantee, as a spent ``budget`` does.
    """
    threat = problem.threat
    if threat.links_alike:
        return forced_group_size(problem.n_robots, threat.n_blinded, threat.alpha_c)
    blinded, graph = strongest_robots(problem), problem.communication
    cuts_only = Threat(graph, 0, threat.alpha_c, protected_links=threat.protected_links)
    if problem.n_robots <= params.listed_robots:
        seeing = sum(1 << i for i in range(problem.n_robots) if i not in blinded)
        counts = np.bitwise_count(np.arange(2**problem.n_robots) & seeing).astype(np.float64)
        test = ThresholdTest(cuts_only, counts)
        return next(g for g in range(problem.n_robots + 1) if test.split(float(g)) is not None)
    tried = (heuristic_cut(cuts_only, budget), heuristic_cut(cuts_only, budget, ignoring=blinded))
    cut = min(tried, key=lambda one: largest_left(graph, one, blinded))
    part = (budget or Budget()).part(params.annealing_share)
    if len(graph.links) <= params.annealed_links and largest_left(graph, cut, blinded) > 1 and part.stop() is None:
        cut = annealed_cut(cuts_only, cut, 1, part, ignoring=blinded)
    return largest_left(graph, cut, blinded)


def strongest_robots(problem: Problem) -> frozenset[int]:
    """The unprotected robots of the ``alpha_s`` largest individual values, the lowest first among equals."""
    single = problem.objective.singletons()
    strength = np.array([single[choice].max() for choice in problem.choices])
    free = [int(i) for i in np.argsort(-strength, kind="stable") if i not in problem.protected_robots]
    return frozenset(free[: problem.alpha_s])
