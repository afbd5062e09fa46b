(** The executable checker: problem, claim and proofs as plain data, decided in exact arithmetic. *)
From Coq Require Import ZArith.
From mathcomp Require Import all_ssreflect.
From Ratt Require Import Dyadic DyadicMatrix DyadicLog Outputs Graph Scores Covers Lemmas Gains UpperTree LowerTree CaseTree Costs GroupProofs Sizes Forced.
Set Implicit Arguments.
Unset Strict Implicit.
Unset Printing Implicit Defensive.

(** ** Data *)
Inductive criterion := Trace | LogDet | MaxEigenvalue.

(** Symmetric matrices are lower triangles, row by row. [outputs]: the part of each target's state that counts, if not all
    of it does. [informations]: by element, then by target. *)
Record problem := Problem {
  objective : criterion;
  dimension : nat;
  priors : seq (seq dyadic);
  weights : seq dyadic;
  outputs : outputs_data;
  informations : seq (seq (seq dyadic));
  net : network
}.
Record claim := Claim { plan : seq nat; lower : dyadic; upper : dyadic }.

(** Where a linear bound touches: one matrix per target (trace, log-det), or a target, a length and a direction. Matrices
    are symmetric, but with outputs: then they have a column for each row of the output, and are listed whole. *)
Inductive point := TracePoint of seq (seq dyadic) | EigenPoint of nat & dyadic & seq dyadic.
(** The same of one target; for log-det also a base set, beside which gains diminish. *)
Inductive touch := MatrixTouch of seq dyadic | EigenTouch of dyadic & seq dyadic | BaseTouch of seq nat.
(** Version 1: a size tree, an attack tree. Version 2: the sets alone, dual prices, a cover, sizes of groups. *)
Inductive lower_proof :=
| ForcedSize of nat & size_tree
| AttackTree of attack_tree
| ForcedSets of sets_lemma
| Duals of sets_lemma & group_tree
| Cover of sets_lemma & group_tree & seq nat
| GroupSizes of sets_lemma & size_proof
| NoLower.
(** A cover: an attack on links, by number, the elements that are left out, and a point for each group. *)
Definition listed_cover := (nat * seq nat * seq nat)%type.
(** Inequalities of single targets, tangents first, and rows: attack, group, an inequality of each target (of one, for the
    largest eigenvalue). [spacing]: how many targets a plan sees at most, and lemmas without scores. *)
Record rows_data := RowsData {
  tangent_list : seq (nat * touch);
  lemma_list : seq listed_lemma;
  row_list : seq (nat * nat * seq nat);
  spacing : option (nat * seq nat)
}.
Definition no_rows : rows_data := RowsData [::] [::] [::] None.
Record proofs := Proofs {
  prior_low : dyadic;
  prior_high : dyadic;
  listed : seq listed_attack;
  points : seq point;
  cut_list : seq (nat * nat * nat);
  cover_list : seq listed_cover;
  upper_part : upper_tree;
  lower_part : lower_proof;
  rows_part : rows_data
}.

(** ** Small tools *)
Fixpoint all_some (T : Type) (s : seq (option T)) : option (seq T) :=
  match s with
  | [::] => Some [::]
  | Some x :: s' => if all_some s' is Some r then Some (x :: r) else None
  | None :: _ => None
  end.
Definition some_or (T : Type) (x y : option T) : option T := if x is Some _ then x else y.

Section Matrices.
Variable d : nat.

(** Symmetric [Q] with [Q <= P^-1] (or [>=]) in the Loewner order, checked as [P - P Q P >= 0]. *)
Definition near_inverse (p : N) (h : dmat * dyadic) : dmat :=
  mkm d (fun i j => quotient_near p (get h.1 (maxn i j) (minn i j)) h.2).
Definition sandwich (P Q : dmat) : dmat := mmul d (mmul d P Q) P.
Definition below_inverse (P Q : dmat) : bool := is_psd d (msub d P (sandwich P Q)).
Definition above_inverse (P Q : dmat) : bool := is_psd d (msub d (sandwich P Q) P).
Definition checked (ok : dmat -> bool) (Q : dmat) : option dmat := if ok Q then Some Q else None.
Definition inverse_bound (ok : dmat -> bool) (shift : dmat -> dyadic -> dmat) (P : dmat) : option dmat :=
  let h := inverse_hint d P in
  let attempt p e := let Q := near_inverse p h in
    some_or (checked ok Q) (checked ok (shift Q (dtiny e))) in
  some_or (attempt 224%num 200%num) (attempt 1200%num 1150%num).
Definition inverse_low (P : dmat) : option dmat :=
  inverse_bound (below_inverse P) (fun Q e => msub d Q (mscalar d e)) P.
Definition inverse_high (P : dmat) : option dmat :=
  inverse_bound (above_inverse P) (fun Q e => madd d Q (mscalar d e)) P.

(** [delta >= 0] with [A + delta I >= 0]: stored information is semidefinite up to rounding only. *)
Definition dabs (x : dyadic) : dyadic := dmax x (dopp x).
Definition enough_of (A : dmat) : dyadic :=
  dmul (dnat d) (foldl (fun m row => foldl (fun m x => dmax m (dabs x)) m row) d0 A).
Definition defect_ok (A : dmat) (delta : dyadic) : bool := dle d0 delta && is_psd d (madd d A (mscalar d delta)).
Definition defect (A : dmat) : option dyadic :=
  if is_psd d A then Some d0
  else let e := enough_of A in
    let tries := [seq dmul e (dtiny (N.of_nat k)) | k <- rev (iota 28 37)] in
    if [seq x <- tries | defect_ok A x] is x :: _ then Some x else None.
End Matrices.

(** ** The criterion's penalty (what is left of the posterior), bounded from above *)
(** Targets of equal weight share one logarithm. *)
Definition weight_groups (ws : seq dyadic) : seq (dyadic * seq nat) :=
  [seq (v, [seq j <- iota 0 (size ws) | nth d0 ws j == v]) | v <- undup ws].
(** Tried in turn: a logarithm's error is about [2^-k]; numbers are rounded to [2^-p]. *)
Definition precisions : seq (nat * N) := [:: (24, 96%num); (44, 160%num); (110, 1024%num)].

Section Penalty.
Variables (kind : criterion) (d m : nat) (ws : seq dyadic) (Ss : seq (option dmat)) (groups : seq (dyadic * seq nat)).

Definition trace_up (p : N) (s : seq dmat) : option dyadic :=
  if all_some [seq trace_inverse_up p d (nth None Ss j) (nth [::] s j) | j <- iota 0 m] is Some ys then
    Some (dsum [seq dmul (nth d0 ws j) (nth d0 ys j) | j <- iota 0 m])
  else None.
Definition determinant_products (p : N) (s : seq dmat) : seq (dyadic * dyadic) :=
  let dets := [seq mdet d (nth [::] s j) | j <- iota 0 m] in
  [seq (g.1, short_product p [seq nth d0 dets j | j <- g.2]) | g <- groups].
Definition logdet_up (k : nat) (p : N) (s : seq dmat) : option dyadic :=
  if all (fun j => is_pd d (nth [::] s j)) (iota 0 m) then
    let products := determinant_products (N.add p 32) s in
    if all (fun x => dlt d0 x.2) products then
      Some (dsum [seq dmul x.1 (log_inverse_up k p x.2) | x <- products])
    else None
  else None.
Definition is_at_most (x : option dyadic) (y : dyadic) : bool := if x is Some z then dle z y else false.
Definition eigen_enough (room : dyadic) (s : seq dmat) : bool :=
  dlt d0 room && all (fun j => is_pd d (nth [::] s j) &&
    is_psd d (msub d (mscale d room (nth [::] s j)) (weighted_square d (nth d0 ws j) (nth None Ss j)))) (iota 0 m).

(** Hint for two rows: [w / lambda_min], a little more. *)
Definition eigen_hint (p : N) (w : dyadic) (A : dmat) : dyadic :=
  let t := dadd (get A 0 0) (get A 1 1) in
  let det := dsub (dmul (get A 0 0) (get A 1 1)) (dmul (get A 1 0) (get A 0 1)) in
  let disc := dsub (dmul t t) (dmul (dnat 4) det) in
  quotient_up p (dmul w (dadd t (root_up p disc))) (dmul (dnat 2) det).
Definition eigen_up (p : N) (room : dyadic) (s : seq dmat) : option dyadic :=
  let y := if (d == 2%N) && nilp Ss then
      foldl dmax d0 [seq eigen_hint p (nth d0 ws j) (nth [::] s j) | j <- iota 0 m]
    else room in
  if eigen_enough y s then Some y else None.

Definition penalty_up (room : dyadic) (s : seq dmat) (e : nat * N) : option dyadic :=
  match kind with
  | Trace => trace_up e.2 s
  | LogDet => logdet_up e.1 e.2 s
  | MaxEigenvalue => eigen_up e.2 room s
  end.
Definition penalty_within (room : dyadic) (s : seq dmat) : bool :=
  match kind with
  | Trace | LogDet => has (fun e => is_at_most (penalty_up room s e) room) precisions
  | MaxEigenvalue => eigen_enough room s
  end.
End Penalty.

(** ** The lower end *)
Section Lower.
Variables (kind : criterion) (d m : nat) (ws : seq dyadic) (Ss : seq (option dmat)) (groups : seq (dyadic * seq nat)).
Variables (lows : seq dmat) (rows : seq (seq dmat)).
Variables (claimed room : dyadic).

Definition combine (f : nat -> dmat) : seq dmat := mkseq f m.
Definition add_robot (s : seq dmat) (i : nat) : seq dmat :=
  combine (fun j => madd d (nth [::] s j) (nth [::] (nth [::] rows i) j)).
Definition add_times (r : nat) (s : seq dmat) (i : nat) : seq dmat :=
  combine (fun j => madd d (nth [::] s j) (mscale d (dnat r) (nth [::] (nth [::] rows i) j))).
(** A claim of at most 0 needs no more than the prior's information. *)
Definition as_good_as_prior (s : seq dmat) : bool :=
  dle claimed d0 && all (fun j => is_psd d (msub d (nth [::] s j) (nth [::] lows j))) (iota 0 m).
Definition worth (s : seq dmat) : bool := as_good_as_prior s || penalty_within kind d m ws Ss groups room s.
Definition average_within (cases : seq (seq dmat)) (r : nat) (e : nat * N) : bool :=
  if all_some [seq penalty_up kind d m ws Ss groups room c e | c <- cases] is Some ys then
    let t := nth d0 (sort (fun x y => dle y x) ys) r.-1 in
    dle (dadd (dsum [seq dmax d0 (dsub y t) | y <- ys]) (dmul (dnat r) t)) (dmul (dnat r) room)
  else false.
Definition average_worth (s : seq dmat) (rest : seq nat) (r : nat) : bool :=
  uniq rest && (r <= size rest)%N &&
  let cases := [seq add_times r s i | i <- rest] in
  all as_good_as_prior cases || has (average_within cases r) precisions.
End Lower.

(** ** The upper end's linear bounds *)
Section Cuts.
Variables (kind : criterion) (d m : nat) (ws : seq dyadic) (o : outputs_data) (Ss : seq (option dmat)).
Variables (ps highs : seq dmat) (infos : seq (seq dmat)).
Variables (base_high : dyadic).

(** A weight matrix per target ([::] for none) and a constant. *)
Definition dots (Ws Is : seq dmat) : dyadic :=
  dsum [seq mdot d x.1 x.2 | x <- zip Ws Is & ~~ nilp x.1].
Definition gradient_at (j : nat) (t : touch) : option (dmat * dyadic) :=
  let wj := nth d0 ws j in
  let close W c := Some (W, dadd c (mdot d W (nth [::] highs j))) in
  match kind, t with
  | Trace, MatrixTouch y =>
      let Y := touching d o j y in
      close (mscale d wj (outer_product d (output_rows d o j) Y))
        (dmul wj (dsub (trace_with d (nth None Ss j) (nth [::] ps j)) (dmul (dnat 2) (touching_trace d o j Y))))
  | LogDet, MatrixTouch y =>
      let Y := unpack d y in
      if is_pd d Y then
        close (mscale d wj Y) (dmul wj (dsub (log_quotient_up 110 400 (mdet d (nth [::] ps j)) (mdet d Y)) (dnat d)))
      else None
  | MaxEigenvalue, EigenTouch t v =>
      let s := length_of d (nth None Ss j) v in
      let b := quotient_up 256 (dmul t t) s in
      if dlt d0 s && dle (dmul t t) (dmul b s) then
        close (mkm d (fun i k => dmul (dmul wj b) (dmul (nth d0 v i) (nth d0 v k))))
          (dsub base_high (dmul (dnat 2) (dmul wj t)))
      else None
  | _, _ => None
  end.
Definition gradient (pt : point) : option (seq dmat * dyadic) :=
  match pt with
  | TracePoint ys =>
      if (size ys == m) && (if kind is MaxEigenvalue then false else true) then
        if all_some [seq gradient_at j (MatrixTouch (nth [::] ys j)) | j <- iota 0 m] is Some gs then
          Some ([seq g.1 | g <- gs], dsum [seq g.2 | g <- gs])
        else None
      else None
  | EigenPoint j t v =>
      if (j < m)%N && (if kind is MaxEigenvalue then true else false) then
        if gradient_at j (EigenTouch t v) is Some g then Some (mkseq (fun i => if i == j then g.1 else [::]) m, g.2)
        else None
      else None
  end.
Definition target_scores (j : nat) (g : dmat * dyadic) : target_bound :=
  (j, ([seq mdot d g.1 (nth [::] row j) | row <- infos], g.2)).
(** What a base set is worth, and what each other element gains beside it alone. [told]: by element and target, [::] for
    nothing. *)
Definition base_bound (told : seq (seq dmat)) (j : nat) (base : seq nat) : target_bound :=
  let es := iota 0 (size infos) in
  let row e := nth [::] (nth [::] told e) j in
  let K := foldl (fun K e => if nilp (row e) then K else madd d K (row e)) (nth [::] highs j) [seq e <- es | e \in base] in
  let D := mdet d K in
  let wj := nth d0 ws j in
  let gain e :=
    if (e \in base) || nilp (row e) then d0
    else dmul wj (log_quotient_up 110 400 (mdet d (madd d K (row e))) D) in
  (j, ([seq gain e | e <- es], dmul wj (log_quotient_up 110 400 (dmul (mdet d (nth [::] ps j)) D) d1))).
(** The tangents of single targets. *)
Definition tangent_bounds (told : seq (seq dmat)) (ts : seq (nat * touch)) : option (seq target_bound) :=
  all_some [seq (if (t.1 < m)%N then
      match t.2, kind with
      | BaseTouch base, LogDet => Some (base_bound told t.1 base)
      | BaseTouch _, _ => None
      | _, _ => if gradient_at t.1 t.2 is Some g then Some (target_scores t.1 g) else None
      end
    else None) | t <- ts].
(** A row has one inequality of each target; none is worth less than the largest eigenvalue. *)
Definition row_ok (bounds : seq target_bound) (ks : seq nat) : bool :=
  all (fun k => (k < size bounds)%N) ks &&
  let js := [seq (inequality_of bounds k).1 | k <- ks] in
  if kind is MaxEigenvalue then (if js is [:: j] then (j < m)%N else false) else js == iota 0 m.
Definition point_scores (g : seq dmat * dyadic) : tangent := ([seq dots g.1 row | row <- infos], g.2).
Definition masked (owner group : seq nat) (s : seq dyadic) : seq dyadic :=
  [seq if x.1 \in group then x.2 else d0 | x <- zip owner s].
Definition cut_bounds (owner : seq nat) (groups : seq (seq (seq nat))) (pts : seq tangent)
    (cs : seq (nat * nat * nat)) : seq cut_bound :=
  [seq let: (a, g, k) := c in let q := nth ([::], d0) pts k in
       CutBound a g q.2 (masked owner (nth [::] (nth [::] groups a) g) q.1) | c <- cs].
Definition row_bounds (w : network) (groups : seq (seq (seq nat))) (bounds : seq target_bound)
    (rs : seq (nat * nat * seq nat)) : seq cut_bound :=
  [seq let: (a, g, ks) := r in let q := row_sum w bounds ks in
       CutBound a g q.2 (masked (owners w) (nth [::] (nth [::] groups a) g) q.1) | r <- rs].
Definition rows_in_range (groups : seq (seq (seq nat))) (bounds : seq target_bound) (rs : seq (nat * nat * seq nat)) : bool :=
  all (fun r => let: (a, g, ks) := r in
    [&& (a < size groups)%N, (g < size (nth [::] groups a))%N & row_ok bounds ks]) rs.
Definition cuts_in_range (groups : seq (seq (seq nat))) (n : nat) (cs : seq (nat * nat * nat)) : bool :=
  all (fun c => let: (a, g, k) := c in
    [&& (a < size groups)%N, (g < size (nth [::] groups a))%N & (k < n)%N]) cs.
Definition cover_bounds (w : network) (groups : seq (seq (seq nat))) (pts : seq tangent) (cs : seq listed_cover) :
    seq cover_bound :=
  [seq let: (a, elements, ks) := c in let out := [seq e \in elements | e <- iota 0 (size (owners w))] in
       CoverBound out (cover_levels w out (nth [::] groups a) [seq nth ([::], d0) pts k | k <- ks]) | c <- cs].
Definition covers_in_range (attacks : seq listed_attack) (groups : seq (seq (seq nat))) (n : nat)
    (cs : seq listed_cover) : bool :=
  all (fun c => let: (a, _, ks) := c in
    [&& (a < size attacks)%N, nilp (nth ([::], [::]) attacks a).1, size ks == size (nth [::] groups a)
      & all (fun k => k < n)%N ks]) cs.
End Cuts.

(** ** What stands for several elements of a robot, where gains bound the upper end *)
Section Gains.
Variables (d m : nat) (owner : seq nat) (infos : seq (seq dmat)) (defects : seq (seq dyadic)).

(** So much more in every direction; [::] for nothing at all. *)
Definition telling (A : dmat) (x : dyadic) : dmat :=
  let B := if is_zero x then A else madd d A (mscalar d x) in if all (all is_zero) B then [::] else B.
Definition told : seq (seq dmat) := [seq [seq telling x.1 x.2 | x <- zip r.1 r.2] | r <- zip infos defects].

(** As [defect], but soon done where nothing small is enough. *)
Definition lacking (A : dmat) : option dyadic :=
  if is_psd d A then Some d0
  else if defect_ok d A (dmul (enough_of d A) (dtiny 28)) then defect d A else None.
Fixpoint each_some (T U : Type) (f : T -> option U) (s : seq T) : option (seq U) :=
  if s is x :: s' then
    if f x is Some y then (if each_some f s' is Some r then Some (y :: r) else None) else None
  else Some [::].
(** What each element lacks beside each other one of its robot, by target. *)
Definition lacks_of : seq (seq (option (seq dyadic))) :=
  let rows := zip owner infos in
  [seq [seq if x.1 == y.1 then each_some (fun z => lacking (msub d z.1 z.2)) (zip x.2 y.2) else None | y <- rows]
  | x <- rows].
Definition traces_of : seq dyadic := [seq dsum [seq mtrace d A | A <- row] | row <- infos].

(** The element that tells most, with what it lacks, if that is little. *)
Definition strongest (traces : seq dyadic) (lacks : seq (seq (option (seq dyadic)))) (es : seq nat) : option (seq dmat) :=
  let b := foldl (fun b e => if dlt (nth d0 traces b) (nth d0 traces e) then e else b) (head 0%N es) (behead es) in
  if each_some (fun e => nth None (nth [::] lacks b) e) es is Some ls then
    let more j := foldl (fun x l => dmax x (nth d0 l j)) (nth d0 (nth [::] defects b) j) ls in
    if nilp es then None else Some (mkseq (fun j => telling (nth [::] (nth [::] infos b) j) (more j)) m)
  else None.
End Gains.

(** ** All of it *)
Section Check.
Variables (pb : problem) (cl : claim) (pr : proofs).
Let d := dimension pb.
Let m := size (priors pb).
Let w := net pb.
Let ws := weights pb.
Definition prior_matrices : seq dmat := [seq unpack (dimension pb) x | x <- priors pb].
Definition info_matrices : seq (seq dmat) := [seq [seq unpack (dimension pb) x | x <- row] | row <- informations pb].

Definition shapes_ok : bool :=
  let k := ((d * d.+1)./2)%N in
  [&& (0 < d)%N, (0 < m)%N, all (fun x => size x == k) (priors pb), size ws == m, all (fun x => dlt d0 x) ws,
      size (informations pb) == size (owners w), outputs_ok d (outputs pb) m,
      (if objective pb is LogDet then ~~ isSome (outputs pb) else true)
    & all (fun row => (size row == m) && all (fun x => size x == k) row) (informations pb)].
Definition plan_ok : bool :=
  [&& size (plan cl) == robots w, all (fun e => e < size (owners w))%N (plan cl)
    & all (fun i => nth 0%N (owners w) (nth 0%N (plan cl) i) == i) (iota 0 (robots w))].
Definition priors_ok : bool := all (is_pd d) prior_matrices.

(** Largest defects of the elements of each robot, summed: no plan has more. *)
Definition worst_defect (defects : seq (seq dyadic)) (j : nat) : dyadic :=
  dsum [seq largest_of (fun e => nth d0 (nth [::] defects e) j) (nth [::] (all_plans w) i) | i <- iota 0 (robots w)].
Definition room_ok (lows : seq dmat) (defects : seq (seq dyadic)) : bool :=
  all (fun j => is_pd d (msub d (nth [::] lows j)
    (mscalar d (dmul (dnat (robots w).+1) (worst_defect defects j))))) (iota 0 m).
(** The covariances of what counts, at first. *)
Definition prior_range_ok : bool :=
  let rows := output_rows d (outputs pb) in
  let covariances := mkseq (fun j => covariance d (outputs pb) j (nth [::] prior_matrices j)) m in
  match objective pb with
  | Trace | LogDet => true
  | MaxEigenvalue =>
      all (fun j => let q := rows j in
          is_psd q (msub q (mscalar q (prior_high pr)) (mscale q (nth d0 ws j) (nth [::] covariances j)))) (iota 0 m)
      && has (fun j => let q := rows j in
          ~~ is_pd q (msub q (mscalar q (prior_low pr)) (mscale q (nth d0 ws j) (nth [::] covariances j)))) (iota 0 m)
  end.
Definition output_squares : seq (option dmat) := squares (dimension pb) (outputs pb).
Definition trace_total : dyadic :=
  let Ss := output_squares in
  dsum [seq dmul (nth d0 ws j) (trace_with d (nth None Ss j) (nth [::] prior_matrices j)) | j <- iota 0 m].
Definition logdet_total_low : dyadic :=
  dopp (dsum [seq dmul (nth d0 ws j) (log_quotient_up 110 400 d1 (mdet d (nth [::] prior_matrices j))) | j <- iota 0 m]).
Definition base_low : dyadic :=
  match objective pb with Trace => trace_total | LogDet => logdet_total_low | MaxEigenvalue => prior_low pr end.

Definition check_lower_part (lows : seq dmat) (defects : seq (seq dyadic)) : bool :=
  let rows := [seq nth [::] info_matrices e | e <- plan cl] in
  let room := dsub base_low (lower cl) in
  let loss j := dsum [seq nth d0 (nth [::] defects e) j | e <- plan cl] in
  let start := mkseq (fun j => msub d (nth [::] lows j) (mscalar d (loss j))) m in
  let add := add_robot d m rows in
  let groups := weight_groups ws in
  let Ss := output_squares in
  let good := worth (objective pb) d m ws Ss groups lows (lower cl) room in
  let average := average_worth (objective pb) d m ws Ss groups lows rows (lower cl) room in
  match lower_part pr with
  | ForcedSize k t => [&& complete w, is_forced w k & check_sizes w add good average k t start [::] 0]
  | AttackTree t =>
      let near := [seq neighbours (link_list w) i | i <- iota 0 (robots w)] in
      check_attacks w near start add good t [::] [::] [::]
  | ForcedSets l => [&& complete w, is_forced w (set_size l) & check_sets w start add good average l]
  | Duals l t =>
      let near := rows_of w (link_list w) in let tied := rows_of w (kept_links w) in
      check_sets w start add good average l && check_duals w start add good average (set_size l) near tied t
  | Cover l t nodes =>
      let near := rows_of w (link_list w) in let tied := rows_of w (kept_links w) in
      check_sets w start add good average l && check_cover w start add good average (set_size l) near tied t nodes
  | GroupSizes l t =>
      let near := rows_of w (link_list w) in let tied := rows_of w (kept_links w) in
      check_sets w start add good average l && check_group_sizes w start add good average near tied (set_size l) t
  | NoLower => false
  end.

Definition gains_leaf (highs : seq dmat) (defects : seq (seq dyadic)) (groups : seq (seq (seq nat))) :
    nat -> seq (seq nat) -> bool :=
  let infos := info_matrices in
  let by_weight := weight_groups ws in
  let dets := [seq mdet d P | P <- prior_matrices] in
  let all_told := told d infos defects in
  let traces := traces_of d infos in
  let lacks := lacks_of d (owners w) infos in
  let room := if by_weight is [:: x] then product_room x.1 (upper cl) else d1 in
  fun a left =>
    let sts := [seq strongest d m infos defects traces lacks es | es <- left] in
    all (fun g => check_group_gains d m by_weight dets highs all_told (upper cl) room left sts
      [seq i <- iota 0 (robots w) | i \in g]) (nth [::] groups a).
Definition gains_are_used : bool := if objective pb is LogDet then has_gains (upper_part pr) else false.

(** ** Values that plans can have *)
Definition seen (j e : nat) : bool := ~~ all (all is_zero) (nth [::] (nth [::] info_matrices e) j).
(** What a target is worth to all that hold an element, at least. *)
Definition worth_alone (lows : seq dmat) (defects : seq (seq dyadic)) (j e : nat) : option dyadic :=
  let S := nth None output_squares j in
  let lost := mscalar d (dmul (dnat (robots w).+1) (worst_defect defects j)) in
  let L := madd d (msub d (nth [::] lows j) lost) (nth [::] (nth [::] info_matrices e) j) in
  if trace_inverse_up 256 d S L is Some y then
    Some (dmul (nth d0 ws j) (dsub (trace_with d S (nth [::] prior_matrices j)) y))
  else None.
Definition lemma_at (k : nat) : listed_lemma := nth (ListedLemma 0 [::] d0 (LemmaLeaf 0)) (lemma_list (rows_part pr)) k.
Definition bounds_seen (ks : seq nat) (j : nat) : bool :=
  has (fun k => [&& (k < size (lemma_list (rows_part pr)))%N, lemma_target (lemma_at k) == j & all is_zero (lemma_scores (lemma_at k))]) ks.
(** What sees [n] targets is worth [n * least] at least, and [n * most] at most. Values that are below [count + 1] times
    the former are at most [count] times the latter: plans need only be worth at most this. *)
Definition enough_shown (lows : seq dmat) (defects : seq (seq dyadic)) : option dyadic :=
  match spacing (rows_part pr), objective pb with
  | None, _ => Some (upper cl)
  | Some (count, ks), Trace =>
      let es := iota 0 (size (owners w)) in
      let pairs := flatten [seq [seq (j, e) | e <- es & seen j e] | j <- iota 0 m] in
      if all_some [seq worth_alone lows defects x.1 x.2 | x <- pairs] is Some ys then
        let least := dopp (largest_of (fun i => dopp (nth d0 ys i)) (iota 0 (size ys))) in
        let most := dmax d0 (largest_of (fun k => lemma_constant (lemma_at k)) ks) in
        if dle d0 least && all (fun j => has (seen j) es ==> bounds_seen ks j) (iota 0 m) then
          Some (if dle (dmul (dnat count) most) (upper cl) then
            dmax (upper cl) (dsub (dmul (dnat count.+1) least) (dtiny 200)) else upper cl)
        else None
      else None
  | _, _ => None
  end.

Definition check_upper_part (lows highs : seq dmat) (defects : seq (seq dyadic)) : bool :=
  let groups := [seq seeing_groups w a | a <- listed pr] in
  let Ss := output_squares in let ps := prior_matrices in let infos := info_matrices in
  let grads := [seq gradient (objective pb) d m ws (outputs pb) Ss ps highs (prior_high pr) pt | pt <- points pr] in
  let rows := rows_part pr in
  match all_some grads, tangent_bounds (objective pb) d m ws (outputs pb) Ss ps highs infos (prior_high pr)
          (if objective pb is LogDet then told d infos defects else [::]) (tangent_list rows),
        enough_shown lows defects with
  | Some gs, Some tangents, Some top =>
    let pts := [seq point_scores d infos g | g <- gs] in
    let bounds := tangents ++ [seq lemma_bound l | l <- lemma_list rows] in
    let cuts := cut_bounds (owners w) groups pts (cut_list pr) ++ row_bounds w groups bounds (row_list rows) in
    let covers := cover_bounds w groups pts (cover_list pr) in
    let gains := if gains_are_used then gains_leaf highs defects groups else (fun _ _ => false) in
    [&& all (attack_ok w) (listed pr), cuts_in_range groups (size gs) (cut_list pr),
        covers_in_range (listed pr) groups (size gs) (cover_list pr), dle d0 (upper cl),
        all (fun l => (lemma_target l < m)%N && check_lemma w tangents l) (lemma_list rows),
        rows_in_range (objective pb) m groups bounds (row_list rows)
      & check_upper w groups cuts covers top gains (upper_part pr) (all_plans w) [::]]
  | _, _, _ => false
  end.

(** What the checker found out. *)
Inductive verdict := Refused | UpperOnly | Proved.

Definition has_lower : bool := if lower_part pr is NoLower then false else true.

Definition check : verdict :=
  if [&& network_ok w, shapes_ok, plan_ok, priors_ok, prior_range_ok & dle (lower cl) (upper cl)] then
    match all_some [seq inverse_low d P | P <- prior_matrices], all_some [seq inverse_high d P | P <- prior_matrices],
          all_some [seq all_some [seq defect d A | A <- row] | row <- info_matrices] with
    | Some lows, Some highs, Some defects =>
        if room_ok lows defects && check_upper_part lows highs defects then
          if has_lower then (if check_lower_part lows defects then Proved else Refused) else UpperOnly
        else Refused
    | _, _, _ => Refused
    end
  else Refused.
End Check.
