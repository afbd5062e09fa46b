"""The robots and the elements that each may choose, as the compiled loops read them."""

from __future__ import annotations

from ctypes import byref, c_double
from typing import TYPE_CHECKING

import numpy as np

from ratt_opt.errors import InputError
from ratt_opt.native.library import address, checked
from ratt_opt.native.loops import ChoicesRecord, loops
from ratt_opt.solvers.maxmin.elements import PackedElements

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from ratt_opt._validation import BoolArray, FloatArray, IntArray
    from ratt_opt.problem import Problem

__all__ = ["MOST_CHOICES", "CoverChoices"]

MOST_CHOICES = 64
"""Elements of one robot: a set of them is a mask of 64 bits."""


class CoverChoices:
    """Elements of N robots; what a group of robots is worth by them, and what it is worth if few are kept.

    ``owner`` : (E,) the robot of each element; ``bit`` : (E,) its place among the robot's
    ``element`` : (N, C) the element at each place, or -1; ``masks`` : (N,) all elements of each robot
    ``safe`` : (N,) whether a robot cannot be blinded
    ``enough`` : what plans have to count in a cover; ``count`` : (N,) what a robot counts, all of it if it is safe

    Raises
    ------
    InputError : a shape or a type is another, an owner is no robot, or a robot has more than 64 elements.
    """

    def __init__(self, elements: PackedElements, owner: IntArray, safe: BoolArray, enough: int) -> None:
        self.elements, self.owner, robots = elements, checked("owner", owner, np.int64, (elements.count,)), len(safe)
        if np.any((owner < 0) | (owner >= robots)):
            raise InputError("owner", f"must be in [0, {robots - 1}]", owner)
        if not 1 <= enough <= robots + 1:
            raise InputError("enough", f"must be in [1, {robots + 1}]", enough)
        choices = [np.flatnonzero(owner == i) for i in range(robots)]
        widest = max(map(len, choices), default=0)
        if widest > MOST_CHOICES:
            raise InputError("owner", f"must give each robot at most {MOST_CHOICES} elements", widest)
        self.bit, self.element = np.zeros(len(owner), np.int64), np.full((robots, widest), -1, np.int64)
        for i, choice in enumerate(choices):
            self.bit[choice] = np.arange(len(choice))
            self.element[i, : len(choice)] = choice
        self.masks = np.array([(1 << len(choice)) - 1 for choice in choices], np.uint64)
        self.safe, self.enough = checked("safe", safe, np.bool_, (robots,)), float(enough)
        self.count = np.where(safe, self.enough, 1.0)
        self.record = ChoicesRecord(
            all=elements.record,
            robots=robots,
            widest=widest,
            owner=address(self.owner),
            place=address(self.bit),
            element=address(self.element),
            count=address(self.count),
            safe=address(self.safe),
            enough=self.enough,
        )
        self.strongest = np.zeros((robots, *elements.prior.shape))
        """(N, M, T) no less than what any element of the robot tells about the target."""
        loops.bound_robots(self.record, address(self.masks), address(self.strongest))

    @classmethod
    def of(cls, problem: Problem) -> CoverChoices:
        """A problem's."""
        objective = problem.information_objective
        sees = np.trace(objective.information, axis1=-2, axis2=-1) > 0
        safe = np.isin(np.arange(problem.n_robots), list(problem.protected_robots))
        enough = min(problem.alpha_s, problem.threat.n_blinded) + 1
        elements = PackedElements.of(objective, objective.information, sees)
        return cls(elements, np.array(problem.robot, np.int64), safe, enough)

    def masks_of(self, chosen: BoolArray) -> NDArray[np.uint64]:
        """(N,) masks of some elements (E,)."""
        masks = np.zeros(len(self.safe), np.uint64)
        bits = np.uint64(1) << self.bit[chosen].astype(np.uint64)
        np.bitwise_or.at(masks, self.owner[chosen], bits)
        return masks

    def in_masks(self, masks: NDArray[np.uint64]) -> BoolArray:
        """(E,) which elements masks (N,) hold."""
        return np.asarray(masks[self.owner] >> self.bit.astype(np.uint64) & np.uint64(1), dtype=np.bool_)

    def group_values(self, members: BoolArray) -> FloatArray:
        """(G, M) what groups, ``members`` (G, N), can be worth for each target."""
        checked("members", members, np.bool_, (len(members), len(self.safe)))
        values = np.zeros((len(members), self.elements.targets))
        given = address(self.strongest), len(members), address(members)
        loops.group_values(self.record, *given, address(values))
        return values

    def lose(
        self, inside: BoolArray, price: FloatArray, values: FloatArray, level: float, noise: FloatArray
    ) -> tuple[FloatArray, BoolArray]:
        """Lose targets of each group until the rest is worth at most ``level``.

        ``inside`` : (G, E) elements of the groups; ``price`` : (E,); ``values`` : (G, M) what a group can be worth for
        each target; ``noise`` : (G, M) factors of the order in which targets are lost

        Returns the price (G,) of all elements that see a lost target, infinite if the level is not reached, and the
        others (G, E).
        """
        groups = len(inside)
        checked("inside", inside, np.bool_, (groups, self.elements.count))
        checked("price", price, np.float64, (self.elements.count,))
        for name, array in (("values", values), ("noise", noise)):
            checked(name, array, np.float64, (groups, self.elements.targets))
        kept, paid = np.zeros_like(inside), np.zeros(groups)
        given = address(inside), address(price), address(values), level, address(noise)
        if loops.lose_all(self.record, groups, *given, address(kept), address(paid)):
            raise MemoryError
        return paid, kept

    def keep(self, inside: BoolArray, price: FloatArray, level: float, kept: BoolArray) -> tuple[float, FloatArray]:
        """Keep further elements of a group while its bound stays at most ``level``.

        ``inside`` : (E,) its elements; ``price`` : (E,)
        ``kept`` : (E,) elements kept so far, whose bound is at most the level; more are set

        Returns the price of what is not kept, and the posterior information (M, T) at which the bound is taken.
        """
        count = self.elements.count
        checked("inside", inside, np.bool_, (count,))
        checked("price", price, np.float64, (count,))
        checked("kept", kept, np.bool_, (count,), written=True)
        sums, paid = np.zeros_like(self.elements.prior), c_double(0.0)
        given, places = (address(inside), address(price), level), (address(kept), address(sums), byref(paid))
        if loops.keep_elements(self.record, *given, *places):
            raise MemoryError
        return paid.value, sums
