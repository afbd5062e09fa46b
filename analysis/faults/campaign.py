"""Runs of cases: in this process, timed, and every surprise noted as a fault."""

import contextlib
import io
import os
import signal
import tempfile
from collections import Counter
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from time import monotonic, process_time, sleep
from typing import Any

import numpy as np

import ratt_opt as ro
from ratt_opt._files import write_json
from ratt_opt.cli import run
from ratt_opt.studies.cases import Case, Seeds
from ratt_opt.studies.store import open_journal
from ratt_opt.studies.study import Study, run_trial

__all__ = [
    "LONGEST",
    "MISSION",
    "STUDY",
    "SWEEP",
    "Campaign",
    "Kind",
    "command",
    "hang",
    "measure",
    "measure_slowly",
    "start_clock",
]

CODES = {0, 1, 2, 3, 4, 74, 130}
"""All exit codes that the command line documents but 70, which is a fault of the program."""
LONGEST = 20.0
"""Seconds that a case, or each run in one of several runs, may take."""
STUDY = Study(
    name="faults",
    cases=tuple(Case(n_robots=n, n_targets=1, alpha_s=0, alpha_c=0) for n in (1, 2)),
    measure="analysis.faults.campaign:measure",
)
MISSION: dict[str, Any] = {"steps": 3, "seed": 1}
SWEEP = replace(STUDY, name="sweep", measure="analysis.faults.campaign:measure_slowly")


def measure(study: Study, case: Case, seeds: Seeds) -> dict[str, Any]:
    """One cheap row."""
    del study
    return {"value": float(np.random.default_rng([seeds.simulation, case.n_robots]).standard_normal())}


def measure_slowly(study: Study, case: Case, seeds: Seeds) -> dict[str, Any]:
    """One row that leaves time to be disturbed."""
    sleep(0.02)
    return measure(study, case, seeds)


class _HangError(BaseException):
    """A case took too long."""


Kind = Callable[["Campaign", np.random.Generator, Path], str]
"""Runs one case in a folder of its own and returns what became of it; an ``AssertionError`` is a fault."""


@dataclass(slots=True)
class Campaign:
    """The cases of one seed: ``counts`` of outcomes, and ``faults`` in words, by case.

    ``files`` : the whole files that cases damage or start from; ``seconds`` : what ``bound`` takes here.
    """

    seed: int
    folder: Path
    counts: Counter[str] = field(default_factory=Counter)
    faults: dict[int, str] = field(default_factory=dict)
    files: dict[str, bytes] = field(default_factory=dict)
    seconds: float = 0.0

    def prepare(self) -> None:
        """Make the whole files that cases damage."""
        home = self.folder / "whole"
        home.mkdir(parents=True)
        scenario = ro.random_scenario(3, 2, alpha_s=1, alpha_c=1, seed=self.seed)
        small = [control for k, control in enumerate(scenario.robots[0].controls) if k % 6 == 0]
        scenario = scenario.replace(robots=tuple(robot.replace(controls=small) for robot in scenario.robots))
        ro.save_scenario(scenario, home / "scenario.json")
        for objective in ("trace", "logdet", "maxeig"):
            problem = scenario.problem(objective)
            ro.certify(problem, ro.solve_maxmin(problem), home / f"{objective}.json")
        write_json(home / "plan.json", {"controls": [0, 1, 0]})
        self._run_all(home)
        record = {"format": "ratt-opt information", "version": 1, "alpha_s": 1, "alpha_c": 0, "robot": [0, 0, 1]}
        matrices = {"prior": [[[2.0]]], "information": [[[[1.0]]], [[[2.0]]], [[[0.5]]]], "labels": ["a", "[b]", "c"]}
        write_json(home / "information.json", record | matrices)
        with open_journal(STUDY, home / "journal") as journal:
            for trial in range(3):
                for case in range(len(STUDY.cases)):
                    journal.append(run_trial(STUDY, case, trial))
        ro.run_mission(scenario, **MISSION, journal=home / "mission.jsonl")
        self.files = {
            file.relative_to(home).as_posix(): file.read_bytes() for file in home.rglob("*") if file.is_file()
        }

    def _run_all(self, home: Path) -> None:
        """Run every command once: an interrupt inside an import would leave this process with half a module."""
        file, other = str(home / "scenario.json"), home / "other.json"
        command(["attack", file, "--plan", str(home / "plan.json")])
        command(["verify", str(home / "trace.json"), "--problem", file])
        ro.save_scenario(ro.random_scenario(4, 1, alpha_s=1, alpha_c=0, seed=self.seed), other)
        command(["bound", str(other), "--out", str(home / "results")])
        began = monotonic()
        command(["bound", file, "--out", str(home / "again")])
        self.seconds = monotonic() - began

    def run_case(self, number: int, kinds: Mapping[str, tuple[float, Kind]]) -> None:
        """Run one case, of a kind drawn with its share, and note what became of it."""
        rng = np.random.default_rng([self.seed, number])
        names = list(kinds)
        kind = names[int(rng.choice(len(names), p=np.array([kinds[name][0] for name in names])))]
        before, used = signal.signal(signal.SIGALRM, hang), process_time()
        start_clock()
        try:
            with tempfile.TemporaryDirectory(dir=self.folder) as place:
                outcome = kinds[kind][1](self, rng, Path(place))
        except AssertionError as fault:
            outcome = "fault"
            self.faults[number] = f"{kind}: {fault}"
        except _HangError:
            outcome = "fault"
            # Where those are many a busy machine may be the reason: --case runs one again.
            machine = f"load {os.getloadavg()[0]:.1f} on {os.cpu_count()} processors"
            self.faults[number] = (
                f"{kind}: more than {LONGEST:g} s, {process_time() - used:.1f} s of them at work; {machine}"
            )
        except Exception as fault:  # noqa: BLE001  (every exception that reaches this is what the campaign looks for)
            outcome = "fault"
            self.faults[number] = f"{kind}: {type(fault).__name__}: {fault}"
        finally:
            signal.setitimer(signal.ITIMER_REAL, 0)
            signal.signal(signal.SIGALRM, before)
        self.counts[f"{kind}: {outcome}"] += 1

    def put(self, place: Path, name: str, content: bytes | None = None) -> Path:
        """Write a whole file, or other content under its name."""
        path = place / name
        path.parent.mkdir(exist_ok=True)
        path.write_bytes(self.files[name] if content is None else content)
        return path


def start_clock() -> None:
    """Let the alarm clock start anew, in a case of several runs."""
    signal.setitimer(signal.ITIMER_REAL, LONGEST)


def hang(*_: object) -> None:
    """Stop a case that takes too long; the alarm clock calls this."""
    raise _HangError


def command(arguments: list[str]) -> tuple[int, str]:
    """Run the command line here; check its exit code and what it says."""
    out, errors = io.StringIO(), io.StringIO()
    with contextlib.redirect_stdout(out), contextlib.redirect_stderr(errors):
        code = run(arguments)
    said = errors.getvalue()
    assert code in CODES, f"exit code {code} of {arguments!a}: {said!a}"
    assert "Traceback" not in said, f"traceback of {arguments!a}"
    assert all(line.isprintable() for line in said.splitlines()), f"unprintable text of {arguments!a}: {said!a}"
    lines = [line for line in said.split("\n") if line.startswith("error: ")]
    # An interrupt may come while another refusal is on its way out.
    allowed = {0} if code in {0, 3} else {1, 2} if code == 130 else {1}
    assert len(lines) in allowed, f"{len(lines)} error lines of {arguments!a}: {said!a}"
    return code, out.getvalue()
