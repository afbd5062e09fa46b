"""The upper proof of a max-min search as a record: pooled Fenchel points, cuts, and the tree in preorder."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from ratt_opt.solvers.maxmin.proof import ElementBranch, Leaf, UpperProof, WinnerBranch

if TYPE_CHECKING:
    from ratt_opt.problem import Attack, Problem
    from ratt_opt.solvers.maxmin.proof import Node

__all__ = ["upper_record"]

DIGITS = 9
"""Digits kept of a Fenchel point: any point is valid, and the bound changes by the square of its error."""
LARGEST_CONDITION = 1e6
"""Of the matrices whose points are shortened: beyond it so few digits could leave one that is not positive definite."""


def upper_record(problem: Problem, proof: UpperProof) -> dict[str, Any]:
    """Return the record; attacks, points and cuts that no leaf weighs are left out, and equal points pooled.

    Raises
    ------
    InputError : the objective is no information criterion, or one whose tangents the verifier does not know.
    """
    objective = problem.information_objective
    used = sorted({k for node in proof.tree if isinstance(node, Leaf) for k, _ in _weighed(node)})
    branched = {node.attack for node in proof.tree if isinstance(node, WinnerBranch)}
    attacks = sorted(branched | {proof.cuts[k].attack for k in used})
    groups = {a: _groups(problem, proof.attacks[a]) for a in attacks}
    cut_number = {k: number for number, k in enumerate(used)}
    attack_number = {a: number for number, a in enumerate(attacks)}
    points: dict[tuple[bytes, int | None], tuple[int, Any]] = {}
    cuts = []
    for k in used:
        cut = proof.cuts[k]
        if (key := (cut.point.tobytes(), cut.target)) not in points:
            point = objective.fenchel_point(cut.point, cut.target)
            kept = point if np.linalg.cond(cut.point).max() > LARGEST_CONDITION else _short(point)
            points[key] = len(points), kept
        cuts.append([attack_number[cut.attack], groups[cut.attack].index(tuple(sorted(cut.group))), points[key][0]])
    return {
        "attacks": [
            {"robots": sorted(a.sensing), "links": [list(link) for link in sorted(a.links)]}
            for a in (proof.attacks[k] for k in attacks)
        ],
        "points": [point for _, point in points.values()],
        "cuts": cuts,
        "tree": [_node(node, cut_number, attack_number, groups) for node in proof.tree],
    }


def _weighed(leaf: Leaf) -> list[tuple[int, float]]:
    """The cuts of a leaf that count, and their weights."""
    return [(k, float(w)) for k, w in zip(leaf.cuts, leaf.weights, strict=True) if w > 0]


def _groups(problem: Problem, attack: Attack) -> list[tuple[int, ...]]:
    """Groups that an attack leaves, ascending."""
    return sorted(tuple(sorted(group)) for group in problem.groups_left(attack) if group) or [()]


def _node(node: Node, cut_number: dict[int, int], attack_number: dict[int, int], groups: dict[int, Any]) -> Any:
    if isinstance(node, Leaf):
        pairs = _weighed(node)
        return {"cuts": [cut_number[k] for k, _ in pairs], "weights": [w for _, w in pairs]}
    if isinstance(node, ElementBranch):
        return {"robot": node.robot, "parts": [list(part) for part in node.parts]}
    assert list(node.parts) == groups[node.attack]
    return {"attack": attack_number[node.attack]}


def _short(value: Any) -> Any:
    """The same nested lists with fewer digits."""
    if isinstance(value, list):
        return [_short(item) for item in value]
    return value if isinstance(value, int) else float(f"{value:.{DIGITS}g}")
