"""A second checker of trace certificates of tiny teams, written from docs/formats.md alone, without the library.

Where the verifier bounds the plans or groups of a leaf all at once, this one takes them one by one: each plan, and each
group that some attack leaves, walks down the proof's tree. What its leaf says is compared with the definition, in
rationals. Flows and forms, which prove costs of many groups at once, are not read: costs are computed. Run it as
``python independent_checker.py FILE``.
"""

import json
import sys
from fractions import Fraction
from itertools import chain, combinations, product
from pathlib import Path


class RefusedError(Exception):
    """The proof does not show its claim."""


def need(holds, fault):
    if not holds:
        raise RefusedError(fault)


class Team:
    def __init__(self, document):
        p = self.problem = document["problem"]
        need(p["objective"] == "trace" and "output" not in p, "this checker reads traces of whole states only")
        self.owners, self.n = p["owners"], max(p["owners"]) + 1
        self.prior = [self.square(x) for x in p["prior"]]
        self.start = [inverse(x) for x in self.prior]
        self.adds = [[self.square(x) for x in row] for row in p["information"]]
        self.weights = [Fraction(w) for w in p["weights"]]
        self.links = {tuple(link) for link in p["links"]}
        self.safe, self.safe_links = set(p["protected_robots"]), {tuple(link) for link in p["protected_links"]}
        self.alpha_s, self.alpha_c, self.plan = p["alpha_s"], p["alpha_c"], document["plan"]
        need([self.owners[e] for e in self.plan] == list(range(self.n)), "an element of the plan is not its robot's")

    def square(self, triangle):
        d, entries = self.problem["dimension"], iter(map(Fraction, triangle))
        rows = [[next(entries) for _ in range(i + 1)] for i in range(d)]
        return [[rows[max(i, j)][min(i, j)] for j in range(d)] for i in range(d)]

    def value(self, elements):
        """The criterion by its definition: what the elements remove of the targets' uncertainty."""
        after = [plus(start, *(self.adds[e][j] for e in elements)) for j, start in enumerate(self.start)]
        parts = zip(self.weights, self.prior, after, strict=True)
        return sum(w * (trace(prior) - trace(inverse(known))) for w, prior, known in parts)

    def worth(self, robots):
        return self.value([self.plan[i] for i in robots])

    def components(self, cut):
        left, found = set(range(self.n)), []
        while left:
            group, front = set(), [min(left)]
            while front:
                i = front.pop()
                group.add(i)
                front += [j for j in left - group if (min(i, j), max(i, j)) in self.links - cut]
            left -= group
            found.append(group)
        return found

    def real_groups(self):
        """Each group that some attack within the budgets leaves: robots, those blinded, links that leave it."""
        for robots in map(set, subsets(range(self.n), 1)):
            leaving = {link for link in self.links if len(robots & set(link)) == 1}
            alone = [group for group in self.components(leaving) if group & robots]
            if len(leaving) <= self.alpha_c and not leaving & self.safe_links and alone == [robots]:
                for blinded in subsets(robots - self.safe, 0, self.alpha_s):
                    yield robots, set(blinded), len(leaving)


def check(document):
    """Raise ``RefusedError`` unless both ends are shown; return how many plans and groups walked down the trees."""
    team, claim = Team(document), document["claim"]
    plans = Upper(team, document["upper"], Fraction(claim["upper"])).walked
    return plans, check_lower(team, document["lower"], Fraction(claim["lower"]))


class Upper:
    def __init__(self, team, proof, claim):
        self.team, self.proof, self.claim, self.walked, self.named = team, proof, claim, 0, {}
        self.groups = []
        for attack in proof["attacks"]:
            blinded, cut = set(attack["robots"]), {tuple(link) for link in attack["links"]}
            need(len(blinded) <= team.alpha_s and len(cut) <= team.alpha_c, "an attack exceeds its budget")
            need(cut <= team.links - team.safe_links and not blinded & team.safe, "an attack hits what is protected")
            left = [sorted(group - blinded) for group in team.components(cut) if group - blinded]
            self.groups.append(sorted(left) or [[]])
        nodes = iter(proof["tree"])
        choices = [[e for e, i in enumerate(team.owners) if i == robot] for robot in range(team.n)]
        self.walk(nodes, choices, {})
        need(next(nodes, None) is None, "a node follows the last leaf")

    def walk(self, nodes, left, winners):
        node = next(nodes, None)
        need(node is not None, "a case has no leaf")
        if "part" in node:
            need(node["part"] not in winners, "a best part is declared twice")
            for group in self.groups[node["part"]]:
                self.walk(nodes, left, {**winners, node["part"]: group})
        elif "element" in node:
            robot = node["element"]
            parts = self.named[robot] = node.get("parts", self.named.get(robot, []))
            rest = sorted(set(left[robot]) - set(chain(*parts)))
            parts = [*parts, rest] if rest and "covers" in self.proof else parts
            need(sorted(chain(*parts)) == sorted(left[robot]), "the parts are not those of the elements left")
            for part in parts:
                self.walk(nodes, [*left[:robot], part, *left[robot + 1 :]], winners)
        else:
            for plan in product(*left):
                self.walked += 1
                need(self.bound(node, plan, winners) <= self.claim, "a leaf's bound is above the claim")

    def bound(self, node, plan, winners):
        team = self.team
        weights = [Fraction(w) for w in node["weights"]]
        if "covers" in node:
            covers = [self.proof["covers"][k] for k in node["covers"]]
            of = [team.alpha_s + 1 if i in team.safe else 1 for i in range(team.n)]
            counts = [sum(of[i] for i in range(team.n) if plan[i] in cover["left_out"]) for cover in covers]
            failed = [cover for cover, count in zip(covers, counts, strict=True) if count <= team.alpha_s]
            need(failed and min(weights) > 0, "a plan meets all covers of its leaf")
            groups, out = self.groups[failed[0]["attack"]], set(failed[0]["left_out"])
            return max(team.value([plan[i] for i in group if plan[i] not in out]) for group in groups)
        total = Fraction(0)
        cuts = (self.proof["cuts"][k] for k in node["fenchel"])
        for weight, (attack, number, point) in zip(weights, cuts, strict=True):
            group = self.groups[attack][number]
            need(len(self.groups[attack]) == 1 or winners.get(attack) == group, "a group is not known to be the best")
            tangent = self.tangent(self.proof["points"][point], [plan[i] for i in group])
            need(team.value([plan[i] for i in group]) <= tangent, "a tangent is below the value")
            total += weight * tangent
        need(sum(weights) > 0 and min(weights) >= 0, "weights are negative or all zero")
        return total / sum(weights)

    def tangent(self, point, elements):
        """Return what a point says: tr(inverse of L) >= 2 tr(Y) - tr(Y L Y) for the symmetric Y of each target."""
        team, total = self.team, Fraction(0)
        for j, y in enumerate(map(team.square, point)):
            known = plus(team.start[j], *(team.adds[e][j] for e in elements))
            total += team.weights[j] * (trace(team.prior[j]) - 2 * trace(y) + trace(times(y, times(known, y))))
        return total


def check_lower(team, proof, claim):
    need(proof["conclusion"] != "enumerated", "the lower end is not proved")
    for lemma in [*proof.get("limits", []), {"robots": range(team.n), **proof["sets"]}]:
        tree = tree_of(lemma["tree"])
        for robots in combinations(lemma["robots"], lemma["size"]):
            need(team.worth(robots) >= claim, "robots of a lemma are not worth the claim")
            leaf = walk_group(tree, set(robots), set())
            need(leaf in ("worth", "copies", "budget"), "a lemma ends in a leaf for groups")
    if proof["conclusion"] in ("forced", "sizes"):  # tiny teams: all attacks
        return check_all(team, claim, proof["sets"]["size"] if proof["conclusion"] == "forced" else None)
    duals, listed, tree = proof["duals"], [], tree_of(proof["tree"])
    n_blinded = min(team.alpha_s, team.n - len(team.safe))
    room = 2 * duals["link"] * team.alpha_c + duals["blinded"] * n_blinded - sum(duals["robots"])
    need((room < 0) == (proof["conclusion"] == "duals"), "what the prices leave is not as the conclusion says")
    for robots, blinded, leaving in team.real_groups():
        if team.worth(sorted(robots - blinded)) >= claim:
            continue
        leaf = walk_group(tree, robots - blinded, blinded)
        cost = duals["link"] * leaving + duals["blinded"] * len(blinded) - sum(duals["robots"][i] for i in robots)
        closes = leaf == "listed" or (leaf == "flow" and cost > room)
        need(cost >= 0 and closes, f"a group below the claim ends at {leaf}")
        listed.append((robots, cost, len(blinded), leaving))
    budgets = (room, n_blinded, 2 * team.alpha_c)
    need(room < 0 or not partition(listed, set(range(team.n)), budgets), "listed groups partition the team")
    return len(listed)


def check_all(team, claim, size):
    def partitions(robots):
        yield from [[]] if not robots else ()
        for others in subsets(robots[1:], 0) if robots else ():
            group = {robots[0], *others}
            yield from ([group, *rest] for rest in partitions([i for i in robots if i not in group]))

    walked = 0
    for groups in partitions(list(range(team.n))):
        cut = {link for link in team.links if not any(set(link) <= group for group in groups)}
        if len(cut) <= team.alpha_c and not cut & team.safe_links:
            for blinded in map(set, subsets(set(range(team.n)) - team.safe, 0, team.alpha_s)):
                walked += 1
                need(
                    any(team.worth(sorted(g - blinded)) >= claim for g in groups),
                    "an attack leaves less than the claim",
                )
                need(size is None or any(len(g - blinded) >= size for g in groups), "an attack leaves smaller groups")
    return walked


def partition(listed, left, room):
    """Whether listed groups partition the robots left within what is left of cost, blinded robots and links."""
    for robots, *costs in listed:
        rest = [b - a for a, b in zip(costs, room, strict=True)]
        if (
            left
            and min(left) in robots
            and robots <= left
            and min(rest) >= 0
            and partition(listed, left - robots, rest)
        ):
            return True
    return not left


def tree_of(nodes):
    """Turn preorder into (node, children)."""
    waiting = iter(nodes)

    def grow():
        node = next(waiting, None)
        need(node is not None, "a case has no leaf")
        name = node if isinstance(node, str) else next(iter(node))
        below = {"sense": 2, "inside": 2, "sensing": 2, "blinded": 2, "limit": 1}
        return node, [grow() for _ in range(below.get(name, 0))]

    tree = grow()
    need(next(waiting, None) is None, "a node follows the last leaf")
    return tree


def walk_group(tree, sensing, blinded):
    node, children = tree
    if not children:
        return node if isinstance(node, str) else next(iter(node))
    ((name, number),) = node.items()
    is_first = {
        "sense": number in sensing, "inside": number in sensing | blinded, "sensing": len(sensing) >= number,
        "blinded": len(blinded) < number, "limit": True,
    }[name]  # fmt: skip
    return walk_group(children[0 if is_first else 1], sensing, blinded)


def subsets(items, low, high=None):
    most = len(items) if high is None else min(high, len(items))
    return chain.from_iterable(combinations(sorted(items), k) for k in range(low, most + 1))


def plus(*matrices):
    return [[sum(entries) for entries in zip(*rows, strict=True)] for rows in zip(*matrices, strict=True)]


def times(a, b):
    return [[sum(x * y for x, y in zip(row, column, strict=True)) for column in zip(*b, strict=True)] for row in a]


def trace(a):
    return sum(a[i][i] for i in range(len(a)))


def inverse(a):
    """Gauss and Jordan; the matrices are positive definite, so no pivot is zero."""
    n = len(a)
    rows = [[*row, *(Fraction(int(i == j)) for j in range(n))] for i, row in enumerate(a)]
    for k in range(n):
        rows[k] = [x / rows[k][k] for x in rows[k]]
        for i in set(range(n)) - {k}:
            rows[i] = [x - rows[i][k] * y for x, y in zip(rows[i], rows[k], strict=True)]
    return [row[n:] for row in rows]


if __name__ == "__main__":
    walked = check(json.loads(Path(sys.argv[1]).read_text(encoding="utf-8")))
    print("both ends are shown: {} plans and {} groups or attacks walked down the trees".format(*walked))
