"""Whether sets of one plan's robots are worth a claim, exactly; all are asked about one claim."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from flint import arb, ctx

from ratt_opt.certificates.verifier.exact_matrices import (
    definite,
    largest_of_inverse,
    output_trace,
    total,
    trace_of_inverse,
)
from ratt_opt.certificates.verifier.fixed_point import FixedPoint
from ratt_opt.certificates.verifier.reading import need
from ratt_opt.certificates.verifier.statement import PRECISIONS
from ratt_opt.certificates.verifier.work import tick

if TYPE_CHECKING:
    from collections.abc import Iterable

    from flint import fmpq, fmpq_mat

    from ratt_opt.certificates.verifier.fixed_point import Sums
    from ratt_opt.certificates.verifier.statement import Statement

    Known = tuple[tuple[int, ...], Sums]

__all__ = ["Worth"]


class Worth:
    """Decides whether robots S that see and are known to be in one group are worth ``lower``.

    The group's L is at least L(S) minus the plan's defects, in the Loewner order, so the group is worth at least the
    criterion there. ``nobody`` : the set without robots, as :meth:`plus` extends it
    """

    def __init__(self, about: Statement, lower: fmpq) -> None:
        self.about, self.lower = about, lower
        defects = [total(about.defect[e][j] for e in about.plan) for j in range(len(about.prior))]
        self._start = [a - about.identity * delta for a, delta in zip(about.inverse, defects, strict=True)]
        self._quick = FixedPoint(about, self._start) if FixedPoint.serves(about) else None
        self.nobody: Known = (), self._quick.start if self._quick else []

    def plus(self, known: Known, robot: int) -> Known:
        """The set with one robot more."""
        inside, sums = known
        return (*inside, robot), self._quick.plus(sums, robot) if self._quick else sums

    def of(self, robots: Iterable[int]) -> Known:
        """The set of these robots."""
        known = self.nobody
        for i in robots:
            known = self.plus(known, i)
        return known

    def require(self, known: Known, others: Iterable[int] = (), count: int = 0) -> None:
        """Check that the set is worth it: alone, or with any ``count`` of the ``others``.

        With r = count robots T, L(S + T) is the average over T of L(S) + r information[i], and phi is concave in L: it
        is worth the average there at least.
        """
        inside, sums = known
        quick = self._quick
        more = [quick.copies(i, count) for i in others] or [quick.none] if quick else []
        if quick is None or not quick.are_worth(sums, more, count or 1, self.lower):
            posterior = self._with(self._start, inside)
            cases = [self._with(posterior, [i], count) for i in others] or [posterior]
            worth = any(self._at(precision, cases, count or 1) for precision in PRECISIONS)
            need(worth, "lower proof: a leaf is worth less than the claim")

    def _with(self, posterior: list[fmpq_mat], robots: Iterable[int], times: int = 1) -> list[fmpq_mat]:
        for i in robots:
            own = self.about.information[self.about.plan[i]]
            posterior = [a + b * times for a, b in zip(posterior, own, strict=True)]
        return posterior

    def _at(self, precision: int, cases: list[list[fmpq_mat]], count: int) -> bool:
        with ctx.workprec(precision):
            return self._are_worth(cases, count)

    def _are_worth(self, cases: list[list[fmpq_mat]], count: int) -> bool:
        """Whether any ``count`` of the cases (all positive definite) are worth it on average."""
        lower = self.lower
        if lower <= 0 and all(definite(m - i) >= 0 for x in cases for m, i in zip(x, self.about.inverse, strict=True)):
            return True  # at least the prior's information is worth at least phi(empty set) = 0
        if self.about.objective != "maxeig" or (self.about.d == 2 and self.about.output is None):
            return bool(total(sorted(map(self._value, cases))[:count]) >= lower * count)
        # Each case is worth it if lambda_max(C L^{-1} C') <= room / w for its targets. With L > 0 that is
        # L - (w / room) C'C >= 0: both say that [[L, C'], [C, (room / w) I]] >= 0 (Schur).
        room = self.about.prior_low - lower
        parts = (part for x in cases for part in zip(self.about.weights, self.about.square, x, strict=True))
        return bool(room > 0) and all(definite(m - square * (w / room)) >= 0 for w, square, m in parts)

    def _value(self, posterior: list[fmpq_mat]) -> Any:
        """Return a lower bound on the criterion (max-eigenvalue: of two coordinates), sharper at a higher precision."""
        tick()
        pairs = list(zip(self.about.weights, posterior, strict=True))
        if self.about.objective == "maxeig":
            return self.about.prior_low - max(w * largest_of_inverse(m) for w, m in pairs)
        if self.about.output is not None:
            traces = zip(self.about.weights, self.about.output, posterior, strict=True)
            return self.about.prior_trace - total(w * output_trace(c, m) for w, c, m in traces)
        if self.about.objective == "trace":
            return self.about.prior_trace - total(w * trace_of_inverse(m) for w, m in pairs)
        items = zip(self.about.weights, self.about.prior, posterior, strict=True)
        return total(w * arb((m * p).det()).log() for w, p, m in items).lower()
