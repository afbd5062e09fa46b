"""Stages: all groups that an attack may leave, listed."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ratt_opt.attack.stages.attack_state import AttackState
from ratt_opt.attack.staging import Share, Stage
from ratt_opt.attack.thresholds.listed_columns import ListedSearch
from ratt_opt.attack.thresholds.listed_size import listed_size_of
from ratt_opt.graph.group_list import LARGEST_MASK, MOST_CUT, groups_of

if TYPE_CHECKING:
    from ratt_opt.attack.params import AttackParams

__all__ = ["ListedColumnsAgainStage", "ListedColumnsStage", "ListedSizeStage"]


class ListedColumnsStage(Stage[AttackState]):
    """Stage that lists the groups before attacks are annealed for long."""

    name = "listed columns"

    def applies(self, attack: AttackState) -> bool:
        """Criterion compiled, at most 60 robots and 255 links to cut."""
        is_narrow = attack.n_robots <= LARGEST_MASK and attack.threat.alpha_c <= MOST_CUT
        return attack.search_by_prices is not None and is_narrow

    def share(self, params: AttackParams) -> Share:
        """Return a part that leaves time for annealing and prices."""
        return Share(part=params.stages.listed_soon, max_nodes=params.stages.listed_nodes)

    def run(self, attack: AttackState) -> None:
        """All groups that an attack may leave, if they are soon listed, and whether one leaves less than in hand."""
        task = attack.task
        assert attack.search_by_prices is not None
        assert attack.team is not None
        if attack.listed is None:
            listed = task.params.listed
            most, part = listed.brief if attack.is_brief else listed.most, task.budget.part(listed.share)
            groups = groups_of(attack.threat)
            if not groups.has_listed(most, part):
                return
            attack.listed = ListedSearch(task, attack.team, groups)
        if not attack.is_annealed:
            attack.search_by_prices.task = task
            attack.search_by_prices.anneal(task.params.listed.starts)
        attack.listed.task = task
        attack.listed.run()


class ListedColumnsAgainStage(ListedColumnsStage):
    """Stage that goes on with the listed columns once attacks are annealed."""

    def applies(self, attack: AttackState) -> bool:
        """Listed columns possible, limit of time, budget left."""
        return super().applies(attack) and attack.has_time_limit and attack.has_prices

    def share(self, params: AttackParams) -> Share:
        """Return a part that leaves time for prices."""
        return Share(part=params.stages.listed, max_nodes=params.stages.listed_nodes)


class ListedSizeStage(Stage[AttackState]):
    """Stage that raises the forced size by listed columns of robots that are all alike."""

    name = "listed size"

    def applies(self, attack: AttackState) -> bool:
        """Groups listed, budget left."""
        return attack.listed is not None and attack.has_prices

    def share(self, params: AttackParams) -> Share:
        """Return a part that leaves time for annealing and prices."""
        return Share(part=params.listed.share, max_nodes=params.stages.listed_nodes)

    def run(self, attack: AttackState) -> None:
        """Unblinded robots that every attack leaves in some group, by all groups that it may leave."""
        size = listed_size_of(attack.threat, attack.task.params)
        try:
            size.run(groups_of(attack.threat), attack.sure, attack.task.budget)
        finally:
            attack.sure = max(attack.sure, size.least)
