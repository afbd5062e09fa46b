"""Attacks on plans, whose outcomes enter the pool, and which of equal attacks lasts."""

from __future__ import annotations

from dataclasses import replace
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from ratt_opt.attack.annealing import AnnealedAttacks
from ratt_opt.attack.exact import worst_case_attack_unrounded
from ratt_opt.attack.heuristics import bounded_rational_attack, greedy_attack
from ratt_opt.attack.least_sets.exchanges import weak_sets_of_size
from ratt_opt.attack.size_vectors.weak_families import GroupExchanges
from ratt_opt.attack.task import AttackBracket, AttackMemory, AttackOptions
from ratt_opt.attack.team import Team, has_native_kernel
from ratt_opt.budget import Budget, OutOfBudget, Stop
from ratt_opt.graph.outcomes import realise
from ratt_opt.problem import Attack
from ratt_opt.setfunctions.information import triangles
from ratt_opt.solvers.maxmin.params import or_default

if TYPE_CHECKING:
    from ratt_opt._validation import FloatArray, IntArray
    from ratt_opt.attack.task import AttackResult
    from ratt_opt.problem import Problem
    from ratt_opt.solvers.maxmin.outcome_pool import OutcomePool
    from ratt_opt.solvers.maxmin.params import AdversaryParams

__all__ = ["Adversary", "PlanIndependentAttacks"]


class PlanIndependentAttacks:
    """Exchanges the smaller groups of attacks on one problem for some that stay weak under other plans too.

    If all robots are alike to the adversary, an attack may leave any of the robots outside its largest group in the
    smaller ones. Those that are weak under this plan may be strong under others, and then nobody knows beforehand which
    group of the outcome wins: the search has to divide on it. Robots that are weak whatever they do hurt the team just
    as much, and their groups can be closed once and for all. ``share`` : of the remaining time, for one attack
    """

    def __init__(self, problem: Problem, budget: Budget, share: float) -> None:
        self._problem, self._budget, self._share = problem, budget, share
        self._known: dict[tuple[frozenset[int], tuple[int, ...]], Attack] = {}

    def of(self, attack: Attack) -> Attack:
        """An attack with the same largest group, whose other groups, of the same sizes, are weak at their best.

        The attack itself if robots or links differ to the adversary, or there is no time.
        """
        if not self._problem.threat.is_symmetric or self._budget.is_over or self._team is None:
            return attack
        groups = sorted(self._problem.groups_left(attack), key=lambda g: (-len(g), min(g, default=0)))
        sizes = tuple(len(group) for group in groups[1:] if group)
        if not sizes:
            return attack
        key = groups[0], sizes
        if key not in self._known:
            others = self._weakest(groups[0], sizes, self._budget.part(self._share))
            if others is None:
                return attack
            outcome = (groups[0], *others)
            self._known[key] = Attack(*realise(self._problem.threat, tuple(sorted(outcome, key=min))))
        return self._known[key]

    @cached_property
    def _team(self) -> Team | None:
        return _at_their_best(self._problem)

    @cached_property
    def _single(self) -> FloatArray:
        """(N,) values of the robots' individually best elements: these decide who is left alone.

        With the information of ``_team`` instead, groups counted as weak that other elements make strong.
        """
        single = self._problem.objective.singletons()
        return np.array([single[choice].max() for choice in self._problem.choices])

    def _weakest(self, largest: frozenset[int], sizes: tuple[int, ...], part: Budget) -> list[frozenset[int]] | None:
        """Disjoint groups of these sizes outside ``largest``, each as weak as exchanges find, the larger ones first.

        ``None`` if the part of the budget ends before: of a thousand robots there may be hundreds.
        """
        assert self._team is not None
        team, single = self._team, self._single
        left = np.array([i for i in range(team.robots) if i not in largest])
        groups = []
        for size in sizes:
            if part.is_over:
                return None
            chosen = [int(single[left].argmin())]
            if size > 1:
                chosen = sorted(weak_sets_of_size(team.among(left), size, part)[0])
            groups.append(frozenset(left[chosen].tolist()))
            left = np.delete(left, chosen)
        return groups


def _at_their_best(problem: Problem) -> Team | None:
    """A team in which each robot sees every target with the element that sees that target best.

    No one element need do all of that. ``None`` if the compiled code does not support the objective.
    """
    objective = problem.objective
    if not has_native_kernel(objective):
        return None
    information = objective.information
    traces = np.trace(information, axis1=-2, axis2=-1)
    best = np.array([choice[traces[choice].argmax(axis=0)] for choice in problem.choices])
    targets = np.arange(traces.shape[1])
    return Team(objective, triangles(objective.prior_information), triangles(information[best, targets]))


class Adversary:
    """Attacks one problem's plans, quickly or exactly; every outcome enters the pool.

    Raises ``OutOfBudget`` : the user interrupted an attack; its outcome has entered the pool.
    """

    def __init__(
        self, problem: Problem, pool: OutcomePool, budget: Budget, params: AdversaryParams | None = None
    ) -> None:
        self.problem, self.pool, self.budget = problem, pool, budget
        self._params = or_default(None).adversary if params is None else params
        self._lasting = PlanIndependentAttacks(problem, budget, self._params.quick)
        on_network = problem.n_robots > self._params.small and not problem.threat.links_alike
        self.on_network = on_network
        self._annealed = AnnealedAttacks.of(problem, budget) if on_network else None
        self._memories: dict[bytes, AttackMemory] = {}

    @property
    def is_exact_cheaply(self) -> bool:
        """True if an exact attack costs little, and can find more than the known outcomes."""
        return self.problem.n_robots <= self._params.small and not self.pool.complete

    def learn(self, plan: IntArray) -> bool:
        """Attack a plan quickly, unless all outcomes are known; whether that found a new outcome."""
        known = len(self.pool)
        if not self.pool.complete and not self._learn_near(plan) and not self._learn_annealed(plan):
            self._remember(self.problem, plan, self._quick_attack(self.problem, plan))
        return len(self.pool) > known

    def _learn_annealed(self, plan: IntArray) -> bool:
        """Anneal the known outcome that hurts a plan most, then others anew; whether a worse one was found."""
        if self._annealed is None:
            return False
        before, known = self.pool.plan_value(plan), len(self.pool)
        worst = self._worst_known(self.problem, plan)
        brief, moves_each = self._params.brief_moves, self._params.moves
        for moves, first in (brief, worst), (moves_each, None), (moves_each, worst), (moves_each, None):
            attack = self._annealed.attack(self.problem, plan, moves, first)
            least = self.problem.objective.least_improvement(before)
            if attack is not None and self.problem.team_value(plan, attack) < before - least:
                self.pool.add(attack)
                break
        return len(self.pool) > known

    def _worst_known(self, problem: Problem, plan: IntArray) -> Attack | None:
        """The known outcome that hurts most a plan of a problem with this threat."""
        values = self._known_values(problem, plan)
        return self.pool.attack(int(values.argmin())) if len(values) else None

    def _known_values(self, problem: Problem, plan: IntArray) -> FloatArray:
        """(O,) what the known outcomes leave a plan of a problem with this threat."""
        return self.pool.outcome_values(self.pool.group_values(problem.information_objective.information[plan]))

    def _learn_near(self, plan: IntArray) -> bool:
        """Exchange robots of known outcomes for a worse one: few descents if an attack takes hundreds."""
        team = Team.of(self.problem.objective, plan) if self.problem.threat.is_symmetric else None
        if team is None or len(plan) <= self._params.small:
            return False
        teams = self._known_values(self.problem, plan)
        best: GroupExchanges | None = None
        lowest, part = float(teams.min(initial=np.inf)), self.budget.part(self._params.quick)
        for outcome in np.argsort(teams, kind="stable")[: self._params.near].tolist():
            if part.is_over:
                break
            groups = [self.pool.groups[g] for g in self.pool.of_outcome[outcome] if self.pool.groups[g]]
            family = GroupExchanges(team, tuple(sorted(map(len, groups), reverse=True)), np.zeros(len(plan), np.bool_))
            family.near(groups, part)
            if groups and family.value < lowest - self.problem.objective.least_improvement(lowest):
                best, lowest = family, family.value
        if best is None:
            return False
        known = len(self.pool)
        self.pool.add_outcome(tuple(sorted(best.groups(), key=min)))
        return len(self.pool) > known

    def learn_relaxed(self, of_robot: FloatArray) -> bool:
        """Learn outcomes from a relaxed plan as if it were one: its robots contribute ``of_robot`` (N, M, d, d)."""
        known = len(self.pool)
        owners = np.arange(self.problem.n_robots)
        objective = self.pool.objective.with_information(of_robot)
        relaxed = replace(self.problem, objective=objective, robot=owners, at_most=None)
        if len(owners) <= self._params.small:
            self.pool.add(greedy_attack(relaxed, owners).attack)
        self._remember(relaxed, owners, self._attack_relaxed(relaxed, owners))
        return len(self.pool) > known

    def _attack_relaxed(self, relaxed: Problem, owners: IntArray) -> Attack:
        annealed, worst = None, self._worst_known(relaxed, owners)
        if self._annealed is not None:
            annealed = self._annealed.attack(relaxed, owners, self._params.brief_moves, worst)
        return self._quick_attack(relaxed, owners) if annealed is None else annealed

    def attack(self, plan: IntArray, budget: Budget, aim: float = -np.inf) -> AttackResult:
        """Exact worst case of a plan within a part of the budget, or an attack that leaves it no more than ``aim``."""
        nodes, known, memory = budget.max_nodes, self._worst_known(self.problem, plan), self._memory(plan)
        options = AttackOptions(max_nodes=nodes, budget=budget, aim=aim, known=known, memory=memory, brief=True)
        result = worst_case_attack_unrounded(self.problem, plan, options)
        self._remember(self.problem, plan, result.attack)
        return result

    def evaluate_quickly(self, plan: IntArray, budget: Budget) -> AttackResult:
        """Evaluate a plan quickly: by the known attack that hurts it most, or earlier exact ones.

        An attack of its own takes half a second if a thousand robots lose hundreds of thousands of links.
        """
        memory = self._memories.get(plan.tobytes()) or AttackMemory()
        values, objective = self._known_values(self.problem, plan), self.problem.objective
        if len(values) and memory.bracket is None:
            worst = int(values.argmin())
            value = max(objective(plan[list(self.pool.groups[group])]) for group in self.pool.of_outcome[worst])
            memory.bracket = AttackBracket(self.pool.attack(worst), value, objective(()), objective.rounding)
        return worst_case_attack_unrounded(
            self.problem, plan, AttackOptions(time_limit=0, budget=budget, memory=memory, brief=True)
        )

    def _memory(self, plan: IntArray) -> AttackMemory:
        """Return the memory of earlier exact attacks on the plan, if it is one of the last few attacked."""
        memory = self._memories.pop(plan.tobytes(), None) or AttackMemory()
        self._memories[plan.tobytes()] = memory
        if len(self._memories) > self._params.remembered:
            del self._memories[next(iter(self._memories))]
        return memory

    def raise_if_interrupted(self, result: AttackResult) -> None:
        """Stop the search if the user interrupted an attack, once what the attack proved is kept."""
        if result.stop is Stop.INTERRUPTED:
            raise OutOfBudget(self.budget.interrupt())

    def _remember(self, problem: Problem, plan: IntArray, attack: Attack) -> None:
        """Add an attack on a plan to the pool; the lasting one in its place if that hurts this plan as much."""
        lasting = self._lasting.of(attack)
        self.pool.add(lasting)
        if lasting is attack:
            return
        value = problem.team_value(plan, attack)
        if problem.team_value(plan, lasting) > value + problem.objective.least_improvement(value):
            self.pool.add(attack)

    def _quick_attack(self, problem: Problem, plan: IntArray) -> Attack:
        if problem.n_robots <= self._params.small:
            return bounded_rational_attack(problem, plan).attack
        if not problem.threat.links_alike:
            return greedy_attack(problem, plan, budget=self.budget).attack
        options = AttackOptions(max_nodes=0, budget=self.budget.part(self._params.quick), brief=True)
        found = worst_case_attack_unrounded(problem, plan, options)
        self.raise_if_interrupted(found)
        return found.attack
