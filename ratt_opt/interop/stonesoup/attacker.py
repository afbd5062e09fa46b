"""The worst that can happen to the sensors as they stand, and what is left of the team."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from ordered_set import OrderedSet
from stonesoup.base import Base, Property

from ratt_opt.attackers.exact import worst_case_attack
from ratt_opt.interop.stonesoup.manager import RobustSensorManager  # noqa: TC001  (a property's type)

if TYPE_CHECKING:
    from collections.abc import Iterable
    from datetime import datetime

    from ratt_opt.attackers.task import AttackResult
    from ratt_opt.interop.stonesoup.problem import Step

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
    """What an attack leaves: who is ``blinded``, which links are ``cut``, and the ``groups``, the best one first.

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

    def attack(self, tracks: Iterable[Any], timestamp: datetime) -> Aftermath:
        """The worst attack on the sensors as they stand, while they measure at ``timestamp``.

        Raises
        ------
        InputError : a budget is larger than the team, or sensors do not fit the tracks.
        """
        nodes = self.manager.nodes
        if not (tracks := list(tracks) if isinstance(tracks, (list, tuple)) else set(tracks)):
            everyone = SurvivingGroup(
                members=tuple(node.name for node in nodes), sensors=tuple(self.manager.sensors), value=0.0
            )
            return Aftermath(blinded=(), cut=(), groups=(everyone,), result=None)
        step = self.manager.step(nodes, tuple(((None,),) * len(node.actionables) for node in nodes), tracks, timestamp)
        result = worst_case_attack(step.problem, range(step.problem.n_robots), time_limit=self.time_limit)
        groups = step.problem.communication.groups(result.attack.links)
        left = [_surviving(step, group, group - result.attack.sensing) for group in groups]
        return Aftermath(
            blinded=tuple(step.names[i] for i in sorted(result.attack.sensing)),
            cut=tuple((step.names[i], step.names[j]) for i, j in sorted(result.attack.links)),
            groups=tuple(sorted(left, key=lambda group: -group.value)),
            result=result,
        )


def _surviving(step: Step, group: frozenset[int], seeing: frozenset[int]) -> SurvivingGroup:
    nodes = [step.nodes[i] for i in sorted(seeing) if i < len(step.nodes)]
    return SurvivingGroup(
        members=tuple(step.names[i] for i in sorted(group)),
        sensors=tuple(sensor for node in nodes for sensor in node.sensors),
        value=float(step.problem.objective(sorted(seeing))),
    )
