(** Guarantees without a centre: each robot's element is best beside the choices of the robots that it heard, whoever
    these are, and however the team was split while it planned. *)
From mathcomp Require Import all_ssreflect all_algebra.
From mathcomp.algebra_tactics Require Import ring.
From Ratt Require Import Extrema Teams Guarantees Planner GroupSize.
Set Implicit Arguments.
Unset Strict Implicit.
Unset Printing Implicit Defensive.
Import Order.Theory GRing.Theory Num.Theory.
Local Open Scope ring_scope.

Section Definitions.
Variables (F : realDomainType) (R E : finType) (t : team R E) (phi : {set E} -> F).

(** Robot [i] took the element of largest marginal beside what the robots of [heard i] chose; a bait heard nobody. *)
Definition best_heard (u : {ffun R -> E}) (heard : R -> {set R}) : Prop :=
  [/\ is_plan t u, forall i, i \notin heard i
    & forall i x, owner t x = i -> phi (x |: contributed u (heard i)) <= phi (u i |: contributed u (heard i))].

(** Robots in an order in which each heard all those before it: a clique of the graph of who heard whom. *)
Definition heard_in_turn (heard : R -> {set R}) (g : seq R) : Prop :=
  uniq g /\ {in g, forall i, [set j in take (index i g) g] \subset heard i}.

(** Lists of robots, each heard in turn, that cover all robots which heard somebody. *)
Definition covers_listeners (heard : R -> {set R}) (groups : seq (seq R)) : Prop :=
  {in groups, forall g, heard_in_turn heard g} /\
  (forall i, heard i = set0 \/ exists2 g, g \in groups & i \in g).
End Definitions.

Section Proofs.
Variables (F : realDomainType) (R E : finType) (t : team R E) (phi : {set E} -> F).
Variables (u o : {ffun R -> E}) (heard : R -> {set R}).
Hypotheses (n0 : normalised phi) (best : best_heard t phi u heard) (oko : is_plan t o).
Implicit Types (S T : {set R}).

Let plan_u : is_plan t u. Proof. by case: best. Qed.
Let not_itself i : i \notin heard i. Proof. by case: best. Qed.
Let gains_more i : marginal phi (o i) (contributed u (heard i)) <= marginal phi (u i) (contributed u (heard i)).
Proof. by rewrite /marginal ler_add2r; case: best => _ _; apply; rewrite plan_owner. Qed.

Let ex p i T : is_plan t p -> i \notin T -> forall q, is_plan t q -> feasible t (q i |: contributed p T).
Proof. by move=> okp iT q okq; apply: extend_feasible okp _; rewrite (plan_owner i okq). Qed.
Let out p i T : is_plan t p -> i \notin T -> forall q, is_plan t q -> q i \notin contributed p T.
Proof. by move=> okp iT q okq; apply: extend_notin okp _; rewrite (plan_owner i okq). Qed.

Lemma whole S : S = set0 :|: [set i in enum S].
Proof. by rewrite set0U; apply/setP => i; rewrite inE mem_enum. Qed.

(** Total curvature: no message is needed. *)
Theorem heard_total_curvature c S : c <= 1 -> total_curvature_at_most t phi c ->
  (1 - c) ^+ 2 * phi (contributed o S) <= phi (contributed u S).
Proof.
move=> c1 curv; have c0 : 0 <= 1 - c by rewrite subr_ge0.
rewrite [S]whole; apply: add_one_by_one; rewrite ?enum_uniq //.
- by rewrite /contributed !imset0 n0 mulr0.
- by move=> i _; rewrite in_set0.
move=> i T _ iT _ _ _; rewrite expr2 -mulrA.
apply: le_trans (_ : (1 - c) * marginal phi (o i) (contributed u (heard i)) <= _).
  by apply: ler_wpmul2l => //; apply: curv; [apply: ex | apply: ex | apply: out | apply: out].
apply: le_trans (_ : (1 - c) * marginal phi (u i) (contributed u (heard i)) <= _).
  by apply: ler_wpmul2l => //; apply: gains_more.
by apply: curv; [apply: ex | apply: ex | apply: out | apply: out].
Qed.

Section Submodular.
Variable k : F.
Hypotheses (k0 : 0 <= k) (k1 : k <= 1) (mono : non_decreasing t phi).
Hypotheses (sub : submodular t phi) (curv : curvature_at_most t phi k).
Let s0 : 0 <= 1 - k. Proof. by rewrite subr_ge0. Qed.

(** Robots of a list are worth no less than what each adds at least beside those before it. *)
Lemma at_least_sum (v : R -> F) (r : seq R) : uniq r ->
  {in r, forall i, v i <= marginal phi (u i) (contributed u [set j in take (index i r) r])} ->
  \sum_(i <- r) v i <= phi (contributed u [set i in r]).
Proof.
elim/last_ind: r => [|r i IH] ur step.
  by rewrite big_nil (_ : [set _ in [::]] = set0) /contributed ?imset0 ?n0 //; apply/setP => j; rewrite !inE.
move: ur; rewrite rcons_uniq => /andP[ir ur].
have eqS : [set j in rcons r i] = i |: [set j in r] by apply/setP => j; rewrite !inE mem_rcons in_cons.
have tki : take (index i (rcons r i)) (rcons r i) = r.
  by rewrite -cats1 index_cat (negbTE ir) /= eqxx addn0 take_size_cat.
have prev : \sum_(j <- r) v j <= phi (contributed u [set j in r]).
  apply: IH => // j jr; have tk : take (index j (rcons r i)) (rcons r i) = take (index j r) r.
    by rewrite -cats1 index_cat jr takel_cat // index_size.
  by have := step j; rewrite tk; apply; rewrite mem_rcons in_cons jr orbT.
have := step i; rewrite tki mem_rcons mem_head => /(_ isT) last.
rewrite -cats1 big_cat big_seq1 /= cats1 eqS contributedU1 addrC.
by rewrite -(subrK (phi (contributed u [set j in r])) (phi (u i |: _))); apply: ler_add last prev.
Qed.

Let alone i : phi [set o i] = marginal phi (o i) set0. Proof. by rewrite /marginal setU0 n0 subr0. Qed.

Lemma alone_ge0 p i : is_plan t p -> 0 <= phi [set p i].
Proof.
move=> okp; rewrite -n0; apply: mono; last exact: sub0set.
have i0 : i \notin set0 by rewrite in_set0.
by have := ex okp i0 okp; rewrite /contributed imset0 setU0.
Qed.

Lemma at_most_sum (r : seq R) : uniq r -> phi (contributed o [set i in r]) <= \sum_(i <- r) phi [set o i].
Proof.
elim/last_ind: r => [|r i IH] ur.
  by rewrite big_nil (_ : [set _ in [::]] = set0) /contributed ?imset0 ?n0 //; apply/setP => j; rewrite !inE.
move: ur; rewrite rcons_uniq => /andP[ir ur].
have eqS : [set j in rcons r i] = i |: [set j in r] by apply/setP => j; rewrite !inE mem_rcons in_cons.
rewrite -cats1 big_cat big_seq1 /= cats1 eqS contributedU1 addrC.
rewrite -(subrK (phi (contributed o [set j in r])) (phi (o i |: _))); apply: ler_add; last exact: IH.
have iT : i \notin [set j in r] by rewrite inE.
by rewrite alone; apply: sub (sub0set _); [apply: ex | apply: out].
Qed.

(** What robot [i] adds, at least: beside robots that it heard, beside any if it heard nobody, beside any at all. *)
Lemma adds_heard i T : T \subset heard i -> (1 - k) * phi [set o i] <= marginal phi (u i) (contributed u T).
Proof.
move=> Th; apply: le_trans (_ : marginal phi (o i) (contributed u (heard i)) <= _).
  by apply: curv; [apply: ex | apply: out].
apply: le_trans (gains_more i) _; apply: sub; [exact: ex | exact: out | exact: imsetS].
Qed.

Lemma adds_any i T : i \notin T -> (1 - k) * phi [set u i] <= marginal phi (u i) (contributed u T).
Proof. by move=> iT; apply: curv; [apply: ex | apply: out]. Qed.

Lemma adds_bait i T : heard i = set0 -> i \notin T -> (1 - k) * phi [set o i] <= marginal phi (u i) (contributed u T).
Proof.
move=> h0 iT; apply: le_trans (adds_any iT); apply: ler_wpmul2l => //.
by have := gains_more i; rewrite h0 /contributed imset0 /marginal !setU0 n0 !subr0.
Qed.

Lemma adds_deaf i T : i \notin T -> (1 - k) ^+ 2 * phi [set o i] <= marginal phi (u i) (contributed u T).
Proof.
move=> iT; rewrite expr2 -mulrA; apply: le_trans (adds_any iT); apply: ler_wpmul2l => //.
apply: le_trans (adds_heard (fintype.subxx _)) _.
rewrite (_ : phi [set u i] = marginal phi (u i) set0); last by rewrite /marginal setU0 n0 subr0.
by apply: sub (sub0set _); [apply: ex | apply: out].
Qed.

(** The share of its own value that robot [i] adds if the robots of [g] come first, in turn. *)
Definition share (g : seq R) i : F := if (i \in g) || (heard i == set0) then 1 - k else (1 - k) ^+ 2.

Lemma one_group g S : heard_in_turn heard g -> \sum_(i in S) share g i * phi [set o i] <= phi (contributed u S).
Proof.
case=> ug turn; set r := [seq i <- g | i \in S] ++ [seq i <- enum S | i \notin g].
have ur : uniq r.
  rewrite cat_uniq (filter_uniq _ ug) (filter_uniq _ (enum_uniq _)) andbT /=; apply/hasPn => i.
  by rewrite mem_filter => /andP[/negbTE ig _] /=; rewrite mem_filter ig andbF.
have eqS : S = [set i in r].
  apply/setP => i; rewrite inE mem_cat 2!mem_filter mem_enum.
  by case: (i \in S); case: (i \in g); rewrite ?andbF ?andbT.
have -> : \sum_(i in S) share g i * phi [set o i] = \sum_(i <- r) share g i * phi [set o i].
  rewrite -big_enum; apply: perm_big; apply: uniq_perm => [||i]; rewrite ?enum_uniq // mem_enum.
  by rewrite {1}eqS inE.
rewrite [X in contributed u X]eqS; apply: (at_least_sum ur) => i ir; rewrite /share.
have iT : i \notin [set j in take (index i r) r] by rewrite inE take_index_notin.
case: ifP => [/orP[ig|/eqP h0]|_]; [|exact: adds_bait|exact: adds_deaf].
have iS : i \in S by rewrite eqS inE.
apply: adds_heard; apply: fintype.subset_trans (turn i ig); apply/subsetP => j; rewrite !inE.
have ia : i \in [seq i <- g | i \in S] by rewrite mem_filter iS.
rewrite /r index_cat ia takel_cat ?index_size //.
have nin : i \notin [seq j <- take (index i g) g | j \in S].
  by rewrite mem_filter (negbTE (take_index_notin g i)) andbF.
have -> : [seq j <- g | j \in S] = [seq j <- take (index i g) g | j \in S] ++ i :: [seq j <- drop (index i g).+1 g | j \in S].
  by rewrite -{1}(cat_take_drop (index i g) g) filter_cat (drop_nth i) ?index_mem // nth_index //= iS.
by rewrite index_cat (negbTE nin) /= eqxx addn0 take_size_cat // mem_filter => /andP[].
Qed.

(** With [Q] cliques that cover the listeners, [1 - k + k / Q] of what hearing everybody is sure of. *)
Theorem heard_submodular groups S : covers_listeners heard groups -> (0 < size groups)%N ->
  (1 - k) * ((size groups)%:R * (1 - k) + k) * phi (contributed o S) <= (size groups)%:R * phi (contributed u S).
Proof.
case=> turns covered Q0; set Q := (size groups)%:R; set s := 1 - k.
have Q1 : 1 <= Q :> F by rewrite ler1n.
have w0 : 0 <= s * (Q * s + k) by apply: mulr_ge0 => //; apply: addr_ge0 => //; apply: mulr_ge0 => //; exact: ler0n.
have step : \sum_(g <- groups) \sum_(i in S) share g i * phi [set o i] <= Q * phi (contributed u S).
  have -> : Q * phi (contributed u S) = \sum_(g <- groups) phi (contributed u S).
    by rewrite big_const_seq count_predT iter_addr_0 /Q mulr_natl.
  rewrite big_seq [X in _ <= X]big_seq; apply: ler_sum => g /turns turn; exact: one_group.
apply: le_trans step; rewrite exchange_big /=.
apply: (@le_trans _ _ (s * (Q * s + k) * (\sum_(i in S) phi [set o i]))).
  apply: ler_wpmul2l => //; have := at_most_sum (enum_uniq (mem S)).
  by rewrite (_ : [set i in enum S] = S) ?big_enum //; apply/setP => i; rewrite inE mem_enum.
rewrite mulr_sumr; apply: ler_sum => i _; rewrite -mulr_suml; apply: ler_wpmul2r; first exact: alone_ge0.
have all_bait : heard i = set0 -> \sum_(g <- groups) share g i = Q * s.
  move=> h0; rewrite (eq_bigr (fun=> s)) => [|g _]; last by rewrite /share h0 eqxx orbT.
  by rewrite big_const_seq count_predT iter_addr_0 mulr_natl.
case: (covered i) => [h0|[g0 g0in ig0]].
  rewrite all_bait // [Q * s]mulrC; apply: ler_wpmul2l => //; rewrite -subr_ge0.
  rewrite (_ : _ - _ = k * (Q - 1)); last by rewrite /s; ring.
  by apply: mulr_ge0; rewrite // subr_ge0.
have low g : s ^+ 2 <= share g i.
  rewrite /share; case: ifP => // _; rewrite -/s expr2 -[X in _ <= X]mulr1; apply: ler_wpmul2l => //.
  by rewrite /s ler_subl_addr ler_addl.
rewrite (perm_big _ (perm_to_rem g0in)) big_cons /= {1}/share ig0 /= -/s.
apply: le_trans (_ : s + (Q - 1) * s ^+ 2 <= _).
  by rewrite -subr_ge0 (_ : _ - _ = 0) // /s; ring.
rewrite ler_add2l; have -> : (Q - 1) * s ^+ 2 = \sum_(g <- rem g0 groups) s ^+ 2.
  rewrite big_const_seq count_predT iter_addr_0 size_rem // -[RHS]mulr_natl; congr (_ * _).
  by rewrite /Q -[in LHS](prednK Q0) -addn1 natrD addrK.
by apply: ler_sum => g _; apply: low.
Qed.
End Submodular.
End Proofs.

(** ** After the worst attack *)
Section Guarantees.
Variables (F : realDomainType) (R E : finType) (t : team R E) (phi : {set E} -> F).
Hypothesis n0 : normalised phi.

Theorem split_total_curvature c u heard : R -> c <= 1 -> total_curvature_at_most t phi c ->
  best_heard t phi u heard -> (1 - c) ^+ 2 * optimum t phi <= worst_case t phi u.
Proof.
move=> i0 c1 curv best; have [okp _ _] := best.
have [[o oko <-] _] := optimumP phi okp.
by apply: share_of_worst_case; rewrite ?sqr_ge0 // => S; apply: heard_total_curvature best oko _ _ _ _.
Qed.
End Guarantees.

Section Cliques.
Variables (F : realFieldType) (R E : finType) (t : team R E) (phi : {set E} -> F).

Theorem split_submodular k u heard groups : R -> 0 <= k <= 1 -> normalised phi -> non_decreasing t phi ->
  submodular t phi -> curvature_at_most t phi k -> best_heard t phi u heard -> covers_listeners heard groups ->
  (0 < size groups)%N -> (1 - k) * (1 - k + k / (size groups)%:R) * optimum t phi <= worst_case t phi u.
Proof.
move=> i0 /andP[k0 k1] n0 mono sub curv best covered Q0; have [okp _ _] := best.
have [[o oko <-] _] := optimumP phi okp; have Qp : 0 < (size groups)%:R :> F by rewrite ltr0n.
apply: share_of_worst_case => // [|S].
  by apply: mulr_ge0; rewrite ?subr_ge0 // addr_ge0 ?subr_ge0 // divr_ge0 ?ler0n.
rewrite -(ler_pmul2l Qp); apply: le_trans (heard_submodular n0 best oko k0 k1 mono sub curv S covered Q0).
rewrite -subr_ge0 (_ : _ - _ = 0) //; field; exact: lt0r_neq0.
Qed.
End Cliques.

(** ** Components that plan alone, and the size of groups

    Each component gives the first [alpha_s + 1] of its own robots, by individual value, their individually best elements.
    RATT in a component does so with [alpha_s] baits already: the first greedy robot chooses beside nothing. *)
Section Components.
Variables (F : realFieldType) (R E : finType) (t : team R E) (phi : {set E} -> F) (default : E) (g : nat).
Variables (K : eqType) (component : R -> K) (u : {ffun R -> E}).
Let order := by_value t phi default.
Definition before_in_component i : {set R} :=
  [set j | (component j == component i) && (index j order < index i order)%N].

Hypothesis every_robot_owns : forall i, exists x, owner t x = i.
Hypothesis robots : (alpha_s t < #|R|)%N.
Hypotheses (n0 : normalised phi) (mono : non_decreasing t phi) (oku : is_plan t u).
Hypothesis first_ones : forall i, (#|before_in_component i| <= alpha_s t)%N ->
  alone phi (best t phi default i) <= phi [set u i].
Hypothesis reach :
  exists2 a, allowed t a & {subset strongest t phi default <= blinded a} /\ forall i, (#|sees t a i| <= g)%N.

Lemma first_of_team : {in take (alpha_s t).+1 order, forall i, alone phi (best t phi default i) <= phi [set u i]}.
Proof.
move=> i; rewrite in_take ?mem_order // ltnS => ia; apply: first_ones; apply: leq_trans ia.
have sub : before_in_component i \subset take (index i order) order.
  by apply/subsetP => j; rewrite inE => /andP[_ ji]; rewrite in_take ?mem_order.
apply: leq_trans (subset_leq_card sub) _; apply: leq_trans (card_size _) _.
by rewrite size_take; case: ltnP => // /ltnW.
Qed.

Theorem components_submodular : submodular t phi -> optimum t phi <= g%:R * worst_case t phi u.
Proof.
move=> sub; have [i0 _] : exists i0 : R, i0 \in R by apply/card_gt0P; apply: leq_ltn_trans robots.
exact: (baits_submodular i0 every_robot_owns robots n0 mono reach oku first_of_team sub).
Qed.

Theorem components_total_curvature c : c <= 1 -> (0 < g)%N -> total_curvature_at_most t phi c ->
  (1 - c) * optimum t phi <= (g.-1%:R + (1 - c)) * worst_case t phi u.
Proof.
move=> c1 g0 curv; have [i0 _] : exists i0 : R, i0 \in R by apply/card_gt0P; apply: leq_ltn_trans robots.
exact: (baits_total_curvature i0 every_robot_owns robots n0 mono reach oku first_of_team c1 g0 curv).
Qed.
End Components.
