"""Where arrays are in memory, and which ones C may read."""

import shutil
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from ratt_opt import InputError
from ratt_opt.native import library
from ratt_opt.native.library import address, checked
from ratt_opt.native.sources import HEADERS, LIBRARY, RECORD, SOURCES, TO_COMPILE, fault_of, fingerprint, record_of

KIND = np.dtype([("mask", np.uint64), ("count", np.int32)])


@pytest.mark.parametrize("array", [np.zeros(3), np.zeros((4, 2))[1:], np.zeros(5, KIND), np.zeros(2, np.bool_)])
@pytest.mark.parametrize("is_locked", [False, True])
def test_addresses_are_those_of_numpy(array, is_locked):
    """Of arrays that may be written and others, and of what is left of them."""
    if is_locked:
        array = array.copy()
        array.setflags(write=False)
    for one in (array, array[1:], array[:0]):
        assert address(one) == one.ctypes.data


def test_only_arrays_of_the_type_shape_and_layout_are_read():
    good = np.zeros((2, 3))
    assert checked("x", good, np.float64, (2, 3), written=True) is good
    locked = good.copy()
    locked.setflags(write=False)
    assert checked("x", locked, np.float64, [2, 3]) is locked
    for bad in (good.tolist(), good.astype(np.float32), good.T, np.zeros((2, 6))[:, ::2], np.zeros((3, 2)), None):
        with pytest.raises(InputError, match=r"^x must "):
            checked("x", bad, np.float64, (2, 3))
    with pytest.raises(InputError, match="contiguous and writable"):
        checked("x", locked, np.float64, (2, 3), written=True)


LOAD = (
    "import sys; from pathlib import Path; "
    "sys.path = [folder for folder in sys.path if not folder or not Path(folder, 'ratt_opt').is_dir()]; "
    "from ratt_opt.native.library import library; print(library().sources().decode())"
)
"""In a folder whose package is the only one that is seen."""


def loaded(folder: Path) -> subprocess.CompletedProcess[str]:
    """Load the library of a copy of the package in another process, which a signal would end."""
    words = [sys.executable, "-c", LOAD]
    return subprocess.run(words, cwd=folder, capture_output=True, text=True, check=False)


def copied(folder: Path) -> Path:
    """A copy of what loading needs."""
    for part in ("errors.py", "native", "running"):
        source, target = LIBRARY.parents[1] / part, folder / "ratt_opt" / part
        if source.is_dir():
            shutil.copytree(source, target, ignore=shutil.ignore_patterns("__pycache__"))
        else:
            target.parent.mkdir(parents=True, exist_ok=True)
            shutil.copyfile(source, target)
    (folder / "ratt_opt" / "__init__.py").touch()
    return folder / "ratt_opt" / "native"


def test_a_damaged_library_is_an_error_with_the_remedy(tmp_path: Path) -> None:
    native = copied(tmp_path)
    library, good = native / LIBRARY.name, LIBRARY.read_bytes()
    assert loaded(tmp_path).stdout.strip() == fingerprint()
    kinds = [b"", good[: len(good) // 2], b"not a library", good + b"\0", Path(sys.executable).resolve().read_bytes()]
    for content in kinds:
        library.write_bytes(content)
        ran = loaded(tmp_path)
        assert ran.returncode == 1
        assert "ImportError: the loops of ratt_opt are damaged or another file" in ran.stderr.splitlines()[-1]
        assert ran.stderr.rstrip().endswith("run python hatch_build.py")
    library.unlink()
    assert "ImportError: the loops of ratt_opt are not compiled" in loaded(tmp_path).stderr
    library.mkdir()
    assert "ImportError: the loops of ratt_opt cannot be read (" in loaded(tmp_path).stderr
    library.rmdir()
    library.write_bytes(good)
    (native / RECORD.name).write_text(record_of(b"not a library"), encoding="utf-8")
    assert "ImportError: the loops of ratt_opt are damaged" in loaded(tmp_path).stderr
    library.write_bytes(b"not a library")  # as it was built, but for another system
    assert "ImportError: the loops of ratt_opt cannot be loaded here (" in loaded(tmp_path).stderr


def test_no_truncation_and_no_changed_byte_is_loaded(tmp_path: Path) -> None:
    good, library = LIBRARY.read_bytes(), tmp_path / LIBRARY.name
    rng = np.random.default_rng(0)
    assert fault_of(LIBRARY, RECORD) == ""
    for _ in range(100):
        where = int(rng.integers(len(good)))
        flipped = bytearray(good)
        flipped[where] ^= 1 << int(rng.integers(8))
        for content in (good[:where], bytes(flipped)):
            library.write_bytes(content)
            assert fault_of(library, RECORD).startswith("are damaged")


def test_stray_files_change_neither_the_fingerprint_nor_the_build(tmp_path: Path) -> None:
    native = copied(tmp_path)
    for name in ("draft.c", ".#flow.c", "flow.c.orig", "notes.txt", "old.h"):
        (native / "src" / name).write_text("no C at all", encoding="utf-8")
    (native / "src" / "folder.c").mkdir()
    assert loaded(tmp_path).stdout.strip() == fingerprint()
    (native / "src" / "flow.c").write_text("/* another */", encoding="utf-8")
    assert "compiled from other sources" in loaded(tmp_path).stderr
    (native / "src" / "flow.c").unlink()
    assert "compiled from other sources" in loaded(tmp_path).stderr


def test_every_source_is_listed() -> None:
    headers = {f"{name}.h" for name in HEADERS.split()}
    assert {file.name for file in SOURCES.iterdir()} == {file.name for file in TO_COMPILE} | headers


def test_a_checkout_without_a_library_uses_that_of_the_installation_it_hides(tmp_path, monkeypatch):
    checkout, installed = tmp_path / "checkout", tmp_path / "site" / "ratt_opt" / "native"
    installed.mkdir(parents=True)
    for file in (LIBRARY, RECORD):
        shutil.copy(file, installed)
    monkeypatch.setattr(library, "LIBRARY", checkout / LIBRARY.name)
    monkeypatch.setattr(library, "RECORD", checkout / RECORD.name)
    monkeypatch.setattr(sys, "path", [str(tmp_path), str(tmp_path / "site")])
    assert library._compiled() == (installed / LIBRARY.name, installed / RECORD.name)
    assert fault_of(*library._compiled()) == ""
    monkeypatch.setattr(sys, "path", [str(tmp_path)])
    assert library._compiled() == (checkout / LIBRARY.name, checkout / RECORD.name)
