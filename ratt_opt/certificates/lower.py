"""Proofs of a plan's worst-case value: the first of a few conclusions that is reached.

Built in floating point, decided by the verifier in exact arithmetic.
"""

from __future__ import annotations

from itertools import product
from typing import TYPE_CHECKING, Any

from ratt_opt.certificates.covers import cover_proof
from ratt_opt.certificates.group_sizes.proof import group_size_proof
from ratt_opt.certificates.group_tree import sets_proof
from ratt_opt.certificates.plan_sets import NotClosedError, PlanSets
from ratt_opt.certificates.verifier.work import limited, seconds_left
from ratt_opt.errors import UndecidedError
from ratt_opt.graph.survivor_sizes import forced_group_size

if TYPE_CHECKING:
    from collections.abc import Callable

    from ratt_opt._validation import IntArray
    from ratt_opt.problem import Problem

    Way = Callable[[PlanSets, int], dict[str, Any]]

__all__ = ["ENUMERATED", "lower_proof", "weaker_lower_proof"]

LARGEST_TREE = 300_000
"""Most nodes of a tree."""
SHARE_OF_OTHERS = 0.4
"""Share of the remaining seconds for each way but the last."""
COVERS_FIRST = 16
"""Robots up to which duals and covers come first on dense graphs, too. Of 48 teams of 8 to 16 robots they prove all, in
a tenth of the time; sizes leave eight open, and the others have shorter proofs (a third of the bytes at 16 robots)."""
LOWERED = (0.01, 0.03, 0.1, 0.3)
"""Shares of a threshold by which it is lowered, in turn, until it is proved."""
ENUMERATED: dict[str, Any] = {"conclusion": "enumerated"}
"""Record that the outcomes were enumerated in floating point: not a proof."""


def lower_proof(problem: Problem, elements: IntArray, threshold: float, *, max_nodes: int = LARGEST_TREE) -> Any:
    """Return the record of a proof that the plan's worst-case value is at least ``threshold``.

    Parameters
    ----------
    elements : (N,) the plan
    threshold : the value to prove [unit of the objective], a little below the plan's worst case
    max_nodes : node limit of each tree that is tried

    Returns
    -------
    ``forced`` if the complete graph allows it; ``duals`` or ``cover``; or ``sizes``, which comes first if most links
    are there; else ``ENUMERATED``.
    """
    by_sizes = _is_dense(problem) and problem.n_robots > COVERS_FIRST
    ways: list[Way] = [group_size_proof, cover_proof] if by_sizes else [cover_proof, group_size_proof]
    if problem.communication.is_complete:
        ways = [_forced_proof, cover_proof]
    for way in ways:
        try:
            with limited(seconds_left() * (1.0 if way is ways[-1] else SHARE_OF_OTHERS)):
                return way(PlanSets(problem, elements, threshold), max_nodes)
        except (NotClosedError, UndecidedError):
            continue
    return ENUMERATED


def _forced_proof(sets: PlanSets, max_nodes: int) -> dict[str, Any]:
    """Every attack on the complete graph leaves a group of the forced size, and any set of that size is enough."""
    size = forced_group_size(sets.problem.n_robots, sets.problem.alpha_s, sets.problem.alpha_c)
    return {"conclusion": "forced", "sets": sets_proof(sets, size, max_nodes)}


def weaker_lower_proof(
    problem: Problem, elements: IntArray, threshold: float, *, max_nodes: int = LARGEST_TREE
) -> tuple[float, Any]:
    """A threshold that is lower by one of ``LOWERED``, with its proof by sizes if most links are there, or by covers.

    Parameters are those of :func:`lower_proof`; if none is proved, the threshold itself comes with ``ENUMERATED``.
    """
    ways: list[Way] = [*([group_size_proof] if _is_dense(problem) else []), cover_proof]
    for share, way in product(LOWERED, ways) if not problem.communication.is_complete else ():
        lower = threshold * (1 - share)
        try:
            with limited(seconds_left() * SHARE_OF_OTHERS):
                return lower, way(PlanSets(problem, elements, lower), max_nodes)
        except (NotClosedError, UndecidedError):
            continue
    return threshold, ENUMERATED


def _is_dense(problem: Problem) -> bool:
    """Tell whether the graph has at least three fifths of all links."""
    return 10 * len(problem.communication.links) >= 3 * problem.n_robots * (problem.n_robots - 1)
