"""Kinds of cases that run in this process: what each does to the program, and what must hold afterwards."""

import contextlib
import io
import json
import resource
import signal
import sys
from collections.abc import Iterator
from pathlib import Path

import numpy as np
from flint import arb

import ratt_opt as ro
from analysis.faults.campaign import LONGEST, MISSION, STUDY, Campaign, Kind, command, hang
from analysis.faults.damage import ODD, damaged
from analysis.faults.results import check_results, earlier_results
from analysis.faults.truth import truth
from ratt_opt.cli import run
from ratt_opt.studies.store import open_journal

__all__ = ["INSIDE"]


def _verify(campaign: Campaign, rng: np.random.Generator, place: Path) -> str:
    name = str(rng.choice(["trace", "logdet", "maxeig"])) + ".json"
    path = campaign.put(place, name, damaged(campaign.files[name], rng))
    code, shown = command(["verify", str(path), "--json", "--time-limit", "10"])
    if code in {0, 3}:
        found = json.loads(shown)
        lower, upper = truth(json.loads(path.read_bytes()), found["elements"])
        assert not upper > arb(found["upper"]), f"false upper end: {upper.str(20)} above {found['upper']}"
        assert code == 3 or not lower < arb(found["lower"]), f"false lower end: {lower.str(20)} below {found['lower']}"
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
         "--communication-range", "10", "--out",
         str(rng.choice([str(kept), str(place), "/dev/null", str(place / "n.json")]))],
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


def _mission(campaign: Campaign, rng: np.random.Generator, place: Path) -> str:
    """A mission that goes on from a damaged journal is the same mission, or is refused."""
    whole = campaign.files["mission.jsonl"]
    lines = whole.splitlines(keepends=True)
    k = int(rng.integers(len(lines)))
    hurt = b"".join([*lines[:k], damaged(lines[k], rng), *lines[k + 1 :]])
    path = campaign.put(place, "mission.jsonl", hurt if rng.random() < 0.7 else whole[: int(rng.integers(len(whole)))])
    scenario = ro.load_scenario(campaign.put(place, "scenario.json"))
    refusal = ""
    try:
        ro.run_mission(scenario, **MISSION, journal=path)
    except ro.InputError as error:
        refusal = str(error)
    if refusal:
        assert refusal.isprintable(), "a refusal is not one line"
        return "refused"
    assert path.read_bytes() == whole, "a damaged journal made another mission"
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


def _full_disk_in_bound(campaign: Campaign, rng: np.random.Generator, place: Path) -> str:
    """``bound`` over an earlier set of files, on a disk with room for some of the new ones."""
    file, out = campaign.put(place, "scenario.json"), earlier_results(campaign, place)
    with _file_size_limit(int(10 ** rng.uniform(2, 5.7))):
        code, _ = command(["bound", str(file), "--out", str(out)])
    assert code in {0, 2}, f"exit code {code} for a full disk"
    check_results(campaign, out)
    assert not [x for x in out.iterdir() if x.name.startswith(".")], "something was left behind"
    return _said(code)


@contextlib.contextmanager
def _interrupt_after(seconds: float) -> Iterator[None]:
    """One Ctrl-C at that time, unless the block has ended."""

    def press(*_: object) -> None:
        signal.signal(signal.SIGALRM, hang)
        signal.setitimer(signal.ITIMER_REAL, LONGEST)
        signal.raise_signal(signal.SIGINT)

    signal.signal(signal.SIGALRM, press)
    signal.setitimer(signal.ITIMER_REAL, seconds)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0)


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
    code = _with_interrupt(commands[int(rng.integers(3))], float(rng.uniform(1e-4, 0.03)))
    if out.exists():
        ro.load_scenario(out)
    assert not [x for x in place.iterdir() if x.name.startswith(".")] or code == 130, "something was left behind"
    return _said(code)


def _with_interrupt(words: list[str], seconds: float) -> int:
    try:
        with _interrupt_after(seconds):
            return command(words)[0]
    except KeyboardInterrupt:  # before or after the command itself
        return 130


def _interrupted_bound(campaign: Campaign, rng: np.random.Generator, place: Path) -> str:
    """An interrupt at a random time of ``bound``, over an earlier set of files."""
    file, out = campaign.put(place, "scenario.json"), earlier_results(campaign, place)
    code = _with_interrupt(["bound", str(file), "--out", str(out)], float(rng.uniform(0, 1.1 * campaign.seconds)))
    assert code in {0, 130}, f"exit code {code} for an interrupt"
    check_results(campaign, out)
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


INSIDE: dict[str, tuple[float, Kind]] = {
    "certificate": (0.4915, _verify),
    "input": (0.194, _attack),
    "flags": (0.1, _flags),
    "journal": (0.1, _journal),
    "mission journal": (0.02, _mission),
    "full disk": (0.03, _full_disk),
    "full disk in bound": (0.005, _full_disk_in_bound),
    "interrupt": (0.04, _interrupted),
    "interrupt of bound": (0.005, _interrupted_bound),
    "closed stream": (0.01, _closed),
}
"""Each kind of case, how often it comes, and what it does."""
