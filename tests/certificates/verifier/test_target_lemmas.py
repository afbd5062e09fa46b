"""Lemmas about single targets against every set; rows and spaced values against every plan; forgeries are refused."""

import json
from dataclasses import replace

import numpy as np
import pytest
from flint import ctx

from ratt_opt import (
    CertificateParams,
    FileFormatError,
    Problem,
    ProofError,
    TraceObjective,
    VerifierLimits,
    exhaustive_optimum,
    verify_certificate,
)
from ratt_opt.certificates.stated_inequalities import StatedInequalities
from ratt_opt.certificates.stated_problem import statement_of
from ratt_opt.certificates.target_trees import TargetTreeParams, target_trees
from ratt_opt.certificates.verifier.target_lemmas import TargetInequalities
from tests.certificates import lemmas
from tests.certificates.mutants import accepted, changed, is_false, places, variants
from tests.strategies import OBJECTIVES, random_problem


def drawn(seed, kind=None):
    """A small problem, of three targets or fewer, some with outputs."""
    rng = np.random.default_rng([64, seed])
    kind = kind or list(OBJECTIVES)[seed % 3]
    problem = random_problem(rng, int(rng.integers(2, 5)), kind=kind, controls=3)
    if kind != "logdet" and seed % 5 == 0:
        f = problem.objective
        output = rng.normal(size=(1, f.dimension))
        problem = replace(problem, objective=type(f)(f.prior, f.information, f.weights, output=output))
    return problem, rng


def stated(problem, drawn_lemmas, params=None):
    """Tangents and lemmas as a certificate has them."""
    found = StatedInequalities(problem, params or CertificateParams())
    for lemma in drawn_lemmas:
        found._lemma(lemma)
    stated_lemmas = found._proved_lemmas()
    return found._stated, stated_lemmas


def read(problem, tangents, proved):
    """The lemmas that the verifier accepts."""
    with ctx.workprec(128):
        return TargetInequalities(statement_of(problem), tangents, proved, []).lemmas


def check_against_all_sets(problem, rng, params=None):
    """Check drawn lemmas, as they are stated and read, against the definition."""
    wanted = [lemmas.drawn_lemma(problem, rng, j) for j in range(problem.objective.n_targets)]
    tangents, proved = stated(problem, wanted, params)
    checked = read(problem, tangents, proved)
    for lemma, claim in zip(wanted, checked, strict=True):
        own = lemmas.touching(problem, claim.target)
        scale = 1 + abs(lemma.constant) + abs(lemma.scores).max()
        excess = [
            lemmas.target_value(problem, claim.target, s) - sum(float(claim.scores.get(e, 0)) for e in s)
            for s in lemmas.sets_of(problem, own)
        ]
        assert max(excess) <= float(claim.constant) + 1e-9 * scale
        assert float(claim.constant) <= max(excess) + 1e-6 * scale


@pytest.mark.parametrize("seed", range(15))
def test_a_lemma_holds_for_every_set_and_its_constant_is_the_least(seed):
    check_against_all_sets(*drawn(seed))


@pytest.mark.parametrize("seed", range(8))
def test_lemmas_by_base_sets_hold_for_every_set(seed):
    """Gains beside bases, in the place of tangents, for log-dets."""
    check_against_all_sets(*drawn(seed, "logdet"), lemmas.BASES)


def test_one_base_shows_a_lemma_of_marginals():
    """The scores are what elements add to a base; no tree is needed, and a lower constant is refused."""
    problem, _ = drawn(1, "logdet")
    own = lemmas.touching(problem, 0)
    base = sorted(own[:2].tolist())
    scores = np.zeros(problem.objective.n)
    value = lemmas.target_value(problem, 0, base)
    for e in set(own.tolist()) - set(base):
        scores[e] = lemmas.target_value(problem, 0, [*base, e]) - value + 1e-12
    lemma = {"target": 0, "elements": own.tolist(), "scores": scores[own].tolist(), "tree": [{"base": base}]}
    assert read(problem, [], [lemma | {"constant": value + 1e-9}])
    with pytest.raises(ProofError, match="only proves"):
        read(problem, [], [lemma | {"constant": value - 1e-6}])
    trace = replace(problem, objective=TraceObjective(problem.objective.prior, problem.objective.information))
    with pytest.raises(ProofError, match="gains diminish with the log-det alone"):
        read(trace, [], [lemma | {"constant": 1e6}])


@pytest.mark.parametrize("seed", range(6))
def test_trees_that_limits_cut_prove_larger_constants(seed):
    problem, rng = drawn(seed)
    wanted = [lemmas.drawn_lemma(problem, rng, j) for j in range(problem.objective.n_targets)]
    for tree in target_trees(problem, wanted, TargetTreeParams(nodes=0)):
        assert tree.point is not None
    tangents, proved = stated(problem, wanted)
    whole = [claim["constant"] for claim in proved]
    for tree in proved:
        tree["tree"] = tree["tree"][-1:]  # a leaf of some case, in the place of all
    for k, lemma in enumerate(proved):
        if len(lemma["tree"]) == 1 and wanted[k].scores.any():
            lemma["constant"] = whole[k] - 1e-3 * (1 + abs(whole[k]))
            with pytest.raises(ProofError, match=f"tree of lemma {k} only proves"):
                read(problem, tangents, proved)
            lemma["constant"] = whole[k] + 1e9


@pytest.mark.parametrize("seed", range(1, 5))
@pytest.mark.parametrize("kind", ["trace", "logdet"])
def test_rows_prove_the_optimum_of_small_teams(kind, seed, tmp_path):
    problem, rng = drawn(seed, kind)
    written, document = lemmas.certified_by_rows(problem, lemmas.by_rows(problem, rng), tmp_path / "rows.json")
    best = exhaustive_optimum(problem).lower
    scale = 1e-9 * (best + problem.objective.prior_magnitude)
    assert document["upper"]["rows"]
    assert written.verified.lower <= best + scale
    assert best - scale <= written.verified.upper <= best + 100 * scale


@pytest.mark.parametrize("seed", range(4))
def test_spaced_values_close_an_upper_end(seed, tmp_path):
    rng = np.random.default_rng([65, seed])
    problem = lemmas.covering(rng, lost=1 + seed % 2)
    best = exhaustive_optimum(problem)
    proof = lemmas.spaced(problem)
    plain = lemmas.certified_by_rows(problem, replace(proof, spacing=None), tmp_path / "plain.json")[0]
    written, document = lemmas.certified_by_rows(problem, proof, tmp_path / "spaced.json")
    assert document["upper"]["spacing"]["count"] == round(best.upper)
    assert best.lower - 1e-9 <= written.verified.upper <= best.upper * (1 + 3e-4)
    if round(best.upper) < problem.objective.n_targets:  # else the rows leave nothing open
        assert plain.verified.upper > best.upper * (1 + 3e-4)
    lie = changed(document, ("claim", "upper"), best.upper * (1 - 1e-3))
    lie["claim"]["lower"] = 0.0
    for count in range(round(best.upper)):
        lie["upper"]["spacing"]["count"] = count
        with pytest.raises(ProofError):
            verify_certificate(_saved(lie, tmp_path / "lie.json"))


def _saved(document, path):
    path.write_text(json.dumps(document))
    return path


def test_values_are_not_spaced_if_an_element_sees_badly(tmp_path):
    """What it adds to one target is then between the values of the others: no leaf is lowered by much."""
    f = lemmas.covering(np.random.default_rng(66)).objective
    information = np.array(f.information)
    information[0] = 0.3
    problem = Problem(TraceObjective(f.prior, information), [0, 0, 1, 1, 2, 2], None, 1, 0)
    best = exhaustive_optimum(problem).upper
    document = lemmas.certified_by_rows(problem, lemmas.spaced(problem), tmp_path / "c.json")[1]
    lie = changed(document, ("claim", "upper"), best * (1 - 1e-3))
    lie["claim"]["lower"] = 0.0
    for count in range(problem.objective.n_targets + 1):
        lie["upper"]["spacing"]["count"] = count
        with pytest.raises(ProofError, match="a leaf only proves"):
            verify_certificate(_saved(lie, tmp_path / "lie.json"))


def test_lemmas_are_proved_if_few_robots_may_choose():
    """The problem is stated with a plan of idle robots, as others may be no plan."""
    team = lemmas.covering(np.random.default_rng(3))
    f = team.objective
    information = np.concatenate([f.information, np.zeros((3, *f.information.shape[1:]))])
    robot = [*team.robot.tolist(), 0, 1, 2]
    problem = Problem(TraceObjective(f.prior, information), robot, None, 1, 0, at_most=2)
    assert statement_of(problem).plan == (6, 7, 8)
    wanted = [lemmas.drawn_lemma(problem, np.random.default_rng(4), j) for j in range(f.n_targets)]
    assert len(read(problem, *stated(problem, wanted))) == f.n_targets


def sweep(seeds, share, tmp_path):
    """Claim a little less than the optimum, then mutate tangents, lemmas, rows, spacing; returns how many mutants."""
    count = 0
    for seed in seeds:
        if seed % 3:
            problem, rng = drawn(seed, ["trace", "logdet"][seed % 2])
            proof = lemmas.by_rows(problem, rng)
        else:
            rng = np.random.default_rng([67, seed])
            problem = lemmas.covering(rng, robots=2, targets=3)
            proof = lemmas.spaced(problem)
        document = lemmas.certified_by_rows(problem, proof, tmp_path / "base.json")[1]
        claim = document["claim"]["upper"]
        if claim < 1e-3:
            continue
        lie = changed(document, ("claim", "upper"), claim * (1 - (1e-2 if "spacing" in document["upper"] else 1e-5)))
        lie["claim"]["lower"] = 0.0
        assert is_false(lie)
        names = [name for name in ("tangents", "lemmas", "usual", "rows", "spacing") if name in lie["upper"]]
        for at, value in list(places({"upper": {name: lie["upper"][name] for name in names}})):
            for new in variants(value, rng):
                if new != value and rng.random() <= share:
                    count += 1
                    assert not accepted(changed(lie, at, new), tmp_path / "mutant.json"), (seed, at, value, new)
    return count


def test_no_mutated_lemma_row_or_spacing_hides_a_false_claim(tmp_path):
    assert sweep(range(3), 0.007, tmp_path) >= 15


@pytest.mark.slow
def test_no_mutated_lemma_row_or_spacing_hides_a_false_claim_at_length(tmp_path):
    assert sweep(range(40), 0.3, tmp_path) >= 5_000


@pytest.mark.parametrize("limit", ["terms", "scores"])
def test_rows_that_take_too_much_are_refused(limit, tmp_path):
    """A short file can name the same inequalities in many rows."""
    problem, rng = drawn(3, "trace")
    lemmas.certified_by_rows(problem, lemmas.by_rows(problem, rng), tmp_path / "rows.json")
    with pytest.raises(FileFormatError, match="size of rows must be at most 3"):
        verify_certificate(tmp_path / "rows.json", limits=VerifierLimits(**{limit: 3}))
