"""Proofs that a plan keeps a value under every attack: the first of a few kinds that closes.

Built in floating point, decided by the verifier in exact arithmetic. Robots are taken strongest
first, so that the cases in which strong robots see close early.
"""

from __future__ import annotations

from itertools import product
from typing import TYPE_CHECKING, Any

from ratt_opt.certificates.attack_tree import AttackTree
from ratt_opt.certificates.forced_by_trees import forced_size_proof
from ratt_opt.certificates.group_covers.all_groups import all_groups_proof
from ratt_opt.certificates.group_covers.proof import group_cover_proof
from ratt_opt.certificates.group_prices import group_price_proof
from ratt_opt.certificates.group_sizes.proof import group_size_proof
from ratt_opt.certificates.plan_sets import NotClosedError, PlanSets
from ratt_opt.certificates.size_tree import size_tree
from ratt_opt.certificates.verifier.work import limited, seconds_left
from ratt_opt.errors import UndecidedError
from ratt_opt.graph.survivor_sizes import forced_group_size

if TYPE_CHECKING:
    from collections.abc import Callable

    from ratt_opt._validation import IntArray
    from ratt_opt.problem import Problem

__all__ = ["ENUMERATED", "lower_proof", "weaker_lower_proof"]

LARGEST_TREE = 200_000
"""Most nodes of a tree."""
NODES_TIMES_PAIRS = 20_000_000
"""Most nodes of an attack tree, times pairs of robots."""
TREES_FIRST = 16
"""Robots up to which attack trees come before sizes of groups where most links are there, though these take a tenth of
a second: a tree takes two at most, and ``formal/`` has a verified checker for it."""
SHARE_OF_OTHERS = 0.4
"""Of the seconds left that each kind but the last may take."""
LOWERED = (0.01, 0.03, 0.1, 0.3)
"""Shares of a threshold by which it is lowered, in turn, until it is proved."""
ENUMERATED: dict[str, Any] = {"kind": "enumerated"}
"""Says that the outcomes were enumerated in floating point: not a proof."""


def lower_proof(problem: Problem, elements: IntArray, threshold: float, *, max_nodes: int = LARGEST_TREE) -> Any:
    """Return the record of a proof that the plan keeps ``threshold`` under every attack.

    Parameters
    ----------
    elements : (N,) the plan
    threshold : the value to prove [unit of the objective], a little below the plan's worst case
    max_nodes : node limit of each tree that is tried

    Returns
    -------
    A ``forced_size`` proof where the complete graph allows one; for larger teams, ``group_sizes`` where they have most
    links, and ``all_groups``; else an ``attack_tree``, a ``forced_size`` proof by trees of links, ``group_prices``,
    ``all_groups`` or ``group_sizes`` for smaller teams, or ``group_covers``, else ``ENUMERATED``.
    """

    def sets() -> PlanSets:
        return PlanSets(problem, elements, threshold)

    def by_size() -> dict[str, Any]:
        size = forced_group_size(problem.n_robots, problem.alpha_s, problem.alpha_c)
        return {"kind": "forced_size", "size": size, "tree": size_tree(sets(), size, max_nodes)}

    def by_trees() -> dict[str, Any]:
        return forced_size_proof(sets(), max_nodes)

    def by_cases() -> dict[str, Any]:
        fewer = min(max_nodes, NODES_TIMES_PAIRS // problem.n_robots**2)
        return {"kind": "attack_tree", "tree": AttackTree(sets(), fewer).run()}

    def by_prices() -> dict[str, Any]:
        return group_price_proof(sets(), max_nodes)

    def by_covers() -> dict[str, Any]:
        return group_cover_proof(sets(), max_nodes)

    def by_scores() -> dict[str, Any]:
        return group_size_proof(sets(), max_nodes)

    def by_groups() -> dict[str, Any]:
        return all_groups_proof(sets(), max_nodes)

    ways: list[Callable[[], dict[str, Any]]] = [by_cases, by_trees, by_prices]
    if problem.communication.is_complete:
        ways = [by_size, *ways]
    elif problem.n_robots > TREES_FIRST:
        first = [by_scores, by_groups] if _is_dense(problem) else [by_groups, by_scores]
        ways = [*first, *ways, by_covers]
    else:
        ways = [*ways, by_groups, by_scores, by_covers]
    for way in ways:
        try:
            with limited(seconds_left() * (1.0 if way is ways[-1] else SHARE_OF_OTHERS)):
                return way()
        except (NotClosedError, UndecidedError):
            continue
    return ENUMERATED


def weaker_lower_proof(
    problem: Problem, elements: IntArray, threshold: float, *, max_nodes: int = LARGEST_TREE
) -> tuple[float, Any]:
    """A threshold that is lower by one of ``LOWERED``, with its proof by sizes of groups where most links are there, by
    all groups, or by covers of groups.

    Parameters are those of :func:`lower_proof`; where none is proved, the threshold itself comes with ``ENUMERATED``.
    """
    ways = [*([group_size_proof] if _is_dense(problem) else []), all_groups_proof, group_cover_proof]
    for share, way in product(LOWERED, ways) if not problem.communication.is_complete else ():
        lower = threshold * (1 - share)
        try:
            with limited(seconds_left() * SHARE_OF_OTHERS):
                return lower, way(PlanSets(problem, elements, lower), max_nodes)
        except (NotClosedError, UndecidedError):
            continue
    return threshold, ENUMERATED


def _is_dense(problem: Problem) -> bool:
    """Whether three fifths of all links are there: with 0.7 proofs by sizes are the shorter ones, with half of them
    (disks of mean degree 12, 24 robots) those by all groups are."""
    return 10 * len(problem.communication.links) >= 3 * problem.n_robots * (problem.n_robots - 1)
