"""Curvature, total curvature and ratios of set functions, over every domain."""
