"""An explicit instance on which a planner attains a ratio, and its exact replay through the library.

Two families show that no larger share than the pattern-free bounds holds for all teams: :func:`attaining_instance`
has ``1-k`` if ties go against RATT, and comes as close as wanted without ties; the ratios of :func:`limit_instance`
tend to ``(1-c)^2``. For one budget more is true (``bounds/survivors.py``). ``families.py`` has more of them.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from fractions import Fraction
from itertools import combinations
from math import lcm
from typing import TYPE_CHECKING

import numpy as np

from ratt_opt._validation import IntArray, readonly
from ratt_opt._values import ByValue
from ratt_opt.attack.exact import worst_case_attack
from ratt_opt.budget import uninterrupted
from ratt_opt.errors import InputError, ProofError
from ratt_opt.graph.survivor_sizes import caa
from ratt_opt.problem import Plan, Problem
from ratt_opt.setfunctions.base import TableFunction
from ratt_opt.solvers.exhaustive import exhaustive_optimum
from ratt_opt.solvers.ratt import greedy, myopic, ratt
from ratt_opt.worst_ratio.class_rows import NonDecreasing
from ratt_opt.worst_ratio.function_class import FunctionClass, check_class

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Sequence

__all__ = ["FAMILIES", "PLANNERS", "RatioQuestion", "RatioWitness", "attaining_instance", "limit_instance",
           "limit_ratio", "replay", "scaled_values"]  # fmt: skip

PLANNERS: dict[str, Callable[[Problem], Plan]] = {"ratt": ratt, "myopic": myopic, "greedy": greedy}

FAMILIES = {"submodular": FunctionClass.CURVATURE, "nondecreasing": FunctionClass.TOTAL_CURVATURE}

LARGEST_VALUE = 2**52
"""Sums and comparisons of integers up to here are exact in float64, in which the library's planners compute."""


@dataclass(frozen=True, slots=True, kw_only=True)
class RatioQuestion:
    """The subject of a worst ratio: a planner on N robots of the complete graph, a threat, a class of functions.

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
    """Multiply rationals by the least common multiple of their denominators; ``None`` if that exceeds 2**52."""
    scale = lcm(*(value.denominator for value in values))
    if scale * max(values) > LARGEST_VALUE:
        return None
    return readonly(np.array([int(value * scale) for value in values], dtype=np.int64))


def replay(witness: RatioWitness) -> Fraction:
    """Check that the function is of its class and return planner's worst-case value over optimum, exactly.

    Runs the library's planner, exact attacker and exhaustive optimum on the instance; raises ``ProofError`` if the
    function is not normalised, not of the class, exceeds its curvature, or has optimum 0.
    """
    _check(witness)
    problem = witness.problem()
    plan = PLANNERS[witness.planner](problem)
    attack = uninterrupted(worst_case_attack(problem, plan.elements))
    optimum = uninterrupted(exhaustive_optimum(problem)).lower
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


def attaining_instance(size: int, curvature: Fraction, epsilon: Fraction = Fraction(0)) -> RatioWitness:
    """Return the instance with ``N = 3 size`` robots, ``alpha_s = size`` on which RATT keeps exactly ``1 - curvature``.

    That is if ties go against RATT, by the order of the elements. With ``epsilon > 0`` RATT's choices are strictly
    the best, in whatever order elements come, and it keeps at most ``1 - curvature + 3/2 epsilon``.

    Let ``t = 1-k`` and m = ``size``. A weighted coverage function, hence submodular and non-decreasing. Each element
    covers an item of its own, and some share items: robots ``b`` (m of them), ``r`` (m) and ``v`` (m) have

    - ``b_i``: own t, and shared items ``W_1 .. W_m`` of weight ``k/m`` each; ``o(b_i)``: own 1;
    - ``r_j``: own t, and a shared item of weight k; ``o(r_j)``: own 1;
    - ``v_j``: own ``t - k/m``, and ``W_j``; ``o(v_j)``: own t, and the shared item of ``r_j``.

    *Class.* The own part of an element is its smallest marginal: t times its value 1, or for ``v_j``, worth t,
    ``t - k/m >= t^2`` as ``m t >= 1``. So the curvature is k.
    *RATT.* All robots' best single values are 1, so the first m robots, b, are the bait (ties by index). Greedy then
    takes the r, whose marginals stay 1 (no element has more), and then the v: ``v_j`` adds t, and so does
    ``o(v_j)`` beside ``r_j``. *Attack.* Blinding the r leaves ``m t + k + m (t - k/m) = 2 m t``. *Optimum.* The
    other plan covers no item twice: it is additive, 1 each, and keeps 2m whatever m robots are blinded. So the ratio
    is at most t, and the pattern-free theorem says at least t.
    *No ties.* The elements ``b`` get ``2 epsilon`` more of their own, ``r`` and ``v`` get ``epsilon``; curvature falls.
    The b are the best alone, then the r, and beside the r no element adds more than t but the v. What is left grows by
    ``3 m epsilon``.

    ``size`` is m >= 1; ``InputError`` unless ``curvature`` is in [0, 1 - 1/m]: above, ``v_j`` would exceed it.
    """
    if not 0 <= curvature <= 1 - Fraction(1, size):
        raise InputError("curvature", f"must be in [0, {1 - Fraction(1, size)}]", curvature)
    n, whole = 3 * size, curvature.denominator * size * epsilon.denominator
    part, more = int(whole * curvature) // size, int(whole * epsilon)
    kept = whole - size * part
    own = [kept + 2 * more] * size + [kept + more] * size + [kept - part + more] * size
    own += [whole] * (2 * size) + [kept] * size
    bait, removed, victims = range(size), range(size, 2 * size), range(2 * size, n)
    items: list[tuple[int, tuple[int, ...]]] = [(weight, (element,)) for element, weight in enumerate(own)]
    items += [(part, (*bait, v)) for v in victims]
    items += [(size * part, (r, n + v)) for r, v in zip(removed, victims, strict=True)]
    masks = np.arange(1 << 2 * n)
    values = sum(weight * (masks & _mask(covers) != 0).astype(np.int64) for weight, covers in items)
    question = RatioQuestion(n_robots=n, alpha_s=size, alpha_c=0, curvature=curvature, family="submodular")
    return question.witness(readonly(np.asarray(values)))


def limit_ratio(size: int, curvature: Fraction) -> Fraction:
    """``(1 + (g-1)(1-c)) / (1 + (g-1)/(1-c))`` for ``g = size`` robots left."""
    kept = 1 - curvature
    return (1 + (size - 1) * kept) / (1 + (size - 1) / kept)


def limit_instance(size: int, curvature: Fraction) -> RatioWitness:
    """Return the instance with ``N = 2 size`` robots, ``alpha_s = size`` on which RATT has :func:`limit_ratio`.

    Let ``t = 1-c``. Largest marginals are 1 for RATT's elements and ``1/t`` for the others. Prescribed: any number
    ``a >= 1`` of bait elements is worth ``1 + (a-1) t``; ``b`` greedy elements are worth ``b``, and with one other
    element ``b + 1``; ``d >= 1`` others are worth ``1 + (d-1)/t``. All single values are 1, so RATT picks its own
    elements by the tie rule. Blinding the greedy half leaves it ``1 + (g-1) t``; the other plan is worth
    ``1 + (g-1)/t`` whatever ``g`` robots are left.

    Such values extend to a function of total curvature c if for all prescribed sets ``f(X) - f(Y)`` is at most
    ``m(X-Y) - t m(Y-X)`` (see ``NonDecreasing``). Two sets of a kind differ by the difference of their sizes times t,
    1 or 1/t, within those bounds. Between kinds (first X, then Y; ``M`` is b greedy elements and one other):
    others, bait: ``t - 1/t <= 0``; bait, others: ``(a-1)(t-1) - (d-1)(1/t-1) <= 0``;
    others, greedy: ``1 - 1/t <= b(1-t)``; greedy, others: ``(d-1)(1-1/t) <= 0``;
    bait, greedy: ``(a-1)(t-1) <= b(1-t)``; greedy, bait: ``t <= 1``;
    others, M: ``b(t-1) <= 0`` with the same other, else ``1 - 1/t <= b(1-t)``; M, others: ``(d-1)(1-1/t) <= 0``, else
    ``d(1-1/t) <= 0``; M, bait: ``t <= 1/t``; bait, M: ``(a-1)(t-1) <= b(1-t)``; M and greedy: ``1 <= 1/t``.
    ``size`` is g >= 1, ``curvature`` c in [0, 1).
    """
    n, kept = 2 * size, 1 - curvature
    bait, greedy, others = range(size), range(size, n), range(n, 2 * n)
    known: dict[int, Fraction] = {}
    for count in range(1, n + 1):
        for chosen in combinations(others, count):
            known[_mask(chosen)] = 1 + (count - 1) / kept
        for chosen in combinations(bait, count):
            known[_mask(chosen)] = 1 + (count - 1) * kept
        for chosen in combinations(greedy, count):
            known[_mask(chosen)] = Fraction(count)
            for other in others:
                known[_mask((*chosen, other))] = Fraction(count + 1)
    part = NonDecreasing(n, curvature, list(known))
    point = [Fraction(0), *[Fraction(1)] * n, *[1 / kept] * n, *known.values()]
    values = scaled_values(part.table(point, list(known)))
    assert values is not None, "small integers"
    question = RatioQuestion(n_robots=n, alpha_s=size, alpha_c=0, curvature=curvature, family="nondecreasing")
    return question.witness(values)


def _mask(elements: Iterable[int]) -> int:
    return sum(1 << e for e in elements)
