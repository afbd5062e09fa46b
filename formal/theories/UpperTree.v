(** The upper proof: a tree of cases over plans whose leaves weigh linear bounds on groups, or covers. Generic in the
    value, and in how the gains of a case bound it. *)
From mathcomp Require Import all_ssreflect all_algebra.
From mathcomp.zify Require Import zify.
From Ratt Require Import Extrema Teams Dyadic DyadicMatrix Graph Scores Covers.
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

(** Leaf: cuts by number with their weights, covers, or gains under an attack. Branch on a robot's elements, or on the group that wins an
    attack. *)
Inductive upper_tree :=
| Leaf of seq (nat * dyadic)
| CoverLeaf of seq (nat * dyadic)
| GainLeaf of nat
| OnElement of nat & seq (seq nat * upper_tree)
| OnWinner of nat & seq upper_tree.

Fixpoint has_gains (t : upper_tree) : bool :=
  match t with
  | Leaf _ | CoverLeaf _ => false
  | GainLeaf _ => true
  | OnElement _ parts => has (fun bt => has_gains bt.2) parts
  | OnWinner _ parts => has has_gains parts
  end.

Section Checker.
Variables (w : network) (attacks : seq (seq (seq nat))) (cuts : seq cut_bound) (covers : seq cover_bound) (upper : dyadic).
Variable gains : nat -> seq (seq nat) -> bool.
(** [attacks]: the seeing groups of each listed attack. A cut may be used where its group is the only one or the winner. *)
Definition cut_of (k : nat) : cut_bound := nth (CutBound 0 0 d0 [::]) cuts k.
Definition usable (winners : seq (nat * nat)) (c : cut_bound) : bool :=
  ((size (nth [::] attacks (of_attack c)) == 1%N) && (of_group c == 0%N)) || ((of_attack c, of_group c) \in winners).

Definition check_leaf (left : seq (seq nat)) (winners : seq (nat * nat)) (used : seq (nat * dyadic)) : bool :=
  let total := weighed (size (owners w)) (fun k => scores (cut_of k)) used in
  let mass := dsum [seq kw.2 | kw <- used] in
  let base := dsum [seq dmul kw.2 (constant (cut_of kw.1)) | kw <- used] in
  let best := dsum [seq largest_of (nth d0 total) (nth [::] left i) | i <- iota 0 (robots w)] in
  [&& all (fun kw => [&& (kw.1 < size cuts)%N, usable winners (cut_of kw.1) & dle d0 kw.2]) used,
      dlt d0 mass & dle (dadd base best) (dmul upper mass)].

Fixpoint check_upper (t : upper_tree) (left : seq (seq nat)) (winners : seq (nat * nat)) : bool :=
  match t with
  | Leaf used => check_leaf left winners used
  | CoverLeaf used => check_cover_leaf w covers upper left used
  | GainLeaf a => (a < size attacks)%N && gains a left
  | OnElement i parts =>
      [&& (i < robots w)%N, all (fun bt => ~~ nilp bt.1) parts,
          sort leq (flatten [seq bt.1 | bt <- parts]) == nth [::] left i
        & all (fun bt => let: (block, t') := bt in check_upper t' (set_nth [::] left i block) winners) parts]
  | OnWinner a parts =>
      [&& (a < size attacks)%N, all (fun ag => ag.1 != a) winners, size parts == size (nth [::] attacks a)
        & (fix go (l : seq upper_tree) (g : nat) {struct l} : bool :=
             if l is t' :: l' then check_upper t' left ((a, g) :: winners) && go l' g.+1 else true) parts 0%N]
  end.

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

Definition worst := worst_case (team_of w) phi p.
Hypothesis covers_sized : forall k, (k < size covers)%N -> size (left_out (cover_of covers k)) = size (owners w).
Hypothesis covers_ok : forall k, (k < size covers)%N -> fails p (cover_of covers k) ->
  all (fun x => dle x upper) (levels (cover_of covers k)) -> worst <= val upper.
Hypothesis gains_ok : forall a left g, gains a left -> in_case p left -> (g < size (nth [::] attacks a))%N ->
  phi (contributed p (set_of w (nth [::] (nth [::] attacks a) g))) <= val upper.

(** The winners declared have at least the plan's worst case. *)
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

Lemma check_leafP left winners used : check_leaf left winners used -> 0 < worst -> in_case p left -> winning winners ->
  worst <= val upper.
Proof.
rewrite /check_leaf !(val_lt F) !(val_le F) val_add val_mul val_sum_iota !val_sum !big_map val0.
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
rewrite ler_add2l; apply: ler_sum => i _; apply: le_trans (largest_ofP F _ (inc i)); rewrite weighedP // => kw ku.
by have /and3P[kin _ _] := good _ ku; apply/eqP/(allP sizes_ok)/mem_nth.
Qed.

Lemma check_upperP t left winners : check_upper t left winners -> 0 < worst -> in_case p left -> winning winners ->
  worst <= val upper.
Proof.
move: t left winners; fix IH 1 => t left winners; case: t => [used|used|a|i parts|a parts].
- exact: check_leafP.
- rewrite [check_upper _ _ _]/= => leaf _ inc _; have [k kl /andP[low fail]] := check_cover_leafP F covers_sized leaf inc.
  exact: covers_ok kl fail low.
- move=> /andP[al leaf] pos inc _; have [g gl best] := some_group pos al.
  exact: le_trans best (gains_ok leaf inc gl).
- rewrite [check_upper _ _ _]/= => /and4P[il _ /eqP cover kids] pos inc win.
  have inpi : (p (robot_of w i) : nat) \in flatten [seq bt.1 | bt <- parts].
    by rewrite -(mem_sort leq) cover -{2}(robot_ofK il); apply: inc.
  have inc' block : (p (robot_of w i) : nat) \in block -> in_case p (set_nth [::] left i block).
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

Theorem upper_treeP t : check_upper t (all_plans w) [::] -> dle d0 upper -> worst <= val upper.
Proof.
rewrite (val_le F) val0 => h u0; have [le|pos] := leP worst 0; first exact: le_trans le u0.
apply: check_upperP h pos _ _ => // i; exact: in_all_plans ok okp.
Qed.
End Checker.
