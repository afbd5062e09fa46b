"""The worst that can happen to the sensors as they stand, and the rest of the team."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import networkx as nx
from ordered_set import OrderedSet
from stonesoup.base import Base, Property

from ratt_opt.attack.exact import worst_case_attack
from ratt_opt.interop.stonesoup.manager import RobustSensorManager  # noqa: TC001  (a property's type)
from ratt_opt.interop.stonesoup.network import Network

if TYPE_CHECKING:
    from collections.abc import Collection, Iterable
    from datetime import datetime

    from ratt_opt.attack.task import AttackResult
    from ratt_opt.interop.stonesoup.nodes import Node

__all__ = ["Aftermath", "SurvivingGroup", "WorstCaseAttacker"]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class SurvivingGroup:
    """Platforms and sensors that can still talk (``members``), and the ``sensors`` among them that still see.

    ``value`` : the criterion of what they tell together.
    """

    members: tuple[Any, ...]
    sensors: tuple[Any, ...]
    value: float

    def detections(self, truths: Iterable[Any], noise: Any = True) -> list[set[Any]]:
        """One set of detections for each sensor that still sees; give ``truths`` as a list for noise that repeats."""
        seen = OrderedSet(truths)
        return [set(sensor.measure(seen, noise=noise)) for sensor in self.sensors]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Aftermath:
    """Team after an attack: who is ``blinded``, which links are ``cut``, and the ``groups``, the best one first.

    Blinded platforms and sensors stay members of their group: they detect nothing but still relay. ``result`` is
    the bracket of the attack, ``None`` if there was no track to hurt.
    """

    blinded: tuple[Any, ...]
    cut: tuple[tuple[Any, Any], ...]
    groups: tuple[SurvivingGroup, ...]
    result: AttackResult | None

    @property
    def best(self) -> SurvivingGroup:
        """The group whose sensors tell most."""
        return self.groups[0]


class WorstCaseAttacker(Base):
    """Blind sensors and cut links so that the best group left knows least, within the manager's budgets.

    The attacker knows the tracks and where the sensors look. The sensors' actions may come from any manager: carry them
    out (``add_actions``, ``act``) before asking for the attack.
    """

    manager: RobustSensorManager = Property(doc="Says who is in the team, their links, the budgets and the criterion.")
    time_limit: float = Property(default=None, doc="Seconds for an attack; None: until it is proved to be the worst.")

    def attack(self, tracks: Collection[Any], timestamp: datetime) -> Aftermath:
        """The worst attack on the sensors as they stand, while they measure at ``timestamp``.

        Raises
        ------
        InputError : a budget is larger than the team, or sensors do not fit the tracks.
        """
        nodes = self.manager.nodes
        if not tracks:
            network = Network.of(self.manager.graph, nodes)
            names = (*(node.name for node in nodes), *network.relays)
            groups = [range(len(names))] if network.graph is None else nx.connected_components(network.graph)
            left = [_surviving(names, nodes, sorted(group), sorted(group), 0.0) for group in groups]
            return Aftermath(blinded=(), cut=(), groups=tuple(left), result=None)
        as_they_stand = tuple(((None,),) * len(node.actionables) for node in nodes)
        step = self.manager.step(nodes, as_they_stand, tracks, timestamp)
        result = worst_case_attack(step.problem, range(step.problem.n_robots), time_limit=self.time_limit)
        left = []
        for group in step.problem.communication.groups(result.attack.links):
            seeing = sorted(group - result.attack.sensing)
            left.append(_surviving(step.names, nodes, sorted(group), seeing, step.problem.objective(seeing)))
        return Aftermath(
            blinded=tuple(step.names[i] for i in sorted(result.attack.sensing)),
            cut=tuple((step.names[i], step.names[j]) for i, j in sorted(result.attack.links)),
            groups=tuple(sorted(left, key=lambda group: -group.value)),
            result=result,
        )


def _surviving(
    names: tuple[Any, ...], nodes: tuple[Node, ...], group: list[int], seeing: list[int], value: float
) -> SurvivingGroup:
    return SurvivingGroup(
        members=tuple(names[i] for i in group),
        sensors=tuple(sensor for i in seeing if i < len(nodes) for sensor in nodes[i].sensors),
        value=float(value),
    )
