"""Diagonals that show what groups score at most (``verifier/sizes.py``), by descent.

The attacker's bounds (``graph/link_scores.py``) are those of the same relaxation: at the best multiplier of the sphere,
added to those of the robots, their quadratic form is definite. Here it is rounded up, and decided in integers.
"""

from __future__ import annotations

from contextlib import suppress
from dataclasses import dataclass
from math import floor
from typing import TYPE_CHECKING, Any

import numpy as np

from ratt_opt.certificates.verifier.sizes import UNIT, LinkCosts
from ratt_opt.errors import ProofError
from ratt_opt.graph.link_scores import SHARES, most_scores

if TYPE_CHECKING:
    from ratt_opt._validation import BoolArray, FloatArray, IntArray
    from ratt_opt.budget import Budget
    from ratt_opt.certificates.params import SizeProofParams
    from ratt_opt.certificates.verifier.sizes import GroupComposition
    from ratt_opt.graph.communication import CommunicationGraph
    from ratt_opt.graph.link_scores import RelaxedScores, SphereMaximum

__all__ = ["CaseBound", "CaseBounds", "ScoreBounds"]

LINK = 2
"""Cost of each link that leaves a group: twice as much as in the attacker's scores."""


@dataclass(frozen=True, slots=True)
class CaseBound:
    """Bounds of a case.

    ``vector``, ``diagonal`` : the bound that closes it, if any; ``place`` (N,) of its best fractional group;
    ``multipliers`` (K, N) to begin with in its parts
    """

    vector: int
    diagonal: tuple[int, ...]
    place: FloatArray
    multipliers: FloatArray


class ScoreBounds:
    """Bounds for one graph and each of the attacker's shares.

    ``duals``, ``forms`` : as the verifier reads them; ``costs`` has taken them over
    """

    def __init__(self, graph: CommunicationGraph, alpha_c: int, budget: Budget, params: SizeProofParams) -> None:
        self.known, self.params = most_scores(graph), params
        self.known.run(budget)
        near = [0] * graph.n_robots
        for i, j in graph.links:
            near[i], near[j] = near[i] | 1 << j, near[j] | 1 << i
        degrees = [others.bit_count() for others in near]
        duals = [[LINK * degree - round(2 * (1 - share) * degree) for degree in degrees] for share in SHARES]
        self.duals = [{"link": LINK, "robots": own} for own in duals]
        self.costs = [LinkCosts(near, alpha_c, LINK, own) for own in duals]
        self.forms = [
            form
            for vector in range(len(self.costs))
            for size in range(2, graph.n_robots)
            if (form := self._form(vector, size)) is not None
        ]

    def _form(self, vector: int, size: int) -> dict[str, Any] | None:
        one, start = self.costs[vector], self.known.multipliers[vector, size]
        top = self.known.relaxed[vector].top(start, size)
        least = 1 - (floor(2 * (top.value + self.params.spare) / one.step) + 1) * one.step
        if least <= one.least[size]:
            return None
        diagonal = _rounded(start + top.level).tolist()
        try:
            one.raise_least(size, least, diagonal)
        except ProofError:
            return None
        return {"duals": vector, "robots": size, "least": least, "diagonal": diagonal}


class CaseBounds:
    """Bounds of what groups of a case score."""

    def __init__(self, bounds: ScoreBounds, group: GroupComposition) -> None:
        self._known, self._costs, self._group, self._params = bounds.known, bounds.costs, group, bounds.params
        self._size, self._n = group.robots, len(bounds.costs[0].near)
        self._need = [-int(limit) for limit in group.limits]

    def start(self) -> FloatArray:
        """(K, N) multipliers to begin with."""
        return self._known.multipliers[:, self._size]

    def look(self, inside: int, outside: int, start: FloatArray) -> CaseBound:
        """Look for a bound that closes the case of masks."""
        members, others = _robots(inside, self._n), ~_robots(inside | outside, self._n)
        case, joining = (inside, (1 << self._n) - 1 & ~(inside | outside)), self._size - inside.bit_count()
        place, multipliers = np.where(others, 0.5, 0.0), start.copy()
        for vector in reversed(range(len(self._costs))):
            diagonal = np.zeros(self._n, dtype=np.int64)
            if 0 < joining < others.sum():
                fixed, relaxed = self._known.relaxed[vector].around(members, others)
                below = self._need[vector] / 2 - fixed - self._params.spare
                top = relaxed.top(multipliers[vector, others], joining)
                place[others] = top.place
                if 0.0 <= top.value - below < self._params.near:
                    steps = self._params.steps
                    own = _lowered(relaxed, multipliers[vector, others], joining, below, steps)
                    multipliers[vector, others], top = own
                diagonal[others] = _rounded(multipliers[vector, others] + top.level)
                if top.value >= below:
                    continue
            kept = tuple(diagonal.tolist())
            if self._costs[vector].are_above(self._group.limits[vector], list(kept), case, joining):
                return CaseBound(vector, kept, place, multipliers)
        return CaseBound(-1, (), place, multipliers)


def _lowered(
    relaxed: RelaxedScores, start: FloatArray, joining: int, below: float, steps: int
) -> tuple[FloatArray, SphereMaximum]:
    """Multipliers of a bound that is lower, until it is below, and that bound."""
    best = start, relaxed.top(start, joining)

    def value(multipliers: FloatArray) -> tuple[float, FloatArray]:
        nonlocal best
        top = relaxed.top(multipliers, joining)
        if top.value < best[1].value:
            best = np.array(multipliers), top
        if top.value < below:
            raise StopIteration
        return top.value, top.place - top.place**2

    from scipy.optimize import minimize  # a third of a second

    with suppress(StopIteration):
        minimize(value, start, jac=True, method="L-BFGS-B", options={"maxiter": steps, "maxfun": steps})
    return best


def _rounded(diagonal: FloatArray) -> IntArray:
    """Round up to the verifier's units of a form twice as large."""
    return np.ceil(2 * UNIT * diagonal).astype(np.int64) + 1


def _robots(mask: int, n_robots: int) -> BoolArray:
    return np.array([mask >> i & 1 for i in range(n_robots)], dtype=np.bool_)
