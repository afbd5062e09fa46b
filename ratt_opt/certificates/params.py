"""Parameters of writing certificates: one frozen class for each part, together in :class:`CertificateParams`.

They decide how long a proof takes to find, how long it is, and how far its ends are moved, never what it proves: the
verifier decides that.
"""

from __future__ import annotations

from dataclasses import dataclass, field

from ratt_opt._params import check_at_least_one
from ratt_opt.certificates.target_trees import TargetTreeParams
from ratt_opt.certificates.verifier.limits import VerifierLimits
from ratt_opt.errors import InputError

__all__ = [
    "DEFAULT",
    "CertificateParams",
    "CoverProofParams",
    "CutProofParams",
    "ExplanationParams",
    "GroupTreeParams",
    "LowerProofParams",
    "PointParams",
    "SizeProofParams",
    "WritingParams",
]


@dataclass(frozen=True, slots=True, kw_only=True)
class WritingParams:
    """Claims that are tried, and the time of their proofs.

    ``shaves`` : relative amounts by which a float lower bound is lowered, in turn, until exact arithmetic proves it:
        larger ones prove less, and more surely
    ``roundings`` : least ratio of the largest shave to the error of the objective's values
    ``lower_share`` : of the seconds left, for a cover of all attacks; verifying takes about as long again
    ``checked_share`` : of them, less the reserve, for verifying one proof; if that does not end, less is proved
    ``reserved``, ``least_reserved`` : seconds kept from verifying both ends, relative to those of bounding the upper
        end, and in addition [s]; the file is verified in them with the upper end alone, if it must be
    """

    shaves: tuple[float, ...] = (0.0, 1e-16, 1e-15, 1e-14, 1e-13, 1e-12, 1e-11)
    roundings: float = 16.0
    lower_share: float = 0.4
    checked_share: float = 0.7
    reserved: float = 1.5
    least_reserved: float = 0.1


@dataclass(frozen=True, slots=True, kw_only=True)
class LowerProofParams:
    """Ways to prove a lower end, and how far it is lowered if none succeeds.

    ``nodes`` : of a tree, at most: longer proofs against larger files
    ``share_of_others`` : of the seconds left, for each way but the last
    ``dense`` : share of all links from which sizes of groups come first, on more robots than ``covers_first``. Of 48
        teams of 8 to 16 robots duals and covers prove all, in a tenth of the time; sizes leave eight open
    ``lowered`` : shares of a threshold by which it is lowered, in turn, until it is proved
    """

    nodes: int = 300_000
    share_of_others: float = 0.4
    dense: float = 0.6
    covers_first: int = 16
    lowered: tuple[float, ...] = (0.01, 0.03, 0.1, 0.3)


@dataclass(frozen=True, slots=True, kw_only=True)
class CoverProofParams:
    """Proofs by dual prices of groups.

    ``unit`` : of integer duals, for a link that leaves a group. By rounding, duals of 100 robots claim less by under a
        hundredth of a link; larger units write longer flows
    ``listed``, ``seconds``, ``share`` : groups that are listed for the best duals, and the time for that: seconds, and
        share of those left
    ``margin`` : links that the duals claim beyond the budget, counted from both sides: what they could claim besides is
        slack of every group; with some, trees are a tenth shorter
    ``searched`` : nodes of the search for duals (seconds, up to half a minute at 30 robots)
    ``partitions`` : nodes of the search of partitions
    ``with_limits``, ``shorter`` : shares of the seconds left for a proof with limits, and for a shorter one without
    ``numbers`` : nodes and numbers of flows; the verifier reads files of two million
    """

    unit: int = 1 << 14
    listed: int = 1_000_000
    seconds: float = 20.0
    share: float = 0.3
    margin: float = 0.02
    searched: int = 2_000_000
    partitions: int = 200_000
    with_limits: float = 0.6
    shorter: float = 0.3
    numbers: int = 1_500_000


@dataclass(frozen=True, slots=True, kw_only=True)
class GroupTreeParams:
    """Trees over groups, and over sets of a size.

    ``cases`` : between two looks at the clock (some hundredths of a second)
    ``criteria``, ``most_criteria`` : of single targets for a tree over sets: between two looks at the clock (a tenth of
        a second), and at most
    ``flows``, ``listed`` : of a tree; ``flow_numbers`` : in all of its flows
    """

    cases: int = 100
    criteria: int = 4_000_000
    most_criteria: int = 256_000_000
    flows: int = 12_000
    listed: int = 20_000
    flow_numbers: int = 1_000_000


@dataclass(frozen=True, slots=True, kw_only=True)
class SizeProofParams:
    """Proofs by the sizes of groups.

    ``robots`` : of a team, at most
    ``few`` : nodes of a tree over all sets of a size; if it has more, the largest groups of that size get their own
    ``numbers`` : integers of trees and bounds; the verifier reads files of two million
    ``near``, ``steps`` : links (twice) above what a group must score from which a bound is not tried to be lowered, and
        values that this takes. With 3 and 18 a tree of 24 robots has a quarter fewer nodes, and takes three to ten
        times as long to find
    ``spare`` : room left below a bound for rounding the diagonal, in twice the links
    """

    robots: int = 60
    few: int = 20_000
    numbers: int = 1_500_000
    near: float = 1.5
    steps: int = 6
    spare: float = 0.02


@dataclass(frozen=True, slots=True, kw_only=True)
class PointParams:
    """Points and constants of the upper proof.

    ``digits`` : kept of a Fenchel point: any point is valid, and the bound changes by the square of its error
    ``lemma_digits`` : kept of points and scores of single targets: a leaf of a lemma bounds many sets, most beside it
    ``condition`` : largest condition of matrices whose points are shortened: with more, so few digits could leave one
        that is not positive definite
    ``precision`` : of balls around the constants that trees prove [bits]
    """

    digits: int = 9
    lemma_digits: int = 12
    condition: float = 1e6
    precision: int = 256


@dataclass(frozen=True, slots=True, kw_only=True)
class CutProofParams:
    """Certificates of fewest cuts.

    ``numbers`` : of a tree, at most; the verifier refuses longer files
    ``seconds`` : in which a proof is verified if writing it has taken all the time [s]
    """

    numbers: int = 1_800_000
    seconds: float = 1.0


@dataclass(frozen=True, slots=True, kw_only=True)
class ExplanationParams:
    """Length of a proof in words.

    ``lines`` : of one tree, and numbers of one list, at most; the rest is counted
    ``digits`` : of a value; ``bits`` : of the balls that it is computed in
    """

    lines: int = 200
    digits: int = 6
    bits: int = 96


@dataclass(frozen=True, slots=True, kw_only=True)
class CertificateParams:
    """Parameters of one certificate, part by part; ``replace`` changes some.

    ``certify(..., params=params)`` and ``certify_cuts(..., params=params)`` use them. ``verifier`` : limits of the
    check that a file must pass before it gets its name.
    """

    writing: WritingParams = field(default_factory=WritingParams)
    lower: LowerProofParams = field(default_factory=LowerProofParams)
    covers: CoverProofParams = field(default_factory=CoverProofParams)
    trees: GroupTreeParams = field(default_factory=GroupTreeParams)
    sizes: SizeProofParams = field(default_factory=SizeProofParams)
    points: PointParams = field(default_factory=PointParams)
    lemmas: TargetTreeParams = field(default_factory=TargetTreeParams)
    cuts: CutProofParams = field(default_factory=CutProofParams)
    verifier: VerifierLimits = field(default_factory=VerifierLimits)

    def __post_init__(self) -> None:
        """Check what no proof could be written with. ``InputError`` : it is less than 1, or no shave is stated."""
        check_at_least_one(self, AT_LEAST_ONE)
        if not self.writing.shaves:
            raise InputError("params.writing.shaves", "must hold a share by which the lower end is lowered", ())
        if self.points.precision < 53:
            raise InputError("params.points.precision", "must be at least 53, as floats have", self.points.precision)
        if self.covers.unit > 1 << 20:
            raise InputError("params.covers.unit", "must be at most 2**20", self.covers.unit)


AT_LEAST_ONE = (
    "covers.unit", "trees.cases", "trees.criteria", "points.digits", "points.lemma_digits", "lemmas.steps",
    "lemmas.searches", "lemmas.divided", "lemmas.at_once",
)  # fmt: skip
"""Parameters without which no proof would be found, or the search for it would not end."""
DEFAULT = CertificateParams()
"""Parameters of certificates that are not given any."""
