"""Sets of robots of low value in large teams, by linearising the value: no claim.

The value is concave in the posterior information, so its linearisation at a set's information is nowhere below it. The
robots of least linearised value are therefore worth no more than the set, and so on from them. A step costs as much as
one look at each robot; an exchange (``exchanges.py``) looks at all pairs.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ratt_opt.setfunctions.information import from_triangles, triangles

if TYPE_CHECKING:
    from ratt_opt._validation import FloatArray, IntArray
    from ratt_opt.attack.least_sets.packed_team import PackedTeam

__all__ = ["descended"]


def descended(team: PackedTeam, start: IntArray) -> IntArray:
    """Robots, as many as in ``start`` (K,) and worth no more; from the end of their descent."""
    chosen, value = start, team.value(start)
    while True:
        scores = np.einsum("nmt,mt->n", team.information, _slopes(team, team.sums(chosen)))
        others = np.argsort(scores, kind="stable")[: len(start)]
        if (lower := team.value(others)) >= value:
            return chosen
        chosen, value = others, lower


def _slopes(team: PackedTeam, sums: FloatArray) -> FloatArray:
    """(M, T) supergradient of the value in the entries of packed matrices, at posterior information (M, T)."""
    gradient = team.objective.gradient(from_triangles(sums))
    off_diagonal_twice = triangles(2 - np.eye(gradient.shape[-1]))
    return off_diagonal_twice * triangles(gradient)
