"""Parameters of the schedules: when stages apply, and their shares of the remaining budget."""

from __future__ import annotations

from dataclasses import dataclass

__all__ = [
    "BranchingParams",
    "CriterionParams",
    "ProtectionParams",
    "StageParams",
    "ValueAnnealingParams",
]


@dataclass(frozen=True, slots=True, kw_only=True)
class StageParams:
    """Shares of the remaining budget, and most nodes, of the stages of one attack.

    ``every_attack`` : for all attacks; ``attacks`` : tried one by one at most if all sets of robots can be looked at,
    ``attacks_beyond`` : otherwise. ``spatial`` : size vectors if targets are not in the plane
    ``greedy`` : greedy steps. ``listed_soon``, ``listed``, ``listed_nodes`` : listed columns before and after annealing
    ``first_bound``, ``first_bound_nodes`` : forced size on dense graphs, at first; ``bound``, ``bound_nodes`` : later
    ``sizes`` : groups of possible sizes. ``annealed_values`` : annealing by values alone
    ``blinded_sets`` : of robots; of more, those of submodular functions are bounded instead of valued one by one
    ``renewed`` : multiple of the earlier attack's seconds from which a resumed one runs its first stages again
    """

    every_attack: float = 0.4
    attacks: int = 20_000
    attacks_beyond: int = 200_000
    spatial: float = 0.6
    greedy: float = 0.05
    listed_soon: float = 0.4
    listed: float = 0.5
    listed_nodes: int = 20_000_000
    first_bound: float = 0.05
    first_bound_nodes: int = 20_000
    bound: float = 0.3
    bound_nodes: int = 1_000_000
    sizes: float = 0.7
    annealed_values: float = 0.5
    blinded_sets: int = 20_000
    renewed: float = 4.0


@dataclass(frozen=True, slots=True, kw_only=True)
class CriterionParams:
    """Conditions of the stages of an attack on a criterion.

    ``dense`` : share of all links from which sizes say more than dual prices
    ``small`` : robots for which all sets are looked at before anything else
    ``starts`` : annealed attacks before the first threshold, for at most ``starts_for`` robots; the square beyond
    ``inner_starts`` : inside another search
    ``inner_nodes`` : of dual prices, and of smallest largest groups, inside another search without limits
    """

    dense: float = 0.5
    small: int = 12
    starts: int = 18
    starts_for: int = 24
    inner_starts: int = 3
    inner_nodes: int = 500_000


@dataclass(frozen=True, slots=True, kw_only=True)
class ValueAnnealingParams:
    """Annealing of set functions that are known by their values.

    ``moves`` : per robot of the first starts, twice as many after two in vain. ``in_vain`` : starts until it is enough
    ``hot``, ``warm``, ``cold`` : temperatures relative to the team's value: first, first from the attack in hand, last
    ``alone``, ``blinds``, ``together`` : probability that a move opens a group, exchanges blinded robots, takes
    neighbours along; ``half`` : of each neighbour then
    ``price`` : of a link beyond the budget, relative to the team's value
    ``remembered`` : values of groups kept from start to start
    """

    moves: int = 200
    in_vain: int = 8
    hot: float = 0.05
    warm: float = 0.01
    cold: float = 5e-4
    alone: float = 0.15
    blinds: float = 0.5
    together: float = 0.2
    half: float = 0.5
    price: float = 0.02
    remembered: int = 200_000


@dataclass(frozen=True, slots=True, kw_only=True)
class BranchingParams:
    """Branch and bound over attacks.

    ``most_open`` : nodes kept by their bounds, some hundred megabytes; beyond, the search goes in depth
    ``at_once`` : sets of blinded robots whose groups are valued in one batch
    """

    most_open: int = 200_000
    at_once: int = 1_000


@dataclass(frozen=True, slots=True, kw_only=True)
class ProtectionParams:
    """Questions that ask many exact attacks: surveys, critical robots, the best links; shares of the time left.

    ``survey`` : for the exact attack beside the heuristics, which need little
    ``base`` : for the plan's own worst attack, which decides the gains to search for. ``bisection`` : for each attack
    ``links`` : for each exact attack on a choice of links; one needed again while open gets all of it
    ``ranked`` : attacks, from the worst, by which candidates are ranked: more cost time at every node
    ``at_once`` : pairs of groups that are valued between two looks at the clock
    """

    survey: float = 0.9
    base: float = 0.3
    bisection: float = 0.1
    links: float = 0.2
    ranked: int = 40
    at_once: int = 64
