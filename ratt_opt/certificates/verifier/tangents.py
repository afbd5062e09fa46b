"""Linear bounds by Fenchel points, of all targets together or of one.

Notation, per target: ``<A, B> = tr(A B)`` and ``L(S) = prior^{-1} + sum of the information of S``.
"""

from __future__ import annotations

from functools import cache, partial
from typing import TYPE_CHECKING, Any, NamedTuple

from flint import arb, fmpq, fmpq_mat

from ratt_opt.certificates.verifier import reading
from ratt_opt.certificates.verifier.exact_matrices import definite, total, trace
from ratt_opt.certificates.verifier.limits import limits
from ratt_opt.certificates.verifier.reading import array, exact, index, need, packed, rows_of
from ratt_opt.certificates.verifier.work import afford, hold, tick

if TYPE_CHECKING:
    from ratt_opt.certificates.verifier.statement import Statement

__all__ = ["Bound", "StatedTangent", "read_points", "read_tangents", "seers_of"]


class Bound(NamedTuple):
    """``phi(S) <= constant + sum of scores[e] over e in S`` for every set of elements."""

    scores: list[fmpq]
    constant: Any


class Seers(NamedTuple):
    """Elements with information about one target, and the entries of their matrices, a row each."""

    elements: tuple[int, ...]
    matrices: fmpq_mat


class StatedTangent(NamedTuple):
    """``phi_j(S) <= constant + sum of <weight, information[e]> over e in S`` for one target ``j``.

    The value of one target is its term of the trace or of the log-det. For the max-eigenvalue it is what that would be
    if the target's posterior were the largest, so no less than the criterion.
    """

    target: int
    weight: fmpq_mat
    constant: Any
    seers: Seers

    def scores(self) -> dict[int, fmpq]:
        """Scores of the elements that see the target; computed anew, as a file may state many tangents."""
        return dict(zip(self.seers.elements, (self.seers.matrices * self.weight).entries(), strict=True))


def seers_of(about: Statement, target: int) -> tuple[int, ...]:
    """Elements that have information about a target."""
    blank = fmpq_mat(about.d, about.d)
    return tuple(e for e, row in enumerate(about.information) if row[target] != blank)


def read_points(about: Statement, points: object) -> list[Bound]:
    """Return for each Fenchel point the score of every element, and the constant of its bound."""
    width = len(about.prior) * about.d**2
    given = array("points", points)
    reading.check_size("points", len(given) * max(width, len(about.owner)), limits().cells)
    fenchel = [_of_all_targets(about, point) for point in given]
    columns = [x for row in about.information for matrix in row for x in matrix.entries()]
    turned = fmpq_mat(len(about.owner), width, columns).transpose()
    scores: list[list[fmpq]] = []
    size = limits().block
    for k in range(0, len(fenchel), size):
        rows = [x for row, _ in fenchel[k : k + size] for x in row]
        block = (fmpq_mat(len(rows) // width, width, rows) * turned).tolist()
        tick()
        for row in block:
            hold(max(row, key=lambda x: int(x.q)), len(row))
        scores += block
    return [Bound(own, constant) for own, (_, constant) in zip(scores, fenchel, strict=True)]


def read_tangents(about: Statement, tangents: object) -> list[StatedTangent]:
    """Return the tangents of single targets: ``[target, Y]``, or ``[target, t, v]`` as points of the max-eigenvalue."""
    given = array("tangents", tangents)
    reading.check_size("tangents", len(given) * about.d**2, limits().cells)
    found, seers = list[StatedTangent](), cache(partial(_seers, about))
    for stated in given:
        tick()
        j, *touch = array("tangent", stated, 3 if about.objective == "maxeig" else 2)
        j = index("tangent target", j, len(about.prior))
        weight, constant = _of_target(about, j, touch if about.objective == "maxeig" else touch[0])
        for x in (*weight.entries(), *([constant] if isinstance(constant, fmpq) else [])):
            hold(x)
        found.append(StatedTangent(j, fmpq_mat(about.d**2, 1, weight.entries()), constant, seers(j)))
    return found


def _seers(about: Statement, target: int) -> Seers:
    elements = seers_of(about, target)
    entries = [x for e in elements for x in about.information[e][target].entries()]
    return Seers(elements, fmpq_mat(len(elements), about.d**2, entries))


def _of_all_targets(about: Statement, point: object) -> tuple[list[fmpq], Any]:
    """Return ``(W, c)`` with ``phi(S) <= c + sum over e in S of <W, information[e]>`` for every S."""
    tick()
    m = len(about.prior)
    if about.objective == "maxeig":
        target, *touch = array("point", point, 3)
        j, blank = index("point target", target, m), [fmpq(0)] * about.d**2
        weight, constant = _of_target(about, j, touch)
        return blank * j + weight.entries() + blank * (m - j - 1), constant
    parts = [_of_target(about, j, given) for j, given in enumerate(array("point", point, m))]
    return [x for weight, _ in parts for x in weight.entries()], total(constant for _, constant in parts)


def _of_target(about: Statement, j: int, touch: Any) -> tuple[fmpq_mat, Any]:
    """Return ``(W, c)`` with ``phi_j(S) <= c + sum over e in S of <W, information[e][j]>`` for every S.

    trace:  tr(C L^{-1} C') >= 2 tr(C Y) - tr(Y' L Y), from (L^{-1} C' - Y)' L (L^{-1} C' - Y) >= 0; W = w Y Y'.
    logdet: logdet L <= tr(Y L) - logdet Y - d, from log x <= x - 1 for the eigenvalues of Y L; W = w Y.
    maxeig: lambda_max(C L^{-1} C') >= 1/q >= 2t - t^2 q with q = v'Lv / |Cv|^2; W = w t^2 vv' / |Cv|^2.
    With u = Cv / |Cv| and z = C'u, (z'v)^2 <= (z' L^{-1} z) (v'Lv) (Cauchy), and z'v = |Cv|.
    """
    d, w, c, inverse = about.d, about.weights[j], about.output[j], about.inverse[j]
    if about.objective == "maxeig":
        size, vector = touch
        t, v = exact("point t", size), fmpq_mat(d, 1, [exact("point v", x) for x in array("point v", vector, d)])
        seen = (v.transpose() * about.square[j] * v)[0, 0]
        need(seen > 0, "upper proof: a direction v is zero, or so is its output")
        weight = v * v.transpose() * (w * t * t / seen)
        return weight, about.prior_high - 2 * w * t + trace(weight * inverse)
    y = _touched(about, touch, c)
    if about.objective == "logdet":
        need(definite(y) > 0, "upper proof: a Fenchel point Y is not positive definite")
        product = y * inverse
        afford(product)
        weight, constant = y * w, -w * d - w * arb(product.det()).log()
    else:
        weight = y * y.transpose() * w
        constant = about.prior_traces[j] - 2 * w * trace(c * y)
    return weight, constant + trace(weight * inverse)


def _touched(about: Statement, given: object, c: fmpq_mat) -> fmpq_mat:
    """Y (d, q) of one target, which is symmetric if the whole state counts."""
    if about.is_whole:
        return packed("point Y", given, about.d)
    return rows_of("point Y", array("point Y", given, c.nrows() * c.ncols()), c.nrows())
