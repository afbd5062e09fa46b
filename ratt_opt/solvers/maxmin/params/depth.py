"""Parameters of the searches in depth, level by level: by covers, and by marginal gains."""

from __future__ import annotations

from dataclasses import dataclass

__all__ = ["CoverSearchParams", "DepthParams", "LevelParams", "MarginalParams", "SeparationParams"]


@dataclass(frozen=True, slots=True, kw_only=True)
class DepthParams:
    """Turns of the search in depth beside the concave one.

    ``unseen`` : least share of pairs of an element and a target without information for a search in depth
    ``slice``, ``growth`` : nodes of the concave search's second turn, and how many times as many each later one has
    ``first`` : nodes for each of the concave search's, if rows are there from the root, at first
    ``most`` : the same without rows, and after a turn that lowered the upper end
    ``in_vain`` : factor after each other turn beside rows: fast ends of either search against slow ones
    ``walk_kicks``, ``walk_share`` : kicks, and share of the time left, for better plans before rows begin at the root
    """

    unseen: float = 0.25
    slice: int = 20
    growth: float = 2.0
    first: float = 2.5
    most: float = 10.0
    in_vain: float = 0.25
    walk_kicks: int = 100
    walk_share: float = 0.1


@dataclass(frozen=True, slots=True, kw_only=True)
class LevelParams:
    """Levels that are tried one after the other.

    ``shares`` : levels, as shares of the open bracket above the best plan
    ``walk_kicks``, ``walk_share`` : kicks, and share of the time left, for a better plan if the lowest took too long
    ``runs``, ``growth`` : of the first search at each level, and how many times as many the next ones have
    """

    shares: tuple[float, ...] = (0.0, 0.25, 0.5, 0.75)
    walk_kicks: int = 50
    walk_share: float = 0.05
    runs: int = 20
    growth: int = 2


@dataclass(frozen=True, slots=True, kw_only=True)
class MarginalParams:
    """Search by marginal gains.

    ``run`` : nodes between two looks at the clock: some ten milliseconds with ten robots
    ``room``, ``recorded`` : nodes of a record at first and at most, 40 MB
    ``tried`` : attacks that are tried at a node if robots have not chosen yet: fewer nodes against their time
    ``sets`` : sets of its seers for which the gains of each target are kept
    ``plans`` : of undominated elements; of more, too few are dead ends early
    """

    run: int = 1_000
    room: int = 1 << 14
    recorded: int = 10_000_000
    tried: int = 200
    sets: int = 64
    plans: float = 1e12


@dataclass(frozen=True, slots=True, kw_only=True)
class CoverSearchParams:
    """Search by covers.

    ``run`` : nodes between two looks at the clock and at the linear program: ten milliseconds with ten robots
    ``rounds``, ``rounds_at_root`` : of covers on one relaxed plan: fewer nodes against linear programs
    ``shortfall`` : of all plans [robots], for a sum that is worth keeping
    ``covers`` : known at once; a node looks at all of them. ``rows`` : of the program; beyond it, half of them go
    ``lowest`` : conditions met by more than this count no further [robots]
    ``room``, ``recorded`` : nodes of a record at first and at most, 160 MB
    ``ways`` : partitions that are tried at a node, those that last led to a dead end first
    ``sums`` : that are looked at: those of most use lately; ``fading`` : weight of earlier use at each new one
    ``no_multiplier`` : multipliers of the linear program up to this count as none
    """

    run: int = 100
    rounds: int = 4
    rounds_at_root: int = 60
    shortfall: float = 2e-6
    covers: int = 20_000
    rows: int = 400
    lowest: float = 50.0
    room: int = 4_096
    recorded: int = 4_000_000
    ways: int = 10
    sums: int = 60
    fading: float = 0.9
    no_multiplier: float = 1e-9


@dataclass(frozen=True, slots=True, kw_only=True)
class SeparationParams:
    """Separation of covers at a relaxed plan: stronger rounds against their time.

    ``listed`` : partitions; each is priced in every round
    ``grown``, ``added`` : partitions of lowest price whose kept elements are completed in a round, and covers it adds
    ``violated`` : known covers that a round brings back
    ``room`` : covers of a pool at first; it doubles
    ``negligible`` : shares of elements and violations of covers up to this count as none
    ``noise`` : relative, on the order in which targets are lost, so that rounds on the same relaxed plan differ
    """

    listed: int = 500
    grown: int = 16
    added: int = 8
    violated: int = 8
    room: int = 256
    negligible: float = 1e-6
    noise: float = 0.2
