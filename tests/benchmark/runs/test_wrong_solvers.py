"""Wrong solvers are named, cost only their own row, and leave nothing running."""

import json
import os
import shlex
import sys
import time

import pytest

import ratt_opt as ro
from ratt_opt.benchmark.proofs.answers import worth_of
from ratt_opt.benchmark.runs.process import Limits, run_command
from ratt_opt.benchmark.runs.trial import BenchTrial
from tests.benchmark.small_library import coverage_instance, record_of, small_library


@pytest.fixture(scope="module")
def made(tmp_path_factory):
    folder = tmp_path_factory.mktemp("library")
    return small_library(folder, [coverage_instance()])


def row_of(library, script, *, seconds=1.0, grace=0.3, shell="sh"):
    """One row of a solver that is a shell script; $1 is the instance, $2 the folder."""
    command = f"{shell} -c {shlex.quote(script)} solver {{instance}} {{out}}"
    case = next(case for case in _cases(library))
    return BenchTrial(command, str(library.folder), seconds, grace)(None, case, None)


def _cases(library):
    from ratt_opt.studies import Case

    for name in library.entries:
        yield Case(n_robots=4, n_targets=12, alpha_s=1, alpha_c=0, options=(("instance", name), ("track", "plan")))


def say(**fields):
    return f"echo {shlex.quote(json.dumps(fields))}"


def plan_of(library):
    return ro.greedy(library.instance("cover").team).elements.tolist()


def test_a_good_solver_has_no_fault(made):
    plan = plan_of(made)
    worth = worth_of(made.instance("cover"), {"elements": plan}, 10).lower
    row = row_of(made, say(elements=plan, lower=worth, upper=1000.0))
    assert row["faults"] == ""
    assert row["value"] == worth
    assert row["claimed"] == 1000.0
    assert row["proved"] == ""  # a word is no proof
    assert 0 < row["gap"] < 1
    assert row["gap"] < row["integral"] < 1


@pytest.mark.parametrize(
    ("script", "fault"),
    [
        (say(elements=[0, 1, 2, 3]), "line 1: elements[1] must be an element of robot 1; got 1 of robot 0"),
        (say(elements=[0, 3, 6]), "line 1: elements must hold one element per robot"),
        (say(elements="0 3 6 9"), "line 1: elements must be a list; got str"),
        (say(elements=[0, 3, 6, 9], lower="high"), "line 1: lower must be a number; got high"),
        (say(elements=[0, 3, 6, 9], certificate="../x"), "certificate must be the plain name of a file"),
        ("echo '[1, 2]'", "line 1 is no JSON object"),
        ("echo hello", "line 1 is no JSON object"),
        ("""printf '{"elements": [0, 3'""", "output stops in the middle of a line, line 1"),
        ("exit 3", "ended with exit code 3: nothing on standard error"),
        ("echo broken >&2; exit 1", "ended with exit code 1: broken"),
        ("kill -9 $$", "ended with exit code -9"),
        ("true", "printed no answer"),
        (say(certificate="none.json"), "certificate none.json: "),
        (f"{say(certificate='c.json')}; echo '{{}}' > $2/c.json", "certificate c.json: "),
        ("while :; do echo '{}'; done", "killed"),
    ],
)
def test_faults_are_named(made, script, fault):
    row = row_of(made, script, seconds=0.5)
    assert fault in row["faults"]


def test_lies_are_named_and_do_not_count(made):
    instance, plan = made.instance("cover"), plan_of(made)
    worth, best = worth_of(instance, {"elements": plan}, 10).lower, made.best["cover"].value
    row = row_of(made, say(elements=plan, lower=worth + 1))
    assert f"claims that its answer is worth {worth + 1:g}, but it is worth {worth:g}" in row["faults"]
    assert row["value"] == worth
    row = row_of(made, say(elements=plan, lower=worth, upper=worth))
    assert f"claims that nobody passes {worth:g}, but {best:g} is attained" in row["faults"]
    assert row["proved"] == ""


def test_a_bound_counts_if_its_certificate_verifies(made, tmp_path):
    record = record_of(made.instance("cover"), tmp_path)
    path = tmp_path / "proof.json"
    path.write_text(json.dumps(record["certificate"]), encoding="utf-8")
    script = f"cp {path} $2/p.json; {say(elements=record['elements'])}; {say(certificate='p.json')}"
    row = row_of(made, script)
    assert (row["faults"], row["value"], row["proved"]) == ("", record["value"], record["bound"])
    forged = json.loads(path.read_text(encoding="utf-8"))
    forged["claim"]["upper"] = forged["claim"]["lower"]
    forged["claim"]["upper"] *= 0.9
    path.write_text(json.dumps(forged), encoding="utf-8")
    row = row_of(made, script)
    assert "certificate p.json: " in row["faults"]
    assert row["proved"] == ""
    assert row["value"] == record["value"]


def test_answers_before_a_kill_count(made):
    plan = plan_of(made)
    row = row_of(made, f"{say(elements=plan)}; sleep 60", seconds=0.3)
    assert row["faults"] == "killed 0.3 s after its 0.3 s"
    assert row["value"] == worth_of(made.instance("cover"), {"elements": plan}, 10).lower
    assert row["seconds"] < 5


@pytest.mark.skipif(sys.platform == "win32", reason="no process groups")
@pytest.mark.parametrize(
    "script",
    [
        "trap '' TERM INT HUP; echo $$ > FILE; while :; do sleep 0.05; done",
        "(trap '' TERM; echo $BASHPID > FILE; exec sleep 300) & sleep 300",
        "setsid sh -c 'echo $$ > FILE; exec sleep 300' & sleep 300",
        "setsid sh -c 'echo $$ > FILE; exec sleep 300' & sleep 0.1; exit 0",
        "(echo $BASHPID > FILE; exec sleep 300) & sleep 0.1; exit 0",
    ],
)
def test_no_process_survives(script, tmp_path):
    pid_file = tmp_path / "pid"
    words = ["bash", "-c", script.replace("FILE", str(pid_file))]
    began = time.monotonic()
    run = run_command(words, tmp_path, Limits(seconds=0.4, grace=0.2))
    assert time.monotonic() - began < 8
    assert run.killed or run.left_behind
    pid = int(pid_file.read_text())
    for _ in range(100):
        if not _lives(pid):
            break
        time.sleep(0.02)
    assert not _lives(pid)


def _lives(pid):
    try:
        with open(f"/proc/{pid}/stat", encoding="ascii") as stat:
            return stat.read().rsplit(")", 1)[1].split()[0] != "Z"
    except OSError:
        try:
            os.kill(pid, 0)
        except OSError:
            return False
        return True


def test_a_command_that_is_none_is_named(made):
    case = next(_cases(made))
    row = BenchTrial("no-such-solver {instance}", str(made.folder), 1.0)(None, case, None)
    assert "cannot be started: No such file" in row["faults"]
    with pytest.raises(ro.InputError, match=r"--solver must hold \{instance\}"):
        BenchTrial("solver", str(made.folder), 1.0)(None, case, None)
    with pytest.raises(ro.InputError, match="--solver must be words as a shell splits them"):
        BenchTrial("solver '{instance}", str(made.folder), 1.0)(None, case, None)


def test_an_interrupt_kills_the_solver_and_keeps_the_rows(tmp_path):
    import signal
    import subprocess

    small_library(tmp_path / "lib", [coverage_instance("a"), coverage_instance("b", seed=1)])
    pid_file, out = tmp_path / "pid", tmp_path / "out"
    (tmp_path / "s.sh").write_text(
        f'grep -q \'"name":"a"\' $1 && {say(elements=[0, 3, 6, 9])} && exit; echo $$ > {pid_file}; exec sleep 100\n',
        encoding="utf-8",
    )
    words = [sys.executable, "-m", "ratt_opt", "bench", "run", str(tmp_path / "lib"), "--out", str(out), "--time", "60"]
    solver = f"sh {tmp_path / 's.sh'} {{instance}}"
    process = subprocess.Popen(
        [*words, "--solver", solver, "--name", "s"], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    )
    for _ in range(600):
        if pid_file.exists() and pid_file.read_text().strip():
            break
        time.sleep(0.05)
    process.send_signal(signal.SIGINT)
    _, errors = process.communicate(timeout=20)
    assert process.returncode == 130
    assert "run the same command to resume" in errors
    assert not _lives(int(pid_file.read_text()))
    (tmp_path / "s.sh").write_text(say(elements=[0, 3, 6, 9]), encoding="utf-8")
    again = subprocess.run([*words, "--solver", solver, "--name", "s"], capture_output=True, text=True, check=True)
    assert "1/2 trials" in again.stderr or "2/2 trials" in again.stderr
    assert "2 instances" in again.stdout
