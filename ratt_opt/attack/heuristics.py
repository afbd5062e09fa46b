"""Attacks without a claim: a lower bound of nothing, an upper bound that their attack attains.

``bounded_rational_attack`` is the paper's attacker; ``greedy_attack`` takes the worst single step again and again,
``random_attack`` knows nothing. They build a :class:`PartialAttack`: blinded robots, then robots cut off one by one.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from ratt_opt._validation import check_integer
from ratt_opt.attack.task import AttackResult, PlanValues, widened_result
from ratt_opt.budget import Budget, Stop
from ratt_opt.coordinates.preparation import precise
from ratt_opt.problem import Attack

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import ArrayLike

    from ratt_opt._validation import FloatArray
    from ratt_opt.graph.communication import Link
    from ratt_opt.problem import Problem

__all__ = [
    "PartialAttack",
    "bounded_rational_attack",
    "greedy_attack",
    "heuristic_result",
    "random_attack",
    "team_values",
]


@dataclass(frozen=True, slots=True)
class PartialAttack:
    """Robots blinded and links cut so far; ``parts`` are the connected groups this leaves, blinded robots included.

    :meth:`cut_off` relies on whole robots having been cut off so far: no link inside a part is cut.
    """

    problem: Problem
    blinded: frozenset[int]
    cut: frozenset[Link]
    parts: tuple[frozenset[int], ...]

    @classmethod
    def of(
        cls, problem: Problem, blinded: frozenset[int] = frozenset(), cut: frozenset[Link] = frozenset()
    ) -> PartialAttack:
        """The attack that blinds and cuts the given ones."""
        return cls(problem, blinded, cut, problem.communication.groups(cut))

    def blind(self, robot: int) -> PartialAttack:
        """Blind one more robot."""
        return replace(self, blinded=self.blinded | {robot})

    def cut_off(self, robot: int) -> PartialAttack | None:
        """Cut all links that robot still has; ``None`` if one is protected or the budget is too small."""
        communication = self.problem.communication
        links = communication.links_of(robot)
        if links & self.problem.protected_links or len(self.cut | links) > self.problem.alpha_c:
            return None
        home = next(part for part in self.parts if robot in part)
        left = communication.groups_among(home - {robot}) if len(home) > 1 else ()
        others = tuple(part for part in self.parts if part is not home)
        return replace(self, cut=self.cut | links, parts=(*others, frozenset([robot]), *left))

    def groups(self) -> list[frozenset[int]]:
        """Robots of each group that still see."""
        return [part - self.blinded for part in self.parts]


def team_values(values: PlanValues, candidates: Sequence[PartialAttack]) -> FloatArray:
    """(C,) team value under each candidate, by one batch of evaluations."""
    groups = [candidate.groups() for candidate in candidates]
    membership = np.zeros((sum(map(len, groups)), values.n), dtype=np.bool_)
    for row, group in enumerate(group for family in groups for group in family):
        membership[row, sorted(group)] = True
    starts = np.concatenate([[0], np.cumsum([len(family) for family in groups])[:-1]])
    return np.asarray(np.maximum.reduceat(values.evaluate(membership), starts))


def heuristic_result(problem: Problem, values: PlanValues, attack: Attack) -> AttackResult:
    """The result of a heuristic: its attack's value, and the value of no measurement as lower bound."""
    lower, evaluations, searched = problem.objective(()), values.evaluations, precise(problem)
    upper = searched.team_value(values.plan, attack)
    found = AttackResult(attack=attack, lower=lower, upper=upper, stop=Stop.HEURISTIC, evaluations=evaluations)
    return replace(widened_result(searched, values.plan, found), lower=lower)


def _on_complete_graph(problem: Problem, order: list[int], blinded: frozenset[int]) -> Attack:
    """Isolate robots on a complete graph, without going through the links.

    The next robot has one link to each robot that is not isolated yet.
    """
    n_robots, left, alone = problem.n_robots, problem.alpha_c, list[int]()
    for robot in order:
        if robot in blinded:
            continue
        left -= n_robots - 1 - len(alone)
        if left < 0:
            break
        alone.append(robot)
    together = set(range(n_robots)).difference(alone)
    return Attack(blinded, problem.communication.links_between([*([i] for i in alone), together]))


def bounded_rational_attack(problem: Problem, elements: ArrayLike) -> AttackResult:
    """Blind the strongest robots, then cut off the next strongest while the link budget lasts.

    Strength is the individual value of the chosen element; ties go to the lowest robot. Protected robots are passed
    over when blinding, and robots with a protected link when cutting off. The attack ends at the first robot whose
    links exceed the remaining budget. (The paper cuts off ``alpha_cs`` robots, which can exceed its own link budget.)

    Raises
    ------
    InputError : an element is not its robot's, or ``elements`` has the wrong shape.

    Source: ratt.tex, Section VI-C, large-scale comparison.
    """
    values = PlanValues(problem, elements)
    order = np.argsort(-values.singletons(), kind="stable").tolist()
    free = [i for i in order if i not in problem.protected_robots]
    if problem.threat.links_alike:
        return heuristic_result(problem, values, _on_complete_graph(problem, order, frozenset(free[: problem.alpha_s])))
    attack = PartialAttack.of(problem, frozenset(free[: problem.alpha_s]))
    locked = {i for link in problem.protected_links for i in link}
    for robot in order:
        if robot in attack.blinded or robot in locked:
            continue
        longer = attack.cut_off(robot)
        if longer is None:
            break
        attack = longer
    return heuristic_result(problem, values, Attack(attack.blinded, attack.cut))


def greedy_attack(problem: Problem, elements: ArrayLike, *, budget: Budget | None = None) -> AttackResult:
    """Blind robots one by one, then cut robots off one by one, each time leaving the least team value.

    Ties go to the step that cuts the fewest links, then to the lowest robot. A blinded robot may
    be cut off too: it relays. It stops if no step fits the budgets, or if the time of ``budget`` is over, and returns
    the attack so far with the reason.

    Raises
    ------
    InputError : an element is not its robot's, or ``elements`` has the wrong shape.
    """
    values, own = PlanValues(problem, elements), budget or Budget()
    attack = PartialAttack.of(problem)
    for _ in range(problem.threat.n_blinded):
        if own.is_over:
            return _so_far(values, attack, own)
        robots = [i for i in range(problem.n_robots) if i not in attack.blinded | problem.protected_robots]
        attack = _best(values, [attack.blind(i) for i in robots])
    while True:
        longer = [None if own.is_over else attack.cut_off(i) for i in range(problem.n_robots)]
        if own.is_over:
            return _so_far(values, attack, own)
        steps = [step for step in longer if step is not None and len(step.cut) > len(attack.cut)]
        if not steps:
            return heuristic_result(problem, values, Attack(attack.blinded, attack.cut))
        attack = _best(values, steps)


def _so_far(values: PlanValues, attack: PartialAttack, budget: Budget) -> AttackResult:
    result = heuristic_result(attack.problem, values, Attack(attack.blinded, attack.cut))
    return replace(result, stop=budget.stop() or result.stop)


def _best(values: PlanValues, steps: list[PartialAttack]) -> PartialAttack:
    worth = team_values(values, steps)
    return steps[min(range(len(steps)), key=lambda k: (worth[k], len(steps[k].cut), k))]


def random_attack(problem: Problem, elements: ArrayLike, *, seed: int) -> AttackResult:
    """Spend both budgets on uniformly random unprotected robots and links.

    Raises
    ------
    InputError : ``seed`` is not an integer >= 0, an element is not its robot's, or ``elements`` has the wrong shape.
    """
    rng = np.random.default_rng(check_integer("seed", seed, low=0))
    values = PlanValues(problem, elements)
    robots = sorted(set(range(problem.n_robots)) - problem.protected_robots)
    links = sorted(problem.communication.links - problem.protected_links)
    blinded = rng.permutation(len(robots))[: problem.alpha_s]
    cut = rng.permutation(len(links))[: problem.alpha_c]
    attack = Attack(frozenset(robots[i] for i in blinded), frozenset(links[i] for i in cut))
    return heuristic_result(problem, values, attack)
