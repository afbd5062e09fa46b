"""All partitions that a few cut links leave, one by one: if links and cuts are few, the quickest exact way.

Real networks are large and hardly more than trees. With one cut each link is one case, whatever the team's
size.
"""

from __future__ import annotations

from itertools import combinations
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterator

    from ratt_opt.budget import Budget
    from ratt_opt.graph.communication import Link
    from ratt_opt.graph.threat import Threat

__all__ = ["partitions_by_few_cuts"]


def partitions_by_few_cuts(
    threat: Threat, budget: Budget
) -> Iterator[tuple[frozenset[Link], tuple[frozenset[int], ...]]]:
    """Yield each partition that cutting all the links allowed can leave, once, with the links first found to leave it.

    A node is a set of links.

    Raises
    ------
    OutOfBudget : the time is up, or no node is left.
    """
    seen: set[tuple[frozenset[int], ...]] = set()
    for cut in combinations(sorted(threat.graph.links - threat.protected_links), threat.n_cut):
        budget.spend()
        groups = threat.graph.groups(cut)
        if groups not in seen:
            seen.add(groups)
            yield frozenset(cut), groups
