"""Proofs of a plan's worst-case value: the first of a few conclusions that is reached.

Built in floating point, decided by the verifier in exact arithmetic.
"""

from __future__ import annotations

from itertools import product
from typing import TYPE_CHECKING, Any

from ratt_opt.certificates.covers import cover_proof
from ratt_opt.certificates.group_sizes.proof import group_size_proof
from ratt_opt.certificates.group_tree import sets_proof
from ratt_opt.certificates.params import DEFAULT
from ratt_opt.certificates.plan_sets import NotClosedError, PlanSets
from ratt_opt.certificates.verifier.work import limited, seconds_left
from ratt_opt.errors import UndecidedError
from ratt_opt.graph.survivor_sizes import forced_group_size

if TYPE_CHECKING:
    from collections.abc import Callable

    from ratt_opt._validation import IntArray
    from ratt_opt.certificates.params import CertificateParams
    from ratt_opt.problem import Problem

    Way = Callable[[PlanSets, int], dict[str, Any]]

__all__ = ["ENUMERATED", "lower_proof", "weaker_lower_proof"]

ENUMERATED: dict[str, Any] = {"conclusion": "enumerated"}
"""Record that the outcomes were enumerated in floating point: not a proof."""


def lower_proof(problem: Problem, elements: IntArray, threshold: float, params: CertificateParams = DEFAULT) -> Any:
    """Return the record of a proof that the plan's worst-case value is at least ``threshold``.

    Parameters
    ----------
    elements : (N,) the plan
    threshold : the value to prove [unit of the objective], a little below the plan's worst case
    params : ways, limits of trees and shares of the time

    Returns
    -------
    ``forced`` if the complete graph allows it; ``duals`` or ``cover``; or ``sizes``, which comes first if most links
    are there; else ``ENUMERATED``.
    """
    own = params.lower
    by_sizes = _is_dense(problem, own.dense) and problem.n_robots > own.covers_first
    ways: list[Way] = [group_size_proof, cover_proof] if by_sizes else [cover_proof, group_size_proof]
    if problem.communication.is_complete:
        ways = [_forced_proof, cover_proof]
    for way in ways:
        try:
            with limited(seconds_left() * (1.0 if way is ways[-1] else own.share_of_others)):
                return way(PlanSets(problem, elements, threshold, params), own.nodes)
        except (NotClosedError, UndecidedError):
            continue
    return ENUMERATED


def _forced_proof(sets: PlanSets, max_nodes: int) -> dict[str, Any]:
    """Every attack on the complete graph leaves a group of the forced size, and any set of that size is enough."""
    size = forced_group_size(sets.problem.n_robots, sets.problem.alpha_s, sets.problem.alpha_c)
    return {"conclusion": "forced", "sets": sets_proof(sets, size, max_nodes)}


def weaker_lower_proof(
    problem: Problem, elements: IntArray, threshold: float, params: CertificateParams = DEFAULT
) -> tuple[float, Any]:
    """A threshold that is a little lower (``params.lower.lowered``), with its proof by sizes or by covers.

    Parameters are those of :func:`lower_proof`; if none is proved, the threshold itself comes with ``ENUMERATED``.
    """
    own = params.lower
    ways: list[Way] = [*([group_size_proof] if _is_dense(problem, own.dense) else []), cover_proof]
    for share, way in product(own.lowered, ways) if not problem.communication.is_complete else ():
        lower = threshold * (1 - share)
        try:
            with limited(seconds_left() * own.share_of_others):
                return lower, way(PlanSets(problem, elements, lower, params), own.nodes)
        except (NotClosedError, UndecidedError):
            continue
    return threshold, ENUMERATED


def _is_dense(problem: Problem, share: float) -> bool:
    """Tell whether the graph has at least this share of all links."""
    return 2 * len(problem.communication.links) >= share * problem.n_robots * (problem.n_robots - 1)
