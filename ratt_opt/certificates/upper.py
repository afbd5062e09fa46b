"""The upper proof of a max-min search as a record: pooled Fenchel points, cuts, and the tree in preorder."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from ratt_opt.setfunctions.criteria.maxeig import MaxEigenvalueObjective
from ratt_opt.solvers.maxmin.proof import ElementBranch, Leaf, Node, UpperProof

if TYPE_CHECKING:
    from ratt_opt.problem import Attack, Problem
    from ratt_opt.solvers.maxmin.proof import Cut

__all__ = ["upper_record"]

DIGITS = 9
"""Digits kept of a Fenchel point: any point is valid, and the bound changes by the square of its error."""


def upper_record(problem: Problem, proof: UpperProof) -> dict[str, Any]:
    """Return the record; attacks, points and cuts that no leaf weighs are left out, and equal points pooled."""
    nodes = _preorder(proof.root)
    leaves = [node for node in nodes if isinstance(node, Leaf)]
    branched = {node.attack for node in nodes if not isinstance(node, (Leaf, ElementBranch))}
    used = sorted({k for leaf in leaves for k, w in zip(leaf.cuts, leaf.weights, strict=True) if w > 0})
    cut_number = {k: number for number, k in enumerate(used)}
    attacks = sorted(branched | {proof.cuts[k].attack for k in used})
    attack_number = {a: number for number, a in enumerate(attacks)}
    points: dict[tuple[Any, ...], int] = {}
    cuts = []
    groups = {a: _groups(problem, proof.attacks[a]) for a in attacks}
    for k in used:
        cut = proof.cuts[k]
        number = points.setdefault((cut.point.tobytes(), cut.target), len(points))
        cuts.append([attack_number[cut.attack], groups[cut.attack].index(tuple(sorted(cut.group))), number])
    first = {number: k for k, (_, _, number) in zip(reversed(used), reversed(cuts), strict=True)}
    return {
        "attacks": [
            {"robots": sorted(a.sensing), "links": [list(link) for link in sorted(a.links)]}
            for a in (proof.attacks[k] for k in attacks)
        ],
        "points": [_fenchel(problem, proof.cuts[first[number]]) for number in range(len(points))],
        "cuts": cuts,
        "tree": [_node(node, cut_number, attack_number, groups) for node in nodes],
    }


def _groups(problem: Problem, attack: Attack) -> list[tuple[int, ...]]:
    found = (tuple(sorted(group - attack.sensing)) for group in problem.communication.groups(attack.links))
    return sorted(group for group in found if group) or [()]


def _children(node: Node) -> list[Node]:
    if isinstance(node, Leaf):
        return []
    order = sorted(node.children, key=lambda child: sorted(child[0]))
    return [child for _, child in order]


def _preorder(root: Node) -> list[Node]:
    found, stack = [], [root]
    while stack:
        node = stack.pop()
        found.append(node)
        stack.extend(reversed(_children(node)))
    return found


def _node(node: Node, cut_number: dict[int, int], attack_number: dict[int, int], groups: dict[int, Any]) -> Any:
    if isinstance(node, Leaf):
        pairs = [(cut_number[k], float(w)) for k, w in zip(node.cuts, node.weights, strict=True) if w > 0]
        return {"cuts": [k for k, _ in pairs], "weights": [w for _, w in pairs]}
    if isinstance(node, ElementBranch):
        return {"robot": node.robot, "parts": sorted(sorted(map(int, members)) for members, _ in node.children)}
    assert sorted(tuple(sorted(members)) for members, _ in node.children) == groups[node.attack]
    return {"attack": attack_number[node.attack]}


def _fenchel(problem: Problem, cut: Cut) -> list[Any]:
    """Return the Fenchel point whose bound touches the criterion at the cut's posterior information."""
    if isinstance(problem.objective, MaxEigenvalueObjective):
        assert cut.target is not None
        eigenvalues, vectors = np.linalg.eigh(cut.point[cut.target])
        return [cut.target, _short(1 / eigenvalues[0]), [_short(x) for x in vectors[:, 0]]]
    inverse = np.linalg.inv(cut.point)
    rows, columns = np.tril_indices(inverse.shape[-1])
    return [[_short(x) for x in row] for row in ((inverse + np.swapaxes(inverse, -1, -2)) / 2)[:, rows, columns]]


def _short(value: float) -> float:
    return float(f"{value:.{DIGITS}g}")
