"""The builds that the page of the compiled loops names, and one without warnings, make a library with all functions."""

import ctypes
import re
import runpy
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
PAGE = ROOT / "docs" / "contributors" / "native.md"
DUMPED = "/tmp/loops/"
OPTIONS = re.findall(r'^RATT_CFLAGS="(.*?)".* python hatch_build\.py$', PAGE.read_text(encoding="utf-8"), re.MULTILINE)


def test_the_page_names_four_builds() -> None:
    assert len(OPTIONS) == 4


@pytest.mark.slow
@pytest.mark.skipif(not shutil.which("gcc"), reason="gcc is not here")
@pytest.mark.parametrize("options", [*OPTIONS, "-O1 -Wall -Wextra -Wmissing-prototypes -Werror"])
def test_a_build_with_options_makes_the_library(options: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("CC", "gcc")
    monkeypatch.setenv("RATT_CFLAGS", options.replace(DUMPED, f"{tmp_path}/"))
    build = runpy.run_path(str(ROOT / "hatch_build.py"), run_name="build")
    build["compile_library"](tmp_path)
    made = tmp_path / build["LIBRARY"].name
    assert made.stat().st_size > 0
    if "sanitize" not in options:  # its runtime has to be loaded before Python
        library = ctypes.CDLL(str(made))
        library.sources.restype = ctypes.c_char_p
        assert library.sources().decode() == build["NATIVE"]["fingerprint"]()


@pytest.mark.slow
@pytest.mark.skipif(not shutil.which("gcov"), reason="gcov is not here")
def test_coverage_counts_the_lines_that_ran(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("CC", "gcc")
    monkeypatch.setenv("RATT_CFLAGS", next(one for one in OPTIONS if "coverage" in one).replace(DUMPED, f"{tmp_path}/"))
    build = runpy.run_path(str(ROOT / "hatch_build.py"), run_name="build")
    build["compile_library"](tmp_path)
    call = f"import ctypes; ctypes.CDLL({str(tmp_path / build['LIBRARY'].name)!r}).sources()"
    subprocess.run([sys.executable, "-c", call], check=True)
    command = ["gcov", "--no-output", *map(str, tmp_path.glob("*.gcda"))]
    told = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, check=True).stdout
    lines = {Path(name).name: share for name, share in re.findall(r"File '(.*)'\nLines executed:([\d.]+)%", told)}
    assert float(lines["team.c"]) > 0
    assert float(lines["pricing.c"]) == 0


def test_options_of_the_environment_come_last_and_so_win(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("RATT_CFLAGS", "-g -O0")
    command = runpy.run_path(str(ROOT / "hatch_build.py"), run_name="build")["_command"](["gcc"], [], tmp_path / "made")
    assert command.index("-O3") < command.index("-g") < command.index("-O0")
