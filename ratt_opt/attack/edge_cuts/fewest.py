"""The least weight of links whose removal leaves groups of at most a size."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from fractions import Fraction
from typing import TYPE_CHECKING, Any, TypeVar

from ratt_opt._validation import check_distinct, check_link
from ratt_opt.attack.edge_cuts.cut_search import CutSearch
from ratt_opt.attack.edge_cuts.network import CutNetwork, exact_integers
from ratt_opt.budget import Budget, Stop, interruptible
from ratt_opt.errors import InputError
from ratt_opt.graph.communication import CommunicationGraph
from ratt_opt.running.progress import Step

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Sequence

    import networkx as nx

    from ratt_opt.graph.communication import Link

__all__ = ["FewestCuts", "cut_network", "cut_result", "fewest_cuts", "size_in_steps"]

T = TypeVar("T")


@dataclass(frozen=True, slots=True, kw_only=True)
class FewestCuts:
    """Claim: no cut that leaves groups of at most ``size`` weighs less than ``lower``; ``cut`` weighs ``upper``.

    ``groups`` : robots of each group that ``cut`` leaves
    ``prices`` : (N,) of robots, or ``None``. A connected group of at most ``size`` keeps links of at most the sum of
    its prices, so at least the weight of all links less the sum of all prices is cut: :attr:`by_prices`
    ``reason`` : why ``lower`` holds, and which limit was met if it is not exact
    ``proved_by`` : ``"prices"``, ``"listed groups"``, ``"elimination"``, or ``"nothing"`` if ``lower`` is 0
    ``notes`` : what a user should know of the network
    ``nodes`` : of all searches
    """

    size: int | float
    lower: int | float
    upper: int | float
    cut: frozenset[Link]
    groups: tuple[frozenset[int], ...]
    stop: Stop
    reason: str
    proved_by: str
    prices: tuple[Fraction, ...] | None
    by_prices: int | float
    notes: tuple[str, ...]
    nodes: int

    def __repr__(self) -> str:
        return f"FewestCuts([{self.lower}, {self.upper}], {len(self.groups)} groups, {self.stop.value}: {self.reason})"

    @property
    def is_exact(self) -> bool:
        """Tell whether ``lower`` meets ``upper``."""
        return self.lower == self.upper


@interruptible
@Step("the fewest cuts")
def fewest_cuts(
    graph: nx.Graph | CommunicationGraph,
    size: float,
    *,
    weights: Mapping[Link, float] | str | None = None,
    sizes: Mapping[int, float] | Sequence[float] | str | None = None,
    protected_links: Iterable[Link] = (),
    time_limit: float | None = None,
    max_nodes: int | None = None,
    budget: Budget | None = None,
) -> FewestCuts:
    """Find the least weight of links to cut so that every group left has at most ``size`` robots.

    Works until the answer is exact or the time is up. Numbers are taken as they are written (0.1 is a tenth), and all
    that is proved is computed in integers.

    Parameters
    ----------
    graph : on robots ``0..N-1`` (:func:`communication_graph` makes one)
    size : most robots of a group, or the sum of their ``sizes``
    weights : of links, by link or as the name of an edge attribute, each a number >= 0; all 1 by default
    sizes : of robots, by robot or as the name of a node attribute, each a number > 0; all 1 by default
    protected_links : links that cannot be cut
    time_limit, max_nodes : seconds, and nodes of all searches; unlimited by default
    budget : an outer search's budget: its seconds and interrupts count too

    Raises
    ------
    InputError : the graph is not simple or has no robot; a weight or size is negative, NaN, missing, or of an unknown
        robot or link; ``size`` is less than the largest robot, or than robots that protected links join.

    Source: Papazaharias and Walteros, Mathematical Programming Computation (2022), the problem; Johnson, Mehrotra and
    Nemhauser, Mathematical Programming 62 (1993), the linear program over groups.
    """
    own = Budget.inside(budget, time_limit, max_nodes)
    network = cut_network(graph, weights, sizes, protected_links)
    search = CutSearch(network, size_in_steps(network, size), own)
    return cut_result(network, search, search.run(), size)


def cut_network(
    graph: nx.Graph | CommunicationGraph,
    weights: Mapping[Link, float] | str | None,
    sizes: Mapping[int, float] | Sequence[float] | str | None,
    protected_links: Iterable[Link],
) -> CutNetwork:
    """The network of a graph, all that is given about it checked.

    Raises ``InputError`` : as :func:`fewest_cuts`.
    """
    given = graph
    if not isinstance(graph, CommunicationGraph):
        count = graph.number_of_nodes() if hasattr(graph, "number_of_nodes") else 1
        if count == 0:
            raise InputError("graph", "must have at least one robot", "none")
        graph = CommunicationGraph.from_networkx(graph, count)
    if isinstance(weights, str):
        weights = {_ordered(link): w for *link, w in _attribute(given, "edges", weights)}
    if isinstance(sizes, str):
        sizes = dict(_attribute(given, "nodes", sizes))
    by_link = None if weights is None else _complete("weights", weights, graph.links, _ordered)
    of_robots = sizes if sizes is None or isinstance(sizes, Mapping) else dict(enumerate(sizes))
    by_robot = None if of_robots is None else _complete("sizes", of_robots, range(graph.n_robots), lambda i: i)
    together = check_distinct("protected link", (_ordered(check_link("protected link", e)) for e in protected_links))
    for link in sorted(together - graph.links):
        raise InputError("protected link", "must be a link of the graph", link)
    in_order = None if by_robot is None else [by_robot[i] for i in range(graph.n_robots)]
    return CutNetwork.of(graph, by_link, in_order, together)


def _ordered(link: Iterable[int]) -> Link:
    i, j = link
    return (min(i, j), max(i, j))


def _attribute(graph: object, kind: str, name: str) -> list[tuple[Any, ...]]:
    """Nodes or edges with an attribute, ``None`` if it is missing.

    Raises ``InputError`` : the graph has no attributes.
    """
    view = getattr(graph, kind, None)
    if not callable(view):
        raise InputError("weights" if kind == "edges" else "sizes", "must be given by number for this graph", name)
    return list(view(data=name))


def _complete(argument: str, given: Mapping[T, object], known: Iterable[T], name: Callable[[T], T]) -> dict[T, object]:
    """Rename the keys of given values to the graph's; all must be known and present.

    Raises ``InputError`` : one is unknown or missing.
    """
    renamed = {name(key): value for key, value in given.items()}
    for key in renamed.keys() - set(known):
        raise InputError(argument, "must be of robots and links of the graph", key)
    for key in known:
        if renamed.get(key) is None:
            raise InputError(argument, "must be given for all", f"none for {key}")
    return renamed


def size_in_steps(network: CutNetwork, size: float) -> int:
    """The size in steps of sizes, rounded down.

    Raises ``InputError`` : it is no number, or less than robots that stay together.
    """
    (room,), scale = exact_integers("size", [size])
    room = room * network.size_scale // scale
    heaviest = int(network.size.argmax())
    if network.size[heaviest] > room:
        robots, least = network.members[heaviest], Fraction(int(network.size[heaviest]), network.size_scale)
        joined = f"robots {robots}, which protected links join, are" if len(robots) > 1 else f"robot {robots[0]} is"
        raise InputError("size", f"must be at least {_number(least)}: {joined} of that size", size)
    return room


def _number(exact: Fraction) -> int | float:
    return int(exact) if exact.denominator == 1 else float(exact)


def cut_result(network: CutNetwork, search: CutSearch, stop: Stop, size: float) -> FewestCuts:
    """The result of a search, in the graph's own units; what the cut weighs is added up anew."""
    cut = network.graph.links_between(network.groups_of(search.label))
    groups = network.graph.groups(cut)
    upper = sum(network.links[link] for link in cut)
    assert upper == search.upper, "a cut weighs what the search says"
    by_prices, prices = 0, None
    if search.prices is not None:
        by_prices = max(network.total - int(search.prices.sum()) // network.unit, 0)
        own = [Fraction(0)] * network.graph.n_robots
        for robots, price in zip(network.members, search.prices.tolist(), strict=True):
            own[robots[0]] = Fraction(price, network.unit * network.scale)
        prices = tuple(own)
    already = len(network.graph.groups())
    notes = () if already == 1 else (f"the network falls into {already} groups before any cut",)
    weight = [_number(Fraction(value, network.scale)) for value in (search.lower, upper, by_prices)]
    return FewestCuts(
        size=size,
        lower=weight[0],
        upper=weight[1],
        cut=cut,
        groups=tuple(sorted(groups, key=lambda group: (-len(group), min(group)))),
        stop=stop,
        reason="; ".join(filter(None, [search.reason, "" if stop is Stop.CLOSED else search.limit])),
        proved_by=search.proved_by,
        prices=prices,
        by_prices=weight[2],
        notes=notes,
        nodes=search.budget.nodes,
    )
