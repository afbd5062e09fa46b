"""A contributor adds a bound with one file and one line: the page "Your first bound", done in a temporary module."""

import importlib.util
import re
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

import ratt_opt as ro
from ratt_opt.solvers.maxmin.stages import schedule
from tests.documents import ROOT
from tests.strategies import random_problem

PAGE = ROOT / "docs" / "contributors" / "first_bound.md"


@pytest.fixture
def added(tmp_path: Path) -> Any:
    """The stage of the page's file."""
    found = re.search(r"<!-- file: (\S+) -->\n```python\n(.*?)```", PAGE.read_text(encoding="utf-8"), re.DOTALL)
    assert found is not None
    path = tmp_path / found[1]
    path.write_text(found[2], encoding="utf-8")
    spec = importlib.util.spec_from_file_location(path.stem, path)
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module.AllElementsStage()


def turns_of(stage: Any) -> list[tuple[float, float]]:
    """The upper ends before and after each turn of the stage from now on."""
    turns: list[tuple[float, float]] = []
    begin = stage.begin

    def watched(known: Any) -> Any:
        search = begin(known)
        run = search.run

        def run_and_note(turn: Any) -> Any:
            stop = run(turn)
            turns.append((turn.upper, search.upper))
            return stop

        search.run = run_and_note
        return search

    stage.begin = watched
    return turns


def check(turns: list[tuple[float, float]], tmp_path: Path, *, closes: bool) -> None:
    lowered = 0
    for seed in range(24):
        rng = np.random.default_rng([seed, 31])
        problem = random_problem(rng, int(rng.integers(2, 5)), kind=str(rng.choice(["trace", "logdet", "maxeig"])))
        best = ro.exhaustive_optimum(problem).lower
        before = len(turns)
        found = ro.solve_maxmin(problem)
        assert found.lower <= best + 1e-9 * abs(best) + 1e-10
        assert found.upper >= best - 1e-9 * abs(best) - 1e-10
        assert found.stop is ro.Stop.CLOSED or not closes
        if problem.alpha_c == 0:
            assert len(turns) == before
        for other, own in turns[before:]:
            assert own >= best - 1e-9 * abs(best) - 1e-10
            lowered += own < other
        if seed % 8 == 0 and found.upper > 0:
            ro.certify(problem, found, tmp_path / "proof.json")
    assert len(turns) > 1
    assert closes or lowered > 5


@pytest.mark.parametrize("alone", [False, True])
def test_brackets_are_true_with_the_stage(
    added: Any, alone: bool, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """After the trees, as the page lists it; and alone, where it is all that bounds from above."""
    first, *others = schedule.BOUND_STAGES
    monkeypatch.setattr(schedule, "BOUND_STAGES", (added,) if alone else (first, added, *others))
    check(turns_of(added), tmp_path, closes=not alone)


@pytest.mark.parametrize("bound", [1e-3, -np.inf, np.nan])
def test_a_bound_below_a_plan_ends_the_search_and_is_named(
    added: Any, bound: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    begin = added.begin

    def false(known: Any) -> Any:
        return SimpleNamespace(upper=bound, proof=begin(known).proof, run=lambda _: ro.Stop.NODES)

    monkeypatch.setattr(added, "begin", false)
    monkeypatch.setattr(schedule, "BOUND_STAGES", (added,))
    problem = replace(random_problem(np.random.default_rng(3), 4, kind="trace"), alpha_s=1, alpha_c=1)
    with pytest.raises(
        ro.ProofError, match=r"all elements: no plan is worth more than .*, but one is worth .* at least"
    ):
        ro.solve_maxmin(problem)


def test_a_turn_that_says_nothing_names_its_stage(added: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    begin = added.begin

    def silent(known: Any) -> Any:
        search = begin(known)
        search.run = lambda _: None
        return search

    monkeypatch.setattr(added, "begin", silent)
    monkeypatch.setattr(schedule, "BOUND_STAGES", (added,))
    problem = replace(random_problem(np.random.default_rng(3), 4, kind="trace"), alpha_s=1, alpha_c=1)
    with pytest.raises(TypeError, match="a turn of the stage 'all elements' must return a Stop"):
        ro.solve_maxmin(problem)


def test_stages_have_names_of_their_own_and_say_when_they_apply() -> None:
    names = [stage.name for stage in schedule.BOUND_STAGES]
    assert len(set(names)) == len(names)
    assert all(type(stage).applies.__doc__ and type(stage).share.__doc__ for stage in schedule.BOUND_STAGES)
