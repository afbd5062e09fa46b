"""The smallest possible largest group (the paper's ``n_max``), four independent ways.

Cutting at most ``alpha_c`` links of a communication graph leaves groups; how small can the attacker
make the largest one? ``N - n_max`` is what RATT takes link attacks to be worth in sensing attacks.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import comb
from typing import TYPE_CHECKING

import numpy as np

from ratt_opt._validation import check_integer
from ratt_opt.errors import InputError
from ratt_opt.graph.caa import caa, links_within
from ratt_opt.graph.communication import CommunicationGraph
from ratt_opt.graph.connected_partitions import LARGEST_LATTICE
from ratt_opt.graph.threat import Threat
from ratt_opt.graph.threshold import ThresholdTest

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable

    import networkx as nx

    from ratt_opt.graph.communication import Link

__all__ = ["LARGEST_MILP", "LargestGroup", "counting_bound", "smallest_largest_group"]

AUTOMATIC_NODES = 20_000_000
"""Groups that ``method="auto"`` tries before it turns to the integer program (some ten seconds)."""

LARGEST_MILP = 40
"""Most robots ``method="auto"`` gives to the integer program."""


@dataclass(frozen=True, slots=True, kw_only=True)
class LargestGroup:
    """Claim: ``lower <= n_max``, and ``cut`` leaves a largest group of ``upper`` robots, so ``n_max <= upper``.

    ``upper`` is recomputed on the graph. ``reason`` says why ``lower`` holds. ``claimed_lower`` is what a
    solver claims beyond that and nothing has checked (equal to ``lower`` where no solver was asked).
    """

    lower: int
    upper: int
    cut: frozenset[Link]
    method: str
    reason: str
    claimed_lower: int

    @property
    def n_max(self) -> int:
        """The size attained by ``cut``: the smallest possible one when ``is_exact``."""
        return self.upper

    @property
    def is_exact(self) -> bool:
        """Whether ``lower`` (checked) meets ``upper``."""
        return self.lower == self.upper


def smallest_largest_group(
    graph: nx.Graph | CommunicationGraph,
    alpha_c: int,
    *,
    method: str = "auto",
    protected_links: Iterable[Link] = (),
    time_limit: float | None = None,
    max_nodes: int | None = None,
) -> LargestGroup:
    """Return the smallest size of the largest group that ``alpha_c`` cut links can leave.

    Parameters
    ----------
    graph : on robots ``0..N-1``
    method : ``"caa"`` (Algorithm 2; complete graphs), ``"partitions"`` (integer partitions; complete graphs),
        ``"enumeration"`` (partitions into connected groups; any graph up to 14 robots, and up to 60 where a link
        budget allows few groups, as on sparse graphs), ``"milp"`` (any graph), ``"counting"`` (any size; a bound
        and a heuristic cut only), or ``"auto"``: the first of caa, enumeration, milp, counting that is exact
    protected_links : links that cannot be cut
    time_limit, max_nodes : seconds and nodes for the enumeration beyond 14 robots, and for the integer program

    Raises
    ------
    InputError : the graph is not simple, the budget is out of range, or the method does not apply (the text says
        which would).

    Source: ratt.tex, Section III-A (n_max) and Algorithm 2.
    """
    if not isinstance(graph, CommunicationGraph):
        n_robots = graph.number_of_nodes() if hasattr(graph, "number_of_nodes") else 1
        graph = CommunicationGraph.from_networkx(graph, n_robots)
    threat = Threat(graph, 0, alpha_c, protected_links=frozenset(protected_links))
    if time_limit is not None and not time_limit >= 0:
        raise InputError("time_limit", "must be a number of seconds >= 0", time_limit)
    if max_nodes is not None:
        max_nodes = check_integer("max_nodes", max_nodes, low=0)
    if method == "auto":
        return _automatic(threat, time_limit, max_nodes)
    if method == "milp":
        return _by_milp(threat, time_limit, max_nodes)
    if method not in METHODS:
        raise InputError("method", f"must be one of auto, milp, {', '.join(METHODS)}", method)
    if method in {"caa", "partitions"} and not threat.links_alike:
        rule = 'must be "enumeration" (sparse graphs or at most 14 robots) or "milp" unless the graph is complete'
        raise InputError("method", f"{rule} and nothing protected", method)
    if method == "enumeration" and graph.n_robots > LARGEST_LATTICE:
        found = _by_groups(threat, time_limit, max_nodes)
        if found is None:
            rule = 'must be "milp" (or "caa" on a complete graph) for more than 60 robots, or a graph'
            value = f"enumeration of {graph.n_robots} robots"
            raise InputError("method", f"{rule} that an attack can split in so many ways", value)
        return found
    return METHODS[method](threat)


def _automatic(threat: Threat, time_limit: float | None, max_nodes: int | None) -> LargestGroup:
    n_robots = threat.graph.n_robots
    if threat.links_alike:
        return _by_caa(threat)
    if n_robots <= LARGEST_LATTICE:
        return _by_enumeration(threat)
    found = _by_groups(threat, time_limit, AUTOMATIC_NODES)
    if found is not None and found.is_exact:
        return found
    if n_robots <= LARGEST_MILP:
        return _by_milp(threat, time_limit, max_nodes)
    return found or _by_counting(threat)


def _by_milp(threat: Threat, time_limit: float | None, max_nodes: int | None) -> LargestGroup:
    from ratt_opt.graph.largest_group_milp import by_milp  # imports highspy

    return by_milp(threat, time_limit, max_nodes)


def _by_groups(threat: Threat, time_limit: float | None, max_nodes: int | None) -> LargestGroup | None:
    from ratt_opt.graph.largest_group_separable import by_separable_groups  # compiles

    return by_separable_groups(threat, time_limit, max_nodes)


def largest_left(graph: CommunicationGraph, cut: Iterable[Link]) -> int:
    """Size of the largest connected component once ``cut`` is gone."""
    return max(len(group) for group in graph.groups(cut))


def _result(threat: Threat, cut: frozenset[Link], lower: int, method: str, reason: str) -> LargestGroup:
    assert len(cut) <= threat.alpha_c, "a cut is within its budget"
    assert not cut & threat.protected_links, "a cut spares protected links"
    upper = largest_left(threat.graph, cut)
    return LargestGroup(lower=lower, upper=upper, cut=cut, method=method, reason=reason, claimed_lower=lower)


def _between(threat: Threat, home: list[int]) -> frozenset[Link]:
    return frozenset((i, j) for i, j in threat.graph.links if home[i] != home[j])


def _by_caa(threat: Threat) -> LargestGroup:
    size = caa(threat.graph.n_robots, threat.alpha_c).n_max
    cut = _between(threat, [i // size for i in range(threat.graph.n_robots)])
    reason = f"groups of at most {size - 1} robots keep too many links cut: links kept are convex in the group sizes"
    return _result(threat, cut, size, "caa", reason)


def _by_partitions(threat: Threat) -> LargestGroup:
    """Most links kept by any integer partition with parts up to p, by dynamic programming over all of them."""
    n_robots = threat.graph.n_robots
    to_keep = len(threat.graph.links) - threat.alpha_c
    for largest in range(1, n_robots + 1):
        kept, part = [0] * (n_robots + 1), [0] * (n_robots + 1)
        for robots in range(1, n_robots + 1):
            options = ((comb(p, 2) + kept[robots - p], p) for p in range(1, min(largest, robots) + 1))
            kept[robots], part[robots] = max(options)
        if kept[n_robots] >= to_keep:
            break
    sizes, left = [], n_robots
    while left:
        sizes.append(part[left])
        left -= part[left]
    home = np.repeat(np.arange(len(sizes)), sizes).tolist()
    reason = f"no integer partition of {n_robots} with parts up to {largest - 1} keeps {to_keep} links"
    return _result(threat, _between(threat, home), largest, "partitions", reason)


def _by_enumeration(threat: Threat) -> LargestGroup:
    """Fewest links that split the graph into connected groups of at most p robots, over all set partitions."""
    n_robots = threat.graph.n_robots
    sizes = np.bitwise_count(np.arange(2**n_robots)).astype(np.float64)
    test = ThresholdTest(threat, sizes)
    largest, split = next((p, s) for p in range(1, n_robots + 1) if (s := test.split(float(p))) is not None)
    home = [next(k for k, group in enumerate(split.groups) if group >> i & 1) for i in range(n_robots)]
    reason = f"no partition into connected groups of at most {largest - 1} robots is within the link budget"
    return _result(threat, _between(threat, home), largest, "enumeration", reason)


def counting_bound(threat: Threat) -> int:
    """Lower bound on ``n_max``: groups of at most p robots have at most ``links_within(N, p)`` links.

    Robots joined by protected links stay together, which gives another.
    """
    n_robots, rest = threat.graph.n_robots, len(threat.graph.links) - threat.alpha_c
    counted = next(p for p in range(1, n_robots + 1) if rest <= links_within(n_robots, p))
    held = CommunicationGraph(n_robots, threat.protected_links)
    return max(counted, *(len(group) for group in held.groups()))


def _by_counting(threat: Threat) -> LargestGroup:
    cut = heuristic_cut(threat)
    reason = "the links left, and the protected ones, do not fit into smaller groups"
    return _result(threat, cut, counting_bound(threat), "counting", reason)


def heuristic_cut(threat: Threat) -> frozenset[Link]:
    """Split the largest group by its cheapest cut, or cut its cheapest robot off, while the budget lasts."""
    import networkx as nx

    locked = len(threat.graph.links) + 1
    rest: nx.Graph = nx.Graph()
    rest.add_nodes_from(range(threat.graph.n_robots))
    for i, j in sorted(threat.graph.links):
        rest.add_edge(i, j, weight=locked if (i, j) in threat.protected_links else 1)
    cut: set[Link] = set()
    while True:
        largest = min(nx.connected_components(rest), key=lambda group: (-len(group), min(group)))
        part = rest.subgraph(sorted(largest))
        if len(largest) == 1:
            return frozenset(cut)
        cost, (side, _) = nx.stoer_wagner(part)
        if len(cut) + cost > threat.alpha_c:
            return frozenset(cut)
        inside = set(side)
        lost = [(min(i, j), max(i, j)) for i, j in part.edges if (i in inside) != (j in inside)]
        cut.update(lost)
        rest.remove_edges_from(lost)


METHODS: dict[str, Callable[[Threat], LargestGroup]] = {
    "caa": _by_caa,
    "partitions": _by_partitions,
    "enumeration": _by_enumeration,
    "counting": _by_counting,
}
