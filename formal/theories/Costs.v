(** What groups cost at dual prices of links, robots and blinding, and flows that bound it from below in a case. *)
From Coq Require Import ZArith.
From mathcomp Require Import all_ssreflect all_algebra.
From mathcomp.zify Require Import zify ssrZ.
From Ratt Require Import Extrema Teams Graph CaseTree.
Set Implicit Arguments.
Unset Strict Implicit.
Unset Printing Implicit Defensive.
Import Order.Theory GRing.Theory Num.Theory.

(** Prices of a link, of each robot (of any sign) and of a blinded robot. *)
Record prices := Prices { link_price : Z; robot_prices : seq Z; blind_price : Z }.
(** Extra prices of a blinded robot and of a cut link, and what is carried from robot to robot (row by row). *)
Record flow_bound := FlowBound { more_blind : Z; more_cut : Z; carried : seq (seq Z) }.

Definition zsum (s : seq Z) : Z := foldr Z.add Z0 s.

(** Who is linked to whom, row by row. *)
Definition rows_of (w : network) (ls : seq link) : seq (seq bool) :=
  [seq let ns := neighbours ls i in [seq j \in ns | j <- iota 0 (robots w)] | i <- iota 0 (robots w)].

(** Links of one row to robots inside, to robots out for sure, and what flows to the others. *)
Fixpoint scan (near : seq bool) (flow : seq Z) (os : seq option_set) (i o f : Z) {struct os} : Z * Z * Z :=
  match near, flow, os with
  | b :: near', x :: flow', p :: os' =>
      if b then
        if inside p then scan near' flow' os' (Z.succ i) o f
        else if gone p then scan near' flow' os' i (Z.succ o) f
        else scan near' flow' os' i o (Z.add f x)
      else scan near' flow' os' i o f
  | _, _, _ => (i, o, f)
  end.

(** The [k] largest of numbers that are not negative. *)
Definition largest_sum (k : nat) (s : seq Z) : Z :=
  let t := Z.max Z0 (nth Z0 (sort (fun x y => Z.leb y x) s) k.-1) in
  Z.add (zsum [seq Z.max Z0 (Z.sub x t) | x <- s]) (Z.mul (Z.of_nat k) t).

Section Checker.
Variables (w : network) (d : prices).

Definition spare : nat := minn (blind_budget w) (count (fun i => i \notin kept_robots w) (iota 0 (robots w))).
(** The costs of all groups of an attack add up to at most this. *)
Definition slack : Z :=
  Z.sub (Z.add (Z.mul (link_price d) (Z.of_nat (cut_budget w + cut_budget w))) (Z.mul (blind_price d) (Z.of_nat spare)))
    (zsum (robot_prices d)).
Definition prices_ok : bool :=
  [&& Z.leb Z0 (link_price d), Z.leb Z0 (blind_price d) & size (robot_prices d) == robots w].

Variables (near tied : seq (seq bool)).

Definition capacity (b : flow_bound) : Z := Z.add (link_price d) (more_cut b).
Definition pair_ok (b : flow_bound) (i j : nat) : bool :=
  let x := nth Z0 (nth [::] (carried b) i) j in
  Z.eqb x (Z.opp (nth Z0 (nth [::] (carried b) j) i)) &&
  (nth false (nth [::] tied i) j || Z.leb x (capacity b)).
Definition bound_ok (b : flow_bound) : bool :=
  [&& Z.leb Z0 (more_blind b), Z.leb Z0 (more_cut b), size (carried b) == robots w,
      all (fun row => size row == robots w) (carried b)
    & all (fun i => let row := nth [::] near i in
        all (fun j => ~~ nth false row j || pair_ok b i j) (iota 0 (robots w))) (iota 0 (robots w))].

(** What a robot adds at least: inside, if it does not sense (or must); otherwise if it does not, and what it adds less
    by sensing. *)
Definition blinding (b : flow_bound) : Z := Z.add (blind_price d) (more_blind b).
Definition robot_bound (b : flow_bound) (os : seq option_set) (x : option_set * seq bool * (seq Z * Z)) : Z * Z :=
  let: (o, row, (flow, u)) := x in
  if gone o then (Z0, Z0) else
  let: (to_in, to_out, f) := scan row flow os Z0 Z0 Z0 in
  let fixed := Z.mul (capacity b) to_out in
  if inside o then (Z.sub fixed (if sure o then u else Z.sub u (blinding b)), Z0)
  else
    let sense := Z.sub (Z.add fixed f) u in
    let out := Z.mul (capacity b) to_in in
    let other := if may_blind o then Z.min (Z.add sense (blinding b)) out else out in
    (other, if may_sense o then Z.max Z0 (Z.sub other sense) else Z0).

(** Open robots inside that sense at most, if others that sense are blinded in their place: [low] robots are blinded,
    and only so many of those not inside can be that cannot sense. *)
Definition only_blind (o : option_set) : bool := [&& ~~ inside o, may_blind o & ~~ may_sense o].
Definition inner_sensing (S : Type) (c : case S) : nat :=
  let blinded := Z.max Z0 (Z.sub (low c) (Z.of_nat (count only_blind (options c)))) in
  minn (count open_inside (options c))
       (Z.to_nat (Z.sub (Z.sub (Z.of_nat (count_inside c)) (Z.of_nat (seen c))) blinded)).

(** No group of the case costs less. *)
Definition flow_value (S : Type) (b : flow_bound) (c : case S) : Z :=
  let os := options c in
  let each := [seq robot_bound b os x | x <- zip (zip os near) (zip (carried b) (robot_prices d))] in
  let gains := nseq (inner_sensing c) (blinding b) ++ [seq x.2 | x <- each] in
  Z.sub (Z.sub (zsum [seq x.1 | x <- each]) (largest_sum (Z.to_nat (Z.sub (most c) (Z.of_nat (seen c)))) gains))
    (Z.add (Z.mul (more_cut b) (Z.of_nat (cut_budget w))) (Z.mul (more_blind b) (high c))).

(** *** Budgets *)
Definition leaving (os : seq option_set) (rows : seq (seq bool)) : Z :=
  zsum [seq if inside x.1 then Z.of_nat (count (fun y => y.1 && gone y.2) (zip x.2 os)) else Z0 | x <- zip os rows].

(** Robots that a search from some robot inside reaches, among those not out for sure. *)
Fixpoint grow (os : seq option_set) (fuel : nat) (todo : seq nat) (reached : seq bool) : seq bool :=
  match fuel, todo with
  | k.+1, i :: todo' =>
      let new := [seq [&& x.1.1, ~~ gone x.1.2 & ~~ x.2] | x <- zip (zip (nth [::] near i) os) reached] in
      let more := [seq x.2 | x <- zip new (iota 0 (size new)) & x.1] in
      grow os k (more ++ todo') [seq x.1 || x.2 | x <- zip reached new]
  | _, _ => reached
  end.
Definition closed (os : seq option_set) (reached : seq bool) : bool :=
  all (fun x => ~~ x.1 || all (fun y => [|| ~~ y.1.1, gone y.1.2 | y.2]) (zip (zip x.2 os) reached)) (zip reached near).
Definition apart (os : seq option_set) : bool :=
  let n := robots w in
  let i := find inside os in
  let reached := grow os n [:: i] (set_nth false (nseq n false) i true) in
  [&& (size reached == n), has (fun x => inside x.1 && x.2) (zip os reached), has (fun x => inside x.1 && ~~ x.2) (zip os reached)
    & closed os reached].
Definition beyond_budgets (S : Type) (c : case S) : bool :=
  [|| impossible c, Z.ltb (Z.of_nat (cut_budget w)) (leaving (options c) near), Z.ltb Z0 (leaving (options c) tied)
    | apart (options c)].
End Checker.

(** ** Sums over lists and over robots *)
Section Sums.
Local Open Scope ring_scope.

Lemma zsumE (s : seq Z) : zsum s = \sum_(x <- s) x.
Proof. by elim: s => [|x s IH]; rewrite ?big_nil // big_cons -IH. Qed.

Lemma zsum_nth (T : Type) (x0 : T) n (s : seq T) (f : T -> Z) : size s = n ->
  zsum [seq f x | x <- s] = \sum_(i < n) f (nth x0 s i).
Proof. by move=> sz; rewrite zsumE big_map (big_nth x0) sz big_mkord. Qed.

Lemma sum_le (I : finType) (f g : I -> Z) : (forall i, Z.le (f i) (g i)) -> Z.le (\sum_i f i) (\sum_i g i).
Proof.
move=> h; have : \sum_i f i <= \sum_i g i by apply: ler_sum => i _; have := h i; lia.
lia.
Qed.

Lemma sum_nat (I : finType) (f : I -> nat) : Z.of_nat (\sum_i f i)%N = \sum_i Z.of_nat (f i).
Proof. by elim/big_rec2: _ => // i x y _ <-; lia. Qed.

Lemma sum_scale (I : finType) (f : I -> Z) (c : Z) : Z.mul c (\sum_i f i) = \sum_i Z.mul c (f i).
Proof. by elim/big_rec2: _ => [|i x y _ <-]; lia. Qed.

Lemma sum_add (I : finType) (f g : I -> Z) : Z.add (\sum_i f i) (\sum_i g i) = \sum_i Z.add (f i) (g i).
Proof. by elim/big_rec3: _ => // i x y z _ <-; lia. Qed.

Lemma sum_opp (I : finType) (f : I -> Z) : Z.opp (\sum_i f i) = \sum_i Z.opp (f i).
Proof. by elim/big_rec2: _ => // i x y _ <-; lia. Qed.

Lemma sum_count (I : finType) (A : pred I) : \sum_(i | A i) Zpos xH = Z.of_nat #|A|.
Proof. by rewrite sumr_const; elim: #|A| => // k IH; rewrite mulrS IH; lia. Qed.

Lemma sum_set (I : finType) (A : {set I}) (m : Z) : \sum_(i : I) (if i \in A then m else Z0) = Z.mul m (Z.of_nat #|A|).
Proof.
rewrite (_ : \sum_(i : I) _ = \sum_(i in A) m); last by rewrite [RHS]big_mkcond.
by rewrite -sum_count; elim/big_rec2: _ => [|i x y _ ->]; lia.
Qed.

Lemma zsum_cat (s t : seq Z) : zsum (s ++ t) = Z.add (zsum s) (zsum t).
Proof. by elim: s => [|x s IH] //=; rewrite IH; lia. Qed.

Lemma zsum_nseq k (x : Z) : zsum (nseq k x) = Z.mul (Z.of_nat k) x.
Proof. by elim: k => [|k IH]; rewrite // Nat2Z.inj_succ Z.mul_succ_l -IH Z.add_comm. Qed.

(** [a] times [x] and some [f], [k] numbers in all, add up to no more than the [k] largest. *)
Lemma largest_sumP n (f : 'I_n -> Z) (A : {set 'I_n}) k a b (x : Z) (s : seq Z) : size s = n ->
  (forall i : 'I_n, nth Z0 s i = f i) -> (a <= b)%N -> (a + #|A| <= k)%N ->
  Z.le (Z.add (Z.mul (Z.of_nat a) x) (\sum_(i in A) f i)) (largest_sum k (nseq b x ++ s)).
Proof.
move=> sz sf ab Ak; rewrite /largest_sum; set t := Z.max _ _; have t0 : Z.le 0 t by rewrite /t; lia.
clearbody t; rewrite map_cat map_nseq zsum_cat zsum_nseq (zsum_nth Z0 (fun x => Z.max Z0 (Z.sub x t)) sz).
set big := \sum_(i < n) _.
have le1 : Z.le (\sum_(i in A) f i) (Z.add big (Z.mul t (Z.of_nat #|A|))).
  have -> : Z.mul t (Z.of_nat #|A|) = \sum_(i < n) (if i \in A then t else Z0).
    by rewrite -sum_count big_mkcond sum_scale; apply: eq_bigr => i _; case: ifP; lia.
  by rewrite /big sum_add big_mkcond; apply: sum_le => i; rewrite sf; case: (_ \in A); lia.
have le2 : Z.le (Z.mul (Z.of_nat a) x) (Z.add (Z.mul (Z.of_nat b) (Z.max Z0 (Z.sub x t))) (Z.mul t (Z.of_nat a))) by nia.
nia.
Qed.

Lemma part_of_size (T : finType) (A : {set T}) k : (k <= #|A|)%N -> exists2 A' : {set T}, A' \subset A & #|A'| = k.
Proof.
move=> le; exists [set i in take k (enum A)]; first by apply/subsetP => i; rewrite inE => /mem_take; rewrite mem_enum.
by rewrite cardsE; have /card_uniqP-> := take_uniq k (enum_uniq (mem A)); rewrite size_takel // -cardE.
Qed.
End Sums.

Section Rows.
Local Open Scope ring_scope.

Lemma size_rows w ls : size (rows_of w ls) = robots w.
Proof. by rewrite size_map size_iota. Qed.

Lemma size_row w ls i : (i < robots w)%N -> size (nth [::] (rows_of w ls) i) = robots w.
Proof. by move=> il; rewrite (nth_map 0%N) ?size_iota // size_map size_iota. Qed.

Lemma nth_rows w ls i j : (i < robots w)%N -> (j < robots w)%N -> nth false (nth [::] (rows_of w ls) i) j = linkmem ls i j.
Proof.
by move=> il jl; rewrite (nth_map 0%N) ?size_iota // (nth_map 0%N) ?size_iota // !nth_iota // !add0n mem_neighbours.
Qed.

Lemma scanE n near flow os i o f : size near = n -> size flow = n -> size os = n ->
  let linked k := nth false near k in let p k := nth nothing os k in
  scan near flow os i o f =
    (Z.add i (\sum_(k < n) if linked k && inside (p k) then Zpos xH else Z0),
     Z.add o (\sum_(k < n) if linked k && gone (p k) then Zpos xH else Z0),
     Z.add f (\sum_(k < n) if linked k && (~~ inside (p k) && ~~ gone (p k)) then nth Z0 flow k else Z0)).
Proof.
move=> sn sf so /=; elim: n near flow os i o f sn sf so => [|n IH] [|b near] [|x flow] [|q os] i o f //=.
  by rewrite !big_ord0 => _ _ _; congr (_, _, _); lia.
case=> sn [sf] [so]; rewrite !big_ord_recl /=; case: b => /=; last first.
  by rewrite IH //; congr (_, _, _); lia.
have excl : gone q -> ~~ inside q by case: q => [] [] [] [].
case: ifP => qi; first by rewrite IH // [gone q](negbTE _) ?(contraL excl) //=; congr (_, _, _); lia.
by case: ifP => qg; rewrite IH //=; congr (_, _, _); lia.
Qed.
End Rows.

(** ** One group *)
Section Group.
Local Open Scope ring_scope.
Variables (w : network) (d : prices).
Local Notation robot := 'I_(top_robot w).+1.
Variables (C B : {set robot}).
Definition adjacent (i j : robot) : bool := linkmem (link_list w) i j.
Definition tied_to (i j : robot) : bool := linkmem (kept_links w) i j.
Definition price_of (i : robot) : Z := nth Z0 (robot_prices d) i.
Definition links_left : nat := (\sum_(i : robot) \sum_(j : robot) ([&& i \in C, j \notin C & adjacent i j]))%N.
Definition cost : Z :=
  Z.sub (Z.add (Z.mul (link_price d) (Z.of_nat links_left)) (Z.mul (blind_price d) (Z.of_nat (blinded_size C B))))
    (\sum_(i in C) price_of i).

Hypothesis few_links : (links_left <= cut_budget w)%N.
Hypothesis untied : forall i j, i \in C -> j \notin C -> ~~ tied_to i j.
Variables (S : Type) (start : S) (add : S -> nat -> S) (c : case S).
Hypothesis st : stands start add C B c.
Local Notation near := (rows_of w (link_list w)).
Local Notation tied := (rows_of w (kept_links w)).
Local Notation os := (options c).
Local Notation o i := (options_of c (i : robot)).

Lemma not_gone i : i \in C -> ~~ gone (o i).
Proof.
have := stands_may st i; rewrite /may_be /gone => + iC; rewrite iC.
by case: (o i) => [] [] [] []; case: (_ \in B).
Qed.
Lemma not_inside i : i \notin C -> ~~ inside (o i).
Proof. by have := stands_may st i; rewrite /may_be /inside => + iC; rewrite (negbTE iC) => ->. Qed.

Lemma adjacent_sym i j : adjacent i j = adjacent j i.
Proof. by rewrite /adjacent /linkmem orbC. Qed.

Section Flow.
Hypothesis prices_good : prices_ok w d.
Variable b : flow_bound.
Hypothesis good : bound_ok w d near tied b.
Local Notation H := (capacity d b).
Definition flow_at (i j : robot) : Z := nth Z0 (nth [::] (carried b) i) j.
Definition third (i : robot) : bool := ~~ inside (o i) && ~~ gone (o i).
Definition toward (P : robot -> bool) (f : robot -> robot -> Z) (i : robot) : Z :=
  \sum_(j : robot) if adjacent i j && P j then f i j else Z0.
Local Notation to_out := (toward (fun j => gone (o j)) (fun _ _ => H)).
Local Notation to_in := (toward (fun j => inside (o j)) (fun _ _ => H)).
Local Notation out_flow := (toward third flow_at).

Lemma flow_pair i j : adjacent i j -> flow_at i j = Z.opp (flow_at j i) /\ (tied_to i j \/ Z.le (flow_at i j) H).
Proof.
move=> a; case/and5P: good => _ _ _ _ /allP/(_ i); rewrite mem_iota add0n ltn_ord => /(_ isT)/allP/(_ j).
rewrite mem_iota add0n ltn_ord nth_rows ?ltn_ord // -/(adjacent i j) a /= => /(_ isT)/andP[/Z.eqb_eq e].
by rewrite nth_rows ?ltn_ord // => /orP[t|/Z.leb_le le]; split=> //; [left|right].
Qed.

(** What links of the group are lost is no less than what the case knows of them. *)
Definition link_part (i : robot) : Z :=
  Z.add (if inside (o i) then to_out i else Z0)
    (if third i then if i \in C then Z.add (to_out i) (out_flow i) else to_in i else Z0).

Lemma link_partP : Z.le (\sum_(i : robot) link_part i) (Z.mul H (Z.of_nat links_left)).
Proof.
have -> : Z.mul H (Z.of_nat links_left) =
    \sum_(i : robot) \sum_(j : robot) if [&& i \in C, j \notin C & adjacent i j] then H else Z0.
  rewrite /links_left sum_nat sum_scale; apply: eq_bigr => i _; rewrite sum_nat sum_scale; apply: eq_bigr => j _.
  by case: ifP => _ /=; lia.
pose sums (f : robot -> robot -> Z) := \sum_(i : robot) \sum_(j : robot) f i j.
pose t1 i j := if [&& adjacent i j, gone (o j) & inside (o i) || (third i && (i \in C))] then H else Z0.
pose t3 i j := if [&& adjacent i j, third j & third i && (i \in C)] then flow_at i j else Z0.
pose t4 i j := if [&& adjacent i j, inside (o j) & third i && (i \notin C)] then H else Z0.
pose z i j := if [&& adjacent i j, third j && (j \in C) & third i && (i \in C)] then flow_at i j else Z0.
have sumsD f g : sums (fun i j => Z.add (f i j) (g i j)) = Z.add (sums f) (sums g).
  by rewrite /sums sum_add; apply: eq_bigr => i _; rewrite sum_add.
have -> : \sum_(i : robot) link_part i = Z.add (Z.add (sums t1) (sums t3)) (sums t4).
  rewrite -!sumsD; apply: eq_bigr => i _; rewrite /link_part /toward /t1 /t3 /t4.
  have excl : inside (o i) -> third i = false by rewrite /third => ->.
  case ii: (inside (o i)); rewrite ?(excl ii) /=.
    rewrite /= Z.add_0_r; apply: eq_bigr => j _; rewrite !andbF !andbT; lia.
  case ti: (third i) => /=; last by rewrite big1 // => j _; rewrite !andbF.
  case: (i \in C) => /=; last by apply: eq_bigr => j _; rewrite !andbF !andbT; lia.
  by rewrite sum_add; apply: eq_bigr => j _; rewrite !andbF !andbT /=; lia.
have zero : sums z = Z0.
  have : sums z = Z.opp (sums z); last by lia.
  rewrite {1}/sums exchange_big /sums sum_opp; apply: eq_bigr => i _; rewrite sum_opp; apply: eq_bigr => j _.
  rewrite /z adjacent_sym; case a: (adjacent i j) => //=; rewrite [(_ && _) && (_ && _)]andbC; case: ifP => // _.
  by have [-> _] := flow_pair a; lia.
have swap : sums t4 = sums (fun i j => t4 j i) by rewrite /sums exchange_big.
have -> : sums t3 = sums (fun i j => Z.add (t3 i j) (Z.opp (z i j))).
  rewrite sumsD; have -> : sums (fun i j => Z.opp (z i j)) = Z.opp (sums z); last by lia.
  by rewrite /sums sum_opp; apply: eq_bigr => i _; rewrite sum_opp.
rewrite swap -!sumsD; apply: sum_le => i; apply: sum_le => j.
rewrite /t1 /t3 /t4 /z [adjacent j i]adjacent_sym; case a: (adjacent i j) => /=; last by rewrite !andbF; lia.
have [_ cap] := flow_pair a; rewrite /third.
have [iC|iC] := boolP (i \in C); have [jC|jC] := boolP (j \in C); rewrite ?andbT ?andbF ?orbF /=.
- have := not_gone jC; move=> /negbTE->.
  by case: (inside (o i)); case: (inside (o j)); case: (gone (o i)) => /=; lia.
- have un := untied iC jC; have {cap} : Z.le (flow_at i j) H by case: cap => // t; rewrite t in un.
  have := not_gone iC; have := not_inside jC => /negbTE-> /negbTE->.
  by case: (inside (o i)); case: (gone (o j)) => /=; lia.
- by have := not_gone jC; have := not_inside iC => /negbTE-> /negbTE->; rewrite ?andbF /=; lia.
by have := not_inside iC; have := not_inside jC => /negbTE-> /negbTE->; rewrite ?andbF /=; lia.
Qed.

Lemma prices_size : size (robot_prices d) = robots w.
Proof. by case/and3P: prices_good => _ _ /eqP. Qed.

Lemma flow_row (i : robot) : size (nth [::] (carried b) i) = robots w.
Proof.
case/and5P: good => _ _ /eqP sz /allP h _; apply/eqP/h; by rewrite mem_nth ?sz ?ltn_ord.
Qed.

Local Notation dearer := (blinding d b).
Definition bound_of (i : robot) : Z * Z :=
  robot_bound d b os (o i, nth [::] near i, (nth [::] (carried b) i, price_of i)).
(** What robot [i] adds to the group's cost. *)
Definition real_part (i : robot) : Z :=
  Z.add (link_part i) (if i \in C then Z.sub (if i \in B then dearer else Z0) (price_of i) else Z0).

Lemma toward_const P (i : robot) :
  Z.mul H (\sum_(j : robot) if adjacent i j && P j then Zpos xH else Z0) = toward P (fun _ _ => H) i.
Proof. by rewrite sum_scale; apply: eq_bigr => j _; case: ifP; lia. Qed.

Lemma dearer_ge0 : Z.le 0 dearer.
Proof.
rewrite /blinding; case/and3P: prices_good => _ /Z.leb_le h _; case/and5P: good => /Z.leb_le; lia.
Qed.

(** Open robots that sense, inside and not, and blinded robots not inside that may sense. *)
Definition inner : {set robot} := [set i : robot | open_inside (o i) && (i \in C :\: B)].
Definition outer : {set robot} := [set i : robot | (open (o i) && ~~ inside (o i)) && (i \in C :\: B)].
Definition spared : {set robot} := [set i : robot | [&& ~~ inside (o i), may_sense (o i), i \in C & i \in B]].

Lemma bound_ofP (X Q : {set robot}) i : X \subset inner -> Q \subset spared ->
  Z.le (Z.add (Z.sub (bound_of i).1 (if i \in inner :\: X then dearer else Z0))
              (Z.sub (if i \in Q then dearer else Z0) (if i \in X then dearer else Z0)))
       (Z.add (real_part i) (if i \in outer :|: Q then (bound_of i).2 else Z0)).
Proof.
move=> /subsetP/(_ i) Xi /subsetP/(_ i) Qi; have m0 := dearer_ge0; move: Xi Qi.
rewrite /bound_of /robot_bound /real_part /link_part (scanE _ _ _ (size_row _ (ltn_ord i)) (flow_row i) (stands_size st)) /=.
under [\sum_(k < _) if _ && inside _ then _ else _]eq_bigr do rewrite nth_rows ?ltn_ord // -/(adjacent i _).
under [\sum_(k < _) if _ && gone _ then _ else _]eq_bigr do rewrite nth_rows ?ltn_ord // -/(adjacent i _).
under [\sum_(k < _) if _ && (~~ _ && _) then _ else _]eq_bigr do rewrite nth_rows ?ltn_ord // -/(adjacent i _).
rewrite !toward_const -/(third _) -/(out_flow i) !inE.
move: (to_out i) (to_in i) (out_flow i) (price_of i) dearer m0 => x y z u m m0.
have := stands_may st i; rewrite /third /may_be /inside /gone /open_inside /open /sure /inside.
case: (o i) => [] [] [] []; case: (i \in C); case: (i \in B) => //= _;
  by case: (i \in X) => [/(_ isT) // _|_]; case: (i \in Q) => [/(_ isT) // _|_];
  rewrite /=; first [by [] | rewrite -[_ -> False]/(Z.le _ _); lia].
Qed.

Lemma inner_few : (#|inner| <= inner_sensing c + #|spared|)%N.
Proof.
pose i_blind := [set i : robot | inside (o i) && (i \in B)]; pose only := [set i : robot | only_blind (o i) && (i \in C :&: B)].
have e1 : (count_inside c = #|i_blind| + (seen c + #|inner|))%N.
  rewrite (seenE st) /count_inside (count_options st) !sum_mem -!big_split /=; apply: eq_bigr => i _.
  have := stands_may st i; rewrite /may_be !inE /open_inside /open /inside /sure.
  by case: (o i) => [] [] [] []; case: (i \in C); case: (i \in B).
have e2 : (blinded_size C B = #|i_blind| + (#|only| + #|spared|))%N.
  rewrite /blinded_size !sum_mem -!big_split /=; apply: eq_bigr => i _.
  have := stands_may st i; rewrite /may_be !inE /only_blind /inside.
  by case: (o i) => [] [] [] []; case: (i \in C); case: (i \in B).
have l1 : (#|only| <= count only_blind (options c))%N.
  by rewrite (count_options st) sum_mem; apply: leq_sum => i _; rewrite inE; case: (only_blind _); case: (_ \in _).
have l2 : (#|inner| <= count open_inside (options c))%N.
  by rewrite (count_options st) sum_mem; apply: leq_sum => i _; rewrite inE; case: (open_inside _); case: (_ \in _).
have := stands_blinded st; move: e1 e2 l1 l2; rewrite /inner_sensing.
move: #|i_blind| #|only| #|spared| #|inner| (blinded_size C B) => x y z u v; lia.
Qed.

Lemma inner_outer : (seen c + (#|inner| + #|outer|) = sensing_size C B)%N.
Proof.
rewrite (seenE st) /sensing_size !sum_mem -!big_split /=; apply: eq_bigr => i _.
have := stands_may st i; rewrite /may_be !inE /open_inside /open /inside /sure.
by case: (o i) => [] [] [] []; case: (i \in C); case: (i \in B).
Qed.

Lemma total_part : \sum_(i : robot) real_part i =
  Z.add (\sum_(i : robot) link_part i) (Z.sub (Z.mul dearer (Z.of_nat (blinded_size C B))) (\sum_(i in C) price_of i)).
Proof.
have -> : Z.mul dearer (Z.of_nat (blinded_size C B)) = \sum_(i : robot) if i \in C :&: B then dearer else Z0.
  by rewrite /blinded_size -sum_count big_mkcond sum_scale; apply: eq_bigr => i _; case: ifP; lia.
rewrite [X in Z.sub _ X]big_mkcond -[Z.sub _ _]/(Z.add _ (Z.opp _)) sum_opp !sum_add; apply: eq_bigr => i _.
by rewrite /real_part inE; case: (i \in C); case: (i \in B) => /=; lia.
Qed.

Theorem flow_valueP : Z.le (flow_value w d near b c) cost.
Proof.
rewrite /flow_value; set items := zip _ _; set each := map _ items; set few := Z.to_nat _.
have si : size items = robots w.
  rewrite !size_zip size_rows (stands_size st) prices_size; case/and5P: good => _ _ /eqP-> _ _.
  by rewrite !minnn.
have se : size each = robots w by rewrite size_map.
have nth_each (i : robot) : nth (Z0, Z0) each i = bound_of i.
  rewrite (nth_map (nothing, [::], ([::], Z0))) ?si ?ltn_ord // /items.
  rewrite nth_zip; last by rewrite !size_zip size_rows (stands_size st) prices_size; case/and5P: good => _ _ /eqP->.
  rewrite nth_zip ?size_rows ?(stands_size st) // nth_zip //.
  by rewrite prices_size; case/and5P: good => _ _ /eqP->.
have firsts : zsum [seq x.1 | x <- each] = \sum_(i : robot) (bound_of i).1.
  by rewrite (zsum_nth (Z0, Z0) _ se); apply: eq_bigr => i _; rewrite nth_each.
(* Robots inside that sense beyond what is allowed for take the places of blinded ones that may sense. *)
have fewi := inner_few; pose excess := (#|inner| - inner_sensing c)%N.
have [X Xin cX] : exists2 X : {set robot}, X \subset inner & #|X| = excess
  by apply: part_of_size; rewrite /excess leq_subr.
have [Q Qin cQ] : exists2 Q : {set robot}, Q \subset spared & #|Q| = excess
  by apply: part_of_size; rewrite /excess leq_subLR.
have cI : #|inner :\: X| = (#|inner| - excess)%N by rewrite cardsD (setIidPr Xin) cX.
have cO : #|outer :|: Q| = (#|outer| + excess)%N.
  rewrite cardsU cQ; have -> : outer :&: Q = set0; last by rewrite cards0 subn0.
  apply/setP => i; rewrite !inE; apply/negP => /andP[/andP[_ /andP[iB _]] iQ].
  by have := subsetP Qin i iQ; rewrite !inE (negbTE iB) !andbF.
have gains : Z.le (Z.add (Z.mul (Z.of_nat #|inner :\: X|) dearer) (\sum_(i in outer :|: Q) (bound_of i).2))
    (largest_sum few (nseq (inner_sensing c) dearer ++ [seq x.2 | x <- each])).
  apply: largest_sumP => [|i||]; first by rewrite size_map.
  - by rewrite (nth_map (Z0, Z0)) ?se ?ltn_ord // nth_each.
  - by rewrite cI leq_subLR addnC -leq_subLR.
  rewrite cI cO addnCA subnK ?leq_subr // addnC -(leq_add2l (seen c)) inner_outer.
  by have := stands_sensing st; rewrite /few; lia.
have parts : Z.le (Z.sub (\sum_(i : robot) (bound_of i).1) (Z.mul dearer (Z.of_nat #|inner :\: X|)))
    (Z.add (\sum_(i : robot) real_part i) (\sum_(i in outer :|: Q) (bound_of i).2)).
  have four (f g h k : robot -> Z) : \sum_(i : robot) Z.add (Z.sub (f i) (g i)) (Z.sub (h i) (k i)) =
      Z.add (Z.sub (\sum_(i : robot) f i) (\sum_(i : robot) g i)) (Z.sub (\sum_(i : robot) h i) (\sum_(i : robot) k i)).
    elim: (index_enum _) => [|i s IH]; first by rewrite !big_nil.
    rewrite !big_cons IH; move: (\sum_(j <- s) f j) (\sum_(j <- s) g j) (\sum_(j <- s) h j) (\sum_(j <- s) k j).
    by move=> x y z t; lia.
  have := sum_le (fun i : robot => bound_ofP (i := i) Xin Qin); rewrite four !sum_set -sum_add cX cQ Z.sub_diag Z.add_0_r.
  by rewrite [X in Z.le _ (Z.add _ X) -> _](_ : _ = \sum_(i in outer :|: Q) (bound_of i).2) // [RHS]big_mkcond.
have lp := link_partP; rewrite firsts /cost.
have h0 : Z.le 0 (more_blind b) /\ Z.le 0 (more_cut b) by case/and5P: good => /Z.leb_le ? /Z.leb_le ? _ _ _.
have cutted : Z.le (Z.mul (more_cut b) (Z.of_nat links_left)) (Z.mul (more_cut b) (Z.of_nat (cut_budget w))).
  by apply: Z.mul_le_mono_nonneg_l; [case: h0 | lia].
have blinded : Z.le (Z.mul (more_blind b) (Z.of_nat (blinded_size C B))) (Z.mul (more_blind b) (high c)).
  by apply: Z.mul_le_mono_nonneg_l; [case: h0 | case: (stands_blinded st)].
move: lp parts gains cutted blinded; rewrite total_part /capacity /blinding !Z.mul_add_distr_r; lia.
Qed.
End Flow.

(** *** Budgets *)
(** A set of robots that a group meets, and that has every neighbour in the group of its robots there, holds the group. *)
Hypothesis whole : forall X : pred robot, (exists2 i, i \in C & X i) ->
  (forall i j, i \in C -> X i -> j \in C -> adjacent i j -> X j) -> forall j, j \in C -> X j.

Lemma leavingE ls : leaving os (rows_of w ls) =
  \sum_(i : robot) Z.of_nat (\sum_(j : robot) [&& inside (o i), linkmem ls i j & gone (o j)])%N.
Proof.
have so := stands_size st.
rewrite /leaving (zsum_nth (nothing, [::]) (n := robots w)); last by rewrite size_zip size_rows so minnn.
apply: eq_bigr => i _; rewrite nth_zip ?size_rows ?so //=; case: (inside _); last by rewrite big1.
congr Z.of_nat; rewrite -sum1_count big_mkcond (big_nth (false, nothing)) size_zip size_row // so minnn big_mkord.
by apply: eq_bigr => j _; rewrite nth_zip ?size_row ?so //= nth_rows ?ltn_ord //; case: (_ && _).
Qed.

Lemma leaving_left : Z.le (leaving os near) (Z.of_nat links_left).
Proof.
rewrite leavingE /links_left sum_nat; apply: sum_le => i; apply/Nat2Z.inj_le/ssrnat.leP; apply: leq_sum => j _.
case ii: (inside _) => //=; case gj: (gone _); rewrite ?andbF ?andbT //.
have -> : i \in C by apply: contraLR ii => iC; rewrite (negbTE (not_inside iC)).
by have -> : j \notin C; [apply: contraL gj => jC; rewrite (negbTE (not_gone jC)) | rewrite /= leqnn].
Qed.

(** Where every robot is inside or out for sure, the links that leave the group are known. *)
Lemma leaving_all : (forall i : robot, inside (o i) || gone (o i)) -> leaving os near = Z.of_nat links_left.
Proof.
move=> decided; rewrite leavingE /links_left sum_nat; apply: eq_bigr => i _; congr Z.of_nat; apply: eq_bigr => j _.
have side k : (k \in C) = inside (o k) /\ (k \in C) = ~~ gone (o k).
  have [kC|kC] := boolP (k \in C); first by move: (decided k); rewrite (negbTE (not_gone kC)) orbF.
  by move: (decided k); rewrite (negbTE (not_inside kC)) /= => ->.
by have [-> _] := side i; have [_ ->] := side j; rewrite negbK; case: (inside _) => //=; rewrite andbC.
Qed.

Lemma leaving_tied : leaving os tied = Z0.
Proof.
rewrite leavingE big1 // => i _; rewrite big1 // => j _.
case ii: (inside _) => //=; case gj: (gone _); rewrite ?andbF ?andbT //.
have iC : i \in C by apply: contraLR ii => iC; rewrite (negbTE (not_inside iC)).
have jC : j \notin C by apply: contraL gj => jC; rewrite (negbTE (not_gone jC)).
by have := untied iC jC; rewrite /tied_to; case: (linkmem _ _ _).
Qed.

Lemma has_nth2 (T U : Type) x0 y0 (P : T * U -> bool) (s : seq T) (t : seq U) : size s = robots w -> size t = robots w ->
  has P (zip s t) -> exists i : robot, P (nth x0 s i, nth y0 t i).
Proof.
move=> ss st' /(has_nthP (x0, y0))[i]; rewrite size_zip ss st' minnn => il; rewrite nth_zip ?ss ?st' // => h.
by exists (Ordinal il).
Qed.

Lemma not_apart : ~~ apart w near os.
Proof.
apply/negP; rewrite /apart; set r := grow _ _ _ _ _ => /and4P[/eqP sr h1 h2 cl]; have so := stands_size st.
have [i /= /andP[ii ri]] := has_nth2 nothing false so sr h1.
have [j /= /andP[ij rj]] := has_nth2 nothing false so sr h2.
have inC k : inside (o k) -> k \in C by apply: contraLR => kC; apply: not_inside.
suff : nth false r j by apply/negP.
apply: (whole (X := fun k => nth false r k)); [by exists i => //; apply: inC | | exact: inC].
move=> k l kC rk lC akl; move: cl => /(all_nthP (false, [::]))/(_ (k : nat)).
rewrite size_zip sr size_rows minnn ltn_ord nth_zip ?sr ?size_rows //= rk /= => /(_ isT)/(all_nthP (false, nothing, false))/(_ (l : nat)).
have s1 : size (zip (nth [::] near k) os) = robots w by rewrite size_zip size_row // so minnn.
rewrite size_zip s1 sr minnn ltn_ord nth_zip ?s1 ?sr // nth_zip ?size_row ?so // nth_rows ?ltn_ord //= => /(_ isT).
by rewrite -/(adjacent k l) akl -/(options_of c l) (negbTE (not_gone lC)).
Qed.

Theorem not_beyond_budgets : ~~ beyond_budgets w near tied c.
Proof.
have := not_impossible st; have := leaving_left => l; have a := not_apart.
by rewrite /beyond_budgets leaving_tied (negbTE a) => /negbTE->; lia.
Qed.
End Group.
