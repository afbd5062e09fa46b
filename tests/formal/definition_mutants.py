"""Change one definition of ``formal/`` at a time and see whether the proofs, examples included, still go through.

``python -m tests.formal.definition_mutants [START [STOP]]`` needs coqc and up to a minute for each change; it prints
where each is noticed, the changes that nothing notices, and how many there are of each kind.
"""

import re
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

FORMAL = Path(__file__).parents[2] / "formal"
CHANGES = (
    # attack
    ("Teams", "#|blinded a| <= alpha_s t", "#|blinded a| < alpha_s t"),
    ("Teams", "#|blinded a| <= alpha_s t", "#|blinded a| <= (alpha_s t).+1"),
    ("Teams", "#|cut a| <= alpha_c t", "#|cut a| < alpha_c t"),
    ("Teams", "#|cut a| <= alpha_c t", "#|cut a| <= (alpha_c t).+1"),
    ("Teams", "#|cut a| <= alpha_c t", "#|cut a| <= alpha_s t"),
    ("Teams", "cut a \\subset links t,", "true,"),
    ("Teams", "[disjoint blinded a & safe_robots t]", "true"),
    ("Teams", "[disjoint cut a & safe_links t]", "true"),
    ("Teams", "[disjoint cut a & safe_links t]", "(cut a \\subset safe_links t)"),
    # links left and groups
    ("Teams", "(i != j) && ([set i; j] \\in links t :\\: cut a)", "(i != j) && ([set i; j] \\in links t)"),
    ("Teams", "(i != j) && ([set i; j] \\in links t :\\: cut a)", "(i != j) && ([set i; j] \\in links t :|: cut a)"),
    (
        "Teams",
        "(i != j) && ([set i; j] \\in links t :\\: cut a).",
        "[&& i != j, j \\notin blinded a, i \\notin blinded a & [set i; j] \\in links t :\\: cut a].",
    ),
    ("Teams", "[set j | connect (linked t a) i j]", "[set j | (i == j) || linked t a i j]"),
    ("Teams", "[set j | connect (linked t a) i j]", "[set j | true]"),
    ("Teams", "[set j | connect (linked t a) i j]", "[set i]"),
    ("Teams", "group t a i :\\: blinded a", "group t a i"),
    ("Teams", "group t a i :\\: blinded a", "group t a i :&: blinded a"),
    # plan and its value
    ("Teams", "[forall i, owner t (p i) == i]", "[exists i, owner t (p i) == i]"),
    ("Teams", "[forall i, owner t (p i) == i]", "true"),
    ("Teams", "p @: G.", "p @: [set: R]."),
    (
        "Teams",
        "\\big[Num.max/value i0]_(i <- enum R) value i else phi set0",
        "\\big[Num.min/value i0]_(i <- enum R) value i else phi set0",
    ),
    ("Teams", "\\big[Num.max/value i0]_(i <- enum R) value i else phi set0", "value i0 else phi set0"),
    # worst case and optimum
    ("Teams", "\\big[Num.min/team_value t phi p no_attack]", "\\big[Num.max/team_value t phi p no_attack]"),
    ("Teams", "(a <- enum [finType of attack] | allowed t a) team_value", "(a <- [::] | allowed t a) team_value"),
    ("Teams", "(exists2 p, is_plan t p & worst_case t phi p = x) /\\", "True /\\"),
    ("Teams", "(forall p, is_plan t p -> worst_case t phi p <= x)", "True"),
    ("Teams", "\\big[Num.max/worst_case t phi p0]", "\\big[Num.min/worst_case t phi p0]"),
    ("Teams", "(p <- enum [finType of {ffun R -> E}] | is_plan t p)", "(p <- enum [finType of {ffun R -> E}])"),
    # classes of functions and curvatures
    ("Guarantees", "(owner t x == owner t y) ==> (x == y)", "(x == y)"),
    ("Guarantees", "(owner t x == owner t y) ==> (x == y)", "true"),
    ("Guarantees", "phi (x |: A) - phi A.", "phi (x |: A)."),
    ("Guarantees", "phi set0 = 0.", "True."),
    ("Guarantees", "feasible B -> A \\subset B -> phi A <= phi B.", "feasible B -> A \\subset B -> phi B <= phi A."),
    ("Guarantees", "marginal x B <= marginal x A.", "marginal x A <= marginal x B."),
    ("Guarantees", "(1 - k) * phi [set x] <= marginal x A.", "k * phi [set x] <= marginal x A."),
    ("Guarantees", "(1 - k) * phi [set x] <= marginal x A.", "marginal x A <= (1 - k) * phi [set x]."),
    ("Guarantees", "(1 - k) * phi [set x] <= marginal x A.", "(1 - k) ^+ 2 * phi [set x] <= marginal x A."),
    ("Guarantees", "(1 - c) * marginal x B <= marginal x A.", "c * marginal x B <= marginal x A."),
    ("Guarantees", "(1 - c) * marginal x B <= marginal x A.", "(1 - c) ^+ 2 * marginal x B <= marginal x A."),
    # bait, greedy, RATT
    ("Planner", "if f b < f y then y else b", "if f b <= f y then y else b"),
    ("Planner", "if f b < f y then y else b", "if f y < f b then y else b"),
    ("Planner", "if f b < f y then y else b", "b"),
    ("Planner", "alone (best j) <= alone (best i)) (enum R)", "alone (best i) <= alone (best j)) (enum R)"),
    ("Planner", "alone (best j) <= alone (best i)) (enum R)", "alone (best j) < alone (best i)) (enum R)"),
    ("Planner", "take alpha by_value", "drop alpha by_value"),
    ("Planner", "take alpha by_value", "take alpha.+1 by_value"),
    ("Planner", "first_max (fun z => phi (z |: chosen)) x s in", "first_max (fun z => phi [set z]) x s in"),
    ("Planner", "(y |: chosen)\n  | _, _ => [::]", "chosen\n  | _, _ => [::]"),
    ("Planner", "owner t z != owner t y] (y |: chosen)", "z != y] (y |: chosen)"),
    ("Planner", "owner t x \\notin bait alpha] set0", "owner t x \\in bait alpha] set0"),
    ("Planner", "if i \\in bait alpha then best i else", "if i \\notin bait alpha then best i else"),
    # the strongest robots, group sizes, n_max
    ("GroupSize", "[seq i <- order | i \\notin safe_robots t].", "order."),
    ("GroupSizeComplete", "#|l| == 2%N]", "#|l| == 3%N]"),
    # criteria
    ("Criteria", "invmx (prior j) + \\sum_(e in S) info e j", "prior j + \\sum_(e in S) info e j"),
    ("Criteria", "invmx (prior j) + \\sum_(e in S) info e j", "invmx (prior j)"),
    (
        "Criteria",
        "\\sum_j weight j * \\tr (counting j (invmx (L j))).",
        "\\sum_j \\tr (counting j (invmx (L j))).",
    ),
    ("Criteria", "\\sum_j weight j * \\tr (counting j (prior j)).", "\\sum_j \\tr (counting j (prior j))."),
    ("Criteria", "\\sum_j weight j * \\tr (counting j (prior j)).", "\\sum_j weight j * \\tr (prior j)."),
    (
        "Criteria",
        "largest (fun j => weight j * lmax (counting j (invmx (L j))))",
        "largest (fun j => lmax (counting j (invmx (L j))))",
    ),
    ("Criteria", ":= part_of (output j) A.", ":= part_of (output j) 1%:M."),
    ("Criteria", "trace_base - trace_penalty (posterior S)", "trace_penalty (posterior S) - trace_base"),
    (
        "Quadratic",
        "Definition psd A : Prop := forall v, 0 <= form A v v.",
        "Definition psd A : Prop := forall v, 0 < form A v v.",
    ),
    ("Quadratic", ":= C *m A *m C^T.", ":= C *m A *m A *m C^T."),
    ("Quadratic", ":= C *m A *m C^T.", ":= C *m C^T."),
    ("Quadratic", "(lmax A <= x) <-> psd (x%:M - A)", "(lmax A <= x) <-> psd (A - x%:M)"),
    ("Logdet", "(forall x, 0 < x -> ln x <= x - 1)", "(forall x, 0 < x -> x - 1 <= ln x)"),
    ("Logdet", "\\sum_j weight j * - ln (\\det (L j))", "\\sum_j - ln (\\det (L j))"),
    ("Logdet", "\\sum_j weight j * ln (\\det (prior j))", "\\sum_j weight j * - ln (\\det (prior j))"),
    # what the data of a certificate stand for
    ("Dyadic", "valZ (man x) / 2%:R ^+ N.to_nat (sc x)", "valZ (man x) * 2%:R ^+ N.to_nat (sc x)"),
    ("DyadicMatrix", "let a := maxn i j in nth d0 flat ((a * a.+1)./2 + minn i j)", "nth d0 flat (i + j)"),
    ("Outputs", "nth d0 flat (i * columns + k).", "nth d0 flat (k * columns + i)."),
    ("Outputs", "nth d0 flat (i * columns + k).", "nth d0 flat (i + k)."),
    ("Outputs", "if i == k then d1 else d0.", "d1."),
    ("Outputs", "size (nth [::] cs j) %/ d else d.", "1 else d."),
)


def noticed(number: int) -> bool:
    """Whether the proofs fail with one definition changed."""
    name, old, new = CHANGES[number]
    with tempfile.TemporaryDirectory() as folder:
        copy = Path(folder) / "formal"
        shutil.copytree(FORMAL, copy)
        path = copy / "theories" / f"{name}.v"
        text = path.read_text()
        if old not in text:
            raise SystemExit(f"change {number}: {name}.v has no {old!r}")
        path.write_text(text.replace(old, new, 1))
        done = subprocess.run(["make", "-C", str(copy), "all"], capture_output=True, text=True, check=False)
        if done.returncode:
            where = re.search(r'File "\./theories/(\w+)\.v", line (\d+)', done.stderr)
            print(f"{number} noticed in {where[1]}, line {where[2]}" if where else done.stderr[-300:], flush=True)
        return done.returncode != 0


def main() -> None:
    """Try the changes of a range."""
    start, stop = (
        (int(x) for x in [*sys.argv[1:], "0", str(len(CHANGES))][:2]) if len(sys.argv) > 2 else (0, len(CHANGES))
    )
    left = [k for k in range(start, min(stop, len(CHANGES))) if not noticed(k)]
    for k in left:
        print(f"{k} not noticed: {CHANGES[k]}")
    print(f"{min(stop, len(CHANGES)) - start - len(left)} noticed, {len(left)} not")


if __name__ == "__main__":
    main()
