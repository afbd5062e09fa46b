"""Solvers from other places: an installed package, processes of a cluster, a library behind an address."""

import json
import os
import subprocess
import sys
import tarfile
import threading
from contextlib import contextmanager
from functools import partial
from hashlib import sha256
from http.server import SimpleHTTPRequestHandler, ThreadingHTTPServer

import pytest

import ratt_opt as ro
from ratt_opt.benchmark.instances import published
from ratt_opt.benchmark.instances.instance import write_document
from ratt_opt.benchmark.runs.runner import read_rows
from ratt_opt.cli import run as command
from tests.benchmark.small_library import coverage_instance, small_library
from tests.cluster import scheduler, workers
from tests.documents import ROOT

PLANNERS = """
def cautious(problem):
    return [int(choice[-1]) for choice in problem.choices]

def blind(problem, elements):
    import ratt_opt
    return ratt_opt.Attack(sensing=frozenset(range(problem.alpha_s)))
"""


def test_an_installed_package_offers_planners_and_attackers_by_name(tmp_path):
    library = small_library(tmp_path / "lib")
    place = tmp_path / "site"
    info = place / "cautious_pack-1.0.dist-info"
    info.mkdir(parents=True)
    (place / "cautious_pack.py").write_text(PLANNERS, encoding="utf-8")
    (info / "METADATA").write_text("Metadata-Version: 2.1\nName: cautious-pack\nVersion: 1.0\n", encoding="utf-8")
    groups = "[ratt_opt.planners]\ncautious = cautious_pack:cautious\n"
    groups += "[ratt_opt.attackers]\nfirst-ones = cautious_pack:blind\n"
    (info / "entry_points.txt").write_text(groups, encoding="utf-8")
    path = os.pathsep.join([str(place), str(ROOT), os.environ.get("PYTHONPATH", "")])
    for solver, name in (("planner:cautious", "cautious"), ("attacker:first-ones", "attacker-first-ones")):
        words = ("bench", "run", str(library.folder), "--solver", solver, "--time", "8", "--out", str(tmp_path / "out"))
        done = subprocess.run(
            [sys.executable, "-m", "ratt_opt", *words, "--json"],
            capture_output=True,
            text=True,
            check=False,
            env=os.environ | {"PYTHONPATH": path},
        )
        assert done.returncode == 0, done.stderr
        assert [row["faults"] for row in json.loads(done.stdout)["rows"]] == [""] * len(
            read_rows(tmp_path / "out")[name]
        )
    plan, _ = read_rows(tmp_path / "out")["cautious"]
    assert float(plan["value"]) <= library.best[plan["instance"]].value + 1e-9


def test_a_name_that_nobody_offers_is_refused_in_one_line(tmp_path):
    library = small_library(tmp_path / "lib", [coverage_instance()])
    with pytest.raises(ro.InputError, match="solver must be one of planner:"):
        ro.run_benchmark(library, "planner:cautious", tmp_path / "out")


def test_rows_of_a_cluster_are_those_of_this_process(tmp_path):
    library = small_library(tmp_path / "lib")
    here = ro.run_benchmark(library, "planner:greedy", tmp_path / "here", seconds=30)
    words = ["bench", "run", str(library.folder), "--solver", "planner:greedy", "--time", "30"]
    with scheduler(tmp_path) as address, workers(2, address, tmp_path):
        assert command([*words, "--out", str(tmp_path / "there"), "--cluster", address]) == 0
    there = read_rows(tmp_path / "there")["greedy"]
    for name in ("instance", "value", "gap", "faults", "claimed", "proved"):
        assert [row[name] for row in there] == [row[name] for row in here]


@contextmanager
def server(folder):
    """Serve a folder on loopback."""
    handler = partial(SimpleHTTPRequestHandler, directory=str(folder))
    handler.log_message = lambda *_: None
    with ThreadingHTTPServer(("127.0.0.1", 0), handler) as one:
        thread = threading.Thread(target=one.serve_forever, daemon=True)
        thread.start()
        yield f"http://127.0.0.1:{one.server_port}"
        one.shutdown()


def test_a_published_library_is_fetched_once_and_a_changed_one_refused(tmp_path, monkeypatch):
    pytest.importorskip("pooch")
    library = small_library(tmp_path / "lib")
    archive = tmp_path / "served" / "library.tar.gz"
    archive.parent.mkdir()
    with tarfile.open(archive, "w:gz") as file:
        file.add(library.folder, arcname="benchmark")
    digest = f"sha256:{sha256(archive.read_bytes()).hexdigest()}"
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    with server(archive.parent) as address:
        monkeypatch.setitem(published.PUBLISHED, "small", (f"{address}/library.tar.gz", digest))
        folder = published.library_folder("small")
        assert ro.BenchmarkLibrary.load(folder).entries == library.entries
    assert published.library_folder("small") == folder  # from the cache: nobody serves it any more
    with server(archive.parent) as address:
        monkeypatch.setitem(published.PUBLISHED, "other", (f"{address}/library.tar.gz", "sha256:" + "0" * 64))
        with pytest.raises(ro.InputError, match="library"):
            published.library_folder("other")
        monkeypatch.setitem(published.PUBLISHED, "absent", (f"{address}/none.tar.gz", digest))
        with pytest.raises(ro.InputError, match="library"):
            published.library_folder("absent")


def test_refined_prints_plans_as_it_finds_them(tmp_path):
    """Lines come from the first moment on, so a run that is killed early has an answer."""
    instance = coverage_instance(robots=12, lost=2)
    write_document(instance.document, tmp_path / "instance.json")
    words = [
        sys.executable,
        "-m",
        "ratt_opt.benchmark.runs.solvers",
        "planner:refined",
        "instance.json",
        ".",
        "--time",
        "2",
    ]
    done = subprocess.run(
        words, cwd=tmp_path, capture_output=True, text=True, check=True, env=os.environ | {"PYTHONPATH": str(ROOT)}
    )
    lines = [json.loads(line) for line in done.stdout.splitlines()]
    worth = [ro.worst_case_attack(instance.team, line["elements"]).lower for line in lines]
    assert len(lines) >= 2
    assert worth == sorted(worth)
    assert lines[-1]["lower"] <= worth[-1] + 1e-9
