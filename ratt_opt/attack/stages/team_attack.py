"""One attack on one plan, by values alone: what the schedule depends on, and what each stage asks."""

from __future__ import annotations

from math import comb, isinf
from typing import TYPE_CHECKING

import numpy as np

from ratt_opt.attack.edge_cuts.smallest import largest_group_of
from ratt_opt.attack.stages.any_function import annealed_attacks, any_bound, exchange_attack
from ratt_opt.attack.stages.attack_tree import AttackTree, try_every_attack
from ratt_opt.attack.thresholds.all_sets import LARGEST_VALUED, AllSets, can_enumerate_subsets
from ratt_opt.budget import Stop
from ratt_opt.graph.few_cuts import MOST_ATTACKS, attacks_are_few
from ratt_opt.problem import Attack

if TYPE_CHECKING:
    from ratt_opt.attack.task import AttackTask, Resumable

__all__ = ["TeamAttack", "last_stage"]


def last_stage(task: AttackTask, search: Resumable) -> Stop:
    """Run a search, begun or new, that goes on where the memory finds it."""
    search.task, task.memory.search = task, search
    return search.run()


class TeamAttack:
    """Conditions and steps of the schedule's rows for any set function.

    ``is_inner`` : another search asks, or nodes are limited
    """

    def __init__(self, task: AttackTask, *, is_inner: bool) -> None:
        self.task, self.is_inner, self._threat = task, is_inner, task.problem.threat
        self._is_limited = not isinf(min(task.budget.seconds_left, task.budget.evaluations_left))
        self._has_table = can_enumerate_subsets(task)

    # -- what the schedule asks ----------------------------------------------------------------------------------

    def counts_robots(self) -> bool:
        """No robot to blind, all robots alike: a group is worth what their number says."""
        return self._threat.n_blinded == 0 and self.task.problem.objective.are_alike(self.task.values.plan)

    def is_valued_at_once(self) -> bool:
        """More than 20 robots, or a limit."""
        return self.task.problem.n_robots > LARGEST_VALUED or self._is_limited

    def has_few_attacks(self) -> bool:
        """More robots, at most 20,000 attacks, links not all alike."""  # else sizes of groups are fewer still
        return not self._threat.links_alike and attacks_are_few(self._threat)

    def has_few_attacks_by_value(self) -> bool:
        """More than 20 robots, at most 20,000 attacks; or no link attacks, fewer blinded sets than half a table."""
        n_robots, threat = self.task.problem.n_robots, self._threat
        if threat.n_cut == 0:
            free = n_robots - len(threat.protected_robots)
            blinded = sum(comb(free, k) for k in range(threat.n_blinded + 1))
            return bool(blinded <= min(MOST_ATTACKS, 2 ** (n_robots - 1)))
        return n_robots > LARGEST_VALUED and self.has_few_attacks()

    def anneals_values(self) -> bool:
        """A limit, too many sets for a table, no other search asks."""
        return self._is_limited and not (self._has_table or self.is_inner)

    def has_a_table(self) -> bool:
        """Team of at most 20 robots, and values left for all sets."""
        return self._has_table

    def is_limited(self) -> bool:
        """A limit."""
        return self._is_limited

    def is_limited_and_inner(self) -> bool:
        """A limit, another search asks."""
        return self._is_limited and self.is_inner

    # -- the stages ----------------------------------------------------------------------------------------------

    def smallest_largest_group(self) -> None:
        """The smallest largest group, by prices of fewest cuts."""
        is_brief = self.is_inner and isinf(self.task.budget.seconds_left)
        most = self.task.params.criterion.inner_nodes if is_brief else None
        with self.task.budget.stage(max_nodes=most) as part:
            found = largest_group_of(self._threat, part)
            self.task.offer(Attack(links=found.cut))
            fewest = np.arange(self.task.values.n) < found.lower
            self.task.bracket.raise_lower(float(self.task.values.evaluate(fewest[None])[0]))

    def singles(self) -> None:
        """Raise the lower bound by single robots and their marginals."""
        any_bound(self.task)

    def exchanges(self) -> None:
        """Greedy steps, then exchanges."""
        exchange_attack(self.task)

    def annealed_values(self) -> None:
        """Attacks annealed by values alone."""
        annealed_attacks(self.task)

    def every_attack(self) -> Stop:
        """Every attack, valued one by one."""
        return try_every_attack(self.task)

    def defer_branch_and_bound(self) -> Stop:
        """Keep a branch and bound in the memory; the next call continues it."""
        self.task.budget.check()
        self.task.memory.search = AttackTree(self.task)
        return self.task.budget.stop() or Stop.HEURISTIC

    def tree_of_attacks(self) -> Stop:
        """Branch and bound over all attacks."""
        self.task.budget.check()
        return last_stage(self.task, AttackTree(self.task))

    def thresholds(self) -> Stop:
        """All sets of robots, thresholds one after the other."""
        begun = self.task.memory.search
        return last_stage(self.task, begun if isinstance(begun, AllSets) else AllSets(self.task))
