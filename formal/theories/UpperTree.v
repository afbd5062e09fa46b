(** The upper proof: a tree of cases over plans whose leaves weigh linear bounds on groups. Generic in the value. *)
From mathcomp Require Import all_ssreflect all_algebra.
From mathcomp.zify Require Import zify.
From Ratt Require Import Extrema Teams Dyadic Graph.
Set Implicit Arguments.
Unset Strict Implicit.
Unset Printing Implicit Defensive.
Import Order.Theory GRing.Theory Num.Theory.

(** A bound on the value of one group of one listed attack: a constant and a score for each element (zero for the
    elements of robots outside of the group). *)
Record cut_bound := CutBound { of_attack : nat; of_group : nat; constant : dyadic; scores : seq dyadic }.

Lemma cut_boundK : cancel (fun c => (of_attack c, of_group c, constant c, scores c))
  (fun q => CutBound q.1.1.1 q.1.1.2 q.1.2 q.2).
Proof. by case. Qed.
Canonical cut_bound_eqType := EqType cut_bound (CanEqMixin cut_boundK).

(** Leaf: cuts by number with their weights. Branch on a robot's elements. Branch on the group that wins an attack. *)
Inductive upper_tree :=
| Leaf of seq (nat * dyadic)
| OnElement of nat & seq (seq nat * upper_tree)
| OnWinner of nat & seq upper_tree.

Fixpoint axpy (w : dyadic) (s acc : seq dyadic) : seq dyadic :=
  match s, acc with
  | x :: s', y :: acc' => dadd (dmul w x) y :: axpy w s' acc'
  | _, _ => [::]
  end.

Definition largest_of (f : nat -> dyadic) (s : seq nat) : dyadic :=
  if s is e :: s' then foldl (fun m x => dmax m (f x)) (f e) s' else d0.

Section Checker.
Variables (w : network) (attacks : seq (seq (seq nat))) (cuts : seq cut_bound) (upper : dyadic).
(** [attacks]: the seeing groups of each listed attack. A cut may be used where its group is the only one or the winner. *)
Definition cut_of (k : nat) : cut_bound := nth (CutBound 0 0 d0 [::]) cuts k.
Definition usable (winners : seq (nat * nat)) (c : cut_bound) : bool :=
  ((size (nth [::] attacks (of_attack c)) == 1%N) && (of_group c == 0%N)) || ((of_attack c, of_group c) \in winners).

Definition leaf_total (used : seq (nat * dyadic)) : seq dyadic :=
  foldl (fun acc kw => axpy kw.2 (scores (cut_of kw.1)) acc) (nseq (size (owners w)) d0) used.

Definition check_leaf (left : seq (seq nat)) (winners : seq (nat * nat)) (used : seq (nat * dyadic)) : bool :=
  let total := leaf_total used in
  let mass := dsum [seq kw.2 | kw <- used] in
  let base := dsum [seq dmul kw.2 (constant (cut_of kw.1)) | kw <- used] in
  let best := dsum [seq largest_of (nth d0 total) (nth [::] left i) | i <- iota 0 (robots w)] in
  [&& all (fun kw => [&& (kw.1 < size cuts)%N, usable winners (cut_of kw.1) & dle d0 kw.2]) used,
      dlt d0 mass & dle (dadd base best) (dmul upper mass)].

Fixpoint check_upper (t : upper_tree) (left : seq (seq nat)) (winners : seq (nat * nat)) : bool :=
  match t with
  | Leaf used => check_leaf left winners used
  | OnElement i parts =>
      [&& (i < robots w)%N, all (fun bt => ~~ nilp bt.1) parts,
          sort leq (flatten [seq bt.1 | bt <- parts]) == nth [::] left i
        & all (fun bt => let: (block, t') := bt in check_upper t' (set_nth [::] left i block) winners) parts]
  | OnWinner a parts =>
      [&& (a < size attacks)%N, all (fun ag => ag.1 != a) winners, size parts == size (nth [::] attacks a)
        & (fix go (l : seq upper_tree) (g : nat) {struct l} : bool :=
             if l is t' :: l' then check_upper t' left ((a, g) :: winners) && go l' g.+1 else true) parts 0%N]
  end.

Definition all_plans : seq (seq nat) :=
  [seq [seq e <- iota 0 (size (owners w)) | nth 0%N (owners w) e == i] | i <- iota 0 (robots w)].

Local Open Scope ring_scope.

Variable F : realFieldType.
Local Notation val := (val F).
Local Notation robot := 'I_(top_robot w).+1.
Local Notation element := 'I_(top_element w).+1.
Variables (phi : {set element} -> F) (listed : seq listed_attack).
Hypotheses (ok : network_ok w) (empty_value : phi set0 = 0).
Hypothesis listed_ok : all (attack_ok w) listed.
Hypothesis attacksE : attacks = [seq seeing_groups w a | a <- listed].
Hypothesis sizes_ok : all (fun c => size (scores c) == size (owners w)) cuts.
Variable p : {ffun robot -> element}.
Hypothesis okp : is_plan (team_of w) p.
Hypothesis cuts_ok : forall k, (k < size cuts)%N -> let c := cut_of k in
  phi (contributed p (set_of w (nth [::] (nth [::] attacks (of_attack c)) (of_group c)))) <=
  val (constant c) + \sum_(i : robot) val (nth d0 (scores c) (p i)).

Lemma size_axpy a s acc : size s = size acc -> size (axpy a s acc) = size acc.
Proof. by elim: s acc => [|x s IH] [|y acc] //= [/IH ->]. Qed.

Lemma nth_axpy a s acc k : size s = size acc ->
  val (nth d0 (axpy a s acc) k) = val a * val (nth d0 s k) + val (nth d0 acc k).
Proof.
elim: s acc k => [|x s IH] [|y acc] [|k] //=; rewrite ?val0 ?mulr0 ?addr0 //.
  by rewrite val_add val_mul.
by case=> /IH.
Qed.

Lemma leaf_totalP used k : all (fun kw => kw.1 < size cuts)%N used ->
  val (nth d0 (leaf_total used) k) = \sum_(kw <- used) val kw.2 * val (nth d0 (scores (cut_of kw.1)) k).
Proof.
move=> /allP inr; rewrite /leaf_total.
have gen acc : size acc = size (owners w) ->
  val (nth d0 (foldl (fun acc kw => axpy kw.2 (scores (cut_of kw.1)) acc) acc used) k) =
  val (nth d0 acc k) + \sum_(kw <- used) val kw.2 * val (nth d0 (scores (cut_of kw.1)) k).
  elim: used acc inr => [|kw used IH] acc inr sz; first by rewrite big_nil addr0.
  have ss : size (scores (cut_of kw.1)) = size acc.
    by rewrite sz; apply/eqP; apply: (allP sizes_ok); apply: mem_nth; apply: inr; rewrite mem_head.
  rewrite [foldl _ _ _]/= IH ?size_axpy // => [|x xu]; last by apply: inr; rewrite in_cons xu orbT.
  by rewrite nth_axpy // big_cons addrCA addrA.
rewrite gen ?size_nseq // nth_nseq if_same val0 add0r //.
Qed.

Lemma largest_ofP f s e : e \in s -> val (f e) <= val (largest_of f s).
Proof.
case: s => [//|x s] h; rewrite /largest_of.
have gen m : val m <= val (foldl (fun m x => dmax m (f x)) m s) /\
    (forall y, y \in s -> val (f y) <= val (foldl (fun m x => dmax m (f x)) m s)).
  elim: s {h} m => [|y s IH] m /=; first by split.
  have [h1 h2] := IH (dmax m (f y)); rewrite val_max in h1; split.
    by apply: le_trans h1; rewrite le_maxr lexx.
  move=> z; rewrite in_cons => /orP[/eqP->|/h2 //]; by apply: le_trans h1; rewrite le_maxr lexx orbT.
by move: h; rewrite in_cons => /orP[/eqP->|/(proj2 (gen (f x)))] //; apply: (proj1 (gen (f x))).
Qed.

Definition worst := worst_case (team_of w) phi p.
(** The plan is in the case, and the winners declared have at least its worst case. *)
Definition in_case (left : seq (seq nat)) : Prop := forall i : robot, (p i : nat) \in nth [::] left i.
Definition winning (winners : seq (nat * nat)) : Prop := forall a g, (a, g) \in winners ->
  worst <= phi (contributed p (set_of w (nth [::] (nth [::] attacks a) g))).

Lemma some_group a : 0 < worst -> (a < size attacks)%N -> exists2 g, (g < size (nth [::] attacks a))%N &
  worst <= phi (contributed p (set_of w (nth [::] (nth [::] attacks a) g))).
Proof.
rewrite attacksE size_map => pos al; rewrite (nth_map ([::], [::])) //; set b := nth _ listed a.
have okb : attack_ok w b by apply: (allP listed_ok); apply: mem_nth.
have le := worst_case_le phi p (attack_of_allowed ok okb).
have [i ei] := team_value_attained (team_of w) phi p (attack_of w b) (ord0 : robot).
have ne : sees (team_of w) (attack_of w b) i != set0.
  apply: contraTN pos => /eqP e; rewrite -leNgt; apply: le_trans le _.
  by rewrite ei e /contributed imset0 empty_value.
have [g gin eg] := seeing_groupsP ok okb ne.
exists (index g (seeing_groups w b)); first by rewrite index_mem.
by rewrite nth_index // -eg -ei.
Qed.

Lemma check_leafP left winners used : check_leaf left winners used -> 0 < worst -> in_case left -> winning winners ->
  worst <= val upper.
Proof.
rewrite /check_leaf !(val_lt F) !(val_le F) val_add val_mul !val_sum !big_map val0.
move=> /and3P[/allP good mass0 le] pos inc win.
have inr : all (fun kw => kw.1 < size cuts)%N used by apply/allP => kw /good /and3P[].
rewrite -(ler_pmul2r mass0); apply: le_trans le.
have cutle kw : kw \in used -> worst <= val (constant (cut_of kw.1)) +
    \sum_(i : robot) val (nth d0 (scores (cut_of kw.1)) (p i)).
  move=> ku; have /and3P[kin us _] := good _ ku; apply: le_trans (cuts_ok kin).
  case/orP: us => [/andP[/eqP s1 /eqP ->]|/win //].
  have al : (of_attack (cut_of kw.1) < size attacks)%N.
    by rewrite ltnNge; apply/negP => /(nth_default [::]) e; rewrite e in s1.
  by have [g] := some_group pos al; rewrite s1; case: g.
rewrite mulr_sumr big_seq_cond; apply: le_trans (_ : \sum_(kw <- used) (val kw.2 * (val (constant (cut_of kw.1)) +
    \sum_(i : robot) val (nth d0 (scores (cut_of kw.1)) (p i)))) <= _).
  rewrite [X in _ <= X]big_seq_cond; apply: ler_sum => kw; rewrite andbT => ku.
  rewrite mulrC ler_wpmul2l ?cutle //; have /and3P[_ _] := good _ ku; by rewrite (val_le F) val0.
have -> : \sum_(kw <- used) (val kw.2 * (val (constant (cut_of kw.1)) +
    \sum_(i : robot) val (nth d0 (scores (cut_of kw.1)) (p i)))) =
  \sum_(kw <- used) val (dmul kw.2 (constant (cut_of kw.1))) +
  \sum_(i : robot) \sum_(kw <- used) val kw.2 * val (nth d0 (scores (cut_of kw.1)) (p i)).
  rewrite exchange_big -big_split; apply: eq_bigr => kw _; by rewrite mulrDr mulr_sumr val_mul.
rewrite ler_add2l.
have -> : \sum_(i <- iota 0 (robots w)) val (largest_of (nth d0 (leaf_total used)) (nth [::] left i)) =
    \sum_(i : robot) val (largest_of (nth d0 (leaf_total used)) (nth [::] left i)).
  by rewrite -(big_mkord xpredT (fun i => val (largest_of (nth d0 (leaf_total used)) (nth [::] left i)))) /index_iota subn0.
by apply: ler_sum => i _; rewrite -leaf_totalP //; apply: largest_ofP.
Qed.

Lemma check_upperP t left winners : check_upper t left winners -> 0 < worst -> in_case left -> winning winners ->
  worst <= val upper.
Proof.
move: t left winners; fix IH 1 => t left winners; case: t => [used|i parts|a parts].
- exact: check_leafP.
- rewrite [check_upper _ _ _]/= => /and4P[il _ /eqP cover kids] pos inc win.
  have inpi : (p (robot_of w i) : nat) \in flatten [seq bt.1 | bt <- parts].
    by rewrite -(mem_sort leq) cover -{2}(robot_ofK il); apply: inc.
  have inc' block : (p (robot_of w i) : nat) \in block -> in_case (set_nth [::] left i block).
    move=> pb j; rewrite nth_set_nth /=; case: eqP => [e|_]; last exact: inc.
    by rewrite -e robot_of_val in pb.
  clear cover; elim: parts inpi kids => [//|[block t] parts IHp] /=.
  rewrite mem_cat => /orP[pb|pin] /andP[h1 h2]; last exact: IHp.
  exact: IH h1 pos (inc' _ pb) win.
rewrite [check_upper _ _ _]/= => /and4P[al _ /eqP sz kids] pos inc win.
have [g gl best] := some_group pos al; rewrite -sz in gl.
have : forall g0, (g0 <= g)%N -> (g < g0 + size parts)%N ->
  (fix go (l : seq upper_tree) (g : nat) {struct l} : bool :=
     if l is t' :: l' then check_upper t' left ((a, g) :: winners) && go l' g.+1 else true) parts g0 ->
  worst <= val upper.
  clear kids gl sz; elim: parts => [|t parts IHp] g0 le lt; first by move: lt; rewrite /= addn0 ltnNge le.
  move=> /andP[h1 h2]; have [e|ne] := eqVneq g0 g; last first.
    by apply: (IHp g0.+1) => //; [rewrite ltn_neqAle ne le | move: lt; rewrite /= addSnnS].
  apply: IH h1 pos inc _ => a' g'; rewrite in_cons => /orP[/eqP[-> ->]|/win //].
  by rewrite e.
by move=> /(_ 0%N (leq0n _) gl kids).
Qed.

Lemma in_all_plans (i : robot) : (p i : nat) \in nth [::] all_plans i.
Proof.
rewrite /all_plans (nth_map 0%N) ?size_iota ?ltn_ord // nth_iota ?ltn_ord // add0n mem_filter mem_iota add0n.
have pos_n : (0 < size (owners w))%N by case/and3P: ok.
have ps : (p i < size (owners w))%N by apply: leq_trans (ltn_ord (p i)) _; rewrite /top_element prednK.
rewrite ps /= andbT; have := plan_owner i okp => /= /(congr1 (@nat_of_ord _)); rewrite /robot_of inordK => [->//|].
by case/and3P: ok => _ /allP own _; apply: own; apply: mem_nth.
Qed.

Theorem upper_treeP t : check_upper t all_plans [::] -> dle d0 upper -> worst <= val upper.
Proof.
rewrite (val_le F) val0 => h u0; have [le|pos] := leP worst 0; first exact: le_trans le u0.
apply: check_upperP h pos _ _ => // i; exact: in_all_plans.
Qed.
End Checker.
