(** Bounds by gains, for log-det: some robots of a group are fixed, and each of the others adds at most what it gains alone
    beside them. Information gains less beside more information. *)
From Coq Require Import ZArith NArith.
From mathcomp Require Import all_ssreflect all_algebra.
From Ratt Require Import Quadratic Criteria Logdet Submodular Dyadic DyadicMatrix DyadicLog Scores.
Set Implicit Arguments.
Unset Strict Implicit.
Unset Printing Implicit Defensive.
Import Order.Theory GRing.Theory Num.Theory.

(** A product rounded up to a multiple of [2^-p], factor by factor. *)
Definition product_up (p : N) (s : seq dyadic) : dyadic := foldl (fun x y => quotient_up p (dmul x y) d1) d1 s.

(** [(1 + u / 2^k) ^ (2^k)] rounded down, which is at most [exp u]. *)
Fixpoint exp_low (k : nat) (p : N) (u : dyadic) : dyadic :=
  if k is k'.+1 then let x := exp_low k' p (dmul (dtiny 1) u) in shorten p (dmul x x) else dadd d1 u.
(** What a product may be whose logarithm is taken [v] times. *)
Definition product_room (v upper : dyadic) : dyadic :=
  let u := quotient_near 400 upper v in
  let x := exp_low 110 400 u in
  if [&& dle d0 u, dle (dmul v u) upper & dlt d0 x] then x else d1.

Section Check.
(** Weights and their targets; determinants of the priors; information without any robot, from above; what an element tells
    of each target, [::] for nothing. *)
Variables (d m : nat) (groups : seq (dyadic * seq nat)) (dets : seq dyadic) (highs : seq dmat) (told : seq (seq dmat)).
Variables (upper room : dyadic).

Definition beside (sts : seq (option (seq dmat))) (g : seq nat) : seq dmat :=
  foldl (fun K i => if nth None sts i is Some M then
      mkseq (fun j => if nilp (nth [::] M j) then nth [::] K j else madd d (nth [::] K j) (nth [::] M j)) m
    else K) highs g.

Section Group.
(** What is left to each robot, and what stands for all of it if anything does. *)
Variables (left : seq (seq nat)) (sts : seq (option (seq dmat))) (g : seq nat).
Let K := beside sts g.
Let Kdets := mkseq (fun j => mdet d (nth [::] K j)) m.
Let free := [seq i <- g | ~~ isSome (nth None sts i)].

Definition fixed_worth (p : N) (js : seq nat) : dyadic :=
  product_up p [seq dmul (nth d0 dets j) (nth d0 Kdets j) | j <- js].
Definition gain (p : N) (js : seq nat) (e : nat) : dyadic :=
  let R := nth [::] told e in
  product_up p [seq quotient_up p (mdet d (madd d (nth [::] K j) (nth [::] R j))) (nth d0 Kdets j)
               | j <- [seq j <- js | ~~ nilp (nth [::] R j)]].
(** Of one weight, as a product; of more, with a logarithm for each element and weight. *)
Definition product_worth (p : N) (js : seq nat) : dyadic :=
  product_up p (fixed_worth p js :: [seq largest_of (gain p js) (nth [::] left i) | i <- free]).
Definition sum_worth (k : nat) (p : N) : dyadic :=
  dadd (dsum [seq dmul x.1 (log_up k p (fixed_worth p x.2)) | x <- groups])
    (dsum [seq largest_of (fun e => dsum [seq dmul x.1 (log_up k p (gain p x.2 e)) | x <- groups]) (nth [::] left i)
          | i <- free]).
Definition check_group_gains : bool :=
  if groups is [:: x] then dle (product_worth 160 x.2) room
  else dle (sum_worth 44 160) upper || dle (sum_worth 110 1024) upper.
End Group.

Local Open Scope ring_scope.

Variables (F : realFieldType) (ln : F -> F).
Hypothesis lnP : logarithm ln.
Local Notation val := (val F).
Local Notation mx := (mx F).

Lemma product_upP p s : (forall x, x \in s -> 0 < val x) ->
  0 < val (product_up p s) /\ \sum_(x <- s) ln (val x) <= ln (val (product_up p s)).
Proof.
have gen a : 0 < val a -> (forall x, x \in s -> 0 < val x) ->
    val a * \prod_(x <- s) val x <= val (foldl (fun x y => quotient_up p (dmul x y) d1) a s).
  elim: s a => [|x s IH] a a0 h; first by rewrite big_nil mulr1.
  have x0 : 0 < val x by apply: h; rewrite mem_head.
  have le : val a * val x <= val (quotient_up p (dmul a x) d1).
    by have := @quotient_upP F p (dmul a x) d1; rewrite val1 mulr1 val_mul; apply; apply: ltr01.
  have hs y : y \in s -> 0 < val y by move=> ys; apply: h; rewrite in_cons ys orbT.
  rewrite big_cons mulrA /=; apply: le_trans (IH _ (lt_le_trans (mulr_gt0 a0 x0) le) hs); apply: ler_wpmul2r le.
  by rewrite big_seq; apply: prodr_ge0 => y /hs/ltW.
move=> h; have [p0 <-] := ln_prod lnP h; have := gen d1 _ h; rewrite val1 mul1r => /(_ ltr01) le.
by have y0 := lt_le_trans p0 le; split=> //; apply: ln_le.
Qed.

Lemma exp_lowP k p u : 0 <= val u ->
  0 <= val (exp_low k p u) /\ (0 < val (exp_low k p u) -> ln (val (exp_low k p u)) <= val u).
Proof.
elim: k u => [|k IH] u u0 /=.
  rewrite val_add val1; split=> [|h]; first by rewrite addr_ge0 ?ler01.
  by apply: le_trans (ln_tangent lnP h) _; rewrite addrAC subrr add0r.
have half : val (dmul (dtiny 1) u) = val u / 2%:R.
  by rewrite val_mul mulrC; congr (_ * _); rewrite /Dyadic.val /= (_ : valZ F 1 = 1) // div1r expr1.
have [|x0 hx] := IH (dmul (dtiny 1) u); first by rewrite half divr_ge0 ?ler0n.
set x := exp_low k p _ in x0 hx *; have xx : 0 <= val (dmul x x) by rewrite val_mul mulr_ge0.
have /andP[s0 le] := val_shorten p xx; split=> // sp.
have xp : 0 < val x by rewrite lt_def x0 andbT; apply: contraTneq (lt_le_trans sp le) => e; rewrite val_mul e mul0r ltxx.
apply: le_trans (ln_le lnP sp le) _; rewrite val_mul lnM //; apply: le_trans (ler_add (hx xp) (hx xp)) _.
by rewrite half -splitr.
Qed.

Lemma product_roomP v : 0 < val v -> 0 <= val upper ->
  0 < val (product_room v upper) /\ val v * ln (val (product_room v upper)) <= val upper.
Proof.
move=> v0 u0; rewrite /product_room; case: ifP => [|_]; last by rewrite val1 (ln1 lnP) mulr0 ltr01.
rewrite !(val_le F) (val_lt F) val_mul val0 => /and3P[p0 le x0]; split=> //; apply: le_trans le; apply: ler_wpmul2l; first exact: ltW.
by have [_] := exp_lowP 110 400 p0; apply.
Qed.

(** ** What a group is worth *)
Variables (P : 'I_m -> 'M[F]_d) (weight : 'I_m -> F).
Hypothesis weight_ge0 : forall j, 0 <= weight j.
Hypothesis prior_good : forall j, symmetrical (P j) /\ pd (P j).
Hypothesis highP : forall j : 'I_m, symmetrical (mx d (nth [::] highs j)) /\ psd (mx d (nth [::] highs j) - invmx (P j)).
Hypothesis detsE : forall j : 'I_m, val (nth d0 dets j) = \det (P j).
Hypothesis groups_sum : forall f : nat -> F,
  \sum_j weight j * f j = \sum_(x <- groups) val x.1 * \sum_(j <- x.2) f j.
Hypothesis groups_ok : {in groups, forall x, 0 <= val x.1 /\ {in x.2, forall j, (j < m)%N}}.
Hypothesis room_ok : forall x, groups = [:: x] -> 0 < val room /\ val x.1 * ln (val room) <= val upper.

(** Each robot of the group chose an element that is left to it; [I i] is what it tells. *)
Variables (left : seq (seq nat)) (sts : seq (option (seq dmat))) (g : seq nat) (c : nat -> nat) (I : nat -> 'I_m -> 'M[F]_d).
Definition known (i : nat) : seq dmat := if nth None sts i is Some M then M else nth [::] told (c i).
Hypothesis in_left : {in g, forall i, c i \in nth [::] left i}.
Hypothesis known_ok : {in g, forall i (j : 'I_m), let R := mx d (nth [::] (known i) j) in
  [/\ symmetrical (I i j), symmetrical R, psd R & psd (R - I i j)]}.
Hypothesis post_good : forall j, symmetrical (invmx (P j) + \sum_(i <- g) I i j) /\ pd (invmx (P j) + \sum_(i <- g) I i j).

Let K := beside sts g.
Let Kdets := mkseq (fun j => mdet d (nth [::] K j)) m.
Let free := [seq i <- g | ~~ isSome (nth None sts i)].
Local Notation R i j := (mx d (nth [::] (known i) j)).

Lemma besideE (j : 'I_m) :
  mx d (nth [::] K j) = mx d (nth [::] highs j) + \sum_(i <- g | isSome (nth None sts i)) R i j.
Proof.
rewrite /K /beside; elim: g highs => [|i s IH] L /=; first by rewrite big_nil addr0.
rewrite IH big_cons /known; case: (nth None sts i) => [M|] //=.
by rewrite nth_mkseq //; case: nilP => [->|_]; rewrite ?mx_nil ?add0r // mx_add addrA.
Qed.

Lemma beside_good (j : 'I_m) : symmetrical (mx d (nth [::] K j)) /\ pd (mx d (nth [::] K j)).
Proof.
have [sH pH] := highP j; have [sP pP] := prior_good j; rewrite besideE; split.
  rewrite /symmetrical linearD /= sH; congr (_ + _); rewrite big_seq_cond.
  by apply: symmetrical_sum => i /andP[/known_ok/(_ j)[]].
apply: pd_add; first exact: pd_above (pd_inv sP pP) pH.
by rewrite big_seq_cond; apply: psd_sum => i /andP[/known_ok/(_ j)[]].
Qed.

(** The logarithms of what is fixed and of what a robot gains, by target. *)
Definition fixed_log (j : nat) : F := ln (val (nth d0 dets j) * val (mdet d (nth [::] K j))).
Definition gain_log (i j : nat) : F :=
  ln (val (mdet d (madd d (nth [::] K j) (nth [::] (known i) j)))) - ln (val (mdet d (nth [::] K j))).

Lemma target_worth (j : 'I_m) : ln (\det (P j)) + ln (\det (invmx (P j) + \sum_(i <- g) I i j)) <=
  fixed_log j + \sum_(i <- free) gain_log i j.
Proof.
have [sP pP] := prior_good j; have [sK pK] := beside_good j; have [sH pH] := highP j; have [sA pA] := post_good j.
have P0 := det_gt0 sP pP; have K0 := det_gt0 sK pK.
rewrite /fixed_log detsE mdetE (lnM lnP) // -addrA ler_add2l.
have freeP i : i \in free -> symmetrical (R i j) /\ psd (R i j).
  by rewrite mem_filter => /andP[_ /known_ok/(_ j)[]].
have e : mx d (nth [::] highs j) + \sum_(i <- g) R i j = mx d (nth [::] K j) + \sum_(i <- free) R i j.
  by rewrite besideE -addrA big_filter (bigID (fun i => isSome (nth None sts i))).
apply: le_trans (_ : ln (\det (mx d (nth [::] K j) + \sum_(i <- free) R i j)) <= _).
  rewrite -e; apply: (logdet_mono lnP) => //.
    rewrite /symmetrical linearD /= sH; congr (_ + _); rewrite big_seq.
    by apply: symmetrical_sum => i /known_ok/(_ j)[].
  rewrite opprD addrACA -sumrB; apply: psdD => //.
  by rewrite big_seq; apply: psd_sum => i /known_ok/(_ j)[].
apply: le_trans (logdet_sum_gains lnP sK pK freeP) _; rewrite ler_add2l le_eqVlt; apply/orP; left; apply/eqP.
by apply: eq_bigr => i _; rewrite /gain_log !mdetE mx_add.
Qed.

Lemma fixed_worthP p x : x \in groups ->
  0 < val (fixed_worth sts g p x.2) /\ \sum_(j <- x.2) fixed_log j <= ln (val (fixed_worth sts g p x.2)).
Proof.
move=> /groups_ok[_ lt]; have [|h1 h2] := @product_upP p [seq dmul (nth d0 dets j) (nth d0 Kdets j) | j <- x.2].
  move=> y /mapP[j /lt jm ->]; rewrite val_mul (detsE (Ordinal jm)) nth_mkseq // mdetE.
  have [sP pP] := prior_good (Ordinal jm); have [sK pK] := beside_good (Ordinal jm).
  by rewrite mulr_gt0 ?det_gt0.
split=> //; apply: le_trans h2; rewrite big_map big_seq [X in _ <= X]big_seq le_eqVlt; apply/orP; left; apply/eqP.
by apply: eq_bigr => j /lt jm; rewrite val_mul nth_mkseq.
Qed.

Lemma gainP p x i : x \in groups -> i \in free ->
  0 < val (gain sts g p x.2 (c i)) /\ \sum_(j <- x.2) gain_log i j <= ln (val (gain sts g p x.2 (c i))).
Proof.
move=> /groups_ok[_ lt]; rewrite mem_filter => /andP[si ig].
have ek : known i = nth [::] told (c i) by rewrite /known; case: (nth None sts i) si.
pose q j := quotient_up p (mdet d (madd d (nth [::] K j) (nth [::] (known i) j))) (nth d0 Kdets j).
have each j : (j < m)%N -> 0 < val (q j) /\ gain_log i j <= ln (val (q j)).
  move=> jm; have [sK pK] := beside_good (Ordinal jm); have [_ sR pR _] := known_ok ig (Ordinal jm).
  have K0 := det_gt0 sK pK; have KR0 : 0 < \det (mx d (nth [::] K j) + R i j).
    by apply: det_gt0; [rewrite /symmetrical linearD /= sK sR | apply: pd_add].
  have := @quotient_upP F p (mdet d (madd d (nth [::] K j) (nth [::] (known i) j))) (nth d0 Kdets j).
  rewrite -/(q j) nth_mkseq // !mdetE mx_add => /(_ K0) le.
  have q0 : 0 < val (q j) by rewrite -(pmulr_lgt0 _ K0); apply: lt_le_trans KR0 le.
  split=> //; rewrite /gain_log !mdetE mx_add -(lnV lnP) // -lnM ?invr_gt0 //.
  by apply: ln_le; rewrite ?divr_gt0 // ler_pdivr_mulr.
have [|h1 h2] := @product_upP p [seq q j | j <- [seq j <- x.2 | ~~ nilp (nth [::] (known i) j)]].
  by move=> y /mapP[j]; rewrite mem_filter => /andP[_ /lt/each[h _]] ->.
rewrite /gain -ek; split=> //; apply: le_trans h2; rewrite big_map big_filter big_seq.
rewrite [X in _ <= X]big_mkcond [X in _ <= X]big_seq; apply: ler_sum => j /lt jm.
case: nilP => [e|_] /=; last by case: (each j jm).
by rewrite /gain_log e !mdetE mx_add mx_nil addr0 subrr.
Qed.

Theorem check_group_gainsP : check_group_gains left sts g ->
  \sum_j weight j * (ln (\det (P j)) + ln (\det (invmx (P j) + \sum_(i <- g) I i j))) <= val upper.
Proof.
move=> h; apply: le_trans (_ : \sum_(x <- groups) val x.1 *
    (\sum_(j <- x.2) fixed_log j + \sum_(i <- free) \sum_(j <- x.2) gain_log i j) <= _).
  rewrite (eq_bigr (fun x => val x.1 * \sum_(j <- x.2) (fixed_log j + \sum_(i <- free) gain_log i j))).
    rewrite -groups_sum; apply: ler_sum => j _; apply: ler_wpmul2l => //; exact: target_worth.
  by move=> x _; rewrite big_split exchange_big.
have inl i : i \in free -> c i \in nth [::] left i by rewrite mem_filter => /andP[_ /in_left].
have by_sum k p : dle (sum_worth left sts g k p) upper -> \sum_(x <- groups) val x.1 *
    (\sum_(j <- x.2) fixed_log j + \sum_(i <- free) \sum_(j <- x.2) gain_log i j) <= val upper.
  rewrite (val_le F) val_add !val_sum !big_map; apply: le_trans.
  rewrite (eq_bigr (fun x => val x.1 * (\sum_(j <- x.2) fixed_log j) +
      \sum_(i <- free) val x.1 * \sum_(j <- x.2) gain_log i j)); last by move=> x _; rewrite mulrDr; congr (_ + _); rewrite mulr_sumr.
  rewrite big_split /= exchange_big; apply: ler_add.
    rewrite [X in X <= _]big_seq [X in _ <= X]big_seq; apply: ler_sum => x xg; have [x0 _] := groups_ok xg.
    have [f0 le] := fixed_worthP p xg; rewrite val_mul; apply: ler_wpmul2l => //.
    exact: le_trans le (log_upP lnP k p f0).
  rewrite [X in X <= _]big_seq [X in _ <= X]big_seq; apply: ler_sum => i fi.
  apply: le_trans (largest_ofP F _ (inl i fi)); rewrite val_sum big_map [X in X <= _]big_seq [X in _ <= X]big_seq.
  apply: ler_sum => x xg; have [x0 _] := groups_ok xg; have [q0 le] := gainP p xg fi.
  by rewrite val_mul; apply: ler_wpmul2l => //; apply: le_trans le (log_upP lnP k p q0).
have one (A : dyadic * seq nat -> bool) (B : bool) : (if groups is [:: x] then A x else B) ->
    B \/ exists2 x, groups = [:: x] & A x.
  by case: groups => [|x [|y s]]; [left | right; exists x | left].
case: (one _ _ h) => [/orP[]|[x eg]]; [exact: by_sum | exact: by_sum |].
rewrite (val_le F) => le; have [r0 rle] := room_ok eg; apply: le_trans rle.
have xg : x \in groups by rewrite eg mem_head.
have [x0 _] := groups_ok xg; rewrite eg big_seq1; apply: ler_wpmul2l => //.
have [f0 fle] := fixed_worthP 160 xg; set f := fixed_worth _ _ _ _ in f0 fle.
pose q i := largest_of (gain sts g 160 x.2) (nth [::] left i).
have qP i : i \in free -> 0 < val (q i) /\ \sum_(j <- x.2) gain_log i j <= ln (val (q i)).
  move=> fi; have [q0 qle] := gainP 160 xg fi; have le1 := largest_ofP F (gain sts g 160 x.2) (inl i fi).
  by split; [apply: lt_le_trans q0 le1 | apply: le_trans qle (ln_le lnP q0 le1)].
have [|w0 wle] := @product_upP 160 (f :: [seq q i | i <- free]).
  by move=> y; rewrite in_cons => /orP[/eqP -> //|/mapP[i /qP[q0 _] ->]].
apply: le_trans (ln_le lnP w0 le); apply: le_trans wle; rewrite big_cons big_map; apply: ler_add => //.
by rewrite [X in X <= _]big_seq [X in _ <= X]big_seq; apply: ler_sum => i /qP[].
Qed.
End Check.
