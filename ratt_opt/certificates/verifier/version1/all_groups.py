"""The plan keeps a value under every attack on any graph: of all groups that an attack may leave, none cover the team.

As ``group_covers.py``, where these groups are few enough to be looked at one by one: no tree and no flows are given.
A group that an attack may leave is connected and loses at most ``alpha_c`` links, none of them protected. Each grows
from its lowest robot: a robot beside it is inside, too, or outside, and its links to the others are lost then.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from ratt_opt.certificates.verifier.reading import fields, need
from ratt_opt.certificates.verifier.version1.group_costs import robots_of
from ratt_opt.certificates.verifier.version1.group_covers import priced_groups
from ratt_opt.certificates.verifier.version1.partitions import Partitions, refuse_many
from ratt_opt.certificates.verifier.work import tell, tick

if TYPE_CHECKING:
    from collections.abc import Iterator

    from ratt_opt.certificates.verifier.statement import Statement
    from ratt_opt.certificates.verifier.version1.group_costs import Group, Groups
    from ratt_opt.certificates.verifier.worth import Worth

__all__ = ["cheap_groups", "check_all_groups"]


def check_all_groups(about: Statement, part: Any, worth: Worth) -> int:
    """Check the proof; returns its leaves, those of the sets' trees and the groups."""
    _, *prices = fields("lower proof", part, "kind half_link robots blinded group sets triples")
    groups, leaves = priced_groups(about, worth, *prices)
    listed: list[Group] = []
    for inside in cheap_groups(groups):
        leaves += 1
        tell("lower proof", leaves)
        group = groups.group_of(inside)
        need(group is None or group.cost >= 0, "lower proof: a group costs less than nothing")
        listed.extend([group] if group and group.cost <= groups.limit else [])
        refuse_many(listed)
    cover = Partitions(listed, groups).first()
    need(cover is None, "lower proof: groups within the budgets cover the team")
    return leaves + 1


def cheap_groups(groups: Groups) -> Iterator[int]:
    """All groups that an attack may leave, as masks, but for those that cost more than the limit with nobody blinded.

    A robot that is neither inside nor outside yet loses its links to the one or to the other in the end.
    """
    near, tied, alpha_c = groups.near, groups.tied, groups.about.alpha_c
    counted, room = groups.sets[0] if groups.sets else (0, 0)
    for first in range(groups.about.n):
        below = (1 << first) - 1
        stack = [(1 << first, below, near[first], (near[first] & below).bit_count())]
        while stack and not tied[first] & below:
            tick()
            inside, outside, reach, lost = stack.pop()
            if (inside & counted).bit_count() - room > groups.most:
                continue
            least, most, pick, left = lost, -1, 0, reach & ~inside & ~outside
            while left and least <= alpha_c:
                i = left.bit_length() - 1
                left ^= 1 << i
                stays, joins = (near[i] & inside).bit_count(), (near[i] & outside).bit_count()
                least += stays if stays < joins else joins
                if stays + joins > most:
                    most, pick = stays + joins, i
            if least > alpha_c:
                continue
            if most < 0:  # no robot is beside it
                paid = sum(groups.robot[i] for i in robots_of(inside)) + groups.group
                if groups.half * lost - paid <= groups.limit:
                    yield inside
                continue
            stays, joins = (near[pick] & inside).bit_count(), (near[pick] & outside).bit_count()
            if lost + stays <= alpha_c and not tied[pick] & inside:
                stack.append((inside, outside | 1 << pick, reach, lost + stays))
            if lost + joins <= alpha_c and not tied[pick] & outside:
                stack.append((inside | 1 << pick, outside, reach | near[pick], lost + joins))
