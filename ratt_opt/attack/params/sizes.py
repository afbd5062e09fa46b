"""Parameters of attacks on complete and dense graphs, by the sizes of groups."""

from __future__ import annotations

from dataclasses import dataclass

__all__ = [
    "CoverParams",
    "DisjointParams",
    "FamilyExchangeParams",
    "FamilyParams",
    "LargestGroupParams",
    "PossibleSizeParams",
    "SizeVectorParams",
]


@dataclass(frozen=True, slots=True, kw_only=True)
class SizeVectorParams:
    """Stages of an attack by size vectors; shares are of the remaining time.

    ``most_vectors`` : vectors of sizes that are searched, at most 5,000; if there are more, some make attacks, and the
    bound is that of the forced size
    ``forced_share`` : for the weakest set of the forced size. ``first_share`` : to test the attack in hand
    ``annealed_share`` : for annealed attacks. ``prices_share`` : for dual prices of robots and links
    ``first_effort`` : nodes to test the attack in hand
    ``effort``, ``last_effort`` : nodes of a threshold, at first and at most
    ``of_each_size``, ``some_vectors`` : vectors per size of the largest group, and in all, if not all can be searched
    ``starts`` : annealed attacks if several groups are about alike
    ``alike`` : value of the second best group, relative to the best, from which they are
    ``small`` : robots of the team for each of a group from which groups are small; then prices come first if nobody is
    blinded
    """

    most_vectors: int = 5_000
    forced_share: float = 0.5
    first_share: float = 0.2
    annealed_share: float = 0.3
    prices_share: float = 0.5
    first_effort: int = 200_000
    effort: int = 100_000
    last_effort: int = 10**8
    of_each_size: int = 4
    some_vectors: int = 200
    starts: int = 6
    alike: float = 0.8
    small: int = 8


@dataclass(frozen=True, slots=True, kw_only=True)
class FamilyExchangeParams:
    """Exchanges of robots between the groups of a family: more find weaker families and take longer.

    ``share`` : of the time, before the bounds; ``settled_share`` : of that, before families are perturbed
    ``stride`` : between the first vectors taken, for large teams that have time for some only
    ``shaken`` : best families that are perturbed. ``shakes`` : perturbations of each; ``strength`` : exchanges of one
    ``large`` : exchanges of the largest group times targets from which it starts at the end of a linear descent
    ``weak_sets`` : starts of a largest group that is clearly the best
    ``clearly`` : size of the second group, relative to the largest, up to which it is
    ``both`` : weight of the two groups' sum beside the largest value
    ``seed`` : of the perturbations
    """

    share: float = 0.2
    settled_share: float = 0.7
    stride: int = 20
    shaken: int = 6
    shakes: int = 40
    strength: int = 3
    large: int = 20_000_000
    weak_sets: int = 3
    clearly: float = 0.5
    both: float = 1e-3
    seed: int = 0


@dataclass(frozen=True, slots=True, kw_only=True)
class LargestGroupParams:
    """Largest groups that are looked at one by one, before all families are searched at once.

    ``few`` : at most. ``nodes_of_set`` : divisor of a threshold's nodes for that number, if families cannot be searched
    """

    few: int = 300
    nodes_of_set: int = 300


@dataclass(frozen=True, slots=True, kw_only=True)
class DisjointParams:
    """Lists of sets, and disjoint sets from them.

    ``nodes_of_look`` : partial sets listed between two looks at the clock; ``looks`` : before a list is given up
    ``most_sets`` : in a list, 16 bytes each
    ``work`` : sets tried between two looks at the clock; ``work_nodes`` : nodes that these count as
    ``memory`` : states remembered, 16 bytes each
    """

    nodes_of_look: int = 10_000
    looks: int = 200
    most_sets: int = 2_000_000
    work: int = 4_000_000
    work_nodes: int = 500
    memory: int = 1 << 20


@dataclass(frozen=True, slots=True, kw_only=True)
class FamilyParams:
    """Search of all families of one size vector.

    ``few_sets`` : largest number of sets of a size that are listed without a bound first
    """

    few_sets: int = 1_000_000


@dataclass(frozen=True, slots=True, kw_only=True)
class CoverParams:
    """Linear program over sets that bounds all families.

    ``rounds`` : at most. ``added`` : sets of each size that enter in one; ``seeds`` : at first
    ``enough`` : share of the room that is not worth another round
    ``sets_of_node`` : sets that a round goes through in the time of a node
    ``box`` : largest potential, relative to the threshold, if the rest is empty
    """

    rounds: int = 60
    added: int = 40
    seeds: int = 12
    enough: float = 1e-3
    sets_of_node: int = 100
    box: float = 4.0


@dataclass(frozen=True, slots=True, kw_only=True)
class PossibleSizeParams:
    """Bounds by sizes that groups of a dense graph may have.

    ``most_vectors`` : to search; with more the bound is left out. ``largest`` : robots of a team, at most
    ``most_sets`` : largest groups to ask about, at most
    ``share`` : of the remaining budget for the bound by vectors, the rest is for sets; ``nodes`` : of each, at most
    """

    most_vectors: int = 1_000
    largest: int = 100
    most_sets: int = 20_000
    share: float = 0.3
    nodes: int = 3_000_000
