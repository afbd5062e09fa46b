"""Records: true ones are accepted, each field that is changed for the better is refused, by name."""

import copy
import itertools

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import ratt_opt as ro
from ratt_opt.benchmark.instances.forms import SumInput
from ratt_opt.benchmark.instances.instance import read_document, write_document
from ratt_opt.benchmark.instances.library import hash_of
from ratt_opt.benchmark.proofs.answers import worth_of
from ratt_opt.benchmark.proofs.enumeration import best_worst_case
from ratt_opt.benchmark.proofs.relaxation import INFORMATION, as_information
from ratt_opt.benchmark.proofs.verification import proved_bound, verify_record
from ratt_opt.errors import UndecidedError
from tests.benchmark.small_library import (
    attack_instance,
    coverage_instance,
    cuts_instance,
    plan_instance,
    record_of,
    small_library,
    table_instance,
)
from tests.oracles import brute_force_optimum
from tests.strategies import problems, random_graph

ALL = (coverage_instance, table_instance, plan_instance, attack_instance, cuts_instance)


@given(problems(4))
@settings(max_examples=60, deadline=None)
def test_enumeration_is_the_definition(problem):
    assert best_worst_case(problem) == pytest.approx(brute_force_optimum(problem), rel=1e-12)


def sums(seed):
    rng = np.random.default_rng(seed)
    robots, controls, parts = 3, 2, int(rng.integers(2, 6))
    graph = random_graph(rng, robots)
    fields = {
        "robot": np.repeat(np.arange(robots), controls).tolist(),
        "alpha_s": int(rng.integers(0, 3)),
        "alpha_c": int(rng.integers(0, 1 + graph.number_of_edges())),
        "links": sorted((min(link), max(link)) for link in graph.edges),
    }
    if seed % 2:
        utility = rng.integers(0, 5, (6, parts))
        utility[0] += 1
        return SumInput(kind="facility location", utility=utility.tolist(), **fields)
    covers = [np.flatnonzero(row).tolist() for row in rng.random((6, parts)) < 0.5]
    covers[0] = covers[0] or [0]
    return SumInput(kind="coverage", covers=covers, weights=rng.integers(1, 9, parts).astype(float).tolist(), **fields)


@pytest.mark.parametrize("seed", range(40))
def test_the_criterion_bounds_the_sum_from_both_sides(seed):
    given_sum = sums(seed)
    f, g = given_sum.function, as_information(given_sum).problem("trace").objective
    sets = np.array(list(itertools.product([False, True], repeat=6)))
    low, high = g.evaluate(sets), g.evaluate(sets) * (1 + 1 / INFORMATION)
    values = f.evaluate(sets)
    assert (low <= values + 1e-9).all()
    assert (values <= high + 1e-9).all()


@pytest.mark.parametrize("seed", range(12))
def test_certificates_of_sums_prove_the_optimum_with_cuts_too(seed, tmp_path):
    instance = ro.BenchmarkInstance(name="s", family="f", source="s", problem=sums(seed))
    record = record_of(instance, tmp_path)
    assert record["bound"] == record["value"] == brute_force_optimum(instance.team)
    assert verify_record(instance, record).bound == record["bound"]


@pytest.mark.parametrize("make", ALL)
def test_a_record_is_proved_and_no_better_one_is(make, tmp_path):
    instance = make()
    record = record_of(instance, tmp_path)
    proved = verify_record(instance, record)
    assert proved.value == record["value"]
    assert abs(proved.bound - proved.value) <= 1e-6 * abs(proved.value)
    better = 1.0 if instance.maximises else -1.0
    step = 1e-3 * abs(record["value"]) + 1e-3
    with pytest.raises(ro.ProofError, match=r"value .* is not reached"):
        verify_record(instance, {**record, "value": record["value"] + better * step, "bound": 1e9 * better})
    with pytest.raises(ro.ProofError, match=r"bound .* is not proved"):
        verify_record(instance, {**record, "bound": record["bound"] - better * step})
    with pytest.raises(ro.ProofError, match="is not proved"):
        verify_record(instance, {**record, "certificate": None})
    assert verify_record(instance, {**record, "certificate": None, "bound": None}).value == record["value"]
    with pytest.raises(ro.ProofError, match="is of the instance x"):
        verify_record(instance, {**record, "instance": "x"})
    for field, wrong in (("value", "1"), ("value", float("nan")), ("bound", True), ("certificate", {"format": "x"})):
        with pytest.raises((ro.InputError, ro.ProofError)):
            verify_record(instance, {**record, field: wrong})
    without = {name: v for name, v in record.items() if name not in {"elements", "sensing", "links", "cut"}}
    with pytest.raises(ro.InputError, match="must hold an answer"):
        verify_record(instance, without)


def test_a_certificate_of_another_problem_proves_nothing(tmp_path):
    for make, other in (
        (coverage_instance, coverage_instance(seed=5)),
        (plan_instance, plan_instance(seed=5)),
        (attack_instance, attack_instance(seed=5)),
        (cuts_instance, cuts_instance(weights=[3] * 15)),
    ):
        record = record_of(make(), tmp_path)
        with pytest.raises(ro.ProofError):
            proved_bound(other, record["certificate"])


def test_a_certificate_of_cuts_says_which_groups_it_is_about(tmp_path):
    instance = cuts_instance()
    record = record_of(instance, tmp_path)
    larger = instance.replace(problem=instance.problem.replace(size=5))
    with pytest.raises(ro.ProofError, match="another network or smaller groups"):
        proved_bound(larger, record["certificate"])
    smaller = instance.replace(problem=instance.problem.replace(size=3))  # needs at least as many cuts
    assert proved_bound(smaller, record["certificate"])[0] == record["bound"]


@given(st.data())
@settings(max_examples=60, deadline=None)
def test_a_certificate_with_one_number_changed_proves_nothing_false(data):
    instance, record, truth = _known()
    certificate = copy.deepcopy(record["certificate"])
    place = certificate["upper"] if data.draw(st.booleans()) else certificate
    while isinstance(place, (dict, list)) and len(place):
        key = data.draw(st.sampled_from(sorted(place))) if isinstance(place, dict) else None
        at = key if key is not None else data.draw(st.integers(0, len(place) - 1))
        if not isinstance(place[at], (dict, list)) or not place[at]:
            if isinstance(place[at], (int, float)):
                place[at] = data.draw(st.sampled_from([0, 1, place[at] / 2, place[at] * 1.5, -place[at]]))
            break
        place = place[at]
    try:
        bound, value = proved_bound(instance, certificate)
    except (ro.InputError, ro.ProofError, UndecidedError):
        return
    assert bound >= truth
    assert value <= truth


_KEPT = []


def _known():
    if not _KEPT:
        import tempfile
        from pathlib import Path

        instance = coverage_instance(seed=3)
        with tempfile.TemporaryDirectory() as folder:
            _KEPT.extend([instance, record_of(instance, Path(folder)), brute_force_optimum(instance.team)])
    return _KEPT


def test_a_record_falls_only_to_a_verified_better_one(tmp_path):
    library = small_library(tmp_path, [coverage_instance()])
    instance, best = library.instance("cover"), library.best["cover"]
    record = read_document(library.record_path("cover"))
    with pytest.raises(ro.InputError, match="must better the known record"):
        ro.submit_record(library, record, who="me")
    worse = ro.greedy(instance.team).elements.tolist()
    value = worth_of(instance, {"elements": worse}, 10).lower
    assert value < best.value
    weak = {**record, "elements": worse, "value": value}
    library = library.set_best(_row(best, weak), weak)
    assert [line.fault for line in ro.verify_benchmark(library)] == [""]
    with pytest.raises(ro.ProofError, match="is not reached"):
        ro.submit_record(library, {**weak, "value": best.value}, who="me")
    assert ro.BenchmarkLibrary.load(tmp_path).best["cover"].value == value
    library, row = ro.submit_record(library, record, who="me")
    assert (row.value, row.who) == (best.value, "me")
    assert ro.BenchmarkLibrary.load(tmp_path).best["cover"] == row


def _row(best, record):
    fields = {name: getattr(best, name) for name in best.__slots__}
    return type(best)(**{**fields, "value": record["value"], "bound": record["bound"], "certificate": hash_of(record)})


def test_the_table_is_verified_line_by_line(tmp_path):
    library = small_library(tmp_path)
    assert [line.fault for line in ro.verify_benchmark(library)] == [""] * 4
    assert len(ro.verify_benchmark(library, sample=2, seed=1)) == 2
    record = read_document(library.record_path("plan"))
    write_document({**record, "value": record["value"] + 1}, library.record_path("plan"))
    (tmp_path / "records" / "cuts.json.xz").unlink()
    table = (tmp_path / "best.csv").read_text(encoding="utf-8")
    (tmp_path / "best.csv").write_text(table.replace("attack,", "attack,1"), encoding="utf-8")
    faults = {line.instance: line.fault for line in ro.verify_benchmark(ro.BenchmarkLibrary.load(tmp_path))}
    assert faults["cover"] == ""
    assert "another SHA-256" in faults["plan"]
    assert "must be a file that can be read" in faults["cuts"]
    assert "the table says 1" in faults["attack"]
