"""Whether listed groups cover the team, as the verifier decides it, and sets that say they do not."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from ratt_opt.certificates.plan_sets import NotClosedError
from ratt_opt.certificates.threatened import Team
from ratt_opt.certificates.verifier.lower_end.group_costs import Group, Groups
from ratt_opt.certificates.verifier.lower_end.partitions import Partitions

if TYPE_CHECKING:
    from ratt_opt.certificates.group_covers.weak_sets import WeakSets
    from ratt_opt.graph.threat import Threat

__all__ = ["refute_covers"]

STEPS = 60_000
"""Most steps of a search of partitions."""


def refute_covers(threat: Threat, weak: WeakSets, record: dict[str, Any], masks: list[int]) -> None:
    """Add weak sets until no partition into the groups is within the budgets.

    Raises
    ------
    NotClosedError : one is.
    UndecidedError : the search takes too long.
    """
    cover: list[Group] | None = []
    while cover is not None:
        groups = Groups(Team.of(threat), *(record[name] for name in ("half_link", "robots", "blinded")))
        groups.sets = list(zip(weak.robots, weak.room, strict=True))
        groups.add(record["group"], record["triples"])
        groups.flows = [groups.carried(flow) for flow in record.get("flows", ())]
        listed = [group for mask in masks if (group := groups.group_of(mask)) and group.cost <= groups.limit]
        cover = Partitions(listed, groups).first(STEPS)
        raised = [weak.raise_need(group.robots) for group in cover or ()]
        if cover is not None and not any(raised):
            raise NotClosedError
