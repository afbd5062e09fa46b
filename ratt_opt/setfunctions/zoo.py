"""Set functions with known answers: one generator a family, each stating what theory knows of its instance.

Every generator takes a NumPy ``Generator`` and the size of the ground set, and draws the rest from it.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from ratt_opt._validation import check_integer
from ratt_opt.errors import InputError
from ratt_opt.setfunctions.base import TableFunction
from ratt_opt.setfunctions.best_elements import Coverage, FacilityLocation
from ratt_opt.setfunctions.criteria.trace import TraceObjective
from ratt_opt.setfunctions.reference import ConcaveOfModular, Cut, Modular, PartitionMatroidRank

if TYPE_CHECKING:
    from collections.abc import Callable

    from ratt_opt._validation import FloatArray
    from ratt_opt.setfunctions.base import SetFunction

__all__ = ["REFERENCE_FAMILIES", "Reference", "reference"]


@dataclass(frozen=True, slots=True, kw_only=True)
class Reference:
    """A set function and what theory knows of it, with the argument (``why``); ``None`` if theory says nothing.

    Both curvatures are over all subsets (``"elements"``), and ``None`` also if the function is not monotone (then
    neither is defined).
    """

    family: str
    function: SetFunction
    non_decreasing: bool
    submodular: bool | None = None
    curvature: float | None = None
    total_curvature: float | None = None
    why: str


def reference(family: str, n: int, rng: np.random.Generator) -> Reference:
    """Draw one member of a family, named by a key of :data:`REFERENCE_FAMILIES`, of ``n`` elements.

    InputError : an unknown family, or ``n < 2``.
    """
    if family not in REFERENCE_FAMILIES:
        raise InputError("family", f"must be one of {', '.join(REFERENCE_FAMILIES)}", family)
    return REFERENCE_FAMILIES[family](check_integer("n", n, low=2), rng)


def _submodular(family: str, f: SetFunction, kept: FloatArray, alone: FloatArray, why: str) -> Reference:
    """A submodular non-decreasing function: ``kept`` and ``alone`` are its marginals on top of all and of nothing.

    Its marginals fall as the context grows, so both curvatures are ``1 - min kept / alone``.
    """
    useful = alone > 0
    k = 1.0 - float((kept[useful] / alone[useful]).min()) if useful.any() else 0.0
    known = Reference(family=family, function=f, non_decreasing=True, submodular=True, why=why)
    return replace(known, curvature=k, total_curvature=k)


def _modular(n: int, rng: np.random.Generator) -> Reference:
    weights = rng.integers(0, 8, n).astype(np.float64)
    return _submodular("modular", Modular(weights), weights, weights, "every marginal is the weight")


def _coverage(n: int, rng: np.random.Generator) -> Reference:
    items = 3 * n
    covers = rng.random((n, items)) < rng.uniform(0.1, 0.5)
    weights = rng.integers(1, 6, items).astype(np.float64)
    alone = covers @ weights
    kept = (covers & (covers.sum(axis=0) == 1)) @ weights
    return _submodular("coverage", Coverage(covers, weights), kept, alone, "on top it adds what it alone covers")


def _planted_coverage(n: int, rng: np.random.Generator) -> Reference:
    """Make a coverage function of one common item and private ones, so that the curvature can be chosen freely."""
    k = float(rng.integers(0, 9)) / 8
    covers = np.concatenate([np.eye(n, dtype=np.bool_), np.ones((n, 1), dtype=np.bool_)], axis=1)
    weights = np.append(np.full(n, 1 - k), k)
    kept, alone = np.full(n, 1 - k), np.ones(n)
    return _submodular("planted coverage", Coverage(covers, weights), kept, alone, "a private item of weight 1 - k")


def _matroid_rank(n: int, rng: np.random.Generator) -> Reference:
    weights = rng.integers(1, 9, n).astype(np.float64)
    blocks = int(rng.integers(1, n + 1))
    block = rng.integers(0, blocks, n)
    capacity = rng.integers(1, n + 1, blocks)
    kept = np.zeros(n)
    for e in range(n):
        mine = np.sort(weights[block == block[e]])[::-1]
        c = int(capacity[block[e]])
        # Without e the heaviest element left out steps in: e adds the difference, if it is in at all.
        kept[e] = weights[e] if len(mine) <= c else max(weights[e] - mine[c], 0.0)
    f = PartitionMatroidRank(weights, block, capacity)
    return _submodular("matroid rank", f, kept, weights, "the exchange with the heaviest element left out")


def _facility_location(n: int, rng: np.random.Generator) -> Reference:
    utility = rng.integers(0, 10, (n, n + 3)).astype(np.float64)
    ranked = np.sort(utility, axis=0)
    rest = np.where(utility == ranked[-1], ranked[-2], ranked[-1])
    kept = np.clip(utility - rest, 0, None).sum(axis=1)
    f = FacilityLocation(utility)
    return _submodular("facility location", f, kept, utility.sum(axis=1), "its lead over the best other, per customer")


def _cut(n: int, rng: np.random.Generator) -> Reference:
    weights = np.triu(rng.integers(0, 4, (n, n)), 1).astype(np.float64)
    weights[0, 1] = 1.0  # at least one edge, or the function is 0
    f, why = Cut(weights + weights.T), "the whole set cuts nothing: not monotone, so no curvature is defined"
    return Reference(family="cut", function=f, non_decreasing=False, submodular=True, why=why)


def _concave_of_modular(n: int, rng: np.random.Generator) -> Reference:
    weights = rng.integers(1, 7, n).astype(np.float64)
    total = weights.sum()
    shape: Callable[[FloatArray], FloatArray] = (np.sqrt, np.log1p)[int(rng.integers(0, 2))]
    kept = shape(np.array([total])) - shape(total - weights)
    f = ConcaveOfModular(weights, shape)
    return _submodular("concave of modular", f, kept, shape(weights), "increments of a concave shape fall")


def _convex_of_modular(n: int, rng: np.random.Generator) -> Reference:
    weights = rng.integers(1, 7, n).astype(np.float64)
    total = weights.sum()
    # (w, w^2) -> marginals rise from w^2 to total^2 - (total - w)^2.
    c = 1.0 - float((weights**2 / (total**2 - (total - weights) ** 2)).min())
    f, why = ConcaveOfModular(weights, np.square), "supermodular: marginals rise from the first to the last"
    known = Reference(family="convex of modular", function=f, non_decreasing=True, why=why)
    return replace(known, submodular=False, total_curvature=c)


def _rank_one_updates(n: int, rng: np.random.Generator) -> Reference:
    direction = rng.normal(size=(n, 3, 2))
    information = direction[..., :, None] * direction[..., None, :]
    f = TraceObjective(np.eye(2) * rng.uniform(1, 5, (3, 1, 1)), information)
    why = "information only grows; the trace of the covariance need not be submodular"
    return Reference(family="rank-one updates", function=f, non_decreasing=True, why=why)


def _aligned_rank_one(n: int, rng: np.random.Generator) -> Reference:
    """Each measurement is along an axis of the prior: per axis ``1/q - 1/(q + total strength)``, a concave shape."""
    start = rng.uniform(0.2, 2.0, 2)
    axis = rng.integers(0, 2, n)
    strength = rng.integers(1, 6, n).astype(np.float64)
    information = np.zeros((n, 1, 2, 2))
    information[np.arange(n), 0, axis, axis] = strength
    q = start[axis]
    others = np.array([strength[axis == a].sum() for a in axis]) - strength
    alone = strength / (q * (q + strength))
    kept = strength / ((q + others) * (q + others + strength))
    f = TraceObjective([np.diag(1 / start)], information)
    return _submodular("aligned rank-one", f, kept, alone, "axes do not mix; each is concave of modular")


def _monotone_table(n: int, rng: np.random.Generator) -> Reference:
    """Raise random numbers to their running maximum over subsets."""
    values = rng.random((2,) * n)
    values[(0,) * n] = 0.0
    for i in range(n):
        np.maximum.accumulate(values, axis=i, out=values)
    f, why = TableFunction(values.ravel()), "a running maximum over subsets"
    return Reference(family="monotone table", function=f, non_decreasing=True, why=why)


def _table(n: int, rng: np.random.Generator) -> Reference:
    """Random numbers with a full set below the empty one: not monotone."""
    values = rng.normal(size=2**n)
    values[-1] = values[0] - 1.0
    f, why = TableFunction(values), "the full set is worth less than the empty one"
    return Reference(family="table", function=f, non_decreasing=False, why=why)


REFERENCE_FAMILIES: dict[str, Callable[[int, np.random.Generator], Reference]] = {
    "modular": _modular,
    "coverage": _coverage,
    "planted coverage": _planted_coverage,
    "matroid rank": _matroid_rank,
    "facility location": _facility_location,
    "cut": _cut,
    "concave of modular": _concave_of_modular,
    "convex of modular": _convex_of_modular,
    "rank-one updates": _rank_one_updates,
    "aligned rank-one": _aligned_rank_one,
    "monotone table": _monotone_table,
    "table": _table,
}
"""Name of each family -> its generator."""
