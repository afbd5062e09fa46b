"""Data of one robot: its knowledge before the first message, awarded information, and neighbours that it refused."""

from __future__ import annotations

from bisect import bisect
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from ratt_opt.decentralised.view import digest
from ratt_opt.setfunctions.information import from_triangles

if TYPE_CHECKING:
    from collections.abc import Callable

    from ratt_opt._validation import FloatArray, IntArray
    from ratt_opt.graph.threat import Threat
    from ratt_opt.setfunctions.information import InformationObjective

__all__ = ["AwardedSum", "Disagreement", "Knowledge"]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Knowledge:
    """All that a robot knows before the first message.

    ``elements`` : (K,) its own element numbers, ascending; ``objective`` : the criterion of these elements.
    ``protected`` : neighbours whose link to it cannot be cut.
    ``links_worth`` : number of sensing attacks that the link attacks of a threat are worth.
    """

    robot: int
    elements: IntArray
    objective: InformationObjective
    neighbours: tuple[int, ...]
    protected: frozenset[int]
    alpha_s: int
    alpha_c: int
    links_worth: Callable[[Threat], int]

    @property
    def common(self) -> bytes:
        """Digest of the data that all robots must share: criterion, prior, weights, output, budgets."""
        f = self.objective
        data = [f.prior.tobytes(), f.weights.tobytes(), b"" if f.output is None else f.output.tobytes()]
        return digest(type(f).__name__, self.alpha_s, self.alpha_c, f.prior.shape, *(part.hex() for part in data))


@dataclass(frozen=True, slots=True)
class Disagreement:
    """A neighbour that a robot refused: ``own`` and ``other`` are what differs, digests in hexadecimal."""

    robot: int
    neighbour: int
    about: str
    own: str
    other: str


class AwardedSum:
    """Awarded information matrices, kept in ascending order of elements."""

    __slots__ = ("_elements", "_rows")

    def __init__(self, objective: InformationObjective) -> None:
        self._elements: list[int] = []
        self._rows = objective.prior_information[None].copy()

    def add(self, element: int, flat: FloatArray) -> None:
        """Add an element's matrices, given as lower triangles one after the other."""
        place, k = bisect(self._elements, element) + 1, len(self._elements) + 1
        if k == len(self._rows):
            self._rows = np.concatenate([self._rows, np.empty_like(self._rows)])
        self._rows[place + 1 : k + 1] = self._rows[place:k].copy()
        self._rows[place] = from_triangles(flat.reshape(self._rows.shape[1], -1))
        self._elements.insert(place - 1, element)

    def posterior(self) -> FloatArray:
        """(M, d, d) posterior information, added as ``InformationObjective.posterior_information`` does."""
        return np.asarray(np.add.reduce(self._rows[: len(self._elements) + 1], axis=0))
