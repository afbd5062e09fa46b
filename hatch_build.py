"""Compile the loops of ``ratt_opt/native/src`` into one library when the package is installed.

A C compiler of the system is used where one works; elsewhere the wheel ``ziglang`` is asked for, which brings one. The
library needs no header of Python's, so one wheel serves every version of it. ``python hatch_build.py`` compiles in
place, after a source of an editable installation has changed; ``RATT_CFLAGS`` adds options to the compiler's.
"""

from __future__ import annotations

import os
import platform
import runpy
import shlex
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import Any

ROOT = Path(__file__).parent
NATIVE = runpy.run_path(str(ROOT / "ratt_opt" / "native" / "sources.py"))  # the package itself needs its dependencies
LIBRARY: Path = NATIVE["LIBRARY"]
RECORD: Path = NATIVE["RECORD"]
ZIG = "ziglang>=0.13"
OPTIONS = ("-std=c11", "-O3", "-fvisibility=hidden", "-shared")
SAME_BITS = ("-ffp-contract=off",)
"""No fused multiplication and addition: the same results on every processor of a kind."""


def system_compiler() -> list[str] | None:
    """The command of a C compiler that can build a library which computes, or ``None``."""
    asked = shlex.split(os.environ.get("CC", ""))
    for command in (asked, ["cc"], ["gcc"], ["clang"]):
        if command and shutil.which(command[0]) and _works(command):
            return command
    return None


def _works(command: list[str]) -> bool:
    with tempfile.TemporaryDirectory() as folder:
        source = Path(folder) / "probe.c"
        function = "double probe(double x);\ndouble probe(double x) { return log(x); }\n"
        source.write_text(f"#include <math.h>\n#include <stdlib.h>\n{function}")
        ran = subprocess.run(_command(command, [source], Path(folder) / LIBRARY.name), capture_output=True, check=False)
        return ran.returncode == 0


def _command(compiler: list[str], sources: list[Path], target: Path) -> list[str]:
    position_independent = [] if sys.platform == "win32" else ["-fPIC"]
    mathematics = [] if sys.platform == "win32" else ["-lm"]
    asked = shlex.split(os.environ.get("RATT_CFLAGS", ""))
    options = [*OPTIONS, *SAME_BITS, *position_independent, *asked, f'-DSOURCES="{NATIVE["fingerprint"]()}"']
    return [*compiler, *options, "-o", str(target), *map(str, sources), *mathematics]


def _zig() -> list[str]:
    import ziglang  # type: ignore[import-not-found]

    command = [str(Path(ziglang.__file__).parent / ("zig.exe" if sys.platform == "win32" else "zig")), "cc"]
    if sys.platform == "linux":
        machine = {"amd64": "x86_64", "arm64": "aarch64"}.get(platform.machine().lower(), platform.machine().lower())
        libc = "musl" if platform.libc_ver()[0] != "glibc" else "gnu.2.17"
        command += ["-target", f"{machine}-linux-{libc}", "-fno-sanitize=undefined"]
        command += ["-mcpu=x86_64"] if machine == "x86_64" else []
    return command


def compile_library(folder: Path) -> None:
    """Compile all sources into one library in the folder, and write its size and hash beside it.

    Stopped in between, it leaves a library that is not loaded.
    """
    folder.mkdir(parents=True, exist_ok=True)
    compiler = system_compiler()
    with tempfile.TemporaryDirectory(dir=folder, prefix=".compiling-") as aside:
        caches = {"ZIG_LOCAL_CACHE_DIR": aside, "ZIG_GLOBAL_CACHE_DIR": aside}
        made = Path(aside) / LIBRARY.name
        command = _command(compiler or _zig(), list(NATIVE["TO_COMPILE"]), made)
        ran = subprocess.run(command, capture_output=True, text=True, check=False, env=os.environ | caches)
        if ran.returncode:
            raise SystemExit(f"the loops do not compile: {shlex.join(command)}\n{ran.stderr}")
        record = NATIVE["record_of"](made.read_bytes())
        made.replace(folder / LIBRARY.name)
    (folder / RECORD.name).write_text(record, encoding="utf-8")


try:
    from hatchling.builders.hooks.plugin.interface import BuildHookInterface
except ImportError:  # run as a command, without the build back end
    BuildHookInterface = None

if BuildHookInterface is not None:

    class NativeBuildHook(BuildHookInterface[Any]):
        """Adds the library to wheels, and compiles it in place for editable installations."""

        PLUGIN_NAME = "custom"

        def dependencies(self) -> list[str]:
            """What the build needs beside the back end."""
            return [] if self.target_name != "wheel" or system_compiler() else [ZIG]

        def initialize(self, version: str, build_data: dict[str, Any]) -> None:
            """Compile before the files are collected."""
            if self.target_name != "wheel":
                return
            from packaging.tags import sys_tags

            folder = LIBRARY.parent
            if version != "editable":
                self._folder = tempfile.TemporaryDirectory()
                folder = Path(self._folder.name)
                for made in (LIBRARY.name, RECORD.name):
                    build_data["force_include"][str(folder / made)] = f"ratt_opt/native/{made}"
            compile_library(folder)
            build_data["pure_python"] = False
            build_data["tag"] = f"py3-none-{next(sys_tags()).platform}"


if __name__ == "__main__":
    compile_library(LIBRARY.parent)
