"""Duration of attacks: renewed in every step, held for some steps, or failures that stay and add up."""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass
from typing import TYPE_CHECKING

from ratt_opt._validation import check_integer
from ratt_opt.errors import InputError
from ratt_opt.missions.world import Threatened
from ratt_opt.problem import Attack

if TYPE_CHECKING:
    import numpy as np

    from ratt_opt.scenario.model import Scenario

__all__ = ["ATTACK_MODELS", "AttackModel", "PermanentFailures", "PersistentAttacks", "RenewedAttacks", "attack_model"]


class AttackModel(ABC):
    """Attacks in force when a plan is made, and attacks that may follow; ``before`` : in force a step ago."""

    @abstractmethod
    def threatened(self, step: int, before: Attack, scenario: Scenario) -> Threatened:
        """Return the known failures at planning time, and the budgets to plan against."""

    def strikes(self, threatened: Threatened, links: int, rng: np.random.Generator) -> tuple[int, int]:  # noqa: ARG002
        """Return how many sensors and how many of the ``links`` may be hit now: all that the team plans against."""
        return threatened.alpha_s, threatened.alpha_c


@dataclass(frozen=True, slots=True)
class RenewedAttacks(AttackModel):
    """An attack ends with its step; the next step's may use the whole budgets again (the paper's)."""

    def threatened(self, step: int, before: Attack, scenario: Scenario) -> Threatened:  # noqa: ARG002
        """Return no failure and the whole budgets."""
        return Threatened(Attack(), scenario.alpha_s, scenario.alpha_c)


@dataclass(frozen=True, slots=True)
class PersistentAttacks(AttackModel):
    """An attack stays for ``hold`` steps and is then replaced by another. Meanwhile the team knows it, and none is
    added."""

    hold: int = 5

    def __post_init__(self) -> None:
        check_integer("hold", self.hold, low=1)

    def threatened(self, step: int, before: Attack, scenario: Scenario) -> Threatened:
        """All budgets if an attack begins, else what is in force and no more."""
        if step % self.hold == 0:
            return Threatened(Attack(), scenario.alpha_s, scenario.alpha_c)
        return Threatened(before, 0, 0)


@dataclass(frozen=True, slots=True)
class PermanentFailures(AttackModel):
    """Failures stay and add up until the budgets are spent. The team knows them and plans against the remaining
    budgets.

    In each step every working sensor fails with probability ``sensor_rate`` and every link with ``link_rate``. These
    draws say how many fail; the attacker chooses which.
    """

    sensor_rate: float = 0.02
    link_rate: float = 0.02

    def __post_init__(self) -> None:
        for name in ("sensor_rate", "link_rate"):
            if not 0 <= getattr(self, name) <= 1:
                raise InputError(name, "must be a probability in [0, 1]", getattr(self, name))

    def threatened(self, step: int, before: Attack, scenario: Scenario) -> Threatened:  # noqa: ARG002
        """Return the failures so far and the rest of the budgets."""
        left = max(scenario.alpha_s - len(before.sensing), 0), max(scenario.alpha_c - len(before.links), 0)
        return Threatened(before, *left)

    def strikes(self, threatened: Threatened, links: int, rng: np.random.Generator) -> tuple[int, int]:
        """A random number of those left."""
        sensors = int(rng.binomial(threatened.alpha_s, self.sensor_rate)) if threatened.alpha_s else 0
        cut = int(rng.binomial(links, self.link_rate))
        return sensors, min(cut, threatened.alpha_c)


ATTACK_MODELS: dict[str, type[RenewedAttacks] | type[PersistentAttacks] | type[PermanentFailures]] = {
    "renewed": RenewedAttacks,
    "persistent": PersistentAttacks,
    "permanent": PermanentFailures,
}


def attack_model(attacks: str | AttackModel) -> AttackModel:
    """The model of that name with its defaults, or the given one. InputError : there is none."""
    if isinstance(attacks, AttackModel):
        return attacks
    if attacks not in ATTACK_MODELS:
        raise InputError("attacks", f"must be {', '.join(ATTACK_MODELS)} or an AttackModel", attacks)
    return ATTACK_MODELS[attacks]()
