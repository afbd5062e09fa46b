"""The integer program of the field: one variable for each attack and target, attacks added as they are found.

For each attack met so far variables say what each group of robots left is worth to each target. A robot chooses one
element; the least worth over the attacks is maximised. The plan that HiGHS returns is attacked exactly, and that attack
is added. If an attack leaves several groups, a binary variable says which of them counts; no group is worth more than
all elements together, so that number is large enough to switch the others off.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from math import inf, isfinite
from typing import TYPE_CHECKING, Any

import numpy as np

from ratt_opt._validation import IntArray, check_number, readonly
from ratt_opt.attack.exact import worst_case_attack
from ratt_opt.budget import Budget, Stop, interruptible
from ratt_opt.errors import InputError
from ratt_opt.highs import silent_solver
from ratt_opt.problem import Attack, Plan, Problem, check_problem
from ratt_opt.running.interrupts import interrupts_afterwards
from ratt_opt.setfunctions.best_elements import BestElements
from ratt_opt.solvers.ratt import ratt

if TYPE_CHECKING:
    from collections.abc import Callable

__all__ = ["ScenarioPlan", "scenario_program"]


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class ScenarioPlan(Plan):
    """A plan of the scenario program.

    ``lower`` : worst case of the plan, by the exact attack; ``claimed_upper`` : HiGHS's bound on the best worst case,
    which nothing checks; ``attacks`` : scenarios of the program; ``stop`` : ``GAP`` if both ends met, ``HEURISTIC`` if
    what is open is within the tolerances of HiGHS
    """

    lower: float
    claimed_upper: float
    attacks: int
    stop: Stop


@interruptible
def scenario_program(
    problem: Problem,
    *,
    time_limit: float | None = 10.0,
    gap: float = 1e-6,
    budget: Budget | None = None,
    on_improvement: Callable[[ScenarioPlan], object] | None = None,
    first_gap: float = 1e-4,
    tolerance: float = 1e-6,
) -> ScenarioPlan:
    """Plan by the scenario program, for coverage and facility location.

    Parameters
    ----------
    time_limit : seconds; ``None`` for none
    gap : relative gap at which the search stops
    on_improvement : called with what is known after each attack
    first_gap : relative gap of HiGHS while attacks are added: proofs of the last ten-thousandth take most of the time
    tolerance : relative room around the ends known, for the rounding of HiGHS

    Raises
    ------
    InputError : the objective is no sum of best elements, or a limit is out of range.

    Source: the standard cutting plane for robust coverage, as in Shi, Zhou, Tokekar, Robust multiple-path orienteering
    problem, ICRA 2020, and Orlin and others 2018, Section 1; nothing is guaranteed before the ends meet.
    """
    if not isinstance(check_problem(problem).objective, BestElements):
        rule = "must be Coverage or FacilityLocation for the scenario program, whose rows are linear"
        raise InputError("objective", rule, type(problem.objective).__name__)
    for name, value in (("gap", gap), ("first_gap", first_gap), ("tolerance", tolerance)):
        check_number(name, value, low=0)
    rows = _ScenarioRows(problem, first_gap, tolerance)
    return _ScenarioSearch(problem, Budget.inside(budget, time_limit), gap, on_improvement, rows).run()


@dataclass(slots=True)
class _ScenarioSearch:
    problem: Problem
    budget: Budget
    gap: float
    on_improvement: Callable[[ScenarioPlan], object] | None
    rows: _ScenarioRows
    best: IntArray = field(init=False)
    lower: float = field(init=False, default=-inf)
    upper: float = field(init=False)

    def run(self) -> ScenarioPlan:
        """Add attacks until the ends meet or the budget is spent."""
        self.best, attacks = ratt(self.problem, budget=self.budget).elements, 0
        self.upper = float(self.problem.objective(range(self.problem.objective.n)))
        attack, model, met = self._attack(self.best), self.rows, set[Attack]()
        while not self._closed and not self.budget.is_over:
            if attack not in met:
                model.add_attack(attack)
                attacks += 1
            elif not model.tighten():  # it is bounded already: what is open is within the tolerances of HiGHS
                break
            met.add(attack)
            plan, bound = model.solve(self.budget, max(self.lower, 0.0), self.upper)
            self.upper = min(self.upper, bound)
            if plan is None:
                break
            attack = self._attack(plan)
            if self.on_improvement is not None:
                self.on_improvement(self._result(attacks))
        return self._result(attacks)

    def _attack(self, plan: IntArray) -> Attack:
        found = worst_case_attack(self.problem, plan, budget=self.budget.part(), brief=True)
        if found.lower > self.lower:
            self.best, self.lower = plan, found.lower
        return found.attack

    @property
    def _closed(self) -> bool:
        return self.upper - self.lower <= self.gap * abs(self.upper)

    def _result(self, attacks: int) -> ScenarioPlan:
        stop = Stop.GAP if self._closed else self.budget.stop() or Stop.HEURISTIC
        return ScenarioPlan(
            elements=readonly(np.array(self.best)),
            evaluations=0,
            lower=self.lower,
            claimed_upper=self.upper,
            attacks=attacks,
            stop=stop,
        )


@dataclass(slots=True)
class _ScenarioRows:
    """The program so far; ``shares`` of a utility level are variables, as in text books on p-median."""

    problem: Problem
    first_gap: float
    tolerance: float
    highs: Any = field(init=False)
    _least: Any = field(init=False)
    _chosen: list[Any] = field(init=False)
    _most: float = field(init=False)
    _integer: Any = field(init=False)

    def __post_init__(self) -> None:
        with interrupts_afterwards():  # half imported it cannot be imported again
            import highspy

        self._integer = highspy.HighsVarType.kInteger
        highs = self.highs = silent_solver()()
        for name, value in {"threads": 1, "random_seed": 0, "mip_rel_gap": self.first_gap}.items():
            highs.setOptionValue(name, value)
        f = self.problem.objective
        self._most = float(f(range(f.n)))
        self._least = highs.addVariable(0, self._most)
        self._chosen = [highs.addVariable(0, 1, type=self._integer) for _ in range(f.n)]
        for choice in self.problem.choices:
            highs.addConstr(sum(self._chosen[e] for e in choice) == 1)

    def tighten(self) -> bool:
        """Solve without a gap from now on; whether there was one."""
        _, gap = self.highs.getOptionValue("mip_rel_gap")
        self.highs.setOptionValue("mip_rel_gap", 0.0)
        return bool(gap > 0)

    def add_attack(self, attack: Attack) -> None:
        """Bound the least worth by that of the best group that the attack leaves."""
        groups = [group for group in self.problem.groups_left(attack) if group]
        if len(groups) < 2:
            self.highs.addConstr(self._least - self._worth(groups[0] if groups else frozenset()) <= 0)
            return
        counts = [self.highs.addVariable(0, 1, type=self._integer) for _ in groups]
        self.highs.addConstr(sum(counts) == 1)
        for group, is_best in zip(groups, counts, strict=True):
            self.highs.addConstr(self._least - self._worth(group) + self._most * is_best <= self._most)

    def _worth(self, group: frozenset[int]) -> Any:
        """Worth of a group as a sum of new variables."""
        f: BestElements = self.problem.objective  # type: ignore[assignment]
        sees, worth = np.isin(self.problem.robot, sorted(group)), 0.0 * self._least
        for part in range(f.n_parts):
            elements = [int(e) for e in f.touching(part) if sees[e]]
            levels, kind = np.unique(f.utility[elements, part], return_inverse=True)
            shares = [self.highs.addVariable(0, 1) for _ in levels]
            for k, share in enumerate(shares):
                same = [self._chosen[e] for e, level in zip(elements, kind, strict=True) if level == k]
                self.highs.addConstr(share - sum(same) <= 0)
                worth = worth + float(f.weights[part] * levels[k]) * share
            if shares:
                self.highs.addConstr(sum(shares) <= 1)
        return worth

    def solve(self, budget: Budget, lower: float, upper: float) -> tuple[IntArray | None, float]:
        """The plan that HiGHS found between the ends known, or ``None``, and the bound that it claims."""
        highs = self.highs
        highs.changeColBounds(self._least.index, lower * (1 - self.tolerance), upper * (1 + self.tolerance))
        asked = (highs.cbMipInterrupt, highs.cbSimplexInterrupt, highs.cbIpmInterrupt)

        with interrupts_afterwards() as met:

            def answer(event: Any) -> None:
                event.interrupt(bool(met) or budget.is_over)

            for question in asked:
                question.subscribe(answer)
            try:
                highs.maximize(self._least)
            finally:
                for question in asked:
                    question.unsubscribe(answer)
        values = np.array(highs.getSolution().col_value)
        bound = float(highs.getInfo().mip_dual_bound)
        chosen = values[1 : len(self._chosen) + 1]
        known = bound if isfinite(bound) else inf
        if len(chosen) < len(self._chosen) or not chosen.any():
            return None, known
        return np.array([choice[int(chosen[choice].argmax())] for choice in self.problem.choices]), known
