"""A second checker of trace certificates of tiny teams, written from docs/formats.md alone, without the library.

It enumerates what the verifier bounds: each plan walks down the upper end's tree to a leaf, and each group that an
attack leaves walks down the lower end's. What the leaf says is compared with the definition, in rationals. Flows and
forms, which prove costs of many groups at once, are not read: costs are computed. Run it with the file's name.
"""

import json
import sys
from fractions import Fraction
from functools import cache
from itertools import chain, combinations, product
from pathlib import Path

import networkx as nx
import numpy as np


class RefusedError(Exception):
    """The proof does not show its claim."""


def need(holds, fault):
    if not holds:
        raise RefusedError(fault)


class Team:
    def __init__(self, document):
        p, self.plan = document["problem"], document["plan"]
        need(p["objective"] == "trace" and "output" not in p, "this checker reads traces of whole states only")
        need("at_most" not in p and "rows" not in document["upper"], "this checker reads neither rows nor idle robots")
        self.dimension, self.owners, self.n = p["dimension"], p["owners"], max(p["owners"]) + 1
        need([self.owners[e] for e in self.plan] == list(range(self.n)), "an element of the plan is not its robot's")
        priors = map(self.square, p["prior"])
        self.targets = [(Fraction(w), x, inverse(x)) for w, x in zip(p["weights"], priors, strict=True)]
        self.adds = [list(map(self.square, row)) for row in p["information"]]
        self.alpha_s, self.alpha_c, self.links = p["alpha_s"], p["alpha_c"], set(map(tuple, p["links"]))
        need(all(0 <= i < j < self.n for i, j in self.links), "a link does not join two robots, in order")
        self.cuttable = self.links - set(map(tuple, p["protected_links"]))
        self.blindable = set(range(self.n)) - set(p["protected_robots"])

    def square(self, triangle):
        full, below = np.full((self.dimension, self.dimension), Fraction(0)), np.tril_indices(self.dimension)
        full[below] = full.T[below] = list(map(Fraction, triangle))
        return full

    def value(self, elements, point=None):
        """Trace by its definition, or above it: tr(inverse of L) >= 2 tr Y - tr(Y L Y), equal if Y is the inverse."""
        total = Fraction(0)
        for j, (weight, prior, start) in enumerate(self.targets):
            known = start + sum(self.adds[e][j] for e in elements)
            y = inverse(known) if point is None else point[j]
            total += weight * np.trace(prior - 2 * y + y @ known @ y)
        return total

    def groups(self, cut):
        graph = nx.Graph(self.links - set(cut))
        graph.add_nodes_from(range(self.n))
        return frozenset(map(frozenset, nx.connected_components(graph)))


def inverse(a):
    """Gauss and Jordan; the matrices are positive definite, so no pivot is zero."""
    rows = np.hstack([a, np.eye(len(a), dtype=int).astype(object)])
    for k in range(len(a)):
        rows[k] /= rows[k, k]
        for other in set(range(len(a))) - {k}:
            rows[other] -= rows[other, k] * rows[k]
    return rows[:, len(a) :]


def subsets(items, most):
    return chain.from_iterable(combinations(items, k) for k in range(most + 1))


def check(document):
    """Raise ``RefusedError`` unless both ends are shown; return how many plans and groups walked down the trees."""
    team, claim = Team(document), document["claim"]
    plans = Upper(team, document["upper"], Fraction(claim["upper"])).walked
    return len(plans), check_lower(team, document["lower"], Fraction(claim["lower"]))


class Upper:
    def __init__(self, team, proof, claim):
        self.team, self.proof, self.claim, self.walked, self.named, self.parts = team, proof, claim, set(), {}, []
        self.points = [list(map(team.square, point)) for point in proof["points"]]
        for attack in proof["attacks"]:
            blinded, cut = set(attack["robots"]), set(map(tuple, attack["links"]))
            need(len(blinded) <= team.alpha_s and len(cut) <= team.alpha_c, "an attack exceeds its budget")
            need(cut <= team.cuttable and blinded <= team.blindable, "an attack hits what is protected")
            self.parts.append(sorted(sorted(g - blinded) for g in team.groups(cut) if g - blinded) or [[]])
        nodes = iter(proof["tree"])
        self.walk(nodes, [[e for e, i in enumerate(team.owners) if i == robot] for robot in range(team.n)], {})
        need(next(nodes, None) is None, "a node follows the last leaf")

    def walk(self, nodes, left, best):
        node = next(nodes, {})
        if "part" in node:
            need(node["part"] not in best, "a best part is declared twice")
            for group in self.parts[node["part"]]:
                self.walk(nodes, left, {**best, node["part"]: group})
        elif "element" in node:
            robot = node["element"]
            parts = self.named[robot] = node.get("parts", self.named.get(robot, []))
            rest = sorted(set(left[robot]) - set(chain(*parts)))
            parts = [*parts, rest] if rest and "covers" in self.proof else parts
            need(sorted(chain(*parts)) == sorted(left[robot]), "the parts are not those of the elements left")
            for part in parts:
                self.walk(nodes, [*left[:robot], part, *left[robot + 1 :]], best)
        else:
            need("covers" in node or "fenchel" in node, "a case has no leaf that this checker reads")
            for plan in product(*left):
                self.walked.add(plan)  # a plan comes once for each part that may be its best
                bound = self.cover(node, plan) if "covers" in node else self.average(node, plan, best)
                need(bound <= self.claim, "a leaf's bound is above the claim")

    def cover(self, node, plan):
        """Return what is left if robots of the first cover that the plan fails are blinded."""
        for cover in (self.proof["covers"][k] for k in node["covers"]):
            need(not self.proof["attacks"][cover["attack"]]["robots"], "the attack of a cover blinds robots")
            out = {i for i, e in enumerate(plan) if e in cover["left_out"]}
            if len(out) <= self.team.alpha_s and out <= self.team.blindable:
                return max(self.team.value([plan[i] for i in g if i not in out]) for g in self.parts[cover["attack"]])
        raise RefusedError("a plan meets all covers of its leaf")

    def average(self, node, plan, best):
        weights, total = list(map(Fraction, node["weights"])), Fraction(0)
        need(min(weights) >= 0 and sum(weights) > 0, "weights are negative or all zero")
        for weight, k in zip(weights, node["fenchel"], strict=True):
            attack, number, point = self.proof["cuts"][k]
            group = self.parts[attack][number]
            need(len(self.parts[attack]) == 1 or best.get(attack) == group, "a group is not known to be the best")
            value, tangent = (self.team.value([plan[i] for i in group], at) for at in (None, self.points[point]))
            need(value <= tangent, "a tangent is below the value")
            total += weight * tangent
        return total / sum(weights)


def check_lower(team, proof, claim):
    need(proof["conclusion"] != "enumerated", "the lower end is not proved")
    worth = cache(lambda robots: team.value([team.plan[i] for i in sorted(robots)]))
    for lemma in [*proof.get("limits", []), {"robots": range(team.n), **proof["sets"]}]:
        values = map(worth, combinations(lemma["robots"], lemma["size"]))
        need(min(values, default=claim) >= claim, "robots of a lemma are not worth the claim")
    below, splits = set(), {team.groups(cut) for cut in subsets(team.cuttable, team.alpha_c)}
    for split, blinded in product(splits, map(frozenset, subsets(team.blindable, team.alpha_s))):
        low = {(g, blinded & g) for g in split if worth(g - blinded) < claim}
        need(low < {(g, blinded & g) for g in split}, "an attack leaves less than the claim")
        is_forced = max(len(g - blinded) for g in split) >= proof["sets"]["size"]
        need(is_forced or proof["conclusion"] != "forced", "an attack leaves smaller groups")
        below |= low
    return len(below) if proof["conclusion"] not in ("duals", "cover") else check_costs(team, proof, below)


def check_costs(team, proof, below):
    """Let the groups worth less, each with the robots blinded in it, walk down the tree, and pay at its leaves."""
    duals, nodes = proof["duals"], iter(proof["tree"])
    slack = 2 * duals["link"] * team.alpha_c + duals["blinded"] * min(team.alpha_s, len(team.blindable))
    slack -= sum(duals["robots"])
    need((slack < 0) == (proof["conclusion"] == "duals"), "the slack is not as the conclusion says")

    def walk(groups):
        node = next(nodes, "missing")
        name, number = (node, None) if isinstance(node, str) else next(iter(node.items()))
        if name in ("inside", "sense", "sensing", "blinded"):
            first = {one for one in groups if is_first(name, number, *one)}
            walk(first)
            walk(groups - first)
        elif name == "limit":
            walk(groups)
        else:
            need(name != "missing", "a case has no leaf")
            for g, blinded in groups:
                leaving = sum(len(g & set(link)) == 1 for link in team.links)
                cost = duals["link"] * leaving + duals["blinded"] * len(blinded) - sum(duals["robots"][i] for i in g)
                is_closed = name == "listed" or (name == "flow" and cost > slack)
                need(cost >= 0 and is_closed, f"a group below the claim ends at {name}")

    walk(below)
    need(next(nodes, None) is None, "a node follows the last leaf")
    return len(below)


def is_first(name, number, group, blinded):
    if name in ("inside", "sense"):
        return number in (group if name == "inside" else group - blinded)
    return len(group - blinded) >= number if name == "sensing" else len(blinded) < number


if __name__ == "__main__":
    walked = check(json.loads(Path(sys.argv[1]).read_text(encoding="utf-8")))
    print("both ends are shown: {} plans and {} groups or attacks walked down the trees".format(*walked))
