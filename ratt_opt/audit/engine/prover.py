"""Find a proof: non-negative multipliers of elementary inequalities that sum to the claim.

For all curvatures at once, multipliers are forms in ``t = 1-c`` and ``s = c``: with
``t + s = 1`` every row of degree r and the claim of degree D become homogeneous, and a
multiplier ``sum_a x_a t^a s^(D-r-a)`` with ``x_a >= 0`` is non-negative on [0, 1]. The
unknowns ``x_a`` solve one linear program, whose solution is rounded and re-checked.
"""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from math import comb
from typing import TYPE_CHECKING

import numpy as np

from ratt_opt.audit.engine.cone import elementary, elementary_keys
from ratt_opt.audit.engine.exact_systems import solve_exactly
from ratt_opt.audit.engine.linear_program import Program, solve
from ratt_opt.audit.engine.polynomial import ZERO, Polynomial, constant
from ratt_opt.audit.engine.proof import Proof, ProofStep, check_proof
from ratt_opt.errors import ProofError

if TYPE_CHECKING:
    from collections.abc import Iterator

    from ratt_opt._validation import FloatArray
    from ratt_opt.audit.engine.claim import Claim, Key, Linear
    from ratt_opt.audit.engine.cone import Elementary

__all__ = ["find_proof"]

_DENOMINATORS = (1, 12, 1000)
_NONZERO = 1e-9


@dataclass(frozen=True, slots=True)
class _Column:
    """One unknown: the power ``a`` of ``t`` in the multiplier of one inequality, and what it adds to the sum."""

    source: Elementary | int
    power: int
    degree: int
    entries: dict[tuple[Key, int], Fraction]


def find_proof(claim: Claim, *, feasible: bool, curvature: Fraction | None = None, extra: int = 0) -> Proof | None:
    """Return a checked proof, or ``None`` when none was found.

    Parameters
    ----------
    feasible : use only sets with one element per robot (a stronger statement)
    curvature : one value, or ``None`` for all values in [0, 1]
    extra : how much the multipliers' degree may exceed the claim's
    """
    if feasible and not _is_feasible(claim):
        return None
    degree = claim.conclusion.degree + extra if curvature is None else 0
    target = _entries(claim.conclusion, degree, 0, curvature)
    columns = list(_columns(claim, degree, curvature, feasible=feasible))
    answer = _multipliers(columns, target)
    if answer is None:
        return None
    for solution in _roundings(columns, target, answer):
        proof = _assemble(columns, solution, curvature, feasible=feasible)
        try:
            check_proof(claim, proof)
        except ProofError:
            continue
        return proof
    return None


def _is_feasible(claim: Claim) -> bool:
    expressions = [premise.expression for premise in claim.premises] + [claim.conclusion]
    return all(claim.ground.is_feasible(key) for e in expressions for key in e.terms if isinstance(key, int))


def _columns(claim: Claim, degree: int, curvature: Fraction | None, *, feasible: bool) -> Iterator[_Column]:
    rows: list[tuple[Elementary | int, Linear]] = [(i, p.expression) for i, p in enumerate(claim.premises)]
    for key in elementary_keys(claim.kind, claim.ground, feasible=feasible):
        rows.append((key, elementary(claim.kind, claim.ground, key).expression))
    for source, expression in rows:
        free = 0 if curvature is not None else degree - expression.degree
        for power in range(free + 1):
            yield _Column(source, power, free, _entries(expression, degree - free, power, curvature))


def _entries(
    expression: Linear, degree: int, power: int, curvature: Fraction | None
) -> dict[tuple[Key, int], Fraction]:
    """Coefficients of the expression (degree ``degree``) times ``t^power``, by value and power of ``t``, as forms."""
    if curvature is not None:
        return {(key, 0): value for key, c in expression.terms.items() if (value := c(1 - curvature))}
    return {
        (key, power + a): value
        for key, c in expression.terms.items()
        for a, value in enumerate(c.form(degree))
        if value
    }


def _multipliers(columns: list[_Column], target: dict[tuple[Key, int], Fraction]) -> FloatArray | None:
    rows = {name: i for i, name in enumerate(dict.fromkeys(k for c in [*columns] for k in c.entries))}
    if any(name not in rows for name in target):
        return None
    right = np.zeros(len(rows))
    for name, value in target.items():
        right[rows[name]] = float(value)
    count = len(columns)
    program = Program(
        cost=np.ones(count),
        columns=[[(rows[name], float(value)) for name, value in column.entries.items()] for column in columns],
        row_lower=right,
        row_upper=right,
        column_lower=np.zeros(count),
        column_upper=np.full(count, np.inf),
    )
    return solve(program)


def _roundings(
    columns: list[_Column], target: dict[tuple[Key, int], Fraction], answer: FloatArray
) -> Iterator[dict[int, Fraction]]:
    """Candidate rational multipliers: rounded, then the exact solution on the same non-zero unknowns."""
    support = [int(i) for i in np.flatnonzero(answer > _NONZERO)]
    for denominator in _DENOMINATORS:
        yield {i: Fraction(float(answer[i])).limit_denominator(denominator) for i in support}
    names = {
        name: j for j, name in enumerate(dict.fromkeys([*target, *(k for i in support for k in columns[i].entries)]))
    }
    exact = solve_exactly(
        [{names[k]: v for k, v in columns[i].entries.items()} for i in support],
        {names[k]: v for k, v in target.items()},
    )
    if exact is not None:
        yield dict(zip(support, exact, strict=True))


def _assemble(
    columns: list[_Column], solution: dict[int, Fraction], curvature: Fraction | None, *, feasible: bool
) -> Proof:
    multipliers: dict[Elementary | int, Polynomial] = {}
    for i, value in solution.items():
        column = columns[i]
        term = constant(value) if curvature is not None else _monomial(value, column.power, column.degree)
        multipliers[column.source] = multipliers.get(column.source, ZERO) + term
    steps = tuple(ProofStep(source, multiplier) for source, multiplier in multipliers.items() if multiplier)
    return Proof(steps=steps, curvature=curvature, feasible=feasible)


def _monomial(value: Fraction, power: int, degree: int) -> Polynomial:
    """``value * t^power (1-t)^(degree-power)``."""
    rest = degree - power
    signed = [value * comb(rest, j) * (-1) ** j for j in range(rest + 1)]
    return Polynomial((*[Fraction(0)] * power, *signed))
