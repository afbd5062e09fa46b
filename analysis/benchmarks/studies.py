"""Speed of the studies: ``python -m analysis.benchmarks.studies [--paper T] [--extended T] [--workers W]``.

Each whole command runs in a new folder, from process start to figures and claims, then once more: the second
run finds every trial done and is what a resumed sweep costs. "plain" is the sum of the same trials run one
after the other in a single process, so that the ratio is what the workers gain; the projection to the issue's
number of trials scales the trials and not the start.
"""

from __future__ import annotations

import argparse
import resource
import subprocess
import sys
import tempfile
import time
from pathlib import Path

from analysis.tables import print_table

TARGETS = {"analysis.paper": (10, 5 * 60), "analysis.extended": (200, 30 * 60)}
"""Command -> trials and seconds on two cores that the study should take."""


def main() -> None:
    """Print one row per command."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--paper", type=int, default=10, help="trials of the paper's figures (default %(default)s)")
    parser.add_argument("--extended", type=int, default=5, help="trials of the extended study (default %(default)s)")
    parser.add_argument("--workers", type=int, default=2, help="local processes (default %(default)s)")
    options = parser.parse_args()
    trials = {"analysis.paper": options.paper, "analysis.extended": options.extended}
    rows = [_row(command, count, options.workers) for command, count in trials.items() if count > 0]
    print_table("whole commands, seconds of wall time and of processor time", rows)


def _row(command: str, trials: int, workers: int) -> dict[str, object]:
    with tempfile.TemporaryDirectory() as folder:
        out = Path(folder)
        start, start_processor = _run(command, 1, out / "one", workers)
        wall, processor = _run(command, trials, out / "all", workers)
        again, _ = _run(command, trials, out / "all", workers)
        plain, _ = _run(command, trials, out / "plain", 1)
    wanted, limit = TARGETS[command]
    per_trial = (processor - start_processor) / max(trials - 1, 1)
    return {
        "command": command,
        "trials": trials,
        "wall": wall,
        "processor": processor,
        "resumed": again,
        "one worker": plain,
        "gain": plain / wall,
        f"projected minutes of {workers} idle cores": (start + per_trial * (wanted - 1) / workers) / 60,
        "at trials": wanted,
        "target minutes": limit / 60,
    }


def _run(command: str, trials: int, out: Path, workers: int) -> tuple[float, float]:
    """Wall and processor seconds of one whole command, its workers included."""
    before, began = resource.getrusage(resource.RUSAGE_CHILDREN), time.perf_counter()
    arguments = ["--trials", str(trials), "--out", str(out), "--workers", str(workers)]
    subprocess.run([sys.executable, "-m", command, *arguments], check=True, capture_output=True)
    wall, after = time.perf_counter() - began, resource.getrusage(resource.RUSAGE_CHILDREN)
    used = (after.ru_utime + after.ru_stime) - (before.ru_utime + before.ru_stime)
    return wall, used


if __name__ == "__main__":
    main()
