"""Roles in the proof: bait and greedy robots, their choices, the premises, and the factor that a group has.

Elements: ``b1`` is bait robot 1's choice, ``g1`` greedy robot 1's (in greedy order), ``o(b1)``
and ``o(g1)`` the compared (optimal) plan's for the same robot, ``h(g1)`` the individually best
control of greedy robot 1 (its would-be bait). Equal elements are a special case of distinct
ones: on sets with one element per robot a function cannot tell a copy from its original.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from enum import Enum
from itertools import combinations
from typing import TYPE_CHECKING

from ratt_audit.engine.claim import Claim, Ground, Inequality, Linear
from ratt_audit.engine.polynomials import ONE, Polynomial, T, constant

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Sequence

    from ratt_opt.worst_ratio.function_class import FunctionClass

    Robots = tuple[str, ...]
    """Robots by the name of RATT's element for each."""

__all__ = ["CUBED", "KEPT", "KEPT_OVER_ONE_PLUS_K", "ONE_PLUS_K", "SQUARED", "T2", "T3", "Factor", "Side", "SizedClaim",
           "Team", "attacks_on", "every_group", "every_surviving_set", "kept_by", "one_group",
           "optimum", "own_best", "team_of", "whose_worst", "worst_for"]  # fmt: skip


@dataclass(frozen=True, slots=True, kw_only=True)
class SizedClaim:
    """One linear claim of an entry: a size and who is attacked in words, robots in play, the question.

    ``team`` : the roles, if the elements have any; ``attacked`` : who of the group is blinded, if it is one of a chain.
    """

    size: str
    robots: int
    claim: Claim
    team: Team | None = None
    attacked: Robots = ()


class Side(Enum):
    """Team by whose value an attack is judged."""

    RATT = "RATT's plan"
    OPTIMUM = "the optimum"


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

    def value(self, side: Side, robots: Iterable[str]) -> Linear:
        """RATT's or the compared plan's value on a set of robots."""
        return self.chosen(robots) if side is Side.RATT else self.compared(robots)

    def singles(self, names: Iterable[str]) -> Linear:
        """Sum of individual values."""
        return sum((self.f([name]) for name in names), Linear())

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
        """Premises that RATT's choices guarantee."""
        return self.bait_premises() + self.greedy_premises()

    def claim(
        self, function_class: FunctionClass, conclusion: Linear, premises: tuple[Inequality, ...] | None = None
    ) -> Claim:
        """``conclusion >= 0``, from all that RATT's choices guarantee unless other premises are given."""
        given = self.premises if premises is None else premises
        return Claim(function_class=function_class, ground=self.ground, premises=given, conclusion=conclusion)

    def comparison(
        self, function_class: FunctionClass, left: Linear, right: Linear, premises: tuple[Inequality, ...] | None = None
    ) -> Claim:
        """``left >= right``, with the common power of ``t`` divided out."""
        return replace(self.claim(function_class, (left - right).reduced(), premises), sides=(left, right))

    def text(self, attacked: Robots = ()) -> str:
        """Roles and attack in words."""
        return f"{len(self.bait)} bait, {len(self.greedy)} greedy, blinded: {','.join(attacked) or 'none'}"

    def _elements_of(self, robot: str) -> list[str]:
        elements = [robot]
        if robot not in self.without_optimum:
            elements.append(optimum(robot))
        if self.with_own_best and robot in self.greedy:
            elements.append(own_best(robot))
        return elements


def team_of(n_bait: int, n_greedy: int) -> Team:
    """Baits b1.. and greedy robots g1.. in greedy order."""
    return Team(tuple(f"b{i + 1}" for i in range(n_bait)), tuple(f"g{i + 1}" for i in range(n_greedy)))


def attacks_on(group: Robots, count: int) -> Iterator[Robots]:
    """Attacks on ``count`` robots of a group, one per symmetry class: baits are alike, the first are attacked first."""
    baits = [robot for robot in group if robot.startswith("b")]
    for attacked in combinations(group, count):
        used = [robot for robot in attacked if robot.startswith("b")]
        if used == baits[: len(used)]:
            yield attacked


def worst_for(team: Team, group: Robots, attacked: Robots, *, side: Side) -> tuple[Inequality, ...]:
    """Premises: among attacks on ``len(attacked)`` robots of ``group``, ``attacked`` leaves ``side`` the least."""
    left = team.value(side, set(group) - set(attacked))
    out = []
    for other in combinations(group, len(attacked)):
        if set(other) != set(attacked):
            hurts = f"hurts {side.value} at least as much as blinding {{{','.join(other)}}}"
            reason = f"blinding {{{','.join(attacked)}}} {hurts}"
            out.append(Inequality(reason, team.value(side, set(group) - set(other)) - left))
    return tuple(out)


def whose_worst(team: Team, group: Robots, attacked: Robots) -> dict[str, tuple[Inequality, ...]]:
    """Readings of A*: the plan's worst attack in the group, the optimum's in the group, or the team's."""
    return {
        "A* hurts RATT's plan most in its group": worst_for(team, group, attacked, side=Side.RATT),
        "A* hurts the optimum most in its group": worst_for(team, group, attacked, side=Side.OPTIMUM),
        "A* worst for the team only, so any attack on a group that is not the best": (),
    }


T2, T3 = T**2, T**3
ONE_PLUS_K = constant(2) - T
"""``1 + k`` with ``t = 1 - k``."""


@dataclass(frozen=True, slots=True)
class Factor:
    """``above / below``, with ``below`` positive for every curvature in [0, 1]."""

    above: Polynomial
    below: Polynomial = ONE

    def gap(self, left: Linear, right: Linear) -> Linear:
        """An expression that is at least zero exactly when ``left >= above/below * right``."""
        return left * self.below - right * self.above


KEPT, SQUARED, CUBED = Factor(T), Factor(T2), Factor(T3)
"""One minus the curvature, its square and its cube."""
KEPT_OVER_ONE_PLUS_K = Factor(T, ONE_PLUS_K)


def every_surviving_set(*, largest: int) -> Iterator[tuple[Team, Robots]]:
    """Every set S of surviving robots, with those that play a part in what S is worth, up to that many in all.

    S has any baits and any of the greedy robots; greedy robots outside S were still chosen before
    some in S. Baits outside S and greedy robots chosen later play no part.
    """
    for total in range(1, largest + 1):
        for n_greedy in range(total + 1):
            bait, greedy = team_of(total - n_greedy, n_greedy).bait, team_of(0, n_greedy).greedy
            for chosen in _subsets_with_last(greedy):
                yield Team(bait, greedy, without_optimum=frozenset(greedy) - set(chosen)), bait + chosen


def kept_by(function_class: FunctionClass, factor: Factor, team: Team, group: Robots) -> SizedClaim:
    """``f(u on S) >= factor f(o on S)`` for one set of surviving robots."""
    claim = team.claim(function_class, factor.gap(team.chosen(group), team.compared(group)))
    text = f"S = {{{','.join(group)}}} of {len(team.bait)} bait, {len(team.greedy)} greedy"
    return SizedClaim(size=text, robots=len(team.robots), claim=claim, team=team)


def every_group(function_class: FunctionClass, factor: Factor, *, largest: int) -> Iterator[SizedClaim]:
    """Claim that ``f(u on S) >= factor f(o on S)`` for every set S of surviving robots, whatever the pattern."""
    for team, group in every_surviving_set(largest=largest):
        yield kept_by(function_class, factor, team, group)


def _subsets_with_last(greedy: Robots) -> Iterator[Robots]:
    if not greedy:
        yield ()
        return
    for size in range(len(greedy)):
        for rest in combinations(greedy[:-1], size):
            yield (*rest, greedy[-1])


def one_group(function_class: FunctionClass, factors: Sequence[Factor], *, all_bait: bool) -> Iterator[SizedClaim]:
    """A group of baits only (or greedy robots only) against the compared plan; ``factors`` of sizes 1, 2, ..."""
    for size, factor in enumerate(factors, start=1):
        team = team_of(size, 0) if all_bait else team_of(0, size)
        conclusion = factor.gap(team.chosen(team.robots), team.compared(team.robots))
        text = f"{size} {'surviving baits' if all_bait else 'greedy robots'}"
        yield SizedClaim(size=text, robots=size, claim=team.claim(function_class, conclusion))
