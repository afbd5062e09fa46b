"""The trace and the worst axis of a part of the state: values, attacks, max-min, curvature and certificates."""

import copy
import json
import pickle

import networkx as nx
import numpy as np
import pytest

from ratt_opt import (
    InputError,
    LogDetObjective,
    MaxEigenvalueObjective,
    Problem,
    ProofError,
    TraceObjective,
    certify,
    exhaustive_optimum,
    ratt,
    solve_maxmin,
    total_curvature,
    verify_certificate,
    worst_case_attack,
)
from ratt_opt.budget import Budget
from tests.brackets import worst_value
from tests.oracles import brute_force_optimum, brute_force_worst_case
from tests.setfunctions import oracle
from tests.strategies import information_data, random_elements

WEIGHTS = [1.0, 2.0]
TRACE, WORST_AXIS = KINDS = [TraceObjective, MaxEigenvalueObjective]


def part_problem(rng, n_robots=4, d=4, q=2, *, kind=WORST_AXIS, controls=3, graph=None):
    """A small problem whose criterion is about ``q`` outputs of ``d`` states, of two targets."""
    prior, information = information_data(rng, controls * n_robots, 2, d)
    objective = kind(prior, information, WEIGHTS, output=rng.normal(size=(2, q, d)))
    owners = np.repeat(np.arange(n_robots), controls)
    links = n_robots * (n_robots - 1) // 2 if graph is None else graph.number_of_edges()
    return Problem(objective, owners, graph, 1, min(3, links))


def by_definition(f, subset) -> float:
    covariance = np.linalg.inv(np.linalg.inv(f.prior) + f.information[list(subset)].sum(axis=0))
    whole, of_one = (sum, np.trace) if isinstance(f, TRACE) else (max, lambda M: np.linalg.eigvals(M).real.max())
    before, after = (
        whole(w * of_one(C @ P @ C.T) for w, C, P in zip(f.weights, f.output, matrices, strict=True))
        for matrices in (f.prior, covariance)
    )
    return before - after


@pytest.mark.parametrize("d", [1, 2, 3, 4])
@pytest.mark.parametrize("kind", KINDS)
def test_the_identity_gives_the_whole_state(kind, d: int) -> None:
    prior, information = information_data(np.random.default_rng(d), 6, 3, d)
    plain = kind(prior, information, [1.0, 2.0, 0.5])
    whole = kind(prior, information, [1.0, 2.0, 0.5], output=np.eye(d))
    np.testing.assert_allclose(whole.table(), plain.table(), rtol=1e-11, atol=1e-12)
    assert whole.prior_criterion == pytest.approx(plain.prior_criterion)
    assert whole.prior_eigenvalue == pytest.approx(plain.prior_eigenvalue)
    point = plain.posterior_information(np.array([1, 4]))
    np.testing.assert_allclose(whole.gradient(point), plain.gradient(point), rtol=1e-8, atol=1e-12)


@pytest.mark.parametrize("q", [1, 2, 3])
@pytest.mark.parametrize("kind", KINDS)
def test_values_are_those_of_the_definition(kind, q: int) -> None:
    f = part_problem(np.random.default_rng(q), q=q, kind=kind).objective
    for subset in ([], [0], [1, 5, 8], range(12)):
        assert f(subset) == pytest.approx(by_definition(f, subset), abs=1e-10)
    step = 1e-6 * np.eye(4)[None]
    point = f.posterior_information(np.array([2, 3]))
    slope = np.einsum("mij,mij->", f.gradient(point), np.broadcast_to(step, point.shape))
    assert float(f.value(point + step) - f.value(point - step)) / 2 == pytest.approx(slope, rel=1e-5)


@pytest.mark.parametrize("q", [1, 2, 4])
def test_tangents_are_above_and_touch(q: int) -> None:
    f = part_problem(np.random.default_rng(q), q=q).objective
    subsets = [np.flatnonzero(np.random.default_rng(k).random(12) < 0.4) for k in range(8)]
    matrices = [f.posterior_information(subset) for subset in subsets]
    for point in matrices:
        (worst,) = f.tangent_targets(point, -np.inf, 1)
        for target in (None, 0, 1):
            tangent = f.tangent(point, target)
            bounds = [tangent.offset + float((tangent.slope * other).sum()) for other in matrices]
            assert all(bound >= f.value(other) - 1e-9 for bound, other in zip(bounds, matrices, strict=True))
            if target in {None, worst}:
                assert tangent.offset + float((tangent.slope * point).sum()) == pytest.approx(float(f.value(point)))


@pytest.mark.parametrize("seed", range(6))
@pytest.mark.parametrize("kind", KINDS)
def test_attacks_and_optima_are_exact(kind, seed: int) -> None:
    rng = np.random.default_rng(seed)
    graph = nx.cycle_graph(4) if seed % 3 == 2 else None
    problem = part_problem(rng, d=2 + seed % 3, q=1 + seed % 2, kind=kind, graph=graph)
    plan = random_elements(rng, problem)
    assert worst_value(problem, plan) == pytest.approx(brute_force_worst_case(problem, plan), rel=1e-9)
    found = solve_maxmin(problem)
    best = brute_force_optimum(problem)
    assert found.lower == pytest.approx(best, rel=1e-8)
    assert found.upper == pytest.approx(found.lower, rel=1e-7)
    assert worst_case_attack(problem, ratt(problem).elements).upper <= best * (1 + 1e-9)


@pytest.mark.parametrize("d", [2, 4])
@pytest.mark.parametrize("q", [1, 2])
@pytest.mark.parametrize("kind", KINDS)
def test_total_curvature_brackets_every_ratio(kind, d: int, q: int) -> None:
    f = part_problem(np.random.default_rng(d), n_robots=3, d=d, q=q, kind=kind, controls=2).objective
    found = total_curvature(f)
    assert found.lower - 1e-7 <= oracle.total_curvature(f.table()) <= found.upper + 1e-7


@pytest.mark.parametrize("seed", range(8))
def test_marginals_lie_between_their_ends(seed: int) -> None:
    """Over sets with one element of each other robot; both ends are above 0 where information is regular."""
    rng = np.random.default_rng(seed)
    prior, _ = information_data(rng, 1, 2, 3)
    root = rng.normal(size=(6, 2, 3, 3))
    information = root @ root.swapaxes(-1, -2) + 0.5 * np.eye(3)
    f = MaxEigenvalueObjective(prior, information, WEIGHTS, output=rng.normal(size=(1 + seed % 3, 3)))
    owners = np.repeat(np.arange(3), 2)
    lower, upper = f.marginal_ends(owners, Budget())
    for e in range(6):
        first, second = ([[], [a], [a + 1]] for a in range(0, 6, 2) if a != e - e % 2)
        marginals = [f([*x, *y, e]) - f([*x, *y]) for x in first for y in second]
        assert 0 < lower[e] <= min(marginals)
        assert max(marginals) <= upper[e] <= f.prior_criterion


def changed(document: dict, where: list, change) -> dict:
    """A copy with one place changed."""
    bad = copy.deepcopy(document)
    record = bad
    for key in where[:-1]:
        record = record[key]
    record[where[-1]] = change(record[where[-1]])
    return bad


@pytest.mark.parametrize("output", [None, np.eye(3)])
def test_the_largest_marginal_may_need_a_context_that_leaves_two_axes(output) -> None:
    """A look along a well known axis tells little, unless that axis is known anyway: then much of the others."""
    look = np.array([3.0, 100.0, 0.0])
    about = np.outer(look, look) + np.diag([0.0, 0.0, 9.0])
    f = TraceObjective(np.diag([1.0, 0.1, 1.0])[None], [[about], [np.diag([0.0, 1e6, 0.0])]], output=output)
    _, largest = f.marginal_ends(np.arange(2), Budget())
    assert f([0, 1]) - f([1]) > 1.7 > f([0])
    assert f([0, 1]) - f([1]) <= largest[0]


def test_certificates_of_the_trace_are_written_and_have_teeth(tmp_path) -> None:
    problem = part_problem(np.random.default_rng(7), n_robots=3, kind=TRACE)
    path = tmp_path / "certificate.json"
    written = certify(problem, solve_maxmin(problem), path)
    assert written.verified.lower_proved
    assert written.verified.lower <= exhaustive_optimum(problem).lower * (1 + 1e-9)
    good = json.loads(path.read_text())
    low = 0.99 * good["claim"]["lower"]
    lies = (
        (["problem", "output", 0, 0], lambda x: x + 0.5),
        (["upper", "points", 0, 0], lambda row: [x + 0.5 for x in row]),
        (["claim"], lambda _: {"lower": 0.9 * low, "upper": low}),
    )
    for where, change in lies:
        path.write_text(json.dumps(changed(good, where, change)))
        with pytest.raises(ProofError):
            verify_certificate(path)


@pytest.mark.parametrize(("d", "graph"), [(2, None), (4, None), (3, nx.path_graph(3))])
def test_certificates_are_written_and_have_teeth(tmp_path, d: int, graph: nx.Graph | None) -> None:
    problem = part_problem(np.random.default_rng(7), n_robots=3, d=d, graph=graph)
    path = tmp_path / "certificate.json"
    written = certify(problem, solve_maxmin(problem), path)
    assert written.verified.lower_proved
    best = exhaustive_optimum(problem).lower
    assert best * (1 - 1e-6) <= written.verified.lower <= best * (1 + 1e-9)
    assert best * (1 - 1e-9) <= written.verified.upper <= best * (1 + 1e-6)
    good = json.loads(path.read_text())
    assert good["problem"]["objective"] == "maxeig"

    def refused(where: list, change, match: str) -> None:
        path.write_text(json.dumps(changed(good, where, change)))
        with pytest.raises(ProofError, match=match):
            verify_certificate(path)

    for factor in (0.5, 2.0):  # of the output, whose covariance then is another
        scaled = [[x * factor for x in row] for row in good["problem"]["output"]]
        refused(["problem", "output"], lambda _, scaled=scaled: scaled, "prior_eigenvalue")
        good["prior_eigenvalue"] = [x * factor**2 for x in good["prior_eigenvalue"]]
        refused(["problem", "output"], lambda _, scaled=scaled: scaled, "only proves|worth less")
        good["prior_eigenvalue"] = [x / factor**2 for x in good["prior_eigenvalue"]]
    refused(["upper", "points"], lambda p: [[j, t * 2, v] for j, t, v in p], "only proves")
    refused(["upper", "points"], lambda p: [[j, t, [x + 1 for x in v]] for j, t, v in p], "only proves")
    refused(["upper", "points", 0, 2], lambda v: [0.0] * len(v), "zero")
    refused(["prior_eigenvalue", 0], lambda x: x * 1.001, "lower too large")
    refused(["prior_eigenvalue", 1], lambda x: x * 0.999, "upper too small")
    refused(["claim", "lower"], lambda x: x * 1.001, "worth less|lower")
    refused(["claim"], lambda c: {"lower": c["lower"] * 0.9, "upper": c["lower"] * 0.95}, "only proves")
    if d > 2:  # a direction that the output does not see proves nothing
        C = np.array(good["problem"]["output"][good["upper"]["points"][0][0]]).reshape(2, d)
        unseen = np.linalg.svd(C)[2][-1]
        refused(["upper", "points", 0, 2], lambda _: unseen.tolist(), "zero|only proves")


def test_a_rank_deficient_output_in_a_file_proves_what_is_true(tmp_path) -> None:
    """The library makes none; the verifier's formulas hold for any: nothing counts, so nothing is lost or kept."""
    problem = part_problem(np.random.default_rng(7), n_robots=2, d=2, q=1)
    path = tmp_path / "certificate.json"
    certify(problem, solve_maxmin(problem), path)
    document = json.loads(path.read_text())
    document["problem"]["output"] = [[0.0, 0.0], [0.0, 0.0]]
    document["prior_eigenvalue"] = [0.0, 0.0]
    document["claim"] = {"lower": -1.0, "upper": document["claim"]["upper"]}
    path.write_text(json.dumps(document))
    with pytest.raises(ProofError, match="so is its output"):
        verify_certificate(path)
    document["upper"] |= {"points": [], "cuts": [], "tree": []}
    path.write_text(json.dumps(document))
    with pytest.raises(ProofError):
        verify_certificate(path)


def test_an_output_is_not_of_the_log_det(tmp_path) -> None:
    problem = part_problem(np.random.default_rng(7), n_robots=2)
    path = tmp_path / "certificate.json"
    certify(problem, solve_maxmin(problem), path)
    document = json.loads(path.read_text())
    document["problem"]["objective"] = "logdet"
    path.write_text(json.dumps(document))
    with pytest.raises(ProofError, match="the log-det has no output"):
        verify_certificate(path)
    with pytest.raises(InputError, match="output must be None"):
        LogDetObjective(np.eye(2)[None], np.eye(2)[None, None], output=np.eye(2))


def test_what_it_has_no_form_for_is_refused_by_name() -> None:
    """No planar formulas, which serve whole states only, and no conic form."""
    f = part_problem(np.random.default_rng(3), d=2).objective
    assert f.compiled_code is None
    assert f.planar_levels() is None
    with pytest.raises(InputError, match="must define conic_value"):
        f.conic_value([])


@pytest.mark.parametrize("kind", KINDS)
def test_copies_and_refusals(kind) -> None:
    f = part_problem(np.random.default_rng(1), kind=kind).objective
    again = pickle.loads(pickle.dumps(f))
    assert isinstance(again, kind)
    assert again([1, 2]) == f([1, 2])
    assert f.restricted_to(np.array([1, 2]))([0, 1]) == f([1, 2])
    prior, information = information_data(np.random.default_rng(1), 3, 2, 3)
    for output in (np.eye(2), np.zeros((1, 3)), np.ones((2, 3)), np.ones((3, 1, 3)), np.array([[np.nan, 0, 0]])):
        with pytest.raises(InputError, match="output"):
            kind(prior, information, output=output)
