"""Verification of the upper end for all plans: a search tree, checked leaf by leaf.

Notation, per target: ``<A, B> = tr(A B)`` and ``L(S) = prior^{-1} + sum of the information of S``.
"""

from __future__ import annotations

from itertools import chain
from typing import TYPE_CHECKING, Any, NamedTuple

from flint import arb, ctx, fmpq

from ratt_opt.certificates.verifier import reading
from ratt_opt.certificates.verifier.exact_matrices import largest, total
from ratt_opt.certificates.verifier.limits import limits
from ratt_opt.certificates.verifier.reading import (
    array,
    exact,
    fields,
    index,
    indices,
    links,
    need,
    walk,
)
from ratt_opt.certificates.verifier.spacing import Spacing
from ratt_opt.certificates.verifier.tangents import read_points
from ratt_opt.certificates.verifier.target_lemmas import TargetInequalities
from ratt_opt.certificates.verifier.work import hold, tick
from ratt_opt.errors import ProofError

if TYPE_CHECKING:
    from collections.abc import Iterator

    from ratt_opt.certificates.verifier.statement import Statement
    from ratt_opt.certificates.verifier.tangents import Bound

__all__ = ["Left", "UpperCheck", "Winners", "check_upper", "upper_bounds"]

Left = tuple[tuple[int, ...], ...]
Winners = dict[int, frozenset[int]]

OPTIONAL = "covers", "tangents", "lemmas", "usual", "rows", "spacing"
FIELDS = " ".join(("attacks points cuts tree", *OPTIONAL))
NODES = "covers", "marginals", "fenchel", "part"
"""Names of nodes, by a field that no other node has; those without one are branches on elements."""


class _Cut(NamedTuple):
    """``phi(plan restricted to group)`` is at most what the bound says of the elements of the group's robots."""

    attack: int
    group: frozenset[int]
    bound: Bound


class _Cover(NamedTuple):
    """A plan is worth at most ``bound`` if it counts less than needed of ``left_out`` (:meth:`UpperCheck._cover`)."""

    left_out: frozenset[int]
    bound: Any


def check_upper(about: Statement, part: object, upper: fmpq) -> int:
    """Check that every plan's worst-case value is at most ``upper``; return the number of leaves."""
    need(upper >= 0, "claim: upper is negative")  # a group of blinded robots only is worth phi(empty set) = 0
    for precision in limits().precisions:
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
        given = {name: [] for name in OPTIONAL} | part if isinstance(part, dict) else part
        parts = fields("upper proof", given, FIELDS)
        attacks, points, cuts, tree, covers, tangents, lemmas, usual, rows, spacing = parts
        self._has_covers = isinstance(part, dict) and "covers" in part
        families = array("attacks", attacks)
        reading.check_size("attacks", len(families) * about.n, limits().cells)
        self.groups = [self._groups_left(attack) for attack in families]
        self._points = read_points(about, points)
        self.inequalities = TargetInequalities(about, tangents, lemmas, usual)
        self.cuts = [self._cut(cut) for cut in array("cuts", cuts)]
        self.cuts += [self._row(row) for row in array("rows", rows)]
        self.covers = [self._cover(cover) for cover in array("covers", covers)]
        self._named: dict[int, list[tuple[int, ...]]] = {}
        is_spaced = isinstance(part, dict) and "spacing" in part
        self.spacing = Spacing(about, spacing, self.inequalities.lemmas) if is_spaced else None
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
            bound = leaves[name](node, left, winners)
            self.bounds.append(bound if self.spacing is None else self.spacing.lowered(bound))
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
        largest score among the elements left. If only some robots may be busy, the others have the score of their idle
        element: at most the idle scores of all, and the largest gains beside them. A robot without its idle element is
        busy; if more are than may be, the leaf has no plan, and needs no cut.
        """
        pairs = self.weighed(node, "fenchel", self.cuts)
        most, idle = self.about.at_most, self.about.idle
        forced = 0 if most is None else sum(e not in elements for e, elements in zip(idle, left, strict=True))
        if most is not None and forced > most:
            return fmpq(0)
        mass = total(w for w, _ in pairs)
        need(mass > 0 and all(w >= 0 for w, _ in pairs), "upper proof: a leaf's weights are negative or all zero")
        wins = all(len(self.groups[cut.attack]) == 1 or winners.get(cut.attack) == cut.group for _, cut in pairs)
        need(wins, "upper proof: a leaf uses a group that is not known to win")
        bound = total(w * cut.bound.constant for w, cut in pairs)
        gains: list[Any] = []
        for i, elements in enumerate(left):
            tick()
            active = [(w, cut.bound.scores) for w, cut in pairs if i in cut.group]
            scores = {e: total(w * scores[e] for w, scores in active) if active else fmpq(0) for e in elements}
            rests = most is not None and idle[i] in scores
            bound += scores[idle[i]] if rests else max(scores.values())
            gains.extend([max(scores.values()) - scores[idle[i]]] if rests else [])
        return (bound + total(sorted(gains, reverse=True)[: (most or 0) - forced])) / mass

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
        return self.inequalities.marginals().bound(self.groups[self._number("marginal leaf", attack)], left)

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
        return self._of_group("cut", a, g, self._point("cut point", p))

    def _row(self, given: object) -> _Cut:
        a, g, inequalities = array("row", given, 3)
        return self._of_group("row", a, g, self.inequalities.row(inequalities))

    def _of_group(self, where: str, attack: object, group: object, bound: Bound) -> _Cut:
        a = self._number(f"{where} attack", attack)
        groups = self.groups[a]
        return _Cut(a, groups[index(f"{where} group", group, len(groups))], bound)

    def _point(self, where: str, number: object) -> Bound:
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
