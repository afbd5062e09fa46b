"""An explicit instance on which a planner attains a ratio, and its exact replay through the library."""

from __future__ import annotations

from dataclasses import dataclass, field
from fractions import Fraction
from math import lcm
from typing import TYPE_CHECKING

import numpy as np

from ratt_opt._validation import IntArray, readonly
from ratt_opt._values import ByValue
from ratt_opt.attackers.exact import worst_case_attack
from ratt_opt.audit.engine.claim import FunctionClass
from ratt_opt.audit.engine.evidence import check_class
from ratt_opt.errors import ProofError
from ratt_opt.graph.caa import caa
from ratt_opt.problem import Plan, Problem
from ratt_opt.setfunctions.table import TableFunction
from ratt_opt.solvers.baselines import greedy, myopic
from ratt_opt.solvers.exhaustive import exhaustive_optimum
from ratt_opt.solvers.ratt import ratt
from ratt_opt.stopping import Stop

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

__all__ = ["FAMILIES", "PLANNERS", "RatioQuestion", "RatioWitness", "replay", "scaled_values"]

PLANNERS: dict[str, Callable[[Problem], Plan]] = {"ratt": ratt, "myopic": myopic, "greedy": greedy}

FAMILIES = {"submodular": FunctionClass.CURVATURE, "nondecreasing": FunctionClass.TOTAL_CURVATURE}

LARGEST_VALUE = 2**52
"""Sums and comparisons of integers up to here are exact in float64, in which the library's planners compute."""


@dataclass(frozen=True, slots=True, kw_only=True)
class RatioQuestion:
    """Whose worst ratio is asked for: a planner on N robots of the complete graph, a threat, a class of functions.

    ``family`` : ``"submodular"`` or ``"nondecreasing"``; ``domain`` : what ``curvature`` is over, ``"elements"`` or
    ``"feasible"`` sets; ``planner`` : a name of ``PLANNERS``.
    """

    n_robots: int
    alpha_s: int
    alpha_c: int
    curvature: Fraction
    family: str
    domain: str = "elements"
    planner: str = "ratt"

    @property
    def n_bait(self) -> int:
        """Bait robots of the planner."""
        alpha = self.alpha_s + caa(self.n_robots, self.alpha_c).alpha_cs
        return {"greedy": 0, "myopic": self.n_robots}.get(self.planner, min(self.n_robots, alpha))

    def witness(self, values: IntArray) -> RatioWitness:
        """An instance of this question: (4**N,) values by bit mask."""
        fields = {field: getattr(self, field) for field in RatioQuestion.__slots__}
        return RatioWitness(values=values, **fields)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class RatioWitness(ByValue, RatioQuestion):
    """A set function on 2N elements, two per robot, with the threat and the planner it is bad for.

    ``values`` : (4**N,) integers, ``values[mask]`` the value of the subset ``mask``. Element ``i`` is the planner's
    choice for robot ``i``, element ``N + i`` that of another plan. ``values / values of the optimum`` is the
    normalised function; integers make every comparison of the replay exact.
    """

    values: IntArray = field(repr=False)

    def problem(self) -> Problem:
        """Return the instance, on the complete graph, for any planner and attacker of the library."""
        owners = np.tile(np.arange(self.n_robots), 2)
        return Problem(TableFunction(self.values), owners, None, self.alpha_s, self.alpha_c)


def scaled_values(values: Sequence[Fraction]) -> IntArray | None:
    """Multiply rationals by the least common multiple of their denominators; ``None`` where that exceeds 2**52."""
    scale = lcm(*(value.denominator for value in values))
    if scale * max(values) > LARGEST_VALUE:
        return None
    return readonly(np.array([int(value * scale) for value in values], dtype=np.int64))


def replay(witness: RatioWitness) -> Fraction:
    """Check that the function is of its class and return planner's worst-case value over optimum, exactly.

    Runs the library's planner, exact attacker and exhaustive optimum on the instance; raises ``ProofError`` where the
    function is not normalised, not of the class, exceeds its curvature, or has optimum 0.
    """
    _check(witness)
    problem = witness.problem()
    plan = PLANNERS[witness.planner](problem)
    attack = worst_case_attack(problem, plan.elements)
    if attack.stop is Stop.INTERRUPTED:
        raise KeyboardInterrupt  # whoever asked keeps a bracket of its own; this one is not exact
    optimum = exhaustive_optimum(problem).lower
    if optimum <= 0:
        raise ProofError("witness: the optimum must be positive")
    return Fraction(int(attack.upper), int(optimum))


def _check(witness: RatioWitness) -> None:
    """Raise ``ProofError`` unless the table is exactly what the witness says: definition by definition, in integers."""
    values, n = witness.values, witness.n_robots
    if len(values) != 4**n or values[0] != 0 or values.max() > LARGEST_VALUE:
        raise ProofError("witness: values must hold 4**N integers up to 2**52, the first 0")
    masks = np.arange(len(values))
    feasible = masks & masks >> n & (1 << n) - 1 == 0 if witness.domain == "feasible" else None
    check_class(FAMILIES[witness.family], values, witness.curvature, feasible)
