"""Answers to an instance: a plan, an attack or a cut, and their worth by exact means."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import networkx as nx

from ratt_opt._validation import check_integer, check_link
from ratt_opt.attack.exact import worst_case_attack
from ratt_opt.errors import InputError
from ratt_opt.problem import Attack

if TYPE_CHECKING:
    from ratt_opt._validation import IntArray
    from ratt_opt.benchmark.instances.instance import BenchmarkInstance

__all__ = ["AnswerWorth", "answer_of", "worth_of"]

FIELDS = {"plan": ("elements",), "attack": ("sensing", "links"), "cuts": ("cut",)}
"""Fields of an answer by the track."""


@dataclass(frozen=True, slots=True, kw_only=True)
class AnswerWorth:
    """Claim: the answer is worth at least ``lower`` and at most ``upper``."""

    lower: float
    upper: float


def answer_of(instance: BenchmarkInstance, document: dict[str, Any]) -> dict[str, Any] | None:
    """The answer that a line or a record holds, in plain numbers, or ``None`` if it has none.

    Raises
    ------
    InputError : it is not one element of each robot, no attack within the budgets, or no cut that leaves small groups.
    """
    names = FIELDS[instance.track]
    if all(document.get(name) is None for name in names):
        return None
    given = {name: document.get(name, []) for name in names}
    for name, value in given.items():
        if not isinstance(value, list):
            raise InputError(name, "must be a list", type(value).__name__)
    if instance.track == "plan":
        return {"elements": instance.team.check_plan(given["elements"]).tolist()}
    if instance.track == "attack":
        attack = attack_of(given)
        instance.team.check_attack(attack)
        return {"sensing": sorted(attack.sensing), "links": [list(link) for link in sorted(attack.links)]}
    links = sorted({_pair(link) for link in given["cut"]})
    _check_cut(instance, links)
    return {"cut": [list(link) for link in links]}


def attack_of(answer: dict[str, Any]) -> Attack:
    """The attack of an answer. InputError : it names no robots or links."""
    robots = frozenset(check_integer("sensing", i, low=0) for i in answer["sensing"])
    return Attack(robots, frozenset(_pair(link) for link in answer["links"]))


def worth_of(instance: BenchmarkInstance, answer: dict[str, Any], seconds: float) -> AnswerWorth:
    """Value an answer again: a plan by the exact attack within some seconds, others at once."""
    if instance.track == "plan":
        found = worst_case_attack(instance.team, answer["elements"], time_limit=seconds)
        return AnswerWorth(lower=found.lower, upper=found.upper)
    if instance.track == "attack":
        plan = only_plan(instance)
        value = instance.team.team_value(plan, attack_of(answer))
    else:
        weights = instance.network.weight_of
        value = float(sum(1 if weights is None else weights[_pair(link)] for link in answer["cut"]))
    return AnswerWorth(lower=value, upper=value)


def only_plan(instance: BenchmarkInstance) -> IntArray:
    """The plan of a team whose robots have one element each."""
    team = instance.team
    return team.check_plan([int(choice[0]) for choice in team.choices])


def _pair(link: Any) -> tuple[int, int]:
    i, j = check_link("link", tuple(link) if isinstance(link, list) else link)
    return min(i, j), max(i, j)


def _check_cut(instance: BenchmarkInstance, links: list[tuple[int, int]]) -> None:
    network = instance.network
    left = nx.Graph(network.graph)
    for link in links:
        if not left.has_edge(*link):
            raise InputError("cut", "must hold links of the network", list(link))
    left.remove_edges_from(links)
    sizes = network.sizes or (1,) * network.robots
    largest = max(sum(sizes[i] for i in group) for group in nx.connected_components(left))
    if largest > network.size:
        raise InputError("cut", f"must leave groups of at most {network.size}", largest)
