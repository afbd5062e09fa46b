"""Worst attacks on incomplete graphs and with protected links: what is asked, and what of the budget each has."""

from __future__ import annotations

from dataclasses import replace
from math import isinf
from typing import TYPE_CHECKING

from ratt_opt.attackers.annealed_values import anneal_for_a_share
from ratt_opt.attackers.attack_tree import AttackTree
from ratt_opt.attackers.by_size.relaxed_teams import possible_sizes_bound
from ratt_opt.attackers.first_bound import first_bound
from ratt_opt.attackers.forced_group import forced_group_bound
from ratt_opt.attackers.tree_bound import tree_bound
from ratt_opt.graph.largest_group.spreading import forced_size
from ratt_opt.graph.threshold import LARGEST_COMPILED
from ratt_opt.setfunctions.information import InformationObjective
from ratt_opt.stopping import Stop

if TYPE_CHECKING:
    from ratt_opt.attackers.by_prices.price_search import PriceSearch
    from ratt_opt.attackers.task import AttackTask, Resumable
    from ratt_opt.attackers.weakest_set.packed_team import PackedTeam
    from ratt_opt.graph.separable_groups import SeparableGroups
    from ratt_opt.problem import Problem

__all__ = ["any_graph", "last_stage"]

TREE_SHARE, TREES_SHORT, BOUND_SHARE, BOUND_NODES = 0.025, (0.05, 0.5), 0.3, 500_000
"""Of what is left of the budget for tree inequalities, which on dense graphs are not asked: there they used up their
share and proved nothing; of a short search more, up to so many seconds, as the first threshold is half-way up from
what they prove; then, and at most so many nodes, for the weakest group of the forced size; prices get the rest.
Measured at 100 robots of disk-6 and of a small world: trees prove 79 and 63 % of the attack in a minute, prices
75 % in a second. What they say of sizes counts more: on disk-12 of 50 robots, (10, 45), a group that keeps 18 is known
after two seconds, 17 after one, and bounds of sizes say 97.2 instead of 96.6 % with it."""

PARTITIONED = 10_000
"""Groups up to which their partitions are searched without prices. Where they are few an attack mostly leaves one large
group, and what each of them needs blinded is another long proof (hubs of 30 robots, (6, 16): 3,300 groups, 0.1 s each);
where they are many, some dozens of these proofs say enough of all: the small world of 24 robots with a third blinded
closes in 2 instead of 9 s, annealing and listing included."""

SOON_SHARE, SOON_NODES = 0.2, 200_000
"""Of what is left for partitions of few groups before attacks are annealed: about a second, within which most close.
Hubs of 50 robots, (24, 9), had an attack after two minutes that was 0.13 % milder than what any start finds; so few
starts are enough."""

FIRST_STARTS, INNER_STARTS, STARTS_FOR = 18, 3, 24
"""Annealed attacks before the first threshold, and where only nodes limit or another search sets no time: about every
fourth start finds the best attack of 24 robots where it is hardest to find (small worlds and hubs, a third blinded).
The first grow with the square of the robots beyond these 24: half a second of them at 24 robots, 1.4 s at 30."""

INNER_NODES = 500_000
"""Of the search by prices where another search asks and nothing is limited: some ten seconds. Rankings attack dozens of
teams, none of which need ever close."""

FIRST_ASKED, ASKED_SHARE = 0.1, 0.5
"""Of the seconds left to ask of each weak set, where they are few, whether an attack can leave it: slow and sure. The
second on dense graphs after partitions, or where these are not searched. Two dense graphs, of 24 and 30 robots, were
left open by 0.1 % where sizes and sets had a fifth together; with a half at first, a disk of mean degree 12 that
partitions close in two seconds waited for 15."""

LOOKS_FROM = 2.0
"""Seconds left from which possible sizes are looked at on sparse graphs, too: of one second they took a fifth, at 30 to
50 robots, and raised the lower end from 0.80 to 0.83 of the attack, where the first threshold is at 0.9."""

DENSE, SPLIT_SHARE, SPLIT_NODES = 0.5, 0.2, 10_000_000
"""Share of all links from which partitions have but a share of the seconds, and at most so many nodes (some seconds),
after possible sizes and before prices: a disk of 24 robots and mean degree 12 closes in 0.5 s by partitions, and not in
30 by prices; a random graph with 0.7 of all links in 6 s by sizes and prices, and not in 60 by partitions."""


def any_graph(task: AttackTask, team: PackedTeam | None, groups: SeparableGroups | None, *, is_brief: bool) -> Stop:
    """Partitions where groups are few; else annealing, bounds of sizes, on dense graphs partitions too, prices."""
    is_dense = _is_dense(task.problem) and not is_brief and task.problem.n_robots > LARGEST_COMPILED
    if team is not None and groups is not None and not is_dense:
        return _listed(task, team, groups, is_brief=is_brief)
    if is_brief and task.budget.max_nodes is None:
        task.budget.max_nodes = task.budget.nodes + INNER_NODES
    if team is not None and is_dense and _closed_by_sizes(task, team, 0, asked=0.0):
        return Stop.CLOSED
    least = _by_trees(task, is_brief=is_brief)
    prices = _price_search(task) if task.budget.stop() is None else None
    if prices is None:
        return _without_prices(task, team, least)
    prices.anneal(INNER_STARTS if is_brief else _starts(task.problem))
    # On sparse graphs they prove less than the first threshold; of targets in three coordinates and more only their
    # number is used, which proves nothing there.
    looks = not is_brief and (is_dense or (team is not None and task.budget.seconds_left > LOOKS_FROM))
    asked = ASKED_SHARE if is_dense and groups is None else FIRST_ASKED
    if _closed_by_sizes(task, team, least, looks=looks, asked=asked):
        return Stop.CLOSED
    if team is not None and groups is not None and _closed_by_partitions(task, team, groups, least):
        return Stop.CLOSED
    return last_stage(task, prices)


def _without_prices(task: AttackTask, team: PackedTeam | None, least: int) -> Stop:
    """Where a criterion has no compiled code: the forced size, and within a limit annealing and all attacks."""
    stop = forced_group_bound(task, team, least)
    if stop is Stop.CLOSED or isinf(task.budget.seconds_left):
        return stop
    anneal_for_a_share(task)
    return last_stage(task, AttackTree(task))


def _listed(task: AttackTask, team: PackedTeam, groups: SeparableGroups, *, is_brief: bool) -> Stop:
    """Where all groups are listed: partitions of few, prices of many on graphs that are not dense."""
    if forced_group_bound(task, team) is Stop.CLOSED:
        return Stop.CLOSED
    is_many = len(groups.masks) > PARTITIONED and not _is_dense(task.problem)
    search = _group_search(task, team, groups, is_many=is_many)
    if not is_many:
        with task.budget.stage(SOON_SHARE, max_nodes=SOON_NODES) as part:
            search.task = replace(task, budget=part)
            search.run()
    if not task.bracket.is_closed and (prices := _price_search(task)) is not None:
        prices.anneal(_starts(task.problem) if is_many and not is_brief else INNER_STARTS)
    return last_stage(task, search)


def _closed_by_partitions(task: AttackTask, team: PackedTeam, groups: SeparableGroups, least: int) -> bool:
    """Whether partitions within their share close it, or the weak sets of possible sizes, asked one by one again."""
    with task.budget.stage(SPLIT_SHARE, max_nodes=SPLIT_NODES) as part:
        _group_search(replace(task, budget=part), team, groups, is_many=False).run()
    return task.bracket.is_closed or _closed_by_sizes(task, team, least)


def _group_search(task: AttackTask, team: PackedTeam, groups: SeparableGroups, *, is_many: bool) -> Resumable:
    if is_many:
        from ratt_opt.attackers.by_covers.cover_search import CoverSearch  # compiles

        return CoverSearch(task, team, groups)
    from ratt_opt.attackers.by_partition.split_search import SplitSearch  # compiles

    return SplitSearch(task, team, groups)


def _starts(problem: Problem) -> int:
    return int(FIRST_STARTS * max(problem.n_robots / STARTS_FOR, 1.0) ** 2)


def last_stage(task: AttackTask, search: Resumable) -> Stop:
    """Run a search, begun or new, that goes on where the memory finds it."""
    search.task, task.memory.search = task, search
    return search.run()


def _closed_by_sizes(
    task: AttackTask, team: PackedTeam | None, least: int, *, looks: bool = True, asked: float = ASKED_SHARE
) -> bool:
    """Whether groups of possible sizes, where one ``looks`` at them, or the weakest of the forced size close it.

    ``asked`` : share of the seconds to ask of each weak set whether an attack can leave it
    """
    if looks:
        least = possible_sizes_bound(task, team, least, asked=asked)
    if not task.bracket.is_closed:
        with task.budget.stage(BOUND_SHARE, max_nodes=BOUND_NODES) as part:
            forced_group_bound(replace(task, budget=part), team, least)
    return task.bracket.is_closed


def _is_dense(problem: Problem) -> bool:
    return 2 * len(problem.communication.links) >= DENSE * problem.n_robots * (problem.n_robots - 1)


def _by_trees(task: AttackTask, *, is_brief: bool) -> int:
    """Seeing robots that some group is forced to keep, by tree inequalities; the bracket knows what that is worth."""
    objective, threat, (share, seconds) = task.problem.objective, task.problem.threat, TREES_SHORT
    part = task.budget.part(TREE_SHARE, at_least=min(share * task.budget.seconds_left, seconds))
    assert isinstance(objective, InformationObjective)
    size = forced_size(threat, part, threat.graph.n_robots)
    task.bracket.raise_lower(first_bound(objective, task.values.plan, threat, size))
    if not is_brief and not _is_dense(task.problem):
        task.bracket.raise_lower(tree_bound(objective, task.values.plan, threat, part, task.bracket.upper))
    task.budget.check()
    return size


def _price_search(task: AttackTask) -> PriceSearch | None:
    """The search by prices, new or begun, for criteria with compiled code."""
    from ratt_opt.attackers.by_prices.team import PricedTeam

    team = PricedTeam.of(task.problem.objective, task.values.plan)
    if team is None:
        return None
    from ratt_opt.attackers.by_prices.price_search import PriceSearch  # compiles

    begun = task.memory.search
    if isinstance(begun, PriceSearch):
        begun.task = task
        return begun
    return PriceSearch(task, team)
