"""One instance on a real Dask cluster of two workers: the bracket of one core, also when one of them is killed."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

import ratt_opt as ro
from ratt_opt import solve_maxmin
from tests.cluster import SLOW, distributed, scheduler, workers
from tests.solvers.maxmin.engine import SHARED_AT_ONCE
from tests.solvers.maxmin.subtrees.workers import assert_agree, hard
from tests.ways import go

if TYPE_CHECKING:
    from pathlib import Path


@pytest.mark.parametrize("kills", [pytest.param(False, marks=pytest.mark.slow), True])
def test_a_cluster_finds_the_same_bracket_and_its_certificate_stands(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, kills: bool
) -> None:
    go(monkeypatch, SHARED_AT_ONCE)
    problem, alone = hard()
    asked: list[object] = []
    with scheduler(tmp_path) as address, workers(2, address, tmp_path) as (first, _):
        with distributed.Client(address, timeout=SLOW, set_as_default=False) as client:
            executor = client.get_executor(pure=False)
            submit = executor.submit

            def watched(*arguments: object, **named: object) -> object:
                asked.append(submit(*arguments, **named))
                if kills and len(asked) == 2:
                    first.kill()
                return asked[-1]

            monkeypatch.setattr(executor, "submit", watched)
            found = solve_maxmin(problem, gap=1e-6, workers=executor)
        assert len(asked) > 1
        assert (first.poll() is not None) == kills
    assert_agree(problem, found, alone)
    verified = ro.certify(problem, found, tmp_path / "certificate.json").verified
    assert verified.upper == pytest.approx(found.upper, rel=1e-9)
