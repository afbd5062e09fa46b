"""An explicit instance on which a planner attains a ratio, and its exact replay through the library."""

from __future__ import annotations

from dataclasses import dataclass, field
from fractions import Fraction
from math import lcm
from typing import TYPE_CHECKING

import numpy as np

from ratt_opt._validation import IntArray, readonly
from ratt_opt.attackers.exact import worst_case_attack
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

__all__ = ["PLANNERS", "RatioQuestion", "RatioWitness", "replay", "scaled_values"]

PLANNERS: dict[str, Callable[[Problem], Plan]] = {"ratt": ratt, "myopic": myopic, "greedy": greedy}

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
class RatioWitness(RatioQuestion):
    """A set function on 2N elements, two per robot, with the threat and the planner it is bad for.

    ``values`` : (4**N,) integers, ``values[mask]`` the value of the subset ``mask``. Element ``i`` is the planner's
    choice for robot ``i``, element ``N + i`` that of another plan. ``values / values of the optimum`` is the
    normalised function; integers make every comparison of the replay exact.
    """

    values: IntArray = field(repr=False)

    def _key(self) -> tuple[object, ...]:
        return (*(getattr(self, name) for name in RatioQuestion.__slots__), self.values.tobytes())

    def __eq__(self, other: object) -> bool:
        return isinstance(other, RatioWitness) and self._key() == other._key()

    def __hash__(self) -> int:
        return hash(self._key())

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

    Runs the library's planner, exact attacker and exhaustive optimum on the instance.

    Raises
    ------
    ProofError : the function is not normalised, not of the class, exceeds its curvature, or has optimum 0.
    """
    check_class(witness)
    problem = witness.problem()
    plan = PLANNERS[witness.planner](problem)
    attack = worst_case_attack(problem, plan.elements)
    if attack.stop is Stop.INTERRUPTED:
        raise KeyboardInterrupt  # whoever asked keeps a bracket of its own; this one is not exact
    optimum = exhaustive_optimum(problem).lower
    if optimum <= 0:
        raise ProofError("witness: the optimum must be positive")
    return Fraction(int(attack.upper), int(optimum))


def check_class(witness: RatioWitness) -> None:
    """Raise ``ProofError`` unless the table is exactly what the witness says: definition by definition, in integers."""
    values, n = witness.values, 2 * witness.n_robots
    if len(values) != 1 << n or values[0] != 0 or values.max() > LARGEST_VALUE:
        raise ProofError("witness: values must hold 4**N integers up to 2**52, the first 0")
    masks = np.arange(1 << n)
    for x in range(n):
        contexts = masks[masks >> x & 1 == 0]
        marginal = values[contexts | 1 << x] - values[contexts]
        if marginal.min() < 0:
            raise ProofError(f"witness: element {x} has a negative marginal")
        for y in range(x + 1, n) if witness.family == "submodular" else ():
            without = contexts >> y & 1 == 0
            after = values[contexts[without] | 1 << x | 1 << y] - values[contexts[without] | 1 << y]
            if (after > marginal[without]).any():
                raise ProofError(f"witness: diminishing returns fail for elements {x} and {y}")
        _check_curvature(witness, x, contexts, marginal)


def _check_curvature(witness: RatioWitness, x: int, contexts: IntArray, marginal: IntArray) -> None:
    if witness.domain == "feasible":
        n = witness.n_robots
        feasible = (contexts & contexts >> n == 0) & (contexts >> (x % n) & 1 == 0) & (contexts >> (x % n + n) & 1 == 0)
        marginal = marginal[feasible]
    # Contexts are ascending, so the first marginal is the value of the element alone.
    largest = int(marginal[0]) if witness.family == "submodular" else int(marginal.max())
    if int(marginal.min()) < (1 - witness.curvature) * largest:
        raise ProofError(f"witness: element {x} exceeds the curvature {witness.curvature}")
