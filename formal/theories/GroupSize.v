(** Guarantees from the group size, for any graph and any protected parts: with more baits than blinded robots, RATT
    keeps [1/g] of the optimum for every submodular function and [t / (g - 1 + t)] for total curvature [1 - t]; with
    [g = 1] it is optimal. Where no cut splits the team and the baits are as many as the robots that can be blinded,
    these hold as a minimum with greedy's own. *)
From mathcomp Require Import all_ssreflect all_algebra.
From mathcomp.algebra_tactics Require Import ring.
From Ratt Require Import Extrema Teams Guarantees Planner Greedy.
Set Implicit Arguments.
Unset Strict Implicit.
Unset Printing Implicit Defensive.
Import Order.Theory GRing.Theory Num.Theory.
Local Open Scope ring_scope.

Section Bounds.
Variables (F : realFieldType) (R E : finType) (t : team R E) (phi : {set E} -> F) (default : E) (g : nat) (robot0 : R).
Hypothesis every_robot_owns : forall i, exists x, owner t x = i.
Hypothesis robots : (alpha_s t < #|R|)%N.
Hypotheses (n0 : normalised phi) (mono : non_decreasing t phi).
Let order := by_value t phi default.
Let worth i := alone phi (best t phi default i).

(** The unprotected robots of the [alpha_s] largest individual values. *)
Definition strongest : seq R := take (alpha_s t) [seq i <- order | i \notin safe_robots t].
(** An allowed attack blinds them and leaves no group with more than [g] seeing robots. *)
Hypothesis reach : exists2 a, allowed t a & {subset strongest <= blinded a} /\ forall i, (#|sees t a i| <= g)%N.

Lemma order_perm : perm_eq order (enum R).
Proof. by rewrite perm_sort. Qed.
Lemma order_uniq : uniq order.
Proof. by rewrite (perm_uniq order_perm) enum_uniq. Qed.
Lemma order_size : size order = #|R|.
Proof. by rewrite (perm_size order_perm) -cardE. Qed.
Lemma mem_order i : i \in order.
Proof. by rewrite (perm_mem order_perm) mem_enum. Qed.

Lemma order_le i j : (i <= j < #|R|)%N -> worth (nth robot0 order j) <= worth (nth robot0 order i).
Proof.
move=> /andP[ij jn].
have tr : transitive (fun i j => worth j <= worth i) by move=> x y z /= h1 h2; apply: le_trans h2 h1.
have so : sorted (fun i j => worth j <= worth i) order.
  by apply: sort_sorted => x y; apply: le_total.
by apply: (sorted_leq_nth tr _ robot0 so) => //; rewrite ?inE ?order_size //; apply: leq_ltn_trans jn.
Qed.

(** The first robot in RATT's order beside the strongest, and its value, the bar. *)
Definition place : nat := find (fun i => i \notin strongest) order.
Definition bar : F := worth (nth robot0 order place).

Lemma size_strongest : (size strongest <= alpha_s t)%N.
Proof. by rewrite size_take; case: ltnP. Qed.

Lemma place_lt : (place < #|R|)%N.
Proof.
rewrite -order_size /place -has_find; apply/negPn; rewrite -all_predC; apply/negP => /allP all_in.
have : (size order <= size strongest)%N.
  by apply: uniq_leq_size order_uniq _ => i /all_in /=; rewrite negbK.
by rewrite order_size leqNgt (leq_ltn_trans size_strongest robots).
Qed.

Lemma first_left : nth robot0 order place \notin strongest.
Proof. by apply: (@nth_find _ robot0 (fun i => i \notin strongest)); rewrite has_find order_size place_lt. Qed.

Lemma place_le : (place <= alpha_s t)%N.
Proof.
have sz : size (take place order) = place by rewrite size_takel // order_size ltnW // place_lt.
rewrite -{1}sz; apply: leq_trans size_strongest; apply: uniq_leq_size; first exact: take_uniq order_uniq.
move=> i /(nthP robot0)[k]; rewrite sz => kp <-; rewrite nth_take //.
by have /negbFE := @before_find _ robot0 (fun i => i \notin strongest) order k kp.
Qed.

(** An unprotected robot beside the strongest has all of them before it. *)
Lemma place_unprotected : nth robot0 order place \notin safe_robots t -> place = alpha_s t.
Proof.
set r := nth _ _ _ => rs; apply/eqP; rewrite eqn_leq place_le /= leqNgt.
have rf : r \in [seq i <- order | i \notin safe_robots t] by rewrite mem_filter rs mem_order.
apply: contra first_left => lt; rewrite /strongest in_take //; apply: leq_ltn_trans lt.
have rp : index r order = place by rewrite index_uniq ?order_uniq // order_size place_lt.
have rt : r \notin take place order by rewrite in_take ?mem_order // rp ltnn.
rewrite -/r; have -> : [seq i <- order | i \notin safe_robots t] =
    [seq i <- take place order | i \notin safe_robots t] ++ [seq i <- drop place order | i \notin safe_robots t].
  by rewrite -filter_cat cat_take_drop.
rewrite index_cat mem_filter (negbTE rt) andbF.
rewrite (drop_nth robot0) ?order_size ?place_lt // -/r /= rs /= eqxx addn0 size_filter.
by apply: leq_trans (count_size _ _) _; rewrite size_take; case: ltnP.
Qed.

Lemma bar_ge0 : 0 <= bar.
Proof.
rewrite /bar /worth /alone -n0; apply: mono; last exact: sub0set.
by apply/forall_inP => x; rewrite inE => /eqP->; apply/forall_inP => y; rewrite inE => /eqP->; rewrite !eqxx.
Qed.

Lemma below_bar i : i \notin strongest -> worth i <= bar.
Proof.
move=> ni; rewrite -(nth_index robot0 (mem_order i)); apply: order_le.
rewrite -{1}order_size index_mem mem_order andbT leqNgt; apply/negP => lt.
by have := @before_find _ robot0 (fun i => i \notin strongest) order _ lt; rewrite nth_index ?mem_order // ni.
Qed.

(** The attack on the strongest leaves groups of at most [g] robots below the bar. *)
Lemma small_groups (x : F) (o : {ffun R -> E}) :
  (forall S : {set R}, (#|S| <= g)%N -> (forall i, i \in S -> worth i <= bar) -> phi (contributed o S) <= x) ->
  worst_case t phi o <= x.
Proof.
move=> h; have [a oka [top small]] := reach; apply: le_trans (worst_case_le phi o oka) _.
apply: team_value_le => [|y]; first exact: robot0.
apply: h => // i; rewrite inE => /andP[ib _]; apply: below_bar; apply: contra ib; exact: top.
Qed.

Lemma single_le_bar o i : is_plan t o -> worth i <= bar -> phi [set o i] <= bar.
Proof. by move=> oko; apply: le_trans; rewrite -[X in worth X](plan_owner i oko); apply: best_max. Qed.

Lemma ratt_plan alpha : is_plan t (ratt t phi default alpha).
Proof. by case: (ratt_bait_or_greedy phi default every_robot_owns alpha). Qed.

Lemma optimum_le (x : F) : (forall o, is_plan t o -> worst_case t phi o <= x) -> optimum t phi <= x.
Proof. by move=> h; have [[o oko <-] _] := optimumP phi (ratt_plan 0); apply: h. Qed.

Lemma optimum_bar_submodular : submodular t phi -> optimum t phi <= g%:R * bar.
Proof.
move=> sub; apply: optimum_le => o oko.
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

Lemma optimum_bar_total_curvature c : c <= 1 -> (0 < g)%N -> total_curvature_at_most t phi c ->
  (1 - c) * optimum t phi <= (g.-1%:R + (1 - c)) * bar.
Proof.
move=> c1 g0 curv; set s := 1 - c; have s0 : 0 <= s by rewrite subr_ge0.
have k0 : 0 <= g.-1%:R + s by rewrite addr_ge0 // ler0n.
have [[o oko <-] _] := optimumP phi (ratt_plan 0).
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

Lemma optimum_bar : g = 1%N -> optimum t phi <= bar.
Proof.
move=> g1; apply: optimum_le => o oko; apply: small_groups => S; rewrite g1 => S1 low.
have [->|[i iS]] := set_0Vmem S; first by rewrite /contributed imset0 n0 bar_ge0.
have eS : S = [set i].
  by apply/eqP; rewrite eq_sym eqEcard sub1set iS cards1.
by rewrite eS /contributed imset_set1; apply: single_le_bar => //; apply: low.
Qed.

(** ** A bait that sees *)
Lemma best_sees u a i : is_plan t u -> worth i <= phi [set u i] -> i \notin blinded a -> worth i <= team_value t phi u a.
Proof.
move=> oku wi ib; apply: le_trans (le_team_value t phi u a i); apply: le_trans wi _.
apply: mono; first exact: plan_feasible oku.
by rewrite sub1set; apply: imset_f; apply: mem_sees.
Qed.

(** Whatever the others chose: it suffices that the first [alpha_s + 1] robots took elements of largest individual value. *)
Theorem baits_keep_bar u : is_plan t u -> {in take (alpha_s t).+1 order, forall i, worth i <= phi [set u i]} ->
  bar <= worst_case t phi u.
Proof.
move=> oku baits; apply: le_worst_case => a /and5P[bl _ _ safe _].
have in_bait k : (k <= alpha_s t)%N -> (k < #|R|)%N -> nth robot0 order k \in take (alpha_s t).+1 order.
  by move=> ka kR; rewrite in_take ?mem_nth ?order_size // index_uniq ?order_uniq ?order_size.
case: (boolP (nth robot0 order place \in safe_robots t)) => [rs|/place_unprotected pE].
  by apply: best_sees oku (baits _ (in_bait _ place_le place_lt)) _; rewrite (disjointFl safe).
pose s := take (alpha_s t).+1 order.
have us : uniq s by apply: take_uniq order_uniq.
have szs : size s = (alpha_s t).+1 by rewrite size_takel ?order_size.
have [i is_ ib] : exists2 i, i \in s & i \notin blinded a.
  apply/hasP; rewrite has_predC; apply/negP => /allP all_b.
  have : (size s <= #|blinded a|)%N by rewrite cardE; apply: uniq_leq_size => // x /all_b; rewrite mem_enum.
  by rewrite szs leqNgt ltnS bl.
have ik : (index i order <= alpha_s t)%N by rewrite -ltnS; move: is_; rewrite in_take ?mem_order.
apply: le_trans (best_sees oku (baits _ is_) ib).
by rewrite -[X in worth X](nth_index robot0 (mem_order i)); apply: order_le; rewrite pE ik.
Qed.

(** The same for a team that planned without a centre: each component kept its own best robots as baits, so the best of
    all are among them. *)
Theorem baits_submodular u : is_plan t u -> {in take (alpha_s t).+1 order, forall i, worth i <= phi [set u i]} ->
  submodular t phi -> optimum t phi <= g%:R * worst_case t phi u.
Proof.
move=> oku baits sub; apply: le_trans (optimum_bar_submodular sub) _.
by apply: ler_wpmul2l (baits_keep_bar oku baits); apply: ler0n.
Qed.

Theorem baits_total_curvature u c : is_plan t u -> {in take (alpha_s t).+1 order, forall i, worth i <= phi [set u i]} ->
  c <= 1 -> (0 < g)%N -> total_curvature_at_most t phi c ->
  (1 - c) * optimum t phi <= (g.-1%:R + (1 - c)) * worst_case t phi u.
Proof.
move=> oku baits c1 g0 curv; apply: le_trans (optimum_bar_total_curvature c1 g0 curv) _.
by apply: ler_wpmul2l (baits_keep_bar oku baits); rewrite addr_ge0 ?ler0n // subr_ge0.
Qed.

Section Baits.
Variable alpha : nat.
Let u := ratt t phi default alpha.

Lemma bait_is_best i : i \in take alpha order -> worth i <= phi [set u i].
Proof. by move=> ia; rewrite (_ : u i = best t phi default i) // ffunE ifT. Qed.

Lemma bait_sees a i : i \in take alpha order -> i \notin blinded a -> worth i <= team_value t phi u a.
Proof. by move=> /bait_is_best; apply: best_sees (ratt_plan alpha). Qed.

Theorem ratt_keeps_bar : (alpha_s t < alpha)%N -> bar <= worst_case t phi u.
Proof.
move=> baits; apply: baits_keep_bar (ratt_plan alpha) _ => i.
by rewrite in_take ?mem_order // => ia; apply: bait_is_best; rewrite in_take ?mem_order // (leq_trans ia baits).
Qed.

Theorem group_size_submodular_any : (alpha_s t < alpha)%N -> submodular t phi ->
  optimum t phi <= g%:R * worst_case t phi u.
Proof.
move=> baits sub; apply: le_trans (optimum_bar_submodular sub) _.
by apply: ler_wpmul2l (ratt_keeps_bar baits); apply: ler0n.
Qed.

Theorem group_size_total_curvature_any c : (alpha_s t < alpha)%N -> c <= 1 -> (0 < g)%N ->
  total_curvature_at_most t phi c -> (1 - c) * optimum t phi <= (g.-1%:R + (1 - c)) * worst_case t phi u.
Proof.
move=> baits c1 g0 curv; apply: le_trans (optimum_bar_total_curvature c1 g0 curv) _.
by apply: ler_wpmul2l (ratt_keeps_bar baits); rewrite addr_ge0 ?ler0n // subr_ge0.
Qed.

(** Where the adversary can leave every seeing robot alone, RATT is optimal, for every non-decreasing function. *)
Theorem ratt_optimal_any : (alpha_s t < alpha)%N -> g = 1%N -> worst_case t phi u = optimum t phi.
Proof.
move=> baits g1; apply/eqP; rewrite eq_le; apply/andP; split.
  by have [_ best] := optimumP phi (ratt_plan 0); apply: best (ratt_plan alpha).
exact: le_trans (optimum_bar g1) (ratt_keeps_bar baits).
Qed.
End Baits.

(** ** No more baits than robots that can be blinded *)
Section Unsplit.
(** No allowed attack splits the team; the paper's [alpha_cs] is 0 then. *)
Hypothesis unsplit : forall a, allowed t a -> forall i j, connect (linked t a) i j.
Let u := ratt t phi default (alpha_s t).
Let picked := map (owner t) (ratt_picks t phi default (alpha_s t)).

Lemma greedy_picked i : i \notin bait t phi default (alpha_s t) -> i \in picked.
Proof.
move=> ib; have [x ox] := every_robot_owns i; rewrite -ox; apply: greedy_picks_all; first exact: max_card.
by rewrite mem_filter ox ib mem_enum.
Qed.

(** Either a bait sees, or exactly the baits are blinded and all greedy robots see each other. *)
Lemma bait_or_greedy_group a : allowed t a -> bar <= team_value t phi u a \/
  forall i, sees t a i = [set j in picked].
Proof.
move=> oka; have /and5P[bl _ _ safe _] := oka; pose s := take (alpha_s t) order.
case: (boolP (has (fun i => i \notin blinded a) s)) => [/hasP[i is_ ib]|none]; [left | right].
  have ik : (index i order < alpha_s t)%N by move: is_; rewrite in_take ?mem_order.
  case: (boolP (nth robot0 order place \in safe_robots t)) => [rs|/place_unprotected pE]; last first.
    apply: le_trans (bait_sees is_ ib); rewrite -[X in worth X](nth_index robot0 (mem_order i)).
    by apply: order_le; rewrite pE (ltnW ik).
  have [lt|ge] := ltnP place (alpha_s t).
    apply: (bait_sees _ (_ : nth robot0 order place \notin blinded a)); last by rewrite (disjointFl safe).
    by rewrite in_take ?mem_order // index_uniq ?order_uniq ?order_size ?place_lt.
  apply: le_trans (bait_sees is_ ib); rewrite -[X in worth X](nth_index robot0 (mem_order i)).
  by apply: order_le; rewrite place_lt (leq_trans (ltnW ik) ge).
move=> i; have all_b x : x \in s -> x \in blinded a by move=> /(hasPn none); rewrite negbK.
have us : uniq s by apply: take_uniq order_uniq.
have sz : size s = alpha_s t by rewrite size_takel // order_size ltnW.
have bE : s =i enum (blinded a).
  apply: (uniq_min_size us _ _).2 => [x /all_b|]; first by rewrite mem_enum.
  by rewrite -cardE sz.
apply/setP => j; rewrite !inE unsplit // andbT -mem_enum -bE; apply/idP/idP => [js|].
  by apply: greedy_picked.
case/mapP=> y /greedy_picks_sub; by rewrite mem_filter => /andP[h _] ->.
Qed.

Lemma greedy_value a : (forall i, sees t a i = [set j in picked]) ->
  phi (contributed u [set j in picked]) <= team_value t phi u a.
Proof. by move=> h; have := le_team_value t phi u a robot0; rewrite h. Qed.

Lemma other_value a o : allowed t a -> (forall i, sees t a i = [set j in picked]) ->
  worst_case t phi o <= phi (contributed o [set j in picked]).
Proof.
move=> oka h; apply: le_trans (worst_case_le phi o oka) _.
by apply: team_value_le => [|i]; [exact: robot0 | rewrite h].
Qed.

Let u_greedy : bait_or_greedy t phi u picked := ratt_bait_or_greedy phi default every_robot_owns (alpha_s t).

Theorem group_size_submodular_unsplit k : 0 <= k <= 1 -> submodular t phi -> curvature_at_most t phi k ->
  optimum t phi <= Num.max g%:R (1 + k) * worst_case t phi u.
Proof.
move=> /andP[k0 k1] sub curv; have [[o oko <-] _] := optimumP phi (ratt_plan 0).
have [a oka ->] := worst_case_attained t phi u; have [_ best] := optimumP phi oko.
have [le|h] := bait_or_greedy_group oka.
  apply: le_trans (best _ oko) _; apply: le_trans (optimum_bar_submodular sub) _.
  apply: ler_pmul => //; [exact: ler0n | exact: bar_ge0 | by rewrite le_maxr lexx].
apply: le_trans (other_value o oka h) _; apply: le_trans (greedy_submodular n0 u_greedy oko k1 sub curv) _.
have k2 : 0 <= 1 + k by rewrite addr_ge0 ?ler01.
apply: ler_pmul => //; [|by rewrite le_maxr lexx orbT|exact: greedy_value].
by rewrite -n0; apply: mono (sub0set _); apply: plan_feasible (ratt_plan _).
Qed.

Theorem group_size_total_curvature_unsplit c : 0 <= c <= 1 -> (0 < g)%N -> total_curvature_at_most t phi c ->
  (1 - c) * optimum t phi <= Num.max (g.-1%:R + (1 - c)) 1 * worst_case t phi u.
Proof.
move=> /andP[c0 c1] g0 curv; have c2 : 0 <= 1 - c by rewrite subr_ge0.
have [a oka ->] := worst_case_attained t phi u; have [le|h] := bait_or_greedy_group oka.
  apply: le_trans (optimum_bar_total_curvature c1 g0 curv) _.
  apply: ler_pmul => //; [by rewrite addr_ge0 ?ler0n | exact: bar_ge0 | by rewrite le_maxr lexx].
have [[o oko <-] _] := optimumP phi (ratt_plan 0).
apply: le_trans (ler_wpmul2l c2 (other_value o oka h)) _.
apply: le_trans (greedy_total_curvature n0 u_greedy oko c1 curv) _; rewrite -[X in X <= _]mul1r.
apply: ler_pmul; [exact: ler01 | | by rewrite le_maxr lexx orbT | exact: greedy_value].
by rewrite -n0; apply: mono (sub0set _); apply: plan_feasible (ratt_plan _).
Qed.
End Unsplit.
End Bounds.
