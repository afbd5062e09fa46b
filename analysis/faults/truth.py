"""True value of a problem that a certificate states: by definition, all plans under all attacks.

Shares nothing with the library, whose searches refuse some of what a file may state (a weight of 5e-324, say): exact
fractions for matrices of two coordinates, balls of ``BITS`` bits for roots and logarithms.
"""

from collections.abc import Iterable, Iterator
from functools import cache, reduce
from itertools import chain, combinations, product
from typing import Any

from flint import arb, ctx, fmpq

__all__ = ["truth"]

BITS = 4096
"""Bits of the balls: more than lie between the smallest and the largest float."""

Matrix = tuple[fmpq, fmpq, fmpq]
"""Lower triangle of a symmetric matrix of two rows."""


def truth(document: Any, elements: list[int]) -> tuple[arb, arb]:
    """The plan's worst case and the best worst case of any plan, each in a ball that holds it."""
    record = document["problem"]
    assert record["dimension"] == 2
    assert "output" not in record
    owned: list[list[int]] = [[] for _ in range(max(record["owners"]) + 1)]
    for element, robot in enumerate(record["owners"]):
        owned[robot].append(element)
    outcomes = set(_outcomes(record, len(owned)))
    criterion = _Criterion(record)
    value = cache(criterion.value)

    def worst(plan: tuple[int, ...]) -> arb:
        return reduce(arb.min, (_best(value(frozenset(plan[i] for i in g)) for g in family) for family in outcomes))

    with ctx.workprec(BITS):
        return worst(tuple(elements)), _best(worst(plan) for plan in product(*owned))


def _best(values: Iterable[arb]) -> arb:
    return reduce(arb.max, values)


def _outcomes(record: Any, n_robots: int) -> Iterator[frozenset[frozenset[int]]]:
    """The unblinded robots of each group, for every attack within the budgets."""
    links = [tuple(link) for link in record["links"]]
    safe = [tuple(link) for link in record["protected_links"]]
    sensing = _subsets([i for i in range(n_robots) if i not in record["protected_robots"]], record["alpha_s"])
    cutting = _subsets([link for link in links if link not in safe], record["alpha_c"])
    for blinded, cut in product(sensing, cutting):
        group = list(range(n_robots))  # the name of each robot's group
        for i, j in links:
            if (i, j) not in cut:
                group = [group[i] if name == group[j] else name for name in group]
        yield frozenset(
            frozenset(i for i in range(n_robots) if group[i] == name and i not in blinded) for name in group
        )


def _subsets(items: list[Any], largest: int) -> list[tuple[Any, ...]]:
    return list(chain.from_iterable(combinations(items, k) for k in range(largest + 1)))


class _Criterion:
    """The criterion of a record, of sets of its elements."""

    def __init__(self, record: Any) -> None:
        self._kind = record["objective"]
        self._weights = [_exact(weight) for weight in record["weights"]]
        self._prior = [_matrix(flat) for flat in record["prior"]]
        self._information = [[_matrix(flat) for flat in row] for row in record["information"]]

    def value(self, elements: frozenset[int]) -> arb:
        """The value of a set."""
        sums = [_inverse(prior) for prior in self._prior]
        for element in elements:
            rows = zip(sums, self._information[element], strict=True)
            sums = [(a + x, b + y, c + z) for (a, b, c), (x, y, z) in rows]
        pairs = list(zip(self._weights, self._prior, map(_inverse, sums), strict=True))
        if self._kind == "trace":
            return arb(sum((w * (p[0] + p[2] - q[0] - q[2]) for w, p, q in pairs), fmpq(0)))
        if self._kind == "logdet":
            return sum((w * arb(_determinant(p) / _determinant(q)).log() for w, p, q in pairs), arb(0))
        before, after = (_best(w * _largest(pair[k]) for w, *pair in pairs) for k in (0, 1))
        return before - after if elements else arb(0)


def _exact(number: float) -> fmpq:
    return fmpq(*number.as_integer_ratio())


def _matrix(flat: list[float]) -> Matrix:
    a, b, c = map(_exact, flat)
    return a, b, c


def _determinant(matrix: Matrix) -> fmpq:
    a, b, c = matrix
    return a * c - b * b


def _inverse(matrix: Matrix) -> Matrix:
    a, b, c = matrix
    determinant = _determinant(matrix)
    return c / determinant, -b / determinant, a / determinant


def _largest(matrix: Matrix) -> arb:
    """The larger eigenvalue."""
    a, b, c = matrix
    return (a + c + arb((a - c) * (a - c) + 4 * b * b).sqrt()) / 2
