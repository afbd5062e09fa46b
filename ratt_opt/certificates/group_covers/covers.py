"""What proofs by covers share: records of prices and weak sets, and whether listed groups cover the team."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from ratt_opt.attackers.by_covers.cover_prices import HALF_LINK
from ratt_opt.certificates.plan_sets import NotClosedError
from ratt_opt.certificates.size_tree import size_tree
from ratt_opt.certificates.threatened import Team
from ratt_opt.certificates.verifier.lower_end.group_costs import Group, Groups, robots_of
from ratt_opt.certificates.verifier.lower_end.partitions import Partitions

if TYPE_CHECKING:
    from ratt_opt.attackers.by_covers.cover_prices import CoverPrices
    from ratt_opt.attackers.by_covers.weak_sets import WeakSets
    from ratt_opt.certificates.plan_sets import PlanSets
    from ratt_opt.graph.threat import Threat

__all__ = ["price_record", "refute_covers", "set_records"]

STEPS = 60_000
"""Most steps of a search of partitions."""


def price_record(prices: CoverPrices) -> dict[str, Any]:
    """The prices as the verifier reads them."""
    triples = [(int(t), int(p)) for t, p in zip(prices.triple, prices.penalty, strict=True) if p]
    return {
        "half_link": HALF_LINK,
        "robots": prices.robot.tolist(),
        "blinded": prices.blinded,
        "group": prices.group,
        "triples": [{"robots": list(robots_of(t)), "half_penalty": p // 2} for t, p in triples],
    }


def set_records(weak: WeakSets, sets: PlanSets, max_nodes: int) -> list[dict[str, Any]]:
    """The weak sets with their proofs.

    Raises
    ------
    NotClosedError : the trees are too large.
    """
    records: list[dict[str, Any]] = []
    nodes = 0
    for mask, room in zip(weak.robots, weak.room, strict=True):
        robots = list(robots_of(mask))
        records.append({"robots": robots, "room": room, "tree": size_tree(sets, room + 1, max_nodes, robots)})
        nodes += len(records[-1]["tree"])
        if nodes > max_nodes:
            raise NotClosedError
    return records


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
