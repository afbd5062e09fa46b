"""Proofs that some weight of links must be cut, beside prices of robots: counting, listed groups, elimination.

All numbers are integers. Robots that protected links join are one robot here, except for counting.
"""

from __future__ import annotations

from collections import defaultdict
from itertools import product
from typing import TYPE_CHECKING

from ratt_opt.certificates.verifier.limits import limits
from ratt_opt.certificates.verifier.reading import array, check_size, fields, index, need
from ratt_opt.certificates.verifier.work import tick

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Sequence

__all__ = ["cannot_cut_less", "check_levels", "most_links_inside"]

Classes = tuple[tuple[int, ...], ...]
State = tuple[int, tuple[int, ...]]
"""Weight cut, and the sizes of eliminated robots in each class."""
Table = dict[Classes, list[State]]


def most_links_inside(robots: int, most: int) -> int:
    """Most links inside disjoint groups of at most ``most`` of these robots.

    A group of s robots has at most s(s-1)/2 links. That is convex in s, so groups as large as may be have the most.
    """
    most = min(most, robots)
    groups, rest = divmod(robots, most) if most else (0, 0)
    return groups * most * (most - 1) // 2 + rest * (rest - 1) // 2


def check_levels(
    groups: list[frozenset[int]], levels: object, needed: int, kept: Callable[[frozenset[int]], int], robots: int
) -> None:
    """Check that no partition into some of these groups keeps ``needed``, in units of prices.

    A level has prices of robots and of triples. At most one group of a partition holds two robots of a triple. A group
    pays the prices of its robots, and of each triple with two or three robots inside. It must pay at least the
    links inside. Then the slacks of a partition's groups add up to at most ``room = all prices - needed``. Groups with
    a greater slack are in no such partition, and the next level need not hold for them. A search ends the rest.

    Raises
    ------
    ProofError : a level does not hold for a group, or a partition is found.
    """
    left = [(group, 0) for group in groups]
    least: int | None = None
    for level in array("levels", levels):
        stated, triples = fields("level", level, "prices triples")
        prices = [index("price", one, limits().cut_numbers) for one in array("level prices", stated, robots)]
        known = [_triple(one, robots) for one in array("triples", triples)]
        room = sum(prices) + sum(price for _, price in known) - needed
        is_least = least is None or room < least
        fresh = []
        for group, before in left:
            tick()
            paid = sum(price for triple, price in known if len(triple & group) > 1)
            slack = sum(prices[i] for i in group) + paid - kept(group)
            need(slack >= 0, "levels: a group has links of more than its prices")
            if slack <= room:
                fresh.append((group, slack if is_least else before))
        left, least = fresh, room if is_least else least
    need(least is not None, "levels: none is given")
    assert least is not None
    need(least < 0 or not _has_partition(left, least, robots), "levels: a partition into listed groups is left")


def _triple(stated: object, robots: int) -> tuple[frozenset[int], int]:
    *three, price = array("triple", stated, 4)
    found = frozenset(index("robot of a triple", i, robots) for i in three)
    need(len(found) == len(three), "levels: a triple names a robot twice")
    return found, index("price of a triple", price, limits().cut_numbers)


def _has_partition(groups: list[tuple[frozenset[int], int]], room: int, robots: int) -> bool:
    """Tell whether disjoint groups have all robots once and slacks of at most ``room``; looks at the clock."""
    by_robot: list[list[tuple[frozenset[int], int]]] = [[] for _ in range(robots)]
    for group, slack in groups:
        for i in group:
            by_robot[i].append((group, slack))
    open_: list[tuple[frozenset[int], int]] = [(frozenset(range(robots)), room)]
    while open_:
        tick()
        rest, left = open_.pop()
        if not rest:
            return True
        fits = [[one for one in by_robot[i] if one[1] <= left and one[0] <= rest] for i in rest]
        open_ += [(rest - group, left - slack) for group, slack in min(fits, key=len)]
    return False


def cannot_cut_less(  # noqa: PLR0917
    order: Sequence[int],
    sizes: Sequence[int],
    links: Sequence[tuple[int, int]],
    weights: Sequence[int],
    most: int,
    claim: int,
) -> bool:
    """Tell whether links of weight ``claim`` at least are cut if groups have a size of at most ``most``.

    Robots are eliminated in order. A table is over robots that are not eliminated: which of these kept links join
    (classes), and for each such division the weight cut and the sizes of the eliminated robots in each class. A state
    is dropped if its weight reaches the claim, a class is too large, or another state dominates it.

    Raises
    ------
    UndecidedError : the time is up.
    FileFormatError : there are more states than fit into memory.
    """
    tables: list[tuple[frozenset[int], Table]] = []
    for (i, j), weight in zip(links, weights, strict=True):
        table: Table = {((i, j),): [(0, (0,))], ((i,), (j,)): [(weight, (0, 0))]}
        tables.append((frozenset((i, j)), table))
    for robot in order:
        here = sorted((one for one in tables if robot in one[0]), key=lambda one: sum(map(len, one[1].values())))
        tables = [one for one in tables if robot not in one[0]]
        scope, joined = frozenset((robot,)), Table({((robot,),): [(0, (0,))]})
        for other, table in here:
            scope |= other
            joined = _joined(joined, table, sizes, most, claim)
        tables.append((scope - {robot}, _without(joined, robot, sizes[robot])))
        if not tables[-1][1]:
            return True
    return sum(min(weight for weight, _ in table[()]) for _, table in tables) >= claim


def _joined(one: Table, other: Table, sizes: Sequence[int], most: int, claim: int) -> Table:
    fronts: dict[Classes, list[State]] = defaultdict(list)
    for (first, states), (second, others) in product(one.items(), other.items()):
        classes = _merged([*first, *second])
        into = [next(k for k, group in enumerate(classes) if part[0] in group) for part in (*first, *second)]
        room = [most - sum(sizes[i] for i in group) for group in classes]
        for (weight, loads), (more, further) in product(states, others):
            tick()
            total = [0] * len(classes)
            for k, load in zip(into, (*loads, *further), strict=True):
                total[k] += load
            if weight + more < claim and all(load <= left for load, left in zip(total, room, strict=True)):
                _keep(fronts[classes], (weight + more, tuple(total)))
    check_size("states of an elimination", sum(map(len, fronts.values())), limits().states)
    return {classes: states for classes, states in fronts.items() if states}


def _without(table: Table, robot: int, size: int) -> Table:
    """The table once a robot is eliminated: its class has its size, or is forgotten with its last robot."""
    fronts: dict[Classes, list[State]] = defaultdict(list)
    for classes, states in table.items():
        at = next(k for k, group in enumerate(classes) if robot in group)
        rest = tuple(i for i in classes[at] if i != robot)
        left = tuple(sorted((*classes[:at], *((rest,) if rest else ()), *classes[at + 1 :])))
        place = [classes.index(group) if group != rest else at for group in left]
        for weight, loads in states:
            tick()
            own = [*loads[:at], loads[at] + size, *loads[at + 1 :]]
            _keep(fronts[left], (weight, tuple(own[k] for k in place)))
    return dict(fronts)


def _keep(front: list[State], state: State) -> None:
    """Add a state unless another one dominates it; drop those that it dominates."""

    def is_as_good(a: State, b: State) -> bool:
        return a[0] <= b[0] and all(x <= y for x, y in zip(a[1], b[1], strict=True))

    if not any(is_as_good(old, state) for old in front):
        front[:] = [old for old in front if not is_as_good(state, old)]
        front.append(state)


def _merged(parts: Iterable[tuple[int, ...]]) -> Classes:
    """Classes of parts that overlap, in order."""
    classes: list[set[int]] = []
    for part in parts:
        whole = set(part)
        for other in [one for one in classes if not whole.isdisjoint(one)]:
            whole |= other
            classes.remove(other)
        classes.append(whole)
    return tuple(sorted(tuple(sorted(group)) for group in classes))
