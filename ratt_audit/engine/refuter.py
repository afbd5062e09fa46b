"""Find a counterexample: a function of the class, over all sets, that breaks the claim."""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from math import inf, lcm
from typing import TYPE_CHECKING

import numpy as np

from ratt_audit.engine.claim import elementary, elementary_keys, largest_marginal
from ratt_audit.engine.evidence import Witness, check_witness, values_of
from ratt_audit.engine.pace import program_seconds
from ratt_opt.errors import ProofError
from ratt_opt.highs import LinearProgram, rows_of
from ratt_opt.worst_ratio.rationals import solve_exactly

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

    from ratt_audit.engine.claim import Claim, Key, Linear
    from ratt_opt._validation import FloatArray

    Row = Mapping[int, Fraction]
    """Coefficients by unknown."""

__all__ = ["LARGEST_GROUND", "find_witness", "least_ratio"]

DENOMINATORS = (1, 2, 4, 12, 120, 5040, 10**6)
"""Rounded values are tried over these, simplest first: the smaller, the smaller the integers of the counterexample."""
ACTIVE = 1e-8
"""Rows this close to zero are taken for active at the solver's vertex, ten times within its feasibility tolerance."""
LARGEST_GROUND = 10
"""Elements up to which counterexamples are looked for: one more doubles the unknowns (10: 0.9 s; 11: 4 s)."""


@dataclass(frozen=True, slots=True)
class _Cone:
    """The cone over all sets at one ``t = 1 - curvature``, premises first: rows that are at least zero.

    ``index`` numbers the values of the non-empty sets by bit mask, then the other numbers by name.
    """

    claim: Claim
    t: Fraction
    index: dict[Key, int]
    rows: list[Row]

    @staticmethod
    def of(claim: Claim, curvature: Fraction | None) -> _Cone:
        """The cone of a claim's class and premises."""
        t, ground = 1 - (curvature or Fraction(0)), claim.ground
        rows = [premise.expression for premise in claim.premises]
        keys = elementary_keys(claim.function_class, ground, feasible=False)
        rows += [elementary(claim.function_class, ground, key).expression for key in keys]
        others = {k for row in (*rows, claim.conclusion) for k in row.terms if isinstance(k, str)}
        names: list[Key] = [*range(1, 1 << ground.n), *sorted(others)]
        index = {name: j for j, name in enumerate(names)}
        numbered: list[Row] = [{index[k]: v for k, c in row.terms.items() if (v := c(t))} for row in rows]
        return _Cone(claim, t, index, numbered)

    def numbered(self, expression: Linear) -> Row:
        """Coefficients of an expression by unknown."""
        return {self.index[k]: c(self.t) for k, c in expression.terms.items()}

    def minimise(self, objective: Row, unit: Row | None = None) -> FloatArray | None:
        """Claimed minimiser within the unit box, or on ``unit = 1`` if one is given."""
        cost = np.zeros(len(self.index))
        cost[list(objective)] = [float(value) for value in objective.values()]
        marginals = {largest_marginal(self.claim.ground, x) for x in range(self.claim.ground.n)}
        free = np.array([isinstance(name, str) and name not in marginals for name in self.index])
        least, lower, upper = np.zeros(len(self.rows)), np.where(free, -1.0, 0.0), np.ones(len(free))
        upper[[name in marginals for name in self.index]] = inf
        most, rows = np.full(len(self.rows), inf), self.rows
        if unit is not None:
            rows, least, most = [*rows, unit], np.append(least, 1.0), np.append(most, 1.0)
            lower, upper = np.where(free, -inf, 0.0), np.full(len(free), inf)
        entries = [(list(row), [float(value) for value in row.values()]) for row in rows]
        claimed = LinearProgram(cost, lower, upper, rows=rows_of(entries, least, most)).solve(program_seconds())
        program_seconds()  # a program that was cut short says nothing
        return claimed.x if claimed.is_optimal else None


def find_witness(claim: Claim, *, curvature: Fraction | None) -> Witness | None:
    """Return a checked counterexample at one curvature, or ``None`` when none was found.

    The function is scaled to at most 1 on the whole ground set, which loses nothing: claims are homogeneous.
    """
    if claim.ground.n > LARGEST_GROUND:
        return None
    cone = _Cone.of(claim, curvature)
    objective = cone.numbered(claim.conclusion)
    answer = cone.minimise(objective)
    if answer is None or _value(objective, answer) > -ACTIVE:
        return None
    for point in _rational_points(cone, answer):
        witness = _as_witness(claim, dict(zip(cone.index, point, strict=True)), curvature)
        try:
            check_witness(claim, witness)
        except ProofError:
            continue
        return witness
    return None


def least_ratio(claim: Claim, left: Linear, right: Linear, *, curvature: Fraction | None) -> float | None:
    """Return the claimed least ``left`` on functions of the claim with ``right = 1`` (floating point)."""
    if claim.ground.n > LARGEST_GROUND:
        return None
    cone = _Cone.of(claim, curvature)
    objective = cone.numbered(left)
    answer = cone.minimise(objective, unit=cone.numbered(right))
    return None if answer is None else _value(objective, answer)


def _value(row: Row, point: FloatArray) -> float:
    return float(sum(float(value) * point[j] for j, value in row.items()))


def _rational_points(cone: _Cone, answer: FloatArray) -> Iterator[list[Fraction]]:
    """Candidate rational points: rounded, then the exact vertex of the active rows with the largest set's value."""
    for denominator in DENOMINATORS:
        yield [Fraction(float(v)).limit_denominator(denominator) for v in answer]
    scale = cone.index[(1 << cone.claim.ground.n) - 1]
    active: list[Row] = [row for row in cone.rows if abs(_value(row, answer)) < ACTIVE]
    active.append({scale: Fraction(1)})
    columns: list[dict[int, Fraction]] = [{} for _ in answer]
    for i, row in enumerate(active):
        for j, value in row.items():
            columns[j][i] = value
    exact = solve_exactly(columns, {len(active) - 1: Fraction(float(answer[scale])).limit_denominator(10**6)})
    if exact is not None:
        yield exact


def _as_witness(claim: Claim, point: dict[Key, Fraction], curvature: Fraction | None) -> Witness:
    """Scale the values to the smallest integers."""
    table = [Fraction(0), *(point[mask] for mask in range(1, 1 << claim.ground.n))]
    factor = lcm(*(value.denominator for value in table))
    auxiliary = {name: point[name] * factor for name in claim.auxiliaries}
    values = tuple(int(value * factor) for value in table)
    t = 1 - (curvature or Fraction(0))
    return Witness(
        names=claim.ground.names,
        values=values,
        auxiliary=auxiliary,
        curvature=curvature if claim.function_class.is_parametric else None,
        violation=-claim.conclusion.value(values_of(values, auxiliary), t),
    )
