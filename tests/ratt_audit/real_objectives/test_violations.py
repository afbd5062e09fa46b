"""Claims on EKF objectives: casting against RATT itself, exact replay, verdicts known by proof."""

import json
from dataclasses import replace
from fractions import Fraction
from itertools import combinations

import numpy as np
import pytest

from ratt_audit.appendix.entry import ClaimEntry
from ratt_audit.appendix.roles import Team
from ratt_audit.entries import all_entries
from ratt_audit.real_objectives.cast import Cast, ExactCriterion, Stage, is_castable
from ratt_audit.real_objectives.violations import Origin, Trial, exact_violation, search_real_objectives
from ratt_audit.report.records import real_record
from ratt_opt import (
    InputError,
    MaxEigenvalueObjective,
    Scenario,
    TraceObjective,
    exhaustive_optimum,
    random_scenario,
    ratt,
)

ENTRIES = [entry for entry in all_entries() if isinstance(entry, ClaimEntry)]


def find(label: str, kind: str, reading: str = "") -> ClaimEntry:
    return next(e for e in ENTRIES if e.label == label and e.kind == kind and e.reading.startswith(reading))


@pytest.mark.parametrize("name", ["trace", "logdet"])
def test_exact_values_agree_with_the_library_s_floats(name: str) -> None:
    objective = random_scenario(2, 2, alpha_s=0, alpha_c=0, seed=4).problem(name).objective
    exact = ExactCriterion(objective)
    for size in range(4):
        for subset in list(combinations(range(0, 24, 5), size)):
            assert float(exact(subset)) == pytest.approx(objective(subset), rel=1e-12, abs=1e-12)
    assert exact(()) == 0
    assert exact((0, 13)) is exact((13, 0))


def test_exact_values_of_one_target_by_hand() -> None:
    """Prior I, information diag(1, 0): posterior trace 1/2 + 1, so the gain is 1/2; with both elements 2/3."""
    exact = ExactCriterion(TraceObjective([np.eye(2)], [[[[1.0, 0], [0, 0]]], [[[1.0, 0], [0, 0]]]]))
    assert [str(exact([0])), str(exact([0, 1]))] == ["1/2", "2/3"]


def test_other_criteria_are_refused() -> None:
    with pytest.raises(InputError, match="trace or the log-det"):
        ExactCriterion(MaxEigenvalueObjective([np.eye(2)], np.zeros((1, 1, 2, 2))))


@pytest.mark.parametrize("seed", range(4))
def test_a_cast_is_ratt_s_plan_and_the_optimum(seed: int) -> None:
    problem = random_scenario(3, 3, alpha_s=1, alpha_c=0, seed=seed).problem()
    team = Team(("b1",), ("g1", "g2"))
    cast = next(Stage(problem).casts(team))
    plan = ratt(problem)
    assert set(cast.elements[:3]) == set(plan.elements.tolist())
    assert problem.robot[cast.elements[0]] == plan.bait[0]
    best = exhaustive_optimum(problem)
    assert set(cast.elements[3:]) == set(best.elements.tolist())
    for premise in team.premises:
        assert cast.evaluate(premise.expression, 1.0) >= -1e-12


def test_proved_claims_hold_and_refuted_ones_fail_on_real_objectives() -> None:
    proved = search_real_objectives(find("nd_p1d1v1_7", "step").claims, refuted=False)
    assert proved is not None
    assert proved.broken == 0
    assert not proved.violated_exactly
    refuted = search_real_objectives(find("nd_p1d1v1_8", "step", "A* hurts RATT").claims, refuted=False)
    assert refuted is not None
    assert refuted.worst is not None
    assert refuted.violated_exactly
    assert 0 < refuted.worst.violation < 1


def test_the_worst_instance_replays_from_its_record_alone() -> None:
    entry = find("nd_p1d1v1_8", "step", "A* hurts RATT")
    result = search_real_objectives(entry.claims, refuted=False)
    assert result is not None
    assert result.worst is not None
    record = json.loads(json.dumps(real_record(result)))["worst"]
    sized = next(s for s in entry.claims if s.size == record["claim"])
    trial = Trial(
        violation=record["relative_violation"],
        sized=sized,
        scenario=Scenario.model_validate_json(json.dumps(record["scenario"])),
        origin=result.worst.origin,
        players=tuple(record["elements"].values()),
    )
    exact = exact_violation(trial)
    assert exact > 0
    assert sized.team is not None
    swapped = replace(trial, players=trial.players[::-1])
    assert exact_violation(swapped) is None, "elements in the wrong roles meet no premise"


def test_the_curvature_in_play_is_that_of_the_definition() -> None:
    """Additive values: curvature 0; a copy of an element in another robot halves its smallest marginal."""
    team = Team(("b1",), ("g1",))
    additive = Cast(team.ground, (0, 1, 2, 3), lambda s: float(sum(e + 1 for e in s)))
    assert additive.kept(submodular=True) == additive.kept(submodular=False) == 1
    concave = Cast(team.ground, (0, 1, 2, 3), lambda s: float([0, 2, 3][len(s)]))
    assert concave.kept(submodular=True) == Fraction(1, 2)


def test_claims_without_roles_or_with_other_numbers_are_not_cast() -> None:
    lemma = find("tzoumas2018_lemma4", "lemma").claims[0]
    assert not is_castable(lemma.claim, lemma.team)
    summary = find("nd_p1_d1", "step").claims[0]
    assert not is_castable(summary.claim, summary.team)
    assert search_real_objectives([lemma, summary], refuted=True) is None


def test_the_search_is_reproducible() -> None:
    claims = find("nd_p1d2v1_4", "step as equality").claims[:2]
    assert search_real_objectives(claims, refuted=True) == search_real_objectives(claims, refuted=True)


def test_an_origin_says_how_to_build_the_scenario_again() -> None:
    assert str(Origin(3, 7)) == "random_scenario(3, 3, alpha_s=0, alpha_c=0, seed=7)"
    assert str(Origin(3, 7, 2)) == f"{Origin(3, 7)}, then moved at random (step 2 of default_rng(0))"
    assert str(Origin(3, 0, 2, has_start=False)).startswith("random_scenario seed 0, then moved")
