"""The engine: same rows whoever ran them, resumed where they stopped, refused where they do not belong."""

import json
import os
import random
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from concurrent.futures import Executor, Future, ThreadPoolExecutor
from dataclasses import replace
from functools import partial
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

from ratt_opt import InputError
from ratt_opt.studies import engine, versions
from ratt_opt.studies.cases import Case, Seeds
from ratt_opt.studies.engine import SweepError, run
from ratt_opt.studies.executors import local_processes, open_executor
from ratt_opt.studies.progress import Progress
from ratt_opt.studies.store import open_journal, read_table
from ratt_opt.studies.study import run_trial
from tests.studies.toy import STUDY

ROOT = Path(__file__).resolve().parents[2]


def _threads(folder: Path, trials: int = 3, study: object = STUDY) -> bytes:
    with ThreadPoolExecutor(2) as executor:
        path = run(study, folder, executor, trials=trials, progress=Progress()).path
        return path.read_bytes()  # type: ignore[arg-type]


def _rows(folder: Path, trials: int) -> list[dict[str, str]]:
    _threads(folder, trials)
    return read_table(folder)


def _command(folder: Path, *arguments: str, seconds: float = 0.0) -> subprocess.Popen[str]:
    command = [sys.executable, "-m", "tests.studies.run_toy", "--out", str(folder), *arguments]
    environment = os.environ | {"TOY_SECONDS": str(seconds), "PYTHONPATH": str(ROOT)}
    return subprocess.Popen(
        command, cwd=ROOT, env=environment, text=True, stdout=subprocess.PIPE, stderr=subprocess.PIPE
    )


class _AtOnce(Executor):
    """Runs everything when it is submitted."""

    def submit(self, function, /, *arguments, **named):  # type: ignore[no-untyped-def]
        future: Future[object] = Future()
        try:
            future.set_result(function(*arguments, **named))
        except ValueError as error:
            future.set_exception(error)
        return future


def _wait_for(condition: Callable[[], bool], *, seconds: float = 120) -> None:
    """Wait as long as a loaded machine may need; fail rather than go on without it."""
    until = time.monotonic() + seconds
    while not condition():
        assert time.monotonic() < until
        time.sleep(0.01)


def test_seeds_are_the_spawned_ones() -> None:
    for trial, child in enumerate(np.random.SeedSequence(5).spawn(3)):
        word = int(child.spawn(1)[0].generate_state(1, np.uint64)[0] >> 1)
        assert Seeds.of(5, trial).scenario == word
    everything = {
        seed
        for t in range(50)
        for seed in (
            Seeds.of(5, t).scenario,
            Seeds.of(5, t).planner,
            Seeds.of(5, t).attacker,
            Seeds.of(5, t).simulation,
        )
    }
    assert len(everything) == 200


def test_table_is_the_same_bytes_whichever_executor_ran(tmp_path: Path) -> None:
    with local_processes(2) as executor:
        processes = run(STUDY, tmp_path / "p", executor, trials=3, progress=Progress()).path.read_bytes()
    assert processes == _threads(tmp_path / "t")
    rows = read_table(tmp_path / "p")
    assert [(row["case"], int(row["trial"])) for row in rows] == [(c.name, t) for c in STUDY.cases for t in range(3)]
    expected = run_trial(STUDY, 1, 2)
    assert {name: str(value) for name, value in expected.items()} == rows[5]  # str of a float64 is its shortest repr
    assert float(rows[5]["value"]) == expected["value"]
    assert float(rows[5]["scalar"]) == expected["scalar"]


def test_more_trials_extend_the_table_and_repeat_nothing(tmp_path: Path) -> None:
    _threads(tmp_path, 2)
    before = (tmp_path / "journal.csv").read_bytes()
    assert _threads(tmp_path, 4) == _threads(tmp_path / "other", 4)
    assert (tmp_path / "journal.csv").read_bytes().startswith(before)
    assert _threads(tmp_path, 1) == _threads(tmp_path / "other", 4)


def test_trials_that_only_some_cases_have_wait_in_the_journal(tmp_path: Path) -> None:
    _threads(tmp_path / "many", 5)
    lines = (tmp_path / "many" / "journal.csv").read_text().splitlines(keepends=True)
    lines.remove(next(line for line in lines if line.startswith(f"{STUDY.cases[2].name},3,")))
    (tmp_path / "many" / "journal.csv").write_text("".join(lines))
    # Asked for three trials, the table has the four that are whole; asked for five, only the missing row is run.
    assert [row["trial"] for row in _rows(tmp_path / "many", 3)] == ["0", "1", "2", "4"] * 4
    assert (tmp_path / "many" / "journal.csv").read_text() == "".join(lines)
    assert _threads(tmp_path / "many", 5) == _threads(tmp_path / "calm", 5)


@pytest.mark.parametrize("cut", [1, 7, 60])
def test_a_torn_last_line_is_run_again(tmp_path: Path, cut: int) -> None:
    whole = _threads(tmp_path)
    journal = tmp_path / "journal.csv"
    os.truncate(journal, journal.stat().st_size - cut)
    assert _threads(tmp_path) == whole
    os.truncate(journal, 5)  # even the header was torn
    assert _threads(tmp_path) == whole


def test_killed_ten_times_at_random_ends_with_the_same_rows(tmp_path: Path) -> None:
    undisturbed = _threads(tmp_path / "calm", 100)
    rng, sizes = random.Random(3), [0]
    journal = tmp_path / "wild" / "toy" / "journal.csv"
    for kill in range(10):
        process = _command(tmp_path / "wild", "--trials", "100", "--workers", "1", seconds=0.02)
        # Every other kill waits for new rows, so that a slow start does not make them all harmless; the others
        # fall anywhere in the start, the first rows included.
        if kill % 2 == 0:
            _wait_for(lambda: journal.exists() and journal.stat().st_size > sizes[-1])
            time.sleep(rng.uniform(0, 0.15))
        else:
            time.sleep(rng.uniform(0, 0.8))
        assert process.poll() is None
        process.kill()
        process.communicate()
        sizes.append(journal.stat().st_size)
    # A torn last line may be cut off again, but no more than that.
    assert sizes[1] < sizes[5] < sizes[9]
    last = _command(tmp_path / "wild", "--trials", "100", "--workers", "2")
    assert last.communicate()[0].strip() == "400 toy"
    assert (tmp_path / "wild" / "toy" / "table.csv").read_bytes() == undisturbed
    assert len(journal.read_text().splitlines()) == 401


def test_interrupt_says_how_to_resume(tmp_path: Path) -> None:
    process = _command(tmp_path, "--trials", "50", "--workers", "1", seconds=0.05)
    journal = tmp_path / "toy" / "journal.csv"
    _wait_for(lambda: journal.exists() and journal.stat().st_size > 0)
    process.send_signal(signal.SIGINT)
    _, errors = process.communicate(timeout=120)
    assert process.returncode == 130
    assert errors.splitlines()[-1] == "error: interrupted; finished rows are kept, run the same command to resume"
    assert "Traceback" not in errors


WORKING = """
import os, sys, time
from ratt_opt.studies.executors import local_processes
if __name__ == "__main__":
    with local_processes(1) as executor:
        executor.submit(os.getpid)
        try:
            time.sleep(60)
        except KeyboardInterrupt:
            time.sleep(0.3)  # it has to write what it has
            sys.exit(130)
else:
    print("starting", flush=True)
    time.sleep(1)
"""


def test_an_interrupt_of_all_processes_at_once_is_met_by_the_first_alone(tmp_path: Path) -> None:
    """As a terminal sends it, while the others still start: none of them complains."""
    script = tmp_path / "working.py"
    script.write_text(WORKING)
    environment = os.environ | {"PYTHONPATH": str(ROOT)}
    process = subprocess.Popen(
        [sys.executable, str(script)],
        env=environment,
        text=True,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        start_new_session=True,
    )
    assert process.stdout is not None
    assert process.stdout.readline() == "starting\n"
    os.killpg(process.pid, signal.SIGINT)
    _, errors = process.communicate(timeout=60)
    assert process.returncode == 130
    assert errors == ""


def test_other_results_are_refused_and_kept(tmp_path: Path) -> None:
    _threads(tmp_path)
    before = {path.name: path.read_bytes() for path in tmp_path.iterdir()}
    for other, text in (
        (
            replace(STUDY, name="other"),
            "must be a new folder or hold results of study 'other' version 1; got study 'toy'",
        ),
        (replace(STUDY, version=2), "results of study 'toy' version 2; got study 'toy' version 1"),
        (replace(STUDY, seed=1), "results of this definition and seed"),
        (replace(STUDY, cases=STUDY.cases[:1]), "results of this definition and seed"),
    ):
        with pytest.raises(InputError, match=text) as caught:
            _threads(tmp_path, study=other)
        assert "\n" not in str(caught.value)
    assert {path.name: path.read_bytes() for path in tmp_path.iterdir()} == before


def test_results_of_other_versions_or_formats_are_refused(tmp_path: Path) -> None:
    _threads(tmp_path)
    manifest = json.loads((tmp_path / "study.json").read_text())
    for change, text in (
        ({"made_with": "ratt_opt 0.0.1"}, "results made with ratt_opt .*; got ratt_opt 0.0.1 in"),
        ({"format": 9}, "results of format 2; got format 9"),
        ({"study": None, "fingerprint": 3}, "got study None version 1"),
    ):
        (tmp_path / "study.json").write_text(json.dumps(manifest | change))
        with pytest.raises(InputError, match=text):
            _threads(tmp_path)
    (tmp_path / "study.json").write_text("{")
    with pytest.raises(InputError, match="must hold a readable study"):
        _threads(tmp_path)
    (tmp_path / "study.json").unlink()
    with pytest.raises(InputError, match="must be an empty folder"):
        _threads(tmp_path)


def test_a_folder_with_anything_else_in_it_is_refused_and_kept(tmp_path: Path) -> None:
    (tmp_path / "toy.png").write_text("mine")
    with pytest.raises(InputError, match=r"must be an empty folder or hold the study\.json of this study"):
        _threads(tmp_path)
    assert [path.name for path in tmp_path.iterdir()] == ["toy.png"]
    assert (tmp_path / "toy.png").read_text() == "mine"


def test_a_run_killed_while_it_wrote_its_first_file_resumes(tmp_path: Path) -> None:
    (tmp_path / ".study-abc.json").write_text("{")
    assert _threads(tmp_path) == _threads(tmp_path / "other")


@pytest.mark.parametrize("damage", ["a,b\n", "REPEAT"])
def test_damaged_rows_are_refused_by_line(tmp_path: Path, damage: str) -> None:
    _threads(tmp_path, 1)
    journal = tmp_path / "journal.csv"
    lines = journal.read_text().splitlines(keepends=True)
    journal.write_text("".join(lines) + (lines[1] if damage == "REPEAT" else damage))
    with pytest.raises(InputError, match=r"journal.csv line 6 must be one whole row, given once"):
        _threads(tmp_path, 2)


def test_a_folder_in_use_is_refused(tmp_path: Path) -> None:
    with open_journal(STUDY, tmp_path), pytest.raises(InputError, match="must not be in use"):
        _threads(tmp_path)


def test_a_failing_trial_is_named_in_one_line_and_rows_are_kept(tmp_path: Path) -> None:
    study = replace(STUDY, measure="tests.studies.toy:fail")
    text = "study toy, case N=2 M=2 alpha_s=1 alpha_c=0, trial [01] failed .ValueError: no such number."
    # All futures are done before the engine looks at one: whichever it meets first, no finished row is lost.
    with pytest.raises(SweepError, match=text):
        run(study, tmp_path, _AtOnce(), trials=2, progress=Progress())
    kept = {tuple(line.split(",")[:2]) for line in (tmp_path / "journal.csv").read_text().splitlines()[1:]}
    assert kept == {(case.name, str(trial)) for case in STUDY.cases if case != STUDY.cases[1] for trial in (0, 1)}


def test_a_study_whose_first_trial_raised_runs_again_once_its_code_is_mended(tmp_path: Path) -> None:
    broken = replace(STUDY, measure="tests.studies.toy:raise_at_once")
    with pytest.raises(SweepError, match="nothing works yet"):
        _threads(tmp_path, 1, broken)
    assert len(_threads(tmp_path, 1).splitlines()) == 1 + len(STUDY.cases)
    with pytest.raises(InputError, match="another definition or seed"):
        _threads(tmp_path, 1, broken)


def test_a_worker_process_that_dies_is_one_line(tmp_path: Path) -> None:
    study = replace(STUDY, measure="tests.studies.toy:die")
    text = "a worker process died; finished rows are kept, run the same command to resume"
    with pytest.raises(SweepError, match=text), local_processes(1) as executor:
        run(study, tmp_path, executor, trials=2, progress=Progress())


def test_a_killed_run_leaves_no_worker_behind(tmp_path: Path) -> None:
    process = _command(tmp_path, "--trials", "50", "--workers", "2", seconds=0.05)
    journal = tmp_path / "toy" / "journal.csv"
    _wait_for(lambda: journal.exists() and journal.stat().st_size > 0)
    # Workers share the pipe of the parent's output: it closes when the last of them is gone.
    process.kill()
    process.communicate(timeout=120)


def test_bad_arguments_are_one_line_and_exit_2(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    process = _command(tmp_path / "file" / "x")
    assert process.communicate()[1].splitlines()[-1].startswith("error: out must be a folder that can be written")
    assert process.returncode == 2


@pytest.mark.parametrize(
    ("name", "value"), [("--trials", "0"), ("--trials", "2.5"), ("--seed", "-1"), ("--workers", "x")]
)
def test_bad_numbers_name_the_argument(tmp_path: Path, name: str, value: str) -> None:
    process = _command(tmp_path, f"{name}={value}")
    errors = process.communicate()[1]
    assert process.returncode == 2
    assert f"argument {name}: must be an integer >= " in errors.splitlines()[-1]
    assert list(tmp_path.iterdir()) == []


def test_a_cluster_that_does_not_answer_is_one_line() -> None:
    pytest.importorskip("distributed")
    began = time.monotonic()
    text = "cluster must be the address of a Dask scheduler"
    with pytest.raises(InputError, match=text), open_executor("not an address", None):
        pass
    assert time.monotonic() - began < 30


def test_cases_have_distinct_names() -> None:
    case = Case(n_robots=2, n_targets=2, alpha_s=0, alpha_c=0)
    names = {case.name, replace(case, objective="logdet").name, replace(case, options=(("range_std", 0.1),)).name}
    assert len(names) == 3


def test_rows_of_other_code_are_refused_or_kept_with_their_mark(tmp_path: Path) -> None:
    """A change of any source file changes the hash; accepted, the rows stay and the manifest says what made them."""
    before = _threads(tmp_path, 1)
    path = tmp_path / "study.json"
    manifest = json.loads(path.read_text())
    assert manifest["made_with"].endswith(f"code {versions._hash_of_code()}")
    for change in ({"made_with": "ratt_opt 0, code 0"}, {"measured_by": "0" * 12}):
        path.write_text(json.dumps(manifest | change))
        with pytest.raises(InputError, match="--accept-old-rows"):
            _threads(tmp_path, 1)
    with ThreadPoolExecutor(1) as executor:
        table = run(STUDY, tmp_path, executor, trials=2, progress=Progress(), accept_old_rows=True).path
    found = json.loads(path.read_text())
    assert found["older_rows_by"] == [{"made_with": manifest["made_with"], "measured_by": "0" * 12}]
    assert before.splitlines()[1] in table.read_bytes().splitlines()
    assert _threads(tmp_path, 2) == table.read_bytes()


def test_the_hash_of_the_code_sees_every_file(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "a").mkdir()
    (tmp_path / "a" / "__init__.py").write_text("x = 1\n")
    (tmp_path / "a" / "b.py").write_text("y = 1\n")
    monkeypatch.setattr(versions, "ratt_opt", SimpleNamespace(__file__=str(tmp_path / "a" / "__init__.py")))
    first = versions._hash_of_code()
    assert versions._hash_of_code() == first
    (tmp_path / "a" / "b.py").write_text("y = 2\n")
    assert versions._hash_of_code() != first


@pytest.mark.parametrize("kind", ["cell", "encoding", "header", "huge", "quote", "empty line", "folder", "nul"])
def test_every_damage_of_a_journal_is_one_line(tmp_path: Path, kind: str) -> None:
    _threads(tmp_path, 1)
    journal = tmp_path / "journal.csv"
    data = journal.read_bytes()
    lines = data.splitlines(keepends=True)
    number = lines[2].split(b",")[-2]
    damaged = {
        "cell": data.replace(number, number.replace(b"1", b"2") if b"1" in number else b"1" + number, 1),
        "encoding": data[:80] + b"\xff" + data[81:],
        "header": data[3:],
        "huge": data + b"x" * 200_000 + b"\n",
        "quote": data + b'"a"b\n',
        "empty line": data + b"\n",
        "nul": data + b"\0\n",
    }
    if kind == "folder":
        journal.unlink()
        journal.mkdir()
    else:
        journal.write_bytes(damaged[kind])
    with pytest.raises(InputError) as caught:
        _threads(tmp_path, 2)
    assert str(caught.value).isprintable()
    if kind != "folder":
        assert journal.read_bytes() == damaged[kind]


class _NoWorkers(ThreadPoolExecutor):
    """A cluster without workers: its futures never end."""

    class _client:  # noqa: N801
        @staticmethod
        def nthreads() -> dict[str, int]:
            return {}

    def submit(self, function, /, *arguments, **named):  # type: ignore[no-untyped-def]
        del function, arguments, named
        return Future()


def test_a_cluster_that_lost_its_workers_is_a_message(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(engine, "_finished", partial(engine._finished, patience=0.1, look=0.02))
    with _NoWorkers(1) as executor, pytest.raises(SweepError, match=r"no worker for 0\.1 s; finished rows are kept"):
        run(STUDY, tmp_path, executor, trials=1, progress=Progress())
