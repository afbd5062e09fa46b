"""Fill a library: ``python -m analysis.benchmark_library solve --pool DIR`` and then ``build --pool DIR --out DIR``.

``solve`` tries the candidates that the pool's journal lacks, for ``--seconds`` at most, and goes on if it is run again.
``build`` chooses from what is solved and writes the library anew.
"""

import argparse
from pathlib import Path

from analysis.benchmark_library.candidates import candidates
from analysis.benchmark_library.choose import ChoiceParams, build
from analysis.benchmark_library.solve import SolveParams, solve_all


def main() -> None:
    """Solve candidates, or build a library of them."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("step", choices=("solve", "build"))
    parser.add_argument("--pool", type=Path, required=True, help="folder of solved candidates")
    parser.add_argument("--out", type=Path, help="folder of the library")
    parser.add_argument("--only", default="", help="candidates whose name holds this word")
    parser.add_argument("--seconds", type=float, default=float("inf"), help="seconds after which no candidate begins")
    parser.add_argument("--long", type=float, default=SolveParams().long, help="seconds of the longest run")
    parser.add_argument("--most", type=int, default=ChoiceParams().most, help="instances of the library")
    options = parser.parse_args()
    if options.step == "solve":
        wanted = [candidate for candidate in candidates() if options.only in candidate.name]
        solve_all(wanted, options.pool, SolveParams(long=options.long), seconds=options.seconds)
        return
    if options.out is None:
        parser.error("build needs --out")
    library = build(options.pool, options.out, ChoiceParams(most=options.most))
    print(f"{len(library.entries)} instances, {sum(row.is_closed for row in library.best.values())} closed")


if __name__ == "__main__":
    main()
