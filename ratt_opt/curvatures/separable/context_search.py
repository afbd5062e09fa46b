"""Branch and bound over the contexts of one element: how small its marginal can be.

A node restricts each other owner to some of its elements, or to none. Its bound is the criterion's best separable
minorant over conditional-gradient steps; the minorant's vertices are contexts, and the smallest marginal among those
tried is the attained end. A node that fixes every owner is evaluated.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np

from ratt_opt.curvatures.marginals import MARGIN
from ratt_opt.search.branch_and_bound import divide_next
from ratt_opt.search.open_nodes import OpenNodes

if TYPE_CHECKING:
    from ratt_opt._validation import BoolArray, FloatArray, IntArray
    from ratt_opt.budget import Budget, Stop
    from ratt_opt.curvatures.params import SeparableParams
    from ratt_opt.setfunctions.criterion_parts import OtherElements
    from ratt_opt.setfunctions.information import InformationObjective

__all__ = ["BestContext", "ContextSearch", "FloorSearch"]


class BestContext:
    """``value`` is the marginal of ``x`` in ``context``, the smallest (or ``largest``) of those offered."""

    def __init__(self, f: InformationObjective, x: int, others: OtherElements, *, largest: bool = False) -> None:
        self._f, self._x, self._others = f, x, others
        self._sign = -1.0 if largest else 1.0
        self.value = self._sign * np.inf
        self.context: tuple[int, ...] = ()
        self._tried: set[tuple[int, ...]] = set()
        self.offer(np.empty(0, dtype=np.int64))

    def descend(self, budget: Budget) -> None:
        """Change one owner's choice at a time, from the best context so far, until no change is better."""
        others = self._others
        groups = [others.elements[others.owners == i] for i in range(len(others.first))]
        before = np.inf
        while self.value != before:
            before = self.value
            for own in groups:
                if budget.is_over:
                    return
                rest = np.array([e for e in self.context if e not in own], dtype=np.int64)
                self._keep(np.concatenate([np.tile(rest, (len(own), 1)), own[:, None]], axis=1))
                self._keep(rest[None])

    def offer(self, context: IntArray) -> None:
        """Evaluate a context, if it is new."""
        key = tuple(context.tolist())
        if key not in self._tried:
            self._tried.add(key)
            self._keep(context[None])

    def _keep(self, contexts: IntArray) -> None:
        """Evaluate contexts (K, size) and keep the best."""
        f = self._f
        posterior = f.prior_information + f.information[contexts].sum(axis=1)
        marginals = f.value(posterior + f.information[self._x]) - f.value(posterior)
        k = int((self._sign * marginals).argmin())
        if np.isinf(self.value) or self._sign * (self.value - marginals[k]) > f.least_improvement(self.value, terms=2):
            self.value, self.context = float(marginals[k]), tuple(contexts[k].tolist())


@dataclass(order=True, slots=True)
class _ContextNode:
    """A part of the contexts: ``allowed`` (K,) elements, ``absent`` (R,) owners that may contribute none."""

    bound: float
    serial: int
    allowed: BoolArray = field(compare=False)
    absent: BoolArray = field(compare=False)
    share: FloatArray = field(compare=False)
    steps: int = field(compare=False)


class ContextSearch:
    """Claim: ``lower <= smallest marginal of x over contexts <= attained.value``; see :class:`BestContext`.

    ``nodes`` : parts bounded so far. Once the budget is spent a part gets one tangent, which bounds it as well.
    """

    def __init__(
        self,
        f: InformationObjective,
        x: int,
        others: OtherElements,
        attained: BestContext,
        *,
        budget: Budget,
        params: SeparableParams,
    ) -> None:
        self.attained, self.nodes, self._params = attained, 0, params
        self._f, self._added, self._others, self._budget = f, f.information[x], others, budget
        self._serial = 0
        self._open: OpenNodes[_ContextNode] = OpenNodes([])
        count = len(others.first)
        share = 1.0 / np.bincount(others.owners, minlength=count)[others.owners]
        root = _ContextNode(0.0, 0, np.ones(len(share), dtype=np.bool_), np.ones(count, dtype=np.bool_), share, 0)
        if count and self._raise_bound(root, params.first_steps):
            self._open = OpenNodes([root])
        self.attained.descend(budget)

    @property
    def exhausted(self) -> bool:
        """Tell whether no part is open: the bounds meet."""
        return not self._open

    @property
    def lower(self) -> float:
        """Proved lower end: the weakest open part."""
        return float(min(self._open.bound, self.attained.value))

    def refine(self) -> None:
        """Look at the weakest open part again, or split it; an interrupt leaves the parts as they were."""
        divide_next(self._open, self)

    def stop(self) -> Stop | None:
        """Return why to stop; searches of other elements take turns with it."""
        return self._budget.stop()

    def bound(self, node: _ContextNode) -> _ContextNode | None:
        """Return the node: children are bounded as they are made, as some need none of their own."""
        return node

    def branch(self, node: _ContextNode) -> list[_ContextNode]:
        """Return the children that may hold a smaller marginal; the root again, with a better bound, the first time."""
        if node.serial == 0 and node.steps < self._params.more_steps:
            return [node] if self._raise_bound(node, self._params.more_steps) else []
        return [child for child in self._children(node) if self._raise_bound(child, self._params.child_steps)]

    def _raise_bound(self, node: _ContextNode, steps: int) -> bool:
        """Raise a part's bound by more tangents; whether it may still hold a smaller marginal."""
        self.nodes += 1
        others = self._others
        for _ in range(steps):
            separable = self._f.marginal_minorant(self._added, others, node.share)
            score = np.where(node.allowed, separable.score, -np.inf)
            best = np.maximum.reduceat(score, others.first)
            worst = np.where(node.absent, np.maximum(best, separable.absent), best)
            bound = separable.constant - float(worst.sum())
            node.bound = max(node.bound, bound - MARGIN * (abs(separable.constant) + float(np.abs(worst).sum())))
            picks = self._picks(score, best)
            self.attained.offer(others.elements[picks])
            node.steps += 1
            if node.bound >= self.attained.value:
                return False
            vertex = np.zeros(len(score))
            vertex[picks] = 1.0
            node.share = node.share + 2 / (node.steps + 2) * (vertex - node.share)
            if self._budget.is_over:
                break
        counts = np.add.reduceat(node.allowed.astype(np.int64), others.first) + node.absent
        return bool((counts != 1).any())  # else it is one context, which has been tried above

    def _picks(self, score: FloatArray, best: FloatArray) -> IntArray:
        """The first element of the best score, of each owner that has one left."""
        hits = np.flatnonzero((score == best[self._others.owners]) & np.isfinite(score))
        return hits[np.unique(self._others.owners[hits], return_index=True)[1]]

    def _children(self, node: _ContextNode) -> list[_ContextNode]:
        """Split off the likeliest element of the owner whose mixture is spread most, or its absence."""
        others = self._others
        counts = np.add.reduceat(node.allowed.astype(np.int64), others.first)
        mean = np.add.reduceat(node.share[:, None, None, None] * others.information, others.first, axis=0)
        posterior = self._f.prior_information + mean.sum(axis=0)
        deviation = others.information - mean[others.owners]
        relative = np.linalg.solve(posterior[None], deviation)
        # Each target counts as much as it contributes to the marginal.
        weight = self._f.criterion(posterior) - self._f.criterion(posterior + self._added)
        spread = node.share * ((relative**2).sum(axis=(-1, -2)) @ weight)
        by_owner = np.add.reduceat(spread, others.first)
        by_owner[(counts + node.absent) < 2] = -1.0
        i = int(by_owner.argmax())
        mine = others.owners == i
        if counts[i] < 2:
            chosen = np.zeros(len(mine), dtype=np.bool_)
            parts = [(node.allowed & ~mine, True), (node.allowed, False)]
        else:
            chosen = mine & (np.arange(len(mine)) == int(np.where(mine & node.allowed, node.share, -1.0).argmax()))
            parts = [((node.allowed & ~mine) | chosen, False), (node.allowed & ~chosen, bool(node.absent[i]))]
        return [self._child(node, allowed, i, absent) for allowed, absent in parts]

    def _child(self, node: _ContextNode, allowed: BoolArray, i: int, absent: bool) -> _ContextNode:
        others = self._others
        left = node.absent.copy()
        left[i] = absent
        share = np.where(allowed, node.share, 0.0)
        mass = np.add.reduceat(share, others.first)
        counts = np.add.reduceat(allowed.astype(np.int64), others.first)
        empty = (mass <= 0) & (counts > 0)
        share = np.where(empty[others.owners] & allowed, 1.0, share)
        mass = np.add.reduceat(share, others.first)
        share = share / np.where(mass > 0, mass, 1.0)[others.owners]
        self._serial += 1
        return _ContextNode(node.bound, self._serial, allowed, left, share, 0)


class FloorSearch:
    """Claim: ``floor <= smallest marginal of x over contexts <= attained.value``, if no more than that is known.

    ``single`` : (n,) values alone; the descent starts from the most valuable element of every other owner.
    """

    exhausted = True
    nodes = 1

    def __init__(
        self, attained: BestContext, others: OtherElements, single: FloatArray, floor: float, budget: Budget
    ) -> None:
        own = np.split(others.elements, others.first[1:])
        best = [int(part[single[part].argmax()]) for part in own if len(part)]
        self.attained = attained
        self.attained.offer(np.array(best, dtype=np.int64))
        self.attained.descend(budget)
        self.lower = min(floor, self.attained.value)

    def refine(self) -> None:
        """Do nothing: no part is open."""
