"""Parameters of the search for best plans: one frozen class for each algorithm, together in :class:`MaxMinParams`.

They decide how soon a plan is found and a bracket closes, never whether a bracket holds.
"""

from __future__ import annotations

from dataclasses import dataclass, field

from ratt_opt._params import check_at_least_one
from ratt_opt.errors import InputError
from ratt_opt.setfunctions.decomposition import PartBounds
from ratt_opt.solvers.maxmin.params.coverage import CoverageParams
from ratt_opt.solvers.maxmin.params.depth import (
    CoverSearchParams,
    DepthParams,
    LevelParams,
    MarginalParams,
    SeparationParams,
)
from ratt_opt.solvers.maxmin.params.plans import (
    AdversaryParams,
    FewPlansParams,
    IncumbentParams,
    KickParams,
    OutcomeListParams,
    TieParams,
    WatcherParams,
)
from ratt_opt.solvers.maxmin.params.rows import RowParams
from ratt_opt.solvers.maxmin.params.trees import (
    CutRoundParams,
    DivisionParams,
    GroupProofParams,
    RestartParams,
    SmallGroupParams,
)
from ratt_opt.solvers.maxmin.params.values import (
    FirstPlanParams,
    PartRowParams,
    RegionParams,
    RowTreeParams,
    ValueCheckParams,
    ValueTurnParams,
    ValueWalkParams,
)

__all__ = [
    "DEFAULT",
    "AdversaryParams",
    "CoverSearchParams",
    "CoverageParams",
    "CutRoundParams",
    "DepthParams",
    "DivisionParams",
    "FewPlansParams",
    "FirstPlanParams",
    "GroupProofParams",
    "IncumbentParams",
    "KickParams",
    "LevelParams",
    "MarginalParams",
    "MaxMinParams",
    "OutcomeListParams",
    "PartRowParams",
    "RegionParams",
    "RestartParams",
    "RowParams",
    "RowTreeParams",
    "SeparationParams",
    "SmallGroupParams",
    "TieParams",
    "ValueCheckParams",
    "ValueTurnParams",
    "ValueWalkParams",
    "WatcherParams",
    "or_default",
]


AT_LEAST_ONE = (
    "walk.fewest", "walk.back", "rounds.cuts", "rounds.targets", "group_proofs.steps", "restarts.later",
    "restarts.growth", "depth.slice", "depth.growth", "levels.runs", "levels.growth", "marginals.run",
    "marginals.room", "marginals.sets", "covers.run", "covers.room", "rows.most", "coverage.information",
    "value_walk.most_robots", "value_turns.nodes", "value_turns.growth", "part_rows.rows",
)  # fmt: skip
"""Parameters without which a search would not go on, or not end."""


@dataclass(frozen=True, slots=True, kw_only=True)
class MaxMinParams:
    """Parameters of one search for the best plan, algorithm by algorithm; ``replace`` changes some.

    ``solve_maxmin(..., params=params)`` uses them, and ``ratt-opt bound --params FILE`` reads them from ``[search]``.
    """

    outcomes: OutcomeListParams = field(default_factory=OutcomeListParams)
    adversary: AdversaryParams = field(default_factory=AdversaryParams)
    incumbent: IncumbentParams = field(default_factory=IncumbentParams)
    walk: KickParams = field(default_factory=KickParams)
    ties: TieParams = field(default_factory=TieParams)
    watchers: WatcherParams = field(default_factory=WatcherParams)
    few_plans: FewPlansParams = field(default_factory=FewPlansParams)
    rounds: CutRoundParams = field(default_factory=CutRoundParams)
    division: DivisionParams = field(default_factory=DivisionParams)
    group_proofs: GroupProofParams = field(default_factory=GroupProofParams)
    small_groups: SmallGroupParams = field(default_factory=SmallGroupParams)
    restarts: RestartParams = field(default_factory=RestartParams)
    rows: RowParams = field(default_factory=RowParams)
    depth: DepthParams = field(default_factory=DepthParams)
    levels: LevelParams = field(default_factory=LevelParams)
    marginals: MarginalParams = field(default_factory=MarginalParams)
    covers: CoverSearchParams = field(default_factory=CoverSearchParams)
    separation: SeparationParams = field(default_factory=SeparationParams)
    coverage: CoverageParams = field(default_factory=CoverageParams)
    value_checks: ValueCheckParams = field(default_factory=ValueCheckParams)
    first_plans: FirstPlanParams = field(default_factory=FirstPlanParams)
    value_walk: ValueWalkParams = field(default_factory=ValueWalkParams)
    value_turns: ValueTurnParams = field(default_factory=ValueTurnParams)
    part_bounds: PartBounds = field(default_factory=PartBounds)
    part_rows: PartRowParams = field(default_factory=PartRowParams)
    regions: RegionParams = field(default_factory=RegionParams)
    row_tree: RowTreeParams = field(default_factory=RowTreeParams)

    def __post_init__(self) -> None:
        """Check what a search could not go on without. ``InputError`` : it is less than 1, or there is no level."""
        check_at_least_one(self, AT_LEAST_ONE)
        if 0.0 not in self.levels.shares:
            raise InputError("params.levels.shares", "must hold 0, the level of the best plan", self.levels.shares)


DEFAULT = MaxMinParams()
"""Parameters of searches that are not given any."""


def or_default(params: MaxMinParams | None) -> MaxMinParams:
    """Return the parameters, or those of searches that are not given any."""
    return DEFAULT if params is None else params
