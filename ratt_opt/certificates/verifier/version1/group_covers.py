"""The plan keeps a value under every attack on any graph: no groups that an attack may leave cover the team.

An attack that leaves only groups worth less than the claim partitions the team into connected groups g, blinding b_g
robots in each. In units of which ``half_link`` are half a link, robot i has a price p_i of any sign, a group q >= 0, a
blinded robot costs u >= 0, and three robots T have a penalty s_T >= 0 in a group that holds two of them: one at most
does. With need(g) <= b_g and at least ``fewest`` groups, the costs

    half_link * (links between g and the others) + u need(g) + sum of s_T over |g and T| >= 2 - sum of p_i over g - q

of the attack's groups add up to at most

    slack = 2 half_link alpha_c + u min(alpha_s, robots that may be blinded) + sum of s_T - sum of all p_i - q fewest.

Given are sets X of which any room(X) + 1 robots are worth the claim. So need(g) = max over X of |g and X| - room(X),
and each group holds at most room(X) of those |X| - min(alpha_s, ...) of X at least that see. A tree over who is inside
a group shows that none costs less than nothing and which cost no more than half the slack; these are listed. An attack
leaves one other group at most: a search of disjoint listed groups finds none that are, with all other robots as one
group or none, within the budgets.

Flows bound what a case's groups cost: a flow of at most half_link on each link (of any size on one that is protected)
carries out of a group at most half_link a lost link. Links and triples with decided robots count as they are.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from ratt_opt.certificates.verifier.reading import array, fields, index, indices, need, walk
from ratt_opt.certificates.verifier.version1.group_costs import Case, Group, Groups, mask_of
from ratt_opt.certificates.verifier.version1.partitions import Partitions, refuse_many
from ratt_opt.certificates.verifier.version1.size_tree import check_size_tree

if TYPE_CHECKING:
    from collections.abc import Iterator

    from ratt_opt.certificates.verifier.statement import Statement
    from ratt_opt.certificates.verifier.worth import Worth

__all__ = ["check_group_covers", "priced_groups"]


def check_group_covers(about: Statement, part: Any, worth: Worth) -> int:
    """Check the proof; returns its leaves.

    Cases in preorder, i >= 0: robot i is inside the group; or outside. -1: no further robot can be in the group, which
    is listed unless it costs more than half the slack. -2: no group of the case is part of an attack. -3 - k: all of
    them cost more, by the flow and the set of the number k = flow * sets + set.
    """
    names = "kind half_link robots blinded group sets triples flows tree"
    _, half, robots, blinded, group, sets, triples, flows, tree = fields("lower proof", part, names)
    groups, leaves = priced_groups(about, worth, half, robots, blinded, group, sets, triples)
    groups.flows = [groups.carried(flow) for flow in array("flows", flows)]
    listed: list[Group] = []

    def expand(node: Any, case: Case) -> Iterator[Case]:
        inside, outside = groups.settled(case)
        open_ = groups.everyone & ~inside & ~outside
        if node == -1:
            need(not open_, "lower proof: a leaf's group is not complete")
            group = groups.group_of(inside)
            need(group is None or group.cost >= 0, "lower proof: a group costs less than nothing")
            listed.extend([group] if group and group.cost <= groups.limit else [])
            refuse_many(listed)
        elif node == -2:
            need(groups.impossible(inside, outside), "lower proof: a leaf's group may be part of an attack")
        elif type(node) is int and node < 0:
            number = index("lower tree bound", -3 - node, len(groups.flows) * len(groups.sets))
            least = groups.least(inside, outside, *divmod(number, len(groups.sets)))
            need(least > groups.limit, "lower proof: a group of a leaf may cost too little")
        else:
            i = index("lower tree", node, about.n)
            need(open_ >> i & 1, f"lower proof: robot {i} is decided twice")
            yield inside | 1 << i, outside
            yield inside, outside | 1 << i

    leaves += walk("lower", tree, (0, 0), expand)
    cover = Partitions(listed, groups).first()
    need(cover is None, "lower proof: groups within the budgets cover the team")
    return leaves


def priced_groups(about: Statement, worth: Worth, *prices: Any) -> tuple[Groups, int]:
    """Groups at prices of half a link, robots, a blinded robot and a group, with sets and triples, after checking them.

    Returns the leaves of the sets' trees, too.
    """
    half, robots, blinded, group, sets, triples = prices
    groups, leaves = Groups(about, half, robots, blinded), 0
    for given in array("sets", sets):
        members, room, proof = fields("set", given, "robots room tree")
        inside, most = indices("set robots", members, about.n), index("set room", room, about.n)
        others = frozenset(range(about.n)).difference(inside)
        leaves += check_size_tree(about.n, most + 1, proof, worth, others)
        groups.sets.append((mask_of(inside), most))
    groups.add(group, triples)
    return groups, leaves
