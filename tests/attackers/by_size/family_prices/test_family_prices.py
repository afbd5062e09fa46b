"""Prices of families never claim more than the worst case; bounds on sets of one size, and who pays, by all sets."""

from __future__ import annotations

from contextlib import suppress
from itertools import combinations
from math import comb

import numpy as np
import pytest

from ratt_opt import Attack, Problem, Stop, worst_case_attack
from ratt_opt.attackers.by_size import annealed_families, size_vector_search, weak_families
from ratt_opt.attackers.by_size.family_prices import family_search, paying_tree, set_finder, threshold_bound
from ratt_opt.attackers.by_size.family_prices.annealed_sets import annealed_of_size, annealed_sets
from ratt_opt.attackers.by_size.family_prices.family_program import FamilyPrices, FamilyProgram
from ratt_opt.attackers.by_size.family_prices.family_search import FamilySearch
from ratt_opt.attackers.by_size.family_prices.paying_sets import PayingSets, Question
from ratt_opt.attackers.by_size.family_prices.set_finder import SetFinder
from ratt_opt.attackers.by_size.family_prices.size_vectors import SizeVectors
from ratt_opt.attackers.by_size.family_prices.threshold_bound import ThresholdBound, _Verdict
from ratt_opt.attackers.task import AttackBracket, AttackTask, PlanValues
from ratt_opt.attackers.weakest_set.packed_team import PackedTeam
from ratt_opt.attackers.weakest_set.pair_bound import fill_pairs, mean_of_least, views, weakest_bound
from ratt_opt.budget import Budget, OutOfBudget
from ratt_opt.graph.survivor_sizes import non_dominated_sizes
from tests.brackets import worst_value
from tests.oracles import brute_force_worst_case
from tests.strategies import OBJECTIVES, information_data

N_ROBOTS = 9
EVERYONE = np.arange(N_ROBOTS)


def make_team(name, seed, n_robots=N_ROBOTS):
    objective = OBJECTIVES[name](*information_data(np.random.default_rng(seed), n_robots, 3))
    return PackedTeam.planar(objective, np.arange(n_robots))


def problems(name, count, n_robots=N_ROBOTS):
    """Attacks that leave several groups: few blinded, most links cut."""
    for seed in range(count):
        rng = np.random.default_rng([seed, 7])
        objective = OBJECTIVES[name](*information_data(rng, n_robots, 3))
        links = comb(n_robots, 2)
        budgets = int(rng.integers(0, 4)), int(rng.integers(links // 2, links - 2))
        must = frozenset(rng.choice(n_robots, int(rng.integers(0, 2)), replace=False).tolist())
        yield Problem(objective, np.arange(n_robots), None, *budgets, protected_robots=must)


def as_row(robots):
    return np.isin(EVERYONE, list(robots))


@pytest.mark.parametrize("name", OBJECTIVES)
def test_pairs_bound_all_sets_with_their_prices(name):
    for seed in range(4):
        team, rng = make_team(name, seed), np.random.default_rng(seed)
        prices = rng.normal(size=N_ROBOTS)
        inside, others = frozenset(range(seed)), np.arange(seed, N_ROBOTS)
        for size in range(2, len(others) + 1):
            sets = list(combinations(others.tolist(), size))
            true = min(team.value({*inside, *one}) - prices[list(one)].sum() for one in sets)
            claims = []
            for view in views(team):
                pairs, least = np.empty((N_ROBOTS, N_ROBOTS)), np.empty(N_ROBOTS)
                sums = view.prior + view.information[sorted(inside)].sum(axis=0)
                fill_pairs(view, sums, others, size, pairs)
                claims.append(mean_of_least(pairs, prices[others], len(others), size, least))
            assert min(claims) <= true + 1e-9
            if size == 2:
                assert min(claims) >= true - 1e-9  # a pair is its own average
            weakest = min(weakest_bound(view, size) for view in views(team))
            assert weakest <= min(team.value(one) for one in combinations(range(N_ROBOTS), size)) + 1e-9


@pytest.mark.parametrize("by_minorants", [False, True])
@pytest.mark.parametrize("name", OBJECTIVES)
def test_who_pays_is_found_or_ruled_out(name, by_minorants, monkeypatch):
    """By all sets; with minorants before pairs of robots are given more than a node, too."""
    monkeypatch.setattr(paying_tree, "FAR", np.inf)
    if by_minorants:
        for constant, value in {
            "FIRST_TRIED": 1,
            "SHARPER": (np.inf, np.inf),
            "TRIED": 1,
            "FEWEST": 1,
            "MOST": 1,
        }.items():
            monkeypatch.setattr(paying_tree, constant, value)
    answers = set()
    for seed in range(12):
        team, rng = make_team(name, seed), np.random.default_rng([seed, 1])
        prices, threshold = rng.normal(size=N_ROBOTS), float(rng.uniform(0.3, 1.0)) * team.value(EVERYONE)
        sets = PayingSets(team)
        asked = list(sets.sizes(threshold, N_ROBOTS))
        for size in range(1, N_ROBOTS + 1):
            weak = [one for one in combinations(range(N_ROBOTS), size) if team.value(one) < threshold]
            if size not in asked:
                assert not weak
                continue
            most = max((prices[list(one)].sum() for one in weak), default=0.0)
            for limit in (most - 0.2, most + 1e-6):
                question = Question(threshold, prices, float(limit))
                found = sets.of_size(question, size, Budget(), 10**6)
                assert found.is_complete == (not found.found) == (not weak or limit > most)
                answers.add(found.is_complete)
                for members in found.found:
                    assert members.sum() == size
                    assert prices[members].sum() > limit
                    assert team.value(np.flatnonzero(members)) < threshold * (1 + 1e-12)
    assert answers == {False, True}


def test_a_search_cut_short_says_so():
    team = make_team("logdet", 0)
    threshold, sets = 0.9 * team.value(EVERYONE), PayingSets(team)
    size = max(sets.sizes(threshold, N_ROBOTS)) // 2
    question = Question(threshold, np.zeros(N_ROBOTS), -1e-9)  # every weak set pays
    budget = Budget()
    assert not sets.of_size(question, size, budget, 1).is_complete
    assert budget.nodes in {1, paying_tree.MINORANT_NODES}
    with pytest.raises(OutOfBudget):
        sets.of_size(question, size, Budget(max_nodes=0), 10)


@pytest.mark.parametrize("name", ["trace", "logdet"])
def test_sets_left_open_are_worth_what_is_said(name, monkeypatch):
    for constant, value in {"FIRST_TRIED": 1, "SHARPER": (np.inf, np.inf), "TRIED": 1, "FEWEST": 1, "MOST": 1}.items():
        monkeypatch.setattr(paying_tree, constant, value)
    bounds, gone_on = 0, 0
    for seed in range(12):
        team, rng = make_team(name, seed), np.random.default_rng([seed, 2])
        prices, threshold, sets = rng.normal(size=N_ROBOTS), 0.95 * team.value(EVERYONE), PayingSets(team)
        for size in set(sets.sizes(threshold, N_ROBOTS)) & {4, 5}:
            paid = {one: prices[list(one)].sum() for one in combinations(range(N_ROBOTS), size)}
            limit = float(np.quantile(list(paid.values()), 0.9))
            weakest = min(team.value(one) for one, price in paid.items() if price > limit)
            question = Question(min(threshold, weakest + 1e-9), prices, limit)
            for nodes in (60, 120, 240):
                left = sets.of_size(question, size, Budget(), nodes)
                assert left.lower <= weakest + 1e-9 or left.lower == np.inf
                assert left.found or left.lower < np.inf or question.threshold <= weakest + 2e-9
                bounds += np.isfinite(left.lower)
            turns = [sets.of_size(question, size, Budget(), 60)]
            while not turns[-1].found and turns[-1].lower < np.inf:
                turns.append(sets.of_size(question, size, Budget(), 60, goes_on=True))
                assert turns[-1].found or turns[-2].lower <= turns[-1].lower <= weakest + 1e-9 or turns[-1].is_complete
            assert turns[-1].found or question.threshold <= weakest + 2e-9
            gone_on += len(turns) > 2
    assert bounds > 3
    assert gone_on > 0


@pytest.mark.parametrize("name", ["trace", "logdet"])
def test_what_is_proved_of_all_sizes_holds_however_a_search_ends(name, monkeypatch):
    """Of sets that pay prices of robots and sizes, cut short by nodes of a size and by nodes of the budget."""
    for constant, value in {"FAR": 0.0, "SHARPER": (-np.inf, -np.inf), "TRIED": 1, "FEWEST": 1, "MOST": 1}.items():
        monkeypatch.setattr(paying_tree, constant, value)
    monkeypatch.setattr(set_finder, "FIRST_TURN", 60)
    monkeypatch.setattr(set_finder, "TURN", 60)
    proved, ends = 0, set()
    for seed in range(48):
        team, rng = make_team(name, seed), np.random.default_rng([seed, 3])
        threshold, robots = float(rng.uniform(0.5, 0.95)) * team.value(EVERYONE), rng.normal(size=N_ROBOTS)
        sets = [one for size in range(1, N_ROBOTS + 1) for one in combinations(range(N_ROBOTS), size)]
        paid, values = np.array([robots[list(one)].sum() for one in sets]), np.array([team.value(one) for one in sets])
        sizes = np.array([len(one) for one in sets])
        of_size = [paid[(sizes == size) & (values < 0.8 * threshold)] for size in range(N_ROBOTS + 1)]
        limits = np.array([pays.max(initial=0.0) + 1e-6 for pays in of_size])
        weakest = values[paid > limits[sizes]].min(initial=np.inf)
        prices = FamilyPrices(robots=robots, limits=limits, claim=1.0, n_seeing=N_ROBOTS)
        for most, nodes in ((10**6, 10**6), (10**6, 120), (2_000, 10**6)):
            finder = SetFinder(team, N_ROBOTS)
            with suppress(OutOfBudget):
                found = finder.decided(threshold, prices, nodes, Budget(max_nodes=most))
                assert all(values[k] < threshold * (1 + 1e-12) for k in places(found.found, sets))
                assert not (found.is_complete and weakest < threshold * (1 - 1e-12))
                ends.add(found.is_complete)
            assert min(finder.proved, threshold) <= weakest + 1e-9
            proved += np.isfinite(finder.proved) and finder.proved > 0
    assert proved > 3
    assert ends == {False, True}


def places(found, sets):
    return [sets.index(tuple(np.flatnonzero(members).tolist())) for members in found]


def test_a_goal_out_of_reach_is_asked_once(monkeypatch):
    """Where only the goal is left to ask, and prices claim nothing there: of links, of seven robots alike."""
    asked, plain = [], ThresholdBound._decide

    def decide(self, threshold, *arguments):
        asked.append(threshold)
        assert len(asked) == 1
        return plain(self, threshold, *arguments)

    monkeypatch.setattr(ThresholdBound, "_decide", decide)
    prior, information = information_data(np.random.default_rng(0), 1, 3)
    objective = OBJECTIVES["logdet"](prior, np.repeat(information, 7, axis=0))
    problem, team = Problem(objective, np.arange(7), None, 0, 14), PackedTeam.planar(objective, np.arange(7))
    bracket = AttackBracket(Attack(), team.value(range(4)), (1 - 1e-5) * team.value(range(4)))
    ThresholdBound(team, problem.threat).run(bracket, Budget())
    assert asked == [bracket.goal]
    assert not bracket.is_closed


@pytest.mark.parametrize(("name", "share"), [("logdet", 1 - threshold_bound.WIDE), ("maxeig", 0.75)])
def test_what_is_promised_is_asked_first_and_then_what_is_in_reach(name, share, monkeypatch):
    """Half of what is left where searches are quick; with prices that reach nine tenths of the attack."""
    asked = []

    def decide(_, threshold, aim, *_others):
        asked.append(threshold)
        assert aim >= threshold
        return _Verdict.REFUTED if aim <= 90.0 else _Verdict.OUT_OF_REACH

    monkeypatch.setattr(ThresholdBound, "_decide", decide)
    problem = Problem(make_team(name, 1).objective, np.arange(N_ROBOTS), None, 0, 14)
    bracket = AttackBracket(Attack(), 100.0, 50.0)
    ThresholdBound(make_team(name, 1), problem.threat).run(bracket, Budget())
    assert asked[0] == pytest.approx(100 * share)
    assert all(threshold > 50 for threshold in asked)
    assert 90 - 3 * threshold_bound.NEAR * 100 <= bracket.lower <= 90


@pytest.mark.parametrize("name", OBJECTIVES)
def test_annealed_sets_are_weak_and_pay_what_they_say(name):
    team, rng = make_team(name, 2), np.random.default_rng(2)
    prices, links = rng.normal(size=N_ROBOTS), np.arange(N_ROBOTS + 1.0) ** 2 / 10
    threshold, count = 0.6 * team.value(EVERYONE), 0
    for view in views(team):
        for members, paid in annealed_sets(view, threshold, prices, links, 200, rng, Budget()):
            assert paid == pytest.approx(prices[members].sum() + links[members.sum()])
            assert team.value(np.flatnonzero(members)) < threshold * (1 + 1e-12)
            count += 1
    assert count >= (team.single < threshold).sum() > 0  # one with each weak robot


@pytest.mark.parametrize("name", ["trace", "logdet"])
def test_annealed_sets_of_a_size_stay_weak_and_pay_most(name):
    dearest = 0
    for seed in range(10):
        team, rng = make_team(name, seed), np.random.default_rng(seed)
        prices, (view,) = rng.normal(size=N_ROBOTS), views(team)
        sets = sorted(combinations(range(N_ROBOTS), 4), key=team.value)
        threshold = team.value(sets[len(sets) // 4])
        members = annealed_of_size(view, threshold, prices, as_row(sets[0]), 2_000, rng)
        weak = [prices[list(one)].sum() for one in sets if team.value(one) < threshold]
        assert members.sum() == 4
        assert team.value(np.flatnonzero(members)) < threshold * (1 + 1e-12)
        dearest += prices[members].sum() >= max(weak) - 1e-9
        assert prices[members].sum() >= prices[list(sets[0])].sum()
    assert dearest >= 7


@pytest.mark.parametrize("name", OBJECTIVES)
def test_prices_of_all_weak_sets_claim_nothing_of_what_attacks_reach(name):
    refuted = {True: 0, False: 0}
    for problem in problems(name, 12, n_robots=5):
        team = PackedTeam.planar(problem.objective, np.arange(5))
        worst = brute_force_worst_case(problem, np.arange(5))
        for share in (0.7, 0.999, 1.001):
            claims = {}
            for has_vectors in (False, True):
                vectors = SizeVectors(5, vectors_of(problem)) if has_vectors else None
                program = FamilyProgram(problem.threat, vectors)
                for size in range(1, 6):
                    for one in combinations(range(5), size):
                        program.add(np.isin(np.arange(5), one), team.value(one))
                prices = program.solve(share * worst)
                assert prices is not None
                claims[has_vectors] = prices.claim
                refuted[has_vectors] += prices.claim > 1e-3
                if share > 1:
                    assert prices.claim <= 1e-6
            assert claims[True] > 1e-3 or not claims[False] > 1e-3  # prices of sizes say no less
    assert refuted[True] >= refuted[False] > 0


def test_prices_of_sizes_know_that_no_vector_is_a_mixture():
    """Of seven robots alike, sevenths of groups of three keep seven links; groups keep six, unless one has four."""
    prior, information = information_data(np.random.default_rng(0), 1, 3)
    objective = OBJECTIVES["logdet"](prior, np.repeat(information, 7, axis=0))
    problem, team = Problem(objective, np.arange(7), None, 0, 14), PackedTeam.planar(objective, np.arange(7))
    threshold = (team.value(range(3)) + team.value(range(4))) / 2
    claims = []
    for vectors in (None, SizeVectors(7, vectors_of(problem))):
        program = FamilyProgram(problem.threat, vectors)
        for size in range(1, 8):
            for one in combinations(range(7), size):
                program.add(np.isin(np.arange(7), one), team.value(one))
        claims.append(program.solve(threshold).claim)
    assert claims[0] == pytest.approx(0)
    assert claims[1] > 0.1


def test_a_program_is_divided_where_a_relaxed_attack_mixes_vectors():
    """Both parts know the same sets, and claim at least as much; together they have all vectors."""
    divided = 0
    for problem in problems("logdet", 16):
        vectors, team = vectors_of(problem), PackedTeam.planar(problem.objective, EVERYONE)
        program = FamilyProgram(problem.threat, SizeVectors(N_ROBOTS, vectors))
        for size in range(1, N_ROBOTS + 1):
            for one in combinations(range(N_ROBOTS), size):
                program.add(np.isin(EVERYONE, one), team.value(one))
        worst = worst_value(problem, EVERYONE)
        for share in (0.95, 0.97, 0.99, 1.01):
            whole = program.solve(share * worst)
            parts = program.divided()
            claims = [part.solve(share * worst).claim for part in parts]
            divided += len(parts) == 2
            assert min(claims, default=whole.claim) >= whole.claim - 1e-6
            assert share < 1 or min(claims, default=whole.claim) <= 1e-6
    assert divided > 0


def test_vectors_of_sizes_cost_what_their_groups_do():
    vectors = [(4, 2, 1), (3, 3, 1), (5, 1, 1)]
    sizes, rng = SizeVectors(7, vectors), np.random.default_rng(0)
    largest, other = rng.normal(size=8), rng.normal(size=8)
    costs = sizes.costs(largest, other)
    for k, (first, *others) in enumerate(vectors):
        assert costs[k] == pytest.approx(largest[first] + other[others].sum())
        assert sizes.vector(k)[0] == first
        assert np.repeat(np.arange(8), sizes.vector(k)[1].astype(int)).tolist() == sorted(others)
    first, others = sizes.divided(1)
    assert [*first.costs(largest, other), *others.costs(largest, other)] == pytest.approx(costs)
    roles = {size: sizes.roles(size) for size in range(8)}
    assert roles == {0: (), 1: (False,), 2: (False,), 3: (False, True), 4: (True,), 5: (True,), 6: (), 7: ()}


def vectors_of(problem):
    return non_dominated_sizes(problem.n_robots, problem.threat.n_blinded, problem.alpha_c)


def bounded(problem, budget, vectors=None):
    """The lower end by prices alone, from no attack at all."""
    team = PackedTeam.planar(problem.objective, np.arange(problem.n_robots))
    bracket = AttackBracket(Attack(), problem.team_value(np.arange(problem.n_robots), Attack()), 0.0)
    try:
        ThresholdBound(team, problem.threat, vectors).run(bracket, budget)
    except OutOfBudget:
        assert budget.stop() is not None
    return bracket.lower


@pytest.mark.parametrize("name", OBJECTIVES)
def test_refuted_thresholds_are_below_the_worst_case(name):
    near = {False: [], True: []}
    for problem in problems(name, 5):
        worst = worst_value(problem, EVERYONE)
        for has_vectors, shares in near.items():
            lower = bounded(problem, Budget(max_nodes=20_000), vectors_of(problem) if has_vectors else None)
            assert lower <= worst + 1e-9 * abs(worst)
            shares.append(lower / worst if worst > 0 else 1.0)
    assert max(near[False]) > 0.97
    assert min(near[False]) > 0.5
    assert np.mean(near[True]) >= np.mean(near[False])
    assert max(near[True]) > 1 - 2 * threshold_bound.NEAR


@pytest.mark.parametrize("name", OBJECTIVES)
def test_thresholds_refuted_in_parts_are_below_the_worst_case(name, monkeypatch):
    """What claims less than twenty links counts as out of reach, and is divided."""
    monkeypatch.setattr(threshold_bound, "CLAIM", 20.0)
    monkeypatch.setattr(threshold_bound, "NARROW", np.inf)
    parts, plain = [], FamilyProgram.divided

    def divided(self, seconds):
        parts.append(plain(self, seconds))
        return parts[-1]

    monkeypatch.setattr(FamilyProgram, "divided", divided)
    for problem in problems(name, 20):
        worst = worst_value(problem, EVERYONE)
        assert bounded(problem, Budget(max_nodes=20_000), vectors_of(problem)) <= worst + 1e-9 * abs(worst)
    assert any(parts)


@pytest.mark.parametrize("name", OBJECTIVES)
def test_prices_of_sizes_close_on_the_worst_attack(name):
    closed, count = 0, 6
    for problem in problems(name, count):
        worst = worst_case_attack(problem, EVERYONE)
        team = PackedTeam.planar(problem.objective, EVERYONE)
        bracket = AttackBracket(worst.attack, worst.upper, 0.0, problem.objective.rounding)
        with suppress(OutOfBudget):
            ThresholdBound(team, problem.threat, vectors_of(problem)).run(bracket, Budget(max_nodes=20_000))
        assert bracket.lower <= worst.upper
        closed += bracket.is_closed
    assert closed >= count / 2


def test_wherever_it_ends_the_bound_holds():
    problem = next(problems("logdet", 1))
    worst = worst_value(problem, EVERYONE)
    lowers = [bounded(problem, Budget(max_nodes=nodes)) for nodes in (0, 1, 3, 10, 30, 100)]
    assert lowers == sorted(lowers)
    assert lowers[-1] <= worst
    assert bounded(problem, Budget(time_limit=0)) == 0.0


@pytest.mark.parametrize("name", OBJECTIVES)
def test_with_time_left_a_search_of_all_families_goes_on(name, monkeypatch):
    monkeypatch.setattr(annealed_families, "FIRST_MOVES", annealed_families.CHUNK)
    monkeypatch.setattr(threshold_bound, "FIRST_MOVES", 100)
    monkeypatch.setattr(size_vector_search, "MOST_VECTORS", 0)
    n_robots, rng = 14, np.random.default_rng(3)
    objective = OBJECTIVES[name](*information_data(rng, n_robots, 3))
    problem = Problem(objective, np.arange(n_robots), None, 1, 65)
    worst = worst_value(problem, np.arange(n_robots))
    values = PlanValues(problem, np.arange(n_robots))
    bracket = AttackBracket(Attack(), problem.team_value(values.plan, Attack()), 0.0)
    task = AttackTask(problem, values, bracket, Budget(time_limit=0.5))
    try:
        stop = FamilySearch(task, PackedTeam.planar(objective, values.plan), []).run()
    except OutOfBudget as out:
        stop = out.stop
    assert stop in {Stop.CLOSED, Stop.TIME}
    assert bracket.lower <= worst <= bracket.upper * (1 + 1e-12)


def test_all_vectors_make_attacks_if_there_is_time():
    vectors = non_dominated_sizes(60, 17, 1226)
    spread = weak_families._spread(vectors)
    assert sorted(spread) == sorted(vectors)
    assert len(vectors) > 2 * weak_families.STRIDE
    few = {sizes[0] for sizes in spread[: len(vectors) // weak_families.STRIDE]}
    assert min(few) < np.median([sizes[0] for sizes in vectors]) < max(few)


def test_prices_know_vectors_unless_they_are_too_many(monkeypatch):
    problem = next(one for one in problems("logdet", 20) if len(vectors_of(one)) > 3)
    vectors, team = vectors_of(problem), make_team("logdet", 0)
    few = len(vectors) - 1
    for most, seconds, known in ((few + 1, None, vectors), (few, None, None), (few + 1, 0.0, None)):
        monkeypatch.setattr(size_vector_search, "MOST_VECTORS", 1)
        monkeypatch.setattr(size_vector_search, "PRICED_SIZES", most * N_ROBOTS)
        bracket = AttackBracket(Attack(), 1.0, 0.0)
        task = AttackTask(problem, PlanValues(problem, EVERYONE), bracket, Budget(seconds))
        search = size_vector_search.SizeVectorSearch(task, team)
        assert not search.has_all_vectors
        assert search._priced_vectors() == known


def test_prices_are_not_asked_of_very_large_teams(monkeypatch):
    problem = next(problems("trace", 1))
    values = PlanValues(problem, EVERYONE)
    bracket = AttackBracket(Attack(), problem.team_value(EVERYONE, Attack()), 0.0)
    search = FamilySearch(AttackTask(problem, values, bracket, Budget()), make_team("trace", 0), [])
    monkeypatch.setattr(family_search, "LARGEST", N_ROBOTS - 1)
    search.narrow()
    assert bracket.lower == 0.0
