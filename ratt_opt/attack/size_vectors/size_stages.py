"""Stages of an attack on a complete graph, by size vectors, in the order in which they run."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ratt_opt.attack.size_vectors.size_vector_search import SizeVectorSearch
from ratt_opt.attack.staging import Share, Stage, run_stages
from ratt_opt.budget import Stop

if TYPE_CHECKING:
    from ratt_opt.attack.params import AttackParams

__all__ = ["SIZE_STAGES", "search_size_vectors"]


class NobodyLeftStage(Stage[SizeVectorSearch]):
    """Stage for an attacker that may blind all robots."""

    name = "nobody left"

    def applies(self, attack: SizeVectorSearch) -> bool:
        """All robots may be blinded."""
        return attack.vectors == [()]

    def run(self, attack: SizeVectorSearch) -> Stop:
        """Blind every robot: none is left to sense."""
        attack.blind_everyone()
        return Stop.CLOSED


class FamilyExchangesStage(Stage[SizeVectorSearch]):
    """Stage that finds weak families of groups."""

    name = "exchanges of families"

    def run(self, attack: SizeVectorSearch) -> None:
        """The weakest families that exchanges find, of each vector or of some."""
        attack.exchange()


class WeakestOfForcedSizeStage(Stage[SizeVectorSearch]):
    """Stage that bounds by the weakest set of the forced size."""

    name = "forced size"

    def applies(self, attack: SizeVectorSearch) -> bool:
        """Size vectors too many for a list of all."""
        return not attack.has_all_vectors

    def share(self, params: AttackParams) -> Share:
        """Return a part that leaves time for annealing."""
        return Share(part=params.size_vectors.forced_share)

    def run(self, attack: SizeVectorSearch) -> None:
        """Some group has the forced size at least, so the weakest set of that size is a bound."""
        attack.weakest_of_forced_size()


class AnnealedOnStage(Stage[SizeVectorSearch]):
    """Stage that anneals until the end."""

    name = "annealed attacks"

    def applies(self, attack: SizeVectorSearch) -> bool:
        """Size vectors too many for a list of all."""
        return not attack.has_all_vectors

    def run(self, attack: SizeVectorSearch) -> None:
        """Annealed attacks as long as there is time."""
        attack.anneal()
        while np.isfinite(attack.task.budget.seconds_left):
            attack.anneal()


class AttackInHandStage(Stage[SizeVectorSearch]):
    """Stage that tests the attack in hand before lower thresholds."""

    name = "attack in hand"

    def applies(self, attack: SizeVectorSearch) -> bool:
        """No limit of time."""
        return not np.isfinite(attack.task.budget.seconds_left)

    def run(self, attack: SizeVectorSearch) -> None:
        """Test by size vectors whether any attack leaves less than the one in hand."""
        attack.test_attack()


class AttackInHandInTimeStage(AttackInHandStage):
    """Stage that tests the attack in hand within a part of the time."""

    def applies(self, attack: SizeVectorSearch) -> bool:
        """Limit of time."""
        return bool(np.isfinite(attack.task.budget.seconds_left))

    def share(self, params: AttackParams) -> Share:
        """Return a part that leaves time for lower thresholds."""
        return Share(part=params.size_vectors.first_share)


class AnnealedAlikeStage(Stage[SizeVectorSearch]):
    """Stage that changes sizes and robots together."""

    name = "annealed attacks"

    def applies(self, attack: SizeVectorSearch) -> bool:
        """Several groups about alike, limit of time."""
        return attack.is_about_families

    def share(self, params: AttackParams) -> Share:
        """Return a part that leaves time for thresholds."""
        return Share(part=params.size_vectors.annealed_share)

    def run(self, attack: SizeVectorSearch) -> None:
        """Annealed attacks, which change sizes and robots together."""
        attack.anneal()


class PricesOfSmallGroupsStage(Stage[SizeVectorSearch]):
    """Stage that asks dual prices if all groups may be small."""

    name = "dual prices"

    def applies(self, attack: SizeVectorSearch) -> bool:
        """Several groups about alike, none need have more than an eighth of the team, nobody blinded, limit of time."""
        return attack.is_about_families and attack.has_small_groups

    def share(self, params: AttackParams) -> Share:
        """Return a part that leaves time for thresholds."""
        return Share(part=params.size_vectors.prices_share)

    def run(self, attack: SizeVectorSearch) -> None:
        """Dual prices of robots and links, by thresholds."""
        attack.dual_prices()


class SizeThresholdsStage(Stage[SizeVectorSearch]):
    """Stage that decides thresholds by all vectors."""

    name = "thresholds"

    def run(self, attack: SizeVectorSearch) -> Stop:
        """Thresholds by vectors of sizes, and annealed attacks."""
        return attack.thresholds()


SIZE_STAGES: tuple[Stage[SizeVectorSearch], ...] = (
    NobodyLeftStage(),
    FamilyExchangesStage(),
    WeakestOfForcedSizeStage(),
    AnnealedOnStage(),
    AttackInHandInTimeStage(),
    AttackInHandStage(),
    AnnealedAlikeStage(),
    PricesOfSmallGroupsStage(),
    SizeThresholdsStage(),
)
"""Stages of an attack on a complete graph, by size vectors."""


def search_size_vectors(search: SizeVectorSearch) -> Stop:
    """Search every vector; the bracket is valid whenever this stops."""
    return run_stages(SIZE_STAGES, search) or search.task.budget.stop() or Stop.HEURISTIC
