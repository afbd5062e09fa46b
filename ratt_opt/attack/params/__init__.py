"""Parameters of exact attacks: one frozen class for each algorithm, together in :class:`AttackParams`.

They decide how soon an attack is found and a bracket closes, never whether a bracket holds.
"""

from __future__ import annotations

from dataclasses import dataclass, field

from ratt_opt._params import check_at_least_one
from ratt_opt.attack.params import groups, least_sets, schedules, sizes
from ratt_opt.errors import InputError
from ratt_opt.graph.params import TreeParams

__all__ = ["DEFAULT", "AttackParams"]

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

    stages: schedules.StageParams = field(default_factory=schedules.StageParams)
    criterion: schedules.CriterionParams = field(default_factory=schedules.CriterionParams)
    value_annealing: schedules.ValueAnnealingParams = field(default_factory=schedules.ValueAnnealingParams)
    branching: schedules.BranchingParams = field(default_factory=schedules.BranchingParams)
    protection: schedules.ProtectionParams = field(default_factory=schedules.ProtectionParams)
    all_sets: groups.AllSetsParams = field(default_factory=groups.AllSetsParams)
    annealing: groups.AnnealingParams = field(default_factory=groups.AnnealingParams)
    bounds: groups.AttackBoundParams = field(default_factory=groups.AttackBoundParams)
    trees: TreeParams = field(default_factory=TreeParams)
    threshold: groups.ThresholdParams = field(default_factory=groups.ThresholdParams)
    pricing: groups.PricingParams = field(default_factory=groups.PricingParams)
    dual_prices: groups.DualPriceParams = field(default_factory=groups.DualPriceParams)
    master: groups.MasterParams = field(default_factory=groups.MasterParams)
    listed: groups.ListedParams = field(default_factory=groups.ListedParams)
    set_exchanges: least_sets.SetExchangeParams = field(default_factory=least_sets.SetExchangeParams)
    limits: least_sets.LimitParams = field(default_factory=least_sets.LimitParams)
    polytopes: least_sets.PolytopeParams = field(default_factory=least_sets.PolytopeParams)
    set_search: least_sets.SetSearchParams = field(default_factory=least_sets.SetSearchParams)
    ascent: least_sets.AscentParams = field(default_factory=least_sets.AscentParams)
    underestimator: least_sets.UnderestimatorParams = field(default_factory=least_sets.UnderestimatorParams)
    axis: least_sets.AxisParams = field(default_factory=least_sets.AxisParams)
    size_vectors: sizes.SizeVectorParams = field(default_factory=sizes.SizeVectorParams)
    family_exchanges: sizes.FamilyExchangeParams = field(default_factory=sizes.FamilyExchangeParams)
    largest_groups: sizes.LargestGroupParams = field(default_factory=sizes.LargestGroupParams)
    disjoint: sizes.DisjointParams = field(default_factory=sizes.DisjointParams)
    families: sizes.FamilyParams = field(default_factory=sizes.FamilyParams)
    family_bound: sizes.CoverParams = field(default_factory=sizes.CoverParams)
    possible_sizes: sizes.PossibleSizeParams = field(default_factory=sizes.PossibleSizeParams)

    def __post_init__(self) -> None:
        """Check what an attack could not go on without. ``InputError`` : it is less than 1."""
        check_at_least_one(self, AT_LEAST_ONE)
        for name in ("hot", "warm", "cold"):
            if not (value := getattr(self.value_annealing, name)) > 0:
                raise InputError(f"params.value_annealing.{name}", "must be positive", value)


DEFAULT = AttackParams()
"""Parameters of attacks that are not given any."""
