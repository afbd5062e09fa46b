"""Planners: RATT, baselines, the exhaustive optimum, exact max-min search."""
