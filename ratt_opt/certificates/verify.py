"""The independent verifier: decides, exactly, whether a certificate proves its claim.

Imports no solver, no attacker, no numerical library. Trace and max-eigenvalue are decided in rational
arithmetic, logarithms in balls (python-flint). Notation, per target: ``<A, B> = tr(A B)`` and
``L(S) = prior^{-1} + sum of the information of S``. The proofs are in the docstrings of what checks them.
"""

from __future__ import annotations

from itertools import chain
from typing import TYPE_CHECKING, Any, NamedTuple

from flint import arb, ctx, fmpq, fmpq_mat

from ratt_opt.certificates import reading
from ratt_opt.certificates.exact_matrices import defect_of, definite, largest_of_inverse, total, trace, trace_of_inverse
from ratt_opt.certificates.reading import array, exact, fields, index, indices, links, need, packed, walk
from ratt_opt.certificates.verified import Verified
from ratt_opt.errors import ProofError

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

__all__ = ["Checker", "verify_certificate"]

PRECISIONS = (128, 1024)
"""Bits of the balls; a comparison undecided at the last is not proved."""
PROBLEM = "objective dimension prior information weights owners links alpha_s alpha_c protected_robots protected_links"
LARGEST_TEAM = 1000


def verify_certificate(path: str | Path, *, expected_problem: object = None) -> Verified:
    """Decide whether the certificate at ``path`` proves its claim.

    Parameters
    ----------
    expected_problem : the problem record it must be about (``problem_document(problem)``); any when ``None``

    Raises
    ------
    FileFormatError : the file is not a certificate of this version.
    ProofError : the proof has a fault; the text names the first one found.
    """
    names = "format version problem plan claim prior_eigenvalue upper lower"
    _, _, problem, plan, claim, prior_range, upper_part, lower_part = fields("", reading.load(path), names)
    need(expected_problem in (None, problem), "the certificate is about a different problem than the one given")
    low, high = fields("claim", claim, "lower upper")
    lower, upper = exact("claim lower", low), exact("claim upper", high)
    need(lower <= upper, "claim: lower is above upper")
    checker = Checker(problem, plan, prior_range)
    upper_leaves, lower_leaves = checker.check_upper(upper_part, upper), checker.check_lower(lower_part, lower)
    return Verified(
        lower=float(low),
        upper=float(high),
        lower_proved=lower_leaves > 0,
        lower_method=str(lower_part["kind"]),
        elements=checker.plan,
        objective=checker.objective,
        arithmetic="ball arithmetic" if checker.objective == "logdet" else "exact rational arithmetic",
        problem_hash=reading.document_hash(problem),
        n_robots=checker.n,
        n_targets=len(checker.prior),
        n_elements=len(checker.owner),
        alpha_s=checker.alpha_s,
        alpha_c=checker.alpha_c,
        largest_defect=float(arb(max(map(max, checker.defect))).upper()),
        upper_leaves=upper_leaves,
        lower_leaves=lower_leaves,
    )


class _Cut(NamedTuple):
    """``phi(plan restricted to group) <= constant + sum of scores[element] over the robots of the group``."""

    attack: int
    group: frozenset[int]
    constant: Any
    scores: list[fmpq]


class Checker:
    """One problem and plan, checked to be well posed; decides the two proofs."""

    def __init__(self, problem: object, plan: object, prior_range: object) -> None:
        kind, d, prior, information, weights, owners, pairs, blinded, cut, *safe = fields("problem", problem, PROBLEM)
        need(kind in ("trace", "logdet", "maxeig"), "problem: the objective must be trace, logdet or maxeig")
        self.objective, self.d = kind, index("dimension", d, 101)
        self.prior = [packed(f"prior[{j}]", p, self.d) for j, p in enumerate(array("prior", prior))]
        m = len(self.prior)
        rows = [array(f"information[{e}]", row, m) for e, row in enumerate(array("information", information))]
        self.information = [[packed(f"information[{e}]", x, self.d) for x in row] for e, row in enumerate(rows)]
        self.weights = [exact("weights", w) for w in array("weights", weights, m)]
        self.owner = [index("owners", i, LARGEST_TEAM) for i in array("owners", owners, len(rows))]
        self.n = n = max(self.owner, default=-1) + 1
        self.choices = tuple(tuple(e for e, i in enumerate(self.owner) if i == k) for k in range(n))
        self.links, self.safe_links = links("links", pairs, n), links("protected_links", safe[1], n)
        self.near: list[set[int]] = [set() for _ in range(n)]
        for i, j in self.links:
            self.near[i].add(j)
            self.near[j].add(i)
        self.alpha_s, self.alpha_c = index("alpha_s", blinded, n + 1), index("alpha_c", cut, len(self.links) + 1)
        self.safe_robots = frozenset(indices("protected_robots", safe[0], n))
        self.plan = tuple(index("plan", e, len(self.owner)) for e in array("plan", plan, n))
        need(self.d and m and n and all(self.choices), "problem: no target, no dimension, or a robot without element")
        need(self.safe_links <= self.links, "problem: a protected link does not exist")
        need(all(self.owner[e] == i for i, e in enumerate(self.plan)), "plan: an element is not its robot's")
        need(all(w > 0 for w in self.weights), "problem: a weight is not positive")
        need(all(definite(p) > 0 for p in self.prior), "problem: a prior is not positive definite")
        self.identity = fmpq_mat(self.d, self.d, [int(i == j) for i in range(self.d) for j in range(self.d)])
        self.inverse = [p.inv() for p in self.prior]
        self.prior_trace = total(w * trace(p) for w, p in zip(self.weights, self.prior, strict=True))
        self.defect = [[defect_of(x, self.identity) for x in row] for row in self.information]
        self.prior_low, self.prior_high = self._check_prior_range(prior_range)
        # Stored information is positive semidefinite up to rounding: with its defect added, it is. So L(S) is
        # positive definite for all plans; n more defects leave room for the lower proof.
        for j, inverse in enumerate(self.inverse):
            worst = total(max(self.defect[e][j] for e in own) for own in self.choices)
            room = inverse - self.identity * ((n + 1) * worst)
            need(definite(room) > 0, f"problem: information of target {j} is not positive semidefinite")

    def _check_prior_range(self, given: object) -> tuple[fmpq, fmpq]:
        """Check ``low <= max_j w_j lambda_max(prior_j) <= high`` (max-eigenvalue only; empty otherwise)."""
        if self.objective != "maxeig":
            array("prior_eigenvalue", given, 0)
            return fmpq(0), fmpq(0)
        low, high = (exact("prior_eigenvalue", x) for x in array("prior_eigenvalue", given, 2))
        pairs = list(zip(self.weights, self.prior, strict=True))
        need(all(definite(self.identity * (high / w) - p) >= 0 for w, p in pairs), "prior_eigenvalue: upper too small")
        need(any(definite(self.identity * (low / w) - p) <= 0 for w, p in pairs), "prior_eigenvalue: lower too large")
        return low, high

    # --- No plan keeps more than `upper` under every attack. ---

    def check_upper(self, part: object, upper: fmpq) -> int:
        """Check that every plan's worst-case value is at most ``upper``; return the number of leaves."""
        need(upper >= 0, "claim: upper is negative")  # a group of blinded robots only is worth phi(empty set) = 0
        for precision in PRECISIONS:
            with ctx.workprec(precision):
                bounds = self.upper_bounds(part)
                worst = next((b for b in bounds if not b <= upper), None)
                if worst is None:
                    return len(bounds)
        raise ProofError(f"upper proof: a leaf only proves {arb(worst).str(17)}, more than the claim")

    def upper_bounds(self, part: object) -> list[Any]:
        """Return each leaf's bound; together the leaves cover all plans, or ProofError.

        The plans of a case are a product of element sets, one per robot. Under attack ``a`` the team value is
        the value of the winning group; a cut of group g may be used where g is the only group or the declared
        winner. So the worst case is at most any weighted average of usable cuts, and that is at most its
        constant plus, robot by robot, the largest score among the elements left.
        """
        attacks, points, cut_list, tree = fields("upper proof", part, "attacks points cuts tree")
        families = array("attacks", attacks)
        reading.check_size("attacks", len(families) * self.n, reading.LARGEST_TABLE)
        groups = [self._groups(attack) for attack in families]
        cuts, bounds = self._cuts(groups, points, cut_list), []

        def expand(node: Any, case: Any) -> Iterator[Any]:
            left, winners = case
            if isinstance(node, dict) and "weights" in node:
                bounds.append(self._leaf(node, cuts, groups, left, winners))
            elif isinstance(node, dict) and "attack" in node:
                a = index("winner branch", fields("winner branch", node, "attack")[0], len(groups))
                need(a not in winners, "upper proof: an attack's winner is declared twice")
                yield from ((left, {**winners, a: group}) for group in groups[a])
            else:
                robot, parts = fields("element branch", node, "robot parts")
                i = index("element branch robot", robot, self.n)
                blocks = [indices("element branch", block, len(self.owner)) for block in array("parts", parts)]
                exact_cover = all(blocks) and sorted(chain(*blocks)) == list(left[i])
                need(exact_cover, f"upper proof: the children of robot {i} do not partition its elements")
                yield from (((*left[:i], block, *left[i + 1 :]), winners) for block in blocks)

        walk("upper", tree, (self.choices, {}), expand)
        return bounds

    def _leaf(self, node: Any, cuts: list[_Cut], groups: list[Any], left: Any, winners: Any) -> Any:
        chosen, given = fields("leaf", node, "cuts weights")
        used = [cuts[index("leaf cut", k, len(cuts))] for k in array("leaf cuts", chosen)]
        weights = [exact("leaf weight", w) for w in array("leaf weights", given, len(used))]
        mass = total(weights)
        need(mass > 0 and all(w >= 0 for w in weights), "upper proof: a leaf's weights are negative or all zero")
        wins = all(len(groups[cut.attack]) == 1 or winners.get(cut.attack) == cut.group for cut in used)
        need(wins, "upper proof: a leaf uses a group that is not known to win")
        pairs = list(zip(weights, used, strict=True))
        bound = total(w * cut.constant for w, cut in pairs)
        for i, elements in enumerate(left):
            active = [(w, cut.scores) for w, cut in pairs if i in cut.group]
            bound += max(total(w * scores[e] for w, scores in active) for e in elements) if active else 0
        return bound / mass

    def _groups(self, attack: object) -> list[frozenset[int]]:
        """Check an attack against the budgets; return the seeing robots of its groups, by lowest robot."""
        robots, pairs = fields("attack", attack, "robots links")
        blinded, cut = frozenset(indices("attack robots", robots, self.n)), links("attack links", pairs, self.n)
        need(len(blinded) <= self.alpha_s and len(cut) <= self.alpha_c, "upper proof: an attack exceeds its budget")
        allowed = cut <= self.links - self.safe_links and not blinded & self.safe_robots
        need(allowed, "upper proof: an attack hits what does not exist or is protected")
        groups: list[set[int]] = []
        for start in range(self.n):
            stack, group = [start], {start}
            while stack and not any(start in g for g in groups):
                i = stack.pop()
                fresh = {j for j in self.near[i] - group if (min(i, j), max(i, j)) not in cut}
                group |= fresh
                stack.extend(fresh)
            groups += [group] if not stack else []
        return sorted((frozenset(g) for group in groups if (g := group - blinded)), key=min) or [frozenset()]

    def _cuts(self, groups: list[list[frozenset[int]]], points: object, cut_list: object) -> list[_Cut]:
        width = len(self.prior) * self.d**2
        given = array("points", points)
        reading.check_size("points", len(given) * max(width, len(self.owner)), reading.LARGEST_TABLE)
        fenchel = [self._fenchel(point) for point in given]
        columns = [x for row in self.information for matrix in row for x in matrix.entries()]
        rows = fmpq_mat(len(fenchel), width, [x for row, _ in fenchel for x in row])
        scores = (rows * fmpq_mat(len(self.owner), width, columns).transpose()).tolist()
        cuts = []
        for item in array("cuts", cut_list):
            a, g, p = array("cut", item, 3)
            family = groups[index("cut attack", a, len(groups))]
            group = family[index("cut group", g, len(family))]
            cuts.append(_Cut(a, group, fenchel[index("cut point", p, len(fenchel))][1], scores[p]))
        return cuts

    def _fenchel(self, point: object) -> tuple[list[fmpq], Any]:
        """Return ``(W, c)`` with ``phi(S) <= c + sum over e in S of <W, information[e]>`` for every S.

        trace:  tr(L^{-1}) >= 2 tr(Y) - tr(Y L Y), from (L^{-1} - Y) L (L^{-1} - Y) >= 0; W = w Y^2.
        logdet: logdet L <= tr(Y L) - logdet Y - d, from log x <= x - 1 for the eigenvalues of Y L; W = w Y.
        maxeig: lambda_max(L^{-1}) >= 1/q >= 2t - t^2 q with q = v'Lv / v'v; W = w t^2 vv' / v'v for one target.
        """
        d, m = self.d, len(self.prior)
        if self.objective == "maxeig":
            target, size, vector = array("point", point, 3)
            j, t = index("point target", target, m), exact("point t", size)
            v = fmpq_mat(d, 1, [exact("point v", x) for x in array("point v", vector, d)])
            need(any(v.entries()), "upper proof: a direction v is zero")
            weight = v * v.transpose() * (self.weights[j] * t * t / trace(v.transpose() * v))
            blank = [fmpq(0)] * (d * d)
            constant = self.prior_high - 2 * self.weights[j] * t + trace(weight * self.inverse[j])
            return blank * j + weight.entries() + blank * (m - j - 1), constant
        row, constant = [], fmpq(0)
        packs = array("point", point, m)
        for given, w, prior, inverse in zip(packs, self.weights, self.prior, self.inverse, strict=True):
            y = packed("point Y", given, d)
            weight = y * w if self.objective == "logdet" else y * y * w
            if self.objective == "logdet":
                need(definite(y) > 0, "upper proof: a Fenchel point Y is not positive definite")
                constant -= w * d + w * arb((y * inverse).det()).log()
            else:
                constant += w * (trace(prior) - 2 * trace(y))
            constant += trace(weight * inverse)
            row += weight.entries()
        return row, constant

    # --- The plan keeps at least `lower` under every attack. ---

    def check_lower(self, part: Any, lower: fmpq) -> int:
        """Check that the plan's value is at least ``lower`` under every attack.

        Returns the number of leaves; 0 when the part says that it is no proof. Every leaf names robots S that see
        and are known to be in one group. The group's L is at least L(S) minus the plan's defects, in the Loewner
        order, so the group is worth at least the criterion there.
        """
        kind = part.get("kind") if isinstance(part, dict) else None
        defects = [total(self.defect[e][j] for e in self.plan) for j in range(len(self.prior))]
        start = [inverse - self.identity * delta for inverse, delta in zip(self.inverse, defects, strict=True)]
        if kind == "forced_size":
            _, size, tree = fields("lower proof", part, "kind size tree")
            return self._check_forced_size(index("forced size", size, self.n + 1), tree, start, lower)
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
        complete = 2 * len(self.links) == self.n * (self.n - 1)
        forced = complete and _is_forced(self.n, self.alpha_s, self.alpha_c, size)
        need(forced, f"lower proof: not every attack is shown to leave a group of {size}")

        def expand(node: Any, case: Any) -> Iterator[Any]:
            posterior, decided, out = case
            if node == -1:
                self._require([posterior], 1, lower)
            elif node == -3:
                missing = size - len(decided) + out
                need(missing > 0, "lower proof: no robot is missing")
                rest = [i for i in range(self.n) if i not in decided]
                self._require([self._with(posterior, [i], missing) for i in rest], missing, lower)
            elif node == -2:
                need(out > self.n - size, "lower proof: a leaf is not impossible")
            else:
                i = index("lower tree", node, self.n)
                need(i not in decided, f"lower proof: robot {i} is decided twice")
                yield self._with(posterior, [i]), decided | {i}, out
                yield posterior, decided | {i}, out + 1

        return walk("lower", tree, (start, frozenset(), 0), expand)

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
                i, asks_group = divmod(index("lower tree", node, 2 * self.n), 2)
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
        between = {(i, j) for i, j in self.links if i in home and j in home and home[i] != home[j]}
        counts = [[len(self.near[i] & part) for part in parts] for i in range(self.n) if i not in home]
        lost = len(between) + sum(sum(c) - max(c, default=0) for c in counts)
        protected = between & self.safe_links or blind & self.safe_robots
        return lost > self.alpha_c or len(blind) > self.alpha_s or bool(protected)

    def _with(self, posterior: list[fmpq_mat], robots: list[int], times: int = 1) -> list[fmpq_mat]:
        for i in robots:
            posterior = [a + b * times for a, b in zip(posterior, self.information[self.plan[i]], strict=True)]
        return posterior

    def _require(self, cases: list[list[fmpq_mat]], count: int, lower: fmpq) -> None:
        """Check that any ``count`` of the cases (all positive definite) are worth ``lower`` on average."""
        worth = False
        for precision in PRECISIONS:
            with ctx.workprec(precision):
                worth = worth or self._are_worth(cases, count, lower)
        need(worth, "lower proof: a leaf is worth less than the claim")

    def _are_worth(self, cases: list[list[fmpq_mat]], count: int, lower: fmpq) -> bool:
        if lower <= 0 and all(definite(m - i) >= 0 for x in cases for m, i in zip(x, self.inverse, strict=True)):
            return True  # at least the prior's information is worth at least phi(empty set) = 0
        if self.objective != "maxeig" or self.d == 2:
            return bool(total(sorted(map(self._value, cases))[:count]) >= lower * count)
        # Each case is worth it if lambda_max(L^{-1}) <= room / w for its targets, decided as L - (w / room) I >= 0.
        room = self.prior_low - lower
        pairs = (pair for x in cases for pair in zip(self.weights, x, strict=True))
        return bool(room > 0) and all(definite(m - self.identity * (w / room)) >= 0 for w, m in pairs)

    def _value(self, posterior: list[fmpq_mat]) -> Any:
        """Return a lower bound on the criterion (max-eigenvalue: d = 2), sharper at a higher precision."""
        pairs = list(zip(self.weights, posterior, strict=True))
        if self.objective == "maxeig":
            return self.prior_low - max(w * largest_of_inverse(m) for w, m in pairs)
        if self.objective == "trace":
            return self.prior_trace - total(w * trace_of_inverse(m) for w, m in pairs)
        items = zip(self.weights, self.prior, posterior, strict=True)
        return total(w * arb((m * p).det()).log() for w, p, m in items).lower()


def _is_forced(n: int, alpha_s: int, alpha_c: int, size: int) -> bool:
    """Whether every attack on the complete graph of n robots leaves a group with ``size`` seeing robots.

    Otherwise groups n_1 + ... = n have (n^2 - sum n_k^2) / 2 <= alpha_c links between them and, to bring each below
    ``size``, sum max(0, n_k - size + 1) <= alpha_s. ``best[r][x]``: largest sum n_k^2 of r robots, blinding x.
    """
    best = [[0] * (alpha_s + 1)]
    for r in range(1, n + 1):
        options = [range(1, min(r, size - 1 + x) + 1) for x in range(alpha_s + 1)]
        part = [[k * k + best[r - k][x - max(0, k - size + 1)] for k in ks] for x, ks in enumerate(options)]
        best.append([max(values, default=-n * n - 1) for values in part])
    return size == 0 or n * n - best[n][alpha_s] > 2 * alpha_c
