"""Who is linked to whom, and what may be attacked, in the verifier's terms."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from ratt_opt.graph.threat import Threat

__all__ = ["Team"]


@dataclass(slots=True)
class Team:
    """A team and what threatens it, for what the verifier decides about groups while a proof is written."""

    n: int
    near: list[set[int]]
    safe_robots: frozenset[int]
    safe_links: frozenset[tuple[int, int]]
    links: frozenset[tuple[int, int]]
    alpha_s: int
    alpha_c: int

    @classmethod
    def of(cls, threat: Threat) -> Team:
        """That of a threat."""
        graph, near = threat.graph, [set[int]() for _ in range(threat.graph.n_robots)]
        for i, j in graph.links:
            near[i].add(j)
            near[j].add(i)
        safe = threat.protected_robots, threat.protected_links
        return cls(graph.n_robots, near, *safe, graph.links, threat.alpha_s, threat.alpha_c)
