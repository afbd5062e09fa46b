"""The kinds of cases: what each does to the program, and what must hold afterwards."""

from __future__ import annotations

import contextlib
import io
import json
import resource
import signal
import subprocess
import sys
from pathlib import Path
from typing import TYPE_CHECKING

import ratt_opt as ro
from analysis.studies.store import open_journal
from ratt_opt.cli import run

if TYPE_CHECKING:
    from collections.abc import Iterator

    import numpy as np

from analysis.faults.campaign import STUDY, Campaign, Kind, command
from analysis.faults.damage import ODD, damaged, truth

__all__ = ["KINDS"]


def _verify(campaign: Campaign, rng: np.random.Generator, place: Path) -> str:
    name = str(rng.choice(["trace", "logdet", "maxeig"])) + ".json"
    path = campaign.put(place, name, damaged(campaign.files[name], rng))
    code, shown = command(["verify", str(path), "--json", "--time-limit", "10"])
    if code in {0, 3}:
        found = json.loads(shown)
        lower, upper = truth(json.loads(path.read_bytes()), found["elements"])
        slack = 1e-9 * max(1.0, abs(upper))
        assert upper <= found["upper"] + slack, f"false upper end: {upper} above {found['upper']}"
        assert code == 3 or lower >= found["lower"] - slack, f"false lower end: {lower} below {found['lower']}"
    return _said(code)


def _said(code: int) -> str:
    return {0: "done", 3: "half proved", 130: "interrupted"}.get(code, "refused")


def _attack(campaign: Campaign, rng: np.random.Generator, place: Path) -> str:
    name = str(rng.choice(["scenario.json", "information.json"]))
    which = int(rng.integers(3))
    file = campaign.put(place, name, damaged(campaign.files[name], rng) if which else None)
    plan = campaign.put(place, "plan.json", None if which else damaged(campaign.files["plan.json"], rng))
    return _said(command(["attack", str(file), "--plan", str(plan), "--time-limit", "2"])[0])


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
    words = commands[int(rng.integers(len(commands)))]
    for _ in range(int(rng.integers(1, 3))):
        spot = int(rng.integers(len(words)))
        if words[spot] != "--out" and words[spot - 1] != "--out":
            words[spot] = str(rng.choice(ODD))
    code, _ = command([text for text in words if rng.random() > 0.03])
    assert kept.is_symlink(), "a symbolic link was replaced"
    assert Path("/dev/null").is_char_device(), "a device was replaced"
    return _said(code)


def _journal(campaign: Campaign, rng: np.random.Generator, place: Path) -> str:
    whole = campaign.files["journal/journal.csv"]
    campaign.put(place, "journal/study.json")
    content = damaged(whole, rng) if rng.random() < 0.7 else whole[: int(rng.integers(len(whole)))]
    path = campaign.put(place, "journal/journal.csv", content)
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
    words = ["new", "--robots", "9", "--targets", "3", "--sensing-attacks", "1", "--link-attacks", "1", "--seed", "1"]
    with _file_size_limit(int(rng.integers(0, 8000))):
        code, _ = command([*words, "--out", str(out)])
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
        code, _ = command(commands[int(rng.integers(3))])
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
    words = ["bound", str(file), "--out", str(out), "--time-limit", "5"]
    assert command(words)[0] == 0, "the first run failed"
    program = [sys.executable, "-c", "from ratt_opt.cli import main; main()", *words]
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


KINDS: dict[str, tuple[float, Kind]] = {
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
