"""Who is who in the proof: bait and greedy robots, what they chose, and the premises that follow.

Elements: ``b1`` is bait robot 1's choice, ``g1`` greedy robot 1's (in greedy order), ``o(b1)``
and ``o(g1)`` the compared (optimal) plan's for the same robot, ``h(g1)`` the individually best
control of greedy robot 1 (its would-be bait). Equal elements are a special case of distinct
ones: on sets with one element per robot a function cannot tell a copy from its original.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import combinations
from typing import TYPE_CHECKING

from ratt_opt.audit.engine.claim import Ground, Inequality, Linear

if TYPE_CHECKING:
    from collections.abc import Iterable

__all__ = ["Team", "optimum", "own_best", "worst_for"]


def optimum(robot: str) -> str:
    """Element the compared plan gives to ``robot`` (named by RATT's element)."""
    return f"o({robot})"


def own_best(robot: str) -> str:
    """Individually best element of ``robot``."""
    return f"h({robot})"


@dataclass(frozen=True, slots=True)
class Team:
    """``bait`` and ``greedy`` robots, the latter in greedy order; each is named by RATT's element for it.

    ``with_own_best`` adds ``h(g)`` for the greedy robots; ``without_optimum`` names robots whose
    compared element plays no part.
    """

    bait: tuple[str, ...]
    greedy: tuple[str, ...]
    with_own_best: bool = False
    without_optimum: frozenset[str] = frozenset()

    @property
    def robots(self) -> tuple[str, ...]:
        """All robots, bait first."""
        return self.bait + self.greedy

    @property
    def ground(self) -> Ground:
        """Elements bait, greedy, compared plan's, would-be bait: the order in which RATT breaks ties."""
        names = list(self.robots)
        owner = list(range(len(self.robots)))
        for i, robot in enumerate(self.robots):
            if robot not in self.without_optimum:
                names.append(optimum(robot))
                owner.append(i)
        if self.with_own_best:
            names += [own_best(robot) for robot in self.greedy]
            owner += list(range(len(self.bait), len(self.robots)))
        return Ground(tuple(names), tuple(owner))

    def f(self, names: Iterable[str]) -> Linear:
        """Value of the set of the named elements."""
        return Linear.of(self.ground.mask(names))

    def chosen(self, robots: Iterable[str]) -> Linear:
        """RATT's value on a set of robots."""
        return self.f(robots)

    def compared(self, robots: Iterable[str]) -> Linear:
        """The compared plan's value on a set of robots."""
        return self.f(optimum(robot) for robot in robots)

    def singles(self, names: Iterable[str]) -> Linear:
        """Sum of individual values."""
        total = Linear()
        for name in names:
            total = total + self.f([name])
        return total

    def bait_premises(self) -> tuple[Inequality, ...]:
        """Bait is its robot's best control, and no control of a greedy robot is better than any bait."""
        out = []
        for b in self.bait:
            rivals = [optimum(b)] if b not in self.without_optimum else []
            for g in self.greedy:
                rivals += self._elements_of(g)
            for rival in rivals:
                out.append(Inequality(f"bait: f({b}) >= f({rival})", self.f([b]) - self.f([rival])))
        for g in self.greedy if self.with_own_best else ():
            for rival in self._elements_of(g)[:-1]:
                best = own_best(g)
                out.append(Inequality(f"{best} is the best of {g}'s robot", self.f([best]) - self.f([rival])))
        return tuple(out)

    def greedy_premises(self) -> tuple[Inequality, ...]:
        """Each greedy robot's choice has the largest value beside those chosen before it."""
        out = []
        for j, g in enumerate(self.greedy):
            before = self.greedy[:j]
            for rival in (e for later in self.greedy[j:] for e in self._elements_of(later) if e != g):
                expression = self.f([*before, g]) - self.f([*before, rival])
                out.append(Inequality(f"greedy: {g} chosen before {rival}", expression))
        return tuple(out)

    @property
    def premises(self) -> tuple[Inequality, ...]:
        """Everything RATT's choices guarantee."""
        return self.bait_premises() + self.greedy_premises()

    def _elements_of(self, robot: str) -> list[str]:
        elements = [robot]
        if robot not in self.without_optimum:
            elements.append(optimum(robot))
        if self.with_own_best and robot in self.greedy:
            elements.append(own_best(robot))
        return elements


def worst_for(team: Team, group: tuple[str, ...], attacked: tuple[str, ...], *, plan: str) -> tuple[Inequality, ...]:
    """Premises: among attacks on ``len(attacked)`` robots of ``group``, ``attacked`` leaves the least.

    ``plan`` is ``"chosen"`` (RATT's plan suffers) or ``"compared"`` (the optimum suffers).
    """
    value = team.chosen if plan == "chosen" else team.compared
    left = value(set(group) - set(attacked))
    who = "RATT's plan" if plan == "chosen" else "the optimum"
    out = []
    for other in combinations(group, len(attacked)):
        if set(other) != set(attacked):
            reason = f"blinding {{{','.join(attacked)}}} hurts {who} at least as much as blinding {{{','.join(other)}}}"
            out.append(Inequality(reason, value(set(group) - set(other)) - left))
    return tuple(out)
