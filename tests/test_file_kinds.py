"""Output replaces regular files only: whatever else is there stays, and nothing is computed first."""

import os
import socket
from pathlib import Path

import pytest

from ratt_opt import InputError, random_scenario, save_scenario
from ratt_opt._files import output_file, write_json
from ratt_opt.cli import run


def _make(kind: str, path: Path) -> None:
    if kind == "symbolic link":
        (path.parent / "aim").write_text("kept")
        path.symlink_to(path.parent / "aim")
    elif kind == "folder":
        path.mkdir()
    elif kind == "pipe":
        os.mkfifo(path)
    else:
        with socket.socket(socket.AF_UNIX) as end:
            here = os.getcwd()
            os.chdir(path.parent)  # the address of a socket must be short
            end.bind(path.name)
            os.chdir(here)


@pytest.mark.parametrize("kind", ["symbolic link", "folder", "pipe", "socket"])
def test_what_is_no_regular_file_stays(kind: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "certificate.json"
    _make(kind, path)
    before = os.lstat(path)
    with pytest.raises(InputError, match=f"a new or a regular file, not a {kind}"):
        write_json(path, {})
    scenario = tmp_path / "s.json"
    save_scenario(random_scenario(2, 1, alpha_s=0, alpha_c=0, seed=0), scenario)
    assert run(["bound", str(scenario), "--out", str(tmp_path)]) == 2
    shown = capsys.readouterr().err
    assert kind in shown
    assert "RATT" not in shown  # refused before anything is computed
    assert run(["new", "--robots", "2", "--targets", "1", "--seed", "0", "--sensing-attacks", "0",
                "--link-attacks", "0", "--out", str(path)]) == 2  # fmt: skip
    assert os.lstat(path).st_ino == before.st_ino
    assert os.lstat(path).st_mode == before.st_mode
    assert not (tmp_path / "report.json").exists()
    if kind == "symbolic link":
        assert (tmp_path / "aim").read_text() == "kept"


def test_devices_are_refused() -> None:
    with pytest.raises(InputError, match="not a device"):
        output_file("/dev/null")


def test_a_link_to_a_folder_is_that_folder(tmp_path: Path) -> None:
    """The folder of the results may be reached by a link: what is in it is not replaced by that."""
    (tmp_path / "real").mkdir()
    (tmp_path / "link").symlink_to(tmp_path / "real")
    assert run(["demo", "--out", str(tmp_path / "link"), "--no-certificate"]) == 0
    assert (tmp_path / "real" / "report.json").is_file()
    assert (tmp_path / "link").is_symlink()
