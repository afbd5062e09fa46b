"""The plan keeps at least the claim's lower end under every attack: a cover of all attacks by cases."""

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
from ratt_opt.certificates.verifier.reading import fields, index, need, walk
from ratt_opt.certificates.verifier.statement import PRECISIONS
from ratt_opt.certificates.verifier.work import tick

if TYPE_CHECKING:
    from collections.abc import Iterator

    from flint import fmpq, fmpq_mat

    from ratt_opt.certificates.verifier.fixed_point import Sums
    from ratt_opt.certificates.verifier.statement import Statement

__all__ = ["LowerCheck", "is_forced"]


class LowerCheck:
    """Decides the lower proofs of one problem's plan."""

    def __init__(self, about: Statement) -> None:
        self.about = about

    def check(self, part: Any, lower: fmpq) -> int:
        """Check that the plan's value is at least ``lower`` under every attack.

        Returns the number of leaves; 0 when the part says that it is no proof. Every leaf names robots S that see
        and are known to be in one group. The group's L is at least L(S) minus the plan's defects, in the Loewner
        order, so the group is worth at least the criterion there.
        """
        kind = part.get("kind") if isinstance(part, dict) else None
        defects = [total(self.about.defect[e][j] for e in self.about.plan) for j in range(len(self.about.prior))]
        start = [
            inverse - self.about.identity * delta for inverse, delta in zip(self.about.inverse, defects, strict=True)
        ]
        if kind == "forced_size":
            _, size, tree = fields("lower proof", part, "kind size tree")
            return self._check_forced_size(index("forced size", size, self.about.n + 1), tree, start, lower)
        if kind == "attack_tree":
            return self._check_attack_tree(fields("lower proof", part, "kind tree")[1], start, lower)
        fields("lower proof", part, "kind")
        need(kind == "enumerated", "lower proof: the kind must be attack_tree, forced_size or enumerated")
        return 0

    def _check_forced_size(self, size: int, tree: object, start: list[fmpq_mat], lower: fmpq) -> int:
        """Every attack leaves a group with ``size`` seeing robots, and every such set is worth ``lower``.

        In preorder, i >= 0: robot i is in the set; or not. -1: the robots I in the set are worth ``lower``.
        -2: fewer than ``size`` robots are left. -3: r > 0 robots T are missing, of those undecided; L(I + T) is the
        average over T of L(I) + r information[i], and phi is concave in L: it is worth the average there at least.
        """
        complete = 2 * len(self.about.links) == self.about.n * (self.about.n - 1)
        forced = complete and is_forced(self.about.n, self.about.alpha_s, self.about.alpha_c, size)
        need(forced, f"lower proof: not every attack is shown to leave a group of {size}")

        quick = FixedPoint(self.about, start) if FixedPoint.serves(self.about) else None

        def require(inside: tuple[int, ...], sums: Sums, others: list[int], count: int) -> None:
            """Check the robots inside with ``count`` copies of each of the others; alone where there are none."""
            more = [quick.copies(i, count) for i in others] or [quick.none] if quick else []
            if quick is None or not quick.are_worth(sums, more, count or 1, lower):
                posterior = self._with(start, list(inside))
                cases = [self._with(posterior, [i], count) for i in others] or [posterior]
                self._require(cases, count or 1, lower)

        def expand(node: Any, case: Any) -> Iterator[Any]:
            inside, sums, decided, out = case
            if node == -1:
                require(inside, sums, [], 0)
            elif node == -3:
                missing = size - len(decided) + out
                need(missing > 0, "lower proof: no robot is missing")
                rest = [i for i in range(self.about.n) if i not in decided]
                require(inside, sums, rest, missing)
            elif node == -2:
                need(out > self.about.n - size, "lower proof: a leaf is not impossible")
            else:
                i = index("lower tree", node, self.about.n)
                need(i not in decided, f"lower proof: robot {i} is decided twice")
                yield (*inside, i), quick.plus(sums, i) if quick else sums, decided | {i}, out
                yield inside, sums, decided | {i}, out + 1

        return walk("lower", tree, ((), quick.start if quick else [], frozenset(), 0), expand)

    def _check_attack_tree(self, tree: object, start: list[fmpq_mat], lower: fmpq) -> int:
        """Cases over attacks; ``parts`` are pairwise in different groups, each within one.

        In preorder, 2i: robot i is blinded; or not. 2i + 1: robot i is in the group of the first part, of the
        second, ..., or of none (a new part). -1: the case exceeds a budget or hits something protected.
        -2 - p: the robots of part p that are known to see are worth ``lower``.
        """
        known: set[int] = set()

        def expand(node: Any, case: Any) -> Iterator[Any]:
            blind, see, parts = case
            if node == -1:
                need(self._infeasible(blind, parts), "lower proof: a case is an attack within the budgets")
            elif type(node) is int and node < 0:
                group = parts[index("lower tree part", -2 - node, len(parts))] & see
                mask = sum(1 << i for i in group)
                if mask not in known:
                    self._require([self._with(start, sorted(group))], 1, lower)
                    known.add(mask)
            else:
                i, asks_group = divmod(index("lower tree", node, 2 * self.about.n), 2)
                decided = any(i in part for part in parts) if asks_group else i in blind | see
                need(not decided, f"lower proof: robot {i} is decided twice")
                if asks_group:
                    yield from ((blind, see, (*parts[:p], x | {i}, *parts[p + 1 :])) for p, x in enumerate(parts))
                yield (blind, see, (*parts, frozenset({i}))) if asks_group else (blind | {i}, see, parts)
                yield from () if asks_group else [(blind, see | {i}, parts)]

        return walk("lower", tree, (frozenset(), frozenset(), ()), expand)

    def _infeasible(self, blind: frozenset[int], parts: tuple[frozenset[int], ...]) -> bool:
        """Whether blinding ``blind`` and separating ``parts`` is beyond the adversary.

        All links between parts are cut; a robot in no part shares a group with at most one part, so its links
        to all parts but the best linked one are lost at least.
        """
        home = {i: p for p, part in enumerate(parts) for i in part}
        between = {(i, j) for i, j in self.about.links if i in home and j in home and home[i] != home[j]}
        counts = [[len(self.about.near[i] & part) for part in parts] for i in range(self.about.n) if i not in home]
        lost = len(between) + sum(sum(c) - max(c, default=0) for c in counts)
        protected = between & self.about.safe_links or blind & self.about.safe_robots
        return lost > self.about.alpha_c or len(blind) > self.about.alpha_s or bool(protected)

    def _with(self, posterior: list[fmpq_mat], robots: list[int], times: int = 1) -> list[fmpq_mat]:
        for i in robots:
            posterior = [
                a + b * times for a, b in zip(posterior, self.about.information[self.about.plan[i]], strict=True)
            ]
        return posterior

    def _require(self, cases: list[list[fmpq_mat]], count: int, lower: fmpq) -> None:
        """Check that any ``count`` of the cases (all positive definite) are worth ``lower`` on average."""
        worth = False
        for precision in PRECISIONS:
            with ctx.workprec(precision):
                worth = worth or self._are_worth(cases, count, lower)
        need(worth, "lower proof: a leaf is worth less than the claim")

    def _are_worth(self, cases: list[list[fmpq_mat]], count: int, lower: fmpq) -> bool:
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


def is_forced(n: int, alpha_s: int, alpha_c: int, size: int) -> bool:
    """Whether every attack on the complete graph of n robots leaves a group with ``size`` seeing robots.

    Otherwise groups n_1 + ... = n have (n^2 - sum n_k^2) / 2 <= alpha_c links between them and, to bring each below
    ``size``, sum max(0, n_k - size + 1) <= alpha_s. ``best[r][x]``: largest sum n_k^2 of r robots, blinding x.
    """
    best = [[0] * (alpha_s + 1)]
    for r in range(1, n + 1):
        tick()
        options = [range(1, min(r, size - 1 + x) + 1) for x in range(alpha_s + 1)]
        part = [[k * k + best[r - k][x - max(0, k - size + 1)] for k in ks] for x, ks in enumerate(options)]
        best.append([max(values, default=-n * n - 1) for values in part])
    return size == 0 or n * n - best[n][alpha_s] > 2 * alpha_c
