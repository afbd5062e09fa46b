"""Find a proof: non-negative multipliers of elementary inequalities that sum to the claim.

For all curvatures at once, multipliers are forms in ``t = 1-c`` and ``s = c``: with ``t + s = 1`` every row of degree r
and the claim of degree D become homogeneous, and a multiplier ``sum_a x_a t^a s^(D-r-a)`` with ``x_a >= 0`` is
non-negative on [0, 1]. The unknowns ``x_a`` solve one linear program, whose solution is rounded and re-checked.
"""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from typing import TYPE_CHECKING

import numpy as np

from ratt_audit.engine.claim import elementary, elementary_keys
from ratt_audit.engine.evidence import Proof, ProofStep, check_proof
from ratt_audit.engine.pace import program_seconds
from ratt_audit.engine.polynomials import ONE, ZERO, Polynomial, T, constant
from ratt_opt.errors import ProofError
from ratt_opt.highs import LinearProgram, Rows
from ratt_opt.worst_ratio.rationals import solve_exactly

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from ratt_audit.engine.claim import Claim, Elementary, Key, Linear
    from ratt_opt._validation import FloatArray

    Entries = dict[tuple[Key, int], Fraction]
    """Coefficients by value and power of ``t``: the rows of the linear program."""

__all__ = ["find_proof"]

DENOMINATORS = (1, 12, 1000)
"""Rounded multipliers are tried over these, simplest first: a proof in twelfths is shorter to read than the vertex."""
NONZERO = 1e-9
"""Multipliers below this are the solver's rounding of zero; its own feasibility tolerance is a hundred times larger."""


@dataclass(frozen=True, slots=True)
class _Column:
    """One unknown: the power ``a`` of ``t`` in the multiplier of one inequality, and what it adds to the sum."""

    source: Elementary | int
    power: int
    degree: int
    entries: Entries

    def multiplier(self, value: Fraction) -> Polynomial:
        """``value * t^power (1-t)^(degree-power)``."""
        return constant(value) * T**self.power * (ONE - T) ** (self.degree - self.power)


def find_proof(claim: Claim, *, feasible: bool, curvature: Fraction | None = None, extra: int = 0) -> Proof | None:
    """Return a checked proof, or ``None`` when none was found.

    Parameters
    ----------
    feasible : use only sets with one element per robot (a stronger statement)
    curvature : one value, or ``None`` for all values in [0, 1]
    extra : how much the multipliers' degree may exceed the claim's
    """
    if feasible and not all(map(claim.ground.is_feasible, claim.sets)):
        return None
    degree = claim.conclusion.degree + extra if curvature is None else 0
    target = _entries(claim.conclusion, degree, 0, curvature)
    columns = list(_columns(claim, degree, curvature, feasible=feasible))
    answer = _claimed_multipliers(columns, target)
    if answer is None:
        return None
    for solution in _roundings(columns, target, answer):
        proof = Proof(steps=_steps(columns, solution), curvature=curvature, feasible=feasible)
        try:
            check_proof(claim, proof)
        except ProofError:
            continue
        return proof
    return None


def _columns(claim: Claim, degree: int, curvature: Fraction | None, *, feasible: bool) -> Iterator[_Column]:
    rows: list[tuple[Elementary | int, Linear]] = [(i, p.expression) for i, p in enumerate(claim.premises)]
    for key in elementary_keys(claim.function_class, claim.ground, feasible=feasible):
        rows.append((key, elementary(claim.function_class, claim.ground, key).expression))
    for source, expression in rows:
        free = 0 if curvature is not None else degree - expression.degree
        for power in range(free + 1):
            yield _Column(source, power, free, _entries(expression, degree - free, power, curvature))


def _entries(expression: Linear, degree: int, power: int, curvature: Fraction | None) -> Entries:
    """Coefficients of the expression (degree ``degree``) times ``t^power``, as forms."""
    if curvature is not None:
        return {(key, 0): value for key, c in expression.terms.items() if (value := c(1 - curvature))}
    return {
        (key, power + a): value
        for key, c in expression.terms.items()
        for a, value in enumerate(c.form(degree))
        if value
    }


def _claimed_multipliers(columns: Sequence[_Column], target: Entries) -> FloatArray | None:
    rows = {name: i for i, name in enumerate(dict.fromkeys(name for column in columns for name in column.entries))}
    if any(name not in rows for name in target):
        return None
    right = np.array([float(target.get(name, 0)) for name in rows])
    matrix = Rows(
        lower=right,
        upper=right,
        starts=np.cumsum([0, *(len(column.entries) for column in columns)]),
        columns=np.array([rows[name] for column in columns for name in column.entries], dtype=np.int64),
        values=np.array([float(value) for column in columns for value in column.entries.values()]),
        by_columns=True,
    )
    claimed = LinearProgram(np.ones(len(columns)), rows=matrix).solve(program_seconds())
    program_seconds()  # a program that was cut short says nothing
    return claimed.x if claimed.is_optimal else None


def _roundings(columns: Sequence[_Column], target: Entries, answer: FloatArray) -> Iterator[dict[int, Fraction]]:
    """Candidate rational multipliers: rounded, then the exact solution on the same non-zero unknowns."""
    support = [int(i) for i in np.flatnonzero(answer > NONZERO)]
    for denominator in DENOMINATORS:
        yield {i: Fraction(float(answer[i])).limit_denominator(denominator) for i in support}
    names = dict.fromkeys([*target, *(name for i in support for name in columns[i].entries)])
    index = {name: j for j, name in enumerate(names)}
    numbered = [{index[name]: v for name, v in e.items()} for e in (*(columns[i].entries for i in support), target)]
    exact = solve_exactly(numbered[:-1], numbered[-1])
    if exact is not None:
        yield dict(zip(support, exact, strict=True))


def _steps(columns: Sequence[_Column], solution: dict[int, Fraction]) -> tuple[ProofStep, ...]:
    multipliers: dict[Elementary | int, Polynomial] = {}
    for i, value in solution.items():
        source = columns[i].source
        multipliers[source] = multipliers.get(source, ZERO) + columns[i].multiplier(value)
    return tuple(ProofStep(source, multiplier) for source, multiplier in multipliers.items() if multiplier)
