"""Whether an attack can leave a team less than a threshold.

An attack leaves groups that cover the team. It leaves less than the threshold if in each group blinding some robots
does, no more of them in all than ``alpha_s``, and if the groups are cut off by no more links than ``alpha_c``.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import inf
from typing import TYPE_CHECKING

import numpy as np

from ratt_opt.attack.columns import UNIT, Columns
from ratt_opt.attack.exact_cover import ExactCover
from ratt_opt.attack.master import best_duals

if TYPE_CHECKING:
    from ratt_opt.attack.sets_below import SetsBelow
    from ratt_opt.budget import Budget
    from ratt_opt.graph.group_list import GroupList
    from ratt_opt.graph.threat import Threat

__all__ = ["Answer", "decide"]

MOST_COLUMNS = 2_000_000
"""Within the gap, above which no cover is searched."""


@dataclass(frozen=True, slots=True)
class Answer:
    """Whether the threshold is reachable, ``None`` if that is left open.

    ``level``, ``following`` : if it is not, what every attack leaves at least, and bit mask of the set that is worth it
    ``groups``, ``blinded`` : if it is, bit masks of the groups, and of the blinded robots
    """

    is_reachable: bool | None
    level: float = inf
    following: int | None = None
    groups: tuple[int, ...] = ()
    blinded: int = 0


def decide(
    threat: Threat, below: SetsBelow, graph: GroupList, threshold: float, budget: Budget, *, steps: int
) -> Answer:
    """Ask ``below`` for the threshold, list columns, bound their master, and search covers within its gap.

    ``steps`` : of the search of covers, columns looked at

    Raises
    ------
    OutOfBudget : the time is up, nodes are spent, or the user interrupted.
    """
    budget.spend()
    groups, cuts = graph.all(budget)
    level, following = below.mark(threshold, budget)
    columns = Columns.of(groups, cuts, below, threat.n_blinded)
    most_cut = 2 * threat.alpha_c
    duals = best_duals(columns, threat.n_blinded, most_cut, budget).duals
    gap = most_cut * UNIT - duals.claim(threat.n_blinded)
    if gap < 0:
        return Answer(is_reachable=False, level=level, following=following)
    chosen = columns.within(duals, gap, MOST_COLUMNS)
    if chosen is None:
        return Answer(is_reachable=None)
    few, costs = chosen
    paid = np.column_stack([costs, few.blinded, few.cuts]).astype(np.int64)
    masks = few.groups[:, None].astype(np.uint64)
    places = ExactCover(few.robots, masks, paid, (gap, threat.n_blinded, most_cut)).next(budget, steps)
    if not isinstance(places, list):
        return Answer(is_reachable=places, level=level, following=following)
    covered = few.groups[places].tolist()
    blinded = sum(group ^ below.largest_inside(group) for group in covered)
    return Answer(is_reachable=True, groups=tuple(covered), blinded=blinded)
