"""Claims of the paper about its figures, each tested as a statistic on our results."""

from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path

from analysis import claims
from analysis.claims import Claim
from ratt_opt.studies.statistics import Verdict, column, select
from ratt_opt.studies.store import read_table

__all__ = ["CLAIMS", "write_claims"]

CLOSE = 0.10
"""RATT counts as close to OPT when its mean trace exceeds OPT's by less than this share."""
LABELS = {"nonrobust_optimum": "NR-OPT", "greedy": "Greedy", "random": "Random"}
METRICS = {"trace": "trace of covariance", "mse": "MSE"}


QUALITATIVE = "ql_1sen_atk, ql_1comm_atk, ql_1sen2comm_atk"


def _qualitative() -> Iterator[Claim]:
    for metric, text in METRICS.items():
        for attacker, when, better, worse in (
            ("none", "without attack", "nonrobust_optimum", "ratt"),
            ("worst", "under the worst attack", "ratt", "nonrobust_optimum"),
        ):
            yield Claim(
                figure=QUALITATIVE,
                command="analysis.paper.qualitative",
                statement=f"{when}, {'RATT' if better == 'ratt' else 'NR-OPT'} has the lower {text}",
                left=f"{better}/{attacker}/{metric}",
                right=f"{worse}/{attacker}/{metric}",
            )


def _quantitative(figure: str, study: str, attacker: str, others: Sequence[str]) -> Iterator[Claim]:
    for metric, text in METRICS.items():
        for other in others:
            yield Claim(
                figure=figure,
                command=f"analysis.paper.{study}",
                statement=f"RATT's {text} is below that of {LABELS[other]}",
                left=f"ratt/{attacker}/{metric}",
                right=f"{other}/{attacker}/{metric}",
            )


CLAIMS = (
    *_qualitative(),
    *_quantitative("small_comp", "small_scale", "worst", ("nonrobust_optimum", "greedy", "random")),
    Claim(
        figure="small_comp",
        command="analysis.paper.small_scale",
        statement=f"RATT is close to OPT (trace less than {CLOSE:.0%} above)",
        left="ratt/worst/trace",
        right="maxmin/worst/trace",
        share=CLOSE,
    ),
    *_quantitative("large_comp", "large_scale", "bounded_rational", ("greedy", "random")),
    Claim(
        figure="large_comp",
        command="analysis.paper.large_scale",
        statement=f"(ours) the EKF's covariance tells its error: RATT's MSE less than {CLOSE:.0%} above the trace",
        left="ratt/bounded_rational/mse",
        right="ratt/bounded_rational/trace",
        share=CLOSE,
    ),
)


def write_claims(out: Path) -> None:
    """Write the table that maps each figure of the paper to its command, our result and the verdict."""
    first = [_caa_line(read_table(out / "caa")), _sharp_loss_line(read_table(out / "qualitative"))]
    claims.write_claims(out, CLAIMS, first=first)


def _caa_line(rows: Sequence[Mapping[str, str]]) -> str:
    kept = [max(int(r["kept"]) for r in rows if int(r["n_max"]) == n) for n in range(1, 6)]
    seven = next(r for r in rows if r["alpha_c"] == "7")
    result = f"links kept {kept}; 7 cut: n_max={seven['n_max']}, alpha_cs={seven['alpha_cs']}"
    holds = kept == [0, 2, 4, 6, 10] and (seven["n_max"], seven["alpha_cs"]) == ("3", "2")
    verdict = Verdict.CONFIRMED if holds else Verdict.CONTRADICTED
    claim = "N=5 keeps 0, 2, 4, 6, 10 links; 7 cut gives n_max=3, alpha_cs=2"
    return f"| caa_show | `analysis.paper.caa` | {claim} | {result} | {verdict.value} (exact) |"


def _sharp_loss_line(rows: Sequence[Mapping[str, str]]) -> str:
    """Count how often NR-OPT loses at least a tenth more than RATT, as in the paper's three pictures."""
    sharp, equal = [], []
    for case in dict.fromkeys(row["case"] for row in rows):
        kept = select(rows, case=case)
        excess = column(kept, "nonrobust_optimum/worst/trace") / column(kept, "ratt/worst/trace") - 1
        sharp.append(f"{100 * (excess >= CLOSE).mean():.0f}")
        equal.append(f"{100 * (excess == 0).mean():.0f}")
    claim = f"(ours) how often NR-OPT's trace under attack is at least {CLOSE:.0%} above RATT's"
    result = f"in {', '.join(sharp)} % of the trials by figure; equal to RATT's in {', '.join(equal)} %"
    return f"| {QUALITATIVE} | `analysis.paper.qualitative` | {claim} | {result}; {len(kept)} trials | (measured) |"
