(** The definitions at work on small instances: each value is computed here by proof, and recomputed with the Python
    library from the same data by tests/formal/test_definitions.py, which reads them in this file. *)
From Coq Require Import ZArith.
From mathcomp Require Import all_ssreflect all_algebra.
From Ratt Require Import Extrema Teams Quadratic Criteria Dyadic Graph UpperTree LowerTree Checker Soundness Certificate.
Set Implicit Arguments.
Unset Strict Implicit.
Unset Printing Implicit Defensive.
Import Order.Theory GRing.Theory Num.Theory.

Definition whole (k : nat) : dyadic := dnat k.

Local Open Scope nat_scope.

(** One target with one coordinate, prior 1 and weight 1; elements with the given information. *)
Definition line_problem (infos : seq nat) (w : network) : problem :=
  Problem Trace 1 [:: [:: whole 1]] [:: whole 1] None [seq [:: [:: whole k]] | k <- infos] w.

(** One linear bound at the posterior 1/8 on the first group of one attack. *)
Definition one_leaf (a : listed_attack) (t : attack_tree) : proofs :=
  Proofs d0 d0 [:: a] [:: TracePoint [:: [:: Dyadic 1 3]]] [:: (0, 0, 0)%N] [::] (Leaf [:: (0%N, whole 1)]) (AttackTree t) no_rows.

(** ** A blinded robot relays: robots in a line, one of them blinded, no link cut. *)
Definition relay_infos : seq nat := [:: 4; 1; 3; 4].
Definition relay_net : network := Network 2 [:: 0; 1; 1; 2] [:: (0, 1); (1, 2)] 1 0 [::] [::].
Definition relay_plan : seq nat := [:: 0; 2; 3].
Definition relay_value : dyadic := Dyadic 7 3.
Definition relay_attack : listed_attack := ([:: 1], [::]).
Definition relay_group : seq nat := [:: 0; 1; 2].
Definition relay_sees : seq nat := [:: 0; 2].

(** ** Protected robots and links: a triangle, one robot blinded, two links cut. *)
Definition safe_infos : seq nat := [:: 4; 1; 3; 1].
Definition safe_net : network := Network 2 [:: 0; 1; 1; 2] [:: (0, 1); (0, 2); (1, 2)] 1 2 [:: 0; 1] [:: (0, 1)].
Definition safe_plan : seq nat := [:: 0; 2; 3].
Definition safe_value : dyadic := Dyadic 7 3.
Definition safe_attack : listed_attack := ([:: 2], [:: (0, 2); (1, 2)]).
Definition safe_group : seq nat := [:: 0; 1].
Definition safe_sees : seq nat := [:: 0; 1].

(** ** Two groups: a line of four robots, one link cut. *)
Definition split_infos : seq nat := [:: 3; 1; 4; 4; 3].
Definition split_net : network := Network 3 [:: 0; 0; 1; 2; 3] [:: (0, 1); (1, 2); (2, 3)] 0 1 [::] [::].
Definition split_plan : seq nat := [:: 0; 2; 3; 4].
Definition split_value : dyadic := Dyadic 7 3.
Definition split_attack : listed_attack := ([::], [:: (1, 2)]).
Definition split_group : seq nat := [:: 0; 1].
Definition split_sees : seq nat := [:: 0; 1].

(** ** A part of the state counts: two coordinates of the state [x] with prior [I], and [x1 + 2 x2] and [x2] of it. *)
Definition part_output : seq nat := [:: 1; 2; 0; 1].
Definition part_infos : seq (seq nat) := [:: [:: 3; 0; 1]; [:: 1; 0; 0]; [:: 3; 0; 1]].
Definition part_net : network := Network 1 [:: 0; 0; 1] [:: (0, 1)] 1 0 [::] [::].
Definition part_plan : seq nat := [:: 0; 2].
Definition part_value : dyadic := Dyadic 13 2.
Definition part_problem : problem :=
  Problem Trace 2 [:: [:: whole 1; whole 0; whole 1]] [:: whole 1] (Some [:: map whole part_output])
    [seq [:: map whole info] | info <- part_infos] part_net.

Section Values.
Local Open Scope ring_scope.
Variable F : realFieldType.

Section One.
Variables (pb : problem) (chosen : seq nat) (v : dyadic) (pr : proofs).
Let w := net pb.
Let phi := trace_value (@prior_of F pb) (@info_of F pb) (@weight_of F pb) (@output_of F pb).
Let cl := Claim chosen v v.

(** Where the checker accepts equal ends, they are the plan's worst case and the optimum. *)
Lemma exact_values : objective pb = Trace -> check pb cl pr = Proved ->
  [/\ is_plan (team_of w) (plan_of pb cl), worst_case (team_of w) phi (plan_of pb cl) = val F v
    & is_optimum (team_of w) phi (val F v)].
Proof.
move=> kind h; have [_ up pl lo] := @trace_certificate_sound F pb cl pr kind h.
have best p : is_plan (team_of w) p -> worst_case (team_of w) phi p <= val F v.
  by move=> okp; apply/worst_case_leP; apply: up.
have eq : worst_case (team_of w) phi (plan_of pb cl) = val F v.
  by apply: le_anti; rewrite best //= le_worst_case.
by split=> //; split=> //; exists (plan_of pb cl).
Qed.
End One.

(** Groups and who sees in them, computed. *)
Lemma exact_group w a (i : 'I_(top_robot w).+1) g s : network_ok w -> attack_ok w a ->
  [seq j <- iota 0 (robots w) | j \in reach (fun k => nth [::] (left_near w a) k) (robots w) [::] i] = g ->
  [seq j <- g | j \notin a.1] = s ->
  [/\ allowed (team_of w) (attack_of w a), group (team_of w) (attack_of w a) i = set_of w g
    & sees (team_of w) (attack_of w a) i = set_of w s].
Proof.
move=> ok oka eg es; have grp : group (team_of w) (attack_of w a) i = set_of w g.
  by apply/setP => j; rewrite /group /set_of !in_set -(mem_reach ok i j oka) -eg mem_filter mem_iota add0n ltn_ord leq0n !andbT.
split=> //; first exact: attack_of_allowed.
by rewrite /sees grp; apply/setP => j; rewrite in_setD /blinded /attack_of /set_of /= !in_set -es mem_filter.
Qed.

Theorem relay_exact : let pb := line_problem relay_infos relay_net in let cl := Claim relay_plan relay_value relay_value in
  let phi := trace_value (@prior_of F pb) (@info_of F pb) (@weight_of F pb) (@output_of F pb) in
  [/\ is_plan (team_of relay_net) (plan_of pb cl),
      worst_case (team_of relay_net) phi (plan_of pb cl) = val F relay_value
    & is_optimum (team_of relay_net) phi (val F relay_value)].
Proof.
apply: (@exact_values (line_problem _ _) _ _ (one_leaf ([:: 0%N], [::])
  (Group 0 [:: Group 1 [:: Group 2 [:: Blinded 0
      (Blinded 1 Beyond (Blinded 2 Beyond (Worth 0)))
      (Blinded 1 (Blinded 2 Beyond (Worth 0)) (Worth 0)); Beyond]; Beyond]])) erefl).
by vm_compute.
Qed.

Theorem relay_groups : [/\ allowed (team_of relay_net) (attack_of relay_net relay_attack),
    group (team_of relay_net) (attack_of relay_net relay_attack) ord0 = set_of relay_net relay_group
  & sees (team_of relay_net) (attack_of relay_net relay_attack) ord0 = set_of relay_net relay_sees].
Proof. by apply: exact_group; vm_compute. Qed.

Theorem safe_exact : let pb := line_problem safe_infos safe_net in let cl := Claim safe_plan safe_value safe_value in
  let phi := trace_value (@prior_of F pb) (@info_of F pb) (@weight_of F pb) (@output_of F pb) in
  [/\ is_plan (team_of safe_net) (plan_of pb cl),
      worst_case (team_of safe_net) phi (plan_of pb cl) = val F safe_value
    & is_optimum (team_of safe_net) phi (val F safe_value)].
Proof.
apply: (@exact_values (line_problem _ _) _ _ (one_leaf ([:: 2%N], [::])
  (Group 0 [:: Group 1 [:: Blinded 0 Beyond (Blinded 1 Beyond (Worth 0)); Beyond]])) erefl).
by vm_compute.
Qed.

Theorem safe_groups : [/\ allowed (team_of safe_net) (attack_of safe_net safe_attack),
    group (team_of safe_net) (attack_of safe_net safe_attack) ord0 = set_of safe_net safe_group
  & sees (team_of safe_net) (attack_of safe_net safe_attack) ord0 = set_of safe_net safe_sees].
Proof. by apply: exact_group; vm_compute. Qed.

Theorem split_exact : let pb := line_problem split_infos split_net in let cl := Claim split_plan split_value split_value in
  let phi := trace_value (@prior_of F pb) (@info_of F pb) (@weight_of F pb) (@output_of F pb) in
  [/\ is_plan (team_of split_net) (plan_of pb cl),
      worst_case (team_of split_net) phi (plan_of pb cl) = val F split_value
    & is_optimum (team_of split_net) phi (val F split_value)].
Proof.
pose cuts := [:: (0, 0, 0)%N; (0, 1, 0)%N].
apply: (@exact_values (line_problem _ _) _ _ (Proofs d0 d0 [:: ([::], [:: (1, 2)%N])] [:: TracePoint [:: [:: Dyadic 1 3]]] cuts [::]
  (OnWinner 0 [:: Leaf [:: (0%N, whole 1)]; Leaf [:: (1%N, whole 1)]])
  (AttackTree (Blinded 0 Beyond (Blinded 1 Beyond (Blinded 2 Beyond (Blinded 3 Beyond
    (Group 0 [:: Group 1 [:: Worth 0; Group 2 [:: Beyond; Group 3 [:: Beyond; Worth 1; Beyond]; Beyond]]])))))) no_rows) erefl).
by vm_compute.
Qed.

Theorem split_groups : [/\ allowed (team_of split_net) (attack_of split_net split_attack),
    group (team_of split_net) (attack_of split_net split_attack) ord0 = set_of split_net split_group
  & sees (team_of split_net) (attack_of split_net split_attack) ord0 = set_of split_net split_sees].
Proof. by apply: exact_group; vm_compute. Qed.

(** One linear bound at the posterior's inverse [diag(1/4, 1/2)] times [C'], on the group that robot 0 leaves if blinded. *)
Theorem part_exact : let pb := part_problem in let cl := Claim part_plan part_value part_value in
  let phi := trace_value (@prior_of F pb) (@info_of F pb) (@weight_of F pb) (@output_of F pb) in
  [/\ is_plan (team_of part_net) (plan_of pb cl),
      worst_case (team_of part_net) phi (plan_of pb cl) = val F part_value
    & is_optimum (team_of part_net) phi (val F part_value)].
Proof.
apply: (@exact_values part_problem _ _ (Proofs d0 d0 [:: ([:: 0%N], [::])]
  [:: TracePoint [:: [:: Dyadic 1 2; whole 0; whole 1; Dyadic 1 1]]] [:: (0, 0, 0)%N] [::] (Leaf [:: (0%N, whole 1)])
  (AttackTree (Group 0 [:: Group 1 [:: Blinded 0 (Blinded 1 Beyond (Worth 0)) (Worth 0); Beyond]])) no_rows) erefl).
by vm_compute.
Qed.
End Values.

(** ** What is not allowed: over budget, a protected robot, a protected link *)
Lemma not_allowed_relay : ~~ allowed (team_of relay_net) (attack_of relay_net ([:: 0; 1], [::])).
Proof.
apply/negP => /and5P[h _ _ _ _]; move: h; rewrite leqNgt => /negP; apply.
have -> : blinded (attack_of relay_net ([:: 0; 1], [::])) = [set robot_of relay_net 0; robot_of relay_net 1].
  by apply/setP => i; rewrite !inE -!val_eqE /= !inordK.
by rewrite cards2 -val_eqE /= !inordK.
Qed.

Lemma not_allowed_safe_robot : ~~ allowed (team_of safe_net) (attack_of safe_net ([:: 1], [::])).
Proof.
apply/negP => /and5P[_ _ _ h _]; have := disjointFr h (_ : robot_of safe_net 1 \in _).
by rewrite !inE !robot_ofK // => /(_ isT).
Qed.

Lemma not_allowed_safe_link : ~~ allowed (team_of safe_net) (attack_of safe_net ([::], [:: (0, 1)])).
Proof.
apply/negP => /and5P[_ _ _ _ h].
have c1 : link_of safe_net (0, 1) \in cut (attack_of safe_net ([::], [:: (0, 1)])).
  by rewrite /cut /attack_of /links_of /= in_set mem_seq1.
by have := disjointFr h c1; rewrite /team_of /links_of /= in_set mem_seq1 eqxx.
Qed.

(** The hypothesis about the largest eigenvalue can be met: with one coordinate it is the entry, over any ordered field. *)
Lemma largest_eigenvalue_one (F : realFieldType) : largest_eigenvalue (fun A : 'M[F]_1 => A 0%R 0%R).
Proof.
move=> A _ x; have f v : form (x%:M - A)%R v v = ((x - A 0 0) * v 0 0 ^+ 2)%R.
  rewrite formBm form_scalar mulrBl; congr (_ - _)%R; first by rewrite dot_sum big_ord1.
  by rewrite /form mxE big_ord1 mxE big_ord1 mxE expr2 mulrCA mulrA.
split=> [le v|h]; first by rewrite f mulr_ge0 ?subr_ge0 ?sqr_ge0.
by have := h (const_mx 1%R); rewrite f mxE expr1n mulr1 subr_ge0.
Qed.

(** So it can where one row of each target's state counts, whatever its dimension: a matrix of one entry is its trace. *)
Lemma largest_eigenvalues_one (F : realFieldType) (pb : problem) : (forall j, counted_rows (pb := pb) j = 1%N) ->
  largest_eigenvalues pb (fun n (A : 'M[F]_n) => \tr A)%R.
Proof.
move=> one j; rewrite one => A sA x; have := largest_eigenvalue_one sA x.
by rewrite /mxtrace big_ord1.
Qed.
