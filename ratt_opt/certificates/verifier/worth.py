"""Decide exactly whether sets of one plan's robots reach a claimed value; all tests are about one claim.

The matrices of a target are integers over one unit, so that sums of them are exact and quick. Of a matrix L the ends
of its characteristic polynomial p are enough: ``|p(0)| = det L`` and ``-p'(0) / p(0) = tr(L^{-1})``, as both sides of
the latter are the sum of ``1 / x`` over the eigenvalues x. The eigenvalues of a 2 x 2 matrix are the roots of p.
"""

from __future__ import annotations

from functools import cache, reduce
from math import isqrt, lcm, prod
from operator import add
from typing import TYPE_CHECKING, Any

from flint import arb, ctx, fmpq, fmpq_mat, fmpz_mat

from ratt_opt.certificates.verifier.exact_matrices import definite, total, trace
from ratt_opt.certificates.verifier.limits import limits
from ratt_opt.certificates.verifier.reading import need, places
from ratt_opt.certificates.verifier.work import afford, hold, tick

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

    from ratt_opt.certificates.verifier.statement import Statement

__all__ = ["Known", "Worth"]

Known = list[int]
"""L of a set of robots that sense for sure, less the plan's defects: each target's lower triangle over its unit."""


class Worth:
    """Exact test whether unblinded robots S that are known to be in one group are worth ``lower``.

    The group's L is at least L(S) minus the plan's defects, in the Loewner order, so the group is worth at least the
    criterion there. ``nobody`` : the set without robots, as :meth:`plus` extends it
    """

    def __init__(self, about: Statement, lower: fmpq) -> None:
        self.about, self.lower = about, lower
        defects = [total(about.defect[e][j] for e in about.plan) for j in range(len(about.prior))]
        start = [a - about.identity * delta for a, delta in zip(about.inverse, defects, strict=True)]
        rows = [start, *(about.information[e] for e in about.plan)]
        self._units = [lcm(*(int(m.numer_denom()[1]) for m in column)) for column in zip(*rows, strict=True)]
        self.nobody, *self._own = map(self._in_units, rows)
        self._copies, self._scales = cache(self._copies_of), cache(self._scales_at)
        self._logarithms = cache(self._logarithms_at)

    def _in_units(self, row: list[fmpq_mat]) -> Known:
        tick()
        known: Known = []
        for m, unit in zip(row, self._units, strict=True):
            numerators, denominator = m.numer_denom()
            known += [
                int(numerators[i, j]) * (unit // int(denominator)) for i in range(self.about.d) for j in range(i + 1)
            ]
        return _held(known)

    def plus(self, known: Known, robot: int) -> Known:
        """The set with one robot more."""
        return list(map(add, known, self._own[robot]))

    def of(self, robots: Iterable[int]) -> Known:
        """The set of these robots."""
        return reduce(self.plus, robots, self.nobody)

    def require(self, known: Known, others: Iterable[int] = (), count: int = 0) -> None:
        """Check that the set is worth it: alone, or with any ``count`` of the ``others``.

        With r = count robots T, L(S + T) is the average over T of L(S) + r information[i], and phi is concave in L: it
        is worth the average there at least.
        """
        cases = [list(map(add, known, self._copies(i, count))) for i in others] or [known]
        worth = any(self._are_worth(precision, cases, count or 1) for precision in limits().precisions)
        need(worth, "lower proof: a leaf is worth less than the claim")

    def _copies_of(self, robot: int, times: int) -> Known:
        return _held([times * x for x in self._own[robot]])

    def _are_worth(self, precision: int, cases: list[Known], count: int) -> bool:
        """Test whether any ``count`` of the cases (all positive definite) reach the claim on average."""
        about, lower = self.about, self.lower
        if lower <= 0 and all(self._is_at_least(about.inverse, x) for x in cases):
            return True  # at least the prior's information is worth at least phi(empty set) = 0
        if about.objective != "maxeig" or (about.d == 2 and about.is_whole):
            with ctx.workprec(precision):
                return bool(total(sorted(self.value(x, precision) for x in cases)[:count]) >= lower * count)
        # Each case is worth it if lambda_max(C L^{-1} C') <= room / w for its targets. With L > 0 that is
        # L - (w / room) C'C >= 0: both say that [[L, C'], [C, (room / w) I]] >= 0 (Schur).
        room = about.prior_low - lower
        if room <= 0:
            return False
        needed = [square * (w / room) for w, square in zip(about.weights, about.square, strict=True)]
        return all(self._is_at_least(needed, x) for x in cases)

    def _is_at_least(self, needed: list[fmpq_mat], known: Known) -> bool:
        parts = zip(self._matrices(known), needed, self._units, strict=True)
        return all(definite(fmpq_mat(m) - least * fmpq(unit)) >= 0 for m, least, unit in parts)

    def value(self, known: Known, precision: int) -> Any:
        """Return a lower bound on the criterion (max-eigenvalue: of two coordinates), sharper at a higher precision."""
        tick()
        about = self.about
        if about.objective == "logdet":
            sizes = [abs(p_0) for p_0, _ in self._ends(known)]
            logs = ((w, arb(prod(sizes[j] for j in own)).log() - log) for w, own, log in self._logarithms(precision))
            return total(w * log for w, log in logs).lower()
        if about.objective == "maxeig":
            return about.prior_low - fmpq(self._largest_error(known, precision), 1 << precision)
        return about.prior_trace - fmpq(sum(self._errors(known, precision)), 1 << precision)

    def _errors(self, known: Known, precision: int) -> Iterator[int]:
        """Compute each target's weighted trace in units of ``2^-precision``, rounded up."""
        scales = self._scales(precision)
        if self.about.is_whole:
            return (-(scale * p_1 // p_0) for scale, (p_0, p_1) in zip(scales, self._ends(known), strict=True))
        parts = zip(scales, self.about.square, self._matrices(known), strict=True)
        return (int((trace(square * m.inv()) * scale).ceil()) for scale, square, m in parts)

    def _largest_error(self, known: Known, precision: int) -> int:
        """The largest weighted eigenvalue of targets of two coordinates, likewise; none exceeds its trace."""
        largest, roots = 0, zip(self._scales(precision), self._ends(known), strict=True)
        for error, (scale, (p_0, p_1)) in zip(self._errors(known, precision), roots, strict=True):
            if error > largest:
                root = isqrt((p_1 * p_1 - 4 * p_0) << 2 * precision) + 1
                largest = max(largest, -(scale * ((p_1 << precision) - root) // (2 * p_0 << precision)))
        return largest

    def _ends(self, known: Known) -> Iterator[tuple[int, int]]:
        """``p(0)`` and ``p'(0)`` of each target."""
        if self.about.d == 2:
            entries = iter(known)
            return ((a * c - b * b, -a - c) for a, b, c in zip(entries, entries, entries, strict=True))
        polynomials = (m.charpoly() for m in self._matrices(known))
        return ((int(p[0]), int(p[1])) for p in polynomials)

    def _matrices(self, known: Known) -> Iterator[Any]:
        d, of_whole = self.about.d, places(self.about.d)
        for k in range(0, len(known), d * (d + 1) // 2):
            matrix = fmpz_mat(d, d, [known[k + place] for place in of_whole])
            afford(matrix)
            yield matrix

    def _scales_at(self, precision: int) -> list[int]:
        """Compute each target's weight over the unit of L, in units of ``2^-precision``, rounded up."""
        weights = zip(self.about.weights, self._units, strict=True)
        return [int((w * (unit << precision)).ceil()) for w, unit in weights]

    def _logarithms_at(self, _: int) -> list[tuple[fmpq, list[int], arb]]:
        """Group targets by weight, a few at a time, with a ball around their log-determinant without robots."""
        about, found, block = self.about, [], limits().block
        for weight in dict.fromkeys(about.weights):
            own = [j for j, w in enumerate(about.weights) if w == weight]
            for few in (own[k : k + block] for k in range(0, len(own), block)):
                tick()
                before = total(arb(self._units[j] ** about.d / about.prior[j].det()).log() for j in few)
                found.append((weight, few, before))
        return found


def _held(known: Known) -> Known:
    """Count a case as held in memory, with what one path of cases adds to it."""
    hold(fmpq(max(map(abs, known))), 2 * len(known))
    return known
