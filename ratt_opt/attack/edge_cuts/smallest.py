"""The smallest possible largest group: how small can ``alpha_c`` cut links make the largest group?

``N - n_max`` is what RATT takes link attacks to be worth in sensing attacks. Complete graphs are decided by CAA, few
cuts one by one, sparse networks by elimination. On all others an annealed cut bounds the size
from above, and the search of :func:`fewest_cuts` refutes the next smaller size, or finds a better cut, until both meet.
Counting, and tree inequalities of a linear program, raise the lower end for as long as that takes.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import partial
from typing import TYPE_CHECKING

import numpy as np

from ratt_opt.attack.edge_cuts.cut_search import CutSearch
from ratt_opt.attack.edge_cuts.elimination import Elimination, TooManyStates
from ratt_opt.attack.edge_cuts.network import CutNetwork
from ratt_opt.budget import Budget, OutOfBudget, Stop, interruptible
from ratt_opt.errors import InputError
from ratt_opt.graph.communication import CommunicationGraph, Link
from ratt_opt.graph.connected_partitions import LARGEST_LATTICE
from ratt_opt.graph.few_cuts import partitions_by_few_cuts
from ratt_opt.graph.largest_group.annealed_cut import annealed_cut
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
from ratt_opt.graph.largest_group.integer_program import by_integer_program
from ratt_opt.graph.largest_group.spreading import TREES, forced_size, forced_size_soon
from ratt_opt.graph.threat import Threat
from ratt_opt.graph.threshold import ThresholdTest
from ratt_opt.running.progress import Step

if TYPE_CHECKING:
    from collections.abc import Iterable

    import networkx as nx

    from ratt_opt._validation import IntArray

__all__ = ["SizeParams", "bound_soon", "by_subsets", "largest_group_of", "smallest_largest_group"]

METHODS = ("auto", "milp", "spreading", "caa", "partitions", "enumeration", "counting")


@dataclass(frozen=True, slots=True, kw_only=True)
class SizeParams:
    """Parameters of the search for the smallest largest group; ``replace`` changes some.

    They decide how soon its bracket closes, never whether it holds.

    ``first_share``, ``first_nodes`` : of a first try of the next smaller size, before tree inequalities
    ``one_by_one`` : attacks that use the whole budgets, up to which every cut is tried: 20,000 take a second or two of
    the processor at 120 robots
    ``trees_share`` : of the time left for tree inequalities, and ``proof_share`` for a size above the lower end
    ``soon_nodes``, ``soon_robots`` : nodes and robots up to which RATT asks for the exact size; fixed work, so that its
    plan is the same on every machine. All set partitions are quicker up to ``soon_subsets`` robots
    """

    one_by_one: int = 20_000
    first_share: float = 0.4
    first_nodes: int = 1_000_000
    trees_share: float = 0.2
    proof_share: float = 0.6
    soon_nodes: int = 30_000
    soon_robots: int = 60
    soon_subsets: int = 12


DEFAULT = SizeParams()
"""Parameters of searches that are not given any."""


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
    params: SizeParams = DEFAULT,
) -> LargestGroup:
    """Return the smallest size of the largest group that ``alpha_c`` cut links can leave.

    Works until that is exact or the budget is spent, at any size.

    Parameters
    ----------
    graph : on robots ``0..N-1``
    method : ``"auto"``, or one of the ways to check it by: ``"caa"`` (Algorithm 2; complete graphs), ``"partitions"``
        (integer partitions; complete graphs), ``"enumeration"`` (all set partitions; up to 14 robots), ``"milp"`` (an
        integer program, whose claim is shown apart and proves nothing), ``"spreading"`` (a bracket by annealing and
        tree inequalities), ``"counting"`` (a bracket at once)
    protected_links : links that cannot be cut
    time_limit, max_nodes : seconds, and nodes of all searches; unlimited by default
    budget : an outer search's budget: its seconds and interrupts count too
    params : of ``"auto"``

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
        rule = 'must be "auto", "milp" or (up to 14 robots) "enumeration" unless the graph is complete'
        raise InputError("method", f"{rule} and nothing protected", method)
    if method == "enumeration" and graph.n_robots > LARGEST_LATTICE:
        rule = f'must be "auto" or "milp" for more than {LARGEST_LATTICE} robots'
        raise InputError("method", rule, f"enumeration of {graph.n_robots} robots")
    if method in {"caa", "partitions"}:
        return by_caa(threat) if method == "caa" else by_integer_partitions(threat)
    ways = {"enumeration": by_subsets, "milp": by_integer_program, "spreading": by_spreading, "counting": by_counting}
    return ways.get(method, partial(largest_group_of, params=params))(threat, own)


def largest_group_of(threat: Threat, budget: Budget, params: SizeParams = DEFAULT) -> LargestGroup:
    """:func:`smallest_largest_group` of a threat, whose robots to blind do not count; nodes are those of ``budget``."""
    if threat.links_alike:
        return by_caa(threat)
    if threat.n_attacks <= params.one_by_one:
        return by_few_cuts(threat, budget)
    search = _SizeSearch(threat, by_counting(threat, budget), budget, params)
    search.run()
    return search.result()


def by_few_cuts(threat: Threat, budget: Budget) -> LargestGroup:
    """Try every cut; the bracket by counting, and the best cut tried, if the budget ends before."""
    best, smallest = frozenset[Link](), threat.graph.n_robots
    try:
        for cut, groups in partitions_by_few_cuts(threat, budget):
            if (size := max(map(len, groups))) < smallest:
                best, smallest = cut, size
    except OutOfBudget as spent:
        return split_result(threat, best, counting_bound(threat), "enumeration", COUNTED, stop=spent.stop)
    return split_result(threat, best, smallest, "enumeration", "every cut was tried")


def by_spreading(threat: Threat, budget: Budget) -> LargestGroup:
    """Bracket by annealing from above and by tree inequalities from below: hundreds of robots in seconds."""
    quick = by_counting(threat, budget)
    cut = annealed_cut(threat, quick.cut, quick.lower, budget)
    upper = largest_left(threat.graph, cut)
    forced = 0 if upper == quick.lower else forced_size(replace(threat, alpha_s=0), budget, upper)
    reason = COUNTED if forced <= quick.lower else TREES
    return split_result(threat, cut, max(forced, quick.lower), "spreading", reason, stop=budget.stop())


def by_subsets(threat: Threat, budget: Budget) -> LargestGroup:
    """Fewest links that split the graph into connected groups of at most p robots, over all set partitions."""
    quick = by_counting(threat, budget)
    lower, reason = quick.lower, quick.reason
    test = (
        None if budget.is_over else ThresholdTest(threat, np.bitwise_count(np.arange(2**threat.graph.n_robots)) * 1.0)
    )
    while test is not None and not budget.is_over:
        split = test.split(float(lower))
        if split is not None:
            return split_result(
                threat, threat.graph.links_between(split.members()), lower, "enumeration", _none_smaller(lower)
            )
        lower += 1
        reason = _none_smaller(lower)
    return split_result(threat, quick.cut, lower, "enumeration", reason, stop=budget.stop())


def _none_smaller(size: int) -> str:
    return f"no partition into connected groups of at most {size - 1} robots is within the link budget"


def bound_soon(threat: Threat, budget: Budget, params: SizeParams = DEFAULT) -> LargestGroup:
    """Bracket the smallest largest group by a fixed amount of work; mostly exact up to some 60 robots.

    Seconds at hundreds of robots, and without a limit of time the same on every machine: every part ends after a fixed
    amount of work.
    """
    found = _searched_soon(threat, budget, params)
    lower = found.lower if found.is_exact else forced_size_soon(threat, budget)
    if found.lower >= lower:
        return found
    return replace(found, lower=lower, claimed_lower=lower, method="spreading", reason=TREES)


def _searched_soon(threat: Threat, budget: Budget, params: SizeParams) -> LargestGroup:
    """Search all partitions of small teams, and smaller sizes one by one of others."""
    known = by_counting(threat, budget)
    if known.is_exact or threat.graph.n_robots > params.soon_robots:
        return known
    if threat.graph.n_robots <= params.soon_subsets:
        return by_subsets(threat, budget)
    search = _SizeSearch(threat, known, budget.part(max_nodes=params.soon_nodes), params)
    search.go_down(while_decided=True)
    return search.result()


class _SizeSearch:
    """The bracket of one threat, and what raises and lowers its ends."""

    def __init__(self, threat: Threat, known: LargestGroup, budget: Budget, params: SizeParams) -> None:
        self.threat, self.known, self.budget, self.params = threat, known, budget, params
        self.lower, self.upper, self.cut, self.reason = known.lower, known.upper, known.cut, known.reason
        self._network = CutNetwork.of(threat.graph, together=threat.protected_links)
        self._limits: list[str] = []
        self._stop: Stop | None = None

    def result(self) -> LargestGroup:
        """The bracket, and what ended the search."""
        method = self.known.method if self.reason == self.known.reason else "prices"
        stop = self._stop or self.budget.stop()
        reason = "; ".join([self.reason, *self._limits]) if self.lower < self.upper else self.reason
        return split_result(self.threat, self.cut, self.lower, method, reason, stop=stop)

    def run(self) -> None:
        """Eliminate; then try the next smaller size, ask tree inequalities, and go on until the ends meet."""
        try:
            self._eliminate()
            self._anneal()
            if self.lower < self.upper:
                with self.budget.stage(self.params.first_share, max_nodes=self.params.first_nodes) as first:
                    self._decide(self.upper - 1, first)
            if self.lower < self.upper:
                with self.budget.stage(self.params.trees_share) as trees:
                    self._raise(forced_size(replace(self.threat, alpha_s=0), trees, self.upper), TREES)
        except OutOfBudget as spent:
            self._stop = spent.stop
            return
        self.go_down()

    def _eliminate(self) -> None:
        """Bisect sizes by elimination; which of them are decided depends on the network's tree width."""
        elimination = Elimination(self._network)
        while self.lower < self.upper:
            size = max((self.lower + self.upper) // 2, int(self._network.size.max()))
            try:
                label = elimination.least_cut(size, self.threat.alpha_c, self.budget) if size < self.upper else None
            except TooManyStates as limit:
                self._limits = [str(limit)]
                return
            if label is None:
                self._raise(min(size + 1, self.upper), f"no group of at most {size} is left: {elimination.reason}")
            else:
                self._take(label)

    def _anneal(self) -> None:
        self._take_cut(annealed_cut(self.threat, self.cut, self.lower, self.budget))

    def _take(self, label: IntArray) -> None:
        self._take_cut(self.threat.graph.links_between(self._network.groups_of(label)))

    def _take_cut(self, cut: frozenset[Link]) -> None:
        self.cut, self.upper = cut, largest_left(self.threat.graph, cut)

    def go_down(self, *, while_decided: bool = False) -> None:
        """Decide the next smaller size again and again; one that stays open is followed by smaller ones.

        ``while_decided`` : the first one that stays open ends it
        """
        step = 1
        try:
            while self.lower < self.upper:
                size = max(self.lower, self.upper - step)
                share = self.params.proof_share if size > self.lower else 1.0
                with self.budget.stage(share) as part:
                    if self._decide(size, part):
                        step = 1
                        continue
                if size == self.lower or while_decided:
                    return
                step *= 2
        except OutOfBudget as spent:
            self._stop = spent.stop

    def _decide(self, size: int, budget: Budget) -> bool:
        """Decide whether a cut within the budget leaves groups of at most this size; return whether it is decided."""
        if size < self._network.size.max():
            self._raise(int(self._network.size.max()), COUNTED)
            return True
        search = CutSearch(self._network, size, budget, target=self.threat.alpha_c)
        stop = search.run()
        if search.lower > self.threat.alpha_c:
            self._raise(
                size + 1, f"more than {self.threat.alpha_c} links must be cut for groups of {size}: {search.reason}"
            )
            return True
        if search.upper <= self.threat.alpha_c:
            self._take(search.label)
            return True
        if stop is Stop.NODES and search.limit:
            self._limits = [search.limit]
            self._stop = stop
        return False

    def _raise(self, lower: int, reason: str) -> None:
        if lower > self.lower:
            self.lower, self.reason = min(lower, self.upper), reason
