(** What a group costs by its size, and forms that bound it: why the checker of sizes may trust them. *)
From Coq Require Import ZArith.
From mathcomp Require Import all_ssreflect all_algebra.
From mathcomp.zify Require Import zify ssrZ.
From Ratt Require Import Extrema Teams Graph CaseTree Costs AttackGroups GroupProofs Positive Sizes.
Set Implicit Arguments.
Unset Strict Implicit.
Unset Printing Implicit Defensive.
Import Order.Theory GRing.Theory Num.Theory.

(** ** What a group costs *)
Section OneCost.
Local Open Scope ring_scope.
Variables (w : network) (d : prices).
Local Notation robot := 'I_(top_robot w).+1.
Local Notation near := (rows_of w (link_list w)).
Local Notation adj := (@adjacent w).
Local Notation h := (link_price d).
Variables (C B : {set robot}).
Hypotheses (ok : network_ok w) (prices_good : prices_ok w d) (free : blind_price d = Z0).
Hypothesis few_links : (links_left C <= cut_budget w)%N.
Local Notation cost := (cost d C B).
Definition zadj (i j : robot) : Z := if adj i j then Zpos xH else Z0.
Definition charge (i : robot) : Z := nth Z0 (charges near d) i.

Lemma adj_sym i j : adj i j = adj j i.
Proof. by rewrite /adjacent /linkmem orbC. Qed.

Lemma adj_irr i : adj i i = false.
Proof.
apply/negP => a; rewrite /adjacent /linkmem orbb in a.
by have /allP/(_ _ a) := links_ok ok; rewrite /link_ok /= ltnn.
Qed.

Lemma h_ge0 : Z.le 0 h.
Proof. by case/and3P: prices_good => /Z.leb_le. Qed.

Lemma size_charges : size (charges near d) = robots w.
Proof. by rewrite size_map size_zip size_rows; case/and3P: prices_good => _ _ /eqP->; rewrite minnn. Qed.

Lemma count_row (i : robot) (P : pred robot) (s : seq bool) : size s = robots w -> (forall j : robot, nth false s j = P j) ->
  links_to (nth [::] near i) s = \sum_(j : robot) if P j then zadj i j else Z0.
Proof.
move=> sz sP; rewrite /links_to -sum1_count big_mkcond (big_nth (false, false)) size_zip size_row // sz minnn big_mkord sum_nat.
apply: eq_bigr => j _; rewrite nth_zip ?size_row ?sz //= nth_rows // sP /zadj /adjacent.
by case: (linkmem _ _ _); case: (P j).
Qed.

Lemma chargeE i : charge i = Z.sub (Z.mul h (\sum_(j : robot) zadj i j)) (price_of d i).
Proof.
rewrite /charge (nth_map ([::], Z0)) ?size_zip ?size_rows; last first.
  by case/and3P: prices_good => _ _ /eqP->; rewrite minnn ltn_ord.
rewrite nth_zip ?size_rows /=; last by case/and3P: prices_good => _ _ /eqP->.
congr (Z.sub (Z.mul _ _) _); rewrite -sum1_count big_mkcond (big_nth false) size_row // big_mkord sum_nat.
by apply: eq_bigr => j _; rewrite nth_rows // /zadj /adjacent; case: (linkmem _ _ _).
Qed.

Definition inner_links (A A' : {set robot}) : Z := \sum_(i in A) \sum_(j in A') zadj i j.

Lemma sum_mkcond (A : {set robot}) (f : robot -> Z) : \sum_(i in A) f i = \sum_(i : robot) if i \in A then f i else Z0.
Proof. exact: big_mkcond. Qed.

Lemma costE : cost = Z.sub (\sum_(i in C) charge i) (Z.mul h (inner_links C C)).
Proof.
pose inw i := \sum_(j in C) zadj i j; pose outw i := \sum_(j : robot) if j \in C then Z0 else zadj i j.
have total i : \sum_(j : robot) zadj i j = Z.add (outw i) (inw i).
  by rewrite /inw sum_mkcond /outw sum_add; apply: eq_bigr => j _; case: (j \in C); lia.
have lost : Z.of_nat (links_left C) = \sum_(i in C) outw i.
  rewrite /links_left sum_nat sum_mkcond; apply: eq_bigr => i _; case: (i \in C); last by rewrite big1.
  by rewrite sum_nat; apply: eq_bigr => j _; rewrite /zadj; case: (j \in C); case: (adj i j).
have -> : inner_links C C = \sum_(i in C) inw i by [].
rewrite /Costs.cost free Z.mul_0_l Z.add_0_r lost.
under [\sum_(i in C) charge i]eq_bigr do rewrite chargeE total.
move: inw outw {total lost} => inw outw; elim: (index_enum _) => [|i s IH]; first by rewrite !big_nil; lia.
rewrite !big_cons; case: ifP => // _; move: IH.
move: (\sum_(j <- s | _) outw j) (\sum_(j <- s | _) price_of d j) (\sum_(j <- s | _) Z.sub _ _) (\sum_(j <- s | _) inw j).
by move=> x y z t; move: (outw i) (inw i) (price_of d i) => a b u; lia.
Qed.

Lemma ole_left x : Z.le x cost -> ole (left_cost w d x) (Some cost).
Proof.
move=> le; rewrite /left_cost /most_cost; case: ifP => [|nle]; first by rewrite /=; lia.
move: nle; case: ifP => //= /allP zero nle; exfalso.
have : Z.le cost (Z.mul h (Z.of_nat (cut_budget w))); last by lia.
rewrite /Costs.cost free Z.mul_0_l Z.add_0_r big1 => [|i _]; first by have := h_ge0; nia.
have : (i < size (robot_prices d))%N by case/and3P: prices_good => _ _ /eqP->.
by move/(mem_nth Z0)/zero/Z.eqb_eq.
Qed.

Lemma ole_most : ole (Some cost) (most_cost w d).
Proof.
have := ole_left (Z.le_refl cost); rewrite /left_cost; by case: ifP.
Qed.

Lemma smallest_sumP (A : {set robot}) (s : seq Z) : size s = robots w ->
  Z.le (smallest_sum #|A| s) (\sum_(i in A) nth Z0 s i).
Proof.
move=> sz; rewrite /smallest_sum; set t := nth _ _ _; clearbody t.
rewrite (zsum_nth Z0 (fun x => Z.min Z0 (Z.sub x t)) sz) [Z.mul _ t]Z.mul_comm -sum_set sum_mkcond sum_add.
by apply: sum_le => i; move: (nth Z0 s i) => x; case: (i \in A); lia.
Qed.

Definition inner_pairs : nat := #|[set ij : robot * robot | [&& ij.1 \in C, ij.2 \in C & adj ij.1 ij.2]]|.

Lemma inner_pairsE : inner_links C C = Z.of_nat inner_pairs.
Proof.
have -> : inner_pairs = (\sum_(i : robot) \sum_(j : robot) [&& i \in C, j \in C & adj i j])%N.
  rewrite /inner_pairs -sum1_card [LHS]big_mkcond pair_big /=; apply: eq_bigr => ij _; rewrite in_set.
  by case: (_ && _).
rewrite sum_nat /inner_links sum_mkcond; apply: eq_bigr => i _; rewrite sum_nat; case: (i \in C) => /=; last by rewrite big1.
by rewrite sum_mkcond; apply: eq_bigr => j _; rewrite /zadj; case: (j \in C); case: (adj i j).
Qed.

Lemma few_pairs : (inner_pairs <= minn (#|C| * #|C|.-1) (size (link_list w) + size (link_list w)))%N.
Proof.
rewrite leq_min; apply/andP; split.
  have sub : [set ij : robot * robot | [&& ij.1 \in C, ij.2 \in C & adj ij.1 ij.2]] \subset
      setX C C :\: [set (i, i) | i in C].
    apply/subsetP => -[i j]; rewrite in_set => /and3P[/= iC jC ij]; rewrite in_setD in_setX iC jC /= andbT.
    apply/negP => /imsetP[k _ [e1 e2]].
    by rewrite e1 e2 adj_irr in ij.
  apply: leq_trans (subset_leq_card sub) _; rewrite cardsD (setIidPr _).
    by rewrite cardsX card_imset => [|i j []//]; case: #|C| => // k; rewrite /= mulSn mulnS; lia.
  by apply/subsetP => x /imsetP[i iC ->]; rewrite !inE /= iC.
pose nats (ij : robot * robot) := ((ij.1 : nat), (ij.2 : nat)).
have inj : injective nats by move=> [i j] [k l] [/val_inj-> /val_inj->].
have half (P : pred (robot * robot)) : (forall ij, P ij -> nats ij \in link_list w) -> (#|P| <= size (link_list w))%N.
  move=> sub; rewrite cardE -(size_map nats); apply: uniq_leq_size; first by rewrite map_inj_uniq ?enum_uniq.
  by move=> x /mapP[ij]; rewrite mem_enum => /sub h ->.
pose P1 := [pred ij : robot * robot | nats ij \in link_list w].
pose P2 := [pred ij : robot * robot | nats (ij.2, ij.1) \in link_list w].
have le2 : (#|P2| <= size (link_list w))%N.
  pose swap (ij : robot * robot) := (ij.2, ij.1).
  have inj_swap : injective swap by move=> [i j] [k l] [-> ->].
  rewrite -(card_image inj_swap P2); apply: half => ij /imageP[[i j] /= hij ->]; exact: hij.
apply: leq_trans (leq_add (half P1 _) le2) => //; rewrite -cardUI; apply: leq_trans (leq_addr _ _).
apply: subset_leq_card; apply/subsetP => ij; rewrite !inE => /and3P[_ _]; rewrite /adjacent /linkmem /=.
by rewrite /nats /=.
Qed.

Lemma cost_by_sizeP : Z.le (cost_by_size w near d #|C|) cost.
Proof.
rewrite costE inner_pairsE /cost_by_size; have := smallest_sumP (A := C) size_charges; have := few_pairs; have := h_ge0.
by rewrite -/(charge _); move: (minn _ _) (smallest_sum _ _) (\sum_(i in C) _) => x y z; nia.
Qed.

(** *** Costs are multiples of a step *)
Lemma even_pairs : exists k, inner_links C C = Z.add k k.
Proof.
exists (\sum_(i : robot) \sum_(j : robot) if [&& (i < j)%N, i \in C & j \in C] then zadj i j else Z0).
rewrite [X in _ = Z.add _ X]exchange_big sum_add /inner_links sum_mkcond; apply: eq_bigr => i _.
rewrite sum_add sum_mkcond; case iC: (i \in C); last by rewrite big1 // => j _; rewrite !andbF.
apply: eq_bigr => j _; rewrite !andbT /zadj (adj_sym j i); case jC: (j \in C); rewrite ?andbF ?andbT //.
have [lt|gt|/val_inj ->] := ltngtP i j; last by rewrite adj_irr.
  by rewrite /=; case: (adj i j).
by rewrite /=; case: (adj i j).
Qed.

Lemma step_divides : Z.divide (step near d) cost.
Proof.
have divides s x : x \in s -> Z.divide (foldr Z.gcd (Z.add h h) s) x.
  elim: s => [//|y s IH]; rewrite in_cons => /orP[/eqP->|/IH le] /=; first exact: Z.gcd_divide_l.
  exact: Z.divide_trans (Z.gcd_divide_r _ _) le.
have first s : Z.divide (foldr Z.gcd (Z.add h h) s) (Z.add h h).
  by elim: s => [|y s IH] /=; [exact: Z.divide_refl | exact: Z.divide_trans (Z.gcd_divide_r _ _) IH].
rewrite costE; apply: Z.divide_sub_r.
  elim/big_ind: _ => [|x y|i _]; [exact: Z.divide_0_r | exact: Z.divide_add_r |].
  by apply: divides; rewrite mem_nth ?size_charges ?ltn_ord.
have [k ->] := even_pairs; have -> : Z.mul h (Z.add k k) = Z.mul (Z.add h h) k by lia.
by apply: Z.divide_mul_l; apply: first.
Qed.

Lemma step_ge0 : Z.le 0 (step near d).
Proof.
rewrite /step; have := h_ge0; elim: (charges _ _) => [|x s _] /= h0; first by lia.
exact: Z.gcd_nonneg.
Qed.

Lemma round_upP x : Z.le x cost -> Z.le (round_up near d x) cost.
Proof.
have [k ->] := step_divides; rewrite /round_up; have := step_ge0; move: (step near d) => q q0 le.
have [q0'|q1] := Z.eq_dec q 0; first by rewrite q0' !Z.mul_0_r.
have pos : Z.lt 0 q by lia.
have le1 : Z.le (Z.mul (Z.opp k) q) (Z.opp x) by lia.
by have := Z.div_le_mono _ _ _ pos le1; rewrite Z.div_mul // => h1; nia.
Qed.

(** *** Forms *)
Section Above.
Variables (limit : Z) (diagonal : seq Z) (ins others : seq bool) (In Ot : {set robot}).
Hypotheses (ins_size : size ins = robots w) (others_size : size others = robots w)
  (insE : forall i : robot, nth false ins i = (i \in In)) (othersE : forall i : robot, nth false others i = (i \in Ot))
  (apart : [disjoint In & Ot]) (In_C : In \subset C) (C_sub : C \subset In :|: Ot).
Local Notation X := (C :\: In).

Lemma room_ofE : room_of near d limit ins = Z.sub (Z.sub (\sum_(i in In) charge i) (Z.mul h (inner_links In In))) limit.
Proof.
rewrite /room_of; congr (Z.sub _ _); have sc := size_charges.
rewrite (zsum_nth (false, (Z0, [::])) (n := robots w)); last by rewrite !size_zip sc size_rows ins_size !minnn.
rewrite /inner_links (sum_mkcond In (fun i => \sum_(j in In) _)) sum_mkcond sum_scale.
rewrite -[RHS]/(Z.add _ (Z.opp _)) sum_opp sum_add; apply: eq_bigr => i _.
have fstE (T U : Type) (x : T) (y : U) : (x, y).1 = x by [].
have sndE (T U : Type) (x : T) (y : U) : (x, y).2 = y by [].
rewrite nth_zip ?size_zip ?sc ?size_rows ?ins_size ?minnn // nth_zip ?sc ?size_rows // !sndE !fstE insE.
case: (i \in In); last by lia.
have -> : links_to (nth [::] near i) ins = \sum_(j in In) zadj i j by rewrite (count_row i ins_size insE) sum_mkcond.
by rewrite -/(charge i); move: (charge i) (\sum_(j in In) zadj i j) => x y; lia.
Qed.

Lemma count_others : count id others = #|Ot|.
Proof.
rewrite -sum1_count big_mkcond (big_nth false) others_size big_mkord -sum1_card [RHS]big_mkcond; apply: eq_bigr => i _.
by rewrite othersE.
Qed.

Lemma X_sub : X \subset Ot.
Proof.
apply/subsetP => i; rewrite in_setD => /andP[iI iC]; have := subsetP C_sub i iC; rewrite in_setU (negbTE iI). by [].
Qed.

Lemma split_sum (f : robot -> Z) : \sum_(i in C) f i = Z.add (\sum_(i in In) f i) (\sum_(i in X) f i).
Proof.
rewrite !sum_mkcond sum_add; apply: eq_bigr => i _; rewrite in_setD.
have := subsetP In_C i; case: (i \in In) => /=; last by case: (i \in C); lia.
by move=> /(_ isT) ->; lia.
Qed.

Lemma inner_sym (P Q : {set robot}) : inner_links P Q = inner_links Q P.
Proof.
rewrite /inner_links exchange_big /=; apply: eq_bigr => i _; apply: eq_bigr => j _; by rewrite /zadj adj_sym.
Qed.

Lemma inner_split : inner_links C C = Z.add (inner_links In In) (Z.add (Z.mul 2 (inner_links X In)) (inner_links X X)).
Proof.
have row i : \sum_(j in C) zadj i j = Z.add (\sum_(j in In) zadj i j) (\sum_(j in X) zadj i j) by apply: split_sum.
have cut (P : {set robot}) : inner_links P C = Z.add (inner_links P In) (inner_links P X).
  rewrite /inner_links !sum_mkcond sum_add; apply: eq_bigr => i _; rewrite row; case: (i \in P); lia.
have := split_sum (fun i => \sum_(j in C) zadj i j); rewrite -!/(inner_links _ _) !cut (inner_sym In X); lia.
Qed.

Lemma room_cost : C = In -> Z.lt 0 (room_of near d limit ins) -> Z.lt limit cost.
Proof. by move=> e; rewrite room_ofE -e costE; lia. Qed.

Local Notation os := [seq i <- iota 0 (robots w) | nth false others i].
Local Notation room := (room_of near d limit ins).
Local Notation A := (form_matrix near d room diagonal ins os).
Definition is_in (i : nat) : Z := if robot_of w i \in C then Zpos xH else Z0.
Definition point (a : nat) : Z := if a is b.+1 then is_in (nth 0%N os b) else Zpos xH.

Lemma sum_os (f : nat -> Z) : \sum_(a < size os) f (nth 0%N os a) = \sum_(i in Ot) f i.
Proof.
rewrite -(big_mkord xpredT (fun a => f (nth 0%N os a))) -(big_nth 0%N xpredT f) big_filter.
rewrite (_ : iota 0 (robots w) = index_iota 0 (robots w)) ?big_mkord; last by rewrite /index_iota subn0.
by apply: eq_bigl => i; rewrite othersE.
Qed.

Lemma size_os : size os = #|Ot|.
Proof.
rewrite -count_others -[in RHS](mkseq_nth false others) others_size /mkseq count_map size_filter.
exact: eq_count.
Qed.

Definition slope (i : nat) : Z :=
  Z.sub (Z.mul unit_of (Z.sub (nth Z0 (charges near d) i) (Z.mul (Z.add h h) (links_to (nth [::] near i) ins)))) (nth Z0 diagonal i).
Definition curve (i j : nat) : Z :=
  Z.sub (if j == i then Z.add (nth Z0 diagonal i) (nth Z0 diagonal i) else Z0)
    (if nth false (nth [::] near i) j then Z.mul unit_of (Z.add h h) else Z0).

Lemma entryE a b : (a < (size os).+1)%N -> (b < (size os).+1)%N -> entry_at A a b =
  match a, b with
  | 0, 0 => Z.mul (Z.add unit_of unit_of) room
  | 0, j.+1 => slope (nth 0%N os j)
  | i.+1, 0 => slope (nth 0%N os i)
  | i.+1, j.+1 => curve (nth 0%N os i) (nth 0%N os j)
  end.
Proof.
rewrite /entry_at; case: a b => [|a] [|b] //; rewrite ?ltnS => al bl.
- by rewrite [nth [::] _ _]/= [nth Z0 _ _]/= (nth_map [::]) ?size_map // (nth_map 0%N).
- by rewrite [nth [::] _ _]/= (nth_map 0%N).
by rewrite [nth [::] _ _]/= (nth_map 0%N) // [nth Z0 _ _]/= (nth_map 0%N).
Qed.

Lemma os_below a : (a < size os)%N -> (nth 0%N os a < robots w)%N.
Proof. by move/(mem_nth 0%N); rewrite mem_filter mem_iota add0n => /andP[_ /andP[]]. Qed.

Lemma entry_sym a b : (a < (size os).+1)%N -> (b < (size os).+1)%N -> entry_at A a b = entry_at A b a.
Proof.
move=> al bl; rewrite !entryE //; case: a b al bl => [|a] [|b] //; rewrite !ltnS => al bl.
rewrite /curve eq_sym; congr (Z.sub _ _); first by case: eqP => [->|].
by rewrite !nth_rows ?os_below // /linkmem orbC.
Qed.

Lemma is_inE (i : robot) : is_in i = if i \in C then Zpos xH else Z0.
Proof. by rewrite /is_in robot_of_val. Qed.

Lemma sum_in (f : robot -> Z) : \sum_(i in Ot) Z.mul (is_in i) (f i) = \sum_(i in X) f i.
Proof.
rewrite !sum_mkcond; apply: eq_bigr => i _; rewrite is_inE in_setD.
have [iO|iO] := boolP (i \in Ot); have [iC|iC] := boolP (i \in C); rewrite ?andbT ?andbF //.
  by rewrite (disjointFl apart iO) Z.mul_1_l.
have : i \notin X by apply: contra iO; apply: (subsetP X_sub).
by rewrite in_setD iC andbT => /negbTE->.
Qed.

(** The value of the form at the group: by how much it costs more, in units. *)
Lemma form_value : zquad (size os).+1 A point = Z.mul (Z.add unit_of unit_of) (Z.sub cost limit).
Proof.
rewrite /zquad.
have row0 : \sum_(b < (size os).+1) Z.mul (Z.mul (point 0) (entry_at A 0 b)) (point b) =
    Z.add (Z.mul (Z.add unit_of unit_of) room) (\sum_(i in X) slope i).
  rewrite big_ord_recl -(sum_in (fun i => slope i)) -(sum_os (fun x => Z.mul (is_in x) (slope x))).
  congr (Z.add _ _); first by rewrite -[LHS]/(Z.mul (Z.mul (Zpos xH) (entry_at A 0 0)) (Zpos xH)) Z.mul_1_l Z.mul_1_r entryE.
  apply: eq_bigr => b _; rewrite lift0 -[point 0]/(Zpos xH) Z.mul_1_l entryE ?ltnS // -[point _]/(is_in _).
  exact: Z.mul_comm.
have row (a : 'I_(size os)) : \sum_(b < (size os).+1) Z.mul (Z.mul (point a.+1) (entry_at A a.+1 b)) (point b) =
    Z.mul (is_in (nth 0%N os a)) (Z.add (slope (nth 0%N os a)) (\sum_(j in X) curve (nth 0%N os a) j)).
  rewrite big_ord_recl -(sum_in (fun j => curve (nth 0%N os a) j)) -(sum_os (fun x => Z.mul (is_in x) (curve (nth 0%N os a) x))).
  rewrite Z.mul_add_distr_l sum_scale; congr (Z.add _ _).
    by rewrite entryE ?ltnS // -[point 0]/(Zpos xH) Z.mul_1_r.
  apply: eq_bigr => b _; rewrite lift0 entryE ?ltnS // -![point _.+1]/(is_in _).
  by move: (curve _ _) (is_in _) (is_in _) => x y z; lia.
rewrite big_ord_recl row0.
rewrite (eq_bigr (fun a : 'I_(size os) => Z.mul (is_in (nth 0%N os a))
  (Z.add (slope (nth 0%N os a)) (\sum_(j in X) curve (nth 0%N os a) j)))) => [|a _]; last by rewrite lift0 row.
rewrite (sum_os (fun i => Z.mul (is_in i) (Z.add (slope i) (\sum_(j in X) curve i j)))).
rewrite (sum_in (fun i => Z.add (slope i) (\sum_(j in X) curve i j))).
have curves (i : robot) : i \in X -> \sum_(j in X) curve i j = Z.sub (Z.add (nth Z0 diagonal i) (nth Z0 diagonal i))
    (Z.mul (Z.mul unit_of (Z.add h h)) (\sum_(j in X) zadj i j)).
  move=> iX; rewrite !sum_mkcond sum_scale -[RHS]/(Z.add _ (Z.opp _)) sum_opp.
  have -> : Z.add (nth Z0 diagonal i) (nth Z0 diagonal i) =
      \sum_(j : robot) if j == i then Z.add (nth Z0 diagonal i) (nth Z0 diagonal i) else Z0.
    by rewrite -big_mkcond big_pred1_eq.
  rewrite sum_add; apply: eq_bigr => j _; rewrite /curve nth_rows // -/(adj i j) /zadj.
  rewrite -[(j : nat) == i]/(j == i); have [->|ne] := eqVneq j i; first by rewrite iX adj_irr; lia.
  by case: (j \in X); case: (adj i j); lia.
have slopes (i : robot) : slope i = Z.sub (Z.mul unit_of (Z.sub (charge i) (Z.mul (Z.add h h) (\sum_(j in In) zadj i j)))) (nth Z0 diagonal i).
  by rewrite /slope (count_row i ins_size insE) -sum_mkcond.
rewrite room_ofE costE inner_split split_sum /inner_links.
have e1 : \sum_(i in X) slope i = Z.sub (Z.mul unit_of (Z.sub (\sum_(i in X) charge i) (Z.mul (Z.add h h)
    (\sum_(i in X) \sum_(j in In) zadj i j)))) (\sum_(i in X) nth Z0 diagonal i).
  rewrite !sum_mkcond; rewrite -[Z.sub _ (\sum_i _)]/(Z.add _ (Z.opp _)).
  rewrite !sum_scale -[Z.sub (\sum_i _) _]/(Z.add _ (Z.opp _)) !sum_opp !sum_add !sum_scale sum_add; apply: eq_bigr => i _.
  by rewrite slopes; case: (i \in X); lia.
have e2 : \sum_(i in X) Z.add (slope i) (\sum_(j in X) curve i j) = Z.sub (Z.add (\sum_(i in X) slope i)
    (Z.add (\sum_(i in X) nth Z0 diagonal i) (\sum_(i in X) nth Z0 diagonal i)))
    (Z.mul (Z.mul unit_of (Z.add h h)) (\sum_(i in X) \sum_(j in X) zadj i j)).
  rewrite -[RHS]/(Z.add _ (Z.opp _)) !(sum_mkcond X) sum_scale sum_opp !sum_add; apply: eq_bigr => i _.
  case iX: (i \in X); last by lia.
  by rewrite (curves i iX); lia.
rewrite e2 e1 /unit_of.
move: (\sum_(i in In) charge i) (\sum_(i in X) charge i) (\sum_(i in X) nth Z0 diagonal i)
  (\sum_(i in In) \sum_(j in In) zadj i j) (\sum_(i in X) \sum_(j in In) zadj i j) (\sum_(i in X) \sum_(j in X) zadj i j).
by move=> s1 s2 u a b c; move: (link_price d) => q; lia.
Qed.

(** *** The last robot written by the others *)
Section Reduced.
Variable k : Z.
Hypotheses (many : (0 < size os)%N) (kE : Z.of_nat #|X| = k).
Local Notation m := (size os).
Local Notation N := (reduced m k A).
Local Notation coefficient a := (last_coefficient k a).

Lemma reducedE a b : (a < m)%N -> (b < m)%N -> entry_at N a b =
  Z.add (Z.add (entry_at A a b) (Z.mul (entry_at A a m) (coefficient b)))
    (Z.mul (coefficient a) (Z.add (entry_at A m b) (Z.mul (coefficient b) (entry_at A m m)))).
Proof. by move=> al bl; rewrite /entry_at (nth_map 0%N) ?size_iota // (nth_map 0%N) ?size_iota // !nth_iota. Qed.

Lemma reduced_square : square_of m N.
Proof.
rewrite /square_of size_map size_iota eqxx /=; apply/allP => row /mapP[a _ ->]; by rewrite size_map size_iota.
Qed.

Lemma reduced_sym a b : (a < m)%N -> (b < m)%N -> entry_at N a b = entry_at N b a.
Proof.
move=> al bl; have aL : (a < m.+1)%N by apply: ltnW.
have bL : (b < m.+1)%N by apply: ltnW.
rewrite !reducedE // (entry_sym aL bL) (entry_sym aL (ltnSn m)) (entry_sym (ltnSn m) bL).
move: (coefficient a) (coefficient b) (entry_at A b a) (entry_at A m a) (entry_at A b m) (entry_at A m m).
by move=> x y p q r t; lia.
Qed.

Lemma last_point : \sum_(a < m) Z.mul (coefficient a) (point a) = point m.
Proof.
have total : \sum_(a < m) point a.+1 = k.
  by rewrite -kE (sum_os (fun x => is_in x)) -sum_count -(sum_in (fun _ => Zpos xH)); apply: eq_bigr => i _; lia.
have := many; case: m total => [//|m'] total _.
rewrite big_ord_recl -total big_ord_recr /=.
have -> : \sum_(a < m') Z.mul (coefficient (lift ord0 a)) (point (lift ord0 a)) = Z.opp (\sum_(a < m') point a.+1).
  by rewrite sum_opp; apply: eq_bigr => a _; rewrite lift0 -[coefficient a.+1]/(Zneg xH); lia.
move: (\sum_(a < m') _) (is_in _) => x y; lia.
Qed.

Lemma reduced_value : zquad m N point = zquad m.+1 A point.
Proof.
have last := last_point; set x := point in last *; set e := fun a => coefficient a in last.
have row a : (a < m)%N -> \sum_(b < m) Z.mul (Z.mul (x a) (entry_at N a b)) (x b) =
    Z.add (Z.add (\sum_(b < m) Z.mul (Z.mul (x a) (entry_at A a b)) (x b)) (Z.mul (Z.mul (x a) (entry_at A a m)) (x m)))
      (Z.mul (Z.mul (e a) (x a)) (Z.add (\sum_(b < m) Z.mul (entry_at A m b) (x b)) (Z.mul (x m) (entry_at A m m)))).
  move=> al; rewrite -last [Z.mul (\sum_(b < m) _) _]Z.mul_comm !sum_scale !sum_add !sum_scale !sum_add; apply: eq_bigr => b _.
  rewrite reducedE // -/(e a) -/(e b); move: (x a) (x b) (e a) (e b) => p q r t.
  by move: (entry_at A a b) (entry_at A a m) (entry_at A m b) (entry_at A m m) => ? ? ? ?; lia.
rewrite /zquad (eq_bigr (fun a : 'I_m => _) (fun a _ => row a (ltn_ord a))) -!sum_add.
set t := Z.add (\sum_(b < m) Z.mul (entry_at A m b) (x b)) _.
have -> : \sum_(a < m) Z.mul (Z.mul (e a) (x a)) t = Z.mul (x m) t.
  rewrite -last [RHS]Z.mul_comm sum_scale; apply: eq_bigr => a _; rewrite /e; move: t (coefficient a) (x a) => ? ? ?.
  by lia.
rewrite [RHS]big_ord_recr /= big_ord_recr /=.
have -> : \sum_(a < m) \sum_(b < m.+1) Z.mul (Z.mul (x a) (entry_at A a b)) (x b) =
    \sum_(a < m) Z.add (\sum_(b < m) Z.mul (Z.mul (x a) (entry_at A a b)) (x b)) (Z.mul (Z.mul (x a) (entry_at A a m)) (x m)).
  by apply: eq_bigr => a _; rewrite big_ord_recr.
rewrite -sum_add /t; have -> : \sum_(b < m) Z.mul (Z.mul (x m) (entry_at A m b)) (x b) =
    Z.mul (x m) (\sum_(b < m) Z.mul (entry_at A m b) (x b)).
  by rewrite sum_scale; apply: eq_bigr => b _; lia.
move: (\sum_(b < m) Z.mul (entry_at A m b) (x b)) (x m) (entry_at A m m) => ? ? ?.
by move: (\sum_(a < m) _) (\sum_(a < m) _) => ? ?; rewrite -[GRing.add _ _]/(Z.add _ _) -[GRing.add _ _]/(Z.add _ _); lia.
Qed.
End Reduced.
End Above.

Theorem is_aboveP limit diagonal ins others (In Ot : {set robot}) k : size ins = robots w -> size others = robots w ->
  (forall i : robot, nth false ins i = (i \in In)) -> (forall i : robot, nth false others i = (i \in Ot)) ->
  [disjoint In & Ot] -> In \subset C -> C \subset In :|: Ot -> Z.of_nat #|C| = Z.add (Z.of_nat #|In|) k ->
  is_above w near d limit diagonal ins others k -> Z.lt limit cost.
Proof.
move=> si so insE othersE apart In_C C_sub kE; have XO := X_sub C_sub.
have kX : Z.of_nat #|C :\: In| = k.
  have := subset_leq_card In_C; rewrite cardsD (setIidPr In_C); move: #|C| #|In| kE => a b e; lia.
rewrite /is_above (count_others so othersE); cbv zeta; case km: (Z.eqb k (Z.of_nat #|Ot|)); cbv iota; last first.
  move/Z.eqb_neq: km => km; case: ifP => [/andP[/Z.ltb_lt k0 /Z.ltb_lt kO]|small].
    rewrite -{1 2}(size_os so othersE) => pos.
    have many : (0 < size [seq i <- iota 0 (robots w) | nth false others i])%N.
      by rewrite (size_os so othersE); move: #|Ot| kO => a; lia.
    have some : exists2 i, (i < size [seq i <- iota 0 (robots w) | nth false others i])%N & point others i <> Z0.
      by exists 0%N.
    have := zquad_gt0 (reduced_square limit diagonal ins others k)
      (reduced_sym limit diagonal si so apart In_C C_sub k many) pos some.
    rewrite (reduced_value limit diagonal si so othersE apart In_C C_sub many kX).
    by rewrite (form_value limit diagonal si so insE othersE apart In_C C_sub) /unit_of; lia.
  have kz : k = Z0.
    have := subset_leq_card XO; move: #|C :\: In| #|Ot| kX km small => a b e1 e2; lia.
  rewrite kz => /Z.ltb_lt pos; have e : C = In.
    apply/eqP; rewrite eqEsubset In_C andbT -setD_eq0 -cards_eq0; move: #|C :\: In| kX => a; lia.
  exact: (room_cost si so insE apart In_C C_sub e pos).
move/Z.eqb_eq: km => km; have e : C = In :|: Ot.
  apply/eqP; rewrite eqEsubset C_sub subUset In_C /=; have /eqP <- : C :\: In == Ot; last exact: subsetDl.
  by rewrite eqEcard XO /=; move: #|Ot| #|C :\: In| km kX => a b; lia.
move=> /Z.ltb_lt pos; have sz : size (nseq (robots w) false) = robots w by rewrite size_nseq.
have none : [disjoint C & set0] by rewrite disjoint_sym disjoints_subset sub0set.
have all_C : C \subset C :|: set0 by rewrite setU0.
have sm : size [seq x.1 || x.2 | x <- zip ins others] = robots w by rewrite size_map size_zip si so minnn.
have maskE (i : robot) : nth false [seq x.1 || x.2 | x <- zip ins others] i = (i \in C).
  rewrite (nth_map (false, false)) ?size_zip ?si ?so ?minnn // nth_zip ?si ?so //=.
  by rewrite insE othersE -in_setU -e.
exact: (room_cost sm sz maskE none (fintype.subxx _) all_C erefl pos).
Qed.
End OneCost.
