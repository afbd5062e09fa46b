"""The main job as one call: every claim of its report against the definitions."""

import signal
from dataclasses import replace

import numpy as np
import pytest

import ratt_opt as ro
from ratt_opt.errors import UndecidedError
from tests.certificates.engine import step
from tests.main_job.engine import step as of_job
from tests.oracles import brute_force_optimum, brute_force_worst_case
from tests.strategies import OBJECTIVES, random_problem
from tests.ways import with_params

SMALL = ro.Problem(ro.LogDetObjective([[[2.0]]], [[[[k]]] for k in (1.0, 2.0, 3.0, 4.0)]), [0, 0, 1, 1], None, 1, 0)


@pytest.mark.parametrize("kind", [*OBJECTIVES, "table"])
@pytest.mark.parametrize("seed", range(8))
def test_every_claim_holds_by_definition(kind, seed):
    problem = random_problem(np.random.default_rng([seed, 11]), kind=kind, controls=2)
    report = ro.bound(problem)
    best = brute_force_optimum(problem)
    slack = 1e-9 * max(1.0, best)
    assert report.optimum.lower - slack <= best <= report.upper + slack
    for plan in report.plans:
        worst = brute_force_worst_case(problem, plan.elements)
        assert plan.worst_case.lower - slack <= worst <= plan.worst_case.upper + slack
        assert report.share(plan) <= (worst / best if best > 0 else 1) + 1e-9
        chosen = [problem.choices[i][k] for i, k in enumerate(plan.controls)]
        assert list(plan.elements) == chosen
    achieved = brute_force_worst_case(problem, report.ratt.elements) / best if best > 0 else 1.0
    for name, guarantee in report.guarantees.items():
        assert 0 <= float(guarantee) <= achieved + 1e-9, name
    assert report.recommended.worst_case.lower == max(plan.worst_case.lower for plan in report.plans)


def test_progress_is_told_step_by_step():
    lines: list[str] = []
    report = ro.bound(ro.random_scenario(3, 2, alpha_s=1, alpha_c=1, seed=0), progress=lines.append)
    assert [line for line in lines if not line.startswith("  ")] == list(report.seconds)


def test_a_time_limit_leaves_an_honest_bracket():
    scenario = ro.random_scenario(20, 20, alpha_s=10, alpha_c=63, seed=0)
    report = ro.bound(scenario, time_limit=1e-3)
    assert report.optimum.stop is ro.Stop.TIME
    assert report.optimum.lower <= report.ratt.worst_case.upper <= report.upper


@pytest.mark.parametrize(
    ("arguments", "text"),
    [
        ({"gap": -1.0}, "gap"),
        ({"gap": float("nan")}, "gap"),
        ({"time_limit": -1.0}, "time_limit"),
        ({"objective": "determinant"}, "objective"),
    ],
)
def test_bad_arguments_are_refused(arguments, text):
    with pytest.raises(ro.InputError, match=text):
        ro.bound(ro.random_scenario(2, 1, alpha_s=0, alpha_c=0, seed=0), **arguments)
    with pytest.raises(ro.InputError, match="scenario_or_problem"):
        ro.bound("scenario.json")


def test_a_function_with_too_many_feasible_sets_has_the_curvature_that_theory_knows():
    problem = ro.Problem(ro.Modular(np.arange(1.0, 26.0)), np.arange(25), None, 2, 0)
    report = ro.bound(problem, time_limit=5)
    assert abs(report.curvature.upper) <= 1e-12  # modular
    assert report.ratt.worst_case.lower == report.optimum.upper == sum(range(1, 24))


def test_an_interrupt_ends_every_step_and_keeps_the_bracket():
    """Ctrl-C during the search for the optimum: what is proved so far is reported, and no later step starts anew."""
    lines = []

    def impatient(line):
        lines.append(line)
        if line.startswith("  "):
            raise KeyboardInterrupt

    scenario = ro.random_scenario(8, 6, alpha_s=2, alpha_c=11, seed=0)
    report = ro.bound(scenario, time_limit=None, progress=impatient)
    assert report.optimum.stop is ro.Stop.INTERRUPTED
    assert report.total_curvature.stop is ro.Stop.INTERRUPTED
    assert lines[-2:] == ["curvature and guarantees", "certificate"]
    assert report.optimum.lower <= ro.solve_maxmin(report.problem, gap=1e-6).upper
    assert ro.solve_maxmin(report.problem, gap=1e-6).lower <= report.upper * (1 + 1e-9)


def test_an_interrupt_while_the_certificate_is_written_keeps_the_report(monkeypatch, tmp_path):
    step(monkeypatch, "upper end", lambda _: lambda *_: signal.raise_signal(signal.SIGINT))
    file = tmp_path / "certificate.json"
    report = ro.bound(ro.random_scenario(4, 4, alpha_s=1, alpha_c=2, seed=0), certificate=file)
    assert report.interrupted
    assert report.certificate.why_not.startswith("interrupted")
    assert report.optimum.stop in {ro.Stop.CLOSED, ro.Stop.EXHAUSTED}
    assert not list(tmp_path.iterdir())


def test_a_proof_with_a_fault_raises_and_keeps_the_report(tmp_path, monkeypatch):
    def faulty(*_):
        raise ro.ProofError("claim: false")

    step(monkeypatch, "writing", lambda _: faulty)
    with pytest.raises(ro.ProofError, match="claim: false") as caught:
        ro.bound(SMALL, certificate=tmp_path / "c.json")
    report = caught.value.report
    assert report == replace(ro.bound(SMALL), certificate=report.certificate)
    assert report.certificate.why_not == "the proof has a fault: claim: false"
    assert ro.ProofError("other").report is None


def test_a_proof_that_is_not_decided_is_a_reason(tmp_path, monkeypatch):
    def undecided(*_):
        raise UndecidedError("not decided within 600 s")

    step(monkeypatch, "writing", lambda _: undecided)
    report = ro.bound(SMALL, certificate=tmp_path / "c.json")
    assert report.certificate.why_not == "could not be made: not decided within 600 s"


class Counted(ro.Modular):
    """A set function that counts what it is asked."""

    def __init__(self, weights):
        super().__init__(weights)
        self.asked = 0

    def evaluate(self, membership):
        self.asked += len(membership)
        return super().evaluate(membership)


@pytest.mark.parametrize("robots", [25, 50])
def test_without_time_individual_values_are_asked_for_once(robots):
    """Without an overrun of first plans they are what a limit of 0 takes; besides, a few for each plan shown."""
    f = Counted(np.random.default_rng(robots).random(3 * robots))
    params = ro.JobParams(search=with_params(ro.MaxMinParams(), {(ro.MaxMinParams, "first_plans.beyond"): 0.0}))
    ro.bound(ro.Problem(f, np.repeat(np.arange(robots), 3), None, 3, 40), time_limit=0, params=params)
    assert f.asked <= f.n + 40


def test_the_smallest_largest_group_is_searched_once(monkeypatch):
    """RATT's bait and the report's group come from the same search."""
    asked = []

    def counted(real):
        def searched(threat, budget):
            found = real(threat, budget)
            asked.extend([found] if threat.alpha_c else [])  # without link attacks nothing is to be searched
            return found

        return searched

    of_job(monkeypatch, "link attacks", counted)
    report = ro.bound(
        ro.network_scenario("disk-6", 16, 2, alpha_s=2, alpha_c=3, seed=0), guarantees="none", time_limit=2
    )
    assert [report.largest_group] == asked
    assert report.alpha_cs == 16 - report.largest_group.lower > 0
