"""A fault campaign: what strangers, full disks, interrupts and kills can do to the command line and to sweeps.

``python -m analysis.faults --cases 20000 --seed 1 --out DIR`` runs the command line in this process on damaged files,
odd flags, closed streams, small file-size limits and interrupts at random times, opens damaged journals, and kills
processes now and then. Case ``k`` of seed ``s`` is always the same. A fault is: an exit code that is not documented, a
traceback, a refusal of more than one printable line, more than 20 s, a certificate accepted whose claim is false, a
file replaced that should not be, a row lost or repeated. The command exits with 1 when there is one.
"""

from __future__ import annotations

import argparse
import contextlib
import io
import json
import math
import resource
import shutil
import signal
import subprocess
import sys
import tempfile
from collections import Counter
from dataclasses import dataclass, field
from pathlib import Path
from time import monotonic
from typing import TYPE_CHECKING, Any

import networkx as nx
import numpy as np

import ratt_opt as ro
from analysis.studies.store import open_journal
from analysis.studies.study import Case, Seeds, Study, run_trial
from ratt_opt._files import output_directory, write_json
from ratt_opt.cli import run
from ratt_opt.setfunctions.criteria.registry import criterion_called

if TYPE_CHECKING:
    from collections.abc import Iterator

__all__ = ["Campaign", "main"]

CODES = {0, 1, 2, 3, 4, 74, 130}
"""All exit codes that the command line documents but 70, which is a fault of the program."""
LONGEST = 20.0
"""Seconds that a case may take."""
ODD = (
    "",
    "0",
    "-1",
    "nan",
    "inf",
    "1e999",
    "true",
    "[b]",
    "\x1b[2J",
    "\u202e",
    "\udc80",
    "a\0b",
    "9" * 5000,
    "--",
    "x=1",
)
VALUES: tuple[Any, ...] = (
    None, True, False, 0, -1, 1, 2**53, 2**64, -0.0, 5e-324, 1e-12, 1e12, 1e300, "", "x", "[b]", "\u202e", "\ud800",
    [], {}, [0, 0],
)  # fmt: skip
STUDY = Study(
    name="faults",
    cases=tuple(Case(n_robots=n, n_targets=1, alpha_s=0, alpha_c=0) for n in (1, 2)),
    measure="analysis.faults:measure",
)


def measure(study: Study, case: Case, seeds: Seeds) -> dict[str, Any]:
    """One cheap row."""
    del study
    return {"value": float(np.random.default_rng([seeds.simulation, case.n_robots]).standard_normal())}


class _HangError(BaseException):
    """A case took too long."""


@dataclass(slots=True)
class Campaign:
    """The cases of one seed: ``counts`` of outcomes, and ``faults`` in words, by case."""

    seed: int
    folder: Path
    counts: Counter[str] = field(default_factory=Counter)
    faults: dict[int, str] = field(default_factory=dict)
    files: dict[str, bytes] = field(default_factory=dict)

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
        # All imports come first: an interrupt inside one leaves this process with half a module.
        file = str(home / "scenario.json")
        _command(["attack", file, "--plan", str(home / "plan.json")])
        _command(["verify", str(home / "trace.json"), "--problem", file])
        record = {"format": "ratt-opt information", "version": 1, "alpha_s": 1, "alpha_c": 0, "robot": [0, 0, 1]}
        matrices = {"prior": [[[2.0]]], "information": [[[[1.0]]], [[[2.0]]], [[[0.5]]]], "labels": ["a", "[b]", "c"]}
        write_json(home / "information.json", record | matrices)
        with open_journal(STUDY, home / "journal") as journal:
            for trial in range(3):
                for case in range(len(STUDY.cases)):
                    journal.append(run_trial(STUDY, case, trial))
        self.files = {
            file.relative_to(home).as_posix(): file.read_bytes() for file in home.rglob("*") if file.is_file()
        }

    def run_case(self, number: int) -> None:
        """Run one case and note what became of it."""
        rng = np.random.default_rng([self.seed, number])
        names = list(KINDS)
        kind = names[int(rng.choice(len(names), p=np.array([KINDS[name][0] for name in names])))]
        before = signal.signal(signal.SIGALRM, _hang)
        signal.setitimer(signal.ITIMER_REAL, LONGEST)
        try:
            with tempfile.TemporaryDirectory(dir=self.folder) as place:
                outcome = KINDS[kind][1](self, rng, Path(place))
        except AssertionError as fault:
            outcome = "fault"
            self.faults[number] = f"{kind}: {fault}"
        except _HangError:
            outcome = "fault"
            self.faults[number] = f"{kind}: more than {LONGEST:g} s"
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


def _hang(*_: object) -> None:
    raise _HangError


def _damaged(data: bytes, rng: np.random.Generator) -> bytes:
    """Bytes changed, cut or repeated, or one value of the JSON replaced."""
    way = int(rng.integers(5))
    if way == 0 or not data.lstrip().startswith(b"{"):
        spots = rng.integers(0, len(data), int(rng.integers(1, 4)))
        changed = bytearray(data)
        for spot in spots:
            changed[int(spot)] = int(rng.integers(256))
        return bytes(changed)
    if way == 1:
        first, last = sorted(int(x) for x in rng.integers(0, len(data), 2))
        return data[:first] + data[last:] if rng.random() < 0.5 else data[:last] + data[first:]
    document = json.loads(data)
    for _ in range(int(rng.integers(1, 3))):
        _replace_one(document, rng)
    return json.dumps(document).encode()


def _replace_one(document: Any, rng: np.random.Generator) -> None:
    """Walk to a random place of a document, and replace, scale, remove or repeat what is there."""
    while True:
        keys = list(document) if isinstance(document, dict) else list(range(len(document)))
        if not keys:
            return
        key = keys[int(rng.integers(len(keys)))]
        value = document[key]
        if isinstance(value, (dict, list)) and value and rng.random() < 0.85:
            document = value
            continue
        way = int(rng.integers(4))
        number = isinstance(value, (int, float)) and not isinstance(value, bool)
        if way == 0 and number:
            document[key] = value * (1 + float(rng.normal(0, 10.0 ** rng.integers(-16, 1))))
        elif way == 1 and number:
            document[key] = value + int(rng.integers(-2, 3))
        elif way == 2 and isinstance(document, list):
            document.insert(key, value)
        elif way == 3 and rng.random() < 0.3:
            del document[key]
        else:
            document[key] = VALUES[int(rng.integers(len(VALUES)))]
        return


def _command(arguments: list[str]) -> tuple[int, str]:
    """Run the command line here; check its exit code and what it says."""
    out, errors = io.StringIO(), io.StringIO()
    with contextlib.redirect_stdout(out), contextlib.redirect_stderr(errors):
        code = run(arguments)
    said = errors.getvalue()
    assert code in CODES, f"exit code {code} of {arguments!a}: {said!a}"
    assert "Traceback" not in said, f"traceback of {arguments!a}"
    assert all(line.isprintable() for line in said.splitlines()), f"unprintable text of {arguments!a}: {said!a}"
    lines = [line for line in said.split("\n") if line.startswith("error: ")]
    assert len(lines) == (code not in {0, 3}), f"{len(lines)} error lines of {arguments!a}: {said!a}"
    return code, out.getvalue()


def _verify(campaign: Campaign, rng: np.random.Generator, place: Path) -> str:
    name = str(rng.choice(["trace", "logdet", "maxeig"])) + ".json"
    path = campaign.put(place, name, _damaged(campaign.files[name], rng))
    code, shown = _command(["verify", str(path), "--json", "--time-limit", "10"])
    if code in {0, 3}:
        found = json.loads(shown)
        lower, upper = _truth(json.loads(path.read_bytes()), found["elements"])
        slack = 1e-9 * max(1.0, abs(upper))
        assert upper <= found["upper"] + slack, f"false upper end: {upper} above {found['upper']}"
        assert code == 3 or lower >= found["lower"] - slack, f"false lower end: {lower} below {found['lower']}"
    return _said(code)


def _truth(document: Any, elements: list[int]) -> tuple[float, float]:
    """The plan's worst case and the optimum of the problem that a certificate states, by brute force."""
    record = document["problem"]
    d = record["dimension"]

    def full(flat: list[float]) -> Any:
        matrix = np.zeros((d, d))
        matrix[np.tril_indices(d)] = flat
        return matrix + np.tril(matrix, -1).T

    graph: nx.Graph = nx.Graph()
    graph.add_nodes_from(range(max(record["owners"]) + 1))
    graph.add_edges_from(record["links"])
    information = np.array([[full(x) for x in row] for row in record["information"]])
    prior = np.array([full(x) for x in record["prior"]])
    objective = criterion_called(record["objective"])(prior, information, record["weights"])
    safe = frozenset(record["protected_robots"]), frozenset((i, j) for i, j in record["protected_links"])
    problem = ro.Problem(objective, record["owners"], graph, record["alpha_s"], record["alpha_c"], *safe)
    return ro.worst_case_attack(problem, elements).lower, ro.exhaustive_optimum(problem).upper


def _said(code: int) -> str:
    return {0: "done", 3: "half proved", 130: "interrupted"}.get(code, "refused")


def _attack(campaign: Campaign, rng: np.random.Generator, place: Path) -> str:
    name = str(rng.choice(["scenario.json", "information.json"]))
    which = int(rng.integers(3))
    file = campaign.put(place, name, _damaged(campaign.files[name], rng) if which else None)
    plan = campaign.put(place, "plan.json", None if which else _damaged(campaign.files["plan.json"], rng))
    return _said(_command(["attack", str(file), "--plan", str(plan), "--time-limit", "2"])[0])


def _flags(campaign: Campaign, rng: np.random.Generator, place: Path) -> str:
    file, plan = str(campaign.put(place, "scenario.json")), str(campaign.put(place, "plan.json"))
    kept = place / "kept.json"
    kept.symlink_to(file)
    commands = [
        ["attack", file, "--plan", plan, "--rank", "1", "--seed", "1", "--below", "1", "--time-limit", "1"],
        ["verify", file, "--problem", file, "--objective", "trace", "--time-limit", "1"],
        ["new", "--robots", "2", "--targets", "1", "--seed", "1", "--sensing-attacks", "0", "--link-attacks", "0",
         "--range", "10", "--out", str(rng.choice([str(kept), str(place), "/dev/null", str(place / "n.json")]))],
        ["schema", "scenario"],
    ]  # fmt: skip
    command = commands[int(rng.integers(len(commands)))]
    for _ in range(int(rng.integers(1, 3))):
        spot = int(rng.integers(len(command)))
        if command[spot] != "--out" and command[spot - 1] != "--out":
            command[spot] = str(rng.choice(ODD))
    code, _ = _command([text for text in command if rng.random() > 0.03])
    assert kept.is_symlink(), "a symbolic link was replaced"
    assert Path("/dev/null").is_char_device(), "a device was replaced"
    return _said(code)


def _journal(campaign: Campaign, rng: np.random.Generator, place: Path) -> str:
    whole = campaign.files["journal/journal.csv"]
    campaign.put(place, "journal/study.json")
    damaged = _damaged(whole, rng) if rng.random() < 0.7 else whole[: int(rng.integers(len(whole)))]
    path = campaign.put(place, "journal/journal.csv", damaged)
    refusal = ""
    try:
        with open_journal(STUDY, path.parent) as journal:
            done = journal.done
    except ro.InputError as error:
        refusal = str(error)
    if refusal:
        assert refusal.isprintable(), "a refusal is not one line"
        return "refused"
    header, *lines = path.read_bytes().splitlines() or [b""]
    assert set(lines) <= set(whole.splitlines()), "a row was accepted that nobody wrote"
    assert len(done) == len(lines) == len(set(lines)), "a row was lost or repeated"
    assert not lines or header == whole.splitlines()[0], "a header was accepted that nobody wrote"
    return "done"


@contextlib.contextmanager
def _file_size_limit(size: int) -> Iterator[None]:
    soft, hard = resource.getrlimit(resource.RLIMIT_FSIZE)
    before = signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
    resource.setrlimit(resource.RLIMIT_FSIZE, (size, hard))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, (soft, hard))
        signal.signal(signal.SIGXFSZ, before)


def _full_disk(campaign: Campaign, rng: np.random.Generator, place: Path) -> str:
    """``new`` over an earlier file, on a disk with room for less: the earlier file stays whole."""
    out = campaign.put(place, "scenario.json")
    command = ["new", "--robots", "9", "--targets", "3", "--sensing-attacks", "1", "--link-attacks", "1", "--seed", "1"]
    with _file_size_limit(int(rng.integers(0, 8000))):
        code, _ = _command([*command, "--out", str(out)])
    assert code == 0 or out.read_bytes() == campaign.files["scenario.json"], "an earlier file was damaged"
    ro.load_scenario(out)
    assert sorted(file.name for file in place.iterdir()) == ["scenario.json"], "something was left behind"
    return _said(code)


def _interrupted(campaign: Campaign, rng: np.random.Generator, place: Path) -> str:
    """An interrupt at a random time of ``attack``, ``verify`` or ``new``."""
    file, plan = campaign.put(place, "scenario.json"), campaign.put(place, "plan.json")
    proof = campaign.put(place, "trace.json")
    out = place / "n.json"
    commands = [
        ["attack", str(file), "--plan", str(plan)],
        ["verify", str(proof), "--problem", str(file)],
        ["new", "--robots", "9", "--targets", "3", "--sensing-attacks", "1", "--link-attacks", "1", "--seed", "1",
         "--out", str(out)],
    ]  # fmt: skip
    signal.signal(signal.SIGALRM, signal.default_int_handler)
    signal.setitimer(signal.ITIMER_REAL, float(rng.uniform(1e-4, 0.03)))
    try:
        code, _ = _command(commands[int(rng.integers(3))])
    except KeyboardInterrupt:  # before or after the command itself
        code = 130
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0)
    if out.exists():
        ro.load_scenario(out)
    assert not [x for x in place.iterdir() if x.name.startswith(".")] or code == 130, "something was left behind"
    return _said(code)


def _closed(campaign: Campaign, rng: np.random.Generator, place: Path) -> str:
    """A command whose output cannot arrive."""
    proof = campaign.put(place, "trace.json")
    before = sys.stdout
    closed = io.StringIO()
    closed.close()
    sys.stdout = closed if rng.random() < 0.5 else None
    try:
        with contextlib.redirect_stderr(io.StringIO()):
            code = run(["verify", str(proof), *(["--json"] if rng.random() < 0.5 else [])])
    finally:
        sys.stdout = before
    assert code == 74, f"exit code {code} although nothing arrived"
    return "refused"


def _killed(campaign: Campaign, rng: np.random.Generator, place: Path) -> str:
    """``bound`` killed at a random time, over an earlier set: whole files, and a mark where they are mixed."""
    file, out = campaign.put(place, "scenario.json"), place / "o"
    command = ["bound", str(file), "--out", str(out), "--time-limit", "5"]
    assert _command(command)[0] == 0, "the first run failed"
    program = [sys.executable, "-c", "from ratt_opt.cli import main; main()", *command]
    process = subprocess.Popen(program, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    with contextlib.suppress(subprocess.TimeoutExpired):
        process.wait(float(rng.uniform(0.5, 6)))
    process.kill()
    process.wait()
    report = json.loads((out / "report.json").read_text())
    proof = ro.verify_certificate(out / "certificate.json")
    claim = report["certificate"].get("claim")
    assert claim in (None, {"lower": proof.lower, "upper": proof.upper}), "a report with another one's certificate"
    return "done"


KINDS: dict[str, tuple[float, Any]] = {
    "certificate": (0.52, _verify),
    "input": (0.2, _attack),
    "flags": (0.1, _flags),
    "journal": (0.1, _journal),
    "full disk": (0.0295, _full_disk),
    "interrupt": (0.04, _interrupted),
    "closed stream": (0.01, _closed),
    "kill": (0.0005, _killed),
}
"""Each kind of case, how often it comes, and what it does."""


def main() -> int:
    """Run the campaign and return the exit code."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("--cases", type=int, default=20_000, help="how many (default %(default)s)")
    parser.add_argument("--seed", type=int, default=1, help="of all cases (default %(default)s)")
    parser.add_argument("--first", type=int, default=0, help="number of the first case, to see one again")
    parser.add_argument("--out", type=Path, required=True, help="folder of the report")
    options = parser.parse_args()
    out, began = output_directory(options.out), monotonic()
    work = Path(tempfile.mkdtemp(prefix="ratt-opt-faults-"))
    campaign = Campaign(options.seed, work)
    try:
        campaign.prepare()
        for number in range(options.first, options.first + options.cases):
            campaign.run_case(number)
    finally:
        shutil.rmtree(work, ignore_errors=True)
    counts = dict(sorted(campaign.counts.items()))
    refused = sum(count for name, count in counts.items() if name.endswith(": refused"))
    faults = {str(number): text for number, text in campaign.faults.items()}
    seconds = math.ceil(monotonic() - began)
    write_json(out / "faults.json", {"seed": options.seed, "counts": counts, "faults": faults, "seconds": seconds})
    print(f"{options.cases} cases, {refused} refusals, {len(faults)} faults in {seconds} s")
    for number, text in list(faults.items())[:20]:
        print(f"case {number}: {ascii(text)[1:-1][:500]}")
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
