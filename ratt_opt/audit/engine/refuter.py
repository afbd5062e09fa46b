"""Find a counterexample: a function of the class, over all sets, that breaks the claim."""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from math import lcm
from typing import TYPE_CHECKING

import numpy as np

from ratt_opt.audit.engine.cone import elementary, elementary_keys
from ratt_opt.audit.engine.exact_systems import solve_exactly
from ratt_opt.audit.engine.linear_program import Program, solve
from ratt_opt.audit.engine.proof import Witness, check_witness
from ratt_opt.errors import ProofError

if TYPE_CHECKING:
    from collections.abc import Iterator

    from ratt_opt._validation import FloatArray
    from ratt_opt.audit.engine.claim import Claim, Key, Linear

__all__ = ["LARGEST_GROUND", "cone_rows", "find_witness", "least_ratio"]

_DENOMINATORS = (1, 2, 4, 12, 120, 5040, 10**6)
_ACTIVE = 1e-8
LARGEST_GROUND = 10


def cone_rows(claim: Claim) -> list[Linear]:
    """Every row of the cone over all sets, premises first; each is at least zero."""
    rows = [premise.expression for premise in claim.premises]
    keys = elementary_keys(claim.kind, claim.ground, feasible=False)
    rows.extend(elementary(claim.kind, claim.ground, key).expression for key in keys)
    return rows


@dataclass(frozen=True, slots=True)
class _Cone:
    """The cone's rows at one curvature, over numbered unknowns."""

    names: list[Key]
    index: dict[Key, int]
    rows: list[dict[int, Fraction]]

    def numbered(self, expression: Linear, t: Fraction) -> dict[int, Fraction]:
        return {self.index[k]: c(t) for k, c in expression.terms.items()}


def _cone(claim: Claim, t: Fraction) -> _Cone:
    rows = cone_rows(claim)
    names: list[Key] = [*range(1, 1 << claim.ground.n)]
    names += sorted({k for row in [*rows, claim.conclusion] for k in row.terms if isinstance(k, str)})
    index = {name: j for j, name in enumerate(names)}
    numbered = [{index[k]: value for k, c in row.terms.items() if (value := c(t))} for row in rows]
    return _Cone(names, index, numbered)


def find_witness(claim: Claim, *, curvature: Fraction | None) -> Witness | None:
    """Return a checked counterexample at one curvature, or ``None`` when none was found.

    The function is scaled to at most 1 on the whole ground set, which loses nothing: claims are homogeneous.
    """
    if claim.ground.n > LARGEST_GROUND:
        return None
    t = 1 - (curvature or Fraction(0))
    cone = _cone(claim, t)
    objective = cone.numbered(claim.conclusion, t)
    answer = _minimise(cone.rows, objective, cone.names)
    if answer is None or sum(float(v) * answer[j] for j, v in objective.items()) > -_ACTIVE:
        return None
    for point in _rational_points(cone.rows, answer, scale=cone.index[(1 << claim.ground.n) - 1]):
        witness = _as_witness(claim, dict(zip(cone.names, point, strict=True)), curvature)
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
    t = 1 - (curvature or Fraction(0))
    cone = _cone(claim, t)
    unit = cone.numbered(right, t)
    answer = _minimise(cone.rows, cone.numbered(left, t), cone.names, unit=unit)
    return None if answer is None else float(sum(float(v) * answer[j] for j, v in cone.numbered(left, t).items()))


def _minimise(
    rows: list[dict[int, Fraction]],
    objective: dict[int, Fraction],
    names: list[Key],
    unit: dict[int, Fraction] | None = None,
) -> FloatArray | None:
    """Minimise over the cone: within the unit box, or on ``unit = 1`` where one is given."""
    if unit is not None:
        rows = [*rows, unit]
    columns: list[list[tuple[int, float]]] = [[] for _ in names]
    for i, row in enumerate(rows):
        for j, value in row.items():
            columns[j].append((i, float(value)))
    cost = np.zeros(len(names))
    for j, value in objective.items():
        cost[j] = float(value)
    upper = np.array([np.inf if isinstance(name, str) and name.startswith("m(") else 1.0 for name in names])
    lower = np.array([-1.0 if isinstance(name, str) and not name.startswith("m(") else 0.0 for name in names])
    row_lower, row_upper = np.zeros(len(rows)), np.full(len(rows), np.inf)
    if unit is not None:
        row_lower[-1] = row_upper[-1] = 1.0
        lower, upper = np.where(lower < 0, -np.inf, lower), np.full(len(names), np.inf)
    program = Program(
        cost=cost,
        columns=columns,
        row_lower=row_lower,
        row_upper=row_upper,
        column_lower=lower,
        column_upper=upper,
    )
    return solve(program)


def _rational_points(rows: list[dict[int, Fraction]], answer: FloatArray, scale: int) -> Iterator[list[Fraction]]:
    """Candidate rational points: rounded, then the exact vertex of the rows that are active, scaled by one unknown."""
    for denominator in _DENOMINATORS:
        yield [Fraction(float(v)).limit_denominator(denominator) for v in answer]
    active = [row for row in rows if abs(sum(float(v) * answer[j] for j, v in row.items())) < _ACTIVE]
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
    known: dict[Key, Fraction] = {mask: Fraction(v) for mask, v in enumerate(values)}
    known.update(auxiliary)
    t = 1 - (curvature or Fraction(0))
    return Witness(
        names=claim.ground.names,
        values=values,
        auxiliary=auxiliary,
        curvature=curvature if claim.kind.is_parametric else None,
        violation=-claim.conclusion.value(known, t),
    )
