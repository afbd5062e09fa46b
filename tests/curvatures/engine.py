"""Ways of searching curvatures as tests know them; what a search answers is asked of the public functions."""

from ratt_opt import CurvatureParams

__all__ = ["FEW_PAIRS", "SEARCHED"]

SEARCHED = CurvatureParams(largest_enumeration=1)
"""Curvatures and ratios are searched, however small the function is."""
FEW_PAIRS = CurvatureParams(largest_pairs=1)
"""Ratios are searched by sets instead of pairs of sets."""
