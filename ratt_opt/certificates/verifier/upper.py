"""No plan keeps more than the claim's upper end under every attack: a search tree, checked leaf by leaf.

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
from ratt_opt.certificates.verifier.work import hold, tick
from ratt_opt.errors import ProofError

if TYPE_CHECKING:
    from collections.abc import Iterator

    from ratt_opt.certificates.verifier.statement import Statement

__all__ = ["UpperCheck"]

BLOCK = 16
"""Points whose scores are computed between two looks at the clock."""


class _Point(NamedTuple):
    """``phi(S) <= constant + sum of scores[e] over e in S`` for every set of elements."""

    scores: list[fmpq]
    constant: Any


class _Cut(NamedTuple):
    """``phi(plan restricted to group) <= constant + sum of scores[element] over the robots of the group``."""

    attack: int
    group: frozenset[int]
    constant: Any
    scores: list[fmpq]


class _Cover(NamedTuple):
    """A plan is worth at most ``bound`` if it counts less than needed of ``left_out`` (:meth:`UpperCheck._covers`)."""

    left_out: frozenset[int]
    bound: Any


class UpperCheck:
    """Decides the upper proofs of one problem."""

    def __init__(self, about: Statement) -> None:
        self.about = about

    def check(self, part: object, upper: fmpq) -> int:
        """Check that every plan's worst-case value is at most ``upper``; return the number of leaves."""
        need(upper >= 0, "claim: upper is negative")  # a group of blinded robots only is worth phi(empty set) = 0
        for precision in PRECISIONS:
            with ctx.workprec(precision):
                bounds = self.bounds(part)
                worst = next((b for b in bounds if not b <= upper), None)
                if worst is None:
                    return len(bounds)
        raise ProofError(f"upper proof: a leaf only proves {arb(worst).str(17)}, more than the claim")

    def bounds(self, part: object) -> list[Any]:
        """Return each leaf's bound; together the leaves cover all plans, or ProofError.

        The plans of a case are a product of element sets, one per robot. Under attack ``a`` the team value is
        the value of the winning group; a cut of group g may be used where g is the only group or the declared
        winner. So the worst case is at most any weighted average of usable cuts, and that is at most its
        constant plus, robot by robot, the largest score among the elements left. Leaves of other kinds:
        :meth:`_cover_leaf`, ``marginals.py``.
        """
        has_covers = isinstance(part, dict) and "covers" in part
        names = "attacks points cuts tree covers" if has_covers else "attacks points cuts tree"
        attacks, given, cut_list, tree, *cover_list = fields("upper proof", part, names)
        families = array("attacks", attacks)
        reading.check_size("attacks", len(families) * self.about.n, reading.MOST_CELLS)
        groups = [self._groups(attack) for attack in families]
        points = self._points(given)
        cuts, bounds = self._cuts(groups, points, cut_list), []
        covers = self._covers(groups, points, cover_list[0]) if has_covers else []
        marginals = cache(lambda: MarginalBounds(self.about))
        before: dict[int, list[tuple[int, ...]]] = {}

        def expand(node: Any, case: Any) -> Iterator[Any]:
            left, winners = case
            if isinstance(node, dict) and "covers" in node:
                bounds.append(self._cover_leaf(node, covers, left))
            elif isinstance(node, dict) and "marginals" in node:
                a = index("marginal leaf", fields("marginal leaf", node, "marginals")[0], len(groups))
                bounds.append(marginals().bound(groups[a], left))
            elif isinstance(node, dict) and "fenchel" in node:
                bounds.append(self._leaf(node, cuts, groups, left, winners))
                if isinstance(bounds[-1], fmpq):
                    hold(bounds[-1])
            elif isinstance(node, dict) and "part" in node:
                a = index("part branch", fields("part branch", node, "part")[0], len(groups))
                need(a not in winners, "upper proof: an attack's best part is declared twice")
                yield from ((left, {**winners, a: group}) for group in groups[a])
            else:
                i, blocks = self._parts(node, before)
                named = sorted(chain(*blocks))
                rest = tuple(sorted(set(left[i]) - set(named))) if has_covers else ()
                exact_cover = all(blocks) and sorted([*named, *rest]) == list(left[i])
                need(exact_cover, f"upper proof: the children of robot {i} do not partition its elements")
                blocks += [rest] if rest else []
                yield from (((*left[:i], block, *left[i + 1 :]), winners) for block in blocks)

        walk("upper", tree, (self.about.choices, {}), expand)
        return bounds

    def _parts(self, node: Any, before: dict[int, list[tuple[int, ...]]]) -> tuple[int, list[tuple[int, ...]]]:
        """The robot of an element branch and the parts that it names, or those that were named for it ``before``."""
        robot, *given = fields(
            "element branch", node, "element" if isinstance(node, dict) and "parts" not in node else "element parts"
        )
        i = index("element branch robot", robot, self.about.n)
        if given:
            before[i] = [indices("element branch", block, len(self.about.owner)) for block in array("parts", given[0])]
        need(i in before, f"upper proof: no branch before names the parts of robot {i}")
        return i, list(before[i])

    def _leaf(self, node: Any, cuts: list[_Cut], groups: list[Any], left: Any, winners: Any) -> Any:
        chosen, given = fields("leaf", node, "fenchel weights")
        used = [cuts[index("leaf cut", k, len(cuts))] for k in array("leaf cuts", chosen)]
        weights = [exact("leaf weight", w) for w in array("leaf weights", given, len(used))]
        mass = total(weights)
        need(mass > 0 and all(w >= 0 for w in weights), "upper proof: a leaf's weights are negative or all zero")
        wins = all(len(groups[cut.attack]) == 1 or winners.get(cut.attack) == cut.group for cut in used)
        need(wins, "upper proof: a leaf uses a group that is not known to win")
        pairs = list(zip(weights, used, strict=True))
        bound = total(w * cut.constant for w, cut in pairs)
        for i, elements in enumerate(left):
            tick()
            active = [(w, cut.scores) for w, cut in pairs if i in cut.group]
            bound += max(total(w * scores[e] for w, scores in active) for e in elements) if active else 0
        return bound / mass

    def _groups(self, attack: object) -> list[frozenset[int]]:
        """Check an attack against the budgets; return the seeing robots of its groups, by lowest robot."""
        robots, pairs = fields("attack", attack, "robots links")
        blinded, cut = (
            frozenset(indices("attack robots", robots, self.about.n)),
            links("attack links", pairs, self.about.n),
        )
        need(
            len(blinded) <= self.about.alpha_s and len(cut) <= self.about.alpha_c,
            "upper proof: an attack exceeds its budget",
        )
        allowed = cut <= self.about.links - self.about.safe_links and not blinded & self.about.safe_robots
        need(allowed, "upper proof: an attack hits what does not exist or is protected")
        groups: list[set[int]] = []
        tick()
        for start in range(self.about.n):
            stack, group = [start], {start}
            while stack and not any(start in g for g in groups):
                i = stack.pop()
                fresh = {j for j in self.about.near[i] - group if (min(i, j), max(i, j)) not in cut}
                group |= fresh
                stack.extend(fresh)
            groups += [group] if not stack else []
        return sorted((frozenset(g) for group in groups if (g := group - blinded)), key=min) or [frozenset()]

    def _covers(self, groups: list[list[frozenset[int]]], points: list[_Point], given: object) -> list[_Cover]:
        """Check covers: under an attack on links, what the elements beside ``left_out`` are worth in each group.

        Where the robots with an element in ``left_out`` can be blinded all at once, an attack leaves nothing else.
        So a plan that is worth more has ``alpha_s + 1`` of them, or a protected one, whose elements therefore count
        ``alpha_s + 1`` times.
        """
        covers = []
        for item in array("covers", given):
            a, out, numbers = fields("cover", item, "attack left_out points")
            family = groups[index("cover attack", a, len(groups))]
            need(sum(map(len, family)) == self.about.n, "upper proof: the attack of a cover blinds robots")
            left_out = frozenset(indices("cover left_out", out, len(self.about.owner)))
            bounds = []
            for group, p in zip(family, array("cover points", numbers, len(family)), strict=True):
                scores, constant = points[index("cover point", p, len(points))]
                bounds.append(constant + total(self._most(i, left_out, scores) for i in group))
            covers.append(_Cover(left_out, largest(bounds)))
        return covers

    def _most(self, robot: int, left_out: frozenset[int], scores: list[fmpq]) -> fmpq:
        """The largest score of what is kept of a robot's elements; 0 if it is blinded."""
        tick()
        return max([fmpq(0), *(scores[e] for e in self.about.choices[robot] if e not in left_out)])

    def _cover_leaf(self, node: Any, covers: list[_Cover], left: Any) -> Any:
        """The largest bound of covers, one of which each plan fails: none counts their weighted sum."""
        chosen, given = fields("cover leaf", node, "covers weights")
        used = [covers[index("leaf cover", k, len(covers))] for k in array("leaf covers", chosen)]
        weights = [exact("leaf weight", w) for w in array("leaf weights", given, len(used))]
        need(used and all(w > 0 for w in weights), "upper proof: a leaf's weights are not positive")
        needed = min(self.about.alpha_s, self.about.n - len(self.about.safe_robots)) + 1
        pairs, most = list(zip(weights, used, strict=True)), fmpq(0)
        for i, elements in enumerate(left):
            tick()
            count = needed if i in self.about.safe_robots else 1
            most += count * max(total(w for w, cover in pairs if e in cover.left_out) for e in elements)
        need(most < needed * total(weights), "upper proof: a plan of a leaf may meet all its covers")
        return largest([cover.bound for cover in used])

    def _points(self, points: object) -> list[_Point]:
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

    def _cuts(self, groups: list[list[frozenset[int]]], points: list[_Point], cut_list: object) -> list[_Cut]:
        cuts = []
        for item in array("cuts", cut_list):
            a, g, p = array("cut", item, 3)
            family = groups[index("cut attack", a, len(groups))]
            group = family[index("cut group", g, len(family))]
            point = points[index("cut point", p, len(points))]
            cuts.append(_Cut(a, group, point.constant, point.scores))
        return cuts

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
                constant -= w * d + w * arb((y * inverse).det()).log()
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
