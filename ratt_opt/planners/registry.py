"""Published planners by name, with what is proved of each and where it comes from."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from ratt_opt.planners.partitioned_robust import partitioned_robust
from ratt_opt.planners.resilient_selection import resilient_selection
from ratt_opt.planners.resource_aware_greedy import resource_aware_greedy
from ratt_opt.planners.scenario_program import scenario_program
from ratt_opt.planners.sensing_only import sensing_only
from ratt_opt.planners.sequential_greedy import sequential_greedy
from ratt_opt.planners.uniform_buckets import uniform_buckets

if TYPE_CHECKING:
    from collections.abc import Callable

    from ratt_opt.problem import Plan

__all__ = ["PUBLISHED", "Published"]


@dataclass(frozen=True, slots=True, kw_only=True)
class Published:
    """A planner, its guarantee in a few words, and its source; ``takes_any`` set function, or sums of best elements."""

    plan: Callable[..., Plan]
    guarantee: str
    source: str
    takes_any: bool = True


PUBLISHED: dict[str, Published] = {
    "resilient_selection": Published(
        plan=resilient_selection,
        guarantee="max(1 - k, 1/(1 + alpha_s), 1/(N - alpha_s)) / (1 + k) of the optimum, if no link is cut",
        source="Tzoumas, Jadbabaie, Pappas 2018, arXiv 1804.01013",
    ),
    "sensing_only": Published(
        plan=sensing_only,
        guarantee="as resilient selection, whose choices it makes",
        source="Zhou, Tzoumas, Pappas, Tokekar, RA-L 2019",
    ),
    "uniform_buckets": Published(
        plan=uniform_buckets,
        guarantee="0.387 of the optimum for sets of N elements, in the limit of few lost ones; none for robots",
        source="Orlin, Schulz, Udwani, IPCO 2016",
    ),
    "partitioned_robust": Published(
        plan=partitioned_robust,
        guarantee="0.387 of the optimum for sets of N elements, in the limit of large ones; none for robots",
        source="Bogunovic, Mitrovic, Scarlett, Cevher, ICML 2017",
    ),
    "sequential_greedy": Published(
        plan=sequential_greedy,
        guarantee="1/(1 + k) of the best value, if nobody attacks",
        source="Fisher, Nemhauser, Wolsey 1978",
    ),
    "resource_aware_greedy": Published(
        plan=resource_aware_greedy,
        guarantee="(best value - k * centralized information) / (1 + k), if nobody attacks",
        source="Xu, Garimella, Tzoumas 2024, arXiv 2407.10382",
    ),
    "scenario_program": Published(
        plan=scenario_program,
        guarantee="the optimum, on HiGHS's word, if its ends meet",
        source="cutting planes over attacks; Orlin, Schulz, Udwani 2018, Section 1",
        takes_any=False,
    ),
}
"""Name -> planner."""
