"""Whole instances: the three steps that fail, replayed from their definitions; requirements against all attacks."""

from collections.abc import Callable, Iterator
from itertools import combinations, product

import pytest

from ratt_audit.appendix.entry import ClaimEntry, EntryKind, entries_of
from ratt_audit.appendix.patterns import pattern1_chains, submodular_chains
from ratt_audit.appendix.roles import Side
from ratt_audit.engine.decide import Verdict, decide
from ratt_audit.whole.recorded import rechecked, recorded_lines
from ratt_audit.whole.replay import WholeInstance
from ratt_audit.whole.search import WholeSearch, decide_team, ordered_teams, smallest_instance
from ratt_audit.whole.teams import whole_teams
from ratt_audit.whole_lines import whole_instance
from ratt_opt import InputError, ProofError, TableFunction, find_monotonicity_violation, find_submodularity_violation

CHAINS = {chain.name: chain for chain in (*pattern1_chains(), *submodular_chains())}


def step(label: str) -> ClaimEntry:
    chain = label.rsplit("_", 1)[0]
    entries = entries_of(CHAINS[chain])
    return next(entry for entry in entries if entry.label == label and entry.kind is EntryKind.STEP)


def partitions(robots: list[int]) -> Iterator[list[list[int]]]:
    if not robots:
        yield []
        return
    first, rest = robots[0], robots[1:]
    for parts in partitions(rest):
        yield [[first], *parts]
        for i in range(len(parts)):
            yield [*parts[:i], [first, *parts[i]], *parts[i + 1 :]]


def worst_case(found: WholeInstance, plan: list[int]) -> int:
    """Every partition of the complete graph within the budget, every choice of blinded robots; integers only."""
    whole, n = found.whole, len(plan)
    attacks = (
        (groups, blinded)
        for groups in partitions(list(range(n)))
        if sum(len(a) * len(b) for a, b in combinations(groups, 2)) <= whole.alpha_c
        for blinded in combinations(range(n), whole.alpha_s)
    )
    return min(
        max(found.values[sum(1 << plan[r] for r in group if r not in blinded)] for group in groups)
        for groups, blinded in attacks
    )


def value_under(found: WholeInstance, plan: tuple[int, ...]) -> int:
    names = found.whole.team.robots
    return max(found.values[sum(1 << plan[names.index(r)] for r in left)] for left in found.whole.left)


def check_is_whole(found: WholeInstance) -> None:
    """RATT's rules, the optimum and A* by enumeration written here."""
    n = len(found.plan)
    single = [found.values[1 << e] for e in range(2 * n)]
    baits = sorted(range(n), key=lambda i: (-max(single[i], single[n + i]), i))[: len(found.bait)]
    assert sorted(baits) == sorted(found.bait)
    chosen = {i: min((i, n + i), key=lambda e: (-single[e], e)) for i in baits}
    taken = 0
    while len(chosen) < n:
        rest = [e for e in range(2 * n) if e % n not in chosen]
        best = min(rest, key=lambda e: (-found.values[taken | 1 << e], e))
        taken |= 1 << best
        chosen[best % n] = best
    assert tuple(chosen[i] for i in range(n)) == found.plan
    plans = [[i + n * c for i, c in enumerate(choice)] for choice in product((0, 1), repeat=n)]
    optimum = max(worst_case(found, plan) for plan in plans)
    assert worst_case(found, list(found.optimal)) == optimum == found.optimum
    attacked = found.plan if found.worst_for is Side.RATT else found.optimal
    assert value_under(found, attacked) == worst_case(found, list(attacked))
    function = TableFunction([float(v) for v in found.values])
    assert find_monotonicity_violation(function) is None


@pytest.mark.parametrize(
    ("label", "smaller", "team", "side"),
    [
        ("nd_p1d2v1_8", (3, 1, 2), (4, 1, 4), Side.OPTIMUM),
        pytest.param("nd_p1d2v1_8", (3, 1, 2), (4, 1, 4), Side.RATT, marks=pytest.mark.slow),
        ("sub_p2d1v1_10", None, (4, 1, 4), Side.RATT),
        ("sub_p2d1v1_10", None, (4, 1, 4), Side.OPTIMUM),
    ],
)
def test_a_step_that_fails_does_so_in_a_whole_instance(
    label: str, smaller: tuple[int, int, int] | None, team: tuple[int, int, int], side: Side
) -> None:
    entry = step(label)
    broken = [sized for sized in entry.claims if decide(sized.claim).verdict is Verdict.REFUTED]
    decided = smallest_instance(entry.chain, broken, side, WholeSearch(largest=4))
    found = decided[-1].instance
    assert found is not None
    assert found.whole.size == team
    check_is_whole(found)
    if smaller is not None:
        assert (smaller, Verdict.PROVED) in [(each.whole.size, each.verdict) for each in decided]
    if entry.claims[0].claim.function_class.is_submodular:
        assert find_submodularity_violation(found.problem().objective) is None


def test_a_greedy_robot_blinded_in_the_third_distribution_breaks_its_sixth_line() -> None:
    """Four robots are enough if A* is the optimum's worst attack."""
    entry = step("nd_p1d3v1_6")
    broken = [sized for sized in entry.claims if decide(sized.claim).verdict is Verdict.REFUTED]
    decided = smallest_instance(entry.chain, broken, Side.OPTIMUM, WholeSearch(largest=4))
    found = decided[-1].instance
    assert found is not None
    assert found.whole.size == (4, 2, 3)
    check_is_whole(found)


FAILING = ("nd_p1d2v1_8", "nd_p1d3v1_6", "sub_p2d1v1_10")


@pytest.mark.parametrize("side", list(Side))
@pytest.mark.parametrize("label", FAILING)
def test_the_recorded_instances_are_whole(label: str, side: Side) -> None:
    check_is_whole(whole_instance(label, side))


@pytest.mark.parametrize(
    ("spoil", "fault"),
    [
        (lambda v: v[:-1], "15 values|values for"),
        (lambda v: [0] * len(v), "does not break the claim"),
        (lambda v: [-x for x in v], "."),
        (lambda v: [*v[:-1], v[-1] * 9], "."),
    ],
)
def test_a_recorded_instance_that_is_none_is_refused(spoil: Callable[[list[int]], list[int]], fault: str) -> None:
    sized = step("sub_p2d1v1_10").claims[0]
    line = next(r for r in recorded_lines() if (r["label"], r["worst_for"]) == ("sub_p2d1v1_10", Side.RATT.value))
    (team,) = [w for _, w in ordered_teams("sub_p2d1v1", [sized], 5) if w.text() == line["teams"][-1][0]]
    values = line["values"]
    assert values is not None
    rechecked(sized, team, Side.RATT, values, WholeSearch())
    with pytest.raises(ProofError, match=fault):
        rechecked(sized, team, Side.RATT, spoil(values), WholeSearch())


def test_of_other_lines_no_instance_is_known() -> None:
    for label in ("nd_p1d1v1_1", "no such line"):
        with pytest.raises(InputError, match="label must be of a line with a known whole instance"):
            whole_instance(label, Side.RATT)


def test_each_line_that_fails_is_recorded_for_both_attacks() -> None:
    sides = {label: {r["worst_for"] for r in recorded_lines() if r["label"] == label} for label in FAILING}
    assert sides == {label: {side.value for side in Side} for label in FAILING}


@pytest.mark.slow
def test_the_sixth_line_fails_for_the_plans_worst_attack_at_five_robots() -> None:
    entry = step("nd_p1d3v1_6")
    sized = entry.claims[0]
    teams = (whole for whole in whole_teams(entry.chain, sized, largest=5) if whole.size == (5, 2, 6))
    found = decide_team(sized, next(teams), Side.RATT, WholeSearch()).instance
    assert found is not None
    check_is_whole(found)


def test_whole_teams_have_the_attack_within_their_budgets() -> None:
    for label in ("nd_p1d1v1_8", "nd_p1d3v1_6", "sub_p2d1v1_10", "nd_p1d1vk_3", "sub_p2vk_3"):
        entry = step(label)
        teams = [whole for sized in entry.claims for whole in whole_teams(entry.chain, sized, largest=6)]
        assert teams, label
        for whole in teams:
            robots = [r for group in whole.groups for r in group]
            assert sorted(robots) == sorted(whole.team.robots)
            assert len(whole.blinded) == whole.alpha_s
            assert sum(len(a) * len(b) for a, b in combinations(whole.groups, 2)) <= whole.alpha_c
