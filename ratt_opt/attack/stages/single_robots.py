"""Stages: bounds by single robots, and by their number if all are alike.

Some group keeps ``k`` unblinded robots (``forced_survivors``). By monotonicity it is worth at least the k-th smallest
individual value, and at least the strongest robot that cannot be blinded. More can be said of some set functions that
are known by their values alone. If theory proves the function submodular, every robot adds at least what it adds on top
of all others of the plan; if the function states a bound ``c`` on its total curvature, at least ``1 - c`` of its
individual value. The ``k`` least of these add up to a bound.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ratt_opt.attack.bounds import first_bound, forced_survivors, strongest_left
from ratt_opt.attack.edge_cuts.smallest import largest_group_of
from ratt_opt.attack.plan_parts import refuse_larger_gain
from ratt_opt.attack.stages.attack_state import AttackState
from ratt_opt.attack.staging import Stage
from ratt_opt.problem import Attack
from ratt_opt.setfunctions.metered import unmetered

if TYPE_CHECKING:
    from ratt_opt.attack.task import AttackTask


__all__ = ["CountedRobotsStage", "SingleRobotsStage", "SingleValuesStage"]


class SingleRobotsStage(Stage[AttackState]):
    """Stage that bounds a criterion by its single robots."""

    name = "single robots"

    def run(self, attack: AttackState) -> None:
        """Raise the lower bound by single robots and the forced size."""
        attack.task.bracket.raise_lower(first_bound(attack.objective, attack.task.values.plan, attack.threat))


class SingleValuesStage(Stage[AttackState]):
    """Stage that bounds any set function by its single robots."""

    name = "single robots"

    def applies(self, attack: AttackState) -> bool:
        """More than 20 robots, or a limit."""
        return attack.n_robots > attack.task.params.all_sets.valued or attack.is_limited

    def run(self, attack: AttackState) -> None:
        """Raise the lower bound by single robots and their marginals."""
        bound_by_values(attack.task)


def bound_by_values(task: AttackTask) -> None:
    """Raise the lower end by what singles and marginals prove; relies on a non-decreasing objective."""
    values, threat = task.values, task.problem.threat
    size, f = forced_survivors(threat), unmetered(task.problem.objective)
    nothing = values(())
    task.bracket.raise_lower(nothing)
    if size == 0:
        return
    single = values.singletons()
    task.bracket.raise_lower(max(strongest_left(single, threat), float(np.sort(single)[size - 1])))
    kept = 1.0 - f.most_total_curvature
    if kept > 0:
        task.bracket.raise_lower(nothing + kept * float(np.sort(single - nothing)[:size].sum()))
    if f.is_submodular:
        everyone = range(values.n)
        top = values(everyone) - values.evaluate(~np.eye(values.n, dtype=np.bool_))
        least = nothing + float(np.sort(np.maximum(top, 0.0))[:size].sum())
        if least > task.bracket.upper + f.least_improvement(least, terms=values.n):
            _refuse(task)
        task.bracket.is_submodular |= least > task.bracket.lower
        task.bracket.raise_lower(least)


def _refuse(task: AttackTask) -> None:
    """Show which element adds more to all others than to some that an attack leaves."""
    f, plan = unmetered(task.problem.objective), task.values.plan
    for group in task.problem.groups_left(task.bracket.attack):
        own = plan[sorted(group)]
        for k, element in enumerate(own.tolist()):
            refuse_larger_gain(f, plan[plan != element], own[:k], element)


class CountedRobotsStage(Stage[AttackState]):
    """Stage for robots that are all alike."""

    name = "smallest largest group"

    def applies(self, attack: AttackState) -> bool:
        """No robot to blind, all robots alike: a group is worth what their number says."""
        return attack.threat.n_blinded == 0 and attack.task.problem.objective.are_alike(attack.task.values.plan)

    def run(self, attack: AttackState) -> None:
        """The smallest largest group, by prices of fewest cuts."""
        task = attack.task
        most = task.params.criterion.inner_nodes if attack.is_brief else None
        with task.budget.stage(max_nodes=most) as part:
            found = largest_group_of(attack.threat, part)
            task.offer(Attack(links=found.cut))
            fewest = np.arange(task.values.n) < found.lower
            task.bracket.raise_lower(float(task.values.evaluate(fewest[None])[0]))
