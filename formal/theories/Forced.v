(** On a complete graph every attack within the budgets leaves a group with a certain number of robots that see: a table
    of the largest sums of squares of group sizes, and why it may be trusted. *)
From Coq Require Import ZArith.
From mathcomp Require Import all_ssreflect.
From mathcomp.zify Require Import zify ssrZ.
From Ratt Require Import Extrema Teams Graph.
Set Implicit Arguments.
Unset Strict Implicit.
Unset Printing Implicit Defensive.

Section Table.
Variables (size_k budget : nat) (none : Z).

(** Largest sum of squares of the sizes of groups of [r] robots with fewer than [size_k] seeing robots each, blinding
    [x]; [rows]: the same for [r - 1, ..., 0] robots. *)
Definition square (k : nat) : Z := Z.mul (Z.of_nat k) (Z.of_nat k).
Definition option_of (rows : seq (seq Z)) (x k : nat) : Z :=
  Z.add (square k) (nth none (nth [::] rows k.-1) (x - (k - size_k.-1))).
Definition next_row (rows : seq (seq Z)) (r : nat) : seq Z :=
  mkseq (fun x => foldr Z.max none [seq option_of rows x k | k <- iota 1 r & (k < size_k + x)%N]) budget.+1.
Fixpoint all_rows (r : nat) : seq (seq Z) :=
  if r is r'.+1 then let rows := all_rows r' in next_row rows r :: rows else [:: nseq budget.+1 Z0].
Definition entry (r x : nat) : Z := nth none (head [::] (all_rows r)) x.

Lemma le_foldr_Zmax (s : seq Z) x : x \in s -> Z.le x (foldr Z.max none s).
Proof. by elim: s => [//|y s IH]; rewrite in_cons /= => /orP[/eqP->|/IH]; lia. Qed.

Lemma nth_all_rows r k : (k <= r)%N -> nth [::] (all_rows r) k = head [::] (all_rows (r - k)).
Proof.
elim: r k => [|r IH] [|k] //= kr; rewrite subSS; exact: IH.
Qed.

Lemma entry_ge r x k : (0 < k <= r)%N -> (k < size_k + x)%N -> (x <= budget)%N ->
  Z.le (Z.add (square k) (entry (r - k) (x - (k - size_k.-1)))) (entry r x).
Proof.
case: r => [|r] /andP[k0 kr] kx xb; first by move: k0; rewrite ltnNge kr.
rewrite {2}/entry /= nth_mkseq ?ltnS //; apply: le_foldr_Zmax; apply/mapP; exists k.
  by rewrite mem_filter kx mem_iota k0 add1n ltnS.
rewrite /option_of /entry nth_all_rows; last by lia.
by congr (Z.add _ (nth _ (head _ (all_rows _)) _)); lia.
Qed.

Lemma entry_groups (gs : seq (nat * nat)) r x :
  all (fun g => (0 < g.1)%N && (g.1 < size_k + g.2)%N) gs -> sumn (map fst gs) = r ->
  (sumn (map snd gs) <= x)%N -> (x <= budget)%N ->
  Z.le (Z.of_nat (sumn [seq g.1 * g.1 | g <- gs])) (entry r x).
Proof.
elim: gs r x => [|[k b] gs IH] r x /=.
  by move=> _ <- _ xb; have -> : entry 0 x = nth none (nseq budget.+1 Z0) x; rewrite // nth_nseq ltnS xb.
move=> /andP[/andP[k0 kb] h] <- bx xb.
have := @entry_ge (k + sumn (map fst gs)) x k; rewrite addKn k0 leq_addr => /(_ isT).
have kx : (k < size_k + x)%N by lia.
move=> /(_ kx xb); have := IH (sumn (map fst gs)) (x - (k - size_k.-1))%N h erefl.
rewrite /square; set e := entry _ (x - _); set f := entry _ x; set q := sumn [seq _ | g <- gs].
move=> h1 h2; have b1 : (sumn (map snd gs) <= x - (k - size_k.-1))%N by lia.
have b2 : (x - (k - size_k.-1) <= budget)%N by lia.
have := h1 b1 b2; move: h2; rewrite Nat2Z.inj_add Nat2Z.inj_mul; lia.
Qed.
End Table.

Definition complete (w : network) : bool :=
  all (fun i => all (fun j => (i < j)%N ==> ((i, j) \in link_list w)) (iota 0 (robots w))) (iota 0 (robots w)).

Definition none_of (n : nat) : Z := Z.opp (Z.of_nat (n * n).+1).
Definition is_forced (w : network) (size_k : nat) : bool :=
  (size_k == 0%N) ||
  Z.ltb (Z.of_nat (cut_budget w + cut_budget w))
        (Z.sub (Z.of_nat (robots w * robots w)) (entry size_k (blind_budget w) (none_of (robots w)) (robots w) (blind_budget w))).

Section Forced.
Variables (w : network) (a : attack [finType of 'I_(top_robot w).+1]).
Hypotheses (ok : network_ok w) (full : complete w) (oka : allowed (team_of w) a).
Local Notation robot := 'I_(top_robot w).+1.
Local Notation e := (linked (team_of w) a).

Lemma e_sym : connect_sym e.
Proof. exact: connect_linked_sym. Qed.

Lemma cut_pair (i j : robot) : ~~ connect e i j -> [set i; j] \in cut a.
Proof.
move=> nc; have ij : i != j by apply: contra nc => /eqP->; apply: connect0.
apply: contraR nc => ncut; apply: connect1; rewrite /linked ij in_setD ncut /= mem_links_of ?links_ok //.
have mem (k l : robot) : (k < l)%N -> ((k : nat), (l : nat)) \in link_list w.
  move=> kl; have io (m : robot) : (m : nat) \in iota 0 (robots w) by rewrite mem_iota add0n ltn_ord.
  by have /allP/(_ _ (io k))/allP/(_ _ (io l))/implyP := full; apply.
by rewrite /linkmem; move: ij; rewrite -val_eqE neq_ltn => /orP[] /mem ->; rewrite ?orbT.
Qed.

Lemma apart_le : (#|[set ij : robot * robot | ~~ connect e ij.1 ij.2]| <= cut_budget w + cut_budget w)%N.
Proof.
case/and5P: oka => _ cb _ _ _; apply: leq_trans (leq_add cb cb).
rewrite addnn -muln2 -card_bool -cardsT -cardsX.
pose f (ij : robot * robot) := ([set ij.1; ij.2], (ij.1 < ij.2)%N).
have inj : {in [set ij : robot * robot | ~~ connect e ij.1 ij.2] &, injective f}.
  move=> [i j] [k l]; rewrite !inE /= => nij nkl [/eqP]; rewrite pair_eq; first last.
  - by apply: contra nkl => /eqP->; apply: connect0.
  - by apply: contra nij => /eqP->; apply: connect0.
  case/orP=> /andP[/eqP-> /eqP->] //; case: ltngtP => // /val_inj eq; move: nkl.
  by rewrite eq connect0.
rewrite -(card_in_imset inj); apply: subset_leq_card; apply/subsetP => q /imsetP[[i j]].
by rewrite !inE /= => nij ->; rewrite cut_pair.
Qed.

Local Notation size_of r := #|[set j : robot | root e j == r]|.

Lemma size_root i : group (team_of w) a i = [set j | root e j == root e i].
Proof. by apply/setP => j; rewrite !inE (root_connect e_sym) e_sym. Qed.

Lemma sum_groups : (\sum_(i : robot) #|group (team_of w) a i| = \sum_(r | roots e r) size_of r * size_of r)%N.
Proof.
rewrite (partition_big (root e) (roots e)) /=; last by move=> i _; apply: (roots_root e_sym).
apply: eq_bigr => r _; rewrite (eq_bigr (fun _ => size_of r)); last by move=> i /eqP <-; rewrite size_root.
by rewrite sum_nat_const -sum1_card; congr (_ * _)%N; rewrite -sum1_card; apply: eq_bigl => j; rewrite inE.
Qed.

Lemma sum_enum (P : pred robot) (f : robot -> nat) :
  (\sum_(i <- enum [finType of robot] | P i) f i = \sum_(i | P i) f i)%N.
Proof. by rewrite big_enum_cond; apply: eq_bigl. Qed.

Theorem forcedP k : is_forced w k -> exists i, (k <= #|sees (team_of w) a i|)%N.
Proof.
case/orP=> [/eqP->|]; first by exists ord0.
move=> lt; apply/existsP; apply: contraLR lt => /existsPn small.
pose gs := [seq (size_of r, #|[set j in blinded a | root e j == r]|) | r <- enum [finType of robot] & roots e r].
have good : all (fun g => (0 < g.1)%N && (g.1 < k + g.2)%N) gs.
  apply/allP => g /mapP[r]; rewrite mem_filter => /andP[rr _] -> /=; apply/andP; split.
    by rewrite card_gt0; apply/set0Pn; exists r; rewrite inE; apply: rr.
  have := small r; rewrite -ltnNge /sees size_root (eqP rr) => h.
  rewrite -(cardsID (blinded a) [set j | root e j == r]) addnC.
  have -> : #|[set j | root e j == r] :&: blinded a| = #|[set j in blinded a | root e j == r]|.
    by apply: eq_card => j; rewrite !inE andbC.
  by rewrite ltn_add2r.
have s1 : sumn (map fst gs) = robots w.
  rewrite /gs -map_comp sumnE big_map big_filter sum_enum /= /robots -[RHS]card_ord -sum1_card.
  rewrite [RHS](partition_big (root e) (roots e)) /=; last by move=> i _; apply: (roots_root e_sym).
  by apply: eq_bigr => r _; rewrite sum1_card; apply: eq_card => j; rewrite inE.
have s2 : (sumn (map snd gs) <= blind_budget w)%N.
  case/and5P: oka => bb _ _ _ _; apply: leq_trans bb; rewrite /gs -map_comp sumnE big_map big_filter sum_enum /=.
  rewrite -sum1_card [X in (_ <= X)%N](partition_big (root e) (roots e)) /=; last by move=> i _; apply: (roots_root e_sym).
  by apply: leq_sum => r _; rewrite -sum1_card; apply: eq_leq; apply: eq_bigl => j; rewrite !inE.
have s3 : (sumn [seq g.1 * g.1 | g <- gs] = \sum_(i : robot) #|group (team_of w) a i|)%N.
  by rewrite sum_groups /gs -map_comp sumnE big_map big_filter sum_enum.
have le := @entry_groups k (blind_budget w) (none_of (robots w)) gs _ _ good s1 s2 (leqnn _).
have pairs : (\sum_(i : robot) #|group (team_of w) a i| +
    #|[set ij : robot * robot | ~~ connect e ij.1 ij.2]| = robots w * robots w)%N.
  have -> : #|[set ij : robot * robot | ~~ connect e ij.1 ij.2]| = (\sum_(i : robot) #|~: group (team_of w) a i|)%N.
    rewrite [RHS](eq_bigr (fun i => \sum_(j | ~~ connect e i j) 1)); last first.
      by move=> i _; rewrite -sum1_card; apply: eq_bigl => j; rewrite !inE.
    by rewrite pair_big_dep /= -sum1_card; apply: eq_bigl => ij; rewrite inE.
  rewrite -big_split /= (eq_bigr (fun _ => robots w)); last by move=> i _; rewrite cardsC card_ord.
  by rewrite sum_nat_const card_ord.
have := apart_le; move: le; rewrite s3; lia.
Qed.
End Forced.
