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

from functools import cache
from typing import TYPE_CHECKING, Any, NamedTuple

from flint import arb, fmpq

from ratt_opt.certificates.verifier.exact_matrices import largest, missing, total, trace
from ratt_opt.certificates.verifier.reading import need
from ratt_opt.certificates.verifier.work import afford, hold, tick

if TYPE_CHECKING:
    from flint import fmpq_mat

    from ratt_opt.certificates.verifier.statement import Statement

__all__ = ["MarginalBounds"]


class _ElementInformation(NamedTuple):
    """Information of an element, made semidefinite: ``matrices`` by target, without zero ones."""

    number: int
    matrices: dict[int, fmpq_mat]


class _Context(NamedTuple):
    """State of one target with some information added: ``L``, its ``logdet``, and its value."""

    matrix: fmpq_mat
    logdet: arb
    value: Any


class MarginalBounds:
    """Bounds of one problem at the precision of the balls that is set meanwhile."""

    def __init__(self, about: Statement) -> None:
        need(about.objective == "logdet", "upper proof: gains diminish with the log-det alone")
        self._about, self._informed = about, list[_ElementInformation]()
        self._raised, self._strongest = cache(self._raised_of), cache(self._strongest_of)
        self._beside, self._gain = cache(self._beside_of), cache(self._gain_of)
        self._elements = [self._raised(e, tuple(about.defect[e])) for e in range(len(about.owner))]

    def bound(self, groups: list[frozenset[int]], left: tuple[tuple[int, ...], ...]) -> Any:
        """No group is worth more, whatever each robot chooses of the elements that are ``left`` to it."""
        return largest([self._group_bound(group, left) for group in groups])

    def beyond(self, target: int, base: tuple[int, ...], elements: tuple[int, ...]) -> tuple[Any, dict[int, Any]]:
        """Bound one target's value of every set by what a base is worth, and gains of other elements beside it.

        ``phi_j(T) <= phi_j(T and base) <= phi_j(base) + sum over e in T outside the base of its gain beside the base``
        """
        numbers = tuple(e for e in base if target in self._elements[e].matrices)
        gains = {e: self._gain(target, numbers, e) for e in elements if target in self._elements[e].matrices}
        return self._beside(target, numbers).value, {e: gain for e, gain in gains.items() if e not in base}

    def _group_bound(self, group: frozenset[int], left: tuple[tuple[int, ...], ...]) -> Any:
        tick()
        chosen = {i: self._strongest(left[i]) for i in sorted(group)}
        fixed = [told for told in chosen.values() if told is not None]
        beside = [tuple(told.number for told in fixed if j in told.matrices) for j in range(len(self._about.prior))]
        bound = sum((self._beside(j, numbers).value for j, numbers in enumerate(beside)), arb(0))
        for i, told in chosen.items():
            if told is None:
                bound += largest([self._added(self._elements[e], beside) for e in left[i]])
        return bound

    def _added(self, told: _ElementInformation, beside: list[tuple[int, ...]]) -> Any:
        """Bound the marginal of an element."""
        return sum((self._gain(j, beside[j], told.number) for j in told.matrices), arb(0))

    def _strongest_of(self, elements: tuple[int, ...]) -> _ElementInformation | None:
        """Find one element whose information bounds that of all the others, if there is one.

        It has the largest trace; its defects are enlarged, so that it has no less information about any target.
        """
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
        return self._raised(best, tuple(lacking))

    def _raised_of(self, element: int, more: tuple[fmpq, ...]) -> _ElementInformation:
        """An element's information with so much more in every direction of each target."""
        pairs = enumerate(zip(self._about.information[element], more, strict=True))
        raised = {j: x + self._about.identity * delta for j, (x, delta) in pairs}
        self._informed.append(
            _ElementInformation(len(self._informed), {j: x for j, x in raised.items() if any(x.entries())})
        )
        return self._informed[-1]

    def _beside_of(self, target: int, numbers: tuple[int, ...]) -> _Context:
        matrix = sum((self._informed[k].matrices[target] for k in numbers), self._about.inverse[target])
        hold(matrix[0, 0], matrix.nrows() ** 2)
        afford(matrix)
        logdet = arb(matrix.det()).log()
        before = self._beside(target, ()).logdet if numbers else logdet
        return _Context(matrix, logdet, self._about.weights[target] * (logdet - before))

    def _gain_of(self, target: int, numbers: tuple[int, ...], number: int) -> Any:
        """Compute the marginal value of an element for one target, beside others."""
        known = self._beside(target, numbers)
        matrix = known.matrix + self._informed[number].matrices[target]
        afford(matrix)
        after = arb(matrix.det()).log()
        return self._about.weights[target] * (after - known.logdet)
