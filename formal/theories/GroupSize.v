(** Guarantees from the group size: on the complete graph, with more baits than blinded robots, RATT keeps [1/g] of the
    optimum for every submodular function and [t / (g - 1 + t)] for total curvature [1 - t]; with [g = 1] it is optimal. *)
From mathcomp Require Import all_ssreflect all_algebra.
From mathcomp.algebra_tactics Require Import ring.
From Ratt Require Import Extrema Teams Guarantees Planner.
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

Lemma from_uniq : uniq from.
Proof.
rewrite cat_uniq !enum_uniq andbT; apply/hasP => -[x].
by rewrite mem_enum in_setC => /negP h1 /=; rewrite mem_enum => /h1.
Qed.
Lemma mem_from x : x \in from.
Proof. by rewrite mem_cat !mem_enum inE orbN. Qed.
Lemma size_from : size from = #|R|.
Proof. by rewrite size_cat -!cardE cardsC. Qed.
Lemma size_order : size order = #|R|.
Proof. by rewrite (perm_size order_all) -cardE. Qed.
Lemma order_uniq : uniq order.
Proof. by rewrite (perm_uniq order_all) enum_uniq. Qed.

Lemma rename_inj : injective rename.
Proof.
move=> x y; rewrite /rename (set_nth_default x y) ?size_order -?size_from ?index_mem ?mem_from // => /eqP.
rewrite nth_uniq ?order_uniq ?size_order -?size_from ?index_mem ?mem_from // => /eqP e.
by rewrite -(nth_index x (mem_from x)) e nth_index ?mem_from.
Qed.

Lemma rename_blinded x : x \in blinded a -> rename x \in take #|blinded a| order.
Proof.
move=> xb; have : (index x from < #|blinded a|)%N by rewrite /from index_cat mem_enum xb cardE index_mem mem_enum.
move=> lt; rewrite /rename -(nth_take _ lt); apply: mem_nth.
by rewrite size_takel // size_order max_card.
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

Section Bounds.
Variables (F : realFieldType) (R E : finType) (t : team R E) (phi : {set E} -> F) (default : E) (alpha g : nat) (robot0 : R).
Hypothesis every_robot_owns : forall i, exists x, owner t x = i.
Hypotheses (full : complete_graph t) (open : unprotected t).
(** More baits than robots that can be blinded, and a robot is left. *)
Hypotheses (baits : (alpha_s t < alpha)%N) (robots : (alpha_s t < #|R|)%N).
(** The adversary can leave no group with more than [g] seeing robots. *)
Hypothesis reach : exists2 a, allowed t a & forall i, (#|sees t a i| <= g)%N.
Hypotheses (n0 : normalised phi) (mono : non_decreasing t phi).
Let u := ratt t phi default alpha.
Let order := by_value t phi default.
Let worth i := alone phi (best t phi default i).

Lemma u_plan : is_plan t u.
Proof. by case: (ratt_bait_or_greedy phi default every_robot_owns alpha). Qed.

Lemma order_perm : perm_eq order (enum R).
Proof. by rewrite perm_sort. Qed.

(** The [alpha_s + 1]-th largest value of a best element. *)
Definition bar : F := worth (nth robot0 order (alpha_s t)).

Lemma order_le i j : (i <= j < #|R|)%N -> worth (nth robot0 order j) <= worth (nth robot0 order i).
Proof.
move=> /andP[ij jn]; have sz : size order = #|R| by rewrite size_sort -cardE.
have tr : transitive (fun i j => worth j <= worth i) by move=> x y z /= h1 h2; apply: le_trans h2 h1.
have so : sorted (fun i j => worth j <= worth i) order.
  by apply: sort_sorted => x y; apply: le_total.
by apply: (sorted_leq_nth tr _ robot0 so) => //; rewrite ?inE ?sz //; apply: leq_ltn_trans jn.
Qed.

Lemma single_le_best x : phi [set x] <= worth (owner t x).
Proof. exact: best_max. Qed.

Lemma bar_ge0 : 0 <= bar.
Proof.
rewrite /bar /worth /alone -n0; apply: mono; last exact: sub0set.
by apply/forall_inP => x; rewrite inE => /eqP->; apply/forall_inP => y; rewrite inE => /eqP->; rewrite !eqxx.
Qed.

Lemma below_bar i : i \notin take (alpha_s t) order -> worth i <= bar.
Proof.
move=> ni; have io : i \in order by rewrite (perm_mem order_perm) mem_enum.
rewrite -(nth_index robot0 io); apply: order_le.
have -> : (index i order < #|R|)%N by rewrite cardE -(perm_size order_perm) index_mem.
by rewrite andbT leqNgt; apply: contra ni; rewrite in_take.
Qed.

(** RATT keeps at least the bar: one of its [alpha_s + 1] first baits sees. *)
Lemma ratt_keeps_bar : bar <= worst_case t phi u.
Proof.
apply: le_worst_case => a /and5P[bl _ _ _ _].
have szo : size order = #|R| by rewrite size_sort -cardE.
pose s := take (alpha_s t).+1 order.
have us : uniq s by apply: take_uniq; rewrite (perm_uniq order_perm) enum_uniq.
have szs : size s = (alpha_s t).+1 by rewrite size_takel ?szo.
have [i is_ ib] : exists2 i, i \in s & i \notin blinded a.
  apply/hasP; rewrite has_predC; apply/negP => /allP all_b.
  have : (size s <= #|blinded a|)%N by rewrite cardE; apply: uniq_leq_size => // x /all_b; rewrite mem_enum.
  by rewrite szs leqNgt ltnS bl.
apply: le_trans (le_team_value t phi u a i).
have ui : u i = best t phi default i.
  rewrite ffunE ifT //; rewrite /bait -(subnKC baits) takeD mem_cat -/s is_ //.
apply: le_trans (_ : phi [set u i] <= _); last first.
  apply: mono; first exact: plan_feasible u_plan.
  by rewrite sub1set; apply: imset_f; apply: mem_sees.
have io : i \in order by rewrite (perm_mem order_perm) mem_enum.
rewrite ui -/(alone phi _) -/(worth i) -[X in worth X](nth_index robot0 io); apply: order_le.
by rewrite robots andbT -ltnS; move: is_; rewrite in_take.
Qed.

(** The attack on the largest baits leaves groups of at most [g] robots below the bar. *)
Lemma small_groups (x : F) (o : {ffun R -> E}) :
  (forall S : {set R}, (#|S| <= g)%N -> (forall i, i \in S -> worth i <= bar) -> phi (contributed o S) <= x) ->
  worst_case t phi o <= x.
Proof.
move=> h; have [a oka small] := reach.
apply: le_trans (worst_case_le phi o (renamed_allowed full open oka order_perm (ltnW robots))) _.
apply: team_value_le => [|y]; first exact: robot0.
apply: h => [|i]; last by rewrite !inE => /andP[/below_bar].
have [i sub] := renamed_sees full oka order_perm y.
by apply: leq_trans (subset_leq_card sub) _; apply: leq_trans (leq_imset_card _ _) _.
Qed.

Lemma single_le_bar o i : is_plan t o -> worth i <= bar -> phi [set o i] <= bar.
Proof. by move=> oko; apply: le_trans; rewrite -[X in worth X](plan_owner i oko); apply: single_le_best. Qed.

Lemma optimum_le (x : F) : (forall o, is_plan t o -> worst_case t phi o <= x) -> optimum t phi <= x.
Proof. by move=> h; have [[o oko <-] _] := optimumP phi u_plan; apply: h. Qed.

Theorem group_size_submodular : submodular t phi -> optimum t phi <= g%:R * worst_case t phi u.
Proof.
move=> sub; apply: le_trans (ler_wpmul2l (ler0n _ _) ratt_keeps_bar); apply: optimum_le => o oko.
apply: small_groups => S Sg low; apply: le_trans (_ : #|S|%:R * bar <= _); last first.
  by apply: ler_wpmul2r; [exact: bar_ge0 | rewrite ler_nat].
move: {2}#|S| (erefl #|S|) => n; elim: n S Sg low => [|n IH] S Sg low cS.
  by rewrite cS mul0r (cards0_eq cS) /contributed imset0 n0.
have [i iS] : exists i, i \in S by apply/set0Pn; rewrite -card_gt0 cS.
have cT : #|S :\ i| = n by have := cardsD1 i S; rewrite cS iS => -[].
have eS : contributed o S = o i |: contributed o (S :\ i) by rewrite -contributedU1 setD1K.
have own : owner t (o i) \notin S :\ i by rewrite (plan_owner _ oko) setD11.
have m := sub (o i) set0 (contributed o (S :\ i)) (extend_feasible oko own) (extend_notin oko own) (sub0set _).
rewrite /marginal setU0 n0 subr0 -eS in m.
have small : (#|S :\ i| <= g)%N by rewrite cT; apply: leq_trans Sg; rewrite cS.
have lowT j : j \in S :\ i -> worth j <= bar by case/setD1P => _ /low.
have h := IH _ small lowT cT; rewrite cT in h.
rewrite cS -addn1 natrD mulrDl mul1r -(subrK (phi (contributed o (S :\ i))) (phi (contributed o S))) addrC.
apply: ler_add h _.
by apply: le_trans m _; apply: single_le_bar => //; apply: low.
Qed.

Theorem group_size_total_curvature c : c <= 1 -> (0 < g)%N -> total_curvature_at_most t phi c ->
  (1 - c) * optimum t phi <= (g.-1%:R + (1 - c)) * worst_case t phi u.
Proof.
move=> c1 g0 curv; set s := 1 - c; have s0 : 0 <= s by rewrite subr_ge0.
have k0 : 0 <= g.-1%:R + s by rewrite addr_ge0 // ler0n.
apply: le_trans (ler_wpmul2l k0 ratt_keeps_bar); have [[o oko <-] _] := optimumP phi u_plan.
have [z|sp] := eqVneq s 0; first by rewrite z mul0r mulr_ge0 ?bar_ge0 // addr0 ler0n.
have {sp} sp : 0 < s by rewrite lt_def sp.
rewrite -ler_pdivl_mull //; apply: small_groups => S Sg low; rewrite ler_pdivl_mull //.
(* A non-empty set of n + 1 robots: s phi <= (n + s) bar. *)
have many n (T : {set R}) : #|T| = n.+1 -> (forall i, i \in T -> worth i <= bar) ->
    s * phi (contributed o T) <= (n%:R + s) * bar.
  elim: n T => [|n IH] T cT lowT.
    have /cards1P[i eT] : #|T| == 1%N by rewrite cT.
    rewrite add0r eT /contributed imset_set1; apply: ler_wpmul2l => //.
    by apply: single_le_bar => //; apply: lowT; rewrite eT set11.
  have [i iT] : exists i, i \in T by apply/set0Pn; rewrite -card_gt0 cT.
  have cT' : #|T :\ i| = n.+1 by have := cardsD1 i T; rewrite cT iT => -[].
  have eT : contributed o T = o i |: contributed o (T :\ i) by rewrite -contributedU1 setD1K.
  have own : owner t (o i) \notin T :\ i by rewrite (plan_owner _ oko) setD11.
  have fe : feasible t (o i |: contributed o (T :\ i)) := extend_feasible oko own.
  have m := curv (o i) set0 (contributed o (T :\ i)) _ fe (negbT (in_set0 _)) _.
  have lowT' j : j \in T :\ i -> worth j <= bar by case/setD1P => _ /lowT.
  have h := IH _ cT' lowT'.
  rewrite -(subrK (phi (contributed o (T :\ i))) (phi (contributed o T))) addrC mulrDr.
  have -> : (n.+1%:R + s) * bar = (n%:R + s) * bar + bar by rewrite -addn1 natrD; ring.
  apply: ler_add h _; apply: le_trans (_ : phi [set o i] <= _); last by apply: single_le_bar => //; apply: lowT.
  move: m; rewrite /marginal setU0 n0 subr0 -eT; apply.
    by apply: sub_feasible fe; rewrite sub1set setU11.
  exact: extend_notin oko own.
case c0: #|S| => [|n].
  by rewrite (cards0_eq c0) /contributed imset0 n0 mulr0 mulr_ge0 ?bar_ge0.
apply: le_trans (many n S c0 low) _; apply: ler_wpmul2r; first exact: bar_ge0.
by rewrite ler_add2r ler_nat -ltnS -c0 prednK.
Qed.

(** Where the adversary can leave every seeing robot alone, RATT is optimal, for every non-decreasing function. *)
Theorem ratt_optimal : g = 1%N -> worst_case t phi u = optimum t phi.
Proof.
move=> g1; apply/eqP; rewrite eq_le; apply/andP; split.
  by have [_ best] := optimumP phi u_plan; apply: best u_plan.
apply: le_trans ratt_keeps_bar; apply: optimum_le => o oko; apply: small_groups => S; rewrite g1 => S1 low.
have [->|[i iS]] := set_0Vmem S; first by rewrite /contributed imset0 n0 bar_ge0.
have eS : S = [set i].
  by apply/eqP; rewrite eq_sym eqEcard sub1set iS cards1.
by rewrite eS /contributed imset_set1; apply: single_le_bar => //; apply: low.
Qed.
End Bounds.
