"""The extracted checker and the Python verifier where a part of the state counts."""

import json

import numpy as np
import pytest

from ratt_opt import InputError, MaxEigenvalueObjective, Problem, TraceObjective, certify, solve_maxmin
from tests.certificates.cases import full
from tests.formal.verified import decisions, python_decision, sweep
from tests.strategies import information_data, random_graph

KINDS = {"trace": TraceObjective, "maxeig": MaxEigenvalueObjective}


def output_problem(rng, kind, d, q, n_robots=3):
    """Few robots of one or two elements, one or two targets with weights, ``q`` outputs of ``d`` states of each."""
    counts, m = rng.integers(1, 3, n_robots), int(rng.integers(1, 3))
    owners = rng.permutation(np.repeat(np.arange(n_robots), counts))
    prior, information = information_data(rng, len(owners), m, d)
    output = rng.normal(size=(m, q, d))
    if rng.random() < 0.5:  # the first coordinates themselves
        output = np.broadcast_to(np.eye(q, d), output.shape)
    objective = KINDS[kind](prior, information, rng.choice([1.0, 1.5, 2.0], size=m), output=output)
    graph = None if rng.random() < 0.4 else random_graph(rng, n_robots)
    links = n_robots * (n_robots - 1) // 2 if graph is None else graph.number_of_edges()
    safe = frozenset(i for i in range(n_robots) if rng.random() < 0.15)
    return Problem(objective, owners, graph, int(rng.integers(0, 3)), int(rng.integers(0, min(links, 2) + 1)), safe)


def documents(folder, seeds):
    """Certificates of random problems, both criteria, two to four coordinates, one or two that count."""
    for seed in seeds:
        rng = np.random.default_rng([50, seed])
        problem = output_problem(rng, ("trace", "maxeig")[seed % 2], 2 + seed // 2 % 3, 1 + seed // 6 % 2)
        path = folder / "base.json"
        try:
            written = certify(problem, solve_maxmin(problem), path)
        except InputError:  # all values are too small
            continue
        yield rng, json.loads(path.read_text()), written.verified.lower


def changeable(folder, seeds):
    """Those of plans that are worth something: where every robot can be blinded there is nothing to change."""
    return ((rng, document) for rng, document, lower in documents(folder, seeds) if lower > 1e-3)


def test_certificates_are_accepted_by_both(tmp_path):
    paths = []
    for _, document, _ in documents(tmp_path, range(48)):
        assert "output" in document["problem"]
        paths.append(tmp_path / f"{len(paths)}.json")
        paths[-1].write_text(json.dumps(document))
    assert len(paths) >= 40
    assert decisions(paths) == [python_decision(path) for path in paths] == [0] * len(paths)


def test_a_raised_claim_is_refused(tmp_path):
    path = tmp_path / "lie.json"
    for _, document, lower in documents(tmp_path, range(12)):
        for side, factor in (("upper", 1 - 1e-6), ("lower", 1 + 1e-6)):
            if lower > 1e-3:
                lie = json.loads(json.dumps(document))
                lie["claim"] = {"lower": 0.0, "upper": 2 * lie["claim"]["upper"]} | {side: factor * lie["claim"][side]}
                path.write_text(json.dumps(lie))
                assert decisions([path]) == [python_decision(path)] == [1]


def test_an_output_is_read_as_python_reads_it(tmp_path):
    """Shapes that are none, other outputs, none at all, and one where there must be none."""
    path = tmp_path / "c.json"
    for _, document, lower in documents(tmp_path, range(6)):
        problem, part = document["problem"], document["problem"]["output"]
        bare = {name: value for name, value in problem.items() if name != "output"}
        cut, longer = [c[:-1] for c in part], [[*c, 0.0] for c in part]
        bad = ([], [[] for _ in part], part[:-1], [*part, part[0]], cut, longer, None, 1.0, [1.0] * len(part))
        others = ([[factor * x for x in c] for c in part] for factor in (2, 0.5, -1, 0))
        wrong = [problem | {"output": output} for output in bad] + [bare, problem | {"objective": "logdet"}]
        maybe = [
            problem | {"output": output} for output in (*others, [c[::-1] for c in part], [[*c, *c] for c in part])
        ]
        for k, changed in enumerate([*wrong, *maybe]):
            path.write_text(json.dumps(document | {"problem": changed}))
            code, expected = decisions([path])[0], python_decision(path)
            assert (code == 0) == (expected == 0), changed
            assert code != 0 or k >= len(wrong)
            assert code != 0 or lower <= 1e-3 or (k == len(wrong) + 2 and problem["objective"] == "maxeig")  # -C


def test_the_identity_gives_the_whole_state(tmp_path):
    """A proof of the whole state is one for the output I."""
    path = tmp_path / "c.json"
    for seed, (kind, objective) in enumerate(KINDS.items()):
        prior, information = information_data(np.random.default_rng([51, seed]), 6, 2, 3)
        problem = Problem(objective(prior, information), np.repeat(np.arange(3), 2), None, 1, 1)
        certify(problem, solve_maxmin(problem), path)
        document = json.loads(path.read_text())
        document["problem"]["output"] = [np.eye(3).ravel().tolist()] * 2
        if kind == "trace":
            upper = document["upper"]
            upper["points"] = [[full(y, 3).ravel().tolist() for y in point] for point in upper["points"]]
        path.write_text(json.dumps(document))
        assert decisions([path]) == [python_decision(path)] == [0]


def test_rows_of_zeros_change_nothing(tmp_path):
    """So outputs may have up to as many rows as columns, another number for each target."""
    path = tmp_path / "c.json"
    for rng, document, _ in documents(tmp_path, range(12)):
        problem, upper, d = document["problem"], document["upper"], document["problem"]["dimension"]
        more = [int(rng.integers(0, d - len(c) // d + 1)) for c in problem["output"]]
        if problem["objective"] == "trace":
            wider = [
                [
                    np.pad(np.reshape(y, (d, -1)), ((0, 0), (0, k))).ravel().tolist()
                    for y, k in zip(point, more, strict=True)
                ]
                for point in upper["points"]
            ]
            upper["points"] = wider
        problem["output"] = [c + [0.0] * (k * d) for c, k in zip(problem["output"], more, strict=True)]
        path.write_text(json.dumps(document))
        assert decisions([path]) == [python_decision(path)] == [0]


def test_more_rows_than_columns_are_refused_alike(tmp_path):
    """Rows of zeros prove what they proved before, but cost time without a limit."""
    path = tmp_path / "c.json"
    for _, document, _ in documents(tmp_path, range(3)):
        problem = document["problem"]
        d = problem["dimension"]
        problem["output"][0] += [0.0] * (d * d + d - len(problem["output"][0]))
        path.write_text(json.dumps(document))
        assert decisions([path]) == [python_decision(path)] == [2]


def test_changes_are_decided_alike(tmp_path):
    found, seen, accepted = sweep(tmp_path, changeable(tmp_path, range(8)), 0.1)
    assert not found
    assert seen >= 200
    assert accepted >= 20


@pytest.mark.slow
def test_ten_thousand_changes_are_decided_alike(tmp_path):
    found, seen, _ = sweep(tmp_path, changeable(tmp_path, range(12, 84)), 0.25)
    assert not found
    assert seen >= 10_000
