"""Names of planners and attackers, for programs that only list them: nothing is loaded here."""

from __future__ import annotations

__all__ = ["ATTACKERS", "PLANNERS"]

PLANNERS = (
    "ratt",
    "decentralised",
    "decentralised_refined",
    "refined",
    "maxmin",
    "greedy",
    "myopic",
    "nonrobust_optimum",
    "random",
    "resilient_selection",
    "sensing_only",
    "uniform_buckets",
    "partitioned_robust",
    "sequential_greedy",
    "resource_aware_greedy",
)
"""Planners of missions. A table of them that lacks one, or has another, is not loaded."""
ATTACKERS = ("none", "worst", "bounded_rational", "greedy", "random")
"""Attackers of missions, in the same way."""
