"""Stages: every attack, if these are few."""

from __future__ import annotations

from itertools import chain, combinations, islice
from math import comb
from typing import TYPE_CHECKING

from ratt_opt.attack.stages.attack_state import AttackState
from ratt_opt.attack.staging import Share, Stage
from ratt_opt.budget import Stop
from ratt_opt.graph.communication import mask_of, membership, robots_of
from ratt_opt.graph.few_cuts import partitions_by_few_cuts
from ratt_opt.problem import Attack
from ratt_opt.setfunctions.base import checked_values
from ratt_opt.setfunctions.metered import unmetered

if TYPE_CHECKING:
    from ratt_opt.attack.params import AttackParams
    from ratt_opt.attack.task import AttackTask


__all__ = ["EveryAttackStage", "EveryValuedAttackStage", "enumerate_by_values"]


class EveryAttackStage(Stage[AttackState]):
    """Stage that tries every attack on a criterion: sparse networks and few cuts close by it with no gap at all."""

    name = "every attack"

    def applies(self, attack: AttackState) -> bool:
        """Links not all alike; at most 20,000 attacks, or 200,000 beyond 24 robots, not brief."""
        few, params = attack.has_table or attack.is_brief, attack.task.params.stages
        most = params.attacks if few else params.attacks_beyond
        return not attack.threat.links_alike and attack.threat.n_attacks <= most

    def share(self, params: AttackParams) -> Share:
        """Return a part that leaves time for other stages."""
        return Share(part=params.stages.every_attack)

    def run(self, attack: AttackState) -> None:
        """Every attack, valued in batches."""
        enumerate_by_values(attack.task)


class EveryValuedAttackStage(EveryAttackStage):
    """Stage that tries every attack on any set function."""

    def applies(self, attack: AttackState) -> bool:
        """More than 20 robots, at most 20,000 attacks; or no link attacks, fewer blinded sets than half a table."""
        n_robots, threat, params = attack.n_robots, attack.threat, attack.task.params
        if threat.n_cut == 0:
            free = n_robots - len(threat.protected_robots)
            blinded = sum(comb(free, k) for k in range(threat.n_blinded + 1))
            return bool(blinded <= min(params.stages.attacks, 2 ** (n_robots - 1)))
        is_large = n_robots > params.all_sets.valued and not threat.links_alike
        return is_large and threat.n_attacks <= params.stages.attacks

    def share(self, params: AttackParams) -> Share:  # noqa: ARG002
        """Return the whole budget."""
        return Share()


def enumerate_by_values(task: AttackTask) -> Stop:
    """Find the worst attack of a plan by trying all.

    If links can be cut it relies on a non-decreasing objective: then some worst attack uses its whole budgets.
    Otherwise all smaller sets of robots are blinded too. A robot blinded in one group leaves the others as they are, so
    each set of robots is valued once; many are valued in one batch.

    Raises
    ------
    OutOfBudget : the time is up, or no node is left; the bracket keeps the worst attack tried.
    """
    threat, plan, worth = task.problem.threat, task.values.plan, dict[int, float]()
    f, bracket = unmetered(task.problem.objective), task.bracket
    free = [1 << i for i in range(task.values.n) if i not in threat.protected_robots]
    sizes = [threat.n_blinded] if threat.n_cut else range(threat.n_blinded, -1, -1)
    for cut, groups in partitions_by_few_cuts(threat, task.budget):
        masks = list(map(mask_of, groups))
        every = map(sum, chain.from_iterable(combinations(free, size) for size in sizes))
        while some := list(islice(every, task.params.branching.at_once)):
            task.budget.check()
            left = [[group & ~blind for group in masks] for blind in some]
            new = list({group: None for parts in left for group in parts if group not in worth})
            worth.update(zip(new, checked_values(task.values, membership(new, task.values.n)).tolist(), strict=True))
            for blind, parts in zip(some, left, strict=True):
                if max(map(worth.__getitem__, parts)) < bracket.upper:
                    task.budget.evaluate(len(parts))  # valued alone: batches may round otherwise
                    value = max(f(plan[robots_of(group)]) for group in parts)
                    bracket.offer(Attack(frozenset(robots_of(blind)), cut), value)
    bracket.raise_lower(bracket.upper)
    return Stop.CLOSED
