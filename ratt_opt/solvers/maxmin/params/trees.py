"""Parameters of the concave relaxations: nodes, cuts, divisions, and trees one after the other."""

from __future__ import annotations

from dataclasses import dataclass

__all__ = ["CutRoundParams", "DivisionParams", "GroupProofParams", "RestartParams", "SmallGroupParams"]


@dataclass(frozen=True, slots=True, kw_only=True)
class CutRoundParams:
    """Rounds of cuts at a node: more rounds, and larger programs, against more nodes.

    ``stall`` : share of the remaining gap; a round that closes less is a stall
    ``stalls``, ``stalls_at_root`` : that end the rounds; all nodes inherit the root's cuts
    ``cuts`` : groups cut in one round
    ``targets`` : of one group that get a tangent each (max-eigenvalue)
    ``patience`` : solves without a multiplier after which a cut leaves the program; it stays stored
    ``deep`` : share of the depth of the deepest known cut that a stored one needs to be brought back
    """

    stall: float = 0.03
    stalls: int = 2
    stalls_at_root: int = 12
    cuts: int = 8
    targets: int = 4
    patience: int = 8
    deep: float = 0.5


@dataclass(frozen=True, slots=True, kw_only=True)
class DivisionParams:
    """Choice of what a node is divided on.

    ``flat`` : share of the gap; mixtures that cost less in every cut do not explain it, known outcomes may
    ``short_outcomes`` : looked at then: those that a rounded plan falls short in most
    ``compared`` : outcomes of which the one that the fewest groups may win is divided on: fewer nodes against proofs
    ``widened`` : nodes of a closed proof that is tried with elements that were left out
    """

    flat: float = 0.01
    short_outcomes: int = 16
    compared: int = 8
    widened: int = 128


@dataclass(frozen=True, slots=True, kw_only=True)
class GroupProofParams:
    """Proof that a group never exceeds a level.

    ``steps`` : of Frank and Wolfe towards the best mixture of a node; ``cuts`` : after which the attempt is given up
    """

    steps: int = 6
    cuts: int = 300


@dataclass(frozen=True, slots=True, kw_only=True)
class SmallGroupParams:
    """Groups whose values under all elements are listed, against linear programs of the same milliseconds.

    ``whole``, ``part`` : criteria of single targets that list a group once and for all, and its rest at a node
    ``not_planar`` : relative cost of a criterion that has no closed form
    ``largest`` : robots; when larger groups could be listed, linear programs have decided them
    """

    whole: int = 600_000
    part: int = 60_000
    not_planar: int = 10
    largest: int = 8


@dataclass(frozen=True, slots=True, kw_only=True)
class RestartParams:
    """Nodes of trees before each is given up for one that begins with what is known by then.

    ``first`` : of the first tree; most searches end within
    ``nearly``, ``more`` : relative width at which that tree is nearly done, and then goes on to this many nodes
    ``later``, ``growth`` : of the second tree, and how many times as many each later one has
    """

    first: int = 100
    nearly: float = 5e-3
    more: int = 500
    later: int = 100
    growth: float = 1.5
