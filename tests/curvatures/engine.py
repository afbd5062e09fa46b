"""Ways of searching curvatures as tests know them; what a search answers is asked of the public functions."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ratt_opt.curvatures import curvature, ratios

if TYPE_CHECKING:
    from tests.ways import Way

__all__ = ["FEW_PAIRS", "RATIOS_SEARCHED", "SEARCHED", "enumerated"]


def enumerated(largest: int) -> Way:
    """Up to so many contexts are enumerated."""
    return {(curvature, "LARGEST_ENUMERATION"): largest}


SEARCHED = enumerated(1)
"""Curvatures are searched, however small the function is."""
RATIOS_SEARCHED = {(ratios, "LARGEST_ENUMERATION"): 1}
FEW_PAIRS = {(ratios, "LARGEST_PAIRS"): 1}
"""Ratios are searched, and by sets instead of pairs of sets."""
