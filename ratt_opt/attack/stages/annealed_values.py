"""Stages: attacks annealed by values alone."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ratt_opt.attack.stages.attack_state import AttackState
from ratt_opt.attack.staging import Share, Stage
from ratt_opt.problem import Attack

if TYPE_CHECKING:
    from collections.abc import Iterable

    from ratt_opt._validation import IntArray
    from ratt_opt.attack.params import AttackParams
    from ratt_opt.attack.task import AttackTask


__all__ = ["AnnealedOwnCriterionStage", "AnnealedValuesStage", "annealed_attacks"]


class AnnealedValuesStage(Stage[AttackState]):
    """Stage that anneals attacks on any set function."""

    name = "annealed values"

    def applies(self, attack: AttackState) -> bool:
        """A limit, too many sets for a table, no other search asks."""
        return attack.is_limited and not (attack.has_table or attack.is_inner)

    def share(self, params: AttackParams) -> Share:
        """Return a part that leaves time for branch and bound."""
        return Share(part=params.stages.annealed_values)

    def run(self, attack: AttackState) -> None:
        """Attacks annealed by values alone."""
        annealed_attacks(attack.task)


class AnnealedOwnCriterionStage(AnnealedValuesStage):
    """Stage that anneals attacks on a criterion without compiled code."""

    def applies(self, attack: AttackState) -> bool:
        """Criterion of one's own, limit of time."""
        return not attack.has_prices and attack.has_time_limit


def annealed_attacks(task: AttackTask, seed: int = 0) -> None:
    """Offer attacks of one start after the other, from the whole team and from the attack in hand in turn.

    Raises
    ------
    OutOfBudget : time or evaluations are spent; what was found counts.
    """
    params = task.params.value_annealing
    rng, in_vain, count = np.random.default_rng(seed), 0, 0
    known: dict[frozenset[int], float] = {}
    while in_vain < params.in_vain and not task.bracket.is_closed:
        before = task.bracket.upper
        _Start(task, rng, known, is_warm=count % 2 == 1).run(params.moves * 2 ** (in_vain // 2))
        in_vain = 0 if task.bracket.upper < before else in_vain + 1
        count += 1


def _neighbours(n_robots: int, links: Iterable[tuple[int, int]]) -> list[list[int]]:
    """The robots that each robot is linked to."""
    near: list[list[int]] = [[] for _ in range(n_robots)]
    for i, j in sorted(links):
        near[i].append(j)
        near[j].append(i)
    return near


class _Start:
    """One cooling; the bracket learns of every state that is worse for the team than the attack in hand."""

    def __init__(
        self, task: AttackTask, rng: np.random.Generator, known: dict[frozenset[int], float], *, is_warm: bool
    ) -> None:
        self._task, self._rng, self._known, problem = task, rng, known, task.problem
        self._params = params = task.params.value_annealing
        n_robots = problem.n_robots
        self._near = _neighbours(n_robots, problem.communication.links)
        self._held = _neighbours(n_robots, problem.protected_links)
        self._free = [i for i in range(n_robots) if i not in problem.protected_robots]
        attack = task.bracket.attack if is_warm else Attack()
        self._group = np.zeros(n_robots, dtype=np.int64)
        for label, members in enumerate(problem.communication.groups(attack.links)):
            self._group[list(members)] = label
        self._blind = set(attack.sensing)
        others = [i for i in self._free if i not in self._blind]
        missing = problem.threat.n_blinded - len(self._blind)
        self._blind |= set(rng.permutation(np.array(others, dtype=np.int64))[:missing].tolist())
        self._cut = len(problem.communication.links_between(self._parts()))
        self._worth = {label: self._value(label) for label in set(self._group.tolist())}
        self._hot = params.warm if is_warm else params.hot
        self._scale = max(abs(task.values(range(n_robots))), 1e-300)

    def run(self, moves: int) -> None:
        """Anneal from hot to cold with ``moves`` moves per robot; raises ``OutOfBudget``."""
        task, steps, energy = self._task, moves * len(self._group), self._energy()
        task.offer_split(self._parts(), self._blind)
        for step in range(steps):
            task.budget.check()
            undo = self._blinding() if self._rng.random() < self._params.blinds else self._joining()
            if undo is None:
                continue
            after, cooling = self._energy(), (self._params.cold / self._hot) ** (step / steps)
            if after > energy and self._rng.random() >= np.exp((energy - after) / (self._scale * self._hot * cooling)):
                self._undo(*undo)
                continue
            energy = after
            if energy < task.bracket.upper and self._cut <= task.problem.alpha_c:
                task.offer_split(self._parts(), self._blind)

    def _energy(self) -> float:
        """Return the value of the best group, plus the price of links beyond the budget."""
        too_many = max(self._cut - self._task.problem.alpha_c, 0)
        return max(self._worth.values()) + self._params.price * self._scale * too_many

    def _blinding(self) -> tuple[dict[int, int], set[int], dict[int, float]] | None:
        """Exchange a blinded robot for one that sees; what undoes it."""
        i, j = (self._free[int(self._rng.integers(len(self._free)))] for _ in range(2)) if self._free else (0, 0)
        if i not in self._blind or j in self._blind:
            return None
        before = set(self._blind)
        self._blind = before - {i} | {j}
        return {}, before, self._valued({int(self._group[i]), int(self._group[j])})

    def _joining(self) -> tuple[dict[int, int], set[int], dict[int, float]] | None:
        """Take a robot, and maybe some neighbours, to another group; what undoes it."""
        i, group, rng = int(self._rng.integers(len(self._group))), self._group, self._rng
        near = self._near[i]
        target = self._unused() if not near or rng.random() < self._params.alone else int(group[rng.choice(near)])
        others = [j for j in near if rng.random() < self._params.half] if rng.random() < self._params.together else []
        homes = {j: int(group[j]) for j in (i, *others) if group[j] != target}
        for j in homes:
            self._move(j, target)
        is_held = any(group[j] != group[k] for j in homes for k in self._held[j])
        if not homes or is_held:
            self._undo(homes, self._blind, self._worth)
            return None
        return homes, self._blind, self._valued({target, *homes.values()})

    def _move(self, robot: int, target: int) -> None:
        near, group = self._near[robot], self._group
        self._cut += sum(group[j] == group[robot] for j in near) - sum(group[j] == target for j in near)
        group[robot] = target

    def _undo(self, homes: dict[int, int], blind: set[int], worth: dict[int, float]) -> None:
        for robot, home in homes.items():
            self._move(robot, home)
        self._blind, self._worth = blind, worth

    def _valued(self, labels: set[int]) -> dict[int, float]:
        """Value some groups anew; the values before."""
        before = self._worth
        self._worth = before | {label: self._value(label) for label in labels}
        return before

    def _value(self, label: int) -> float:
        robots = frozenset(np.flatnonzero(self._group == label).tolist()) - self._blind
        if robots not in self._known:
            if len(self._known) > self._params.remembered:
                self._known.clear()
            self._known[robots] = self._task.values(robots)
        return self._known[robots]

    def _unused(self) -> int:
        used = np.bincount(self._group, minlength=len(self._group) + 1)
        return int(np.argmin(used))

    def _parts(self) -> list[IntArray]:
        return [np.flatnonzero(self._group == label) for label in np.unique(self._group)]
