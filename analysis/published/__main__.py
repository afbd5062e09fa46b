"""One page of the tables that others published, beside ours.

Run as ``python -m analysis.published --data FOLDER --rows DIR [--page FILE] [--seconds S] [--only TABLE ...]``.
``FOLDER`` holds ``graph_partition``, ``orlib``, ``entropy_sampling`` and ``pmu``. A table whose data are absent is left
out, and the page says so. Rows are kept in ``DIR`` as they are made; the same command goes on.
"""

from __future__ import annotations

import argparse
from pathlib import Path

from analysis.benchmarks.timing import count_processor_time

count_processor_time()

from analysis.published.page import page_text  # noqa: E402
from analysis.published.tables import TABLES, make  # noqa: E402

NEEDS = {"cuts": "graph_partition", "facilities": "orlib", "entropy": "entropy_sampling", "designs": "pmu"}


def main() -> None:
    """Make rows, then the page."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--data", type=Path, required=True, help="folder of the published data")
    parser.add_argument("--rows", type=Path, required=True, help="folder of the rows that are made")
    parser.add_argument("--page", type=Path, help="page to write")
    parser.add_argument("--seconds", type=float, default=10.0, help="processor seconds of each search and rival")
    parser.add_argument("--only", nargs="+", choices=tuple(TABLES), default=tuple(TABLES))
    options = parser.parse_args()
    for name in options.only:
        if (options.data / NEEDS.get(name, "")).is_dir():
            make(name, options.data, options.rows, options.seconds)
        else:
            print(f"{name}: left out, as {options.data / NEEDS[name]} is absent")
    if options.page is not None:
        options.page.write_text(page_text(options.rows, options.seconds), encoding="utf-8")


if __name__ == "__main__":
    main()
