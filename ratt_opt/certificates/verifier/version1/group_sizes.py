"""The plan keeps a value under every attack on any graph, by the sizes of the groups that an attack can leave.

Blinding more robots makes no group better: say that an attack blinds as many as it may, and leaves groups that are all
worth less than the claim. For each of a few vectors of prices, groups score as in ``link_scores.py``. Each link is
inside a group or cut, so the groups together score at least

    4 (links - alpha_c) - sum of all prices.

Given are bounds of what groups of so many robots score. Take a group with the most seeing robots, a of them, and with b
blinded ones. What the others score at most, by their sizes alone, as none has more than a, leaves what it must score,
and that says which a and b are possible (``largest_groups.py``). As any ``size`` robots are worth the claim, a is less.
For each that is left, a tree over the robots shows that such a group has seeing robots worth the claim, or scores less.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

from ratt_opt.certificates.verifier.reading import array, fields, index, need, signed, walk
from ratt_opt.certificates.verifier.version1.group_costs import mask_of, robots_of
from ratt_opt.certificates.verifier.version1.largest_groups import largest_groups
from ratt_opt.certificates.verifier.version1.link_scores import LinkScores
from ratt_opt.certificates.verifier.version1.size_tree import check_size_tree
from ratt_opt.errors import UndecidedError

if TYPE_CHECKING:
    from collections.abc import Iterator

    from ratt_opt.certificates.verifier.statement import Statement
    from ratt_opt.certificates.verifier.version1.largest_groups import LargestGroup
    from ratt_opt.certificates.verifier.worth import Worth

__all__ = ["check_group_sizes"]

LARGEST = 2**31
"""Of prices, scores and diagonals, in size."""

MOST_ROBOTS = 200
"""A characteristic polynomial of so many rows takes less than a second; one of 1,000 minutes."""


@dataclass(frozen=True, slots=True)
class _Case:
    """Masks: robots that see in the group, that do not see in it, that are inside it, and outside it.

    ``known`` : the seeing ones, as ``Worth`` has them
    """

    known: Any
    seeing: int = 0
    others: int = 0
    inside: int = 0
    outside: int = 0


def check_group_sizes(about: Statement, part: Any, worth: Worth) -> int:
    """Check the proof; returns its leaves."""
    if about.n > MOST_ROBOTS:
        raise UndecidedError(f"not decided: sizes of groups are for at most {MOST_ROBOTS} robots")
    names = "kind prices most size sizes bounds trees"
    _, prices, most, given, sizes, bounds, trees = fields("lower proof", part, names)
    scores = [LinkScores(about, _integers("prices", own, about.n)) for own in array("prices", prices)]
    need(scores, "lower proof: there are no prices")
    for bound in array("most", most):
        vector, robots, below, diagonal = fields("most", bound, "vector robots below diagonal")
        one, count = scores[index("vector", vector, len(scores))], index("robots", robots, about.n + 1)
        one.lower(count, signed("below", below, LARGEST), _integers("diagonal", diagonal, about.n))
    size = index("size", given, about.n + 2)
    leaves = check_size_tree(about.n, size, sizes, worth)
    known: list[tuple[int, list[int]]] = []
    for bound in array("bounds", bounds):
        vector, diagonal = fields("bound", bound, "vector diagonal")
        known.append((index("vector", vector, len(scores)), _integers("diagonal", diagonal, about.n)))
    groups = largest_groups(scores, min(about.alpha_s, about.n - len(about.safe_robots)), size)
    for group, tree in zip(groups, array("trees", trees, len(groups)), strict=True):
        leaves += _Groups(about, group, scores, known).check(tree, worth)
    return leaves


def _integers(where: str, given: object, n: int) -> list[int]:
    return [signed(where, value, LARGEST) for value in array(where, given, n)]


class _Groups:
    """Groups with so many seeing and blinded robots."""

    def __init__(
        self, about: Statement, group: LargestGroup, scores: list[LinkScores], bounds: list[tuple[int, list[int]]]
    ) -> None:
        self.about, self.group, self.scores, self.bounds = about, group, scores, bounds
        self._robots = group.seeing + group.blinded
        self.everyone, self.safe = (1 << about.n) - 1, mask_of(about.safe_robots)

    def check(self, tree: object, worth: Worth) -> int:
        """Check that each of them is worth the claim or scores less than it must; returns the number of leaves.

        In preorder, 2i: robot i sees in the group; or does not. 2i + 1: robot i is in the group; or is not. -1: those
        that see are worth the claim. -2: no group of the case has these sizes. -3: some seeing robots are missing, and
        any so many of those undecided bring it to the claim. -4 - k: by bound k, the case's groups score less.
        """

        def expand(node: Any, case: _Case) -> Iterator[_Case]:
            may_see = self.everyone & ~(case.seeing | case.others | case.outside)
            if node == -1:
                worth.require(case.known)
            elif node == -2:
                need(self._is_impossible(case, may_see), "lower proof: a leaf is not impossible")
            elif node == -3:
                missing = self.group.seeing - case.seeing.bit_count()
                need(missing > 0, "lower proof: no robot is missing")
                worth.require(case.known, robots_of(may_see), missing)
            elif type(node) is int and node < 0:
                bound = self.bounds[index("lower tree bound", -4 - node, len(self.bounds))]
                need(self._score_less(case, *bound), "lower proof: a group of a leaf may score enough")
            else:
                i, asks_place = divmod(index("lower tree", node, 2 * self.about.n), 2)
                one, open_ = 1 << i, self.everyone & ~(case.inside | case.outside) if asks_place else may_see
                need(open_ & one, f"lower proof: robot {i} is decided twice")
                if asks_place:
                    yield replace(case, inside=case.inside | one)
                    yield replace(case, outside=case.outside | one)
                    return
                seen = {"seeing": case.seeing | one, "inside": case.inside | one}
                yield replace(case, known=worth.plus(case.known, i), **seen)
                yield replace(case, others=case.others | one)

        return walk("lower", tree, _Case(worth.nobody), expand)

    def _is_impossible(self, case: _Case, may_see: int) -> bool:
        """Whether no group of the case has the sizes."""
        group, blinded = self.group, case.inside & case.others
        too_many = case.seeing.bit_count() > group.seeing or blinded.bit_count() > group.blinded
        too_many |= case.inside.bit_count() > self._robots or bool(blinded & self.safe)
        too_few = case.seeing.bit_count() + may_see.bit_count() < group.seeing
        return too_many or too_few or (self.everyone & ~case.outside).bit_count() < self._robots

    def _score_less(self, case: _Case, vector: int, diagonal: list[int]) -> bool:
        """Whether the groups of the case are shown to score less than they must."""
        open_ = self.everyone & ~(case.inside | case.outside)
        missing = self._robots - case.inside.bit_count()
        return self.scores[vector].are_below(self.group.need[vector], diagonal, (case.inside, open_), missing)
