"""Numbers of the rows of inequalities."""

from __future__ import annotations

from dataclasses import dataclass

__all__ = ["RowParams"]


@dataclass(frozen=True, slots=True, kw_only=True)
class RowParams:
    """Limits on what is kept and tried; none of them changes what is claimed.

    ``unseen`` : least share of pairs of an element and a target without information
    ``seen`` : targets that an element sees in the mean; of more, searches in depth meet dead ends late, and rows begin
        at the root. Camera teams of 10 see 1.6 and end in depth; of 20, 3.2, and coverage by 10 robots, 10, and do not
    ``nodes`` : of all searches, before rows begin elsewhere: what ends without rows by then takes no longer with them
    ``rounds`` : linear programs with tangents of whole groups before rows begin: many searches end by then
    ``paired`` : elements of each target that tell most, whose pairs are base sets: stronger rows against more of them
    ``most_bases`` : base sets of all targets together; beyond it single elements that tell least are left out
    ``base_work`` : operations for their marginals, likewise: about a second
    ``similar`` : share of a target's largest value; a base set that no plan's set bounds by more than it below another
        one is left out: fewer inequalities to compare against weaker rows
    ``value_errors`` : evaluation errors by which the difference of two values of a target may be off
    ``most`` : inequalities that are kept at once, beside base sets: memory and time of a round
    ``lower`` : share of a target's bound by which a tangent has to be lower to be kept
    ``share`` : of what is open at a node, for all targets together, likewise: fewer tangents against more nodes
    ``inward`` : share of the way from a relaxed plan to the mean of earlier ones where rows are taken: fewer rounds
        against rows that cut less off
    ``newest`` : share of the newest relaxed plan in that mean
    ``starts`` : known outcomes from which robots are exchanged
    ``steps`` : exchanges of one descent at most
    ``hulls_at_root`` : rounds with hulls, once rows stall at the root. With one more at each node, 20 cameras
        had a tenth of the nodes, and as much open after a minute
    ``hull_least`` : share of what is open that a round with hulls has to take off for another one: on networks of fifty
        a round takes seconds and takes off a thousandth of it, with the time that attacks need
    ``hull_groups`` : groups with the lowest rows that get hulls in one round
    ``hull_gain`` : of what is open at a node, for all targets together: what a hull has to lower its target's bound by
    ``least_share`` : weights of elements up to this are none for a hull
    ``hull_tolerance`` : of a target's largest value, by which a hull may be higher than the concave envelope
    ``hull_inexact`` : share of that gain, likewise: fewer searches against weaker inequalities
    ``hull_rounds``, ``hull_lifts`` : sets that one hull adds at most, and times that other elements' scores are raised
    ``hull_nodes`` : of one search for the set that violates an inequality most
    """

    unseen: float = 0.25
    seen: float = 2.5
    nodes: int = 1_500
    rounds: int = 8
    paired: int = 6
    most_bases: int = 12_000
    base_work: float = 3e8
    similar: float = 1e-4
    value_errors: int = 2
    most: int = 6_000
    lower: float = 1e-9
    share: float = 0.03
    inward: float = 0.5
    newest: float = 0.2
    starts: int = 3
    steps: int = 30
    hulls_at_root: int = 20
    hull_least: float = 0.005
    hull_groups: int = 8
    hull_gain: float = 0.03
    least_share: float = 1e-3
    hull_tolerance: float = 1e-5
    hull_inexact: float = 0.2
    hull_rounds: int = 60
    hull_lifts: int = 25
    hull_nodes: int = 20_000
