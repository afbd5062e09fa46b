"""Values that plans can have, if each target is worth nearly the same as soon as an element sees it: coverage.

A set that has information about ``n`` targets is worth at least ``n least`` and at most ``n most``: the criterion is a
sum over targets, an unseen one adds nothing, and a seen one what its weakest element adds alone, or more, as
information is positive semidefinite. So no value of a plan is between ``count most`` and ``(count + 1) least``.
Semidefinite matrices are needed: what rounding left below zero is taken from what an element adds.

Source: rounding of bounds of integer programs (Gomory 1958), for values that are nearly whole.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from flint import arb, fmpq

from ratt_opt.certificates.verifier.exact_matrices import largest, total, trace
from ratt_opt.certificates.verifier.reading import array, fields, index, need
from ratt_opt.certificates.verifier.tangents import seers_of
from ratt_opt.certificates.verifier.work import afford

if TYPE_CHECKING:
    from collections.abc import Iterator

    from ratt_opt.certificates.verifier.statement import Statement
    from ratt_opt.certificates.verifier.target_lemmas import StatedLemma

__all__ = ["Spacing"]


class Spacing:
    """Checked spacing; plans worth less than ``next_value`` are worth at most ``value``."""

    def __init__(self, about: Statement, given: object, lemmas: list[StatedLemma]) -> None:
        need(about.objective != "maxeig", "upper proof: values are spaced for sums over targets alone")
        number, named = fields("spacing", given, "count lemmas")
        count = index("spacing count", number, len(about.prior) + 1)
        seers = {j: own for j in range(len(about.prior)) if (own := seers_of(about, j))}
        used = [lemmas[index("spacing lemmas", k, len(lemmas))] for k in array("spacing lemmas", named, len(seers))]
        fits = [lemma.target for lemma in used] == list(seers) and not any(lemma.scores for lemma in used)
        need(
            fits, "upper proof: the spacing does not name a lemma without scores of each target that is seen, in order"
        )
        self.value = count * max((lemma.constant for lemma in used), default=fmpq(0))
        least = _least(list(_alone(about, seers)))
        need(least >= 0, "upper proof: an element may be worth less than nothing, so values are not spaced")
        self.next_value = (count + 1) * least

    def lowered(self, bound: Any) -> Any:
        """Lower the bound of a leaf that shows enough; others stay."""
        return self.value if self.value < bound < self.next_value else bound


def _alone(about: Statement, seers: dict[int, tuple[int, ...]]) -> Iterator[Any]:
    """Yield lower bounds on the value of each seen target with each of its elements, whatever else is chosen."""
    for j, elements in seers.items():
        missing = total(max(about.defect[e][j] for e in own) for own in about.choices)
        start = about.inverse[j] - about.identity * missing
        before = arb(about.inverse[j].det()).log() if about.objective == "logdet" else about.prior_traces[j]
        for e in elements:
            posterior = start + about.information[e][j]
            afford(posterior)
            if about.objective == "logdet":
                yield about.weights[j] * (arb(posterior.det()).log() - before)
            else:
                yield before - about.weights[j] * trace(about.square[j] * posterior.inv())


def _least(values: list[Any]) -> Any:
    """The least of values, or a ball around it; 0 of none."""
    return -largest([-value for value in values]) if values else fmpq(0)
