"""Every set of so many robots of a plan is worth a claim: a tree over its robots."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from ratt_opt.certificates.verifier.reading import index, need, walk

if TYPE_CHECKING:
    from collections.abc import Iterator

    from ratt_opt.certificates.verifier.worth import Worth

__all__ = ["check_size_tree"]


def check_size_tree(n: int, size: int, tree: object, worth: Worth, others: frozenset[int] = frozenset()) -> int:
    """Check that every set of ``size`` of ``n`` robots but the ``others`` is worth it; returns the number of leaves.

    In preorder, i >= 0: robot i is in the set; or not. -1: the robots I in the set are worth it. -2: fewer than
    ``size`` robots are left. -3: some robots are missing, and I with any so many of those undecided is worth it.
    """

    def expand(node: Any, case: Any) -> Iterator[Any]:
        known, decided, out = case
        if node == -1:
            worth.require(known)
        elif node == -3:
            missing = size - len(decided) + out
            need(missing > 0, "lower proof: no robot is missing")
            worth.require(known, [i for i in range(n) if i not in decided], missing)
        elif node == -2:
            need(out > n - size, "lower proof: a leaf is not impossible")
        else:
            i = index("lower tree", node, n)
            need(i not in decided, f"lower proof: robot {i} is decided twice")
            yield worth.plus(known, i), decided | {i}, out
            yield known, decided | {i}, out + 1

    return walk("lower", tree, (worth.nobody, others, len(others)), expand)
