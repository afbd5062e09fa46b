"""The arrays that the compiled loop reads, and how it names what ended a node."""

from __future__ import annotations

from typing import Any, NamedTuple

__all__ = ["BRANCHED", "MOST_ROBOTS", "Attacks", "Gains", "Path", "Team"]

BRANCHED = -1
"""In a record: the node is divided by the elements of the next robot. Any other number is the attack of a dead end."""
MOST_ROBOTS = 64
"""Robots that masks hold."""


class Team(NamedTuple):
    """The data of a problem over E elements, robots in the order in which they choose.

    ``code`` : the criterion's; ``weights``, ``baseline`` (M,) : of targets; ``prior`` (M, T), ``information`` (E, M, T)
    ``first`` (N + 1,) : where each robot's elements begin; ``sees`` (E, M) : whether there is information
    ``seeing`` (M, E) : elements with information of a target, those of the last robots first; padded by -1
    """

    code: Any
    weights: Any
    baseline: Any
    prior: Any
    information: Any
    first: Any
    sees: Any
    seeing: Any


class Attacks(NamedTuple):
    """Groups ``of`` (A, S) each attack, padded by -1; ``members`` (G,) : masks of their robots, none of them blinded.

    ``order`` (A,) : in which attacks are tried; those that last led to a dead end come first
    """

    members: Any
    of: Any
    order: Any


class Path(NamedTuple):
    """Where the search is.

    ``depth`` (1,) : how many robots have chosen; ``chosen`` (N,) : their elements
    ``seers`` (M,) : masks of the robots that have chosen to see a target; ``version`` (M,) : another one at each change
    ``record`` (R,) : of each node, in preorder, how it ended; ``size`` (1,) : how many there are
    """

    depth: Any
    chosen: Any
    seers: Any
    version: Any
    record: Any
    size: Any


class Gains(NamedTuple):
    """Of each target, for the sets of its seers asked for last: their ``value`` (M, K), and what elements gain.

    ``gain`` (M, K, E) : beside the set, of elements of robots that choose later than ``since`` (M, K)
    ``version``, ``seers`` (M, K) : which set it is; ``matrices`` (2, T) : room for two
    """

    value: Any
    gain: Any
    since: Any
    version: Any
    seers: Any
    matrices: Any
