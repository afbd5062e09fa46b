(** The groups that an attack within the budgets leaves: what they lose, and what all of them cost together. *)
From Coq Require Import ZArith.
From mathcomp Require Import all_ssreflect all_algebra.
From mathcomp.zify Require Import zify ssrZ.
From Ratt Require Import Extrema Teams Graph CaseTree Costs.
Set Implicit Arguments.
Unset Strict Implicit.
Unset Printing Implicit Defensive.
Import Order.Theory GRing.Theory Num.Theory.

Section Groups.
Local Open Scope ring_scope.
Variables (w : network) (a : attack [finType of 'I_(top_robot w).+1]).
Hypotheses (ok : network_ok w) (oka : allowed (team_of w) a).
Local Notation robot := 'I_(top_robot w).+1.
Local Notation root := fingraph.root.
Local Notation e := (linked (team_of w) a).
Local Notation B := (blinded a).
Local Notation adjacent := (@adjacent w).

Lemma sym : connect_sym e.
Proof. exact: connect_linked_sym. Qed.

Lemma roots_root i : roots e (root e i).
Proof. exact: fingraph.roots_root sym i. Qed.

(** Groups by their roots. *)
Definition part (r : robot) : {set robot} := [set j | root e j == r].

Lemma mem_part i : i \in part (root e i).
Proof. by rewrite inE. Qed.

Lemma part_group i : part (root e i) = group (team_of w) a i.
Proof. by apply/setP => j; rewrite !inE (root_connect sym) sym. Qed.

Lemma part_connect r i j : i \in part r -> (j \in part r) = connect e i j.
Proof. by rewrite !inE => /eqP<-; rewrite (root_connect sym) sym. Qed.

Lemma adjacent_neq i j : adjacent i j -> i != j.
Proof.
move=> h; apply: contraTneq h => ->; rewrite /Costs.adjacent /linkmem orbb; apply/negP => h.
by have /allP/(_ _ h) := links_ok ok; rewrite /link_ok /= ltnn.
Qed.

Lemma adjacent_cut i j : adjacent i j -> ~~ connect e i j -> [set i; j] \in cut a.
Proof.
move=> adj; apply: contraR => nc; apply: connect1; rewrite /linked adjacent_neq //= in_setD nc /=.
by rewrite mem_links_of ?links_ok ?adjacent_neq.
Qed.

Lemma cut_few : (#|cut a| <= cut_budget w)%N.
Proof. by case/and5P: oka. Qed.

(** A group loses no more links than are cut. *)
Lemma part_links r : (links_left (part r) <= cut_budget w)%N.
Proof.
apply: leq_trans cut_few; rewrite /links_left pair_big /=.
have -> : (\sum_(ij : robot * robot) [&& ij.1 \in part r, ij.2 \notin part r & adjacent ij.1 ij.2] =
    #|[set ij : robot * robot | [&& ij.1 \in part r, ij.2 \notin part r & adjacent ij.1 ij.2]]|)%N.
  by rewrite -sum1_card [RHS]big_mkcond; apply: eq_bigr => ij _; rewrite in_set; case: (_ && _).
have inj : {in [set ij : robot * robot | [&& ij.1 \in part r, ij.2 \notin part r & adjacent ij.1 ij.2]] &,
    injective (fun ij : robot * robot => [set ij.1; ij.2])}.
  move=> [i j] [k l]; rewrite in_set [X in _ -> is_true X -> _]in_set /= => /and3P[iC jC ij] /and3P[kC lC kl] /eqP.
  rewrite pair_eq ?adjacent_neq // => /orP[/andP[/eqP-> /eqP->] //|/andP[/eqP e1 _]].
  by rewrite e1 (negbTE lC) in iC.
rewrite -(card_in_imset inj); apply: subset_leq_card; apply/subsetP => q /imsetP[[i j]].
rewrite inE /= => /and3P[iC jC ij] ->; apply: adjacent_cut => //.
by rewrite -(part_connect _ iC).
Qed.

Lemma across_few : (#|[set ij : robot * robot | adjacent ij.1 ij.2 && ~~ connect e ij.1 ij.2]| <= cut_budget w + cut_budget w)%N.
Proof.
apply: leq_trans (leq_add cut_few cut_few); rewrite addnn -muln2 -card_bool -cardsT -cardsX.
pose f (ij : robot * robot) := ([set ij.1; ij.2], (ij.1 < ij.2)%N).
have inj : {in [set ij : robot * robot | adjacent ij.1 ij.2 && ~~ connect e ij.1 ij.2] &, injective f}.
  move=> [i j] [k l]; rewrite !inE /= => /andP[ij _] /andP[kl _] [/eqP]; rewrite pair_eq ?adjacent_neq //.
  case/orP=> /andP[/eqP-> /eqP->] //; case: ltngtP => // /val_inj eq; move: (adjacent_neq kl).
  by rewrite eq eqxx.
rewrite -(card_in_imset inj); apply: subset_leq_card; apply/subsetP => q /imsetP[[i j]].
by rewrite !inE /= => /andP[ij nij] ->; rewrite adjacent_cut.
Qed.

Lemma sum_parts (T : Type) (idx : T) (op : Monoid.com_law idx) (f : robot -> T) :
  \big[op/idx]_(r | roots e r) \big[op/idx]_(i in part r) f i = \big[op/idx]_i f i.
Proof.
rewrite [RHS](partition_big (root e) (roots e)) /=; last by move=> i _; apply: roots_root.
by apply: eq_bigr => r _; apply: eq_bigl => i; rewrite inE.
Qed.

Lemma all_links : (\sum_(r | roots e r) links_left (part r) <= cut_budget w + cut_budget w)%N.
Proof.
apply: leq_trans across_few.
have -> : (#|[set ij : robot * robot | adjacent ij.1 ij.2 && ~~ connect e ij.1 ij.2]| =
    \sum_(i : robot) \sum_(j : robot) (adjacent i j && ~~ connect e i j))%N.
  by rewrite -sum1_card big_mkcond pair_big /=; apply: eq_bigr => ij _; rewrite in_set; case: (_ && _).
rewrite -(sum_parts _ (fun i => \sum_j _)%N) /=; apply: leq_sum => r _; rewrite /links_left [X in (_ <= X)%N]big_mkcond /=.
apply: leq_sum => i _; case iC: (i \in part r) => /=; last by rewrite big1.
by apply: leq_sum => j _; rewrite -(part_connect _ iC) andbC; case: (_ && _).
Qed.

Lemma untied_part r i j : i \in part r -> j \notin part r -> ~~ tied_to i j.
Proof.
move=> iC; rewrite (part_connect _ iC) => nc; apply/negP => t.
have adj : adjacent i j.
  case/and4P: ok => _ _ _ /and5P[_ _ _ /allP kept _].
  by move: t; rewrite /tied_to /Costs.adjacent /linkmem => /orP[] /kept ->; rewrite ?orbT.
have cutij := adjacent_cut adj nc; case/and5P: oka => _ _ _ _ dis.
by have := disjointFr dis cutij; rewrite mem_links_of ?kept_links_ok ?adjacent_neq // => h; rewrite /tied_to h in t.
Qed.

Lemma blinded_few : (#|B| <= spare w)%N.
Proof.
case/and5P: oka => few _ _ dis _; rewrite /spare leq_min; apply/andP; split=> //.
rewrite -size_filter cardE -[X in (X <= _)%N](size_map (@nat_of_ord _)); apply: uniq_leq_size.
  by rewrite map_inj_uniq ?enum_uniq //; apply: val_inj.
move=> x /mapP[i]; rewrite mem_enum => iB ->; rewrite mem_filter mem_iota add0n ltn_ord leq0n !andbT.
by have := disjointFr dis iB; rewrite inE => ->.
Qed.

Lemma part_blinded r : (blinded_size (part r) B <= spare w)%N.
Proof. by apply: leq_trans blinded_few; apply: subset_leq_card; apply: subsetIr. Qed.

Lemma all_blinded : (\sum_(r | roots e r) blinded_size (part r) B <= spare w)%N.
Proof.
apply: leq_trans blinded_few; rewrite -sum1_card [X in (_ <= X)%N]big_mkcond -sum_parts leq_eqVlt; apply/orP; left.
apply/eqP/eq_bigr => r _; rewrite /blinded_size -sum1_card [LHS]big_mkcond [RHS]big_mkcond /=; apply: eq_bigr => i _.
by rewrite !inE; case: (_ == r).
Qed.

Lemma whole_part r (X : pred robot) : (exists2 i, i \in part r & X i) ->
  (forall i j, i \in part r -> X i -> j \in part r -> adjacent i j -> X j) -> forall j, j \in part r -> X j.
Proof.
case=> i iC iX step j; rewrite (part_connect _ iC) => /connectP[s].
elim: s i iC iX => [|k s IH] i iC iX /= => [_ -> //|/andP[ik ks] last].
have kC : k \in part r by rewrite (part_connect _ iC) connect1.
apply: (IH k) => //; apply: (step i) => //; case/andP: ik => ne.
by rewrite in_setD => /andP[_] /=; rewrite mem_links_of ?links_ok.
Qed.

(** All groups together cost no more than the slack. *)
Lemma all_costs d : prices_ok w d -> Z.le (\sum_(r | roots e r) cost d (part r) B) (slack w d).
Proof.
case/and3P=> /Z.leb_le h0 /Z.leb_le m0 /eqP sz.
have prices : zsum (robot_prices d) = \sum_(r | roots e r) \sum_(i in part r) price_of d i.
  by rewrite sum_parts -(zsum_nth Z0 (fun x => x) sz) map_id.
have le1 : Z.le (Z.of_nat (\sum_(r | roots e r) links_left (part r))%N) (Z.of_nat (cut_budget w + cut_budget w)).
  by have := all_links; lia.
have le2 : Z.le (Z.of_nat (\sum_(r | roots e r) blinded_size (part r) B)%N) (Z.of_nat (spare w)).
  by have := all_blinded; lia.
have sums s : \sum_(r <- s | roots e r) cost d (part r) B =
    Z.sub (Z.add (Z.mul (link_price d) (Z.of_nat (\sum_(r <- s | roots e r) links_left (part r))%N))
                 (Z.mul (blind_price d) (Z.of_nat (\sum_(r <- s | roots e r) blinded_size (part r) B)%N)))
      (\sum_(r <- s | roots e r) \sum_(i in part r) price_of d i).
  elim: s => [|r s IH]; first by rewrite !big_nil; lia.
  by rewrite !big_cons; case: ifP => _; rewrite ?IH // {1}/cost; lia.
rewrite sums /slack prices; move: (Z.mul_le_mono_nonneg_l _ _ _ h0 le1) (Z.mul_le_mono_nonneg_l _ _ _ m0 le2).
lia.
Qed.
End Groups.
