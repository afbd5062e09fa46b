"""Trees over sets of robots, and over the groups of an attack, by compiled loops (``native/src/group_tree.c``)."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from ratt_opt.attack.thresholds.pricing import GroupSearch, Question
from ratt_opt.certificates.plan_sets import COVERING, NotClosedError
from ratt_opt.certificates.verifier.work import tell, tick
from ratt_opt.native.library import address
from ratt_opt.native.loops import GroupTreeRecord, RowRecord, loops

if TYPE_CHECKING:
    from collections.abc import Sequence

    from ratt_opt._validation import IntArray
    from ratt_opt.attack.thresholds.pricing import PricingProblem
    from ratt_opt.certificates.plan_sets import PlanSets

__all__ = ["GroupTree", "group_tree", "sets_proof"]

Limit = tuple[int, int]
"""A set of robots (bit mask), and the most of these that sense in a group below the threshold."""
BRANCHES, LEAVES = ("sense", "inside", "sensing", "blinded", "limit"), ("worth", "copies", "budget", "flow", "listed")
"""Nodes by their numbers in the compiled code."""
NUMBERED = (*BRANCHES, "flow")
FINISHED, PAUSED, FULL = range(3)


@dataclass(frozen=True, slots=True)
class GroupTree:
    """``nodes`` in preorder as a certificate has them; ``bounds`` : prices and flows; ``listed`` : masks of groups, and
    how many of each are blinded at least; ``used`` : limits that nodes name, by their places here."""

    nodes: list[Any]
    bounds: list[dict[str, Any]]
    listed: list[tuple[int, int]]
    used: list[Limit]


class _Trees:
    """The arrays that a tree is written to."""

    def __init__(
        self,
        plan: PricingProblem,
        limit: int,
        max_nodes: int,
        *,
        averages: bool,
        flows: int = 0,
        listed: int = 0,
        limits: Sequence[Limit] = (),
    ) -> None:
        robots, arcs = plan.robots, len(plan.links.robot)
        self.nodes = np.zeros((max_nodes + 4 * robots + 12, 2), np.int64)
        self.flows, self.recent = np.zeros((flows, 2 + arcs), np.int64), np.zeros(flows + 1, np.int64)
        self.listed, self.needs = np.zeros((listed, robots), np.int8), np.zeros(listed, np.int64)
        self.limited = np.array([limited for limited, _ in limits], np.uint64)
        self.most, self.uses = np.array([most for _, most in limits], np.int64), np.zeros(len(limits), np.int64)
        self.record = GroupTreeRecord(
            limit=limit,
            averages=averages,
            count=0,
            capacity=len(self.nodes),
            n_flows=0,
            most_flows=flows,
            n_listed=0,
            most_listed=listed,
            nodes=address(self.nodes),
            flows=address(self.flows),
            recent=address(self.recent),
            listed=address(self.listed),
            needs=address(self.needs),
            n_limits=len(limits),
            limited=address(self.limited),
            most=address(self.most),
            uses=address(self.uses),
        )

    def named(self, places: list[int]) -> list[Any]:
        """The nodes as a certificate has them; ``places`` : of the limits there."""
        names = *BRANCHES, *LEAVES
        written = ((names[kind], number) for kind, number in self.nodes[: self.record.count].tolist())
        return [
            {name: places[number] if name == "limit" else number} if name in NUMBERED else name
            for name, number in written
        ]


def sets_proof(
    sets: PlanSets, size: int, max_nodes: int, among: int | None = None, limits: Sequence[Limit] = ()
) -> dict[str, Any]:
    """Return the record of a proof that any ``size`` robots are worth the threshold, or any of those in a bit mask.

    ``limits`` : that are proved, which nodes name by their places

    Raises
    ------
    NotClosedError : a set is worth less, or the tree is too large.
    """
    plan = sets.plan
    if size > plan.robots:
        return {"size": size, "tree": ["budget"]}
    trees = _Trees(plan, 0, max_nodes, averages=sets.objective.verifier_averages, limits=limits)
    nobody = np.zeros(plan.robots, dtype=np.int64)
    members = np.array([among is None or among >> i & 1 for i in range(plan.robots)], np.int8)
    rows, depth = np.zeros(plan.robots + 1, RowRecord), np.full(1, -1, np.int32)
    places = address(members), address(rows), address(depth)
    params, looked, code = sets.params.trees, 0, PAUSED
    effort = params.criteria // sets.objective.n_targets
    search = GroupSearch(plan, Question(sets.threshold, plan.robots, nobody, 0, 0), nobody)
    while code == PAUSED and looked < params.most_criteria:
        tick()
        tell(COVERING, trees.record.count)
        code = loops.grow_sets_tree(search.handle, trees.record, *places, size, effort)
        looked += params.criteria
    if code != FINISHED:
        raise NotClosedError
    return {"size": size, "tree": trees.named(list(range(len(limits))))}


def group_tree(sets: PlanSets, question: Question, max_nodes: int, limits: Sequence[Limit] = ()) -> GroupTree:
    """Return a tree that closes or lists each group that costs at most ``question.limit``.

    Raises
    ------
    NotClosedError : a group is neither, or the tree is too large.
    """
    plan, params = sets.plan, sets.params.trees
    averages, links = sets.objective.verifier_averages, len(plan.threat.graph.links)
    flows = min(params.flows, params.flow_numbers // max(links, 1))
    trees = _Trees(plan, question.limit, max_nodes, averages=averages, flows=flows, listed=params.listed, limits=limits)
    first = np.argsort(-question.duals, kind="stable").astype(np.int64)
    record, code = trees.record, PAUSED
    search = GroupSearch(plan, question, first)
    while code == PAUSED:
        tick()
        tell(COVERING, record.count)
        code = loops.grow_group_tree(search.handle, record, params.cases)
    if code != FINISHED:
        raise NotClosedError
    masks = [sum(1 << int(i) for i in np.flatnonzero(row)) for row in trees.listed[: record.n_listed]]
    bounds = [_bound(plan, flow) for flow in trees.flows[: record.n_flows]]
    listed = list(zip(masks, trees.needs[: record.n_listed].tolist(), strict=True))
    used = [limits[k] for k in np.flatnonzero(trees.uses).tolist()]
    return GroupTree(trees.named((np.cumsum(trees.uses > 0) - 1).tolist()), bounds, listed, used)


def _bound(plan: PricingProblem, flow: IntArray) -> dict[str, Any]:
    """A bound as a certificate has it: what each link carries from its lower robot to the other."""
    links, carried = plan.links, flow[2:]
    arcs = [
        (i, int(links.robot[a]), int(carried[a]))
        for i in range(plan.robots)
        for a in range(int(links.start[i]), int(links.start[i + 1]))
        if links.robot[a] > i
    ]
    return {"blinding": int(flow[0]), "cut": int(flow[1]), "flow": [value for _, _, value in sorted(arcs)]}
