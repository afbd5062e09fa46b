"""The same sweep on a real Dask scheduler: the same bytes, also when a worker is killed in the middle."""

import os
import subprocess
import sys
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from functools import partial
from pathlib import Path

import pytest

from ratt_opt import InputError
from ratt_opt.studies import executors
from ratt_opt.studies.engine import run
from ratt_opt.studies.executors import open_executor
from ratt_opt.studies.progress import Progress
from tests.cluster import SLOW, scheduler, wait_for, workers
from tests.documents import ROOT
from tests.studies.toy import STUDY


@pytest.fixture(autouse=True)
def _patient(monkeypatch: pytest.MonkeyPatch) -> None:
    """A loaded machine may answer later than a user would wait; what is tested here is what is answered."""
    monkeypatch.setattr(executors, "dask_cluster", partial(executors.dask_cluster, patience=SLOW))


def test_a_killed_worker_changes_nothing(tmp_path: Path) -> None:
    with open_executor(None, 1) as executor:
        expected = run(STUDY, tmp_path / "local", executor, trials=10, progress=Progress()).path.read_bytes()
    with ExitStack() as stack:
        address = stack.enter_context(scheduler(tmp_path))
        first, _ = stack.enter_context(workers(2, address, tmp_path, seconds=0.1))
        rows = 0

        class Killing(Progress):
            @contextmanager
            def task(self, name: str, *, total: int, done: int) -> Iterator[object]:
                def counting() -> None:
                    nonlocal rows
                    rows += 1
                    if rows == total // 5:
                        first.kill()
                    advance()

                with super().task(name, total=total, done=done) as advance:
                    yield counting

        with open_executor(address, None) as executor:
            table = run(STUDY, tmp_path / "dask", executor, trials=10, progress=Killing()).path
        assert first.wait(SLOW) != 0
    assert rows == 40
    assert table.read_bytes() == expected


MINE = """
from ratt_opt.studies import Case, Study

def first_of_each(problem):
    return [int(own[0]) for own in problem.choices]

case = Case(n_robots=2, n_targets=2, alpha_s=1, alpha_c=0)
STUDY = Study(name="mine", cases=(case,), planners=(first_of_each,), attackers=("worst",), metrics=("value",))
"""


def test_a_study_of_ones_own_runs_from_any_folder(tmp_path: Path) -> None:
    """Neither the study's file nor its folder is where the workers look."""
    mine, far = tmp_path / "mine", tmp_path / "far"
    mine.mkdir()
    far.mkdir()
    (mine / "my_study.py").write_text(MINE)
    run_it = (
        "import sys; from my_study import STUDY; from ratt_opt.studies import run; "
        "from ratt_opt.studies.executors import open_executor\n"
        "with open_executor(sys.argv[1], None) as executor:\n"
        "    print(len(run(STUDY, 'out', executor, trials=3).rows))"
    )
    with ExitStack() as stack:
        address = stack.enter_context(scheduler(far))
        stack.enter_context(workers(1, address, far))
        environment = os.environ | {"PYTHONPATH": f"{mine}{os.pathsep}{ROOT}"}
        command = [sys.executable, "-c", run_it, address]
        done = subprocess.run(command, cwd=mine, env=environment, capture_output=True, text=True, check=False)
    assert done.stdout == "3\n", done.stderr


def test_a_lost_scheduler_is_one_line_and_the_sweep_resumes(tmp_path: Path) -> None:
    with ExitStack() as stack:
        service = stack.enter_context(ExitStack())
        address = service.enter_context(scheduler(tmp_path))
        stack.enter_context(workers(1, address, tmp_path, seconds=0.1))
        command = [sys.executable, "-m", "tests.studies.run_toy", "--out", str(tmp_path / "out"), "--trials", "100"]
        process = stack.enter_context(
            subprocess.Popen([*command, "--cluster", address], cwd=ROOT, text=True, stderr=subprocess.PIPE)
        )
        journal = tmp_path / "out" / "toy" / "journal.csv"
        wait_for(lambda: journal.exists() and journal.stat().st_size > 0)
        service.close()
        errors = process.communicate(timeout=SLOW)[1]
    assert process.returncode == 1
    again = "finished rows are kept, run the same command to resume"
    assert errors.splitlines() == [f"error: the cluster dropped the trials; {again}"]
    with open_executor(None, 1) as executor:
        table = run(STUDY, tmp_path / "out" / "toy", executor, trials=100, progress=Progress()).path
    assert len(table.read_text().splitlines()) == 401


def _without_the_package(folder: Path) -> str:
    """A search path on which an interpreter does not find the package, installed or not."""
    path = folder / "without"
    path.mkdir()
    (path / "sitecustomize.py").write_text(
        "import sys\n"
        "class Hidden:\n"
        "    def find_spec(self, name, path=None, target=None):\n"
        "        if name.partition('.')[0] in {'analysis', 'ratt_opt', 'tests'}:\n"
        "            raise ModuleNotFoundError(f'No module named {name!r}', name=name)\n"
        "sys.meta_path.insert(0, Hidden())\n"
    )
    return str(path)


def test_a_worker_without_the_package_is_one_line(tmp_path: Path) -> None:
    with ExitStack() as stack:
        address = stack.enter_context(scheduler(tmp_path))
        stack.enter_context(workers(1, address, tmp_path, path=_without_the_package(tmp_path)))
        with pytest.raises(InputError, match=r"worker tcp\S+ must import the same package .*; got ModuleNotFoundError"):
            stack.enter_context(open_executor(address, None))


def test_a_worker_without_the_package_that_joins_later_changes_nothing(tmp_path: Path) -> None:
    # It cannot even read a trial: Dask drops it and runs the trial elsewhere.
    with ExitStack() as stack:
        address = stack.enter_context(scheduler(tmp_path))
        stack.enter_context(workers(1, address, tmp_path, seconds=0.05))
        executor = stack.enter_context(open_executor(address, None))
        stack.enter_context(workers(1, address, tmp_path, path=_without_the_package(tmp_path), before=1))
        table = run(STUDY, tmp_path / "dask", executor, trials=5, progress=Progress()).path.read_bytes()
    with open_executor(None, 1) as executor:
        assert run(STUDY, tmp_path / "local", executor, trials=5, progress=Progress()).path.read_bytes() == table


def test_unreachable_cluster_exits_2_with_one_line(tmp_path: Path) -> None:
    command = [sys.executable, "-m", "tests.studies.run_toy", "--out", str(tmp_path), "--cluster", "tcp://127.0.0.1:9"]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=False)
    assert done.returncode == 2
    text = "error: cluster must be the address of a Dask scheduler that answers within 10 s; got tcp://127.0.0.1:9"
    assert done.stderr.splitlines() == [text]
    assert list(tmp_path.iterdir()) == []
