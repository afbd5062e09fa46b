"""Parameters of exact attacks: one frozen class for each algorithm, together in :class:`AttackParams`.

They decide how soon an attack is found and a bracket closes, never whether a bracket holds.
"""

from __future__ import annotations

from dataclasses import dataclass, field

from ratt_opt._params import check_at_least_one
from ratt_opt.attack.params.groups import (
    AllSetsParams,
    AnnealingParams,
    AttackBoundParams,
    DualPriceParams,
    ListedParams,
    MasterParams,
    PricingParams,
    ThresholdParams,
)
from ratt_opt.attack.params.least_sets import (
    AscentParams,
    AxisParams,
    LimitParams,
    PolytopeParams,
    SetExchangeParams,
    SetSearchParams,
    UnderestimatorParams,
)
from ratt_opt.attack.params.size_vectors import (
    CoverParams,
    DisjointParams,
    FamilyExchangeParams,
    FamilyParams,
    LargestGroupParams,
    PossibleSizeParams,
    SizeVectorParams,
)
from ratt_opt.attack.params.stages import (
    BranchingParams,
    CriterionParams,
    ProtectionParams,
    StageParams,
    ValueAnnealingParams,
)
from ratt_opt.errors import InputError
from ratt_opt.graph.params import TreeParams

__all__ = [
    "DEFAULT",
    "AllSetsParams",
    "AnnealingParams",
    "AscentParams",
    "AttackBoundParams",
    "AttackParams",
    "AxisParams",
    "BranchingParams",
    "CoverParams",
    "CriterionParams",
    "DisjointParams",
    "DualPriceParams",
    "FamilyExchangeParams",
    "FamilyParams",
    "LargestGroupParams",
    "LimitParams",
    "ListedParams",
    "MasterParams",
    "PolytopeParams",
    "PossibleSizeParams",
    "PricingParams",
    "ProtectionParams",
    "SetExchangeParams",
    "SetSearchParams",
    "SizeVectorParams",
    "StageParams",
    "ThresholdParams",
    "TreeParams",
    "UnderestimatorParams",
    "ValueAnnealingParams",
]

AT_LEAST_ONE = (
    "criterion.starts_for", "branching.at_once", "protection.at_once", "all_sets.block", "annealing.longer",
    "annealing.again", "bounds.largest_weight", "axis.intervals", "axis.bisections", "family_exchanges.stride",
    "size_vectors.of_each_size", "size_vectors.some_vectors",
)  # fmt: skip
"""Parameters without which an attack would not go on, or not end."""


@dataclass(frozen=True, slots=True, kw_only=True)
class AttackParams:
    """Parameters of one exact attack, algorithm by algorithm; ``replace`` changes some.

    ``worst_case_attack(..., params=params)`` uses them, and ``ratt-opt attack --params FILE`` reads them from TOML.
    """

    stages: StageParams = field(default_factory=StageParams)
    criterion: CriterionParams = field(default_factory=CriterionParams)
    value_annealing: ValueAnnealingParams = field(default_factory=ValueAnnealingParams)
    branching: BranchingParams = field(default_factory=BranchingParams)
    protection: ProtectionParams = field(default_factory=ProtectionParams)
    all_sets: AllSetsParams = field(default_factory=AllSetsParams)
    annealing: AnnealingParams = field(default_factory=AnnealingParams)
    bounds: AttackBoundParams = field(default_factory=AttackBoundParams)
    trees: TreeParams = field(default_factory=TreeParams)
    threshold: ThresholdParams = field(default_factory=ThresholdParams)
    pricing: PricingParams = field(default_factory=PricingParams)
    dual_prices: DualPriceParams = field(default_factory=DualPriceParams)
    master: MasterParams = field(default_factory=MasterParams)
    listed: ListedParams = field(default_factory=ListedParams)
    set_exchanges: SetExchangeParams = field(default_factory=SetExchangeParams)
    limits: LimitParams = field(default_factory=LimitParams)
    polytopes: PolytopeParams = field(default_factory=PolytopeParams)
    set_search: SetSearchParams = field(default_factory=SetSearchParams)
    ascent: AscentParams = field(default_factory=AscentParams)
    underestimator: UnderestimatorParams = field(default_factory=UnderestimatorParams)
    axis: AxisParams = field(default_factory=AxisParams)
    size_vectors: SizeVectorParams = field(default_factory=SizeVectorParams)
    family_exchanges: FamilyExchangeParams = field(default_factory=FamilyExchangeParams)
    largest_groups: LargestGroupParams = field(default_factory=LargestGroupParams)
    disjoint: DisjointParams = field(default_factory=DisjointParams)
    families: FamilyParams = field(default_factory=FamilyParams)
    family_bound: CoverParams = field(default_factory=CoverParams)
    possible_sizes: PossibleSizeParams = field(default_factory=PossibleSizeParams)

    def __post_init__(self) -> None:
        """Check what an attack could not go on without. ``InputError`` : it is less than 1."""
        check_at_least_one(self, AT_LEAST_ONE)
        for name in ("hot", "warm", "cold"):
            if not (value := getattr(self.value_annealing, name)) > 0:
                raise InputError(f"params.value_annealing.{name}", "must be positive", value)


DEFAULT = AttackParams()
"""Parameters of attacks that are not given any."""
