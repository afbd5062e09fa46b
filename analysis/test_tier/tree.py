"""A copy of the repository in which faults are made, one after another, and its tests run."""

import json
import os
import shutil
import subprocess
import sys
from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path

from analysis.test_tier.mutants import Mutant

__all__ = ["ROOT", "Tree"]

ROOT = Path(__file__).parents[2]
LOOPS = "ratt_opt/native/_loops*"


class Tree:
    """A clone in a folder, with a process that runs its tests."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder.absolute()
        self.root = self.folder / "tree"
        self._worker: subprocess.Popen[str] | None = None

    def prepare(self) -> None:
        """Clone, unless that is done, and compile the loops."""
        if not self.root.exists():
            self.folder.mkdir(parents=True, exist_ok=True)
            subprocess.run(["git", "clone", "--quiet", ROOT, self.root], check=True)
            if (data := ROOT.parent / "shared").is_dir():
                (self.folder / "shared").symlink_to(data)
        subprocess.run(["git", "checkout", "--quiet", "ratt_opt", "ratt_audit"], cwd=self.root, check=True)
        self._make_loops()

    def _make_loops(self) -> bool:
        made = subprocess.run([sys.executable, "hatch_build.py"], cwd=self.root, capture_output=True, check=False)
        return made.returncode == 0

    @contextmanager
    def with_faults(self, mutants: Iterable[Mutant]) -> Iterator[bool]:
        """Make faults, say whether the sources still compile, and mend them afterwards."""
        by_file: dict[str, list[Mutant]] = {}
        for mutant in mutants:
            by_file.setdefault(mutant.file, []).append(mutant)
        before = {file: ((self.root / file).read_bytes(), (self.root / file).stat()) for file in by_file}
        in_c = any(file.endswith((".c", ".h")) for file in by_file)
        loops = [(path, path.read_bytes()) for path in self.root.glob(LOOPS)] if in_c else []
        try:
            for file, faults in by_file.items():
                text = before[file][0].decode()
                for mutant in sorted(faults, key=lambda one: -one.begin):
                    text = mutant.apply(text)
                (self.root / file).write_bytes(text.encode())
            yield self._make_loops() if in_c else True
        finally:
            for file, (content, known) in before.items():
                (self.root / file).write_bytes(content)
                os.utime(self.root / file, ns=(known.st_atime_ns, known.st_mtime_ns))
            for path, content in loops:
                path.unlink(missing_ok=True)  # a process may still run the one with faults
                path.write_bytes(content)

    def run(self, limits: Mapping[str, float], cases: Mapping[str, int]) -> tuple[str, str]:
        """Run test functions, or some cases of them, each within its seconds: how it ended, and the last test."""
        shutil.rmtree(self.root / ".hypothesis", ignore_errors=True)
        if self._worker is None:
            own = {
                "PYTHONPATH": str(self.root),
                "PYTHONDONTWRITEBYTECODE": "1",
                "OMP_NUM_THREADS": "1",
                "MPLBACKEND": "Agg",
            }
            command = [sys.executable, str(Path(__file__).with_name("worker.py")), str(self.folder)]
            self._worker = subprocess.Popen(
                command, cwd=self.root, env=os.environ | own, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True
            )
        assert self._worker.stdin is not None
        assert self._worker.stdout is not None
        self._worker.stdin.write(json.dumps([dict(limits), dict(cases)]) + "\n")
        self._worker.stdin.flush()
        ended, test = json.loads(self._worker.stdout.readline())
        return ended, test

    def close(self) -> None:
        """End the process."""
        if self._worker is not None:
            self._worker.kill()
            self._worker.wait()
