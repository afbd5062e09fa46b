"""Faults of a network and of robots while they plan, and the radios that carry their messages."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from ratt_opt._validation import check_integer, check_link, check_number
from ratt_opt.errors import InputError

if TYPE_CHECKING:
    from ratt_opt.problem import Problem

__all__ = ["Faults", "RadioParams"]


@dataclass(frozen=True, slots=True, kw_only=True)
class RadioParams:
    """Radios of the robots: each sends one packet at a time, to one neighbour.

    ``bandwidth`` : [bit/s] more shortens the time to send; 0.25 Mbit/s as published work assumes
    ``delay`` : shortest and longest time between the end of sending and arrival [s]; if they differ, packets overtake
    ``tick`` : time after which what may be lost is sent again [s]: less repairs losses sooner and repeats more
    ``detection`` : time after which the link layer tells a robot that a link is lost [s]

    Source of the bandwidth: Xu, Garimella, Tzoumas 2024, arXiv 2407.10382.
    """

    bandwidth: float = 250_000.0
    delay: tuple[float, float] = (0.001, 0.001)
    tick: float = 0.25
    detection: float = 0.5

    def __post_init__(self) -> None:
        for name in ("bandwidth", "tick"):
            if not check_number(name, getattr(self, name)) > 0:
                raise InputError(name, "must be positive", getattr(self, name))
        if not 0 <= check_number("delay", self.delay[0]) <= check_number("delay", self.delay[1]):
            raise InputError("delay", "must be (shortest, longest), from 0 s on", self.delay)
        if not check_number("detection", self.detection) >= 0:
            raise InputError("detection", "must be at least 0", self.detection)


@dataclass(frozen=True, slots=True, kw_only=True)
class Faults:
    """Faults while robots plan. Rounds count the longest chain of messages; faults later than the end do not happen.

    ``loss`` : share of packets that do not arrive, at most 0.9; ``duplicates`` : share that arrive twice
    ``cuts`` : ``(round, i, j)``, links cut for good; ``blinded``, ``crashed`` : ``(round, robot)``
    ``radio`` : bandwidth, delays, ticks

    Raises
    ------
    InputError : a share or a round is out of range.
    """

    loss: float = 0.0
    duplicates: float = 0.0
    cuts: tuple[tuple[int, int, int], ...] = ()
    blinded: tuple[tuple[int, int], ...] = ()
    crashed: tuple[tuple[int, int], ...] = ()
    radio: RadioParams = RadioParams()

    def __post_init__(self) -> None:
        # At least one message of ten arrives, or a plan would take thousands of rounds.
        for name, most in (("loss", 0.9), ("duplicates", 1.0)):
            if not 0 <= check_number(name, getattr(self, name)) <= most:
                raise InputError(name, f"must be in [0, {most:g}]", getattr(self, name))
        for name, length in (("cuts", 3), ("blinded", 2), ("crashed", 2)):
            for entry in getattr(self, name):
                if not isinstance(entry, tuple) or len(entry) != length:
                    rule = "must hold (round, i, j)" if length == 3 else "must hold (round, robot)"
                    raise InputError(name, rule, entry)
                for number in entry:
                    check_integer(name, number, low=0)

    def check(self, problem: Problem) -> Faults:
        """Return the faults after checking that their robots and links exist (``InputError`` otherwise)."""
        for _, i, j in self.cuts:
            link = check_link("cuts", (i, j))
            if (min(link), max(link)) not in problem.communication.links:
                raise InputError("cuts", "must hold links of the graph", (i, j))
        for name in ("blinded", "crashed"):
            for _, robot in getattr(self, name):
                check_integer(name, robot, low=0, high=problem.n_robots - 1)
        return self

    def by_round(self) -> list[tuple[int, str, tuple[int, ...]]]:
        """All faults that come at a round: ``(round, kind, who)``, the first ones first."""
        found: list[tuple[int, str, tuple[int, ...]]] = [(at, "cut", (i, j)) for at, i, j in self.cuts]
        found += [(at, "blinded", (i,)) for at, i in self.blinded] + [(at, "crashed", (i,)) for at, i in self.crashed]
        return sorted(found)
