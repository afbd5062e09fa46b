"""Certificates of fewest cuts: the network, prices of robots, and the tree that shows that they hold for all groups."""

from __future__ import annotations

import json
from contextlib import suppress
from typing import TYPE_CHECKING, Any

import numpy as np

from ratt_opt._files import write_atomically
from ratt_opt.attack.edge_cuts.cut_search import CutSearch, SearchParams
from ratt_opt.attack.edge_cuts.elimination import Elimination, TooManyStates
from ratt_opt.attack.edge_cuts.fewest import FewestCuts, cut_network, size_in_steps
from ratt_opt.attack.edge_cuts.kept_links import groups_above, proof_tree
from ratt_opt.attack.edge_cuts.listed import partition_that_keeps
from ratt_opt.budget import Budget, OutOfBudget
from ratt_opt.certificates.certification import CutsCertification
from ratt_opt.certificates.params import DEFAULT
from ratt_opt.certificates.verifier.cut_proofs import most_links_inside
from ratt_opt.certificates.verifier.edge_cuts import CUTS_FORMAT, VerifiedCuts, verify_cuts
from ratt_opt.errors import InputError, ProofError, UndecidedError
from ratt_opt.graph.largest_group.counting import LargestGroup

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping, Sequence
    from fractions import Fraction
    from pathlib import Path

    import networkx as nx

    from ratt_opt._validation import IntArray
    from ratt_opt.attack.edge_cuts.network import CutNetwork
    from ratt_opt.certificates.params import CertificateParams, CutProofParams
    from ratt_opt.graph.communication import CommunicationGraph, Link
    from ratt_opt.graph.threat import Threat

__all__ = ["certify_cuts", "certify_size_if_possible"]


def certify_cuts(
    graph: nx.Graph | CommunicationGraph,
    found: FewestCuts | LargestGroup,
    path: str | Path,
    *,
    weights: Mapping[Link, float] | str | None = None,
    sizes: Mapping[int, float] | Sequence[float] | str | None = None,
    protected_links: Iterable[Link] = (),
    time_limit: float | None = None,
    budget: Budget | None = None,
    params: CertificateParams = DEFAULT,
) -> VerifiedCuts:
    """Write the proof of the lower end that :func:`fewest_cuts` or :func:`smallest_largest_group` found, verified.

    Of a smallest largest group: more than ``found.alpha_c`` links must be cut for groups that are smaller by one. A
    proof counts links, has prices of robots, or lists the groups that prices leave, or eliminates robots one by one. If
    none of these proves the lower end in time, what prices prove is written.

    ``graph``, ``weights``, ``sizes``, ``protected_links`` : as for :func:`fewest_cuts`
    ``time_limit``, ``budget`` : seconds for writing and for verifying; an outer search's budget
    ``params`` : their ``cuts``, and the limits of the ``verifier``

    Raises
    ------
    InputError : as :func:`fewest_cuts`.
    ProofError : nothing is proved, or a proof is too long for a file or does not end in time.
    """
    together, own = list(protected_links), Budget.inside(budget, time_limit)
    if isinstance(found, LargestGroup) and (weights, sizes) != (None, None):
        raise InputError("weights", "and sizes must be absent for a smallest largest group", "given")
    network = cut_network(graph, weights, sizes, together)
    writer = _Writer(network, _room(network, found), own, params.cuts)
    try:
        proof = writer.of_size(found) if isinstance(found, LargestGroup) else writer.of_cuts(found)
    except OutOfBudget as out:
        raise ProofError(f"the proof does not end in {own.elapsed:.3g} s") from out
    joined = sorted({(min(link), max(link)) for link in together})
    links = sorted(network.links)
    document: dict[str, Any] = {
        "format": CUTS_FORMAT,
        "version": 1,
        "network": {
            "robots": network.graph.n_robots,
            "links": [list(link) for link in links],
            "weights": [network.links[link] for link in links],
            "sizes": network.sizes,
            "protected": [list(link) for link in joined],
            "scale": network.scale,
            "size_scale": network.size_scale,
        },
        "size": writer.room,
        **proof,
    }
    verified = verify_cuts(document, time_limit=max(own.seconds_left, params.cuts.seconds), limits=params.verifier)
    text = json.dumps(document, separators=(",", ":")) + "\n"
    write_atomically(path, lambda file: file.write_text(text, encoding="utf-8"))
    return verified


def certify_size_if_possible(
    threat: Threat,
    found: LargestGroup | None,
    path: Path,
    budget: Budget,
    params: CertificateParams = DEFAULT,
) -> CutsCertification:
    """:func:`certify_cuts` for the smallest largest group that a threat leaves, or why there is no certificate."""
    if found is None:
        return CutsCertification(why_not="the smallest largest group was not searched")
    together = threat.protected_links
    try:
        verified = certify_cuts(threat.graph, found, path, protected_links=together, budget=budget, params=params)
    except (InputError, ProofError, UndecidedError, MemoryError) as error:
        reason = "not enough memory" if isinstance(error, MemoryError) else str(error)
        return CutsCertification(why_not=reason)
    return CutsCertification(path=path, verified=verified)


def _room(network: CutNetwork, found: FewestCuts | LargestGroup) -> int:
    """Size of groups in steps of sizes, for which the lower end says that much must be cut.

    Raises ``ProofError`` : no partition has groups that small.
    """
    if isinstance(found, FewestCuts):
        return size_in_steps(network, found.size)
    if found.lower <= int(network.size.max()):
        why = "no group has less than one robot" if found.lower <= 1 else "protected links join that many robots"
        raise ProofError(f"there is nothing to prove: {why}")
    return found.lower - 1


class _Writer:
    """Proofs that links must be cut for groups of at most ``room``."""

    def __init__(self, network: CutNetwork, room: int, budget: Budget, params: CutProofParams) -> None:
        self.network, self.room, self._budget, self._params = network, room, budget, params

    def of_cuts(self, found: FewestCuts) -> dict[str, Any]:
        """A proof of the lower end, or of what prices prove."""
        network = self.network
        claim = round(found.lower * network.scale)
        prices = None if found.prices is None else self._steps(found.prices)
        if prices is not None and self._by_prices(prices) >= claim:
            return self._priced(prices)
        if proof := self._counted(claim):
            return proof
        if found.proved_by == "elimination":
            return self._eliminated(claim)
        if prices is None:
            search = CutSearch(network, self.room, self._budget)
            with suppress(OutOfBudget):
                search.raise_prices()
            prices = search.prices
        if prices is None:
            raise ProofError("no prices were proved: give more time")
        if found.proved_by == "listed groups" and (proof := self._listed(prices, claim)):
            return proof
        return self._priced(prices)

    def of_size(self, found: LargestGroup) -> dict[str, Any]:
        """A proof that more links than ``found.alpha_c`` must be cut.

        Raises ``ProofError`` : none is found.
        """
        network, claim = self.network, found.alpha_c + 1
        if proof := self._counted(claim):
            return proof
        is_large = network.n_nodes > SearchParams().priced_first
        if is_large and (proof := self._eliminated_if_few(claim)):
            return proof
        search = CutSearch(network, self.room, self._budget, target=found.alpha_c)
        search.run()
        if search.lower >= claim and search.prices is not None:
            if self._by_prices(search.prices) >= claim:
                return self._priced(search.prices)
            if proof := self._listed(search.prices, claim):
                return proof
        if not is_large and (proof := self._eliminated_if_few(claim)):
            return proof
        raise ProofError(f"neither prices nor elimination prove it: {found.reason}")

    def _steps(self, prices: Sequence[Fraction]) -> IntArray:
        """(n,) prices of nodes in units."""
        network = self.network
        own = [prices[robots[0]] * network.unit * network.scale for robots in network.members]
        return np.array([int(price) for price in own], dtype=np.int64)

    def _by_prices(self, prices: IntArray) -> int:
        return max(self.network.total - int(prices.sum()) // self.network.unit, 0)

    def _counted(self, claim: int) -> dict[str, Any] | None:
        """Say that groups of so few robots have few links inside, if that proves the claim."""
        network = self.network
        inside = most_links_inside(network.graph.n_robots, self.room // min(network.sizes))
        lightest = sorted(network.links.values())[: max(len(network.links) - inside, 0)]
        return {"claim": sum(lightest), "links_inside": inside} if sum(lightest) >= claim else None

    def _eliminated(self, claim: int) -> dict[str, Any]:
        return {"claim": claim, "order": Elimination(self.network).order()}

    def _eliminated_if_few(self, claim: int) -> dict[str, Any] | None:
        """An order of elimination, if it proves the claim within its limits."""
        elimination = Elimination(self.network)
        with suppress(TooManyStates):
            if elimination.least_cut(self.room, claim - 1, self._budget) is None:
                return {"claim": claim, "order": elimination.order()}
        return None

    def _priced(self, prices: IntArray) -> dict[str, Any]:
        """Prices, and the tree that proves them.

        Raises ``ProofError`` : it is too long.
        """
        tree = proof_tree(self.network, prices, self.room, self._params.numbers, self._budget)
        if tree is None:
            raise ProofError(f"the tree that proves the prices has more than {self._params.numbers:,} numbers")
        return {"claim": self._by_prices(prices), **self._with_tree(prices, tree)}

    def _with_tree(self, prices: IntArray, tree: IntArray) -> dict[str, Any]:
        return {"unit": self.network.unit, "prices": prices.tolist(), "tree": list(_nodes(tree))}

    def _listed(self, prices: IntArray, claim: int) -> dict[str, Any] | None:
        """Prices, the groups within their gap, and why no partition into these cuts less; ``None`` if too many."""
        network, need = self.network, self.network.total - claim + 1
        room = int(prices.sum()) - network.unit * need
        most = SearchParams().most_listed
        groups = groups_above(network, prices, self.room, -room - 1, most, self._budget)
        if room < 0 or not groups.is_complete:
            return None
        answer = partition_that_keeps(network, groups.groups, prices, need, self._budget)
        tree = proof_tree(network, prices, self.room, self._params.numbers, self._budget, -room - 1)
        if answer.label is not None or tree is None:
            return None
        levels = [
            {"prices": level.prices.tolist(), "triples": [[*triple, price] for triple, price in level.triples]}
            for level in answer.levels
        ]
        return {"claim": claim, **self._with_tree(prices, tree), "levels": levels}


def _nodes(tree: IntArray) -> Iterator[dict[str, Any]]:
    """The nodes that the search wrote as integers: 1 and the robot of a split, or 2 and a leaf."""
    numbers, at = tree.tolist(), 0
    while at < len(numbers):
        if numbers[at] == 1:
            yield {"split": numbers[at + 1]}
            at += 2
            continue
        multiplier, count = numbers[at + 1 : at + 3]
        yield {"multiplier": multiplier, "parts": numbers[at + 3 : at + 3 + 2 * count]}
        at += 3 + 2 * count
