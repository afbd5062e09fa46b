(** The paper's number of baits: [alpha_s] plus as many robots as link attacks can keep from the largest group. *)
From mathcomp Require Import all_ssreflect all_algebra.
From Ratt Require Import Extrema Teams Guarantees Planner GroupSize.
Set Implicit Arguments.
Unset Strict Implicit.
Unset Printing Implicit Defensive.
Import Order.Theory GRing.Theory Num.Theory.
Local Open Scope ring_scope.

Section NMax.
Variables (R E : finType) (t : team R E).

(** Size of the largest group that a cut leaves, and the smallest such size over the allowed cuts. *)
Definition largest_group (C : {set {set R}}) : nat := \max_(i : R) #|group t (set0, C) i|.
Definition n_max : nat :=
  \big[minn/#|R|]_(C <- enum [finType of {set {set R}}] | allowed t (set0, C)) largest_group C.
(** The sensing attacks that the link attacks are worth. *)
Definition alpha_cs : nat := (#|R| - n_max)%N.

Lemma n_max_le C : allowed t (set0, C) -> (n_max <= largest_group C)%N.
Proof.
move=> ok; have : C \in enum [finType of {set {set R}}] by rewrite mem_enum.
rewrite /n_max; elim: (enum _) => [//|D s IH]; rewrite in_cons big_cons => /orP[/eqP <-|/IH le].
  by rewrite ok geq_minl.
by case: ifP => _ //; rewrite geq_min le orbT.
Qed.

Lemma le_n_max k : (k <= #|R|)%N -> (forall C, allowed t (set0, C) -> k <= largest_group C)%N -> (k <= n_max)%N.
Proof.
move=> kR h; rewrite /n_max; elim: (enum _) => [|D s IH]; first by rewrite big_nil.
by rewrite big_cons; case: ifP => ok //; rewrite leq_min h.
Qed.

(** Where link attacks are worth nothing, none of them splits the team. *)
Lemma unsplit_of : alpha_cs = 0%N -> forall a, allowed t a -> forall i j, connect (linked t a) i j.
Proof.
move=> z a /and5P[_ cb sub _ safe] i j.
have okC : allowed t (set0, cut a).
  by rewrite /allowed /= cards0 leq0n cb sub safe /= andbT disjoint_subset; apply/subsetP => x; rewrite in_set0.
have le : (#|R| <= largest_group (cut a))%N.
  by apply: leq_trans (n_max_le okC); rewrite -subn_eq0; apply/eqP.
have R0 : (0 < #|R|)%N by apply/card_gt0P; exists i.
have [i0 e] := eq_bigmax (fun i => #|group t (set0, cut a) i|) R0.
have all_in k : connect (linked t a) i0 k.
  have : k \in group t (set0, cut a) i0.
    suff -> : group t (set0, cut a) i0 = setT by rewrite inE.
    by apply/eqP; rewrite eqEcard subsetT cardsT -e.
  by rewrite inE.
by apply: connect_trans (all_in j); rewrite connect_linked_sym.
Qed.
End NMax.

(** RATT with the paper's number of baits. *)
Section PaperRatt.
Variables (F : realFieldType) (R E : finType) (t : team R E) (phi : {set E} -> F) (default : E) (g : nat) (robot0 : R).
Hypothesis every_robot_owns : forall i, exists x, owner t x = i.
Definition paper_ratt : {ffun R -> E} := ratt t phi default (alpha_s t + alpha_cs t).

Hypothesis robots : (alpha_s t < #|R|)%N.
Hypotheses (n0 : normalised phi) (mono : non_decreasing t phi).
Hypothesis reach : exists2 a, allowed t a &
  {subset strongest t phi default <= blinded a} /\ forall i, (#|sees t a i| <= g)%N.

Theorem paper_group_size_submodular k : 0 <= k <= 1 -> submodular t phi -> curvature_at_most t phi k ->
  optimum t phi <= (if alpha_cs t == 0%N then Num.max g%:R (1 + k) else g%:R) * worst_case t phi paper_ratt.
Proof.
move=> k01 sub curv; rewrite /paper_ratt; case: eqP => [z|/eqP nz].
  by rewrite z addn0; apply: group_size_submodular_unsplit => //; apply: unsplit_of.
by apply: group_size_submodular_any => //; rewrite -addn1 leq_add2l lt0n.
Qed.

Theorem paper_group_size_total_curvature c : 0 <= c <= 1 -> (0 < g)%N -> total_curvature_at_most t phi c ->
  (1 - c) * optimum t phi <=
  (if alpha_cs t == 0%N then Num.max (g.-1%:R + (1 - c)) 1 else g.-1%:R + (1 - c)) * worst_case t phi paper_ratt.
Proof.
move=> c01 g0 curv; rewrite /paper_ratt; case: eqP => [z|/eqP nz].
  by rewrite z addn0; apply: group_size_total_curvature_unsplit => //; apply: unsplit_of.
by have /andP[_ c1] := c01; apply: group_size_total_curvature_any => //; rewrite -addn1 leq_add2l lt0n.
Qed.

Theorem paper_optimal : g = 1%N -> alpha_cs t != 0%N -> worst_case t phi paper_ratt = optimum t phi.
Proof.
by move=> g1 nz; apply: (ratt_optimal_any robot0 every_robot_owns robots n0 mono reach) => //;
  rewrite -addn1 leq_add2l lt0n.
Qed.
End PaperRatt.
