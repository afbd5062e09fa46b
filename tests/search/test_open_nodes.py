"""Open nodes against a plain list: order, bounds, and interrupts at any moment."""

from dataclasses import dataclass, field

import numpy as np
import pytest

from ratt_opt.search.open_nodes import OpenNodes


@dataclass(frozen=True, order=True)
class Part:
    """Numbers ``first`` to ``last`` of a list; the bound is their least one, or less."""

    bound: float
    serial: int
    first: int = field(compare=False)
    last: int = field(compare=False)


class StoppedError(Exception):
    """A limit, or a user."""


def halves(part, values, serial):
    middle = (part.first + part.last) // 2
    for k, (a, b) in enumerate(((part.first, middle), (middle, part.last))):
        yield Part(max(part.bound, values[a:b].min() - (b - a)), serial + k, a, b)


def searched(values, most, stops):
    """Find the least value; ``stops()`` says whether to stop at this moment, and the search goes on after that."""
    nodes, best, serial, divided = OpenNodes([Part(-np.inf, 0, 0, len(values))], most), np.inf, 1, 0
    while nodes:
        try:
            while nodes:
                assert min(nodes.bound, best) <= values.min()
                part = nodes.take()
                if part.last - part.first == 1:
                    best = min(best, values[part.first])
                elif part.bound < best:
                    divided += 1
                    if stops():
                        raise StoppedError
                    nodes.keep([child for child in halves(part, values, serial) if child.bound < best])
                    serial += 2
                    if stops():
                        raise StoppedError
                nodes.done()
        except StoppedError:
            assert len(nodes) > 0
    assert nodes.bound == np.inf
    return best, divided


@pytest.mark.parametrize("most", [0, 1, 3, np.inf])
@pytest.mark.parametrize("share", [0.0, 0.3])
def test_no_node_is_lost_whatever_ends_the_search(most, share):
    for seed in range(100):
        rng = np.random.default_rng([seed, 65])
        values = rng.integers(0, 40, int(rng.integers(1, 40))).astype(float)
        assert searched(values, most, lambda rng=rng: rng.random() < share)[0] == values.min()


def test_the_least_bound_comes_first_and_the_node_in_hand_counts():
    nodes = OpenNodes([Part(float(k), k, 0, 1) for k in (3, 1, 2)])
    assert nodes.take().bound == 1
    assert nodes.bound == 1
    assert nodes.take().bound == 1  # it is still in hand
    nodes.raise_bound(Part(2.5, 9, 0, 1))
    assert nodes.bound == 2
    nodes.done()
    assert [len(nodes), nodes.take().bound] == [2, 2]
    nodes.clear()
    assert not nodes


def test_beyond_the_most_the_last_child_comes_first_and_all_count():
    nodes = OpenNodes([Part(0.0, 0, 0, 1)], most=0)
    nodes.take()
    nodes.keep([Part(7.0, 1, 0, 1), Part(5.0, 2, 0, 1), Part(9.0, 3, 0, 1)])
    nodes.done()
    assert nodes.bound == 5
    assert nodes.take().bound == 9
    nodes.done()
    nodes.prune(lambda part: part.bound == 5)
    assert [part.bound for part in nodes] == [7]
