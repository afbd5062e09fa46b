"""A robot's view of its component: who is in it, which links, and the tree along which it plans.

A link is live if the records of both its ends name the other one. All robots of a component that know the same records
have the same view, and they need no message to agree on the tree: it grows breadth-first from the middle of a longest
path found by two sweeps (on a tree, its centre), so that it is at most about half as deep as from an end.
"""

from __future__ import annotations

from collections import deque
from dataclasses import dataclass
from hashlib import blake2b
from math import inf
from typing import TYPE_CHECKING

from ratt_opt.graph.communication import CommunicationGraph
from ratt_opt.graph.threat import Threat

if TYPE_CHECKING:
    from collections.abc import Mapping

    from ratt_opt.decentralised.messages import LinkRecord

__all__ = ["ComponentView", "digest", "live_component", "make_view"]


def digest(*parts: object) -> bytes:
    """8 bytes that tell different data apart."""
    return blake2b("\n".join(map(str, parts)).encode(), digest_size=8).digest()


@dataclass(frozen=True, slots=True, eq=False)
class ComponentView:
    """One component, as all of its robots see it.

    ``near`` : live neighbours of each member; ``members`` : ascending. ``threat`` : the component's links with what an
    attack on it may do, robots numbered by their place in ``members``. ``parent`` : of each member on the way to
    ``root``; ``order`` : members, parents first.
    """

    digest: bytes
    near: Mapping[int, list[int]]
    members: tuple[int, ...]
    threat: Threat
    root: int
    parent: Mapping[int, int]
    order: tuple[int, ...]

    def branches(self, robot: int) -> dict[int, int]:
        """Members below a robot -> its child on the way to them."""
        via: dict[int, int] = {}
        for i in self.order:
            above = self.parent.get(i)
            if above == robot:
                via[i] = i
            elif above in via:
                via[i] = via[above]
        return via

    def within(self, robot: int, hops: int) -> dict[int, int]:
        """Parent of each other robot within some links of one, on a shortest way to it."""
        return _tree(self.near, robot, hops)


def live_component(records: Mapping[int, LinkRecord], start: int) -> dict[int, list[int]] | int:
    """Live neighbours of each robot of the component of ``start``; or a robot of it whose record is missing.

    A robot named by another one counts as linked to it until its own record says otherwise.
    """
    found: dict[int, list[int]] = {}
    waiting = [start]
    while waiting:
        i = waiting.pop()
        if i in found:
            continue
        near = []
        for j in records[i].neighbours:
            if j not in records:
                return j
            if i in records[j].neighbours:
                near.append(j)
        found[i] = near
        waiting += [j for j in near if j not in found]
    return found


def make_view(
    near: Mapping[int, list[int]], records: Mapping[int, LinkRecord], alpha_s: int, alpha_c: int
) -> ComponentView:
    """Component from the live neighbours of its members; budgets are clamped to what can be attacked."""
    members = tuple(sorted(near))
    place = {i: k for k, i in enumerate(members)}
    links = sorted((i, j) for i in members for j in near[i] if i < j)
    kept = [(i, j) for i, j in links if j in records[i].protected or i in records[j].protected]
    blinded = [i for i in members if records[i].blinded]
    sheltered = [i for i in members if records[i].is_protected]
    graph = CommunicationGraph(len(members), frozenset((place[i], place[j]) for i, j in links))
    threat = Threat(
        graph,
        min(alpha_s, len(members)),
        min(alpha_c, len(links)),
        frozenset(place[i] for i in sheltered),
        protected_links=frozenset((place[i], place[j]) for i, j in kept),
    )
    root = _middle(near, members[0])
    parent = _tree(near, root)
    order = (root, *parent)
    name = digest(members, links, kept, blinded, sheltered)
    return ComponentView(name, near, members, threat, root, parent, order)


def _tree(near: Mapping[int, list[int]], root: int, hops: float = inf) -> dict[int, int]:
    """Breadth-first, up to some hops: parent of each other robot, in the order in which they are met."""
    parent, waiting, depth = {root: root}, deque([root]), {root: 0}
    while waiting:
        i = waiting.popleft()
        if depth[i] >= hops:
            break
        for j in sorted(near[i]):
            if j not in parent:
                parent[j], depth[j] = i, depth[i] + 1
                waiting.append(j)
    del parent[root]
    return parent


def _middle(near: Mapping[int, list[int]], start: int) -> int:
    """Robot in the middle of a path between two robots that are far from each other."""
    one = _last(near, start)
    above = _tree(near, one)
    path = [next(reversed(above), one)]
    while path[-1] != one:
        path.append(above[path[-1]])
    return path[len(path) // 2]


def _last(near: Mapping[int, list[int]], start: int) -> int:
    return next(reversed(_tree(near, start)), start)
