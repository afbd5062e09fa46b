"""The command line of the campaign."""

import argparse
import json
import math
import shutil
import sys
import tempfile
from collections import Counter
from collections.abc import Mapping
from pathlib import Path
from time import monotonic
from typing import Any

import analysis.faults
from analysis.faults.campaign import Campaign
from analysis.faults.kinds import KINDS
from ratt_opt._files import output_directory, write_json

REPORT = "faults.json"
OUTCOMES = ("done", "half proved", "refused", "interrupted", "fault")
SECONDS_BETWEEN_REPORTS = 20.0


def main() -> int:
    """Run the campaign, or the rest of one that was stopped, and return the exit code."""
    parser = argparse.ArgumentParser(description=(analysis.faults.__doc__ or "").partition("\n")[0])
    parser.add_argument("--cases", type=int, default=20_000, help="how many (default %(default)s)")
    parser.add_argument("--seed", type=int, default=1, help="of all cases (default %(default)s)")
    parser.add_argument("--case", type=int, help="run this one only, and keep no report: to see a fault again")
    parser.add_argument("--time-limit", type=float, default=math.inf, help="seconds; run the same command to go on")
    parser.add_argument("--out", type=Path, required=True, help="folder of the report; goes on with the one in it")
    options = parser.parse_args()
    campaign = Campaign(options.seed, Path(tempfile.mkdtemp(prefix="ratt-opt-faults-")))
    try:
        campaign.prepare()
        if options.case is not None:
            campaign.run_case(options.case, KINDS)
            print(*(campaign.faults.values() or ["no fault"]))
            return 1 if campaign.faults else 0
        found = _run(campaign, output_directory(options.out, REPORT) / REPORT, options)
    finally:
        shutil.rmtree(campaign.folder, ignore_errors=True)
    _show(found)
    return 1 if found["faults"] else 0


def _run(campaign: Campaign, path: Path, options: argparse.Namespace) -> Mapping[str, Any]:
    """Run what is missing of the cases and keep the report as it grows."""
    found: dict[str, Any] = {"seed": options.seed, "cases": 0, "seconds": 0.0, "counts": {}, "faults": {}}
    if path.exists():
        earlier = json.loads(path.read_text(encoding="utf-8"))
        found = earlier if earlier["seed"] == options.seed else found
    campaign.counts.update(found["counts"])
    campaign.faults.update({int(number): text for number, text in found["faults"].items()})
    began = written = monotonic()
    before = found["seconds"]
    for number in range(found["cases"], options.cases):
        campaign.run_case(number, KINDS)
        now = monotonic()
        over = now - began > options.time_limit
        if over or number == options.cases - 1 or now - written > SECONDS_BETWEEN_REPORTS:
            written = now
            faults = {str(number): text for number, text in campaign.faults.items()}
            counts = dict(sorted(campaign.counts.items()))
            found |= {"cases": number + 1, "seconds": before + now - began, "counts": counts, "faults": faults}
            write_json(path, found)
        if over:
            break
    return found


def _show(found: Mapping[str, Any]) -> None:
    """Print a table of outcomes by kind, and the first faults."""
    print(f"{'kind':24}" + "".join(f"{name:>13}" for name in ("cases", *OUTCOMES)))
    sums: Counter[str] = Counter()
    for kind in KINDS:
        counts = {name: found["counts"].get(f"{kind}: {name}", 0) for name in OUTCOMES}
        sums.update(counts)
        print(f"{kind:24}" + "".join(f"{count:13,}" for count in (sum(counts.values()), *counts.values())))
    print(f"{'all':24}" + "".join(f"{count:13,}" for count in (sum(sums.values()), *(sums[x] for x in OUTCOMES))))
    faults = found["faults"]
    print(f"{found['cases']} cases, {sums['refused']} refusals, {len(faults)} faults in {found['seconds']:.0f} s")
    for number, text in list(faults.items())[:20]:
        print(f"case {number}: {ascii(text)[1:-1][:500]}")


if __name__ == "__main__":
    sys.exit(main())
