"""Parameters of curvatures: one frozen class for each algorithm, together in :class:`CurvatureParams`.

They decide how soon a bracket closes, never whether it holds.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from math import pi

__all__ = ["DEFAULT", "CurvatureParams", "PlanarParams", "SeparableParams"]


@dataclass(frozen=True, slots=True, kw_only=True)
class PlanarParams:
    """Branch and bound for the max-eigenvalue criterion in the plane.

    ``sectors`` : ends of the sectors first looked at [rad, double angle from the direction in which an element adds
    the least (most)]; more of them are narrower, and each is bounded
    ``slopes`` : most slopes tried for one region: fewer give weaker bounds, so more regions
    ``slope_share`` : smallest share of the gap that another slope must be able to close
    ``narrowest`` : sectors narrower than this are not halved again [rad]
    ``largest_leaf`` : regions with at most this many contexts are enumerated, which takes no longer than a program
    ``halving_share`` : a sector is halved if that could close this share of what its mixture leaves open
    ``rounds``, ``new_cuts``, ``first_cuts`` : of the linear program: times that violated cuts are added for one slope,
    targets that get one in a round, and targets that get one if there is none to start from
    ``violation`` : cuts violated by less than this are left, relative to the difference of the two levels
    ``smallest_share`` : targets with a smaller share of the average to start from get no cut at once
    ``edge_cost`` : cap on the multipliers of a sector's edges
    ``pool`` : averages of cuts kept for elements not searched yet; each is a pass over all options
    ``stuck``, ``long_stuck`` : parts bounded on one side before pairs of owners are tried for a better context, of
    contenders and of others; ``contender`` : ratio up to which an element is one, as a multiple of the smallest
    ``patience`` : parts bounded on one side before its number of parts counts against it
    """

    sectors: tuple[float, ...] = (0.1, 0.3, 0.6, 1.1, 1.6, 2.3, pi)
    slopes: int = 4
    slope_share: float = 0.1
    narrowest: float = 1e-3
    largest_leaf: int = 2048
    halving_share: float = 0.4
    rounds: int = 12
    new_cuts: int = 6
    first_cuts: int = 10
    violation: float = 3e-2
    smallest_share: float = 1e-9
    edge_cost: float = 100.0
    pool: int = 16
    stuck: int = 8
    long_stuck: int = 40
    contender: float = 1.1
    patience: int = 20


@dataclass(frozen=True, slots=True, kw_only=True)
class SeparableParams:
    """Branch and bound by separable minorants.

    ``first_steps`` : tangents tried at the root, which every element pays; more raise its bound, and take longer
    ``more_steps`` : tried when the root is looked at again, before it is branched. ``child_steps`` : for a part
    ``at_once`` : matrices of all elements up to which one search is made whatever the time (half a second)
    """

    first_steps: int = 12
    more_steps: int = 36
    child_steps: int = 8
    at_once: int = 1_000_000


@dataclass(frozen=True, slots=True, kw_only=True)
class CurvatureParams:
    """Parameters of curvatures and ratios; ``replace`` changes some.

    ``gap`` : by default; a guarantee that is linear in ``1 - curvature`` then loses at most 2 % to the bracket
    ``seconds`` : by default; what 30 robots with 12 controls take at a gap of 0.15, up to one instance in twenty

    ``enumeration_share`` : of the seconds left in which an enumeration has to end; a bracket gets the rest
    ``largest_enumeration`` : contexts that are enumerated at most [sets]; more take longer than a bracket
    ``largest_checked`` : elements whose submodularity is checked before the closed form is used (milliseconds)
    ``contexts`` : drawn at random for functions known by their values; they attain the lower end
    ``largest_pairs`` : nested pairs of sets that are all looked at, at most (a few seconds)
    ``samples``, ``sampled_size`` : random sets whose subsets are all looked at beyond that, and elements of each
    """

    gap: float = 0.02
    seconds: float = 30.0
    enumeration_share: float = 0.5
    largest_enumeration: int = 2**24
    largest_checked: int = 16
    contexts: int = 30
    largest_pairs: float = 1.5e8
    samples: int = 200
    sampled_size: int = 8
    planar: PlanarParams = field(default_factory=PlanarParams)
    separable: SeparableParams = field(default_factory=SeparableParams)


DEFAULT = CurvatureParams()
"""Parameters of curvatures that are not given any."""
