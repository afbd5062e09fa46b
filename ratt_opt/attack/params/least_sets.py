"""Parameters of the search for sets of robots that are worth least."""

from __future__ import annotations

from dataclasses import dataclass

__all__ = [
    "AscentParams",
    "AxisParams",
    "LimitParams",
    "PolytopeParams",
    "SetExchangeParams",
    "SetSearchParams",
    "UnderestimatorParams",
]


@dataclass(frozen=True, slots=True, kw_only=True)
class SetExchangeParams:
    """Local searches for weak sets of one size: more starts find weaker sets and take longer.

    ``random_starts`` : beside those that the data suggest. ``fewest_starts`` : whatever they cost
    ``work`` : exchanges times targets in one step of all starts together
    ``seed`` : of the random starts, the same for every call
    """

    random_starts: int = 40
    fewest_starts: int = 4
    work: int = 3_000_000
    seed: int = 0


@dataclass(frozen=True, slots=True, kw_only=True)
class LimitParams:
    """Limits on the robots of a set that sense below a threshold.

    ``enlarging`` : nodes to decide whether a limit holds with one more robot; more make limits stronger, later
    ``in_depth`` : partial sets that a question takes in depth before branch and bound
    """

    enlarging: int = 1_000
    in_depth: int = 4_000


@dataclass(frozen=True, slots=True, kw_only=True)
class PolytopeParams:
    """Half-spaces of the outer polytopes: each tightens the bound and adds vertices; all together fit 64 bits.

    ``sphere`` : directions spread evenly if a family has no parent. ``sight`` : directions along lines of sight
    ``capacity`` : vertices of a polytope; one that has more is not used
    ``safety`` : relative amount by which half-spaces are widened against rounding
    """

    sphere: int = 10
    sight: int = 8
    capacity: int = 160
    safety: float = 1e-9


@dataclass(frozen=True, slots=True, kw_only=True)
class SetSearchParams:
    """Depth-first search against branch and bound, in partial sets.

    ``whole`` : before branch and bound begins, by the robots of a team (at most, partial sets)
    ``by_axis`` : the same if one axis decides: bounds are quick then
    ``fewest``, ``most`` : of a node, before it is divided; they change by ``after_success`` and ``after_failure``
    ``heavy`` : robots per target whose patterns are enumerated, by undecided robots (at most, robots); each doubles the
    polytopes and sharpens the bound
    ``at_once`` : values of single targets between two looks at the clock
    """

    whole: tuple[tuple[int, int], ...] = ((32, 200_000), (10**9, 40_000))
    by_axis: int = 10_000
    fewest: int = 1_000
    most: int = 4_000
    after_success: float = 1.3
    after_failure: float = 0.8
    heavy: tuple[tuple[int, int], ...] = ((50, 4), (10**9, 5))
    at_once: int = 10_000_000


@dataclass(frozen=True, slots=True, kw_only=True)
class AscentParams:
    """Smoothed ascent of an underestimator's multipliers: more and cooler steps sharpen the bound and take longer.

    ``cold``, ``warm`` : temperatures in the room per target, from a first guess and from related multipliers
    ``steps`` : L-BFGS steps at each temperature. ``memory`` : pairs that L-BFGS keeps
    ``screened`` : temperatures above the least from which points are left out until the next temperature
    ``flat`` : least spread of points in a direction, relative to all (squared)
    """

    cold: tuple[float, ...] = (0.5, 0.3, 0.15, 0.1, 0.05, 0.03, 0.015)
    warm: tuple[float, ...] = (0.05, 0.02)
    steps: int = 25
    memory: int = 20
    screened: float = 200.0
    flat: float = 1e-6


@dataclass(frozen=True, slots=True, kw_only=True)
class UnderestimatorParams:
    """Half-spaces per target that a node hands to its children: more make polytopes tighter and their vertices more.

    ``kept`` : of those that bind. ``new`` : that would cut off vertices which bind
    ``binding`` : relative distance from the least vertex that counts as binding; it only ranks
    """

    kept: int = 24
    new: int = 4
    binding: float = 1e-2


@dataclass(frozen=True, slots=True, kw_only=True)
class AxisParams:
    """Bisection of the angle of the weakest axis.

    ``intervals`` : arcs per target at first. ``closed`` : relative width at which an arc is decided
    ``bisections`` : at most; arcs left open only loosen the bound
    """

    intervals: int = 16
    closed: float = 1e-12
    bisections: int = 60
