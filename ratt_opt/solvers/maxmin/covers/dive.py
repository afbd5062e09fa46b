"""A search in depth (``native/src/cover_dive.c``) that runs on and on, the plan that it meets, and its proof."""

from __future__ import annotations

from ctypes import byref, c_int
from enum import IntEnum
from typing import TYPE_CHECKING

import numpy as np

from ratt_opt.native.library import address, check_numbers, checked
from ratt_opt.native.loops import NodeRecord, NodesRecord, StackRecord, StepRecord, SumsRecord, loops
from ratt_opt.solvers.maxmin.levels import Outcome
from ratt_opt.solvers.maxmin.proof import CoverLeaf, ElementBranch, UpperProof

if TYPE_CHECKING:
    from ratt_opt._validation import BoolArray, FloatArray, IntArray
    from ratt_opt.solvers.maxmin.covers.choices import CoverChoices
    from ratt_opt.solvers.maxmin.covers.separation import Separation
    from ratt_opt.solvers.maxmin.elements import Elements
    from ratt_opt.solvers.maxmin.params import CoverSearchParams
    from ratt_opt.solvers.maxmin.proof import Cover

__all__ = ["CoverSums", "Dive", "DiveProof", "Reason"]


class Reason(IntEnum):
    """Reason that forbids an element, or ends a frame: a cover, a sum of covers, or that the element was a dead end."""

    COVER = 0
    SUM = 1
    TRIED = 2


class Stack:
    """Frames and steps, at first one frame in which everything is allowed.

    ``allowed`` : (N + 1, N) masks of the elements that are allowed in each frame
    """

    def __init__(self, choices: CoverChoices) -> None:
        n, e = choices.element.shape[0], choices.elements.count
        self.allowed, strongest = np.zeros((n + 1, n), np.uint64), np.zeros((n + 1, *choices.strongest.shape))
        self.allowed[0], strongest[0] = choices.masks, choices.strongest
        fixed, first, since = np.zeros(n + 1, np.int64), np.zeros(n + 2, np.int64), np.full(e, -1, np.int64)
        steps, reasons = np.zeros(e + 1, StepRecord), np.zeros((e + 1, n), np.uint64)
        touched, activity = np.zeros((n + 1, n), np.int64), np.zeros(n)
        # The record has their addresses only.
        self._arrays = choices.masks, strongest, fixed, first, since, steps, reasons, touched, activity
        self.record = StackRecord(
            frame=0,
            count=0,
            start=address(choices.masks),
            allowed=address(self.allowed),
            strongest=address(strongest),
            fixed=address(fixed),
            first=address(first),
            steps=address(steps),
            reasons=address(reasons),
            since=address(since),
            touched=address(touched),
            activity=address(activity),
        )

    @property
    def frame(self) -> int:
        """The present one."""
        return int(self.record.frame)


class DiveRecord:
    """The nodes of a search: the last one is the root.

    A node's subject is a cover, a sum, or the node of the dead end. What ends a frame has robot -1.
    """

    def __init__(self, room: int) -> None:
        self._nodes = np.zeros(room, NodeRecord)
        self.record = NodesRecord(size=0, room=room, nodes=address(self._nodes))

    @property
    def size(self) -> int:
        """Number of entries."""
        return int(self.record.size)

    @property
    def nodes(self) -> IntArray:
        """(R, 5) kind, its subject, robot, element's place, the next node."""
        return self._nodes[: self.size].view(np.int64).reshape(-1, 5)

    def make_room(self, more: int) -> None:
        """Grow as long as there is no room for ``more`` nodes and one."""
        while self.size + more >= len(self._nodes):
            self._nodes = np.concatenate([self._nodes, np.zeros_like(self._nodes)])
        self.record = NodesRecord(size=self.size, room=len(self._nodes), nodes=address(self._nodes))


class Sums:
    """Sums of covers by number: what each element counts, ``terms`` (R, E), of which plans have to count ``enough``.

    ``tried`` : (A,) those that are looked at; ``used`` : (R,) how often each was of use; it changes

    Raises
    ------
    InputError : a shape or a type is another, or one that is tried is not there.
    """

    def __init__(self, elements: int, terms: FloatArray, tried: IntArray, used: FloatArray) -> None:
        checked("terms", terms, np.float64, (len(used), elements))
        checked("tried", tried, np.int64, (len(tried),))
        checked("used", used, np.float64, (len(used),), written=True)
        check_numbers("tried", tried, 0, len(used))
        self.terms, self._tried, self._used = terms, tried, used
        self.record = SumsRecord(looked_at=len(tried), terms=address(terms), tried=address(tried), used=address(used))


class CoverSums:
    """Sums by number, with the leaf that each stands for."""

    def __init__(self, elements: int, params: CoverSearchParams) -> None:
        self._params = params
        self._elements, self._terms, self._used = elements, np.zeros((params.sums, elements)), np.zeros(params.sums)
        self.leaves: list[CoverLeaf] = []

    def add(self, covers: IntArray, weights: FloatArray, terms: FloatArray) -> None:
        """Add the covers' weighted sum; ``terms`` : (E,) what each element counts."""
        number = len(self.leaves)
        if number == len(self._used):
            self._terms = np.concatenate([self._terms, np.zeros_like(self._terms)])
            self._used = np.concatenate([self._used, np.zeros_like(self._used)])
        self._terms[number] = terms
        self._used *= self._params.fading
        self._used[number] = self._used.max() + 1.0
        self.leaves.append(CoverLeaf(covers=tuple(covers.tolist()), weights=tuple(weights.tolist())))

    def rows(self) -> Sums:
        """Return the sums of most use, in the form that the compiled dive reads."""
        tried = np.argsort(-self._used[: len(self.leaves)], kind="stable")[: self._params.sums]
        return Sums(self._elements, self._terms, tried.astype(np.int64), self._used)


class Dive:
    """A search over all plans."""

    def __init__(self, separation: Separation, sums: CoverSums) -> None:
        self._separation, self._sums, self._choices = separation, sums, separation.choices
        self._params = separation.params.covers
        self.record, self._stack = DiveRecord(self._params.room), Stack(separation.choices)

    @property
    def frame(self) -> int:
        """The frame that it is in."""
        return self._stack.frame

    @property
    def is_long(self) -> bool:
        """True if the record is as long as memory should hold."""
        return self.record.size >= self._params.recorded

    def run(self, level: float, nodes: int) -> Outcome:
        """Search on; how that ended. Makes room in what is full first."""
        pool, ways, sums = self._separation.pool, self._separation.ways(), self._sums.rows()
        pool.make_room(ways.widest)
        self.record.make_room(self._choices.elements.count + 1)
        outcome = c_int(Outcome.SPENT)
        tables = self._choices.record, ways.record, pool.record, sums.record, self._stack.record, self.record.record
        if loops.dive_by_covers(*tables, level, nodes, self._params.ways, byref(outcome)):
            raise MemoryError
        return Outcome(outcome.value)

    def allowed(self, frame: int) -> BoolArray:
        """(E,) elements that are allowed in a frame."""
        return self._choices.in_masks(self._stack.allowed[frame])

    def plan(self) -> IntArray:
        """(N,) the plan that is left."""
        masks, element = self._stack.allowed[self.frame], self._choices.element
        return np.array([element[i, int(mask).bit_length() - 1] for i, mask in enumerate(masks)])


class DiveProof:
    """A record with the covers and sums that it names, over the elements of the search.

    ``nodes`` : (R, 5), the last is the root; ``left_out`` : of each cover in use, masks (N,); ``terms`` : (R', E)
    """

    def __init__(
        self,
        elements: Elements,
        nodes: IntArray,
        *,
        covers: dict[int, Cover],
        left_out: dict[int, list[int]],
        sums: list[CoverLeaf],
        terms: FloatArray,
    ) -> None:
        self._elements, self._nodes, self._sums, self._terms = elements, nodes, sums, terms
        self._covers, self._left_out = covers, left_out
        self._branches: dict[tuple[int, int, int], ElementBranch] = {}
        self._leaves: dict[int, CoverLeaf] = {}

    def written(self) -> UpperProof:
        """The tree in preorder, with the covers that it uses."""
        choices = self._elements.problem.choices
        stack = [(len(self._nodes) - 1, [(1 << len(choice)) - 1 for choice in choices])]
        tree: list[CoverLeaf | ElementBranch] = []
        while stack:
            number, allowed = stack.pop()
            kind, subject, robot, place, following = self._nodes[number if number >= 0 else -1 - number].tolist()
            if robot < 0 or number < 0:  # what ends a frame, or what a step forbids
                tree.append(self._leaf(kind, subject))
                continue
            gone = allowed[robot] & self._gone(kind, subject, robot, place)
            rest = allowed[robot] & ~gone
            below = {mask: [*allowed[:robot], mask, *allowed[robot + 1 :]] for mask in (gone, rest) if mask}
            if len(below) == 2:
                below = dict(sorted(below.items(), key=lambda item: item[0].bit_count()))
                tree.append(self._branch(robot, *below))
            for mask, own in reversed(below.items()):
                stack.append((following if mask == rest else subject if kind == Reason.TRIED else -1 - number, own))
        return self._numbered(tree)

    def _gone(self, kind: int, subject: int, robot: int, place: int) -> int:
        """The mask of a robot's elements that one step forbids, whatever was forbidden before."""
        if kind == Reason.TRIED:
            return 1 << place
        if kind == Reason.COVER:
            return ~self._left_out[subject][robot]
        terms = self._terms[subject][self._elements.problem.choices[robot]]
        return sum(1 << p for p in np.flatnonzero(terms <= terms[place]).tolist())

    def _leaf(self, kind: int, subject: int) -> CoverLeaf:
        if kind == Reason.SUM:
            return self._sums[subject]
        if subject not in self._leaves:
            self._leaves[subject] = CoverLeaf(covers=(subject,), weights=(1.0,))
        return self._leaves[subject]

    def _branch(self, robot: int, first: int, second: int) -> ElementBranch:
        key = robot, first, second
        if key not in self._branches:
            choice = self._elements.problem.choices[robot]
            parts = tuple(
                self._elements.members(choice[[p for p in range(len(choice)) if mask >> p & 1]])
                for mask in (first, second)
            )
            self._branches[key] = ElementBranch(robot=robot, parts=parts)
        return self._branches[key]

    def _numbered(self, tree: list[CoverLeaf | ElementBranch]) -> UpperProof:
        """The proof, its covers numbered anew."""
        used = sorted({k for node in tree if isinstance(node, CoverLeaf) for k in node.covers})
        number = {k: n for n, k in enumerate(used)}
        leaves: dict[CoverLeaf, CoverLeaf] = {}
        for node in tree:
            if isinstance(node, CoverLeaf) and node not in leaves:
                leaves[node] = CoverLeaf(covers=tuple(number[k] for k in node.covers), weights=node.weights)
        nodes = tuple(leaves[node] if isinstance(node, CoverLeaf) else node for node in tree)
        return UpperProof(attacks=(), cuts=(), tree=nodes, covers=tuple(self._covers[k] for k in used))
