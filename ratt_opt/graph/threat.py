"""The adversary's means: the graph, the budgets, and the robots and links that are protected."""

from __future__ import annotations

from dataclasses import dataclass
from math import comb
from typing import TYPE_CHECKING

from ratt_opt._validation import check_distinct, check_integer, check_link
from ratt_opt.errors import InputError

if TYPE_CHECKING:
    from ratt_opt.graph.communication import CommunicationGraph, Link

__all__ = ["Threat"]


@dataclass(frozen=True, slots=True)
class Threat:
    """The adversary blinds at most ``alpha_s`` robots and cuts at most ``alpha_c`` links of ``graph``.

    Robots in ``protected_robots`` cannot be blinded and links in ``protected_links`` cannot
    be cut. Budgets may exceed what can be attacked (at most N robots and all links).

    Raises ``InputError`` : a budget is out of range, or a protected robot or link does not exist.
    """

    graph: CommunicationGraph
    alpha_s: int
    alpha_c: int
    protected_robots: frozenset[int] = frozenset()
    protected_links: frozenset[Link] = frozenset()

    def __post_init__(self) -> None:
        n_robots, links = self.graph.n_robots, self.graph.links
        set_field = object.__setattr__
        set_field(self, "alpha_s", check_integer("alpha_s", self.alpha_s, low=0, high=n_robots))
        set_field(self, "alpha_c", check_integer("alpha_c", self.alpha_c, low=0, high=len(links)))
        robots = (check_integer("protected robot", i, low=0, high=n_robots - 1) for i in self.protected_robots)
        set_field(self, "protected_robots", check_distinct("protected robot", robots))
        pairs = (check_link("protected link", link) for link in self.protected_links)
        ordered = check_distinct("protected link", ((min(i, j), max(i, j)) for i, j in pairs))
        for link in sorted(ordered - links):
            raise InputError("protected link", "must be a link of the graph", link)
        set_field(self, "protected_links", ordered)

    @property
    def n_blinded(self) -> int:
        """Robots a worst attack blinds: the budget, as far as unprotected robots last."""
        return min(self.alpha_s, self.graph.n_robots - len(self.protected_robots))

    @property
    def n_cut(self) -> int:
        """Links a worst attack cuts: the budget, as far as unprotected links last."""
        return min(self.alpha_c, len(self.graph.links) - len(self.protected_links))

    @property
    def n_attacks(self) -> int:
        """Sets of links times sets of robots that use the whole budgets."""
        cuts = comb(len(self.graph.links) - len(self.protected_links), self.n_cut)
        return cuts * comb(self.graph.n_robots - len(self.protected_robots), self.n_blinded)

    @property
    def links_alike(self) -> bool:
        """Tell whether all links are alike to the adversary (complete graph, no protected link)."""
        return self.graph.is_complete and not self.protected_links

    @property
    def is_symmetric(self) -> bool:
        """Tell whether all robots and links are alike to the adversary (complete graph, nothing protected)."""
        return self.links_alike and not self.protected_robots
