"""How small one element's marginal of the max-eigenvalue criterion can be."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ratt_opt.setfunctions.attained import Attained
from ratt_opt.setfunctions.minorants import others_of

if TYPE_CHECKING:
    from ratt_opt._validation import IntArray
    from ratt_opt.setfunctions.information import InformationObjective

__all__ = ["EigenvalueSearch"]


class EigenvalueSearch:
    """Claim: ``lower <= smallest marginal of x over contexts <= attained.value``; see :class:`Attained`."""

    def __init__(self, f: InformationObjective, owners: IntArray, x: int) -> None:
        self.others = others_of(f, owners, x)
        self.attained = Attained(f, x, self.others)
        self.nodes = 1
        self.lower = 0.0
        single = f.singletons()[self.others.elements]
        hits = [
            int(np.flatnonzero(self.others.robot == i)[single[self.others.robot == i].argmax()])
            for i in range(len(self.others.first))
        ]
        self.attained.offer(self.others.elements[np.array(hits, dtype=np.int64)])
        self.attained.descend()

    @property
    def exhausted(self) -> bool:
        """Whether nothing is left to refine."""
        return True

    def refine(self) -> None:
        """Nothing to refine."""
