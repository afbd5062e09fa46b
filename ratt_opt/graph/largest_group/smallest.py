"""The smallest possible largest group by the way asked for, or by the first that settles it.

Cutting at most ``alpha_c`` links of a communication graph leaves groups; how small can the attacker
make the largest one? ``N - n_max`` is what RATT takes link attacks to be worth in sensing attacks.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from ratt_opt.budget import Budget
from ratt_opt.errors import InputError
from ratt_opt.graph.communication import CommunicationGraph
from ratt_opt.graph.connected_partitions import LARGEST_LATTICE
from ratt_opt.graph.largest_group.complete import by_caa, by_integer_partitions
from ratt_opt.graph.largest_group.counting import by_counting
from ratt_opt.graph.largest_group.enumeration import by_separable_groups, by_subsets
from ratt_opt.graph.largest_group.integer_program import by_integer_program
from ratt_opt.graph.threat import Threat

if TYPE_CHECKING:
    from collections.abc import Iterable

    import networkx as nx

    from ratt_opt.graph.communication import Link
    from ratt_opt.graph.largest_group.result import LargestGroup

__all__ = ["smallest_largest_group"]

AUTOMATIC_NODES = 20_000_000
"""Groups that ``method="auto"`` tries before it turns to the integer program (some ten seconds)."""

LARGEST_AUTOMATIC_PROGRAM = 40
"""Most robots ``method="auto"`` gives to the integer program."""

METHODS = ("auto", "milp", "caa", "partitions", "enumeration", "counting")


def smallest_largest_group(
    graph: nx.Graph | CommunicationGraph,
    alpha_c: int,
    *,
    method: str = "auto",
    protected_links: Iterable[Link] = (),
    time_limit: float | None = None,
    max_nodes: int | None = None,
    budget: Budget | None = None,
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
    budget : an outer search's budget: its seconds and interrupts count too

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
    own = Budget.inside(budget, time_limit, max_nodes)
    if method not in METHODS:
        raise InputError("method", f"must be one of {', '.join(METHODS)}", method)
    if method in {"caa", "partitions"} and not threat.links_alike:
        rule = 'must be "enumeration" (sparse graphs or at most 14 robots) or "milp" unless the graph is complete'
        raise InputError("method", f"{rule} and nothing protected", method)
    if method == "auto":
        return _automatic(threat, own)
    if method == "enumeration":
        return _by_enumeration(threat, own)
    if method == "milp":
        return by_integer_program(threat, own)
    return {"caa": by_caa, "partitions": by_integer_partitions, "counting": by_counting}[method](threat)


def _automatic(threat: Threat, budget: Budget) -> LargestGroup:
    n_robots = threat.graph.n_robots
    if threat.links_alike:
        return by_caa(threat)
    if n_robots <= LARGEST_LATTICE:
        return by_subsets(threat)
    found = by_separable_groups(threat, budget.part(max_nodes=AUTOMATIC_NODES))
    if found is not None and found.is_exact:
        return found
    if n_robots <= LARGEST_AUTOMATIC_PROGRAM:
        return by_integer_program(threat, budget)
    return found or by_counting(threat)


def _by_enumeration(threat: Threat, budget: Budget) -> LargestGroup:
    if threat.graph.n_robots <= LARGEST_LATTICE:
        return by_subsets(threat)
    found = by_separable_groups(threat, budget)
    if found is None:
        rule = 'must be "milp" (or "caa" on a complete graph) for more than 60 robots, or a graph'
        value = f"enumeration of {threat.graph.n_robots} robots"
        raise InputError("method", f"{rule} that an attack can split in so many ways", value)
    return found
