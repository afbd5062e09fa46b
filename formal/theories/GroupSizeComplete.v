(** Group sizes on the complete graph without protected parts: which robots are blinded does not matter to how small
    the groups can be made, so the smallest achievable group size is the right one. *)
From mathcomp Require Import all_ssreflect all_algebra.
From Ratt Require Import Extrema Teams Guarantees Planner GroupSize.
Set Implicit Arguments.
Unset Strict Implicit.
Unset Printing Implicit Defensive.
Import Order.Theory GRing.Theory Num.Theory.
Local Open Scope ring_scope.

Section Relabel.
Variables (R E : finType) (t : team R E).
(** All links, and nothing protected. *)
Definition complete_graph : Prop := links t = [set l : {set R} | #|l| == 2%N].
Definition unprotected : Prop := safe_robots t = set0 /\ safe_links t = set0.

Hypotheses (full : complete_graph) (open : unprotected).
Variables (a : attack R) (order : seq R).
Hypotheses (oka : allowed t a) (order_all : perm_eq order (enum R)).

(** Robots renamed so that those blinded come first in the given order. *)
Let from := enum (blinded a) ++ enum (~: blinded a).
Definition rename (x : R) : R := nth x order (index x from).

Lemma mem_from x : x \in from.
Proof. by rewrite mem_cat !mem_enum inE orbN. Qed.
Lemma size_from : size from = #|R|.
Proof. by rewrite size_cat -!cardE cardsC. Qed.
Lemma size_given : size order = #|R|.
Proof. by rewrite (perm_size order_all) -cardE. Qed.
Lemma given_uniq : uniq order.
Proof. by rewrite (perm_uniq order_all) enum_uniq. Qed.

Lemma rename_inj : injective rename.
Proof.
move=> x y; rewrite /rename (set_nth_default x y) ?size_given -?size_from ?index_mem ?mem_from // => /eqP.
rewrite nth_uniq ?given_uniq ?size_given -?size_from ?index_mem ?mem_from // => /eqP e.
by rewrite -(nth_index x (mem_from x)) e nth_index ?mem_from.
Qed.

Lemma rename_blinded x : x \in blinded a -> rename x \in take #|blinded a| order.
Proof.
move=> xb; have : (index x from < #|blinded a|)%N by rewrite /from index_cat mem_enum xb cardE index_mem mem_enum.
move=> lt; rewrite /rename -(nth_take _ lt); apply: mem_nth.
by rewrite size_takel // size_given max_card.
Qed.

Definition top : {set R} := [set x | x \in take (alpha_s t) order].
Definition renamed : attack R := (top, [set rename @: l | l : {set R} in cut a]).

Lemma blinded_top x : x \in blinded a -> rename x \in top.
Proof.
move=> /rename_blinded h; rewrite inE; case/and5P: oka => le _ _ _ _.
by rewrite -(subnKC le) takeD mem_cat h.
Qed.

Lemma renamed_allowed : (alpha_s t <= #|R|)%N -> allowed t renamed.
Proof.
case: open => sr sl le; case/and5P: oka => _ cb sub _ _; apply/and5P; split.
- rewrite cardE /=; apply: leq_trans (_ : size (take (alpha_s t) order) <= _)%N.
    by apply: uniq_leq_size; rewrite ?enum_uniq // => x; rewrite mem_enum inE.
  by rewrite size_take; case: ltnP.
- exact: leq_trans (leq_imset_card _ _) cb.
- apply/subsetP => l /imsetP[m mc ->]; have := subsetP sub _ mc; rewrite full !inE card_imset //.
  exact: rename_inj.
- by rewrite sr disjoint_subset; apply/subsetP => x _; rewrite !inE.
by rewrite sl disjoint_subset; apply/subsetP => x _; rewrite !inE.
Qed.

Lemma rename_surj y : exists x, y = rename x.
Proof. by have [h _ hK] := injF_bij rename_inj; exists (h y); rewrite hK. Qed.

Lemma renamed_linked i j : linked t renamed (rename i) (rename j) -> linked t a i j.
Proof.
rewrite /linked !in_setD (inj_eq rename_inj) => /andP[ne /andP[nc _]]; rewrite ne /=.
have e : [set rename i; rename j] = rename @: [set i; j] by rewrite imsetU1 imset_set1.
rewrite full inE cards2 ne andbT; apply: contra nc => c; by rewrite e; apply: imset_f.
Qed.

Lemma renamed_sees y : exists i, sees t renamed y \subset [set rename j | j in sees t a i].
Proof.
have [i ->] := rename_surj y; exists i; apply/subsetP => z; rewrite !inE => /andP[zt con].
suff : z \in [set rename j | j in group t a i].
  case/imsetP=> j ji ez; apply/imsetP; exists j => //; rewrite in_setD ji andbT.
  by apply: contra zt => /blinded_top; rewrite ez inE.
have cl : closed (linked t renamed) [set rename j | j in group t a i].
  apply: intro_closed; first exact: connect_linked_sym.
  move=> x x' l /imsetP[j ji ej]; have [k ek] := rename_surj x'.
  rewrite ek; apply: imset_f; rewrite inE; move: ji; rewrite inE => ji.
  by apply: connect_trans ji (connect1 _); apply: renamed_linked; rewrite -ej -ek.
rewrite -(closed_connect cl con); apply: imset_f; by rewrite inE connect0.
Qed.
End Relabel.

Section Complete.
Variables (F : realFieldType) (R E : finType) (t : team R E) (phi : {set E} -> F) (default : E) (alpha g : nat) (robot0 : R).
Hypothesis every_robot_owns : forall i, exists x, owner t x = i.
Hypotheses (full : complete_graph t) (open : unprotected t).
(** More baits than robots that can be blinded, and a robot is left. *)
Hypotheses (baits : (alpha_s t < alpha)%N) (robots : (alpha_s t < #|R|)%N).
(** The adversary can leave no group with more than [g] seeing robots. *)
Hypothesis reach : exists2 a, allowed t a & forall i, (#|sees t a i| <= g)%N.
Hypotheses (n0 : normalised phi) (mono : non_decreasing t phi).
Let u := ratt t phi default alpha.

(** The same attack on the robots of the largest individual values. *)
Lemma reach_strongest : exists2 a, allowed t a &
  {subset strongest t phi default <= blinded a} /\ forall i, (#|sees t a i| <= g)%N.
Proof.
have [a oka small] := reach; pose order := by_value t phi default.
have op : perm_eq order (enum R) := order_perm t phi default.
exists (renamed t a order); first exact: (renamed_allowed full open oka op (ltnW robots)).
split=> [i|y].
  case: open => e _; rewrite /strongest e (eq_filter (a2 := predT)) ?filter_predT => [|x]; last by rewrite /= in_set0.
  by rewrite inE.
have [i sub] := renamed_sees full oka op y; apply: leq_trans (subset_leq_card sub) _.
exact: leq_trans (leq_imset_card _ _) (small i).
Qed.

Theorem group_size_submodular : submodular t phi -> optimum t phi <= g%:R * worst_case t phi u.
Proof. exact: (group_size_submodular_any robot0 every_robot_owns robots n0 mono reach_strongest baits). Qed.

Theorem group_size_total_curvature c : c <= 1 -> (0 < g)%N -> total_curvature_at_most t phi c ->
  (1 - c) * optimum t phi <= (g.-1%:R + (1 - c)) * worst_case t phi u.
Proof. exact: (group_size_total_curvature_any robot0 every_robot_owns robots n0 mono reach_strongest baits). Qed.

Theorem ratt_optimal : g = 1%N -> worst_case t phi u = optimum t phi.
Proof. exact: (ratt_optimal_any robot0 every_robot_owns robots n0 mono reach_strongest baits). Qed.
End Complete.
