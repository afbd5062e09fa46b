(** What RATT returns where ties decide: two elements for each robot, [(true, i)] listed before [(false, i)]. *)
From mathcomp Require Import all_ssreflect all_algebra.
From Ratt Require Import Extrema Teams Guarantees Planner.
Set Implicit Arguments.
Unset Strict Implicit.
Unset Printing Implicit Defensive.
Import Order.Theory GRing.Theory Num.Theory.
Local Open Scope ring_scope.

Lemma enum_pair (A B : finType) : enum [finType of A * B] = [seq (a, b) | a <- enum A, b <- enum B].
Proof. by rewrite enumT unlock. Qed.
Lemma enum_bool : enum bool_finType = [:: true; false].
Proof. by rewrite enumT unlock. Qed.
Lemma enum_option (T : finType) : enum (option_finType T) = None :: map some (enum T).
Proof. by rewrite enumT unlock /= /option_enum -enumT. Qed.

(** The first of the list stays where no other is larger. *)
Lemma first_max_head (F : realDomainType) (T : eqType) (f : T -> F) x s :
  (forall y, y \in s -> f y <= f x) -> first_max f x s = x.
Proof.
elim: s => [//|y s IH] h; rewrite /first_max /= ifF; last by rewrite ltNge h ?mem_head.
by apply: IH => z zs; apply: h; rewrite in_cons zs orbT.
Qed.

Section Two.
Variables (F : realDomainType) (R : finType) (t : team R [finType of bool * R]) (phi : {set bool * R} -> F).
Variable default : bool * R.
Hypothesis owner_second : forall x, owner t x = x.2.

Definition first_choice : {ffun R -> bool * R} := [ffun i => (true, i)].
Definition both (rs : seq R) : seq (bool * R) := [seq (true, i) | i <- rs] ++ [seq (false, i) | i <- rs].

Lemma enum_both : enum [finType of bool * R] = both (enum R).
Proof. by rewrite enum_pair enum_bool /both /= cats0. Qed.

Lemma filter_both (P : pred R) rs : [seq z <- both rs | P (owner t z)] = both [seq i <- rs | P i].
Proof.
by rewrite /both filter_cat !filter_map; congr (_ ++ _); congr map; apply: eq_filter => i /=; rewrite owner_second.
Qed.

Lemma own_two i : own t i = [:: (true, i); (false, i)].
Proof. by rewrite /own enum_both (filter_both (pred1 i)) filter_pred1_uniq ?enum_uniq ?mem_enum. Qed.

Lemma best_first i : phi [set (false, i)] <= phi [set (true, i)] -> best t phi default i = (true, i).
Proof. by move=> h; rewrite /best own_two; apply: first_max_head => y; rewrite inE => /eqP ->. Qed.

(** Where the best elements are worth the same, the robots keep their order. *)
Lemma by_value_flat c : (forall i, alone phi (best t phi default i) = c) -> by_value t phi default = enum R.
Proof.
move=> h; apply: sorted_sort => [x y z _ _|]; first by rewrite !h lexx.
by case: (enum R) => [//|x s]; apply/(pathP x) => i _; rewrite !h lexx.
Qed.

Lemma greedy_heads n rs A : (size rs <= n)%N -> uniq rs ->
  (forall l r l', rs = l ++ r :: l' -> forall z, z.2 \in r :: l' ->
     phi (z |: (A :|: [set (true, i) | i in l])) <= phi ((true, r) |: (A :|: [set (true, i) | i in l]))) ->
  greedy_picks t phi n (both rs) A = [seq (true, i) | i <- rs].
Proof.
elim: n rs A => [|n IH] [|r rs] A // sn /andP[rn u] h; rewrite [both _]/= greedy_picksS; cbv zeta.
have -> : first_max (fun z => phi (z |: A)) (true, r) ([seq (true, i) | i <- rs] ++ [seq (false, i) | i <- r :: rs]) = (true, r).
  apply: first_max_head => z zin; have := h [::] r rs erefl z.
  rewrite (_ : [set (true, i) | i in [::]] = set0) ?setU0; last by apply/setP => x; rewrite inE; apply/imsetP => -[i].
  apply; rewrite -[r :: rs]/([:: r] ++ rs) mem_cat; move: zin; rewrite mem_cat => /orP[] /mapP[i ir ->] /=.
    by rewrite ir orbT.
  by move: ir; rewrite in_cons mem_seq1.
rewrite -[_ :: _ ++ _]/(both (r :: rs)) owner_second (filter_both (fun i => i != r)) /= eqxx /=.
have -> : [seq i <- rs | i != r] = rs.
  by apply/all_filterP/allP => i ir; apply: contraNneq rn => <-.
congr (_ :: _); apply: IH => // l r' l' e z zl.
have := h (r :: l) r' l' _ z zl; rewrite e => /(_ erefl).
suff -> : A :|: [set (true, i) | i in r :: l] = (true, r) |: A :|: [set (true, i) | i in l] by [].
rewrite [_ |: A]setUC -setUA; congr (_ :|: _); apply/setP => x; rewrite !inE; apply/imsetP/orP.
  by case=> i; rewrite in_cons => /orP[/eqP ->|il] ->; [left | right; apply: imset_f].
by case=> [/eqP ->|/imsetP[i il ->]]; [exists r | exists i]; rewrite ?mem_head // in_cons il orbT.
Qed.

(** RATT takes every robot's first element if its baits do and greedy finds none better among the robots left. *)
Lemma ratt_first_choice alpha (rs : seq R) : rs = [seq i <- enum R | i \notin bait t phi default alpha] ->
  (forall i, i \in bait t phi default alpha -> best t phi default i = (true, i)) ->
  (forall r z, r \in rs -> z.2 \in rs -> z.2 \notin take (index r rs) rs ->
     phi (z |: before first_choice rs r) <= phi ((true, r) |: before first_choice rs r)) ->
  ratt t phi default alpha = first_choice.
Proof.
move=> rsE hb hg; have ur : uniq rs by rewrite rsE filter_uniq ?enum_uniq.
have picks : ratt_picks t phi default alpha = [seq (true, i) | i <- rs].
  rewrite /ratt_picks enum_both (filter_both (fun i => i \notin bait t phi default alpha)) -rsE; apply: greedy_heads => //.
    by rewrite rsE size_filter; apply: leq_trans (count_size _ _) _; rewrite -cardE.
  move=> l r l' e z zl; have rl : r \notin l by move: ur; rewrite e cat_uniq /= negb_or => /and3P[_ /andP[]].
  have tk : take (index r rs) rs = l by rewrite e index_cat (negbTE rl) /= eqxx addn0 take_size_cat.
  have beforeE : before first_choice rs r = set0 :|: [set (true, i) | i in l].
    rewrite /before tk set0U /contributed; apply/setP => x; apply/imsetP/imsetP => -[i il ->]; exists i;
      by move: il; rewrite ?inE ?ffunE.
  rewrite -beforeE; apply: hg; rewrite ?tk ?e ?mem_cat ?mem_head ?zl ?orbT //.
  move: ur; rewrite e cat_uniq => /and3P[_ /hasPn h _]; exact: h.
apply/ffunP => i; rewrite !ffunE; case: ifP => ib; first exact: hb.
rewrite picks filter_map (eq_filter (a2 := pred1 i)); last by move=> j; rewrite /= owner_second.
by rewrite filter_pred1_uniq // rsE mem_filter ib mem_enum.
Qed.
End Two.
