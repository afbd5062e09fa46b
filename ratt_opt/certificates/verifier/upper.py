"""Verification of the upper end for all plans: a search tree, checked leaf by leaf.

Notation, per target: ``<A, B> = tr(A B)`` and ``L(S) = prior^{-1} + sum of the information of S``.
"""

from __future__ import annotations

from functools import cache
from itertools import chain
from typing import TYPE_CHECKING, Any, NamedTuple

from flint import arb, ctx, fmpq, fmpq_mat

from ratt_opt.certificates.verifier import reading
from ratt_opt.certificates.verifier.exact_matrices import definite, largest, total, trace
from ratt_opt.certificates.verifier.marginals import MarginalBounds
from ratt_opt.certificates.verifier.reading import (
    array,
    exact,
    fields,
    index,
    indices,
    links,
    need,
    packed,
    rows_of,
    walk,
)
from ratt_opt.certificates.verifier.statement import PRECISIONS
from ratt_opt.certificates.verifier.work import afford, hold, tick
from ratt_opt.errors import ProofError

if TYPE_CHECKING:
    from collections.abc import Iterator

    from ratt_opt.certificates.verifier.statement import Statement

__all__ = ["Left", "UpperCheck", "Winners", "check_upper", "upper_bounds"]

Left = tuple[tuple[int, ...], ...]
Winners = dict[int, frozenset[int]]

NODES = "covers", "marginals", "fenchel", "part"
"""Names of nodes, by a field that no other node has; those without one are branches on elements."""
BLOCK = 16
"""Points whose scores are computed between two looks at the clock."""


class _Point(NamedTuple):
    """``phi(S) <= constant + sum of scores[e] over e in S`` for every set of elements."""

    scores: list[fmpq]
    constant: Any


class _Cut(NamedTuple):
    """``phi(plan restricted to group)`` is at most what the point says of the elements of the group's robots."""

    attack: int
    group: frozenset[int]
    point: _Point


class _Cover(NamedTuple):
    """A plan is worth at most ``bound`` if it counts less than needed of ``left_out`` (:meth:`UpperCheck._cover`)."""

    left_out: frozenset[int]
    bound: Any


def check_upper(about: Statement, part: object, upper: fmpq) -> int:
    """Check that every plan's worst-case value is at most ``upper``; return the number of leaves."""
    need(upper >= 0, "claim: upper is negative")  # a group of blinded robots only is worth phi(empty set) = 0
    for precision in PRECISIONS:
        with ctx.workprec(precision):
            bounds = upper_bounds(about, part)
            worst = next((b for b in bounds if not b <= upper), None)
            if worst is None:
                return len(bounds)
    raise ProofError(f"upper proof: a leaf only proves {arb(worst).str(17)}, more than the claim")


def upper_bounds(about: Statement, part: object) -> list[Any]:
    """Return each leaf's bound; together the leaves cover all plans, or ProofError."""
    return UpperCheck(about, part).bounds


class UpperCheck:
    """A proof as it is read: what its leaves name, and the ``bounds`` of its leaves.

    The plans of a case are a product of element sets, one per robot: those ``left``. Under attack ``a`` the team value
    is the value of the winning group, which ``winners`` may declare.
    """

    def __init__(self, about: Statement, part: object) -> None:
        self.about, self.bounds = about, list[Any]()
        self._has_covers = isinstance(part, dict) and "covers" in part
        names = "attacks points cuts tree covers" if self._has_covers else "attacks points cuts tree"
        attacks, points, cuts, tree, *covers = fields("upper proof", part, names)
        families = array("attacks", attacks)
        reading.check_size("attacks", len(families) * about.n, reading.MOST_CELLS)
        self.groups = [self._groups_left(attack) for attack in families]
        self._points = self._read_points(points)
        self.cuts = [self._cut(cut) for cut in array("cuts", cuts)]
        self.covers = [self._cover(cover) for given in covers for cover in array("covers", given)]
        self._marginals = cache(lambda: MarginalBounds(about))
        self._named: dict[int, list[tuple[int, ...]]] = {}
        walk("upper", tree, (about.choices, {}), self.expand)

    def expand(self, node: object, case: tuple[Left, Winners]) -> Iterator[tuple[Left, Winners]]:
        """Yield the cases below a branch; append a leaf's bound."""
        left, winners = case
        name = next((name for name in NODES if isinstance(node, dict) and name in node), "element")
        if name == "part":
            a = self._number("part branch", *fields("part branch", node, name))
            need(a not in winners, "upper proof: an attack's best part is declared twice")
            yield from ((left, {**winners, a: group}) for group in self.groups[a])
        elif name == "element":
            i, blocks = self._blocks(node, left)
            yield from (((*left[:i], block, *left[i + 1 :]), winners) for block in blocks)
        else:
            leaves = {"covers": self.cover_leaf, "marginals": self.marginal_leaf, "fenchel": self.fenchel_leaf}
            self.bounds.append(leaves[name](node, left, winners))
            if isinstance(self.bounds[-1], fmpq):
                hold(self.bounds[-1])

    def _blocks(self, node: Any, left: Left) -> tuple[int, list[tuple[int, ...]]]:
        """The robot of an element branch and its parts: those named, or named ``before``, and with covers the rest."""
        has_parts = isinstance(node, dict) and "parts" in node
        robot, *given = fields("element branch", node, "element parts" if has_parts else "element")
        i = index("element branch robot", robot, self.about.n)
        for parts in given:
            self._named[i] = [indices("element branch", part, len(self.about.owner)) for part in array("parts", parts)]
        need(i in self._named, f"upper proof: no branch before names the parts of robot {i}")
        blocks = list(self._named[i])
        named = sorted(chain(*blocks))
        rest = tuple(sorted(set(left[i]) - set(named))) if self._has_covers else ()
        exact_cover = all(blocks) and sorted([*named, *rest]) == list(left[i])
        need(exact_cover, f"upper proof: the children of robot {i} do not partition its elements")
        return i, blocks + [rest] * bool(rest)

    def weighed(self, node: object, name: str, known: list[Any]) -> list[tuple[fmpq, Any]]:
        """Return the weights of a leaf, and what it names of what the proof has."""
        chosen, given = fields("leaf", node, f"{name} weights")
        used = [known[index(f"leaf {name}", k, len(known))] for k in array(f"leaf {name}", chosen)]
        weights = [exact("leaf weight", w) for w in array("leaf weights", given, len(used))]
        return list(zip(weights, used, strict=True))

    def fenchel_leaf(self, node: object, left: Left, winners: Winners) -> Any:
        """Return the bound by an average of cuts, each of the only group of an attack or of the declared winner.

        The worst case is at most that of each, so at most the constant of the average plus, robot by robot, the
        largest score among the elements left.
        """
        pairs = self.weighed(node, "fenchel", self.cuts)
        mass = total(w for w, _ in pairs)
        need(mass > 0 and all(w >= 0 for w, _ in pairs), "upper proof: a leaf's weights are negative or all zero")
        wins = all(len(self.groups[cut.attack]) == 1 or winners.get(cut.attack) == cut.group for _, cut in pairs)
        need(wins, "upper proof: a leaf uses a group that is not known to win")
        bound = total(w * cut.point.constant for w, cut in pairs)
        for i, elements in enumerate(left):
            tick()
            active = [(w, cut.point.scores) for w, cut in pairs if i in cut.group]
            bound += max(total(w * scores[e] for w, scores in active) for e in elements) if active else 0
        return bound / mass

    def cover_leaf(self, node: object, left: Left, _: Winners) -> Any:
        """Return the largest bound of covers, one of which each plan fails: none counts their weighted sum."""
        pairs = self.weighed(node, "covers", self.covers)
        need(pairs and all(w > 0 for w, _ in pairs), "upper proof: a leaf's weights are not positive")
        needed = min(self.about.alpha_s, self.about.n - len(self.about.safe_robots)) + 1
        most = fmpq(0)
        for i, elements in enumerate(left):
            tick()
            count = needed if i in self.about.safe_robots else 1
            most += count * max(total(w for w, cover in pairs if e in cover.left_out) for e in elements)
        need(most < needed * total(w for w, _ in pairs), "upper proof: a plan of a leaf may meet all its covers")
        return largest([cover.bound for _, cover in pairs])

    def marginal_leaf(self, node: object, left: Left, _: Winners) -> Any:
        """Return the bound by gains: no group of the attack is worth more."""
        (attack,) = fields("marginal leaf", node, "marginals")
        return self._marginals().bound(self.groups[self._number("marginal leaf", attack)], left)

    def _number(self, where: str, attack: object) -> int:
        return index(where, attack, len(self.groups))

    def _groups_left(self, attack: object) -> list[frozenset[int]]:
        """Check an attack against the budgets; return the unblinded robots of its groups, by lowest robot."""
        about = self.about
        robots, pairs = fields("attack", attack, "robots links")
        blinded, cut = frozenset(indices("attack robots", robots, about.n)), links("attack links", pairs, about.n)
        fits = len(blinded) <= about.alpha_s and len(cut) <= about.alpha_c
        need(fits, "upper proof: an attack exceeds its budget")
        allowed = cut <= about.links - about.safe_links and not blinded & about.safe_robots
        need(allowed, "upper proof: an attack hits what does not exist or is protected")
        tick()
        groups, others = [], set(range(about.n))
        while others:
            front = [min(others)]
            group = set(front)
            while front:
                i = front.pop()
                fresh = {j for j in about.near[i] - group if (min(i, j), max(i, j)) not in cut}
                group |= fresh
                front.extend(fresh)
            others -= group
            groups.append(frozenset(group - blinded))
        return sorted(filter(None, groups), key=min) or [frozenset()]

    def _cut(self, given: object) -> _Cut:
        a, g, p = array("cut", given, 3)
        attack = self._number("cut attack", a)
        groups = self.groups[attack]
        return _Cut(attack, groups[index("cut group", g, len(groups))], self._point("cut point", p))

    def _point(self, where: str, number: object) -> _Point:
        return self._points[index(where, number, len(self._points))]

    def _cover(self, given: object) -> _Cover:
        """Check a cover: under an attack on links, what the elements beside ``left_out`` are worth in each group.

        Where the robots with an element in ``left_out`` can be blinded all at once, an attack leaves nothing else.
        So a plan that is worth more has ``alpha_s + 1`` of them, or a protected one, whose elements therefore count
        ``alpha_s + 1`` times.
        """
        attack, out, numbers = fields("cover", given, "attack left_out points")
        groups = self.groups[self._number("cover attack", attack)]
        need(sum(map(len, groups)) == self.about.n, "upper proof: the attack of a cover blinds robots")
        left_out, bounds = frozenset(indices("cover left_out", out, len(self.about.owner))), []
        for group, p in zip(groups, array("cover points", numbers, len(groups)), strict=True):
            scores, constant = self._point("cover point", p)
            bounds.append(constant + total(self._most(i, left_out, scores) for i in group))
        return _Cover(left_out, largest(bounds))

    def _most(self, robot: int, left_out: frozenset[int], scores: list[fmpq]) -> fmpq:
        """The largest score of what is kept of a robot's elements; 0 if it is blinded."""
        tick()
        return max([fmpq(0), *(scores[e] for e in self.about.choices[robot] if e not in left_out)])

    def _read_points(self, points: object) -> list[_Point]:
        """Return for each Fenchel point the score of every element, and the constant of its bound."""
        width = len(self.about.prior) * self.about.d**2
        given = array("points", points)
        reading.check_size("points", len(given) * max(width, len(self.about.owner)), reading.MOST_CELLS)
        fenchel = [self._fenchel(point) for point in given]
        columns = [x for row in self.about.information for matrix in row for x in matrix.entries()]
        turned = fmpq_mat(len(self.about.owner), width, columns).transpose()
        scores: list[list[fmpq]] = []
        for k in range(0, len(fenchel), BLOCK):
            rows = [x for row, _ in fenchel[k : k + BLOCK] for x in row]
            block = (fmpq_mat(len(rows) // width, width, rows) * turned).tolist()
            tick()
            for row in block:
                hold(max(row, key=lambda x: int(x.q)), len(row))
            scores += block
        return [_Point(own, constant) for own, (_, constant) in zip(scores, fenchel, strict=True)]

    def _fenchel(self, point: object) -> tuple[list[fmpq], Any]:
        """Return ``(W, c)`` with ``phi(S) <= c + sum over e in S of <W, information[e]>`` for every S.

        trace:  tr(C L^{-1} C') >= 2 tr(C Y) - tr(Y' L Y), from (L^{-1} C' - Y)' L (L^{-1} C' - Y) >= 0; W = w Y Y'.
        logdet: logdet L <= tr(Y L) - logdet Y - d, from log x <= x - 1 for the eigenvalues of Y L; W = w Y.
        maxeig: lambda_max(C L^{-1} C') >= 1/q >= 2t - t^2 q with q = v'Lv / |Cv|^2; W = w t^2 vv' / |Cv|^2 for one
        target. With u = Cv / |Cv| and z = C'u, (z'v)^2 <= (z' L^{-1} z) (v'Lv) (Cauchy), and z'v = |Cv|.
        """
        tick()
        about, d, m = self.about, self.about.d, len(self.about.prior)
        if about.objective == "maxeig":
            target, size, vector = array("point", point, 3)
            j, t = index("point target", target, m), exact("point t", size)
            v = fmpq_mat(d, 1, [exact("point v", x) for x in array("point v", vector, d)])
            seen = (v.transpose() * about.square[j] * v)[0, 0]
            need(seen > 0, "upper proof: a direction v is zero, or so is its output")
            weight = v * v.transpose() * (about.weights[j] * t * t / seen)
            blank = [fmpq(0)] * (d * d)
            constant = about.prior_high - 2 * about.weights[j] * t + trace(weight * about.inverse[j])
            return blank * j + weight.entries() + blank * (m - j - 1), constant
        row, constant = [], about.prior_trace if about.objective == "trace" else fmpq(0)
        parts = zip(array("point", point, m), about.output, about.weights, about.inverse, strict=True)
        for given, c, w, inverse in parts:
            y = self._touched(given, c)
            if about.objective == "logdet":
                need(definite(y) > 0, "upper proof: a Fenchel point Y is not positive definite")
                weight = y * w
                product = y * inverse
                afford(product)
                constant -= w * d + w * arb(product.det()).log()
            else:
                weight = y * y.transpose() * w
                constant -= 2 * w * trace(c * y)
            constant += trace(weight * inverse)
            row += weight.entries()
        return row, constant

    def _touched(self, given: object, c: fmpq_mat) -> fmpq_mat:
        """Y (d, q) of one target, which is symmetric if the whole state counts."""
        if self.about.is_whole:
            return packed("point Y", given, self.about.d)
        return rows_of("point Y", array("point Y", given, c.nrows() * c.ncols()), c.nrows())
