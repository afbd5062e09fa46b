"""Bounds by marginal gains, for log-determinants: what robots that are still free can add, each alone.

Notation, per target: ``L(S) = prior^{-1} + sum of the information of S``. With information that is positive
semidefinite ``logdet L(S)`` is submodular: an element adds no more to a set than to a part of that set. So

    phi(plan restricted to group) <= phi(F) + sum over robots i that are not in F of max_e [phi(F + e) - phi(F)]

where F has the elements of those robots of the group for which one is left, or one that tells at least as much about
every target as all others left (phi is non-decreasing). Both need matrices that are semidefinite: what rounding left
below zero is added to the eigenvalues first, and what one element lacks beside another.

Source: Nemhauser, Wolsey and Fisher 1978.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple

from flint import arb, fmpq

from ratt_opt.certificates.verifier.exact_matrices import largest, missing, total, trace
from ratt_opt.certificates.verifier.reading import need
from ratt_opt.certificates.verifier.work import hold, tick

if TYPE_CHECKING:
    from flint import fmpq_mat

    from ratt_opt.certificates.verifier.statement import Statement

__all__ = ["MarginalBounds"]


class _Told(NamedTuple):
    """What an element tells, made semidefinite: ``matrices`` by target, of those that it tells anything about."""

    number: int
    matrices: dict[int, fmpq_mat]


class _Beside(NamedTuple):
    """Of one target and some elements: ``L``, its ``logdet``, what it is worth, and what others gain beside them."""

    matrix: fmpq_mat
    logdet: Any
    value: Any
    gains: dict[int, Any]


class MarginalBounds:
    """Bounds of one problem at the precision of the balls that is set meanwhile."""

    def __init__(self, about: Statement) -> None:
        need(about.objective == "logdet", "upper proof: gains diminish with the log-det alone")
        self._about = about
        self._told: dict[tuple[int, tuple[fmpq, ...]], _Told] = {}
        self._elements = [self._raised(e, about.defect[e]) for e in range(len(about.owner))]
        self._strongest: dict[tuple[int, ...], _Told | None] = {}
        self._beside: list[dict[tuple[int, ...], _Beside]] = [{} for _ in about.prior]

    def bound(self, groups: list[frozenset[int]], left: tuple[tuple[int, ...], ...]) -> Any:
        """No group is worth more, whatever each robot chooses of the elements that are ``left`` to it."""
        return largest([self._group_bound(group, left) for group in groups])

    def _group_bound(self, group: frozenset[int], left: tuple[tuple[int, ...], ...]) -> Any:
        tick()
        chosen = {i: self._strongest_of(left[i]) for i in sorted(group)}
        fixed = [told for told in chosen.values() if told is not None]
        beside = [self._known(j, fixed) for j in range(len(self._about.prior))]
        bound = sum((known.value for known in beside), arb(0))
        for i, told in chosen.items():
            if told is None:
                bound += largest([self._gain(self._elements[e], beside) for e in left[i]])
        return bound

    def _strongest_of(self, elements: tuple[int, ...]) -> _Told | None:
        """What stands for all of some elements: the one that tells most, if no other tells more of any target."""
        if elements not in self._strongest:
            self._strongest[elements] = self._found_strongest(elements)
        return self._strongest[elements]

    def _found_strongest(self, elements: tuple[int, ...]) -> _Told | None:
        information = self._about.information
        best = max(elements, key=lambda e: total(trace(x) for x in information[e]))
        lacking = list(self._about.defect[best])
        for e in elements:
            for j, (own, other) in enumerate(zip(information[best], information[e], strict=True)):
                tick()
                more = missing(own - other, self._about.identity)
                if more is None:
                    return None
                lacking[j] = max(lacking[j], more)
        return self._raised(best, lacking)

    def _raised(self, element: int, more: list[fmpq]) -> _Told:
        """An element's information with so much more in every direction of each target, stated once."""
        key = element, tuple(more)
        if key not in self._told:
            pairs = enumerate(zip(self._about.information[element], more, strict=True))
            raised = {j: x + self._about.identity * delta for j, (x, delta) in pairs}
            telling = {j: x for j, x in raised.items() if any(x.entries())}
            self._told[key] = _Told(len(self._told), telling)
        return self._told[key]

    def _known(self, target: int, fixed: list[_Told]) -> _Beside:
        """A target beside the elements of ``fixed`` that tell something about it."""
        telling = [told for told in fixed if target in told.matrices]
        kept, key = self._beside[target], tuple(told.number for told in telling)
        if key not in kept:
            matrix = sum((told.matrices[target] for told in telling), self._about.inverse[target])
            logdet = arb(matrix.det()).log()
            before = kept[()].logdet if telling and () in kept else arb(self._about.inverse[target].det()).log()
            hold(matrix[0, 0], matrix.nrows() ** 2)
            kept[key] = _Beside(matrix, logdet, self._about.weights[target] * (logdet - before), {})
        return kept[key]

    def _gain(self, told: _Told, beside: list[_Beside]) -> Any:
        """What an element adds at most."""
        gain = arb(0)
        for j, matrix in told.matrices.items():
            known = beside[j]
            if told.number not in known.gains:
                more = arb((known.matrix + matrix).det()).log() - known.logdet
                known.gains[told.number] = self._about.weights[j] * more
            gain += known.gains[told.number]
        return gain
