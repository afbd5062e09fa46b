"""The proof of an upper bound on the optimum: a search tree, in preorder, whose leaves are checked one by one.

A node stands for the plans whose elements remain allowed on its path and for which the declared
groups win. Children of an :class:`ElementBranch` partition one robot's remaining elements; those of a
:class:`WinnerBranch` say which group of one attack attains the team value, one child a group. At a leaf, a cut
on the only group of an attack, or on the group declared to win, bounds the team value under that attack and so the
worst case; the leaf's convex combination of such cuts bounds every plan that remains.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from ratt_opt._values import ByValue

if TYPE_CHECKING:
    from ratt_opt._validation import FloatArray
    from ratt_opt.problem import Attack

__all__ = ["Cut", "ElementBranch", "Leaf", "Node", "UpperProof", "WinnerBranch"]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class Cut(ByValue):
    """A tangent bound on one group of one attack.

    ``point`` : (M, d, d) posterior information where it touches; ``target`` : for max-eigenvalue, which target's.
    """

    attack: int
    group: tuple[int, ...]
    point: FloatArray
    target: int | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class Leaf:
    """Cuts by index, and their non-negative weights (normalised by their sum)."""

    cuts: tuple[int, ...]
    weights: tuple[float, ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class ElementBranch:
    """``parts`` : the elements that remain for ``robot`` in each child, ascending; a partition of what remained."""

    robot: int
    parts: tuple[tuple[int, ...], ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class WinnerBranch:
    """``parts`` : the group that attains the team value under ``attack`` in each child, ascending; all its groups."""

    attack: int
    parts: tuple[tuple[int, ...], ...]


Node = Leaf | ElementBranch | WinnerBranch


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class UpperProof(ByValue):
    """Attacks and cuts that the ``tree`` refers to by index; its nodes are in preorder."""

    attacks: tuple[Attack, ...]
    cuts: tuple[Cut, ...]
    tree: tuple[Node, ...]

    def __repr__(self) -> str:
        return f"UpperProof({len(self.attacks)} attacks, {len(self.cuts)} cuts, {len(self.tree)} nodes)"
