"""Parameters of searches for best plans of functions known by their values, and of sums of parts."""

from __future__ import annotations

from dataclasses import dataclass

__all__ = [
    "FirstPlanParams",
    "PartRowParams",
    "RegionParams",
    "RowTreeParams",
    "ValueCheckParams",
    "ValueTurnParams",
    "ValueWalkParams",
]


@dataclass(frozen=True, slots=True, kw_only=True)
class ValueCheckParams:
    """Feasible sets up to which a function is checked to be as it says, in milliseconds; of more it is relied upon.

    ``sets`` : of any function; ``table`` : of one given as a table
    ``share`` : of the seconds and values left, at most
    """

    sets: int = 2**12
    table: int = 2**18
    share: float = 0.2


@dataclass(frozen=True, slots=True, kw_only=True)
class FirstPlanParams:
    """RATT's, the greedy and the myopic plan, attacks on them, and exchanges from them: no search returns less.

    ``beyond`` : seconds that they may take beyond a limit that ends before they do: a plan against an overrun
    ``singles``, ``plan``, ``attack``, ``climb`` : shares of the seconds and values left, for individual values, for
        the rest of each plan, for each attack, and for exchanges from one plan with attacks on what they reach
    ``most_plan`` : share of the values left that a plan has at most, if it needs more: attacks need the rest
    ``table`` : share of the values left for the first attack, if values are counted: a table takes a known number
    ``longer``, ``longer_share`` : seconds of a second attack on the plan that seems best, if they are at most this
        share of those left: with a fifth of one second, three quarters of what a second proves of RATT's plan for 20
        robots were left unproved
    ``rounds`` : of exchanges and an attack on what they reach
    ``exchanges`` : share of the seconds left, but ``beyond`` at least, for exchanges from these plans each of which is
        attacked before it counts: a floor for all searches against their time
    ``kept`` : values, some hundred megabytes at most; others are computed again
    """

    beyond: float = 0.4
    singles: float = 0.7
    plan: float = 0.5
    attack: float = 0.2
    climb: float = 0.5
    most_plan: float = 0.95
    table: float = 0.8
    longer: float = 1.0
    longer_share: float = 0.8
    rounds: int = 50
    exchanges: float = 0.1
    kept: int = 500_000


@dataclass(frozen=True, slots=True, kw_only=True)
class ValueWalkParams:
    """Walks from the best plan: more kicks find better plans, and leave less for upper ends.

    ``share`` : of the seconds and values left, for a walk
    ``patience`` : kicks in vain after which the first walk ends; later ones have more
    ``most_robots`` : robots that a kick moves, from 1 to this
    """

    share: float = 0.5
    patience: int = 30
    most_robots: int = 3


@dataclass(frozen=True, slots=True, kw_only=True)
class ValueTurnParams:
    """Turns of enumeration, rows, walks and branch and bound.

    ``enumerated`` : share of the seconds and values left for the enumeration of a small problem
    ``outcomes`` : that are gone through for it: some seconds if plans are few
    ``first_rows`` : share of the seconds and values left for upper ends by rows, before other searches
    ``rows`` : the same before a walk: upper ends against better plans
    ``nodes`` : of the first turn of branch and bound; ``growth`` : factor of the nodes and kicks of each later one
    ``most_open`` : nodes kept by their bounds; beyond, the last ones are divided first, which keeps few more
    """

    enumerated: float = 0.5
    outcomes: int = 200_000
    first_rows: float = 0.1
    rows: float = 0.5
    nodes: int = 200
    growth: int = 2
    most_open: int = 50_000


@dataclass(frozen=True, slots=True, kw_only=True)
class PartRowParams:
    """Effort of one round of rows; more of each gives fewer rounds for more time.

    ``rows`` : rows added; ``fresh`` : outcomes whose parts get new bounds
    ``tolerance`` : relative violation of a row that is added
    ``deep`` : share of what is open by which rows of bounds known have to cut, so that none are looked for
    ``patience`` : solves without a multiplier after which a row leaves the program
    """

    rows: int = 8
    fresh: int = 2
    tolerance: float = 1e-9
    deep: float = 0.1
    patience: int = 8


@dataclass(frozen=True, slots=True, kw_only=True)
class RegionParams:
    """Choice of the regions by which plans of robots that may be exchanged are divided.

    ``single`` : share of a robot from which a column counts as a region of its own: rows against their time
    ``beyond`` : worth of a robot too many in a region, as a share of what is open: plans that have to move
    ``least`` : promise of a region, as a share of what is open; below it a node is divided by one column
    ``block`` : numbers computed at once while regions are compared: some megabytes each
    """

    single: float = 0.5
    beyond: float = 0.3
    least: float = 1e-4
    block: int = 1_000_000


@dataclass(frozen=True, slots=True, kw_only=True)
class RowTreeParams:
    """Effort of one node of rows; more of each gives fewer nodes for more time.

    ``stall`` : share of what is open at a node that a round has to close
    ``at_root``, ``elsewhere`` : rounds that close less after which the node is divided
    """

    stall: float = 0.03
    at_root: int = 12
    elsewhere: int = 2
