"""Values of plans in exact arithmetic, from the definitions: rationals, and balls where a value is irrational.

To be used with ``ctx.workdps(DIGITS)``.
"""

from itertools import product

from flint import arb, fmpq, fmpq_mat

from tests.oracles import all_attacks, groups_left

DIGITS = 60


def rational(value):
    return fmpq(*float(value).as_integer_ratio())


def matrix(entries):
    return fmpq_mat(len(entries), len(entries[0]), [rational(x) for row in entries for x in row])


def trace(square):
    return sum((square[i, i] for i in range(square.nrows())), fmpq(0))


def is_definite(square):
    """Whether a symmetric matrix is positive definite, by its leading minors."""
    n = square.nrows()
    minors = (fmpq_mat(k, k, [square[i, j] for i in range(k) for j in range(k)]) for k in range(1, n + 1))
    return all(minor.det() > 0 for minor in minors)


def largest_eigenvalue(square):
    """A ball, by bisection."""
    low, high = fmpq(0), trace(square)
    one = fmpq_mat(
        square.nrows(), square.nrows(), [fmpq(int(i % (square.nrows() + 1) == 0)) for i in range(square.nrows() ** 2)]
    )
    for _ in range(4 * DIGITS):
        middle = (low + high) / 2
        if is_definite(one * middle - square):
            high = middle
        else:
            low = middle
    return arb((low + high) / 2, (high - low) / 2) if high > low else arb(high)


class ExactValues:
    """Of sets of elements of one problem, and of its plans under attack."""

    def __init__(self, problem):
        f = self.objective = problem.objective
        self.problem, self.known = problem, {}
        self.prior = [matrix(p.tolist()) for p in f.prior]
        self.added = [[matrix(x.tolist()) for x in row] for row in f.information]
        self.weights = [rational(w) for w in f.weights]
        output = getattr(f, "output", None)
        self.output = None if output is None else [matrix(c.tolist()) for c in output]

    def __call__(self, elements):
        key = tuple(sorted(elements))
        if key not in self.known:
            self.known[key] = self._value(key)
        return self.known[key]

    def _value(self, elements):
        before, after = [], []
        for j, prior in enumerate(self.prior):
            information = prior.inv()
            for e in elements:
                information += self.added[e][j]
            before.append(self._criterion(j, prior))
            after.append(self._criterion(j, information.inv()))
        if self.objective.name == "maxeig":
            return self._largest(before) - self._largest(after)
        return sum((b - a for b, a in zip(before, after, strict=True)), arb(0))

    def _criterion(self, j, covariance):
        if self.output is not None:
            covariance = self.output[j] * covariance * self.output[j].transpose()
        if self.objective.name == "trace":
            return arb(self.weights[j] * trace(covariance))
        if self.objective.name == "logdet":
            return arb(self.weights[j]) * arb(covariance.det()).log()
        return arb(self.weights[j]) * largest_eigenvalue(covariance)

    @staticmethod
    def _largest(values):
        best = values[0]
        for value in values[1:]:
            best = best.max(value)
        return best

    def team(self, elements, attack):
        groups = groups_left(self.problem, attack.links)
        return self._largest([self([elements[i] for i in group - attack.sensing]) for group in groups])

    def worst_case(self, elements):
        worst = None
        for blinded, cut in all_attacks(self.problem):
            value = self._largest(
                [self([elements[i] for i in group - blinded]) for group in groups_left(self.problem, cut)]
            )
            worst = value if worst is None else worst.min(value)
        return worst

    def optimum(self):
        return self._largest([self.worst_case(plan) for plan in product(*(c.tolist() for c in self.problem.choices))])


def holds(lower, exact, upper):
    """Whether the exact value lies in the bracket, up to 1e-40: far below the last digit of any end."""
    slack = fmpq(1, 10**40)
    return bool(arb(lower) <= exact + slack) and bool(exact <= arb(upper) + slack)
