"""The one budget: what is spent, by whom, and who hears of an interrupt."""

import math

import pytest

from ratt_opt import InputError, Stop
from ratt_opt.budget import Budget, OutOfBudget


def test_without_limits_nothing_stops():
    budget = Budget()
    budget.spend(10**9)
    assert budget.stop() is None
    assert budget.seconds_left == math.inf
    assert budget.nodes_left(7) == 7


def test_zero_seconds_are_spent_at_once():
    assert Budget(time_limit=0).stop() is Stop.TIME
    with pytest.raises(OutOfBudget) as signal:
        Budget(time_limit=0).check()
    assert signal.value.stop is Stop.TIME


def test_nodes_are_counted_and_refused_when_none_is_left():
    budget = Budget(max_nodes=3)
    budget.spend(2)
    assert budget.nodes_left(5) == 1
    budget.spend()
    assert budget.stop() is Stop.NODES
    budget.check()  # time and interrupts only
    with pytest.raises(OutOfBudget) as signal:
        budget.spend()
    assert signal.value.stop is Stop.NODES
    assert budget.nodes == 3


def test_a_part_takes_a_share_of_the_seconds_and_nodes_of_its_own():
    outer = Budget(time_limit=100.0, max_nodes=1)
    outer.spend()
    inner = outer.part(0.25)
    assert inner.stop() is None
    assert 24 < inner.seconds_left <= 25
    assert Budget.inside(outer, 5.0).seconds_left <= 5
    assert Budget.inside(outer, 500.0).seconds_left <= 100
    assert outer.part(0.0, at_least=1e6).seconds_left <= 100


@pytest.mark.parametrize("inner_first", [True, False])
def test_an_interrupt_is_heard_by_the_search_and_all_around_and_inside_it(inner_first):
    outer = Budget()
    middle = outer.part()
    inner = middle.part()
    (inner if inner_first else outer).interrupt()
    assert [b.stop() for b in (outer, middle, inner, inner.part())] == [Stop.INTERRUPTED] * 4
    with pytest.raises(OutOfBudget) as signal:
        middle.check()
    assert signal.value.stop is Stop.INTERRUPTED


@pytest.mark.parametrize(
    "limits",
    [
        {"time_limit": -1},
        {"time_limit": math.nan},
        {"time_limit": "1"},
        {"time_limit": True},
        {"max_nodes": -1},
        {"max_nodes": 1.5},
    ],
)
def test_limits_that_are_no_numbers_from_zero_are_refused(limits):
    with pytest.raises(InputError, match=r"time_limit|max_nodes"):
        Budget(**limits)


def test_a_stage_takes_a_share_of_all_and_its_nodes_count_for_the_whole():
    whole = Budget(time_limit=100.0, max_nodes=50)
    whole.spend(10)
    with whole.stage(0.5) as part:
        assert 49 < part.seconds_left <= 50
        part.spend(15)
        part.spend(5)
        part.spend()  # the 21st of half of forty
        pytest.fail("a stage has no more nodes than its share")
    assert (part.nodes, whole.nodes, whole.stop()) == (20, 30, None)
    with whole.stage(max_nodes=7) as part:
        assert part.nodes_left(100) == 7
    with whole.stage(max_nodes=700) as part:
        assert part.nodes_left(100) == 20


def test_after_a_stage_that_used_up_the_whole_nothing_goes_on():
    whole = Budget(max_nodes=3)
    with whole.stage() as part:
        part.spend(3)
    assert whole.stop() is Stop.NODES
    with pytest.raises(OutOfBudget), whole.stage():
        pytest.fail("a stage begins without nodes")


def test_an_interrupt_within_a_stage_ends_what_is_around_it():
    whole = Budget()
    with pytest.raises(OutOfBudget) as signal, whole.stage() as part:
        part.interrupt()
    assert signal.value.stop is whole.stop() is Stop.INTERRUPTED


def test_an_error_within_a_stage_is_not_taken_for_its_end():
    whole = Budget()
    with pytest.raises(InputError), whole.stage() as part:
        part.nodes += len([Budget(max_nodes=2), Budget(max_nodes=-1)])
    assert whole.nodes == 0
    with pytest.raises(InputError), whole.stage(max_nodes=-1):
        pytest.fail("a stage of a negative number of nodes begins")
