"""Parameters of the lower end: known outcomes, attacks on plans, the best plan, kicks and ties."""

from __future__ import annotations

from dataclasses import dataclass

__all__ = [
    "AdversaryParams",
    "FewPlansParams",
    "IncumbentParams",
    "KickParams",
    "OutcomeListParams",
    "TieParams",
    "WatcherParams",
]


@dataclass(frozen=True, slots=True, kw_only=True)
class OutcomeListParams:
    """Limits of a list of all non-dominated outcomes before a search.

    ``robots``, ``outcomes`` : at most; of more, each node would value most in vain
    """

    robots: int = 12
    outcomes: int = 3_000


@dataclass(frozen=True, slots=True, kw_only=True)
class AdversaryParams:
    """Quick attacks on plans, whose outcomes a search learns.

    ``small`` : robots up to which quick attacks are simple rules; larger teams are attacked by exchanges, which are
        fast and hardly ever wrong
    ``quick`` : share of the remaining time for one quick attack, and for exchanges next to known outcomes before it:
        outcomes that hurt more against time for other plans
    ``near`` : known outcomes, those that hurt a plan most, from which a worse one is sought first
    ``brief_moves``, ``moves`` : of annealing, per robot: of each relaxed plan, and of a plan that these did not hurt
    ``remembered`` : plans whose exact attacks can go on where they ended: some megabytes each
    """

    small: int = 12
    quick: float = 0.05
    near: int = 4
    brief_moves: int = 300
    moves: int = 2_000
    remembered: int = 4


@dataclass(frozen=True, slots=True, kw_only=True)
class IncumbentParams:
    """Shares of the remaining time for the best plan's value; more proves more of it, and searches fewer others.

    ``rounds`` : of climbing and attacking, after which a plan is left as it is
    ``first``, ``first_nodes`` : for each attack that bounds the first plan, and then the best one, from below
    ``first_on_network`` : instead, on networks; there, attacks go on later
    ``first_seconds``, ``short`` : fewest seconds of these attacks, if they are at most this share of the remaining ones
    ``improved`` : for the local search from one plan, and for attacks on one plan that is offered
    ``rival`` : once, for a second attack on a plan that has a higher proved value than the best one
    ``race`` : on networks for the first plan, and for the best one; that of higher proved value gets the rest
    ``left_early``, ``early`` : share of what is open of the best plan that an attack on a network has to take off for
        another plan to be looked for at once, and of the time in which that is done
    ``searched`` : searched before an unproved plan is attacked exactly
    ``block`` : numbers of plans valued at once while climbing: some tens of megabytes
    """

    rounds: int = 50
    first: float = 0.1
    first_nodes: int = 500_000
    first_on_network: float = 0.02
    first_seconds: float = 1.0
    short: float = 0.95
    improved: float = 0.1
    rival: float = 0.5
    race: float = 0.2
    left_early: float = 0.05
    early: float = 0.5
    searched: float = 0.25
    block: int = 4_000_000


@dataclass(frozen=True, slots=True, kw_only=True)
class TieParams:
    """Search for a plan of the same worst case that is worth more without attack.

    ``share`` : of the remaining time; ``nodes`` : of each attack; ``rounds`` : plans that are attacked
    """

    share: float = 0.1
    nodes: int = 100_000
    rounds: int = 10


@dataclass(frozen=True, slots=True, kw_only=True)
class KickParams:
    """Kicks of the best plan, from which the search climbs again.

    ``fewest`` : robots that take another element; up to a third of the team do
    ``softness`` : share of the best value: what an attack leaves more by it counts e times less in the mean that
        judges; without it half of the teams of ten robots end a tenth below the best plan
    ``worse``, ``back`` : share of the best value that a step may lose, and kicks in vain until the best plan is taken
    """

    fewest: int = 2
    softness: float = 0.01
    worse: float = 0.01
    back: int = 50


@dataclass(frozen=True, slots=True, kw_only=True)
class WatcherParams:
    """First plan by the numbers of watchers that targets have.

    ``unseen`` : least share of pairs of an element and a target without information
    ``watching`` : share of what all elements tell about a target that an element alone has to tell, to watch it
    ``precise`` : least share that watches a target of those that see it; with fewer, as under the log-det of cameras,
    what watchers tell together counts: 20 cameras on a disk (seed 0) leave 8.6 % open with such a plan, 7.5 without
    ``kicks``, ``share`` : of the walk, and share of the time left: better plans against time for attacks
    """

    unseen: float = 0.25
    watching: float = 0.5
    precise: float = 0.5
    kicks: int = 300
    share: float = 0.05


@dataclass(frozen=True, slots=True, kw_only=True)
class FewPlansParams:
    """Limits of an enumeration of all plans, without attacks.

    ``plans`` : at most; ``share`` : of the remaining time
    """

    plans: int = 300_000
    share: float = 0.5
