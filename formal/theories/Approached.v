(** [(1 - c)^2] is approached: for every [m >= 1] and [0 <= c < 1] a non-decreasing function of total curvature at most
    [c] on [2m] robots, [m] of them blinded, on which RATT keeps at most [(1 - c)^2 + 1/m] of the optimum. *)
From mathcomp Require Import all_ssreflect all_algebra.
From mathcomp.algebra_tactics Require Import ring.
From Ratt Require Import Extrema Teams Guarantees Planner Ties.
Set Implicit Arguments.
Unset Strict Implicit.
Unset Printing Implicit Defensive.
Import Order.Theory GRing.Theory Num.Theory.
Local Open Scope ring_scope.

Section Family.
Variables (F : realFieldType) (n : nat) (c : F).
Local Notation m := n.+1.
Local Notation t := (1 - c).
Hypotheses (c0 : 0 <= c) (c1 : c < 1).

(** Robots: baits [(true, j)] and greedy ones [(false, j)]; elements: the plan's ([true]) and the others. *)
Let R : finType := [finType of bool * 'I_m].
Let E : finType := [finType of bool * R].

Definition baits : {set E} := [set x | x.1 && x.2.1].
Definition greedies : {set E} := [set x | x.1 && ~~ x.2.1].
Definition others : {set E} := [set x | ~~ x.1].
(** The first is worth 1, every other [a]. *)
Definition steps (a : F) (k : nat) : F := if k is l.+1 then 1 + l%:R * a else 0.
Arguments steps : simpl never.
Definition phi (A : {set E}) : F := steps t #|A :&: baits| + #|A :&: greedies|%:R + steps t^-1 #|A :&: others|.
Definition family_team : team R E := Team (fun x : E => x.2) [set l : {set R} | #|l| == 2%N] m 0 set0 set0.

Lemma t_gt0 : 0 < t. Proof. by rewrite subr_gt0. Qed.
Lemma t_le1 : t <= 1. Proof. by rewrite ler_subl_addr ler_addl. Qed.
Lemma one_le_tV : 1 <= t^-1. Proof. by rewrite invr_ge1 ?t_gt0 ?t_le1 // unitfE gt_eqF ?t_gt0. Qed.

Lemma cardU1I x (A B : {set E}) : x \notin A -> #|(x |: A) :&: B| = ((x \in B) + #|A :&: B|)%N.
Proof.
move=> xA; rewrite setIUl; case xB: (x \in B).
  by rewrite (setIidPl _) ?sub1set // cardsU1 inE (negbTE xA).
suff -> : [set x] :&: B = set0 by rewrite set0U.
by apply/setP => y; rewrite !inE; case: eqP => // ->.
Qed.

(** What an element adds, by its kind and by how many of its kind are there. *)
Definition add_step (a : F) (k : nat) : F := if k is 0 then 1 else a.
Lemma steps_succ a k : steps a k.+1 = steps a k + add_step a k.
Proof. by case: k => [|k]; rewrite /steps /= ?mul0r ?addr0 ?add0r // -addrA -[in LHS]addn1 natrD mulrDl mul1r. Qed.

Lemma marginalE x (A : {set E}) : x \notin A -> marginal phi x A =
  if x.1 then if x.2.1 then add_step t #|A :&: baits| else 1 else add_step t^-1 #|A :&: others|.
Proof.
move=> xA; rewrite /marginal /phi !cardU1I // !inE; case: x xA => [[] [b j]] _ /=; first case: b.
all: rewrite /= ?add0n ?add1n ?steps_succ ?[_.+1%:R]mulrS; ring.
Qed.

Lemma phi0 : phi set0 = 0.
Proof. by rewrite /phi !set0I cards0 /= !addr0. Qed.
Lemma single x : phi [set x] = 1.
Proof.
have := @marginalE x set0; rewrite in_set0 /marginal setU0 phi0 subr0 => ->; rewrite // !set0I cards0.
by case: x.1 => //; case: x.2.1.
Qed.

Lemma family_curvature : total_curvature_at_most family_team phi c.
Proof.
move=> x A B _ _ xA xB; rewrite !marginalE //; have t0 := t_gt0; have t1 := t_le1; have tV := one_le_tV.
have tt : t * t <= t by rewrite ler_pimulr // ltW.
case: x.1; first case: x.2.1; rewrite ?mulr1 //.
  by case: #|B :&: _| => [|b]; case: #|A :&: _| => [|a]; rewrite /= ?mulr1 //; apply: le_trans tt t1.
case: #|B :&: _| => [|b]; case: #|A :&: _| => [|a]; rewrite /= ?mulr1 ?mulfV ?gt_eqF //.
exact: le_trans t1 tV.
Qed.

Definition default : E := (true, (true, ord0)).
Local Notation baits_first := [seq (true, j) | j <- enum 'I_m].
Local Notation greedy_second := [seq (false, j) | j <- enum 'I_m].

Lemma enum_robots : enum R = baits_first ++ greedy_second.
Proof. by rewrite /R enum_pair enum_bool /= cats0. Qed.

Lemma best_true i : best family_team phi default i = (true, i).
Proof. by apply: best_first => //; rewrite !single. Qed.

Lemma baitE : bait family_team phi default m = baits_first.
Proof.
rewrite /bait (by_value_flat (c := 1)) => [|i]; last by rewrite /alone single.
by rewrite enum_robots take_size_cat // size_map size_enum_ord.
Qed.

(** RATT with its [m] baits takes every robot's first element. *)
Lemma family_ratt : ratt family_team phi default m = first_choice R.
Proof.
apply: (@ratt_first_choice _ _ _ _ _ _ m greedy_second) => // [|i _|r z rg zg zt].
- rewrite enum_robots filter_cat baitE; set s1 := filter _ _; set s2 := filter _ _.
  have -> : s1 = [::] by rewrite /s1 -(filter_pred0 baits_first); apply: eq_in_filter => i ->.
  rewrite cat0s /s2; apply/esym/all_filterP/allP => i /mapP[j _ ->].
  by apply/mapP => -[k].
- exact: best_true.
set B := before _ _ _.
have inB x : x \in B -> x.1 /\ x.2 \in take (index r greedy_second) greedy_second.
  by case/imsetP => i; rewrite inE => ib ->; rewrite ffunE.
have zB : z \notin B by apply: contra zt => /inB[].
have rB : (true, r) \notin B.
  by apply/negP => /inB[_]; apply/negP; apply: take_index_notin.
rewrite -(ler_add2r (- phi B)) -!/(marginal phi _ _) !marginalE //=.
case/mapP: rg => j _ -> /=; case/mapP: zg => k _ -> /=; case: z.1 => //.
rewrite (_ : B :&: others = set0) ?cards0 //; apply/setP => x; rewrite !inE; apply/negP => /andP[/inB[->]].
by [].
Qed.

Lemma ratt_worst : worst_case family_team phi (first_choice R) <= 1 + n%:R * t.
Proof.
pose a : attack R := ([set i | ~~ i.1], set0).
have oka : allowed family_team a.
  apply/and5P; split; rewrite ?sub0set ?cards0 //=.
  - apply: leq_trans (_ : #|greedy_second| <= _)%N; last by apply: leq_trans (card_size _) _; rewrite size_map size_enum_ord.
    apply/subset_leq_card/subsetP => -[b j]; rewrite inE /= => /negbTE ->.
    by apply/mapP; exists j; rewrite ?mem_enum.
  - by rewrite disjoint_subset; apply/subsetP => x _; rewrite !inE.
  by rewrite disjoint_subset; apply/subsetP => x _; rewrite !inE.
apply: le_trans (worst_case_le phi _ oka) _; apply: team_value_le; first exact: (true, ord0).
move=> i; set S := contributed _ _.
have inS x : x \in S -> x.1 /\ x.2.1.
  by case/imsetP=> k; rewrite in_setD inE negbK => /andP[k1 _] ->; rewrite ffunE.
have none (T : {set E}) : (forall x, x \in T -> ~~ (x.1 && x.2.1)) -> S :&: T = set0.
  by move=> h; apply/setP => x; rewrite !inE; apply/negP => /andP[/inS[s1 s2] /h]; rewrite s1 s2.
have -> : phi S = steps t #|S :&: baits|.
  rewrite /phi (none greedies) => [|x]; last by rewrite inE => /andP[->].
  by rewrite (none others) => [|x]; rewrite ?cards0 /steps ?addr0 // inE => /negbTE ->.
have le : (#|S :&: baits| <= m)%N.
  apply: leq_trans (subset_leq_card (_ : _ \subset [set (true, (true, j)) | j : 'I_m])) _; last first.
    by apply: leq_trans (leq_imset_card _ _) _; rewrite card_ord.
  apply/subsetP => -[b [b' j]]; rewrite !inE => /andP[_ /andP[/= -> ->]]; exact: imset_f.
case: #|_| le => [|l] le; rewrite /steps; first by rewrite addr_ge0 ?mulr_ge0 ?ler0n ?ler01 // ltW // t_gt0.
by rewrite ler_add2l; apply: ler_wpmul2r; [apply/ltW/t_gt0 | rewrite ler_nat].
Qed.

Definition second_choice : {ffun R -> E} := [ffun i => (false, i)].

Lemma second_worst : 1 + n%:R / t <= worst_case family_team phi second_choice.
Proof.
apply: le_worst_case => a /and5P[bl cb _ _ _]; pose i0 : R := (true, ord0).
apply: le_trans (le_team_value family_team phi second_choice a i0).
have noc : cut a = set0 by apply/eqP; rewrite -cards_eq0 -leqn0.
have -> : sees family_team a i0 = ~: blinded a.
  apply/setP => j; rewrite !inE; case: (_ \in _) => //=; have [<-|ne] := eqVneq i0 j; first exact: connect0.
  by apply: connect1; rewrite /linked noc setD0 inE cards2 ne.
set S := contributed _ _.
have cS : #|S :&: others| = #|~: blinded a|.
  rewrite (setIidPl _); first by apply: card_imset => i j; rewrite !ffunE => -[].
  by apply/subsetP => x /imsetP[i _ ->]; rewrite ffunE inE.
have left : (m <= #|~: blinded a|)%N.
  by rewrite -(leq_add2l #|blinded a|) cardsC card_prod card_bool card_ord mul2n -addnn leq_add2r.
rewrite /phi cS; have b0 : 0 <= steps t #|S :&: baits|.
  by case: #|_| => [|l]; rewrite /steps ?addr_ge0 ?mulr_ge0 ?ler0n ?ler01 // ltW // t_gt0.
apply: ler_paddl; first by rewrite addr_ge0 ?ler0n.
case: #|_| left => [//|l] le; rewrite /steps ler_add2l; apply: ler_wpmul2r; last by rewrite ler_nat.
by rewrite invr_ge0 ltW ?t_gt0.
Qed.

Lemma second_plan : is_plan family_team second_choice.
Proof. by apply/forallP => i; rewrite ffunE. Qed.

Lemma optimum_ge : 1 + n%:R / t <= optimum family_team phi.
Proof. have [_ best] := optimumP phi second_plan; exact: le_trans second_worst (best _ second_plan). Qed.

Lemma ratio_close : 1 + n%:R * t <= (t ^+ 2 + m%:R^-1) * (1 + n%:R / t).
Proof.
have t0 := t_gt0; have m0 : 0 < m%:R :> F by rewrite ltr0n.
rewrite -subr_ge0 (_ : _ - _ = (n%:R * (1 - t) + m%:R * t ^+ 3) / (m%:R * t)); last first.
  have m1 : 1 + n%:R != 0 :> F by rewrite -mulrS pnatr_eq0.
  by rewrite !mulrS; field; rewrite m1 gt_eqF.
by rewrite divr_ge0 ?addr_ge0 ?mulr_ge0 ?ler0n ?subr_ge0 ?t_le1 // ?exprn_ge0 ?ltW.
Qed.

Theorem one_minus_c_squared_family :
  [/\ normalised phi, total_curvature_at_most family_team phi c, 0 < optimum family_team phi
    & worst_case family_team phi (ratt family_team phi default m) <=
      ((1 - c) ^+ 2 + m%:R^-1) * optimum family_team phi].
Proof.
have pos : 0 < 1 + n%:R / t by rewrite ltr_spaddl ?ltr01 // divr_ge0 ?ler0n // ltW // t_gt0.
split; [exact: phi0 | exact: family_curvature | exact: lt_le_trans pos optimum_ge |].
rewrite family_ratt; apply: le_trans ratt_worst _; apply: le_trans ratio_close _.
by apply: ler_wpmul2l optimum_ge; rewrite addr_ge0 ?sqr_ge0 // invr_ge0 ler0n.
Qed.
End Family.

(** No larger factor than [(1 - c)^2] holds for all teams, over any Archimedean field: the rationals, the reals. *)
Theorem one_minus_c_squared_approached (F : archiFieldType) (c eps : F) : 0 <= c < 1 -> 0 < eps ->
  exists (R E : finType) (t : team R E) (phi : {set E} -> F) (default : E),
    [/\ normalised phi, total_curvature_at_most t phi c, 0 < optimum t phi
      & worst_case t phi (ratt t phi default (alpha_s t)) < ((1 - c) ^+ 2 + eps) * optimum t phi].
Proof.
move=> /andP[c0 c1] e0; pose n := Num.bound eps^-1.
have [n0 curv pos le] := one_minus_c_squared_family n c0 c1.
exists [finType of bool * 'I_n.+1], [finType of bool * (bool * 'I_n.+1)], (family_team n), (@phi F n c), (default n); split=> //.
apply: le_lt_trans le _; rewrite ltr_pmul2r // ltr_add2l -[X in _ < X]invrK ltf_pinv ?posrE ?invr_gt0 ?ltr0n //.
apply: lt_trans (archi_boundP _) _; first by rewrite invr_ge0 ltW.
by rewrite ltr_nat.
Qed.
