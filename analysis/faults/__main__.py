"""The command line of the campaign."""

from __future__ import annotations

import argparse
import math
import shutil
import sys
import tempfile
from pathlib import Path
from time import monotonic

import analysis.faults
from analysis.faults.campaign import Campaign
from analysis.faults.kinds import KINDS
from ratt_opt._files import output_directory, write_json


def main() -> int:
    """Run the campaign and return the exit code."""
    parser = argparse.ArgumentParser(description=(analysis.faults.__doc__ or "").partition("\n")[0])
    parser.add_argument("--cases", type=int, default=20_000, help="how many (default %(default)s)")
    parser.add_argument("--seed", type=int, default=1, help="of all cases (default %(default)s)")
    parser.add_argument("--first", type=int, default=0, help="number of the first case, to see one again")
    parser.add_argument("--out", type=Path, required=True, help="folder of the report")
    options = parser.parse_args()
    out, began = output_directory(options.out), monotonic()
    work = Path(tempfile.mkdtemp(prefix="ratt-opt-faults-"))
    campaign = Campaign(options.seed, work)
    try:
        campaign.prepare()
        for number in range(options.first, options.first + options.cases):
            campaign.run_case(number, KINDS)
    finally:
        shutil.rmtree(work, ignore_errors=True)
    counts = dict(sorted(campaign.counts.items()))
    refused = sum(count for name, count in counts.items() if name.endswith(": refused"))
    faults = {str(number): text for number, text in campaign.faults.items()}
    seconds = math.ceil(monotonic() - began)
    write_json(out / "faults.json", {"seed": options.seed, "counts": counts, "faults": faults, "seconds": seconds})
    print(f"{options.cases} cases, {refused} refusals, {len(faults)} faults in {seconds} s")
    for name, text in list(faults.items())[:20]:
        print(f"case {name}: {ascii(text)[1:-1][:500]}")
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
