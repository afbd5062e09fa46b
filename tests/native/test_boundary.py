"""Python's side of the compiled loops is written from the headers of C, and whatever changes there is noticed."""

import ctypes
import re
import runpy
import subprocess
import sys
from pathlib import Path

import pytest

from analysis.boundary import TARGET, generated, read_headers
from ratt_opt.native import loops as side
from ratt_opt.native.loops import ColumnsRecord, DualsRecord, loops
from ratt_opt.native.sources import SOURCES, TO_COMPILE

ROOT = Path(__file__).parents[2]
RECORDS = {name: kind for name, kind in vars(side).items() if name.endswith("Record")}
CHANGES = {
    "two fields change places": ("annealing", "double hot, cold;", "double cold, hot;"),
    "two lines change places": (
        "groups",
        "int64_t depth, nodes, most_nodes;",
        "int64_t nodes, depth, most_nodes;",
    ),
    "a field gets another type": ("groups", "int32_t robot, column;", "int64_t robot, column;"),
    "an array gets another type": ("groups", "int32_t *fitting;", "int64_t *fitting;"),
    "a field is new": ("sets_of_size", "int64_t next, leaves, enters;", "int64_t next, leaves, enters, more;"),
    "an array is longer": ("groups", "int64_t room[3];", "int64_t room[4];"),
    "two arguments change places": ("groups", "int64_t gap, int64_t room", "int64_t room, int64_t gap"),
    "an argument gets another type": ("pricing", "int64_t size, int64_t effort", "int size, int64_t effort"),
    "a result gets another type": ("groups", "EXPORTED int next_cover", "EXPORTED int64_t next_cover"),
    "a record becomes an array": ("sets_of_size", "int64_t pairs, Scan *scan,", "int64_t pairs, Scan scan[],"),
}


def test_the_committed_file_is_what_the_headers_say() -> None:
    assert TARGET.read_text(encoding="utf-8") == generated(read_headers()), "run python -m analysis.boundary"


@pytest.mark.parametrize("change", CHANGES)
def test_a_change_of_a_header_changes_the_file(change: str) -> None:
    family, before, after = CHANGES[change]
    headers = read_headers()
    assert headers[family].count(before) == 1
    headers[family] = headers[family].replace(before, after)
    assert generated(headers) != TARGET.read_text(encoding="utf-8")


def test_a_record_without_a_comment_is_named() -> None:
    headers = read_headers()
    headers["groups"] = headers["groups"].replace("*/\ntypedef", "*/\n\ntypedef")
    with pytest.raises(ValueError, match=r"groups\.h:\d+ needs a comment"):
        generated(headers)


def test_functions_are_exported_in_headers_only_and_all_are_in_the_library() -> None:
    assert not [source.name for source in TO_COMPILE if "EXPORTED" in source.read_text(encoding="utf-8")]
    names = [name for name in vars(side.Loops) if not name.startswith("_")]
    assert len(names) == sum(len(re.findall("^EXPORTED", text, re.MULTILINE)) for text in read_headers().values())
    for name in names:
        assert getattr(loops, name).argtypes is not None
    with pytest.raises(AttributeError):
        loops.no_such_function  # type: ignore[attr-defined] # noqa: B018


def test_a_record_of_another_kind_is_not_passed() -> None:
    columns = ColumnsRecord(count=0, wide=0, groups=None, cuts=None, blinded=None)
    duals = DualsRecord(sums=None, unit=1, blinding=0)
    assert loops.within_gap(columns, duals, 0, 0, None, None) == 0
    with pytest.raises(ctypes.ArgumentError):
        loops.within_gap(duals, columns, 0, 0, None, None)  # type: ignore[arg-type]


MISUSES = """\
import numpy as np
from ratt_opt.native.library import address
from ratt_opt.native.loops import DualsRecord, loops
whole, floats = np.zeros(4, np.int64), np.zeros(4)
DualsRecord(sums=address(floats), unit=1, blinding=0)
DualsRecord(sums=address(whole), unit=1)
DualsRecord(sums=address(whole), unit=1, blinding=0, more=1)
loops.close_pricing(loops.open_sets())
loops.close_pricing(loops.open_kept_links())
loops.gain_ratio(address(whole), 1, address(whole), 0, 1, 0.0, address(whole), address(floats), address(whole))
loops.largest_excess(address(floats), 4)
"""


@pytest.mark.slow
def test_the_check_of_types_finds_what_c_would_misread(tmp_path: Path) -> None:
    pytest.importorskip("mypy")
    (tmp_path / "misuses.py").write_text(MISUSES, encoding="utf-8")
    command = [sys.executable, "-m", "mypy", "--strict", str(tmp_path / "misuses.py")]
    ran = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=False)
    found = {int(line) for line in re.findall(r"misuses\.py:(\d+): error", ran.stdout)}
    assert found == set(range(5, 12)), ran.stdout


def test_the_compiler_puts_every_field_where_python_does(tmp_path: Path) -> None:
    compiler = runpy.run_path(str(ROOT / "hatch_build.py"), run_name="build")["system_compiler"]()
    if compiler is None:
        pytest.skip("no compiler of the system is here")
    lines = [
        "#include <stddef.h>",
        *(
            f'#include "{name}.h"'
            for name in sorted(name for name, text in read_headers().items() if "\nEXPORTED" in text)
        ),
    ]
    for name, kind in RECORDS.items():
        if not kind._fields_:
            continue
        own = name.removesuffix("Record")
        lines.append(f'_Static_assert(sizeof({own}) == {ctypes.sizeof(kind)}, "");')
        lines += [
            f'_Static_assert(offsetof({own}, {field}) == {getattr(kind, field).offset}, "");'
            for field, _ in kind._fields_
        ]
    assert len(lines) > 200
    (tmp_path / "offsets.c").write_text("\n".join(lines), encoding="utf-8")
    command = [*compiler, "-std=c11", "-fsyntax-only", f"-I{SOURCES}", str(tmp_path / "offsets.c")]
    ran = subprocess.run(command, capture_output=True, text=True, check=False)
    assert ran.returncode == 0, ran.stderr
