(** [1 - k] is attained: for every [m >= 1] and [0 <= k <= 1 - 1/m] a weighted coverage function of curvature at most
    [k] on [3m] robots, [m] of them blinded, on which RATT, the function, keeps exactly [1 - k] of the optimum. *)
From mathcomp Require Import all_ssreflect all_algebra.
From mathcomp.algebra_tactics Require Import ring.
From Ratt Require Import Extrema Teams Guarantees Planner Ties.
Set Implicit Arguments.
Unset Strict Implicit.
Unset Printing Implicit Defensive.
Import Order.Theory GRing.Theory Num.Theory.
Local Open Scope ring_scope.

Section Coverage.
Variables (F : realFieldType) (E I : finType) (own : E -> F) (size_of : I -> F) (covers : I -> {set E}).
Hypotheses (own_ge0 : forall x, 0 <= own x) (size_ge0 : forall i, 0 <= size_of i).
Implicit Types (A B : {set E}) (x : E).

(** Weighted coverage: each element covers an item of its own, and shared items. *)
Definition hit i A : bool := [exists x in A, x \in covers i].
Definition coverage A : F := \sum_(x in A) own x + \sum_i size_of i * (hit i A)%:R.
(** Shared items of [x] that [A] leaves uncovered. *)
Definition fresh x A : F := \sum_i size_of i * ((x \in covers i) && ~~ hit i A)%:R.

Lemma hitU1 i x A : hit i (x |: A) = (x \in covers i) || hit i A.
Proof.
apply/exists_inP/orP => [[y]|[xi|/exists_inP[y yA yi]]].
- by rewrite in_setU1 => /orP[/eqP->|yA] yi; [left | right; apply/exists_inP; exists y].
- by exists x; rewrite ?setU11.
by exists y; rewrite // in_setU1 yA orbT.
Qed.

Lemma coverage_marginal x A : x \notin A -> marginal coverage x A = own x + fresh x A.
Proof.
move=> xA; rewrite /marginal /coverage big_setU1 //= opprD addrACA addrK -sumrB; congr (_ + _).
apply: eq_bigr => i _; rewrite -mulrBr hitU1; congr (_ * _).
by case: (x \in covers i); case: (hit i A); rewrite /= ?subrr ?subr0.
Qed.

Lemma coverage0 : coverage set0 = 0.
Proof.
rewrite /coverage big_set0 add0r big1 // => i _; rewrite (_ : hit i set0 = false) ?mulr0 //.
by apply/exists_inP => -[x]; rewrite in_set0.
Qed.

Lemma fresh_ge0 x A : 0 <= fresh x A.
Proof. by apply: sumr_ge0 => i _; rewrite mulr_ge0 ?ler0n. Qed.

Lemma fresh_antitone x A B : A \subset B -> fresh x B <= fresh x A.
Proof.
move=> AB; apply: ler_sum => i _; apply: ler_wpmul2l => //; rewrite ler_nat.
case: (x \in covers i) => //=; case hA: (hit i A) => //=; last by case: (hit i B).
suff -> : hit i B by [].
by case/exists_inP: hA => y yA yi; apply/exists_inP; exists y => //; apply: (subsetP AB).
Qed.


Lemma coverage_single x : coverage [set x] = own x + fresh x set0.
Proof.
have := @coverage_marginal x set0; rewrite in_set0 => /(_ isT).
by rewrite /marginal setU0 coverage0 subr0.
Qed.

Variables (R : finType) (t : team R E).

Lemma coverage_submodular : submodular t coverage.
Proof.
move=> x A B _ xB AB; rewrite !coverage_marginal ?ler_add2l ?fresh_antitone //.
by apply: contra xB; apply: (subsetP AB).
Qed.

Lemma coverage_curvature k : (forall x, (1 - k) * coverage [set x] <= own x) -> curvature_at_most t coverage k.
Proof.
move=> h x A _ xA; rewrite coverage_marginal //; apply: le_trans (h x) _.
by rewrite ler_addl fresh_ge0.
Qed.
End Coverage.

Section Mono.
Variables (F : realFieldType) (E I : finType) (own : E -> F) (size_of : I -> F) (covers : I -> {set E}).
Hypotheses (own_ge0 : forall x, 0 <= own x) (size_ge0 : forall i, 0 <= size_of i).
Lemma coverage_mono (A B : {set E}) : A \subset B -> coverage own size_of covers A <= coverage own size_of covers B.
Proof.
move=> AB; apply: ler_add.
  by rewrite [X in _ <= X](big_setID A) /= (setIidPr AB) ler_addl; apply: sumr_ge0.
apply: ler_sum => i _; apply: ler_wpmul2l => //; rewrite ler_nat; case hA: (hit covers i A) => //.
suff -> : hit covers i B by [].
by case/exists_inP: hA => y yA yi; apply/exists_inP; exists y => //; apply: (subsetP AB).
Qed.
End Mono.

(** ** The family *)
Section Family.
Variables (F : realFieldType) (n : nat) (k : F).
Local Notation m := n.+1.
Local Notation t := (1 - k).
Hypotheses (k0 : 0 <= k) (km : m%:R^-1 <= t).

(** Robots: baits [None], removed [Some true], victims [Some false]; elements: the plan's ([true]) and the optimum's. *)
Let R : finType := [finType of option bool * 'I_m].
Let E : finType := [finType of bool * R].
Let I : finType := [finType of bool * 'I_m].

Definition own (x : E) : F :=
  match x with
  | (true, (Some false, _)) => t - k / m%:R
  | (true, _) | (false, (Some false, _)) => t
  | (false, _) => 1
  end.
(** Items [(true, j)] are covered by all baits and victim [j]; [(false, j)] by removed robot [j] and, in the other plan, by
    victim [j]. *)
Definition size_of (i : I) : F := if i.1 then k / m%:R else k.
Definition covered (i : I) (x : E) : bool :=
  match x with
  | (true, (None, _)) => i.1
  | (true, (Some false, j)) => i == (true, j)
  | (true, (Some true, j)) | (false, (Some false, j)) => i == (false, j)
  | _ => false
  end.
Definition covers (i : I) : {set E} := [set x | covered i x].
Definition phi := coverage own size_of covers.

Definition family_team : team R E :=
  Team (fun x : E => x.2) [set l : {set R} | #|l| == 2%N] m 0 set0 set0.
Definition baited : {ffun R -> E} := first_choice R.
Definition other : {ffun R -> E} := [ffun i => (false, i)].
Definition removed : seq R := [seq (Some true, j) | j <- enum 'I_m].
Definition victims : seq R := [seq (Some false, j) | j <- enum 'I_m].
Definition greedy_order : seq R := removed ++ victims.

Lemma t_gt0 : 0 < t.
Proof. by apply: lt_le_trans km; rewrite invr_gt0 ltr0n. Qed.
Lemma size_ge0 i : 0 <= size_of i.
Proof. by rewrite /size_of; case: i.1; rewrite ?divr_ge0 ?ler0n. Qed.
Lemma share_le : k / m%:R <= t * k.
Proof. by rewrite mulrC; apply: ler_wpmul2r. Qed.
Lemma share_sum : (k / m%:R) *+ m = k.
Proof. by rewrite -[LHS]mulr_natr divfK // pnatr_eq0. Qed.
Lemma t_le1 : t <= 1.
Proof. by rewrite ler_subl_addr ler_addl. Qed.
Lemma own_ge0 x : 0 <= own x.
Proof.
have t0 := ltW t_gt0; have s0 : 0 <= t - k / m%:R.
  rewrite subr_ge0; apply: le_trans share_le _; rewrite -[X in _ <= X]mulr1; apply: ler_wpmul2l => //.
  by rewrite -subr_ge0.
by case: x => [[] [[[]|] j]] /=; rewrite ?ler01.
Qed.

Lemma sum_one (T : finType) (f : T -> F) (x : T) (c : F) :
  (forall y, f y = if y == x then c else 0) -> \sum_y f y = c.
Proof. by move=> h; rewrite (bigD1 x) //= h eqxx big1 ?addr0 // => y ne; rewrite h (negbTE ne). Qed.

Lemma fresh_one x A (i : I) : covered i x -> ~~ hit covers i A -> size_of i <= fresh size_of covers x A.
Proof.
move=> ci nh; rewrite /fresh (bigD1 i) //= inE ci nh mulr1 ler_addl; apply: sumr_ge0 => j _.
by rewrite mulr_ge0 ?ler0n ?size_ge0.
Qed.

Lemma fresh_none x A : (forall i, covered i x -> hit covers i A) -> fresh size_of covers x A = 0.
Proof.
move=> h; rewrite /fresh big1 // => i _; rewrite inE; case ci: (covered i x); rewrite ?mulr0 //.
by rewrite (h _ ci) mulr0.
Qed.

Lemma hit0 i : hit covers i set0 = false.
Proof. by apply/exists_inP => -[x]; rewrite in_set0. Qed.

(** Single values: 1, but [t] for the victims' elements in the plan. *)
Lemma single x : phi [set x] = if x is (true, (Some false, _)) then t else 1.
Proof.
rewrite /phi (coverage_single _ _ _ x) /fresh.
case: x => [[] [[[]|] j]] /=.
- rewrite (@sum_one _ _ (false, j) k) ?subrK // => i; rewrite inE hit0 andbT /=.
  by case: eqP => [->|_]; rewrite ?mulr0 ?mulr1.
- rewrite (@sum_one _ _ (true, j) (k / m%:R)) ?subrK // => i; rewrite inE hit0 andbT /=.
  by case: eqP => [->|_]; rewrite ?mulr0 ?mulr1.
- rewrite (eq_bigr (fun i : I => if i.1 then k / m%:R else 0)); last first.
    by move=> i _; rewrite inE hit0 andbT /= /size_of; case: i.1; rewrite ?mulr0 ?mulr1.
  rewrite -(pair_bigA _ (fun (b : bool) (j : 'I_m) => if b then k / m%:R else 0)) /= big_bool /= [X in _ + (_ + X)]big1 // addr0.
  by rewrite sumr_const card_ord share_sum subrK.
- by rewrite big1 ?addr0 // => i _; rewrite inE /= mulr0.
- rewrite (@sum_one _ _ (false, j) k) ?subrK // => i; rewrite inE hit0 andbT /=.
  by case: eqP => [->|_]; rewrite ?mulr0 ?mulr1.
by rewrite big1 ?addr0 // => i _; rewrite inE /= mulr0.
Qed.

Lemma family_curvature : curvature_at_most family_team phi k.
Proof.
apply: coverage_curvature => [|x]; first exact: size_ge0.
rewrite -/phi single; have t0 := ltW t_gt0; case: x => [[] [[[]|] j]] /=; rewrite ?mulr1 ?t_le1 //.
rewrite ler_subr_addl; apply: le_trans (ler_add share_le (lexx _)) _.
by rewrite -mulrDr [k + _]addrC subrK mulr1.
Qed.

Lemma baited_plan : is_plan family_team baited.
Proof. by apply/forallP => i; rewrite ffunE. Qed.
Lemma other_plan : is_plan family_team other.
Proof. by apply/forallP => i; rewrite ffunE. Qed.

Lemma mem_removed b j : ((b, j) \in removed) = (b == Some true).
Proof.
apply/mapP/eqP => [[j' _ [-> _]] //|->]; by exists j; rewrite ?mem_enum.
Qed.
Lemma mem_victims b j : ((b, j) \in victims) = (b == Some false).
Proof.
apply/mapP/eqP => [[j' _ [-> _]] //|->]; by exists j; rewrite ?mem_enum.
Qed.

Lemma before_removed j x : x \in take (index (Some true, j) greedy_order) greedy_order -> x \in removed.
Proof.
have lt : (index (Some true, j) removed < size removed)%N by rewrite index_mem mem_removed.
by rewrite /greedy_order index_cat mem_removed eqxx takel_cat ?(ltnW lt) // => /mem_take.
Qed.
Lemma before_victim j x : x \in removed -> x \in take (index (Some false, j) greedy_order) greedy_order.
Proof. by rewrite /greedy_order index_cat mem_removed /= take_cat ltnNge leq_addr /= mem_cat => ->. Qed.

Lemma before_true g i x : x \in before baited g i -> x = (true, x.2) /\ x.2 \in take (index i g) g.
Proof. by case/imsetP => j; rewrite inE => jt ->; rewrite ffunE. Qed.

Lemma sum_pairs (A B : finType) (f : A * B -> F) : \sum_i f i = \sum_a \sum_b f (a, b).
Proof. by rewrite pair_bigA; apply: eq_bigr => -[]. Qed.

Lemma sum_roles (f : R -> F) : \sum_i f i = \sum_j f (None, j) + \sum_j f (Some true, j) + \sum_j f (Some false, j).
Proof.
rewrite sum_pairs (bigD1 None) //= (bigD1 (Some true)) //= (bigD1 (Some false)) //=.
by rewrite [X in _ + (_ + (_ + X))]big1 ?addr0 ?addrA // => -[[]|].
Qed.

(** Blinding the removed robots leaves [2 m t]. *)
Lemma baited_value : phi (contributed baited (~: [set i | i \in removed])) <= (2 * m)%:R * t.
Proof.
rewrite /phi /coverage big_imset /=; last by move=> i j _ _; rewrite !ffunE => -[].
rewrite big_mkcond sum_roles /=.
rewrite (eq_bigr (fun=> t)) => [|j _]; last by rewrite in_setC in_set mem_removed /= ffunE.
rewrite [X in _ + X + _ + _]big1 ?addr0 => [|j _]; last by rewrite in_setC in_set mem_removed.
rewrite [X in _ + X + _](eq_bigr (fun=> t - k / m%:R)) => [|j _]; last by rewrite in_setC in_set mem_removed /= ffunE.
apply: (@le_trans _ _ (\sum_(j < m) t + \sum_(j < m) (t - k / m%:R) + k)).
  rewrite ler_add2l sum_pairs big_bool /=.
  rewrite [X in _ + X]big1 ?addr0 => [|j _].
    apply: (@le_trans _ _ (\sum_(j < m) k / m%:R)).
      by apply: ler_sum => j _; rewrite ler_pimulr ?divr_ge0 ?ler0n // lern1; case: hit.
    by rewrite sumr_const card_ord share_sum.
  rewrite (_ : hit _ _ _ = false) ?mulr0 //; apply/exists_inP => -[x /imsetP[[b i]]].
  by rewrite in_setC in_set mem_removed ffunE => nb ->; rewrite inE /=; case: b nb => [[]|].
rewrite !sumr_const card_ord [in X in _ + X + _]mulrnBl share_sum -addrA subrK.
by rewrite mul2n -addnn natrD mulrDl !mulr_natl.
Qed.

Lemma baited_worst : worst_case family_team phi baited <= (2 * m)%:R * t.
Proof.
pose a : attack R := ([set i | i \in removed], set0).
have oka : allowed family_team a.
  apply/and5P; split; rewrite ?sub0set ?cards0 //=.
  - by rewrite cardsE; apply: leq_trans (card_size _) _; rewrite size_map size_enum_ord.
  - by rewrite disjoint_subset; apply/subsetP => x _; rewrite !inE.
  by rewrite disjoint_subset; apply/subsetP => x _; rewrite !inE.
apply: le_trans (worst_case_le phi baited oka) _; apply: team_value_le; first exact: (None, ord0).
move=> i; apply: le_trans baited_value; apply: coverage_mono; [exact: own_ge0 | exact: size_ge0 |].
by apply: imsetS; apply/subsetP => j; rewrite !inE => /andP[].
Qed.

Lemma other_value (S : {set R}) : #|S|%:R <= phi (contributed other S).
Proof.
rewrite /phi /coverage big_imset /=; last by move=> i j _ _; rewrite !ffunE => -[].
have -> : #|S|%:R = \sum_(i in S) own (other i) + \sum_(i in S) (if i.1 == Some false then k else 0).
  rewrite -big_split /= -sumr_const; apply: eq_bigr => -[b j] _; rewrite ffunE.
  by case: b => [[]|] /=; rewrite ?addr0 ?subrK.
rewrite ler_add2l big_mkcond sum_roles /= big1 ?add0r => [|j _]; last by case: ifP.
rewrite big1 ?add0r => [|j _]; last by case: ifP.
rewrite [X in _ <= X]sum_pairs big_bool /=.
rewrite ler_paddl //; first by apply: sumr_ge0 => j _; apply: mulr_ge0; [exact: size_ge0 | exact: ler0n].
apply: ler_sum => j _ /=; case: ifP => jS; last by apply: mulr_ge0; [exact: size_ge0 | exact: ler0n].
suff -> : hit covers (false, j) (contributed other S) by rewrite mulr1; apply: lexx.
apply/exists_inP; exists (false, (Some false, j)); last by rewrite inE /= eqxx.
by apply/imsetP; exists (Some false, j); rewrite ?ffunE.
Qed.

Lemma card_robots : #|R| = (3 * m)%N.
Proof. by rewrite card_prod card_option card_bool card_ord. Qed.

Lemma other_worst : (2 * m)%:R <= worst_case family_team phi other.
Proof.
apply: le_worst_case => a /and5P[bl cb _ _ _]; pose i0 : R := (None, ord0).
apply: le_trans (le_team_value family_team phi other a i0); apply: le_trans (other_value _); rewrite ler_nat.
have noc : cut a = set0 by apply/eqP; rewrite -cards_eq0 -leqn0.
have -> : sees family_team a i0 = ~: blinded a.
  apply/setP => j; rewrite !inE; case: (_ \in _) => //=; have [<-|ne] := eqVneq i0 j; first exact: connect0.
  by apply: connect1; rewrite /linked noc setD0 inE cards2 ne.
rewrite -(leq_add2l #|blinded a|) cardsC card_robots -[X in (_ <= X)%N]/((1 + 2) * m)%N mulnDl mul1n leq_add2r.
exact: bl.
Qed.

(** ** RATT, with its ties, returns that plan *)
Definition default : E := (true, (None, ord0)).
Definition baits : seq R := [seq (None, j) | j <- enum 'I_m].

Lemma enum_robots : enum R = baits ++ greedy_order.
Proof. by rewrite /R enum_pair enum_option enum_bool /= cats0. Qed.

Lemma every_robot_owns i : exists x, owner family_team x = i.
Proof. by exists (true, i). Qed.

Lemma bait_true j : best family_team phi default (None, j) = (true, (None, j)).
Proof. by apply: best_first => //; rewrite !single. Qed.

Lemma best_value i : alone phi (best family_team phi default i) = 1.
Proof.
have h b : alone phi (b, i) <= 1 by rewrite /alone single; case: b i => [] [[[]|] j]; rewrite ?t_le1.
apply: le_anti; apply/andP; split.
  by case: (best _ _ _ i) (owner_best phi default every_robot_owns i) => b r /= ->; apply: h.
have := best_max family_team phi default (false, i).
by rewrite [X in X <= _]/alone single; case: i {h} => [[[]|] j].
Qed.

Lemma baitE : bait family_team phi default m = baits.
Proof.
rewrite /bait (by_value_flat (c := 1)) => [|i]; last exact: best_value.
by rewrite enum_robots take_size_cat // size_map size_enum_ord.
Qed.

(** What greedy adds to its picks: nothing among the robots left is better, and ties go to the plan's elements. *)
Lemma marginal_single x (A : {set E}) : x \notin A -> marginal phi x A <= phi [set x].
Proof.
move=> xA; rewrite /phi coverage_marginal // coverage_single ler_add2l.
by apply: fresh_antitone; [exact: size_ge0 | exact: sub0set].
Qed.

Lemma family_ratt : ratt family_team phi default m = baited.
Proof.
apply: (@ratt_first_choice _ _ _ _ _ _ m greedy_order) => // [|[b j]|r z rg zg zt].
- rewrite enum_robots filter_cat baitE; set s1 := filter _ _; set s2 := filter _ _.
  have -> : s1 = [::] by rewrite /s1 -(filter_pred0 baits); apply: eq_in_filter => i ->.
  rewrite cat0s /s2; apply/esym/all_filterP/allP => -[b j].
  by rewrite mem_cat mem_removed mem_victims => ig; apply/mapP => -[k' _ [eb _]]; rewrite eb in ig.
- by rewrite baitE => /mapP[k' _ [-> _]]; apply: bait_true.
rewrite -/baited; set B := before _ _ _.
have inB x : x \in B -> x = (true, x.2) /\ x.2 \in take (index r greedy_order) greedy_order by apply: before_true.
have zB : z \notin B by apply: contra zt => /inB[].
have rB : (true, r) \notin B by apply/negP => /inB[_]; apply/negP; apply: take_index_notin.
rewrite -(ler_add2r (- phi B)) -!/(marginal phi _ _).
have own_item : t - k / m%:R + k / m%:R = t by rewrite subrK.
case: r rg zt @B inB zB rB => b j; rewrite mem_cat mem_removed mem_victims => /orP[] /eqP -> zt B inB zB rB.
  apply: le_trans (marginal_single zB) _; apply: (@le_trans _ _ 1).
    by rewrite single; case: (z) => [[] [[[]|] q]]; rewrite ?t_le1.
  rewrite coverage_marginal //= -[X in X <= _](subrK k) ler_add2l.
  apply: (@fresh_one _ _ (false, j)); first by rewrite /= eqxx.
  apply/exists_inP => -[x xB]; have [-> xt] := inB _ xB; rewrite inE /=.
  have := before_removed xt; case: (x.2) xt => [b' j'] xt; rewrite mem_removed => /eqP eb; subst b' => /= /eqP[e].
  by move: (take_index_notin greedy_order (Some true, j)); rewrite {1}e xt.
apply: (@le_trans _ _ t).
  case: z zg zt zB => c [b' q]; rewrite mem_cat mem_removed mem_victims => /orP[] /eqP /= -> zt zB.
    by case/negP: zt; apply: before_victim; rewrite mem_removed.
  case: c zB => zB; first by apply: le_trans (marginal_single zB) _; rewrite single.
  rewrite coverage_marginal //= fresh_none ?addr0 // => i /= /eqP ->.
  apply/exists_inP; exists (true, (Some true, q)); last by rewrite inE /= eqxx.
  apply/imsetP; exists (Some true, q); last by rewrite ffunE.
  by rewrite inE; apply: before_victim; rewrite mem_removed.
rewrite coverage_marginal //= -[X in X <= _]own_item ler_add2l.
apply: (@fresh_one _ _ (true, j)); first by rewrite /= eqxx.
apply/exists_inP => -[x xB]; have [-> xt] := inB _ xB; rewrite inE /=.
have := mem_take xt; case: (x.2) xt => [b' j'] xt; rewrite mem_cat mem_removed mem_victims.
case/orP=> /eqP eb; subst b' => //= /eqP[e].
by move: (take_index_notin greedy_order (Some false, j)); rewrite {1}e xt.
Qed.

(** The ratio is [1 - k] exactly, and the optimum is positive. *)
Theorem one_minus_k_attained :
  [/\ normalised phi, submodular family_team phi, curvature_at_most family_team phi k, 0 < optimum family_team phi
    & worst_case family_team phi (ratt family_team phi default m) = (1 - k) * optimum family_team phi].
Proof.
rewrite family_ratt.
have n0 : normalised phi := coverage0 _ _ _.
have sub : submodular family_team phi by apply: coverage_submodular; apply: size_ge0.
have opt : (2 * m)%:R <= optimum family_team phi.
  have [_ best] := optimumP phi baited_plan; exact: le_trans other_worst (best _ other_plan).
split=> //; [exact: family_curvature | by apply: lt_le_trans opt; rewrite ltr0n |].
apply: le_anti; have curv := family_curvature; rewrite -[X in _ && (_ <= worst_case _ _ X)]family_ratt.
rewrite (ratt_submodular default every_robot_owns m (None, ord0)) ?andbT //.
  by apply: le_trans baited_worst _; rewrite mulrC; apply: ler_wpmul2l => //; apply: ltW t_gt0.
by rewrite -subr_ge0 ltW ?t_gt0.
Qed.
End Family.
