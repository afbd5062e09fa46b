"""Records and functions of the compiled loops, by ``python -m analysis.boundary`` from the headers."""

# fmt: off

from ctypes import Array, Structure, c_int64
from typing import Annotated, Protocol, cast

from ratt_opt.native.declared import (Anything, Bytes, Double, Doubles, Int, Int32, Int32s, Int64, Int64s, Int8s,
    Loader, Pointer, Text, UInt16s, UInt64, UInt64s, record)

@record
class TeamRecord(Structure):
    """Robots that measure targets."""
    robots: Int32; targets: Int32; dimension: Int32; criterion: Int32; weights: Doubles; prior: Doubles
    information: Doubles; before: Doubles; before_all: Double; relative: Double; rounding: Double

@record
class AnnealRecord(Structure):
    """An annealed attack; arcs of robot i are start[i]..start[i + 1] - 1."""
    team: Pointer[TeamRecord]; robots: Int64; budget: Int64; start: Int64s; robot: Int64s; fixed: Bytes; seeing: Bytes
    group: Int64s; best_group: Int64s; blind: Bytes; best_blind: Bytes; first: Int64; last: Int64; steps: Int64
    hot: Double; cold: Double; least: Doubles; random: UInt64s

@record
class CutAnnealRecord(Structure):
    """An annealed cut that leaves no group with more than ``most`` robots; arcs as in ``Anneal``."""
    robots: Int64; groups: Int64; most: Int64; start: Int64s; robot: Int64s; price: Int64s; counts: Int64s
    group: Int64s; best: Int64s; sizes: Int64s; hot: Double; cold: Double; oversize: Double; random: Anything
    uniform: Anything

@record
class ElementsRecord(Structure):
    """Elements and the targets."""
    elements: Int64; targets: Int64; entries: Int64; dimension: Int32; criterion: Int32; weights: Doubles
    baseline: Doubles; prior: Doubles; information: Doubles; sees: Bytes; relative: Double; rounding: Double

@record
class ChoicesRecord(Structure):
    """The elements with the robots that choose."""
    all: ElementsRecord; robots: Int64; widest: Int64; owner: Int64s; place: Int64s; element: Int64s; count: Doubles
    safe: Bytes; enough: Double

@record
class WaysRecord(Structure):
    """Partitions of the robots that cutting links leaves."""
    groups: Int64; partitions: Int64; widest: Int64; members: Bytes; inside: Bytes; of: Int64s; order: Int64s

@record
class CoversRecord(Structure):
    """Covers by number."""
    size: Int64; room: Int64; groups: Int64; left_out: UInt64s; partition: Int64s; sums: Doubles; level: Doubles

@record
class SumsRecord(Structure):
    """Sums of covers by number."""
    looked_at: Int64; terms: Doubles; tried: Int64s; used: Doubles

@record
class StepRecord(Structure):
    """A step forbids elements of a robot, because of a cover, a sum or a node that was a dead end."""
    kind: Int64; what: Int64; robot: Int64; gone: UInt64

@record
class StackRecord(Structure):
    """Frames, which each fix an element, and steps."""
    frame: Int64; count: Int64; start: UInt64s; allowed: UInt64s; strongest: Doubles; fixed: Int64s; first: Int64s
    steps: Pointer[StepRecord]; reasons: UInt64s; since: Int64s; touched: Int64s; activity: Doubles

@record
class NodeRecord(Structure):
    """A node of a proof."""
    kind: Int64; subject: Int64; robot: Int64; place: Int64; next: Int64

@record
class NodesRecord(Structure):
    """Nodes of a proof in a growing array."""
    size: Int64; room: Int64; nodes: Pointer[NodeRecord]

@record
class CutStatesRecord(Structure):
    """Partial cuts that leave the same classes."""
    classes: Int64; count: Int64; map: Int64s; states: Int64s

@record
class CutFrontRecord(Structure):
    """Joined states, none as good as another."""
    classes: Int64; most_cut: Int64; capacity: Int64; count: Int64; room: Int64s; states: Int64s

@record
class BranchRecord(Structure):
    """A node of the list of groups."""
    inside: UInt64; outside: UInt64; near: UInt64; cut: Int64

@record
class ColumnsRecord(Structure):
    """Groups that an attack may leave; as bit masks of 64 bits where they are ``wide``, of 32 elsewhere."""
    count: Int64; wide: Int64; groups: Anything; cuts: Bytes; blinded: Bytes

@record
class DualsRecord(Structure):
    """Integer duals, in units of a link."""
    sums: Int64s; unit: Int64; blinding: Int64

@record
class LevelRecord(Structure):
    """A level of the search of covers."""
    room: Annotated[Array[c_int64], c_int64 * 3]; start: Int64; end: Int64; position: Int64; robot: Int32
    column: Int32

@record
class CoverRecord(Structure):
    """A search of covers."""
    robots: Int64; words: Int64; room: Int64; groups: UInt64s; costs: Int64s; fitting: Int32s
    levels: Pointer[LevelRecord]; left: UInt64s; counts: Int64s; depth: Int64; nodes: Int64; most_nodes: Int64

@record
class KeptLinksRecord(Structure):
    """Groups with more link weight inside than their robots' prices."""
    robots: Int64; links: Int64; ends: Int64s; start: Int64s; arc: Int64s; weight: Int64s; price: Int64s; size: Int64s
    room: Int64; threshold: Int64; listing: Int64; most_found: Int64; found: Int64; groups: Bytes; values: Int64s
    most_length: Int64; length: Int64; tree: Int64s; nodes: Int64

@record
class KeptSearchRecord(Structure):
    """An open search of kept links."""

@record
class ChoosersRecord(Structure):
    """The elements of robots, both in the order in which robots choose."""
    all: ElementsRecord; robots: Int64; first: Int64s; seeing: Int64s

@record
class AttacksRecord(Structure):
    """Attacks whose groups have no blinded robots."""
    attacks: Int64; widest: Int64; members: UInt64s; of: Int64s; order: Int64s

@record
class PathRecord(Structure):
    """Place of the search."""
    depth: Int64; size: Int64; chosen: Int64s; seers: UInt64s; version: Int64s; record: Int32s

@record
class GainsRecord(Structure):
    """Values and gains of each target beside the last sets of its seers."""
    sets: Int64; value: Doubles; gain: Doubles; since: Int64s; version: Int64s; seers: UInt64s; slot: Int64s

@record
class GreedyRecord(Structure):
    """Gains of the greedy algorithm."""
    criterion: Int64; targets: Int64; width: Int64; weights: Doubles; information: Doubles; sums: Doubles
    covariances: Doubles; order: Int64s; bounds: Doubles; gains: Doubles

@record
class DescentRecord(Structure):
    """Descent over the contexts of one element."""
    owners: Int64; targets: Int64; sign: Double; value: Double; relative: Double; rounding: Double; parts: Doubles
    ends: Int64s; added: Doubles; total: Doubles; picks: Int64s; rest: Doubles; one: Doubles

@record
class ProgramRecord(Structure):
    """Parts of an affine underestimator."""
    targets: Int64; robots: Int64; heavies: Int64; patterns: Int64; size: Int64; first: Int64s; pattern: Int64s
    values: Doubles; light: Doubles; inside: Doubles; heavy: Int64s; information: Doubles

@record
class PricingRecord(Structure):
    """A search for groups of small reduced cost."""
    team: Pointer[TeamRecord]; threshold: Double; level: Double; n_blinded: Int64; most_cut: Int64; most: Int64
    start: Int64s; robot: Int64s; back: Int64s; fixed: Bytes; seeing: Bytes; least_cut: Int64s; duals: Int64s
    order: Int64s; blinding: Int64; unit: Int64; limit: Int64; effort: Int64

@record
class GroupTreeRecord(Structure):
    """A tree of cases that is written for a proof."""
    limit: Int64; averages: Int64; count: Int64; capacity: Int64; n_flows: Int64; most_flows: Int64; n_listed: Int64
    most_listed: Int64; nodes: Int64s; flows: Int64s; recent: Int64s; listed: Int8s; needs: Int64s; n_limits: Int64
    limited: UInt64s; most: Int64s; uses: Int64s

@record
class RowRecord(Structure):
    """A row of a tree over sets."""
    sensing: UInt64; count: Int32; first: Int32; size: Int32

@record
class SearchRecord(Structure):
    """An open search of groups."""

@record
class ScanRecord(Structure):
    """Progress of a round of exchanges, and the best one so far."""
    next: Int64; leaves: Int64; enters: Int64; lowest: Double

@record
class SetQuestionRecord(Structure):
    """A search of sets of one size."""
    team: Pointer[TeamRecord]; threshold: Double; level: Double; limit: Double; size: Int64; start: Doubles
    candidates: Int64; in_order: Int64; order: Int64s; costs: Doubles

@record
class SetSearchRecord(Structure):
    """An open search of sets."""

@record
class ChoiceRecord(Structure):
    """A level of the search of disjoint sets."""
    decided: UInt64; rest: UInt64; next: Int64; chosen: Int64; cost: Double; value: Double; counts: Int32s
    option: Int32; places: Int32; kept: Int32; unused: Int32

@record
class DisjointSetsRecord(Structure):
    """Disjoint sets from lists, by their first robots and cheapest first."""
    robots: Int64; classes: Int64; rest: Int64; n_blinded: Int64; masks: UInt64s; values: Doubles; costs: Doubles
    starts: Int64s; rest_costs: Doubles; single: Doubles; must: UInt64; threshold: Double; room: Double
    remembered: Int64; depth: Int64; found: Int64; memory: UInt64s; stack: Pointer[ChoiceRecord]; best: Int64s

@record
class SeersRecord(Structure):
    """The elements that tell about one target, robot by robot."""
    robots: Int32; dimension: Int32; criterion: Int32; weight: Double; baseline: Double; error: Double; first: Int64s
    prior: Doubles; information: Doubles

class Loops(Protocol):
    """Functions of the compiled loops, by header."""

    # team.h
    def value_of(self, team: TeamRecord, sums: Doubles) -> Double: ...
    def criteria_before(self, team: TeamRecord, before: Doubles) -> None: ...
    def all_values(self, team: TeamRecord, values: Doubles, sums: Doubles) -> None: ...
    def sources(self) -> Text: ...
    def mark_below(self, team: TeamRecord, threshold: Double, first: Int64, last: Int64, outside: Bytes, inside: Bytes,
                   most: Int, sizes: Bytes, next: Doubles, next_set: Int64s) -> Int: ...
    def level_of_threshold(self, team: TeamRecord, threshold: Double) -> Double: ...

    # annealing.h
    def anneal(self, a: AnnealRecord) -> Int: ...
    def anneal_cut(self, a: CutAnnealRecord, first: Int64, last: Int64, moves: Int64, fewest: Int64) -> Int64: ...

    # elements.h
    def bound_robots(self, choices: ChoicesRecord, masks: UInt64s, bounds: Doubles) -> None: ...
    def group_values(self, choices: ChoicesRecord, bounds: Doubles, groups: Int64, members: Bytes,
                     values: Doubles) -> None: ...

    # covers.h
    def lose_all(self, choices: ChoicesRecord, groups: Int64, inside: Bytes, price: Doubles, values: Doubles,
                 level: Double, noise: Doubles, out: Bytes, paid: Doubles) -> Int: ...
    def keep_elements(self, choices: ChoicesRecord, inside: Bytes, price: Doubles, level: Double, kept: Bytes,
                      sums: Doubles, paid: Doubles) -> Int: ...
    def dive_by_covers(self, choices: ChoicesRecord, ways: WaysRecord, covers: CoversRecord, sums: SumsRecord,
                       stack: StackRecord, record: NodesRecord, level: Double, nodes: Int64, most: Int64,
                       outcome: Int32s) -> Int: ...

    # cut_states.h
    def join_cut_states(self, f: CutFrontRecord, a: CutStatesRecord, b: CutStatesRecord, start: Int64,
                        pairs: Int64) -> Int64: ...

    # groups.h
    def list_groups(self, robots: Int, neighbours: UInt64s, protected_links: UInt64s, most: Int64,
                    stack: Pointer[BranchRecord], position: Int64s, steps: Int64, room: Int64, groups: UInt64s,
                    cuts: UInt16s) -> Int64: ...
    def price(self, robots: Int, columns: ColumnsRecord, duals: DualsRecord, cheapest: Int64s) -> Int64: ...
    def within_gap(self, columns: ColumnsRecord, duals: DualsRecord, gap: Int64, room: Int64, chosen: Int64s,
                   costs: Int64s) -> Int64: ...
    def restrict_columns(self, columns: ColumnsRecord, set: UInt64, size: Int, protected: UInt64,
                         most: Int) -> Int64: ...
    def next_cover(self, cover: CoverRecord, steps: Int64) -> Int: ...

    # kept_links.h
    def close_kept_links(self, s: Pointer[KeptSearchRecord]) -> None: ...
    def open_kept_links(self, question: KeptLinksRecord) -> Pointer[KeptSearchRecord]: ...
    def search_kept_links(self, s: Pointer[KeptSearchRecord], nodes: Int64) -> Int: ...

    # lattice.h
    def disjoint_slack(self, values: Doubles, first: Int64, last: Int64, slack: Doubles, sets: Int64s) -> None: ...
    def gain_ratio(self, values: Doubles, axes: Int, sizes: Int64s, first: Int64, last: Int64, noise: Double,
                   positions: Int64s, ratios: Doubles, sets: Int64s) -> None: ...

    # marginals.h
    def dive_by_marginals(self, team: ChoosersRecord, attacks: AttacksRecord, gains: GainsRecord, path: PathRecord,
                          level: Double, slack: Double, nodes: Int64, most: Int64) -> Int: ...

    # outputs.h
    def output_covariances(self, count: Int64, targets: Int64, q: Int64, d: Int64, matrices: Doubles, output: Doubles,
                           spare: Doubles, covariances: Doubles) -> None: ...

    # planar.h
    def evaluate_gains(self, g: GreedyRecord, candidates: Int64s, count: Int64, close: Double,
                       best: Double) -> Double: ...
    def descend(self, d: DescentRecord) -> Int: ...
    def descend_pairs(self, d: DescentRecord, i: Int64) -> None: ...
    def sum_ceilings(self, count: Int64, options: Int64, width: Int64, owners: Int64s, levels: Doubles, slopes: Doubles,
                     own: Doubles, best: Doubles, sums: Doubles, sizes: Doubles) -> None: ...

    # polytopes.h
    def cut_polytopes(self, targets: Int64, patterns: Int64, rows: Int64, capacity: Int64, normals: Doubles,
                      offsets: Doubles, factors: Doubles, vertices: Doubles, facets: UInt64s,
                      numbers: Int64s) -> Int64: ...
    def vertex_values(self, team: TeamRecord, patterns: Int64, starts: Doubles, vertices: Doubles, numbers: Int64s,
                      values: Doubles) -> None: ...
    def rest_of_vertices(self, p: ProgramRecord, multipliers: Doubles, rest: Doubles, spare: Doubles) -> None: ...
    def smoothed_bound(self, p: ProgramRecord, multipliers: Doubles, temperature: Double, gradient: Doubles,
                       fraction: Doubles, soft: Doubles, rest: Doubles, spare: Doubles) -> Double: ...

    # pricing.h
    def close_pricing(self, s: Pointer[SearchRecord]) -> None: ...
    def open_pricing(self, question: PricingRecord) -> Pointer[SearchRecord]: ...
    def list_groups_below(self, s: Pointer[SearchRecord], nodes: Int64, room: Int64, groups: Int8s, columns: Int64s,
                          count: Int64s, progress: Int64s) -> Int: ...
    def most_below(self, s: Pointer[SearchRecord], group: Bytes) -> Int64: ...
    def anneal_column(self, q: PricingRecord, first: Int64, moves: Int64, hot: Double, cold: Double, random: UInt64s,
                      best: Int8s) -> Int64: ...
    def grow_sets_tree(self, s: Pointer[SearchRecord], out: GroupTreeRecord, among: Int8s, rows: Pointer[RowRecord],
                       depth: Int32s, size: Int64, effort: Int64) -> Int: ...
    def grow_group_tree(self, s: Pointer[SearchRecord], out: GroupTreeRecord, cases: Int64) -> Int: ...

    # sets_of_size.h
    def close_sets(self, s: Pointer[SetSearchRecord]) -> None: ...
    def open_sets(self, question: SetQuestionRecord) -> Pointer[SetSearchRecord]: ...
    def next_set_below(self, s: Pointer[SetSearchRecord], nodes: Int64, chosen: Bytes, value: Doubles,
                       progress: Int64s) -> Int: ...
    def list_sets_below(self, s: Pointer[SetSearchRecord], nodes: Int64, room: Int64, chosen: Bytes, masks: UInt64s,
                        values: Doubles, count: Int64s, progress: Int64s) -> Int: ...
    def least_open(self, s: Pointer[SetSearchRecord]) -> Double: ...
    def exchange_groups(self, team: TeamRecord, groups: Int, home: Int64s, must: Bytes, share: Double, pairs: Int64,
                        scan: ScanRecord, value: Doubles) -> Int: ...
    def search_disjoint(self, d: DisjointSetsRecord, work: Int64) -> Int: ...

    # target_sets.h
    def largest_excess(self, seers: SeersRecord, prices: Doubles, floor: Double, tolerance: Double, most: Int64,
                       chosen: Int64s) -> Double: ...

loops = cast("Loops", Loader(Loops))
"""Functions, bound at the first use."""
