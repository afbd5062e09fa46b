"""Stages: families of groups by their sizes, on complete graphs."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ratt_opt.attack.size_vectors.size_vector_search import SizeVectorSearch, search_size_vectors
from ratt_opt.attack.stages.attack_state import AttackState
from ratt_opt.attack.staging import Share, Stage

if TYPE_CHECKING:
    from ratt_opt.attack.params import AttackParams
    from ratt_opt.budget import Stop

__all__ = ["SizeVectorsStage", "SpatialSizeVectorsStage"]


class SizeVectorsStage(Stage[AttackState]):
    """Stage for planar targets on a complete graph."""

    name = "size vectors"

    def applies(self, attack: AttackState) -> bool:
        """Planar targets, complete graph, no protected links."""
        return attack.team is not None and attack.threat.links_alike and attack.team.is_planar

    def run(self, attack: AttackState) -> Stop:
        """Families of groups by their sizes."""
        assert attack.team is not None
        return search_size_vectors(SizeVectorSearch(attack.task, attack.team))


class SpatialSizeVectorsStage(SizeVectorsStage):
    """Stage for targets that are not in the plane: bounds on their sets are weaker, so other stages get a part."""

    def applies(self, attack: AttackState) -> bool:
        """Other targets, complete graph, no protected links."""
        return attack.team is not None and attack.threat.links_alike and not attack.team.is_planar

    def share(self, params: AttackParams) -> Share:
        """Return a part that leaves time for other stages."""
        return Share(part=params.stages.spatial)
