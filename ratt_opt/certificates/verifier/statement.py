"""The problem and the plan that a certificate states, checked to be well posed.

Notation, per target: ``L(S) = prior^{-1} + sum of the information of S``.
"""

from __future__ import annotations

from typing import Any

from flint import fmpq, fmpq_mat

from ratt_opt.certificates.verifier.exact_matrices import definite, missing, total, trace
from ratt_opt.certificates.verifier.limits import limits
from ratt_opt.certificates.verifier.reading import (
    array,
    check_rows,
    exact,
    fields,
    index,
    indices,
    links,
    need,
    packed,
    rows_of,
)
from ratt_opt.certificates.verifier.work import afford, hold, refuse_wide

__all__ = ["Statement"]

PROBLEM = "objective dimension prior information weights owners links alpha_s alpha_c protected_robots protected_links"


class Statement:
    """One problem and plan, in exact numbers.

    ``output`` : the part C (q, d) of each target's state that counts: the identity if ``is_whole``. ``square`` : C'C.
    ``at_most``, ``idle`` : robots that may choose another element than their idle one, their first without information;
    ``None`` and nothing if all may.
    ``defect[e][j]`` : what has to be added to the eigenvalues of element ``e``'s information of target ``j`` to make it
    positive semidefinite. ``prior_low``, ``prior_high`` : bounds on ``max_j w_j lambda_max(C prior_j C')``
    (max-eigenvalue).

    Raises
    ------
    FileFormatError : a field is missing, too large or of another form.
    ProofError : the problem, the plan or the range of the prior's eigenvalue is not what it must be.
    """

    def __init__(self, problem: object, plan: object, prior_range: object) -> None:
        optional = [name for name in ("output", "at_most") if isinstance(problem, dict) and name in problem]
        self.is_whole = "output" not in optional
        given = fields("problem", problem, " ".join([PROBLEM, *optional]))
        kind, d, prior, information, weights, owners, pairs, blinded, cut, robots, safe_links, *rest = given
        output = rest[: not self.is_whole]
        need(kind in ("trace", "logdet", "maxeig"), "problem: the objective must be trace, logdet or maxeig")
        need(self.is_whole or kind != "logdet", "problem: the log-det has no output")
        self.objective, self.d = kind, index("dimension", d, 101)
        m, size = len(array("prior", prior)), self.d * (self.d + 1) // 2
        rows = [array(f"information[{e}]", row, m) for e, row in enumerate(array("information", information))]
        named = [(f"prior[{j}]", p) for j, p in enumerate(prior)]
        for where, x in (*named, *((f"information[{e}]", x) for e, row in enumerate(rows) for x in row)):
            array(where, x, size)
        for c in (c for part in output for c in array("output", part, m)):
            check_rows("output", c, self.d)
        array("weights", weights, m)
        self._read_team(owners, pairs, (blinded, cut), (robots, safe_links), len(rows))
        self.plan = tuple(index("plan", e, len(self.owner)) for e in array("plan", plan, self.n))
        need(
            self.d and m and self.n and all(self.choices),
            "problem: no target, no dimension, or a robot without element",
        )
        need(self.safe_links <= self.links, "problem: a protected link does not exist")
        need(all(self.owner[e] == i for i, e in enumerate(self.plan)), "plan: an element is not its robot's")
        self._read_numbers(prior, rows, weights, output)
        need(all(w > 0 for w in self.weights), "problem: a weight is not positive")
        refuse_wide((x for row in (self.prior, *self.information) for x in row), self.d)
        need(all(definite(p) > 0 for p in self.prior), "problem: a prior is not positive definite")
        self._derive(prior_range)
        self.at_most: int | None = None
        self.idle: tuple[int, ...] = ()
        for most in rest[len(output) :]:
            self._read_limit(most)

    def _read_team(
        self, owners: object, pairs: object, budgets: tuple[object, object], safe: tuple[object, object], elements: int
    ) -> None:
        self.owner = [index("owners", i, limits().robots) for i in array("owners", owners, elements)]
        self.n = n = max(self.owner, default=-1) + 1
        self.choices = tuple(tuple(e for e, i in enumerate(self.owner) if i == k) for k in range(n))
        self.links, self.safe_links = links("links", pairs, n), links("protected_links", safe[1], n)
        self.near: list[set[int]] = [set() for _ in range(n)]
        for i, j in self.links:
            self.near[i].add(j)
            self.near[j].add(i)
        self.alpha_s, self.alpha_c = (
            index("alpha_s", budgets[0], n + 1),
            index("alpha_c", budgets[1], len(self.links) + 1),
        )
        self.safe_robots = frozenset(indices("protected_robots", safe[0], n))

    def _read_limit(self, most: object) -> None:
        """Read how many robots may be busy; the plan is one of these."""
        limit = self.at_most = index("at_most", most, self.n + 1)
        nothing = [all(not any(x.entries()) for x in row) for row in self.information]
        first = [next((e for e in own if nothing[e]), None) for own in self.choices]
        need(None not in first, "problem: a robot has no element without information, to be idle with")
        self.idle = tuple(e for e in first if e is not None)
        busy = sum(e != idle for e, idle in zip(self.plan, self.idle, strict=True))
        need(busy <= limit, "plan: more robots are busy than at_most")

    def _read_numbers(self, prior: list[Any], rows: list[list[Any]], weights: list[Any], output: list[Any]) -> None:
        """Read matrices and weights exactly, once their shapes are those of the problem."""
        self.prior = [packed(f"prior[{j}]", p, self.d) for j, p in enumerate(prior)]
        self.information = [[packed(f"information[{e}]", x, self.d) for x in row] for e, row in enumerate(rows)]
        self.weights = [exact("weights", w) for w in weights]
        self.identity = fmpq_mat(self.d, self.d, [int(i == j) for i in range(self.d) for j in range(self.d)])
        stated = [rows_of("output", c, self.d) for part in output for c in part]
        self.output = stated or [self.identity] * len(prior)

    def _derive(self, prior_range: object) -> None:
        """Derive the quantities that the checks need; information must be semidefinite up to rounding."""
        self.inverse = [self._inverse(p) for p in self.prior]
        self.square = [c.transpose() * c for c in self.output]
        parts = zip(self.weights, self.square, self.prior, strict=True)
        self.prior_traces = [w * trace(square * p) for w, square, p in parts]
        self.prior_trace = total(self.prior_traces)
        self.defect = [[missing(x, self.identity) for x in row] for row in self.information]
        semidefinite = all(delta is not None for row in self.defect for delta in row)
        need(semidefinite, "problem: an information matrix is not positive semidefinite")
        self.prior_low, self.prior_high = self._check_prior_range(prior_range)
        # Stored information is positive semidefinite up to rounding: with its defect added, it is. So L(S) is
        # positive definite for all plans; n more defects leave room for the lower proof.
        for j, inverse in enumerate(self.inverse):
            worst = total(max(self.defect[e][j] for e in own) for own in self.choices)
            room = inverse - self.identity * ((self.n + 1) * worst)
            need(definite(room) > 0, f"problem: information of target {j} is not positive semidefinite")

    def _inverse(self, prior: fmpq_mat) -> fmpq_mat:
        afford(prior)
        inverse = prior.inv()
        hold(inverse[0, 0], self.d * self.d)
        return inverse

    def _check_prior_range(self, given: object) -> tuple[fmpq, fmpq]:
        """Check ``low <= max_j w_j lambda_max(C prior_j C') <= high`` (max-eigenvalue only; empty otherwise)."""
        if self.objective != "maxeig":
            array("prior_eigenvalue", given, 0)
            return fmpq(0), fmpq(0)
        low, high = (exact("prior_eigenvalue", x) for x in array("prior_eigenvalue", given, 2))
        pairs = [(w, c * p * c.transpose()) for w, c, p in zip(self.weights, self.output, self.prior, strict=True)]
        need(all(definite(_scaled(high / w, p) - p) >= 0 for w, p in pairs), "prior_eigenvalue: upper too small")
        need(any(definite(_scaled(low / w, p) - p) <= 0 for w, p in pairs), "prior_eigenvalue: lower too large")
        return low, high


def _scaled(value: fmpq, like: fmpq_mat) -> fmpq_mat:
    """``value`` times the identity of the size of another matrix."""
    q = like.nrows()
    return fmpq_mat(q, q, [value if i == j else 0 for i in range(q) for j in range(q)])
