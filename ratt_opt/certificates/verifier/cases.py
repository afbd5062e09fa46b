"""Trees over the groups that an attack leaves: the grammar of the lower end's proofs.

A case says of each robot what it may be: sensing in the group, blinded in it, or out of it. Branches split a case in
two; a leaf shows that no group of the case can be one of an attack that leaves less than the claim.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from ratt_opt.certificates.verifier.reading import array, fields, index, indices, need, walk

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator, Mapping

    from ratt_opt.certificates.verifier.statement import Statement
    from ratt_opt.certificates.verifier.worth import Known, Worth

    Close = Callable[["GroupCase", object], None]

__all__ = ["BRANCHES", "Cases", "GroupCase", "is_short", "mask_of", "read_node", "robots_of"]

BRANCHES = ("sense", "inside", "sensing", "blinded", "limit")
PLAIN = ("worth", "copies", "budget", "listed")
"""Leaves that are names; other nodes are records of a name and a number."""


@dataclass(frozen=True, slots=True)
class GroupCase:
    """Masks: robots that sense for sure, and the others that may sense, may be blinded, may be out of the group.

    ``known`` : those that sense for sure, as ``Worth`` has them; ``least`` to ``most`` robots of the group sense, and
    ``low`` to ``high`` of them are blinded
    """

    known: Known
    everyone: int
    sensing: int
    may_sense: int
    may_blind: int
    may_leave: int
    least: int
    most: int
    low: int
    high: int

    @property
    def inside(self) -> int:
        """Robots that cannot be out."""
        return self.everyone & ~self.may_leave

    @property
    def outside(self) -> int:
        """Robots that can only be out."""
        return self.may_leave & ~self.may_sense & ~self.may_blind

    @property
    def more(self) -> int:
        """Number of robots that may sense besides those that do for sure."""
        return self.most - self.sensing.bit_count()

    @property
    def need(self) -> int:
        """Blinded robots, at least."""
        inside = self.inside
        more = min(self.more, (inside & self.may_sense).bit_count())
        return max(self.low, (inside & ~self.sensing).bit_count() - more)


class Cases:
    """Checks trees about one plan and claim."""

    def __init__(self, about: Statement, worth: Worth) -> None:
        self.about, self.worth, self.everyone = about, worth, (1 << about.n) - 1
        self.near = [mask_of(others) for others in about.near]
        self.safe, self.tied = mask_of(about.safe_robots), [0] * about.n
        for i, j in about.safe_links:
            self.tied[i] |= 1 << j
            self.tied[j] |= 1 << i
        self.blinded = min(about.alpha_s, about.n - len(about.safe_robots))
        self.limits: list[tuple[int, int]] = []
        """Sets of robots, and the most of these that sense in a group worth less than the claim."""

    def check_limits(self, given: object) -> int:
        """Check that of each limit's robots any ``size`` are worth the claim; returns the number of leaves.

        The trees may name the limits before their own.
        """
        leaves = 0
        for limit in array("limits", given):
            members, number, tree = fields("limit", limit, "robots size tree")
            robots = indices("limit robots", members, self.about.n)
            size = index("limit size", number, self.about.n + 2)
            leaves += self.check_sets(size, tree, mask_of(robots))
            self.limits.append((mask_of(robots), size - 1))
        return leaves

    def check_sets(self, size: int, tree: object, among: int | None = None) -> int:
        """Check that a tree shows that any ``size`` robots are worth the claim; returns the number of its leaves.

        Robots that are not in the set may be in its group, blinded: of the rules for groups none holds.

        ``among`` : the robots of which this is said; all of them by default
        """
        everyone = self.everyone
        members = everyone if among is None else among
        root = GroupCase(self.worth.nobody, everyone, 0, members, 0, everyone, size, size, 0, 0)
        return self.check(tree, root, {"budget": self._close_no_set}, ("sense", "limit"))

    def groups(self, most: int, least: int = 0, blinded: int | None = None) -> GroupCase:
        """Groups of an attack: ``least`` to ``most`` of the robots sense; ``blinded``, if given, are blinded."""
        everyone, low, high = self.everyone, blinded or 0, self.blinded if blinded is None else blinded
        return GroupCase(
            self.worth.nobody, everyone, 0, everyone, everyone & ~self.safe, everyone, least, most, low, high
        )

    def check(
        self,
        tree: object,
        root: GroupCase,
        closing: Mapping[str, Close] | None = None,
        branches: tuple[str, ...] = BRANCHES,
    ) -> int:
        """Check that a tree closes a case; returns the number of its leaves.

        ``closing`` : what a conclusion's own leaves ask, by their names; ``branches`` : that the tree may have
        """
        known = {"worth": self._close_worth, "copies": self._close_copies, "budget": self._close_beyond}
        close: dict[str, Close] = {**known, **(closing or {})}

        def expand(node: object, case: GroupCase) -> Iterator[GroupCase]:
            name, number = read_node(node)
            need((number is not None) == (name not in PLAIN), f"lower proof: a node is not as {name} must be")
            if name in close:
                close[name](case, number)
            else:
                need(name in branches, f"lower proof: a node is none of this proof: {name}")
                yield from self.halves(name, number, case)

        return walk("lower", tree, root, expand)

    def halves(self, name: str, number: object, case: GroupCase) -> Iterator[GroupCase]:
        """Yield the cases below a branch."""
        n = self.about.n
        if name == "sensing":
            count = index("lower tree sensing", number, n + 1)
            yield replace(case, least=max(case.least, count))
            yield replace(case, most=min(case.most, count - 1))
        elif name == "blinded":
            count = index("lower tree blinded", number, n + 1)
            yield replace(case, high=min(case.high, count - 1))
            yield replace(case, low=max(case.low, count))
        elif name == "limit":
            robots, most = self.limits[index("lower tree limit", number, len(self.limits))]
            others = (case.sensing | case.may_sense) & ~robots
            blinded = (case.inside & robots).bit_count() - most
            yield replace(case, most=min(case.most, most + others.bit_count()), low=max(case.low, blinded))
        else:
            i = index(f"lower tree {name}", number, n)
            bit = 1 << i
            may_leave, may_blind = bool(case.may_leave & bit), bool(case.may_blind & bit)
            if name == "sense":
                need(case.may_sense & bit and (may_leave or may_blind), f"lower proof: robot {i} is decided twice")
                yield self._sensing(case, i)
                yield replace(case, may_sense=case.may_sense & ~bit)
            else:
                may_stay = case.may_sense & bit or may_blind
                need(may_leave and may_stay, f"lower proof: robot {i} is decided twice")
                yield replace(case, may_leave=case.may_leave & ~bit) if may_blind else self._sensing(case, i)
                yield replace(case, may_sense=case.may_sense & ~bit, may_blind=case.may_blind & ~bit)

    def _sensing(self, case: GroupCase, robot: int) -> GroupCase:
        others = self.everyone & ~(1 << robot)
        return replace(
            case,
            known=self.worth.plus(case.known, robot),
            sensing=case.sensing | 1 << robot,
            may_sense=case.may_sense & others,
            may_blind=case.may_blind & others,
            may_leave=case.may_leave & others,
        )

    def _close_worth(self, case: GroupCase, _: object) -> None:
        self.worth.require(case.known)

    def _close_copies(self, case: GroupCase, _: object) -> None:
        """Close a case: the sure robots with any ``count`` missing ones of the possible robots reach the claim."""
        among, count = case.may_sense, case.least - case.sensing.bit_count()
        if count <= 0:
            inside = case.inside
            among, count = case.may_sense & inside, (inside & ~case.sensing).bit_count() - case.high
        need(0 < count <= among.bit_count(), "lower proof: no robot is missing, or too few are left")
        self.worth.require(case.known, robots_of(among), count)

    def _close_no_set(self, case: GroupCase, _: object) -> None:
        need(is_short(case) or case.least > case.most, "lower proof: a leaf's set may have robots enough")

    def _close_beyond(self, case: GroupCase, _: object) -> None:
        need(self._is_beyond(case), "lower proof: a leaf's group may be part of an attack")

    def _is_beyond(self, case: GroupCase) -> bool:
        """Test whether an attack within the budgets leaves no group of the case."""
        inside, outside, lost = case.inside, case.outside, 0
        possible = self.everyone & ~outside
        if is_short(case) or max(case.sensing.bit_count(), case.least) > case.most:
            return True
        if case.need > case.high or possible.bit_count() < case.least + case.low:
            return True
        for i in robots_of(inside):
            lost += (self.near[i] & outside).bit_count()
            if self.tied[i] & outside:
                return True
        return lost > self.about.alpha_c or self.is_apart(inside, possible)

    def is_apart(self, inside: int, possible: int) -> bool:
        """Test whether robots inside are not connected by possible ones."""
        reached = front = inside & -inside
        while front:
            i = front.bit_length() - 1
            new = self.near[i] & possible & ~reached
            reached, front = reached | new, front ^ 1 << i | new
        return bool(inside & ~reached)


def is_short(case: GroupCase) -> bool:
    """Test whether fewer robots may sense than must."""
    return case.sensing.bit_count() + case.may_sense.bit_count() < case.least


def read_node(node: object) -> tuple[str, object]:
    """The name and the number of a node."""
    if isinstance(node, str):
        return node, None
    need(isinstance(node, dict) and len(node) == 1, "lower proof: a node must be a name, or a record of one")
    assert isinstance(node, dict)
    ((name, number),) = node.items()
    return name, number


def robots_of(mask: int) -> Iterator[int]:
    """The bits of a mask, ascending."""
    while mask:
        yield (mask & -mask).bit_length() - 1
        mask &= mask - 1


def mask_of(bits: Iterable[int]) -> int:
    """The mask with these bits."""
    return sum(1 << i for i in bits)
