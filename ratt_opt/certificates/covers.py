"""Proofs by dual prices that every attack leaves a group worth a threshold.

All groups that an attack may leave (``listed_columns.py``), or the attacker's search (``attack/dual_prices``) if there
are too many, give duals at which no group below the threshold costs less than nothing. Here they become integers, a
tree closes or lists the groups (``group_tree.py``), and if some are listed, a search shows that they do not partition
the team. Limits that were found with the duals have proofs of their own, if the tree names them.
"""

from __future__ import annotations

from contextlib import suppress
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np

from ratt_opt.attack.thresholds.pricing import Question
from ratt_opt.attack.thresholds.threshold_search import Threshold
from ratt_opt.budget import Budget, OutOfBudget
from ratt_opt.certificates.group_tree import group_tree, sets_proof
from ratt_opt.certificates.listed_columns import LinkDuals, duals_of_all_groups
from ratt_opt.certificates.plan_sets import NotClosedError
from ratt_opt.certificates.verifier.duals import ListedGroup
from ratt_opt.certificates.verifier.work import limited, seconds_left, tick
from ratt_opt.errors import UndecidedError
from ratt_opt.graph.communication import robots_of

if TYPE_CHECKING:
    from ratt_opt.attack.thresholds.pricing import PricingProblem
    from ratt_opt.certificates.group_tree import GroupTree, Limit
    from ratt_opt.certificates.plan_sets import PlanSets
    from ratt_opt.graph.threat import Threat

    Lemmas = tuple[GroupTree, dict[str, Any]]
    """A tree of groups, and the fields of the lemmas that it needs."""

__all__ = ["cover_proof"]


def cover_proof(sets: PlanSets, max_nodes: int) -> dict[str, Any]:
    """Return the record of a proof of the sets' threshold.

    Raises
    ------
    NotClosedError : no duals were found, a group is left, or a tree is too large.
    """
    threat, plan, params = sets.problem.threat, sets.plan, sets.params.covers
    duals, unit = duals_of_all_groups(plan, sets.threshold, params) or _searched_duals(plan, sets), params.unit
    robots, blinded = np.floor(duals.robots * unit).astype(np.int64), int(np.ceil(duals.blinded * unit))
    question = Question(sets.threshold, plan.robots, robots, blinded, 0, unit)
    slack = 2 * threat.alpha_c * unit - question.claim(threat.n_blinded)
    tree, lemmas = _shorter(sets, replace(question, limit=max(slack, -1)), duals.limits, max_nodes)
    record = {**lemmas, "duals": {"link": unit, "robots": question.duals.tolist(), "blinded": question.blinding}}
    record |= {"bounds": tree.bounds, "tree": tree.nodes}
    if slack < 0:
        return {"conclusion": "duals", **record}
    listed = [_listed(threat, question, *group) for group in tree.listed]
    return {"conclusion": "cover", **record, "partition": _partition(listed, threat, slack, params.partitions)}


def _searched_duals(plan: PricingProblem, sets: PlanSets) -> LinkDuals:
    """Find the duals with which the attacker's search refutes the threshold."""
    from ratt_opt.attack.thresholds.dual_prices import ThresholdDecision

    seconds = seconds_left()
    budget = Budget(None if seconds == np.inf else seconds)
    try:
        answer = ThresholdDecision(plan).decide(sets.threshold, budget, sets.params.covers.searched)
    except OutOfBudget:
        raise NotClosedError from None
    if answer.verdict is not Threshold.REFUTED or answer.prices is None:
        raise NotClosedError
    return LinkDuals(2 * answer.prices.robot, 2 * answer.prices.blinded, [])  # prices are about half links


def _shorter(sets: PlanSets, question: Question, limits: list[Limit], max_nodes: int) -> Lemmas:
    """The tree of groups with limits, or without: a limit may be about more robots than its cases, and so its proof.

    Raises
    ------
    NotClosedError : neither way closes or lists all groups, or both are too large.
    """
    if not limits:
        return _without_limits(sets, question, limits, max_nodes)
    try:
        with limited(sets.params.covers.with_limits * seconds_left()):
            tree, lemmas = _with_limits(sets, question, limits, max_nodes)
    except (NotClosedError, UndecidedError):
        return _without_limits(sets, question, limits, max_nodes)
    nodes = len(tree.nodes) + sum(1 + len(limit["tree"]) for limit in lemmas["limits"])
    with suppress(NotClosedError, UndecidedError), limited(sets.params.covers.shorter * seconds_left()):
        plain, lemma = _without_limits(sets, question, limits, min(nodes, max_nodes))
        if len(plain.nodes) + len(lemma["sets"]["tree"]) <= nodes:
            return plain, lemma
    return tree, lemmas


def _without_limits(sets: PlanSets, question: Question, limits: list[Limit], max_nodes: int) -> Lemmas:
    """Prove the threshold by one lemma: the smallest known size of which all sets reach it."""
    everyone = (1 << sets.plan.robots) - 1
    sizes = {sets.plan.most_below(sets.threshold), *(most for robots, most in limits if robots == everyone)}
    for most in sorted(sizes):
        try:
            lemma = sets_proof(sets, most + 1, max_nodes)
        except NotClosedError:
            continue
        return group_tree(sets, replace(question, most=most), max_nodes), {"sets": lemma}
    raise NotClosedError


def _with_limits(sets: PlanSets, question: Question, limits: list[Limit], max_nodes: int) -> Lemmas:
    """Prove the threshold by the tree's limits, each proved with those before; drop limits of too large proofs."""
    nobody = {"size": sets.plan.robots + 1, "tree": ["budget"]}
    everyone = (1 << sets.plan.robots) - 1, sets.plan.most_below(sets.threshold)
    limits = sorted({*limits, everyone}, key=lambda limit: (limit[0].bit_count(), limit))
    while True:
        tree = group_tree(sets, question, max_nodes, limits)
        proofs: dict[Limit, dict[str, Any]] = {}
        left = sets.params.covers.numbers - len(tree.nodes) - sum(len(bound["flow"]) for bound in tree.bounds)
        for robots, most in tree.used:
            with suppress(NotClosedError):
                proof = sets_proof(sets, most + 1, max(min(left, max_nodes), 0), robots, list(proofs))
                proofs[robots, most] = {"robots": list(robots_of(robots)), **proof}
                left -= len(proof["tree"])
        if len(proofs) == len(tree.used):
            return tree, {"sets": nobody, "limits": list(proofs.values())}
        limits = list(proofs)


def _listed(threat: Threat, question: Question, robots: int, need: int) -> ListedGroup:
    inside = [robots >> i & 1 for i in range(threat.graph.n_robots)]
    links = sum(inside[i] != inside[j] for i, j in threat.graph.links)
    need = max(need, 0)
    duals = sum(int(dual) for dual, is_in in zip(question.duals, inside, strict=True) if is_in)
    return ListedGroup(robots, question.unit * links + question.blinding * need - duals, need, links)


def _partition(groups: list[ListedGroup], threat: Threat, slack: int, max_nodes: int) -> list[int]:
    """The tree that shows that groups, as a verifier lists them, do not partition the team.

    Raises
    ------
    NotClosedError : they do, or the tree is too large.
    """
    alpha_c, most, robots = threat.alpha_c, threat.n_blinded, threat.graph.n_robots
    listed: dict[int, ListedGroup] = {}
    for group in groups:
        known = listed.get(group.robots)
        fits = group.cost >= 0 and _fits(group, slack, most, alpha_c)
        if fits and (known is None or known.need > group.need):
            listed[group.robots] = group
    having = [[group for group in listed.values() if group.robots >> i & 1] for i in range(robots)]
    tree: list[int] = []
    waiting = [((1 << robots) - 1, slack, most, 2 * alpha_c)]
    while waiting:
        tick()
        left, cost, blinded, links = waiting.pop()
        if not left or len(tree) > max_nodes:
            raise NotClosedError
        fitting = {
            i: [group for group in having[i] if not group.robots & ~left and _fits(group, cost, blinded, links)]
            for i in robots_of(left)
        }
        robot = min(fitting, key=lambda i: len(fitting[i]))
        tree.append(robot)
        for group in reversed(fitting[robot]):
            waiting.append((left & ~group.robots, cost - group.cost, blinded - group.need, links - group.links))
    return tree


def _fits(group: ListedGroup, cost: int, blinded: int, links: int) -> bool:
    return group.cost <= cost and group.need <= blinded and group.links <= links
