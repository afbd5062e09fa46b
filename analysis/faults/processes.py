"""Kinds of cases that need processes of their own: kills, lost workers, interrupts from the start on, streams."""

import contextlib
import os
import signal
import subprocess
import sys
from pathlib import Path
from time import monotonic, sleep

import numpy as np

from analysis.faults.campaign import LONGEST, SWEEP, Campaign, Kind, command, start_clock
from analysis.faults.results import check_results, earlier_results
from ratt_opt.studies.command import Entry, main
from ratt_opt.studies.store import open_journal, read_table
from ratt_opt.studies.study import run_trial

__all__ = ["PROCESSES", "sweep"]

_TELLING = """
import ratt_opt.cli as cli
def told(arguments, run=cli.run):
    print(flush=True)
    return run(arguments)
cli.run = told
cli.main()
"""
PROGRAM = [sys.executable, "-c", _TELLING]
"""Program that prints an empty line once its guards stand: before, Python itself shows an interrupt."""
SWEEP_PROGRAM = [sys.executable, "-c", "import sys; from analysis.faults.processes import sweep; sys.exit(sweep())"]
TRIALS = 20


def sweep() -> int:
    """Run the sweep that cases disturb, as its own command line says."""
    return main("A sweep to be disturbed.", [Entry(SWEEP, lambda *_: None)], trials=TRIALS)


def _commands(campaign: Campaign, place: Path) -> list[list[str]]:
    file, plan = str(campaign.put(place, "scenario.json")), str(campaign.put(place, "plan.json"))
    return [
        ["verify", str(campaign.put(place, "trace.json")), "--json"],
        ["attack", file, "--plan", plan],
        ["new", "--robots", "2", "--targets", "1", "--sensing-attacks", "0", "--link-attacks", "0", "--seed", "1",
         "--out", str(place / "n.json")],
        ["schema"],
        ["attack", "--help"],
    ]  # fmt: skip


def _killed(campaign: Campaign, rng: np.random.Generator, place: Path) -> str:
    """``bound`` killed at a random time, over an earlier set of files; a later run makes it whole again."""
    file, out = campaign.put(place, "scenario.json"), earlier_results(campaign, place)
    words = ["bound", str(file), "--out", str(out)]
    with subprocess.Popen([*PROGRAM, *words], stdout=subprocess.PIPE, stderr=subprocess.DEVNULL) as process:
        assert process.stdout is not None
        process.stdout.readline()
        with contextlib.suppress(subprocess.TimeoutExpired):
            process.wait(float(rng.uniform(0, 1 + 1.1 * campaign.seconds)))
        process.kill()
    check_results(campaign, out)
    if rng.random() < 0.2:
        start_clock()
        assert command(words)[0] == 0, "a killed run cannot be repeated"
        check_results(campaign, out)
    return "done" if process.returncode == 0 else "interrupted"


def _interrupted(campaign: Campaign, rng: np.random.Generator, place: Path) -> str:
    """An interrupt at a random time of a process, from its first line to its last."""
    words = [*_commands(campaign, place), ["bound", str(place / "scenario.json"), "--out", str(place / "o")]]
    k = int(rng.integers(len(words)))
    last = (1 + 1.1 * campaign.seconds) if k == len(words) - 1 else 1.0
    options = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE}
    with subprocess.Popen([*PROGRAM, *words[k]], text=True, **options) as process:  # type: ignore[call-overload]
        process.stdout.readline()
        with contextlib.suppress(subprocess.TimeoutExpired):
            process.wait(float(rng.uniform(0, last)))
        process.send_signal(signal.SIGINT)
        _, said = process.communicate(timeout=LONGEST)
    # Python takes its own handler back when nothing of ours is left to run.
    assert process.returncode in {0, 130, -signal.SIGINT}, f"exit code {process.returncode} of {words[k]!a}: {said!a}"
    assert "Traceback" not in said, f"traceback of {words[k]!a}: {said!a}"
    assert "Exception ignored" not in said, f"complaint of {words[k]!a}: {said!a}"
    return "done" if process.returncode == 0 else "interrupted"


def _streams(campaign: Campaign, rng: np.random.Generator, place: Path) -> str:
    """A process whose streams are closed, full or nobody's."""
    ways = {"<&-": False, "2>&-": False, ">&-": True, ">&- 2>&-": True, "<&- >&- 2>&-": True, ">/dev/full": True}
    way = str(rng.choice(list(ways)))
    commands = _commands(campaign, place)
    words = commands[int(rng.integers(len(commands)))]
    program = [sys.executable, "-c", "from ratt_opt.cli import main; main()"]
    done = subprocess.run(
        ["/bin/sh", "-c", f'exec "$0" "$@" {way}', *program, *words],
        capture_output=True, text=True, timeout=LONGEST, check=False,
    )  # fmt: skip
    assert done.returncode == (74 if ways[way] else 0), f"exit code {done.returncode} of {words!a} {way}"
    assert "Traceback" not in done.stderr, f"traceback of {words!a} {way}: {done.stderr!a}"
    return "refused" if ways[way] else "done"


def _disturbed_sweep(campaign: Campaign, rng: np.random.Generator, place: Path) -> str:
    """A sweep whose workers or whose own process are killed or interrupted, and that is started again until it ends."""
    del campaign
    words = [*SWEEP_PROGRAM, "--out", str(place), "--workers", "2"]
    for _ in range(2):
        _disturb(words, rng)
        with open_journal(SWEEP, place / SWEEP.name) as journal:
            done = journal.done
        lines = (place / SWEEP.name / "journal.csv").read_bytes().count(b"\n")
        assert lines == len(done) + bool(lines), "a row was repeated"
    start_clock()
    last = subprocess.run(words, capture_output=True, text=True, timeout=LONGEST, check=False)
    assert last.returncode == 0, f"the sweep cannot be resumed: {last.stderr!a}"
    expected = [run_trial(SWEEP, case, trial) for case in range(len(SWEEP.cases)) for trial in range(TRIALS)]
    found = [float(row["value"]) for row in read_table(place / SWEEP.name)]
    assert found == [row["value"] for row in expected], "a row was lost, repeated or changed"
    return "done"


def _disturb(words: list[str], rng: np.random.Generator) -> None:
    """Start a sweep, and kill a worker, kill it or interrupt it once it has workers."""
    way = str(rng.choice(["worker", "kill", "interrupt"]))
    start_clock()
    with subprocess.Popen(words, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True) as process:
        began = monotonic()
        while process.poll() is None and not _workers(process.pid) and monotonic() - began < LONGEST:
            sleep(0.01)
        sleep(float(rng.uniform(0, 1.5)))
        if way == "kill":
            process.kill()
        elif way == "interrupt":
            process.send_signal(signal.SIGINT)
        else:
            for child in _workers(process.pid)[-1:]:
                with contextlib.suppress(ProcessLookupError):
                    os.kill(child, signal.SIGKILL)
        _, said = process.communicate(timeout=LONGEST)
    # An interrupt after the last trial can meet Python as it ends, as above.
    allowed = {"worker": {0, 1}, "kill": {0, -signal.SIGKILL}, "interrupt": {0, 130, -signal.SIGINT}}[way]
    assert process.returncode in allowed, f"exit code {process.returncode} of a sweep after {way}: {said!a}"
    assert "Traceback" not in said, f"traceback of a sweep after {way}: {said!a}"


def _workers(parent: int) -> list[int]:
    """The processes that run the trials of a sweep, by the system's own list."""
    try:
        text = Path(f"/proc/{parent}/task/{parent}/children").read_text(encoding="ascii")
        return [int(child) for child in text.split() if b"spawn_main" in Path(f"/proc/{child}/cmdline").read_bytes()]
    except OSError:  # one of them has ended meanwhile
        return []


PROCESSES: dict[str, tuple[float, Kind]] = {
    "kill": (0.001, _killed),
    "interrupt of a process": (0.002, _interrupted),
    "streams of a process": (0.001, _streams),
    "disturbed sweep": (0.0005, _disturbed_sweep),
}
"""Each kind of case, how often it comes, and what it does."""
