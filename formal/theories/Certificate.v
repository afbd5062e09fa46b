(** The theorem about [ratt-check], in the words of the definitions. *)
From mathcomp Require Import all_ssreflect all_algebra.
From Ratt Require Import Extrema Teams Quadratic Criteria Logdet Dyadic DyadicMatrix Outputs Graph UpperTree LowerTree CaseTree Costs GroupProofs Forced Checker Soundness.
Set Implicit Arguments.
Unset Strict Implicit.
Unset Printing Implicit Defensive.
Import Order.Theory GRing.Theory Num.Theory.
Local Open Scope ring_scope.

(** Without outputs all of each state counts. *)
Lemma output_of_whole (F : realFieldType) kind d priors weights infos w j :
  @output_of F (Problem kind d priors weights None infos w) j = 1%:M :> 'M[F]_d.
Proof.
by apply/matrixP => i k; rewrite !mxE -val_eqE /=; case: eqP => _; rewrite ?val1 ?val0.
Qed.

(** [lmax] is the largest eigenvalue of matrices of as many rows as count of a target: all of its state, or its output. *)
Definition largest_eigenvalues (F : realFieldType) (pb : problem) (lmax : forall n, 'M[F]_n -> F) : Prop :=
  forall j, largest_eigenvalue (@lmax (@counted_rows pb j)).

Section Certificate.
(** Any ordered field that has what the numbers need; for the largest-eigenvalue criterion any function that is the
    largest eigenvalue there, for log-det any logarithm. *)
Variables (F : realFieldType) (pb : problem) (cl : claim) (pr : proofs).
Variables (lmax : forall n, 'M[F]_n -> F) (ln : F -> F).
Hypothesis lmaxP : objective pb = MaxEigenvalue -> largest_eigenvalues pb lmax.
Hypothesis lnP : objective pb = LogDet -> logarithm ln.

Local Notation team := (team_of (net pb)).
Local Notation phi := (@value F pb lmax ln).
Local Notation given := (plan_of pb cl).

(** No plan keeps more than [upper] under every attack. *)
Definition upper_claim : Prop := forall p, is_plan team p ->
  exists2 a, allowed team a & team_value team phi p a <= val F (upper cl).
(** The given plan is one, and keeps at least [lower] under every attack. *)
Definition lower_claim : Prop := is_plan team given /\
  forall a, allowed team a -> val F (lower cl) <= team_value team phi given a.
(** The numbers name existing robots, elements and links, so that [team_of] and [plan_of] read them faithfully. *)
Definition well_formed : Prop := [/\ network_ok (net pb), shapes_ok pb & plan_ok pb cl].

Lemma check_parts : check pb cl pr <> Refused -> well_formed /\ upper_claim /\ (check pb cl pr = Proved -> lower_claim).
Proof.
rewrite /check; case: ifP => [/and5P[net_good shapes plan_good priors_good /andP[range le]]|//].
case el: (all_some _) => [lows|//]; case eh: (all_some _) => [highs|//]; case ed: (all_some _) => [defects|//].
case: ifP => // /andP[room up] _; split; first by split.
split=> [p okp|].
  by apply/(worst_case_leP team phi p); apply: (upper_sound lmaxP lnP net_good shapes priors_good range el eh ed room up okp).
case: ifP => // _; case: ifP => // lo _; split; first exact: (plan_ofP net_good plan_good).
by apply: (lower_sound lmaxP lnP net_good shapes plan_good priors_good range el ed room lo).
Qed.
End Certificate.

Theorem certificate_upper (F : realFieldType) pb cl pr (lmax : forall n, 'M[F]_n -> F) (ln : F -> F) :
  (objective pb = MaxEigenvalue -> largest_eigenvalues pb lmax) -> (objective pb = LogDet -> logarithm ln) ->
  check pb cl pr = UpperOnly -> well_formed pb cl /\ upper_claim pb cl lmax ln.
Proof. by move=> h1 h2 e; have [|wf [up _]] := @check_parts F pb cl pr lmax ln h1 h2; rewrite ?e. Qed.

Theorem certificate_sound (F : realFieldType) pb cl pr (lmax : forall n, 'M[F]_n -> F) (ln : F -> F) :
  (objective pb = MaxEigenvalue -> largest_eigenvalues pb lmax) -> (objective pb = LogDet -> logarithm ln) ->
  check pb cl pr = Proved -> [/\ well_formed pb cl, upper_claim pb cl lmax ln & lower_claim pb cl lmax ln].
Proof.
move=> h1 h2 e; have [|wf [up lo]] := @check_parts F pb cl pr lmax ln h1 h2; rewrite ?e //.
by split=> //; apply: lo.
Qed.

(** The trace criterion needs no eigenvalue and no logarithm: over any ordered field, the rationals for one. *)
Theorem trace_certificate_sound (F : realFieldType) pb cl pr : objective pb = Trace -> check pb cl pr = Proved ->
  let phi := trace_value (@prior_of F pb) (@info_of F pb) (@weight_of F pb) (@output_of F pb) in let t := team_of (net pb) in
  [/\ well_formed pb cl,
      forall p, is_plan t p -> exists2 a, allowed t a & team_value t phi p a <= val F (upper cl),
      is_plan t (plan_of pb cl)
    & forall a, allowed t a -> val F (lower cl) <= team_value t phi (plan_of pb cl) a].
Proof.
move=> e h phi t; have [||wf up [pl lo]] := @certificate_sound F pb cl pr (fun _ _ => 0) (fun _ => 0) _ _ h; rewrite ?e //.
have eq : value (pb := pb) (fun n (_ : 'M[F]_n) => 0) (fun _ => 0) = phi by rewrite /value e.
by rewrite /upper_claim /lower_claim eq in up lo.
Qed.

(** The same in full for log-det. *)
Theorem logdet_certificate_sound (F : realFieldType) pb cl pr (ln : F -> F) : logarithm ln -> objective pb = LogDet ->
  check pb cl pr = Proved ->
  let phi := logdet_value ln (@prior_of F pb) (@info_of F pb) (@weight_of F pb) in let t := team_of (net pb) in
  [/\ well_formed pb cl,
      forall p, is_plan t p -> exists2 a, allowed t a & team_value t phi p a <= val F (upper cl),
      is_plan t (plan_of pb cl)
    & forall a, allowed t a -> val F (lower cl) <= team_value t phi (plan_of pb cl) a].
Proof.
move=> lnP e h phi t; have [||wf up [pl lo]] := @certificate_sound F pb cl pr (fun _ _ => 0) ln _ _ h; rewrite ?e //.
have eq : value (pb := pb) (fun n (_ : 'M[F]_n) => 0) ln = phi by rewrite /value e.
by rewrite /upper_claim /lower_claim eq in up lo.
Qed.

(** The optimum lies between the claimed ends. *)
Theorem certificate_bracket (F : realFieldType) pb cl pr (lmax : forall n, 'M[F]_n -> F) (ln : F -> F) x :
  (objective pb = MaxEigenvalue -> largest_eigenvalues pb lmax) -> (objective pb = LogDet -> logarithm ln) ->
  check pb cl pr = Proved -> is_optimum (team_of (net pb)) (@value F pb lmax ln) x -> val F (lower cl) <= x <= val F (upper cl).
Proof.
move=> h1 h2 h [[p okp <-] best]; have [wf up [pl lo]] := certificate_sound h1 h2 h.
apply/andP; split; last by apply/worst_case_leP; apply: up.
by apply: le_trans (best _ pl); apply: le_worst_case.
Qed.
