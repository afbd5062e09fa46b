"""Proofs of best plans, read by definition."""

from itertools import product

import numpy as np

from ratt_opt import (
    Attack,
    LogDetObjective,
    Problem,
    TraceObjective,
)
from ratt_opt.solvers.maxmin.proof import (
    CoverLeaf,
    ElementBranch,
    Leaf,
    MarginalLeaf,
    TargetLemma,
    UpperProof,
    WinnerBranch,
)
from tests.oracles import groups_left


def kept_bound(problem: Problem, cover) -> float:
    """What the elements that a cover keeps are worth in any group, from the tangents."""
    problem.check_attack(cover.attack)
    assert not cover.attack.sensing
    f, bounds = problem.objective, []
    groups = sorted(sorted(group) for group in groups_left(problem, cover.attack.links))
    for group, point in zip(groups, cover.points, strict=True):
        value, slope = tangent(f, point, None)
        bound = value + sum(np.vdot(slope[j], f.prior_information[j] - point[j]) for j in range(f.n_targets))
        for i in group:
            kept = [e for e in problem.choices[i].tolist() if e not in cover.left_out]
            scores = [sum(np.vdot(slope[j], f.information[e, j]) for j in range(f.n_targets)) for e in kept]
            bound += max([0.0, *scores])
        bounds.append(bound)
    return max(bounds)


def cover_leaf_bound(problem: Problem, proof: UpperProof, leaf: CoverLeaf, choices) -> float:
    """The largest bound of the leaf's covers; assert that no plan of it counts as much as all of them together ask."""
    can_be_blinded = problem.n_robots - len(problem.protected_robots)
    needed = min(problem.alpha_s, can_be_blinded) + 1
    assert min(leaf.weights) > 0
    most = 0.0
    for i, elements in enumerate(choices):
        count = needed if i in problem.protected_robots else 1
        left_out = [[e in proof.covers[k].left_out for k in leaf.covers] for e in elements]
        most += count * max(np.dot(leaf.weights, out) for out in left_out)
    assert most < needed * sum(leaf.weights)
    return max(kept_bound(problem, proof.covers[k]) for k in leaf.covers)


def marginal_leaf_bound(problem: Problem, attack: Attack, choices) -> float:
    """By the definition of the leaf: submodular, so what robots without a strongest element add is at most a sum."""
    assert isinstance(problem.objective, LogDetObjective)
    problem.check_attack(attack)
    information = problem.objective.information
    bounds = [0.0]
    for group in groups_left(problem, attack.links):
        fixed, free = [], []
        for i in sorted(group - attack.sensing):
            strongest = [
                e
                for e in choices[i]
                if all(np.linalg.eigvalsh(information[e] - information[o]).min() > -1e-9 for o in choices[i])
            ]
            (fixed if strongest else free).append(strongest[0] if strongest else choices[i])
        base = problem.objective(fixed)
        bounds.append(base + sum(max(problem.objective([*fixed, e]) - base for e in own) for own in free))
    return max(bounds)


def tangent(f, point, target):
    """Value and supergradient at one posterior information, from the definitions."""
    inverse = np.linalg.inv(point)
    if isinstance(f, TraceObjective):
        values = [target_value(f, j, point[j]) for j in range(f.n_targets)]
        shown = np.eye(point.shape[-1]) if f.output is None else np.swapaxes(f.output, -1, -2) @ f.output
        return sum(values), f.weights[:, None, None] * (inverse @ shown @ inverse)
    if isinstance(f, LogDetObjective):
        gains = [np.linalg.slogdet(L)[1] + np.linalg.slogdet(p)[1] for L, p in zip(point, f.prior, strict=True)]
        return f.weights @ gains, f.weights[:, None, None] * inverse
    values, vectors = np.linalg.eigh(inverse[target])
    slope = np.zeros_like(point)
    slope[target] = f.weights[target] * values[-1] ** 2 * np.outer(vectors[:, -1], vectors[:, -1])
    return max(f.weights * np.linalg.eigvalsh(f.prior)[:, -1]) - f.weights[target] * values[-1], slope


def target_value(f, target, point) -> float:
    """What one target's posterior information (d, d) is worth, from the definitions."""
    prior = f.prior[target]
    if isinstance(f, TraceObjective):
        C = np.eye(len(prior)) if f.output is None else f.output[target]
        return f.weights[target] * np.trace(C @ (prior - np.linalg.inv(point)) @ C.T)
    return f.weights[target] * (np.linalg.slogdet(point)[1] + np.linalg.slogdet(prior)[1])


def assert_holds_for_every_set(problem: Problem, lemma: TargetLemma) -> None:
    """Compare an inequality of one target with its value for every set of at most one element of each robot."""
    f, j = problem.objective, lemma.target
    seers = set(np.flatnonzero(f.information[:, j].any(axis=(-2, -1))).tolist())
    options = [[None, *(e for e in choice.tolist() if e in seers)] for choice in problem.choices]
    sets = [[e for e in chosen if e is not None] for chosen in product(*options)]
    for chosen in sets:
        value = target_value(f, j, f.posterior_information(np.array(chosen, dtype=np.int64))[j])
        assert lemma.constant + lemma.scores[chosen].sum() >= value


def proved_upper(problem: Problem, proof: UpperProof) -> float:
    """Walk the tree and bound every leaf from the matrices; assert that it covers all plans."""
    f = problem.objective

    def bound_at(cut, winners):
        attack = proof.attacks[cut.attack]
        problem.check_attack(attack)
        groups = {tuple(sorted(g - attack.sensing)) for g in groups_left(problem, attack.links)} - {()} or {()}
        assert cut.group in groups
        assert len(groups) == 1 or winners.get(cut.attack) == cut.group
        value, slope = tangent(f, cut.point, cut.target)
        slope = slope.copy()
        for lemma in cut.lemmas:
            assert_holds_for_every_set(problem, lemma)
        named = {lemma.target for lemma in cut.lemmas}
        assert len(named) == len(cut.lemmas)
        if named:
            value -= sum(target_value(f, j, cut.point[j]) for j in named)
            slope[sorted(named)] = 0.0
        constant = value + sum(np.vdot(slope[j], f.prior_information[j] - cut.point[j]) for j in range(f.n_targets))
        scores = np.array([sum(np.vdot(slope[j], f.information[e, j]) for j in range(f.n_targets)) for e in range(f.n)])
        constant += sum(lemma.constant for lemma in cut.lemmas)
        scores = scores + sum((lemma.scores for lemma in cut.lemmas), np.zeros(f.n))
        return constant, np.where(np.isin(problem.robot, cut.group), scores, 0.0)

    nodes = iter(proof.tree)

    def visit(choices, winners):
        node = next(nodes)
        if isinstance(node, Leaf):
            assert node.cuts
            assert min(node.weights) >= 0
            bounds = [bound_at(proof.cuts[k], winners) for k in node.cuts]
            share = np.array(node.weights) / sum(node.weights)
            total = share @ np.array([b[1] for b in bounds])
            return share @ np.array([b[0] for b in bounds]) + sum(max(total[e] for e in c) for c in choices)
        if isinstance(node, CoverLeaf):
            return cover_leaf_bound(problem, proof, node, choices)
        if isinstance(node, MarginalLeaf):
            return marginal_leaf_bound(problem, proof.attacks[node.attack], choices)
        if isinstance(node, ElementBranch):
            assert set().union(*node.parts) == set(choices[node.robot])
            assert sum(map(len, node.parts)) == len(choices[node.robot])
            before, after = choices[: node.robot], choices[node.robot + 1 :]
            return max([visit((*before, list(part), *after), winners) for part in node.parts])
        assert isinstance(node, WinnerBranch)
        attack = proof.attacks[node.attack]
        groups = {tuple(sorted(g - attack.sensing)) for g in groups_left(problem, attack.links)} - {()}
        assert sorted(groups) == list(node.parts)
        return max([visit(choices, {**winners, node.attack: group}) for group in node.parts])

    bound = visit(tuple(c.tolist() for c in problem.choices), {})
    assert next(nodes, None) is None
    return bound
