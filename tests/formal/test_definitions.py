"""The definitions in Coq and Python agree: values proved in formal/theories/Examples*.v, computed again here."""

import re
import shutil
import subprocess
from fractions import Fraction
from pathlib import Path

import networkx as nx
import numpy as np
import pytest

from ratt_opt import (
    Attack,
    Problem,
    TableFunction,
    TraceObjective,
    curvature,
    exhaustive_optimum,
    ratt,
    smallest_largest_group,
    total_curvature,
)
from tests.certificates.cases import full
from tests.oracles import brute_force_worst_case

FORMAL = Path(__file__).parents[2] / "formal"
EXAMPLES = ("relay", "safe", "split")
EXAMPLE_FILES = [f"theories/{path.stem}.vo" for path in sorted((FORMAL / "theories").glob("Examples*.v"))]
TEXT = "\n".join(path.read_text() for path in sorted((FORMAL / "theories").glob("Examples*.v")))


def defined(name):
    """The right side of a definition in the Coq file."""
    found = re.search(rf"^Definition {name} : [^=]*:=\s(.*?)\.$", TEXT, re.MULTILINE | re.DOTALL)
    assert found is not None, name
    return found[1]


def numbers(text):
    """All whole numbers in a text."""
    return [int(x) for x in re.findall(r"\d+", text)]


def lists(text):
    """The bracketed lists of a text as lists of numbers, pairs in pieces of two."""
    return [numbers(part) for part in re.findall(r"\[::([^\]]*)\]", text)]


def pairs(flat):
    """Numbers two by two."""
    return list(zip(flat[::2], flat[1::2], strict=True))


def example(name):
    """The problem, plan, value, attack, group and seeing robots of an example, as Coq has them."""
    text = defined(f"{name}_net")
    owners, links, safe_robots, safe_links = lists(text)
    alpha_s, alpha_c = numbers(re.sub(r"\[::[^\]]*\]", "", text).split("Network")[1])[1:]
    graph = nx.Graph()
    graph.add_nodes_from(range(max(owners) + 1))
    graph.add_edges_from(pairs(links))
    information = np.array([float(x) for x in numbers(defined(f"{name}_infos"))]).reshape(-1, 1, 1, 1)
    problem = Problem(
        TraceObjective(np.ones((1, 1, 1)), information),
        np.array(owners),
        graph,
        alpha_s,
        alpha_c,
        frozenset(safe_robots),
        frozenset(pairs(safe_links)),
    )
    blinded, cut = lists(defined(f"{name}_attack"))
    mantissa, scale = numbers(defined(f"{name}_value"))
    plan, group, sees = (numbers(defined(f"{name}_{what}")) for what in ("plan", "group", "sees"))
    return problem, plan, Fraction(mantissa, 2**scale), Attack(frozenset(blinded), frozenset(pairs(cut))), group, sees


@pytest.mark.parametrize("name", EXAMPLES)
def test_worst_case_and_optimum(name):
    problem, plan, value, *_ = example(name)
    assert brute_force_worst_case(problem, problem.check_plan(plan)) == pytest.approx(float(value), abs=1e-12)
    optimum = exhaustive_optimum(problem)
    assert optimum.lower == pytest.approx(float(value), abs=1e-12)
    assert optimum.upper == pytest.approx(float(value), abs=1e-12)


@pytest.mark.parametrize("name", EXAMPLES)
def test_attacks_and_groups(name):
    problem, _, _, attack, group, sees = example(name)
    problem.check_attack(attack)
    found = next(g for g in problem.communication.groups(attack.links) if 0 in g)
    assert sorted(found) == group
    assert sorted(found - attack.sensing) == sees


@pytest.mark.parametrize("name", EXAMPLES)
def test_smallest_possible_largest_group(name):
    problem = example(name)[0]
    found = smallest_largest_group(problem.communication, problem.alpha_c, protected_links=problem.protected_links)
    assert [found.n_max] == numbers(defined(f"{name}_n_max"))


def test_a_part_of_the_state():
    owners, links, *_ = lists(defined("part_net"))
    entries = np.array([full(flat, 2) for flat in lists(defined("part_infos")[len("[::") :])])
    output = np.array(numbers(defined("part_output")), dtype=float).reshape(-1, 2)
    objective = TraceObjective(np.eye(2)[None], entries[:, None], output=output)
    problem = Problem(objective, np.array(owners), nx.Graph(pairs(links)), 1, 0)
    mantissa, scale = numbers(defined("part_value"))
    plan = problem.check_plan(numbers(defined("part_plan")))
    optimum = exhaustive_optimum(problem)
    for found in (brute_force_worst_case(problem, plan), optimum.lower, optimum.upper):
        assert found == pytest.approx(mantissa / 2**scale, abs=1e-12)


@pytest.mark.parametrize("name", ["ties", "pairs"])
def test_ratt_with_ties(name):
    owners, table, alpha, plan = (numbers(defined(f"{name}_{what}")) for what in ("owners", "table", "alpha", "plan"))
    problem = Problem(TableFunction(np.array(table, dtype=float)), np.array(owners), None, alpha[0], 0)
    assert list(ratt(problem, alpha_cs=0).elements) == plan


@pytest.mark.parametrize(("name", "measure"), [("covered", curvature), ("bonus", total_curvature)])
def test_curvatures(name, measure):
    owners, table = (
        np.array(numbers(defined("covered_owners"))),
        np.array(numbers(defined(f"{name}_table")), dtype=float),
    )
    over, under = numbers(defined(f"{name}_curvature_is"))
    found = measure(TableFunction(table), owners)
    assert found.lower == pytest.approx(over / under, abs=1e-12)
    assert found.upper == pytest.approx(over / under, abs=1e-12)
    assert measure(TableFunction(table)).lower == pytest.approx(1)  # over all sets


def test_every_definition_distinguishes_the_examples():
    """Without the relay, without protection, or with other groups the values would be others."""
    relay, plan, value, *_ = example("relay")
    cut_off = Problem(relay.objective, relay.robot, nx.empty_graph(3), 1, 0)
    assert brute_force_worst_case(cut_off, cut_off.check_plan(plan)) < float(value)
    safe, plan, value, *_ = example("safe")
    for robots, links in ((frozenset(), safe.protected_links), (safe.protected_robots, frozenset())):
        bare = Problem(safe.objective, safe.robot, safe.graph, safe.alpha_s, safe.alpha_c, robots, links)
        assert exhaustive_optimum(bare).upper < float(value)


def test_coq_accepts_the_examples():
    coqc = shutil.which("coqc")
    if coqc is None:
        pytest.skip("coqc is not installed (Debian: coq libcoq-mathcomp-algebra)")
    done = subprocess.run(
        [shutil.which("make") or "make", "-C", str(FORMAL), *EXAMPLE_FILES],
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stdout[-2000:] + done.stderr[-2000:]
