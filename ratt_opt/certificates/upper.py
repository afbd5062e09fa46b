"""The upper proof of a max-min search as a record: pooled Fenchel points, cuts, and the tree in preorder."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from ratt_opt.certificates.params import DEFAULT
from ratt_opt.certificates.stated_inequalities import StatedInequalities, shortened
from ratt_opt.solvers.maxmin.proof import CoverLeaf, ElementBranch, Leaf, MarginalLeaf, UpperProof

if TYPE_CHECKING:
    from ratt_opt._validation import FloatArray
    from ratt_opt.certificates.params import CertificateParams, PointParams
    from ratt_opt.problem import Attack, Problem
    from ratt_opt.solvers.maxmin.proof import Cover, Node, TangentCut

__all__ = ["upper_record"]


def upper_record(
    problem: Problem, proof: UpperProof, upper: float = np.inf, params: CertificateParams = DEFAULT
) -> dict[str, Any]:
    """Return the record; attacks, points, cuts and covers that no leaf weighs are left out, and equal ones pooled.

    ``upper`` : the end that the proof shows, if it relies on the spacing of values
    ``params`` : digits of points, and trees of single targets

    Raises
    ------
    InputError : the objective is no information criterion, or one whose tangents the verifier does not know.
    """
    used = sorted({k for node in proof.tree if isinstance(node, Leaf) for k, _ in _weighed(node.cuts, node.weights)})
    covers = sorted(
        {k for node in proof.tree if isinstance(node, CoverLeaf) for k, _ in _weighed(node.covers, node.weights)}
    )
    pool, inequalities = _StatedParts(problem, params.points), StatedInequalities(problem, params)
    used.sort(key=lambda k: (proof.cuts[k].by_target, k))  # rows are counted behind cuts
    writer = _Nodes(
        pool,
        proof,
        cuts={k: number for number, k in enumerate(used)},
        covers={k: number for number, k in enumerate(covers)},
    )
    tree = [writer.node(node) for node in proof.tree]
    cuts = [pool.cut(proof.attacks[proof.cuts[k].attack], proof.cuts[k]) for k in used if not proof.cuts[k].by_target]
    for k in used:
        if proof.cuts[k].by_target:
            inequalities.add(pool.place(proof.attacks[proof.cuts[k].attack], proof.cuts[k]), proof.cuts[k])
    stated = {"covers": [pool.cover(proof.covers[k]) for k in covers]} if covers else {}
    stated |= inequalities.record(None if proof.spacing is None else proof.spacing.count(upper))
    return {"attacks": pool.attacks(), "points": pool.points(), "cuts": cuts, **stated, "tree": tree}


def _weighed(numbers: tuple[int, ...], weights: tuple[float, ...]) -> list[tuple[int, float]]:
    """The cuts or covers of a leaf that count, and their weights."""
    return [(k, float(w)) for k, w in zip(numbers, weights, strict=True) if w > 0]


class _StatedParts:
    """Attacks and Fenchel points, each stated once and counted as they are met."""

    def __init__(self, problem: Problem, params: PointParams) -> None:
        self._problem, self._objective, self._params = problem, problem.information_objective, params
        self._attacks: dict[Attack, int] = {}
        self._groups: dict[Attack, list[tuple[int, ...]]] = {}
        self._points: dict[tuple[bytes, int | None], tuple[int, Any]] = {}

    def attack(self, attack: Attack) -> int:
        return self._attacks.setdefault(attack, len(self._attacks))

    def groups(self, attack: Attack) -> list[tuple[int, ...]]:
        """Groups that an attack leaves, ascending."""
        if attack not in self._groups:
            left = sorted(tuple(sorted(group)) for group in self._problem.groups_left(attack) if group)
            self._groups[attack] = left or [()]
        return self._groups[attack]

    def point(self, point: FloatArray, target: int | None = None) -> int:
        key = point.tobytes(), target
        if key not in self._points:
            fenchel = self._objective.fenchel_point(point, target)
            self._points[key] = (
                len(self._points),
                shortened(fenchel, point, self._params.digits, self._params.condition),
            )
        return self._points[key][0]

    def place(self, attack: Attack, cut: TangentCut) -> list[int]:
        """The attack and the group that a cut bounds, by their numbers."""
        return [self.attack(attack), self.groups(attack).index(tuple(sorted(cut.group)))]

    def cut(self, attack: Attack, cut: TangentCut) -> list[int]:
        return [*self.place(attack, cut), self.point(cut.point, cut.target)]

    def cover(self, cover: Cover) -> dict[str, Any]:
        return {
            "attack": self.attack(cover.attack),
            "left_out": list(cover.left_out),
            "points": [self.point(point) for point in cover.points],
        }

    def attacks(self) -> list[dict[str, Any]]:
        return [{"robots": sorted(a.sensing), "links": [list(link) for link in sorted(a.links)]} for a in self._attacks]

    def points(self) -> list[Any]:
        return [point for _, point in self._points.values()]


class _Nodes:
    """Nodes as the record has them, in order; ``cuts``, ``covers`` : the numbers there of those that the proof has."""

    def __init__(self, pool: _StatedParts, proof: UpperProof, *, cuts: dict[int, int], covers: dict[int, int]) -> None:
        self._pool, self._proof, self._cuts, self._covers = pool, proof, cuts, covers
        self._parts: dict[int, list[list[int]]] = {}

    def node(self, node: Node) -> dict[str, Any]:
        if isinstance(node, Leaf):
            pairs = _weighed(node.cuts, node.weights)
            return {"fenchel": [self._cuts[k] for k, _ in pairs], "weights": [w for _, w in pairs]}
        if isinstance(node, CoverLeaf):
            pairs = _weighed(node.covers, node.weights)
            return {"covers": [self._covers[k] for k, _ in pairs], "weights": [w for _, w in pairs]}
        if isinstance(node, ElementBranch):
            listed = node.parts[:-1] if self._covers else node.parts  # the last part is what is left
            parts = [list(part) for part in listed]
            if parts == self._parts.get(node.robot):
                return {"element": node.robot}
            self._parts[node.robot] = parts
            return {"element": node.robot, "parts": parts}
        attack = self._proof.attacks[node.attack]
        if isinstance(node, MarginalLeaf):
            return {"marginals": self._pool.attack(attack)}
        assert list(node.parts) == self._pool.groups(attack)
        return {"part": self._pool.attack(attack)}
