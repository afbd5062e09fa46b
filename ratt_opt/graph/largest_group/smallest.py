"""The smallest possible largest group by the way that is named, or by the first that settles it; ways by enumeration.

Cutting at most ``alpha_c`` links of a communication graph leaves groups; how small can the attacker make the largest
one? ``N - n_max`` is what RATT takes link attacks to be worth in sensing attacks. Small teams are decided over all
their subsets; larger ones get a bracket from annealing and a linear program first. If that does not close, they are
partitioned into separable groups of at most p robots, for p = 1, 2, ... in turn, or given to the integer program.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from ratt_opt.budget import Budget, OutOfBudget, interruptible
from ratt_opt.errors import InputError
from ratt_opt.graph.communication import CommunicationGraph, Link
from ratt_opt.graph.connected_partitions import LARGEST_LATTICE
from ratt_opt.graph.few_cuts import attacks_are_few, partitions_by_few_cuts
from ratt_opt.graph.largest_group.annealed_cut import annealed_cut
from ratt_opt.graph.largest_group.bridges import by_bridges, is_nearly_a_tree
from ratt_opt.graph.largest_group.counting import (
    COUNTED,
    LargestGroup,
    by_caa,
    by_counting,
    by_integer_partitions,
    counting_bound,
    largest_left,
    split_result,
)
from ratt_opt.graph.largest_group.heuristic_cut import heuristic_cut
from ratt_opt.graph.largest_group.integer_program import by_integer_program
from ratt_opt.graph.largest_group.spreading import TREES, forced_size, forced_size_soon
from ratt_opt.graph.separable_groups import PartitionSearch, separable_groups
from ratt_opt.graph.threat import Threat
from ratt_opt.graph.threshold import ThresholdTest
from ratt_opt.running.progress import Step

if TYPE_CHECKING:
    from collections.abc import Iterable

    import networkx as nx


__all__ = ["bound_soon", "by_search", "by_separable_groups", "by_subsets", "smallest_largest_group"]

AUTOMATIC_NODES = 20_000_000
"""Groups that ``method="auto"`` tries before it turns to the integer program (some ten seconds)."""
LARGEST_AUTOMATIC_PROGRAM = 40
"""Most robots ``method="auto"`` gives to the integer program."""
METHODS = ("auto", "milp", "spreading", "caa", "partitions", "enumeration", "counting")


@interruptible
@Step("the smallest largest group")
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
        ``"enumeration"`` (partitions into connected groups; any graph up to 14 robots, and up to 60 if a link
        budget allows few groups, as on sparse graphs), ``"milp"`` (any graph), ``"spreading"`` (hundreds of robots;
        a bracket), ``"counting"`` (any size; a bound and a heuristic cut only), or ``"auto"``: of caa, enumeration,
        spreading and milp what applies, until one is exact; if few cuts are possible, all of them, and if the graph is
        hardly more than a tree, its bridges and few links beside them
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
    if method == "spreading":
        return by_spreading(threat, own)
    if method == "counting":
        return by_counting(threat, own)
    return by_caa(threat) if method == "caa" else by_integer_partitions(threat)


def _automatic(threat: Threat, budget: Budget) -> LargestGroup:
    if threat.links_alike or threat.graph.n_robots <= LARGEST_LATTICE:
        return by_search(threat, budget)
    if is_nearly_a_tree(threat):
        return by_bridges(threat, budget)
    if attacks_are_few(threat):
        return by_few_cuts(threat, budget)
    known = by_spreading(threat, budget)
    return known if known.is_exact or budget.is_over else by_search(threat, budget, known)


def by_few_cuts(threat: Threat, budget: Budget) -> LargestGroup:
    """Try every cut; the bracket by counting, and the best cut tried, if the budget ends before."""
    best, smallest = frozenset[Link](), threat.graph.n_robots
    try:
        for cut, groups in partitions_by_few_cuts(threat, budget):
            if (size := max(map(len, groups))) < smallest:
                best, smallest = cut, size
    except OutOfBudget:
        return split_result(threat, best, counting_bound(threat), "enumeration", COUNTED)
    return split_result(threat, best, smallest, "enumeration", "every cut was tried")


def by_search(threat: Threat, budget: Budget, known: LargestGroup | None = None) -> LargestGroup:
    """The first of the exact ways that applies, from what is ``known``; that, or counting, if none does."""
    if threat.links_alike:
        return by_caa(threat)
    if threat.graph.n_robots <= LARGEST_LATTICE:
        return by_subsets(threat, budget)
    found = by_separable_groups(threat, budget.part(max_nodes=AUTOMATIC_NODES), known)
    if found is not None and (found.is_exact or budget.is_over):
        return found
    if threat.graph.n_robots <= LARGEST_AUTOMATIC_PROGRAM:
        return by_integer_program(threat, budget, known)
    return found or known or by_counting(threat, budget)


def bound_soon(threat: Threat, budget: Budget) -> int:
    """No cut leaves a smaller largest group; the smallest one itself up to 14 robots and if groups are soon listed.

    Seconds at hundreds of robots, and without a limit of time the same on every machine: listing and trees end after
    a fixed amount of work.
    """
    if threat.graph.n_robots <= SUBSETS_SOON:
        return by_subsets(threat, budget).lower
    found = by_separable_groups(threat, budget.part(max_nodes=AUTOMATIC_NODES))
    if found is not None and found.is_exact:
        return found.lower
    if threat.graph.n_robots <= LARGEST_LATTICE:
        return by_subsets(threat, budget).lower
    known = counting_bound(threat) if found is None else found.lower
    return max(known, forced_size_soon(threat, budget))


def by_spreading(threat: Threat, budget: Budget) -> LargestGroup:
    """Bracket by annealing from above and by tree inequalities from below: hundreds of robots in seconds."""
    quick = by_counting(threat, budget)
    cut = annealed_cut(threat, quick.cut, quick.lower, budget)
    upper = largest_left(threat.graph, cut)
    forced = 0 if upper == quick.lower else forced_size(replace(threat, alpha_s=0), budget, upper)
    reason = COUNTED if forced <= quick.lower else TREES
    return split_result(threat, cut, max(forced, quick.lower), "spreading", reason)


def _by_enumeration(threat: Threat, budget: Budget) -> LargestGroup:
    if threat.graph.n_robots <= LARGEST_LATTICE:
        return by_subsets(threat, budget)
    found = by_separable_groups(threat, budget)
    if found is None and budget.is_over:
        return by_counting(threat, budget)
    if found is None:
        rule = 'must be "milp" (or "caa" on a complete graph) for more than 60 robots, or a graph'
        value = f"enumeration of {threat.graph.n_robots} robots"
        raise InputError("method", f"{rule} that an attack can split in that many ways", value)
    return found


MOST_GROUPS = 300_000
"""Groups listed before this way is given up: a second on sparse graphs of 50 robots, four on dense ones."""
PAIRS_A_SECOND = 8_000_000
"""Of a set of robots and a group in it, of which a team has 3^N: they are listed without a look at the clock, so not at
all if that would take longer than there is."""
SUBSETS_SOON = 12
"""Robots up to which all subsets are a tenth of a second; beyond, groups are mostly listed sooner."""
NODES_AT_ONCE = 100_000
"""Nodes between two looks at the clock (about a tenth of a second)."""


def by_subsets(threat: Threat, budget: Budget) -> LargestGroup:
    """Fewest links that split the graph into connected groups of at most p robots, over all set partitions."""
    n_robots = threat.graph.n_robots
    lower, reason = counting_bound(threat), COUNTED
    if budget.is_over or 3**n_robots > PAIRS_A_SECOND * budget.seconds_left:
        return split_result(threat, heuristic_cut(threat, budget), lower, "enumeration", reason)
    test = ThresholdTest(threat, np.bitwise_count(np.arange(2**n_robots)).astype(np.float64))
    while not budget.is_over:
        split = test.split(float(lower))
        if split is not None:
            cut = threat.graph.links_between(split.members())
            return split_result(threat, cut, lower, "enumeration", _none_smaller(lower))
        lower += 1
        reason = _none_smaller(lower)
    return split_result(threat, heuristic_cut(threat, budget), lower, "enumeration", reason)


def by_separable_groups(threat: Threat, budget: Budget, known: LargestGroup | None = None) -> LargestGroup | None:
    """Smallest largest group, or the bracket that the budget allows; ``None`` if the groups are too many to list."""
    groups = separable_groups(threat, MOST_GROUPS, budget)
    if groups is None:
        return None
    sizes = np.bitwise_count(groups.masks)
    known = known or by_counting(threat, budget)
    lower, reason, cut = known.lower, known.reason, known.cut
    while lower < largest_left(threat.graph, cut):
        few = groups.among(sizes <= lower)
        search = PartitionSearch(few)
        chosen = _first_partition(search, budget)
        if chosen is not None:
            cut = threat.graph.links_between(few.members(group).tolist() for group in chosen)
        if chosen is not None or not search.finished:
            break
        lower += 1
        reason = _none_smaller(lower)
    return split_result(threat, cut, lower, "enumeration", reason)


def _first_partition(search: PartitionSearch, budget: Budget) -> list[int] | None:
    """The first partition, or ``None`` when the search is finished or the budget spent."""
    chosen = None
    try:
        while chosen is None and not search.finished:
            chosen = search.next_within(NODES_AT_ONCE, budget)
    except OutOfBudget:
        pass
    return chosen


def _none_smaller(size: int) -> str:
    return f"no partition into connected groups of at most {size - 1} robots is within the link budget"
