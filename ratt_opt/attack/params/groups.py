"""Parameters of attacks on any graph: annealing, thresholds, columns and their dual prices."""

from __future__ import annotations

from dataclasses import dataclass

__all__ = [
    "AllSetsParams",
    "AnnealingParams",
    "AttackBoundParams",
    "DualPriceParams",
    "ListedParams",
    "MasterParams",
    "PricingParams",
    "ThresholdParams",
]


@dataclass(frozen=True, slots=True, kw_only=True)
class AllSetsParams:
    """Thresholds with the values of all sets of robots.

    ``valued`` : most robots whose sets are all valued if there is no compiled code; 2 to that power are values
    ``enumerated``, ``most_work`` : most robots whose sets the compiled code enumerates (2 to that power are bytes), and
    most multiplications for their values; more close larger teams by this, later
    ``starts`` : annealed attacks before the first threshold. ``moves`` : of a start, for each pair of robots
    ``few`` : robots whose sets are all valued first
    ``block`` : sets valued at once, which is lost if the budget ends
    ``fall`` : relative to the largest value, up to which a larger set of less value is rounding
    ``slack`` : relative to the largest value, taken off an earlier bound: more than all falls add up to
    ``first_steps`` : of the first search of covers; ``more`` : factor if it stays undecided
    ``levels`` : values told apart once the bracket counts as closed, one threshold each
    ``narrow`` : relative width of the bracket below which no lower threshold is tested
    ``most_columns`` : within the gap, for covers to be searched
    """

    valued: int = 20
    enumerated: int = 24
    most_work: float = 2.0**32
    starts: int = 4
    moves: int = 400
    few: int = 12
    block: int = 2**10
    fall: float = 1e-12
    slack: float = 1e-9
    first_steps: int = 100_000_000
    more: int = 4
    levels: int = 10
    narrow: float = 1e-3
    most_columns: int = 2_000_000


@dataclass(frozen=True, slots=True, kw_only=True)
class AnnealingParams:
    """Annealed attacks: more moves find worse attacks and take longer.

    ``moves`` : per robot of the first starts; they double after each ``longer`` starts, up to ``longest`` times as many
    ``part`` : moves between two looks at the clock, times the work of a value in the plane
    ``hot``, ``warm``, ``cold`` : temperatures relative to the team's value: first, first from a good attack, last
    ``again`` : after this number of starts one begins with the best attack so far
    """

    moves: int = 10_000
    longer: int = 16
    longest: int = 4
    part: int = 500_000
    hot: float = 0.02
    warm: float = 0.004
    cold: float = 0.00005
    again: int = 4


@dataclass(frozen=True, slots=True, kw_only=True)
class AttackBoundParams:
    """Bounds by tree inequalities; shares are of the remaining budget.

    ``share`` : on sparse graphs. ``short_share``, ``short`` : the same for a short search, up to a number of seconds
    ``largest_weight`` : integer that stands for the largest weight of a robot
    ``fewer`` : for the weakest sets of fewer robots than the forced size, one more each time: sure sooner, and lower
    ``in_depth`` : partial sets of a search for the weakest set before branch and bound, some five seconds: with the
        weakest set known by exchanges, each robot more takes twice as many
    """

    share: float = 0.025
    short_share: float = 0.05
    short: float = 0.5
    largest_weight: int = 2**20
    fewer: float = 0.7
    in_depth: int = 1_000_000


@dataclass(frozen=True, slots=True, kw_only=True)
class ThresholdParams:
    """Thresholds between the two ends, and annealed attacks between thresholds.

    ``starts`` : annealed attacks if a threshold is left open. ``nodes_of_start`` : nodes of a proof for one more
    ``patience`` : multiple of the starts that the best attack took, until which starts go on
    ``annealing_share`` : of the remaining seconds for starts; ``short_share``, ``short`` : at least, up to some seconds
    ``effort`` : nodes of a threshold before it is left open; ``harder`` : factor if lower ones are exhausted
    ``near`` : relative width of the bracket from which the attack in hand is tested
    ``bisected`` : relative width below which an open threshold is not bisected
    ``long`` : nodes of a refutation after which the next step is ``quarter`` of the bracket instead of a half
    ``for_one``, ``as_last``, ``least`` : limit of one threshold in a wide bracket: a share of the seconds left, but
    at least a multiple of what the last took, and at least a number of seconds
    ``reach`` : share of the bracket of a step if the last refutation took the seconds that are left
    ``resolution`` : share of the bracket below an open threshold that is not worth a bisection
    """

    starts: int = 4
    nodes_of_start: int = 50_000
    patience: int = 3
    annealing_share: float = 0.1
    short_share: float = 0.3
    short: float = 3.0
    effort: int = 500_000
    harder: int = 4
    near: float = 2e-2
    bisected: float = 2e-3
    long: int = 50_000
    quarter: float = 0.25
    for_one: float = 0.35
    as_last: float = 2.0
    least: float = 10.0
    reach: float = 0.25
    resolution: float = 0.05


@dataclass(frozen=True, slots=True, kw_only=True)
class PricingParams:
    """Search for groups of negative reduced cost.

    ``effort`` : robots valued at most to decide what a group needs; ``work`` : multiplications for it, at most
    """

    effort: int = 200_000
    work: int = 50_000_000


@dataclass(frozen=True, slots=True, kw_only=True)
class DualPriceParams:
    """Dual prices of a threshold; prices are in links.

    ``margin`` : links that scaled prices claim beyond the budget: above rounding, below one link
    ``tolerance`` : reduced costs below minus this are negative; the sum over a team stays below ``margin``
    ``lowered`` : what all prices fall by if no group has a reduced cost below minus this
    ``first_attempt`` : nodes of the first search for a column; ``longer`` : factor from search to search
    ``rounded`` : units of integer duals by which rounding leaves a group's cost below zero, per robot
    ``moves`` : of annealing around each robot; ``hot``, ``cold`` : its temperatures
    ``rounds`` : of annealing at the prices that claim most; ``rounds_share`` : of the remaining seconds
    ``room`` : groups listed for covers. ``new_groups`` : added to the program at a time
    ``listing`` : nodes that one node of a listing counts for
    """

    margin: float = 5e-3
    tolerance: float = 1e-6
    lowered: float = 3e-3
    first_attempt: int = 10_000
    longer: int = 3
    rounded: int = 2
    moves: int = 1_500
    hot: float = 4.0
    cold: float = 0.1
    rounds: int = 50
    rounds_share: float = 0.05
    room: int = 100_000
    new_groups: int = 100
    listing: int = 2


@dataclass(frozen=True, slots=True, kw_only=True)
class MasterParams:
    """Linear program over the columns found so far.

    ``used`` : part of a column in a solution that is more than the program's tolerance
    ``most_rows`` : before rows with slack are dropped; more slow the program down
    """

    used: float = 1e-7
    most_rows: int = 6_000


@dataclass(frozen=True, slots=True, kw_only=True)
class ListedParams:
    """Columns of all groups that an attack may leave.

    ``step`` : relative distance of the first threshold from the attack in hand, once a budget has ended the search
    ``most_within`` : columns within the gap, for covers to be searched
    ``most`` : groups listed at most, 20 bytes each; ``brief`` : in a brief attack. ``share`` : of the remaining seconds
    ``strongest`` : of the seconds of a threshold, for the limits of the strongest robots; a team whose limits take
        longer has too many sets that are nearly as weak as the attack in hand
    ``starts`` : annealed attacks before
    """

    step: float = 0.02
    most_within: int = 1_000_000
    most: int = 3_000_000
    brief: int = 20_000
    share: float = 0.1
    strongest: float = 0.25
    starts: int = 4
