"""What nodes of lower proofs claim, by definition: every group of an attack, in every case that is drawn.

A case is drawn with branches; it holds for the groups, with who is blinded in each, that agree with every answer. Of
what the verifier accepts at its leaf, the definition must say the same of each of these groups.
"""

from itertools import combinations

import networkx as nx
import numpy as np
import pytest
from flint import fmpq

from ratt_opt import FileFormatError, Problem, ProofError, TraceObjective
from ratt_opt.certificates.verifier.cases import Cases, robots_of
from ratt_opt.certificates.verifier.duals import Duals, check_partition
from ratt_opt.certificates.verifier.worth import Worth
from tests.certificates.engine import statement
from tests.strategies import information_data

BRANCHES = ("sense", "inside", "inside", "sensing", "blinded")


def subsets(robots):
    robots = list(robots)
    for size in range(len(robots) + 1):
        yield from map(frozenset, combinations(robots, size))


class Drawn:
    """A small team, all groups that an attack may leave of it, and a drawn case."""

    def __init__(self, seed):
        rng = self.rng = np.random.default_rng([71, seed])
        n = self.n = int(rng.integers(3, 7))
        prior, information = information_data(rng, n, 1)
        graph = nx.gnp_random_graph(n, 0.6, seed=seed)
        links = sorted(graph.edges)
        safe_links = {links[0]} if links and seed % 4 == 1 else set()
        safe = {int(rng.integers(n))} if seed % 4 == 2 else set()
        budgets = int(rng.integers(0, n)), min(int(rng.integers(0, 6)), len(links))
        self.problem = Problem(TraceObjective(prior, information), range(n), graph, *budgets, safe, safe_links)
        self.threat, self.about = self.problem.threat, statement(self.problem, range(n))
        self.claim = float(rng.uniform(0, 1) * self.problem.objective(range(n)))
        self.cases = Cases(self.about, Worth(self.about, fmpq(*self.claim.as_integer_ratio())))
        self.groups = [
            (group, blinded)
            for group in subsets(range(n))
            if group and nx.is_connected(graph.subgraph(group)) and self.may_be_left(group)
            for blinded in subsets(group - safe)
            if len(blinded) <= self.threat.n_blinded
        ]

    def may_be_left(self, group):
        leaving = [link for link in self.threat.graph.links if len(group & set(link)) == 1]
        return len(leaving) <= self.threat.alpha_c and not self.threat.protected_links & set(leaving)

    def links_of(self, group):
        return sum(len(group & set(link)) == 1 for link in self.threat.graph.links)

    def draw_limit(self):
        """Some robots, and the most of these that are worth less than the claim, by definition."""
        robots = [i for i in range(self.n) if self.rng.uniform() < 0.7]
        below = [len(some) for some in subsets(robots) if self.problem.objective(sorted(some)) < self.claim]
        self.cases.limits.append((sum(1 << i for i in robots), max(below, default=-1)))

    def descend(self, case, groups, steps, names=BRANCHES):
        """Answer some branches at random: the case, and the groups that agree."""
        for _ in range(steps):
            name = str(self.rng.choice(names))
            number = int(self.rng.integers(self.n if name in ("sense", "inside") else self.n + 1))
            if name == "limit":
                number = int(self.rng.integers(len(self.cases.limits)))
            try:
                halves = list(self.cases.halves(name, number, case))
            except ProofError:  # it is decided already
                continue
            if name == "limit":
                (case,) = halves
                continue
            answer = int(self.rng.integers(2))
            agreeing = {
                "sense": lambda g, b, i: i in g - b,
                "inside": lambda g, _, i: i in g,
                "sensing": lambda g, b, k: len(g - b) >= k,
                "blinded": lambda _, b, k: len(b) < k,
            }[name]
            both = [[pair for pair in groups if agreeing(*pair, number) == truth] for truth in (True, False)]
            assert sum(map(len, both)) == len(groups)
            case, groups = halves[answer], both[answer]
        return case, groups

    def accepts(self, name, case, number=None, close=None):
        try:
            self.cases.check([name if number is None else {name: number}], case, close)
        except ProofError:
            return False
        return True


def value(drawn, group, blinded):
    return drawn.problem.objective(sorted(group - blinded))


@pytest.mark.parametrize("part", range(6))
def test_leaves_by_definition(part):
    accepted = dict.fromkeys(("worth", "copies", "budget", "flow"), 0)
    for draw in range(600):
        if draw % 60 == 0:
            drawn = Drawn(10 * part + draw // 60)
        most = int(drawn.rng.integers(0, drawn.n + 1))
        groups = [(g, b) for g, b in drawn.groups if len(g - b) <= most]
        case, groups = drawn.descend(drawn.cases.groups(most), groups, int(drawn.rng.integers(0, 9)))
        for name in ("worth", "copies"):
            if drawn.accepts(name, case):
                assert all(value(drawn, *pair) >= drawn.claim * (1 - 1e-9) for pair in groups)
                accepted[name] += 1
        if drawn.accepts("budget", case):
            assert not groups
            accepted["budget"] += 1
        duals = random_duals(drawn)
        limit = max(duals.slack, -1)
        if drawn.accepts("flow", case, 0, {"flow": duals.close_by_flow}):
            assert all(cost(drawn, duals, *pair) > limit for pair in groups)
            accepted["flow"] += 1
        assert_listed(drawn, duals, case, groups)
    assert min(accepted.values()) > 0


@pytest.mark.parametrize("part", range(4))
def test_limits_by_definition(part):
    """Groups that are worth less than the claim stay in a case that limits narrow."""
    accepted = dict.fromkeys(("worth", "copies", "budget", "flow"), 0)
    narrower = 0
    for draw in range(600):
        if draw % 60 == 0:
            drawn = Drawn(500 + 10 * part + draw // 60)
            for _ in range(3):
                drawn.draw_limit()
            below = [pair for pair in drawn.groups if value(drawn, *pair) < drawn.claim * (1 - 1e-9)]
        names = (*BRANCHES, "limit", "limit")
        case, groups = drawn.descend(drawn.cases.groups(drawn.n), below, int(drawn.rng.integers(0, 9)), names)
        narrower += case.most < drawn.n and case.low > 0
        for group, blinded in groups:
            assert case.least <= len(group - blinded) <= case.most
            assert case.low <= len(blinded) <= case.high
        duals = random_duals(drawn)
        for name in ("worth", "copies", "budget"):
            if drawn.accepts(name, case):
                assert not groups
                accepted[name] += 1
        if drawn.accepts("flow", case, 0, {"flow": duals.close_by_flow}):
            assert all(cost(drawn, duals, *pair) > max(duals.slack, -1) for pair in groups)
            accepted["flow"] += 1
        assert_listed(drawn, duals, case, groups)
    assert narrower > 0
    assert min(accepted.values()) > 0


def random_duals(drawn):
    rng, links = drawn.rng, len(drawn.about.links)
    link = int(rng.integers(0, 9))
    robots = rng.integers(-12, 12, drawn.n).tolist()
    duals = Duals(drawn.cases, {"link": link, "robots": robots, "blinded": int(rng.integers(0, 9))})
    cut = int(rng.integers(0, 3))
    flow = rng.integers(-(link + cut), link + cut + 1, links).tolist()
    duals.read_bounds([{"blinding": int(rng.integers(0, 5)), "cut": cut, "flow": flow}])
    return duals


def cost(drawn, duals, group, blinded):
    return duals.link * drawn.links_of(group) + duals.blinded * len(blinded) - sum(duals.robot[i] for i in group)


def assert_listed(drawn, duals, case, groups):
    """A case of one group is listed as cheap as it can be, or forgotten if no attack leaves it so cheap."""
    try:
        duals.list_group(case, None)
    except ProofError:
        return
    inside = frozenset(robots_of(case.inside))
    assert all(group == inside for group, _ in groups)
    listed = {frozenset(robots_of(group.robots)): group for group in duals.listed}
    for group, blinded in groups:
        if cost(drawn, duals, group, blinded) <= duals.slack:
            assert listed[group].cost <= cost(drawn, duals, group, blinded)
            assert listed[group].need <= len(blinded)
            assert listed[group].links == drawn.links_of(group)


def random_tree(drawn, decided, known, size):
    """A tree over sets that ends in what is true by chance."""
    left = [i for i in range(drawn.n) if i not in decided]
    if drawn.cases.limits and drawn.rng.uniform() < 0.2:
        limit = int(drawn.rng.integers(len(drawn.cases.limits)))
        return [{"limit": limit}, *random_tree(drawn, decided, known, size)]
    if not left or drawn.rng.uniform() < 0.3:
        return [str(drawn.rng.choice(["worth", "copies", "budget"]))]
    robot = int(drawn.rng.choice(left))
    halves = [random_tree(drawn, {*decided, robot}, known + more, size) for more in (1, 0)]
    return [{"sense": robot}, *halves[0], *halves[1]]


@pytest.mark.parametrize("part", range(4))
def test_sets_of_a_size_by_definition(part):
    accepted = 0
    for draw in range(6000):
        if draw % 300 == 0:
            drawn = Drawn(20 * part + draw // 300)
        size = int(drawn.rng.integers(0, drawn.n + 1))
        among = [i for i in range(drawn.n) if draw % 2 or drawn.rng.uniform() < 0.7]
        others = set(range(drawn.n)) - set(among) if draw % 4 else set()
        tree = random_tree(drawn, others, 0, size)
        try:
            if draw % 2:
                drawn.cases.check_sets(size, tree)
            else:
                drawn.cases.check_limits([{"robots": among, "size": size, "tree": tree}])
        except (ProofError, FileFormatError):
            continue
        accepted += 1
        assert draw % 2 or drawn.cases.limits[-1] == (sum(1 << i for i in among), size - 1)
        sets = combinations(among, size)
        assert all(drawn.problem.objective(robots) >= drawn.claim * (1 - 1e-9) for robots in sets)
    assert accepted >= 100
    for node in ("inside", "sensing", "blinded", "flow"):
        with pytest.raises(ProofError, match="none of this proof"):
            drawn.cases.check_sets(1, [{node: 0}])


@pytest.mark.parametrize("seed", range(60))
def test_partitions_by_definition(seed):
    """The tree that tries every robot's groups is accepted if and only if no listed groups partition the team."""
    drawn = Drawn(seed)
    duals = Duals(drawn.cases, {"link": 1, "robots": [0] * drawn.n, "blinded": 1})
    for group, blinded in drawn.groups:
        if drawn.rng.uniform() < 0.5:
            mask = sum(1 << i for i in group)
            outside = drawn.cases.everyone & ~mask
            case = drawn.cases.groups(drawn.n, blinded=None)
            for i in robots_of(mask):
                case = next(iter(drawn.cases.halves("inside", i, case)))
            for i in robots_of(outside):
                case = list(drawn.cases.halves("inside", i, case))[1]
            if blinded:
                case = list(drawn.cases.halves("blinded", len(blinded), case))[1]
            duals.list_group(case, None)
    listed = duals.listed
    budgets = duals.slack, drawn.threat.n_blinded, 2 * drawn.threat.alpha_c

    def partition(left, spent):
        """Whether groups partition those left; and the tree that shows that none do."""
        if not left:
            return True, []
        robot = (left & -left).bit_length() - 1
        tree, found = [robot], False
        for group in listed:
            after = tuple(a + b for a, b in zip(spent, (group.cost, group.need, group.links), strict=True))
            fits = group.robots >> robot & 1 and not group.robots & ~left
            if fits and all(a <= b for a, b in zip(after, budgets, strict=True)):
                inner, below = partition(left & ~group.robots, after)
                found, tree = found or inner, tree + below
        return found, tree

    exists, tree = partition(drawn.cases.everyone, (0, 0, 0))
    if exists:
        with pytest.raises(ProofError, match="partition the team"):
            check_partition(duals, tree)
    else:
        check_partition(duals, tree)
        for broken in (tree[:-1], [*tree, 0]):
            with pytest.raises(ProofError):
                check_partition(duals, broken)
