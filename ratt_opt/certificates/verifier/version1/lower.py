"""The plan keeps at least the claim's lower end under every attack: a cover of all attacks by cases."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from ratt_opt.certificates.verifier.reading import fields, index, need, walk
from ratt_opt.certificates.verifier.version1.all_groups import check_all_groups
from ratt_opt.certificates.verifier.version1.forced_size import is_forced, is_forced_by_trees
from ratt_opt.certificates.verifier.version1.group_covers import check_group_covers
from ratt_opt.certificates.verifier.version1.group_prices import check_group_prices
from ratt_opt.certificates.verifier.version1.group_sizes import check_group_sizes
from ratt_opt.certificates.verifier.version1.size_tree import check_size_tree
from ratt_opt.certificates.verifier.worth import Worth

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from flint import fmpq

    from ratt_opt.certificates.verifier.statement import Statement

__all__ = ["LowerCheck"]

BY_GROUPS: dict[str, Callable[[Statement, Any, Worth], int]] = {
    "group_prices": check_group_prices,
    "group_covers": check_group_covers,
    "all_groups": check_all_groups,
    "group_sizes": check_group_sizes,
}
"""Proofs by what the groups of an attack cost or score."""


class LowerCheck:
    """Decides the lower proofs of one problem's plan."""

    def __init__(self, about: Statement) -> None:
        self.about = about

    def check(self, part: Any, lower: fmpq) -> int:
        """Check that the plan's value is at least ``lower`` under every attack.

        Returns the number of leaves; 0 when the part says that it is no proof.
        """
        kind = part.get("kind") if isinstance(part, dict) else None
        if kind == "forced_size":
            return self._check_forced_size(part, Worth(self.about, lower))
        if kind == "attack_tree":
            return self._check_attack_tree(fields("lower proof", part, "kind tree")[1], Worth(self.about, lower))
        if isinstance(kind, str) and kind in BY_GROUPS:
            return BY_GROUPS[kind](self.about, part, Worth(self.about, lower))
        fields("lower proof", part, "kind")
        kinds = f"attack_tree, forced_size, {', '.join(BY_GROUPS)} or enumerated"
        need(kind == "enumerated", f"lower proof: the kind must be {kinds}")
        return 0

    def _check_forced_size(self, part: dict[str, Any], worth: Worth) -> int:
        """Every attack leaves a group with ``size`` seeing robots, and every such set is worth it."""
        about, has_trees = self.about, "trees" in part
        _, given, tree, *trees = fields("lower proof", part, "kind size tree trees" if has_trees else "kind size tree")
        size = index("forced size", given, about.n + 1)
        if has_trees:
            forced = is_forced_by_trees(about, size, trees[0])
        else:
            complete = 2 * len(about.links) == about.n * (about.n - 1)
            forced = complete and is_forced(about.n, about.alpha_s, about.alpha_c, size)
        need(forced, f"lower proof: not every attack is shown to leave a group of {size}")
        return check_size_tree(about.n, size, tree, worth)

    def _check_attack_tree(self, tree: object, worth: Worth) -> int:
        """Cases over attacks; ``parts`` are pairwise in different groups, each within one.

        In preorder, 2i: robot i is blinded; or not. 2i + 1: robot i is in the group of the first part, of the
        second, ..., or of none (a new part). -1: the case exceeds a budget or hits something protected.
        -2 - p: the robots of part p that are known to see are worth it.
        """
        known: set[int] = set()

        def expand(node: Any, case: Any) -> Iterator[Any]:
            blind, see, parts = case
            if node == -1:
                need(self._infeasible(blind, parts), "lower proof: a case is an attack within the budgets")
            elif type(node) is int and node < 0:
                group = parts[index("lower tree part", -2 - node, len(parts))] & see
                mask = sum(1 << i for i in group)
                if mask not in known:
                    worth.require(worth.of(sorted(group)))
                    known.add(mask)
            else:
                i, asks_group = divmod(index("lower tree", node, 2 * self.about.n), 2)
                decided = any(i in part for part in parts) if asks_group else i in blind | see
                need(not decided, f"lower proof: robot {i} is decided twice")
                if asks_group:
                    yield from ((blind, see, (*parts[:p], x | {i}, *parts[p + 1 :])) for p, x in enumerate(parts))
                yield (blind, see, (*parts, frozenset({i}))) if asks_group else (blind | {i}, see, parts)
                yield from () if asks_group else [(blind, see | {i}, parts)]

        return walk("lower", tree, (frozenset(), frozenset(), ()), expand)

    def _infeasible(self, blind: frozenset[int], parts: tuple[frozenset[int], ...]) -> bool:
        """Whether blinding ``blind`` and separating ``parts`` is beyond the adversary.

        All links between parts are cut; a robot in no part shares a group with at most one part, so its links
        to all parts but the best linked one are lost at least.
        """
        home = {i: p for p, part in enumerate(parts) for i in part}
        between = {(i, j) for i, j in self.about.links if i in home and j in home and home[i] != home[j]}
        counts = [[len(self.about.near[i] & part) for part in parts] for i in range(self.about.n) if i not in home]
        lost = len(between) + sum(sum(c) - max(c, default=0) for c in counts)
        protected = between & self.about.safe_links or blind & self.about.safe_robots
        return lost > self.about.alpha_c or len(blind) > self.about.alpha_s or bool(protected)
