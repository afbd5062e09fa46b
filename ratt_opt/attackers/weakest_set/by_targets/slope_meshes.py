"""Cells of slopes, kept from one search (``slope_cells.py``) for the next: compiled.

Cells that contain all gradients of one family of sets contain those of others whose gradients are no larger, and what
is proved in a cell is proved anew for each. So a search of sets much like the last ones begins with the cells at its
end, and with the weights by which they were bounded: most are bounded by one matrix again. At 60 robots, (0, 1226),
log-det, half of a proof from nothing goes to cells that say nothing yet.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from ratt_opt.running.compiling import numba

__all__ = ["HEAVY", "Meshes", "begin", "keep", "resume"]

HEAVY = 4
"""Robots of a target with and without which its choices are searched apart, at most."""
MESH = 1_000
"""Corners of the cells that are kept, at most."""


class Meshes(NamedTuple):
    """Cells of the last searches, of each target and pattern of heavy robots, for searches of other families.

    ``n_corners`` (K,) of each slot, 0 for no cells, which are three fewer; ``white`` (K, V, 3), ``cells`` (K, V, 4) and
    ``weights`` (K, V, 4) as in ``cell_bound.py``; ``mean`` (K, 3) is the unit matrix of the coordinates; the cells
    contain all gradients with eigenvalues up to ``high`` (K,) there
    """

    n_corners: Any
    white: Any
    cells: Any
    weights: Any
    mean: Any
    high: Any

    @classmethod
    def of(cls, n_targets: int) -> Meshes:
        """None yet."""
        slots = n_targets * 2**HEAVY
        return cls(
            n_corners=np.zeros(slots, dtype=np.int64),
            white=np.empty((slots, MESH, 3)),
            cells=np.empty((slots, MESH, 4), dtype=np.int16),
            weights=np.empty((slots, MESH, 4)),
            mean=np.empty((slots, 3)),
            high=np.empty(slots),
        )


@numba.njit(cache=True)
def begin(high: float, corners: Any, cells: Any) -> int:
    """Slopes with eigenvalues of at most ``high``, of none at least, in one cell; returns its corners."""
    # Matrices of trace t without negative eigenvalues are a disk, and in the triangle around it.
    corners.white[0] = 0.0
    for k in range(1, 4):
        x, y = 2 * np.cos(2 * np.pi * k / 3), 2 * np.sin(2 * np.pi * k / 3)
        corners.white[k, 0], corners.white[k, 1], corners.white[k, 2] = high * (1 + x), high * y, high * (1 - x)
    cells[0] = np.arange(4)
    return 4


@numba.njit(cache=True)
def resume(meshes: Any, slot: int, corners: Any, cells: Any, weights: Any) -> int:
    """The cells that a slot has; returns their corners, 0 for none."""
    n_corners = meshes.n_corners[slot]
    if n_corners == 0:
        return 0
    corners.white[:n_corners] = meshes.white[slot, :n_corners]
    cells[: n_corners - 3] = meshes.cells[slot, : n_corners - 3]
    weights[: n_corners - 3] = meshes.weights[slot, : n_corners - 3]
    return int(n_corners)


@numba.njit(cache=True)
def keep(meshes: Any, slot: int, n_corners: int, corners: Any, cells: Any, weights: Any) -> None:  # noqa: PLR0917
    """Let the slot have these cells, or none where they are too many."""
    if n_corners > meshes.white.shape[1]:
        meshes.n_corners[slot] = 0
        return
    meshes.n_corners[slot] = n_corners
    meshes.white[slot, :n_corners] = corners.white[:n_corners]
    meshes.cells[slot, : n_corners - 3] = cells[: n_corners - 3]
    meshes.weights[slot, : n_corners - 3] = weights[: n_corners - 3]
