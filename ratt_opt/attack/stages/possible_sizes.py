"""Stage: lower bounds by size vectors where the graph is not complete, or has protected links.

- An attacker that may cut protected links too leaves no more.
- Sizes alone say which size vectors are possible on a graph (``graph/possible_sizes.py``). Groups of such sizes, with
  any robots in them, leave no more than any attack.
- If the sets below the attack in hand that a largest group may be are few, they are ruled out one by one, weakest
  first: with no blinded robots can they score what the other groups leave to be scored (``graph/link_scores.py``). The
  first that cannot be ruled out bounds every attack.

Relies on a non-decreasing objective. What is proved when the budget runs out is kept.
"""

from __future__ import annotations

from dataclasses import replace
from math import comb
from operator import itemgetter
from typing import TYPE_CHECKING

import numpy as np

from ratt_opt.attack.size_vectors.disjoint_sets import MOST_ROBOTS
from ratt_opt.attack.size_vectors.family_search import SetLists
from ratt_opt.attack.size_vectors.size_vector_search import SizeVectorSearch, search_size_vectors
from ratt_opt.attack.stages.attack_state import AttackState
from ratt_opt.attack.staging import Share, Stage
from ratt_opt.attack.task import AttackBracket
from ratt_opt.graph.link_scores import link_scores, scoring_group
from ratt_opt.graph.possible_sizes import PossibleSizes
from ratt_opt.problem import Attack

if TYPE_CHECKING:
    from ratt_opt.attack.params import AttackParams
    from ratt_opt.attack.task import AttackTask
    from ratt_opt.attack.team import Team
    from ratt_opt.graph.survivor_sizes import Sizes

__all__ = ["PossibleSizesStage"]


_SetValues = list[tuple[float, frozenset[int]]]


class PossibleSizesStage(Stage[AttackState]):
    """Stage that bounds dense graphs by the sizes that groups can have together."""

    name = "possible sizes"

    def applies(self, attack: AttackState) -> bool:
        """Dense graph, at most 100 robots, packed team, not brief."""
        return attack.may_have_sizes

    def share(self, params: AttackParams) -> Share:
        """Return a part that leaves time for prices."""
        return Share(part=params.stages.sizes)

    def run(self, attack: AttackState) -> None:
        """Groups of sizes that are possible on the graph; then the sets that one of them may be, one by one."""
        assert attack.team is not None
        attack.sure = possible_sizes_bound(attack.task, attack.team, attack.sure)


def possible_sizes_bound(task: AttackTask, team: Team, least: int) -> int:
    """Raise the lower end to the least that groups of possible sizes leave, then by each set below the attack in hand.

    ``least`` : unblinded robots that are known to be left in some group. Returns the same, by sizes too.

    Raises
    ------
    OutOfBudget : the time is up, or no node is left to begin with; the bracket keeps what was proved.
    """
    threat, budget, params = task.problem.threat, task.budget, team.params.possible_sizes
    possible = PossibleSizes(link_scores(threat.graph, threat.alpha_c, budget), threat.n_blinded, least)
    vectors = possible.vectors(budget, params.most_vectors)
    if vectors is None:
        return possible.forced
    with budget.stage(params.share, max_nodes=params.nodes) as part:
        _vectors_bound(replace(task, budget=part), team, vectors)
    if not task.bracket.is_closed:
        with budget.stage(1.0, max_nodes=params.nodes) as part:
            _sets_bound(replace(task, budget=part), team, possible)
    return vectors[0][0]


def _vectors_bound(task: AttackTask, team: Team, vectors: list[Sizes]) -> None:
    """Attack a complete graph by these size vectors; what that proves holds for the task, however it ends.

    Every attack leaves groups of unblinded robots of the sizes of a vector, or mergers of them.
    """
    problem, bracket = task.problem, task.bracket
    every_link = comb(problem.n_robots, 2)
    relaxed = replace(problem, graph=None, alpha_c=every_link, protected_links=frozenset())
    start = AttackBracket(bracket.attack, bracket.upper, bracket.lower, bracket.rounding)
    try:
        search_size_vectors(SizeVectorSearch(replace(task, problem=relaxed, bracket=start, records=[]), team, vectors))
    finally:
        bracket.raise_lower(min(start.lower, start.upper))


def _sets_below(task: AttackTask, team: Team, possible: PossibleSizes) -> _SetValues | None:
    """Every set below the goal of a size that a largest group may have, with its value; ``None`` if too many.

    If no set of a size is below the goal, no larger set is.
    """
    if task.problem.n_robots > MOST_ROBOTS:
        return None
    lists, sets = SetLists(team, np.argsort(-team.single, kind="stable")), list[tuple[float, frozenset[int]]]()
    for size in range(possible.forced, possible.n_seeing + 1):
        low = lists.of(size, task.bracket.goal, task.budget)
        if low is None or len(sets) + len(low.masks) > team.params.possible_sizes.most_sets:
            return None
        if not len(low.masks):
            break
        sets.extend(zip(low.values.tolist(), map(lists.robots, low.masks.tolist()), strict=True))
    return sorted(sets, key=itemgetter(0))


def _sets_bound(task: AttackTask, team: Team, possible: PossibleSizes) -> None:
    """Raise the lower end by asking of each set, weakest first, whether an attack can leave it as a largest group."""
    sets = _sets_below(task, team, possible)
    if sets is None:
        return
    bracket, budget = task.bracket, task.budget
    graph, n_robots = task.problem.threat.graph, task.problem.n_robots
    joining = {size: possible.largest(size) for size in {len(robots) for _, robots in sets}}
    for value, robots in sets:
        bracket.raise_lower(min(value, bracket.goal))
        members = np.isin(np.arange(n_robots), list(robots))
        for inside, needed in joining[len(robots)]:
            group = scoring_group(graph, members, inside, needed, budget)
            if group is not None:
                _offer(task, robots, frozenset(np.flatnonzero(group).tolist()))
                bracket.raise_lower(min(value, bracket.goal))
                return
    bracket.raise_lower(bracket.goal)


def _offer(task: AttackTask, seeing: frozenset[int], group: frozenset[int]) -> None:
    """Offer the attack that separates a group from the others and blinds those in it that are not ``seeing``.

    The rest of the budget blinds the strongest others.
    """
    problem, threat = task.problem, task.problem.threat
    single, blinded = task.values.singletons(), group - seeing
    others = sorted(frozenset(range(problem.n_robots)) - group - threat.protected_robots, key=lambda i: -single[i])
    blinded |= frozenset(others[: threat.n_blinded - len(blinded)])
    cut = problem.communication.links_between([group, frozenset(range(problem.n_robots)) - group])
    if len(cut) <= threat.alpha_c and not (cut & threat.protected_links or blinded & threat.protected_robots):
        task.offer(Attack(blinded, frozenset(cut)))
