"""Proofs built to deceive: trees closed by whatever rule the verifier takes, with duals, flows and lemmas at will.

The forger knows the verifier and asks it about every leaf. Of claims that are false it must fail; of claims that are
true it succeeds often enough to show that it is no straw man.
"""

from dataclasses import replace

import numpy as np
import pytest
from flint import fmpq

from ratt_opt import ProofError
from ratt_opt.certificates.verifier.cases import Cases, mask_of
from ratt_opt.certificates.verifier.duals import Duals
from ratt_opt.certificates.verifier.worth import Worth
from tests.certificates.engine import check, drawn, statement

LARGEST = 120
"""Nodes of a forged tree."""
FLOWS, LIMITS = 6, 3


class Forger:
    """Forges the lower end of one problem and plan for a claim."""

    def __init__(self, problem, plan, claim, rng):
        self.about, self.claim, self.rng = statement(problem, plan), claim, rng
        self.cases = Cases(self.about, Worth(self.about, fmpq(*claim.as_integer_ratio())))
        self.n = self.about.n

    def forged(self):
        """A proof, closed wherever the verifier lets it be, or ``None``."""
        self.cases.limits.clear()
        size = next((k for k in range(self.n + 1) if self._sets(k)), self.n + 1)
        sets = {"size": size, "tree": self._sets(size) or ["budget"]}
        if self.rng.uniform() < 0.2:
            return {"conclusion": "forced", "sets": sets}
        rng, links, link = self.rng, len(self.about.links), int(self.rng.integers(1, 30))
        degrees = np.array([len(near) for near in self.about.near])
        robots = (link * rng.uniform(0.2, 1.2) * degrees + rng.integers(-3, 4, self.n)).astype(int).tolist()
        given = {"link": link, "robots": robots, "blinded": int(rng.integers(0, 40))}
        bounds = []
        for _ in range(FLOWS):
            cut = int(rng.choice([0, 0, rng.integers(0, link + 1)]))
            flow = rng.integers(-(link + cut), link + cut + 1, links).tolist()
            bounds.append({"blinding": int(rng.choice([0, rng.integers(0, 40)])), "cut": cut, "flow": flow})
        bounds.append({"blinding": 0, "cut": 0, "flow": [0] * links})
        limits = [limit for limit in (self._limit() for _ in range(LIMITS)) if limit is not None]
        self.duals = Duals(self.cases, given)
        self.duals.read_bounds(bounds)
        self.closing = {"flow": self.duals.close_by_flow}
        if self.duals.slack >= 0:
            self.closing["listed"] = self.duals.list_group
        tree = []
        if not self._close(self.cases.groups(min(size - 1, self.n)), tree):
            return None
        proof = {"sets": sets, "duals": given, "bounds": bounds, "tree": tree, **({"limits": limits} if limits else {})}
        if self.duals.slack < 0:
            return {"conclusion": "duals", **proof}
        partition = self._partition()
        return None if partition is None else {"conclusion": "cover", **proof, "partition": partition}

    def _limit(self):
        """The least size that the verifier takes of some robots, as a limit; ``None`` if it takes none."""
        robots = [i for i in range(self.n) if self.rng.uniform() < 0.7]
        for size in range(len(robots) + 1):
            tree = self._sets(size, robots)
            if tree is not None:
                limit = {"robots": robots, "size": size, "tree": tree}
                self.cases.check_limits([limit])
                return limit
        return None

    def _sets(self, size, among=None):
        """A tree over sets of a size, robots in turn; ``None`` if some are worth less."""
        robots = list(range(self.n)) if among is None else among
        limited = ([{"limit": k}, "budget"] for k in range(len(self.cases.limits)))
        trees = (["worth"], ["copies"], ["budget"], *limited, self._every_set(size, robots, 0))
        return next((tree for tree in trees if self._is_closed_set(size, tree, robots)), None)

    def _every_set(self, size, robots, known):
        if known == size:
            return ["worth"]
        if len(robots) + known < size:
            return ["budget"]
        robot, *rest = robots
        return [{"sense": robot}, *self._every_set(size, rest, known + 1), *self._every_set(size, rest, known)]

    def _is_closed_set(self, size, tree, robots):
        try:
            self.cases.check_sets(size, tree, mask_of(robots))
        except ProofError:
            return False
        return True

    def _takes(self, node, case):
        known = {"worth": self.cases._close_worth, "copies": self.cases._close_copies}
        known |= {"budget": self.cases._close_beyond, **self.closing}
        name, number = (node, None) if isinstance(node, str) else next(iter(node.items()))
        try:
            known[name](case, number)
        except ProofError:
            return False
        return True

    def _close(self, case, tree):
        leaves = ["budget", "worth", "copies", *({"flow": k} for k in range(FLOWS + 1))]
        for leaf in (*leaves, *(["listed"] if "listed" in self.closing else [])):
            if self._takes(leaf, case):
                tree.append(leaf)
                return True
        if len(tree) > LARGEST:
            return False
        for name in self.rng.permutation(["limit", "inside", "inside", "sense", "sensing", "blinded"]):
            count = len(self.cases.limits) if name == "limit" else self.n + (name in ("sensing", "blinded"))
            numbers = self.rng.permutation(count)
            for number in map(int, numbers):
                try:
                    halves = list(self.cases.halves(str(name), number, case))
                except ProofError:
                    continue
                plain = [replace(half, known=case.known) == replace(case, known=case.known) for half in halves]
                if any(plain):  # it says nothing new
                    continue
                tree.append({str(name): number})
                return all(self._close(half, tree) for half in halves)
        return False

    def _partition(self):
        def below(left, spent):
            if not left:
                return None
            robot = (left & -left).bit_length() - 1
            tree = [robot]
            for group in self.duals.listed:
                after = [a + b for a, b in zip(spent, (group.cost, group.need, group.links), strict=True)]
                fits = group.robots >> robot & 1 and not group.robots & ~left
                if fits and all(a <= b for a, b in zip(after, budgets, strict=True)):
                    inner = below(left & ~group.robots, after)
                    if inner is None:
                        return None
                    tree += inner
            return tree

        budgets = self.duals.slack, self.cases.blinded, 2 * self.about.alpha_c
        return below(self.cases.everyone, [0, 0, 0])


def forgeries(seeds, tries, factor):
    """Forged proofs of claims that are ``factor`` times the worst case, as the verifier's check is asked about them."""
    for seed in seeds:
        problem, plan, worst = drawn(seed)
        if worst <= 1e-3:
            continue
        rng = np.random.default_rng([81, seed])
        for _ in range(tries):
            forger = Forger(problem, plan, worst * factor, rng)
            yield forger, forger.forged()


def accepted(forger, part):
    try:
        return part is not None and check(forger.about, part, forger.claim) > 0
    except ProofError:
        return False


def test_true_claims_are_forged_and_accepted():
    """What the forger thinks that it closed is accepted, but for conclusions of which it asked nothing before."""
    count = limited = 0
    for forger, part in forgeries(range(20), 6, 0.7):
        taken = accepted(forger, part)
        assert taken or part is None or part["conclusion"] == "forced"
        count += taken
        limited += taken and any("limit" in node for node in part.get("tree", []))
    assert count >= 30
    assert limited >= 5


@pytest.mark.parametrize("factor", [1 + 1e-6, 1.01, 1.2])
def test_false_claims_are_never_accepted(factor):
    for forger, part in forgeries(range(16), 6, factor):
        assert not accepted(forger, part)


@pytest.mark.slow
@pytest.mark.parametrize("factor", [1 + 1e-6, 1.001, 1.05])
def test_many_false_claims_are_never_accepted(factor):
    for forger, part in forgeries(range(100, 400), 30, factor):
        assert not accepted(forger, part)
