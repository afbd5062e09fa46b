"""Every guarantee against what RATT really keeps, on small problems solved by enumeration."""

import copy
import json
import pickle
import re
from dataclasses import FrozenInstanceError, asdict, replace
from pathlib import Path

import numpy as np
import pytest

import ratt_opt as ro
from tests.strategies import monotone_table, random_graph, random_objective


def submodular(rng, n):
    family = str(rng.choice(["coverage", "matroid rank", "facility location", "concave of modular"]))
    return ro.reference(family, n, rng).function


def random_problem(rng, *, submodular_only):
    robots = int(rng.integers(2, 5))
    owners = np.sort(np.concatenate([np.arange(robots), rng.integers(0, robots, int(rng.integers(0, 3)))]))
    n = len(owners)
    if submodular_only:
        f = submodular(rng, n) if rng.random() < 0.7 else random_objective(rng, n, "logdet")
    else:
        f = random_objective(rng, n) if rng.random() < 0.6 else ro.TableFunction(monotone_table(rng, n))
    graph = random_graph(rng, robots) if rng.random() < 0.5 else None
    links = robots * (robots - 1) // 2 if graph is None else graph.number_of_edges()
    return ro.Problem(f, owners, graph, int(rng.integers(0, robots)), int(rng.integers(0, links + 1)))


def kept(problem, elements, best):
    return ro.worst_case_attack(problem, elements).upper / best


@pytest.mark.parametrize("submodular_only", [False, True])
def test_ratt_keeps_every_guarantee_and_any_plan_its_own(submodular_only):
    rng = np.random.default_rng([7, submodular_only])
    useful = 0
    for _ in range(250):
        problem = random_problem(rng, submodular_only=submodular_only)
        best = ro.exhaustive_optimum(problem).upper
        alpha_cs = ro.ratt(problem).alpha_cs
        kind = ro.curvature if submodular_only else ro.total_curvature
        found = kind(problem.objective, problem.robot)
        given = {"k" if submodular_only else "c": found}
        robust = ro.ratt(problem).elements
        plans = [robust, ro.random_plan(problem, seed=0).elements]
        bounds = [float(ro.instance_bound(problem, plan, **given)) for plan in plans]
        guarantees = ro.all_guarantees(problem, alpha_cs, **given)
        assert list(guarantees.values()) == sorted(guarantees.values(), reverse=True)
        # RATT's own numbers are never worse than the worst numbers of any plan.
        name = "k" if submodular_only else "c"
        assert bounds[0] >= guarantees[f"pattern-free ({name})"] - 1e-9
        if best > 1e-9:
            useful += 1
            assert kept(problem, robust, best) >= max(guarantees.values()) - 1e-9
            for plan, bound in zip(plans, bounds, strict=True):
                assert kept(problem, plan, best) >= bound - 1e-9
    assert useful > 120


def test_the_instance_bound_is_the_best_order_or_the_group_size_by_definition():
    from itertools import permutations

    rng = np.random.default_rng(8)
    for _ in range(40):
        f = ro.TableFunction(monotone_table(rng, 5))
        problem = ro.Problem(f, np.array([0, 0, 1, 2, 2]), None, 0, 0)
        plan = np.array([int(rng.choice(choice)) for choice in problem.choices])
        c = ro.total_curvature(f, problem.robot)
        largest = [max(c.marginals.largest_upper[choice]) for choice in problem.choices]

        def least(robot, before, f=f, plan=plan):
            sets = [[plan[i] for k, i in enumerate(before) if mask >> k & 1] for mask in range(2 ** len(before))]
            return min(f([*s, plan[robot]]) - f(s) for s in sets)

        orders = []
        for order in permutations(range(3)):
            ratios = [least(i, order[:k]) / largest[i] for k, i in enumerate(order) if largest[i] > 0]
            orders.append(min(ratios, default=1.0))
        # By group size: nobody is attacked, so the best element sees, and all three robots are one group.
        excess = max(m - max(map(f, choice[:, None])) for m, choice in zip(largest, problem.choices, strict=True))
        groups = max(map(f, plan[:, None])) / (sum(largest) - excess) if sum(largest) > 0 else 1.0
        assert ro.instance_bound(problem, plan, c=c) == pytest.approx(min(max(*orders, groups), 1.0), abs=1e-12)


def test_a_plan_of_many_robots_is_bracketed():
    for kind in ("trace", "maxeig"):
        problem = ro.random_scenario(18, 4, alpha_s=2, alpha_c=0, seed=1).problem(kind)
        c = ro.total_curvature(problem.objective, problem.robot, max_nodes=0)
        plan = ro.ratt(problem).elements
        found = ro.instance_bound(problem, plan, c=c, time_limit=0.0)
        assert 0 <= found < 1
        rng = np.random.default_rng(0)
        for _ in range(200):
            group = plan[rng.random(18) < rng.random()]
            own = sum(c.marginals.largest_upper[problem.choices[i]].max() for i in problem.robot[group])
            assert problem.objective(group) >= float(found) * own - 1e-9


def test_extremes_of_the_formulas():
    assert ro.theorem1_bound(0, k=0.5) == pytest.approx(0.5 / 1.5)  # no division by alpha_cs = 0
    assert ro.theorem1_bound(3, k=0.5) == pytest.approx(0.5 / 3)
    assert ro.theorem1_bound(0, c=0.5) == pytest.approx(0.125)
    assert ro.theorem1_bound(4, c=0.5) == pytest.approx(0.0625)
    assert ro.theorem1_bound(4, c=0.5, all_bait=True) == pytest.approx(0.25) == ro.remark1_bound(c=0.5)
    assert ro.all_bait_group_bound(1, c=1.0) == 1
    for bound in (ro.remark1_bound, ro.sensing_only_bound, ro.pattern_free_bound):
        assert bound(k=0.0) == bound(c=0) == 1
        assert bound(k=1.0) == bound(c=1) == 0
        assert bound(k=0.3).hypotheses
        assert bound(k=0.3).source


def test_every_guarantee_points_at_a_proof():
    """A function whose documentation has one, and the theorem of formal/ where it names one."""
    theories = Path(__file__).parents[2] / "formal" / "theories"
    coq = "\n".join(path.read_text(encoding="utf-8") for path in theories.glob("*.v"))
    problem = ro.random_scenario(4, 3, alpha_s=1, alpha_c=0, seed=0).problem("trace")
    c = ro.total_curvature(problem.objective, problem.robot)
    bounds = [ro.instance_bound(problem, ro.ratt(problem).elements, c=c), ro.all_bait_group_bound(2, k=0.5)]
    for g, given in ((1, {"c": c}), (2, {"c": c}), (2, {"k": 0.5})):
        bounds += [ro.group_size_bound(g, **given), ro.survivor_bound(g, **given), ro.remark1_bound(**given)]
        bounds += [*ro.all_guarantees(problem, 0, **given).values(), ro.theorem1_bound(2, **given)]
    for bound in bounds:
        function, _, theorem = bound.proof.partition("; in Coq ")
        assert "Proof" in getattr(ro, function).__doc__
        name = theorem.removesuffix(" (complete graphs)")
        assert not theorem or re.search(rf"^(Theorem|Corollary) {name}\b", coq, re.MULTILINE)
        assert bound.proof.startswith("pattern_free_bound") or function in {
            "instance_bound",
            "all_bait_group_bound",
            "group_size_bound",
            "survivor_bound",
        }
        if bound.proof.startswith("pattern_free_bound"):
            name = "k" if "ratt_submodular" in theorem else "c"
            assert bound <= ro.pattern_free_bound(**{name: 0.5 if name == "k" else c})


def test_a_bracket_gives_its_conservative_end():
    f = ro.random_scenario(7, 3, alpha_s=1, alpha_c=0, seed=0).problem("trace")
    c = ro.total_curvature(f.objective, f.robot, max_nodes=0)
    assert c.lower < c.upper
    assert ro.pattern_free_bound(c=c) == ro.pattern_free_bound(c=c.upper) <= ro.pattern_free_bound(c=c.lower)


def test_what_does_not_apply_is_said_with_its_reason():
    problem = ro.random_scenario(4, 2, alpha_s=1, alpha_c=3, seed=0).problem()
    assert set(ro.inapplicable_guarantees(problem, 1)) == {"sensing only", "Remark 1", "all bait"}
    assert "alpha_c = 3" in ro.inapplicable_guarantees(problem, 1)["sensing only"]
    assert set(ro.inapplicable_guarantees(problem, 3)) == {"sensing only"}
    free = ro.random_scenario(4, 2, alpha_s=1, alpha_c=0, seed=0).problem()
    assert set(ro.inapplicable_guarantees(free, 0)) == {"Remark 1", "all bait"}


@pytest.mark.parametrize(
    ("call", "text"),
    [
        (lambda p, _: ro.instance_bound(p, [0, 12, 24]), "k, c must be given one at a time"),
        (lambda p, c: ro.instance_bound(p, [0, 12, 24], k=c, c=c), "k, c must be given one at a time"),
        (lambda p, c: ro.instance_bound(p, [0, 1, 24], c=c), "elements"),
        (lambda p, _: ro.instance_bound(p, [0, 12, 24], c=ro.total_curvature(p.objective, plan=[0])), "feasible sets"),
        (lambda *_: ro.pattern_free_bound(), "k, c must be given one at a time"),
        (lambda *_: ro.pattern_free_bound(k=1.5), "k must be in"),
        (lambda *_: ro.pattern_free_bound(c=float("nan")), "c must be a finite number"),
        (lambda *_: ro.pattern_free_bound(k=True), "k must be a finite number; got True"),
        (lambda *_: ro.pattern_free_bound(k="0.5"), "k must be a finite number; got '0.5'"),
        (lambda *_: ro.theorem1_bound(-1, k=0.5), "alpha_cs"),
        (lambda *_: ro.all_bait_group_bound(0, k=0.5), "size"),
    ],
)
def test_bad_arguments_are_refused(call, text):
    problem = ro.random_scenario(3, 2, alpha_s=1, alpha_c=0, seed=0).problem()
    c = ro.total_curvature(problem.objective, problem.robot)
    with pytest.raises(ro.InputError, match=text):
        call(problem, c)


def test_a_guarantee_is_a_number_and_a_value() -> None:
    given = ro.theorem1_bound(2, k=0.5)
    copies = [copy.copy(given), copy.deepcopy(given), pickle.loads(pickle.dumps(given)), replace(given)]
    for other in copies:
        assert other == given
        assert hash(other) == hash(given)
        assert other.to_dict() == given.to_dict() == asdict(given) | {"hypotheses": list(given.hypotheses)}
    assert given == 0.25
    assert 1 - given == 0.75
    assert f"{given}" == "0.25"
    assert json.loads(json.dumps(given)) == 0.25
    assert repr(given) == "Guarantee(0.25, 'ratt.tex, Theorem 1')"
    assert replace(given, source="elsewhere").source == "elsewhere"
    with pytest.raises(FrozenInstanceError):
        given.value = 1.0  # type: ignore[misc]
