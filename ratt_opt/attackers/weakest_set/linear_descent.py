"""Sets of robots of low value in large teams, by linearising the value: no claim.

The value is concave in the posterior information, so its linearisation at a set's information is nowhere below it. The
robots of least linearised value are therefore worth no more than the set, and so on from them. A step costs as much as
one look at each robot, where an exchange (``exchanges.py``) looks at all pairs.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from ratt_opt._validation import FloatArray, IntArray
    from ratt_opt.attackers.weakest_set.planar_team import PlanarTeam

__all__ = ["descended"]


def descended(team: PlanarTeam, start: IntArray) -> IntArray:
    """Robots, as many as in ``start`` (K,) and worth no more; from the end of their descent."""
    chosen, value = start, team.value(start)
    while True:
        scores = np.einsum("nmt,mt->n", team.information, _slopes(team, team.sums(chosen)))
        others = np.argsort(scores, kind="stable")[: len(start)]
        if (lower := team.value(others)) >= value:
            return chosen
        chosen, value = others, lower


def _slopes(team: PlanarTeam, sums: FloatArray) -> FloatArray:
    """(M, 3) supergradient of the value in the entries of ``[[a, b], [b, c]]``, at posterior information (M, 3)."""
    matrices = np.stack([sums[:, :2], sums[:, 1:]], axis=1)
    gradient = team.objective.gradient(matrices)
    return np.stack([gradient[:, 0, 0], 2 * gradient[:, 0, 1], gradient[:, 1, 1]], axis=-1)
