"""The library of the repository: its index, its records, and a first look in two minutes."""

from pathlib import Path

import numpy as np
import pytest

import ratt_opt as ro
from ratt_opt.cli import run as command

FOLDER = Path(__file__).parents[2] / "benchmark"
MOST_BYTES = 20 * 2**20

pytestmark = pytest.mark.skipif(not FOLDER.exists(), reason="the source distribution has no benchmark folder")


@pytest.fixture(scope="module")
def library():
    return ro.BenchmarkLibrary.load(FOLDER)


def test_every_line_has_its_files_and_no_file_is_left_over(library):
    for kind in ("instances", "records"):
        assert sorted(path.name.removesuffix(".json.xz") for path in (FOLDER / kind).iterdir()) == sorted(
            library.entries
        )
    assert set(library.best) == set(library.entries)
    assert sum(path.stat().st_size for path in FOLDER.rglob("*") if path.is_file()) <= MOST_BYTES
    assert sum(entry.curated for entry in library.entries.values()) == 10
    for row in library.best.values():
        is_open = library.entries[row.instance].hardness == "open"
        assert is_open == (not row.is_closed)


@pytest.mark.parametrize("seed", range(3))
def test_a_sample_of_the_records_holds(library, seed):
    assert [line.fault for line in ro.verify_benchmark(library, sample=5, seed=seed)] == [""] * 5


def test_a_sample_of_the_instances_is_what_its_line_says(library):
    for name in np.random.default_rng(1).choice(sorted(library.entries), 12, replace=False):
        instance, entry = library.instance(str(name)), library.entries[str(name)]
        assert (instance.class_code, instance.family) == (entry.code, entry.family)
        assert instance.sizes == (entry.robots, entry.elements)


def test_a_first_look_ends_in_a_page(tmp_path, capsys):
    """The guide's commands with fewer seconds."""
    for solver in ("planner:greedy", "attacker:worst"):
        words = ["bench", "run", str(FOLDER), "--solver", solver, "--curated", "--time", "3", "--out", str(tmp_path)]
        assert command(words) == 0
        assert "0 with faults" in capsys.readouterr().out
    assert command(["bench", "page", str(tmp_path)]) == 0
    assert "Performance profile" in (tmp_path / "page.html").read_text(encoding="utf-8")
