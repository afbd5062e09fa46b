"""Places of the appendix that say something else than what is meant there, by the proof's own lines."""

from __future__ import annotations

from dataclasses import dataclass

__all__ = ["MISPRINTS", "Misprint"]


@dataclass(frozen=True, slots=True, kw_only=True)
class Misprint:
    """One place: what is printed there and what is meant.

    ``label`` : the entry that decides it as printed, if that is a statement; ``repaired`` : as meant.
    """

    where: str
    printed: str
    meant: str
    label: str = ""
    repaired: str = ""


MISPRINTS = (
    Misprint(
        where="nd_p1_d1 to nd_p1_d3, nd_p1, nd_p2_d1 to nd_p2_d3, nd_p2, nd1, nd, sub_p2_d1, sub: left side",
        printed="Phi(V minus the empty set, E minus A_c*)",
        meant="Phi(V minus A_s*, E minus A_c*), the left side of team_subgroup; decided so",
    ),
    Misprint(
        where="before nd_p1d3v1_1",
        printed="|V1b1| = alpha - alpha_s^1",
        meant="|V1b1| = alpha_s - alpha_s^1",
        label="nd_p1d3v1_sizes",
        repaired="nd_p1d3v1_sizes_repaired",
    ),
    Misprint(
        where="reason of nd_p1d3v1_4",
        printed="V1b1 without A*",
        meant="V1b2 without A*",
        label="nd_p1d3v1_4_counts",
        repaired="nd_p1d3v1_4_counts_repaired",
    ),
    Misprint(
        where="before sub_p2d1v1_1",
        printed="|V1b1| = alpha - alpha_s^1",
        meant="|V1b1| = |V2g|",
        label="sub_p2d1v1_sizes",
        repaired="sub_p2d1v1_sizes_repaired",
    ),
    Misprint(where="before both", printed="the other robots in V1b1", meant="the other robots in V1b"),
    Misprint(where="reasons of sub_p2d1v1", printed="eq. nd_p1d3v1_1 holds", meant="eq. sub_p2d1v1_1 holds"),
    Misprint(
        where="sub_p2d1v1_9",
        printed="for all W in V1 with |W| = |Vg| (the line has no W)",
        meant="no quantifier: the line is about Vg; decided in both readings",
    ),
    Misprint(
        where="reason of sub_p2d1v1_9",
        printed="greedy achieves 1-k",
        meant="greedy achieves 1/(1+k), as the line uses",
        label="conforti1984_in_words",
        repaired="conforti1984_theorem2_3",
    ),
)
