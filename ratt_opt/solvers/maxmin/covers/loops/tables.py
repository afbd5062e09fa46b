"""The arrays that the compiled loops share, and the numbers by which they name what happened."""

from __future__ import annotations

from typing import Any, NamedTuple

__all__ = ["BY_COVER", "BY_SUM", "TRIED", "Record", "Stack", "Sums", "Team", "Ways"]

BY_COVER, BY_SUM, TRIED = 0, 1, 2
"""What forbids an element, or ends a frame: a cover, a sum of covers, or that the element was a dead end."""


class Team(NamedTuple):
    """The data of a problem over E elements.

    ``code`` : the criterion's; ``weights``, ``baseline`` (M,) : of targets; ``prior`` (M, T), ``information`` (E, M, T)
    ``sees`` (E, M) : whether there is information; ``owner``, ``bit``, ``element`` : as :class:`Places` has them
    ``count`` (N,) : what a robot counts in a cover; ``safe`` (N,) : whether it cannot be blinded
    """

    code: Any
    weights: Any
    baseline: Any
    prior: Any
    information: Any
    sees: Any
    owner: Any
    bit: Any
    element: Any
    count: Any
    safe: Any
    enough: Any


class Ways(NamedTuple):
    """Partitions ``of`` (P, S) of groups, padded by -1, in the ``order`` in which they are tried.

    ``members`` (G, N), ``inside`` (G, E) : which robots and elements are in each group
    """

    members: Any
    inside: Any
    of: Any
    order: Any


class Sums(NamedTuple):
    """Sums of covers by number: what each element counts, ``terms`` (R, E), of which plans have to count ``enough``.

    ``tried`` (A,) : those that are looked at; ``used`` (R,) : how often each was of use
    """

    terms: Any
    tried: Any
    used: Any


class Stack(NamedTuple):
    """Frames and steps.

    ``start`` (N,) : masks of what is allowed at first; ``allowed`` (N + 1, N) : in each frame
    ``strongest`` (N + 1, N, M, T) : bounds of what allowed elements tell; ``fixed`` (N + 1,) : each frame's element
    ``first`` (N + 2,) : the first step of each frame
    ``kind``, ``what``, ``robot``, ``gone`` (E + 1,), ``reason`` (E + 1, N) : steps, what they forbid, and why
    ``since`` (E,) : the frame in which an element was forbidden last; ``touched`` (N + 1, N) : the same of robots
    ``activity`` (N,) : dead ends that depended on a robot's elements
    """

    start: Any
    allowed: Any
    strongest: Any
    fixed: Any
    first: Any
    kind: Any
    what: Any
    robot: Any
    gone: Any
    reason: Any
    since: Any
    touched: Any
    activity: Any
    frame: Any
    steps: Any


class Record(NamedTuple):
    """``nodes`` (R, 5) : kind, its subject, robot, element's place, the next node; the last one is the root.

    The subject is a cover, a sum, or the node of the dead end. What ends a frame has robot -1.
    """

    nodes: Any
    size: Any
