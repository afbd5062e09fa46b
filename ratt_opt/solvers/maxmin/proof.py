"""The proof of an upper bound on the optimum, as a search tree whose leaves are checked one by one.

A node stands for the plans whose elements remain allowed on its path and for which the declared
groups win. Children of an :class:`ElementBranch` partition one robot's remaining elements; those of a
:class:`WinnerBranch` say which group of one attack attains the team value, one child a group. At a leaf, a cut
on the only group of an attack, or on the group declared to win, bounds the team value under that attack and so the
worst case; the leaf's convex combination of such cuts bounds every plan that remains.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from ratt_opt._validation import FloatArray
    from ratt_opt.problem import Attack

__all__ = ["Cut", "ElementBranch", "Leaf", "Node", "UpperProof", "WinnerBranch"]


@dataclass(frozen=True, slots=True, kw_only=True)
class Cut:
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
    """``children`` : (elements that remain for ``robot``, node); the element sets partition what remained."""

    robot: int
    children: tuple[tuple[tuple[int, ...], Node], ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class WinnerBranch:
    """``children`` : (group that attains the team value under ``attack``, node); one child for each of its groups."""

    attack: int
    children: tuple[tuple[tuple[int, ...], Node], ...]


Node = Leaf | ElementBranch | WinnerBranch


@dataclass(frozen=True, slots=True, kw_only=True)
class UpperProof:
    """Attacks and cuts that the tree ``root`` refers to by index."""

    attacks: tuple[Attack, ...]
    cuts: tuple[Cut, ...]
    root: Node
