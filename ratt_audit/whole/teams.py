"""Teams with budgets and an attack around the group that a line of the appendix speaks of.

A chain names the robots of one group, V1 or another one, and who of it is blinded. The rest of the team follows from
the pattern: baits in other groups, and in Pattern 2 the group V2 with the greedy robot ``x1``. The attack cuts the
complete graph into these groups, within the budget.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import accumulate, combinations
from typing import TYPE_CHECKING

from ratt_audit.appendix.roles import Team
from ratt_audit.enumeration.setting import every_setting
from ratt_opt.graph.communication import CommunicationGraph
from ratt_opt.graph.outcomes import non_dominated_outcomes
from ratt_opt.graph.threat import Threat

if TYPE_CHECKING:
    from collections.abc import Iterator

    from ratt_audit.appendix.roles import Robots, SizedClaim
    from ratt_audit.enumeration.setting import Setting

    Groups = tuple[Robots, ...]

__all__ = ["WholeTeam", "whole_teams"]

ALONE = "readings"
"""Chain of the lines on the team as a whole: one group is the team."""


@dataclass(frozen=True, slots=True)
class WholeTeam:
    """All robots by their roles, the budgets, the groups that A* leaves, and whom it blinds.

    ``groups`` : every robot once, the group of the line first
    """

    team: Team
    alpha_s: int
    alpha_c: int
    groups: Groups
    blinded: frozenset[str]

    @property
    def left(self) -> Groups:
        """Unblinded robots of each group that has any."""
        left = (tuple(r for r in group if r not in self.blinded) for group in self.groups)
        return tuple(group for group in left if group)

    def outcomes(self) -> tuple[Groups, ...]:
        """Unblinded groups that the attacks within the budgets leave, without dominated ones."""
        n_robots = len(self.team.robots)
        threat = Threat(CommunicationGraph.complete(n_robots), self.alpha_s, self.alpha_c)
        robots = self.team.robots
        return tuple(
            tuple(tuple(robots[i] for i in sorted(group)) for group in outcome if group)
            for outcome in non_dominated_outcomes(threat)
        )

    @property
    def size(self) -> tuple[int, int, int]:
        """Robots and budgets: the order in which teams are tried."""
        return len(self.team.robots), self.alpha_s, self.alpha_c

    def text(self) -> str:
        """The budgets, groups and blinded robots in words."""
        groups = ", ".join(f"{{{','.join(group)}}}" for group in self.groups)
        budgets = f"N = {len(self.team.robots)}, alpha_s = {self.alpha_s}, alpha_c = {self.alpha_c}"
        return f"{budgets}; A* leaves groups {groups} and blinds {','.join(sorted(self.blinded)) or 'nobody'}"


@dataclass(frozen=True, slots=True)
class _Place:
    """Place of a chain's group: its pattern, the distribution of blinded robots, and whether it is V1."""

    pattern: int
    distribution: int
    is_first: bool

    @staticmethod
    def of(chain: str) -> _Place:
        """Read it from the paper's label, such as ``nd_p1d2v1``; ``sub_p2vk`` stands beside Distribution 1."""
        digits = chain.split("_")[1]
        distribution = int(digits[3]) if digits[2] == "d" else 1
        return _Place(int(digits[1]), distribution, is_first=digits.endswith("v1"))

    def fits(self, sized: SizedClaim, elsewhere: int) -> bool:
        """Tell whether blinding ``elsewhere`` robots outside the group, too, is what the distribution says."""
        assert sized.team is not None
        inside, second = len(sized.attacked), sum(r.startswith("x") for r in sized.team.greedy)
        if not self.is_first:
            return elsewhere > 0 or self.distribution != 1
        is_spread = (elsewhere == 0, inside == 0, inside > 0 and elsewhere > 0)[self.distribution - 1]
        return is_spread and len(sized.team.bait) == inside + elsewhere + second

    def pool(self, groups: Groups, first: int) -> Robots:
        """Robots outside the line's group that the distribution lets an attack blind; V1 is group ``first``."""
        outside = [r for k, group in enumerate(groups) if k not in (0, first) for r in group]
        if self.pattern == 2 and self.distribution == 2:
            outside = list(groups[first + 1])
        inside = groups[first] if first else ()
        return (tuple(inside), tuple(outside), (*inside, *outside))[self.distribution - 1]


def whole_teams(chain: str, sized: SizedClaim, *, largest: int) -> Iterator[WholeTeam]:
    """Yield teams of at most ``largest`` robots in which the group of one size of a chain occurs, smallest first."""
    if chain == ALONE:
        yield from _alone(sized)
        return
    place = _Place.of(chain)
    for setting in every_setting(largest):
        if setting.alpha_s and setting.n_greedy > 0 and setting.alpha_cs:
            yield from _completed(place, sized, setting)


def _alone(sized: SizedClaim) -> Iterator[WholeTeam]:
    """Yield the team itself as one group, of which robots are blinded and no link is cut."""
    assert sized.team is not None
    yield WholeTeam(sized.team, len(sized.attacked), 0, (sized.team.robots,), frozenset(sized.attacked))


def _completed(place: _Place, sized: SizedClaim, setting: Setting) -> Iterator[WholeTeam]:
    """Yield the ways to place the robots that the group lacks, and to blind those that it does not have."""
    assert sized.team is not None
    greedy = sized.team.greedy if place.is_first else tuple(f"g{i + 1}" for i in range(setting.n_greedy))
    if place.pattern == 2 and not place.is_first:
        greedy = (*greedy[1:], "x1")
    group = tuple(r for r in sized.team.robots if not r.startswith("x"))
    elsewhere = setting.alpha_s - len(sized.attacked)
    baits = tuple(f"b{i + 1}" for i in range(setting.alpha))
    if len(greedy) != setting.n_greedy or len(baits) < len(sized.team.bait) or not place.fits(sized, elsewhere):
        return
    team = Team(baits, greedy)
    for groups in _groupings(place, group, team, setting):
        if _links_cut(groups) <= setting.alpha_c:
            pool = place.pool(groups, 0 if place.is_first else 1)
            for others in combinations(pool, elsewhere):
                if all(_begins_with(others, members) for members in groups[1:]):
                    blinded = frozenset((*sized.attacked, *others))
                    yield WholeTeam(team, setting.alpha_s, setting.alpha_c, groups, blinded)


def _groupings(place: _Place, group: Robots, team: Team, setting: Setting) -> Iterator[Groups]:
    """Yield the groups: the line's, V1 if it is another one, V2 in Pattern 2, and baits as they come."""
    spare = tuple(b for b in team.bait if b not in group)
    second = tuple(r for r in team.greedy if r.startswith("x"))
    heads: Groups = (group,)
    if not place.is_first:
        count = setting.alpha_s + len(second)
        heads, spare = (group, (*spare[:count], *(g for g in team.greedy if g not in second))), spare[count:]
    for count in range(1, len(spare) + 1) if second else (0,):
        for sizes in _sizes(len(spare) - count, len(spare)):
            beside = ((*spare[:count], *second),) if second else ()
            yield (*heads, *beside, *_cut(spare[count:], sizes))


def _sizes(total: int, largest: int) -> Iterator[tuple[int, ...]]:
    if total == 0:
        yield ()
    for part in range(min(total, largest), 0, -1):
        yield from ((part, *rest) for rest in _sizes(total - part, part))


def _cut(robots: Robots, sizes: tuple[int, ...]) -> Groups:
    ends = list(accumulate(sizes))
    return tuple(robots[end - size : end] for size, end in zip(sizes, ends, strict=True))


def _links_cut(groups: Groups) -> int:
    return (sum(map(len, groups)) ** 2 - sum(len(group) ** 2 for group in groups)) // 2


def _begins_with(blinded: Robots, group: Robots) -> bool:
    """Baits of a group are alike, so its first ones are blinded first."""
    hit = [r in blinded for r in group if r.startswith("b")]
    return hit == sorted(hit, reverse=True)
