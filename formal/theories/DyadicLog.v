(** Determinants and upper bounds on logarithms in binary fractions. *)
From Coq Require Import ZArith NArith Nnat.
From mathcomp Require Import all_ssreflect all_algebra.
From mathcomp.zify Require Import zify ssrZ.
From mathcomp.algebra_tactics Require Import ring.
From Ratt Require Import Quadratic Dyadic DyadicMatrix Logdet.
Set Implicit Arguments.
Unset Strict Implicit.
Unset Printing Implicit Defensive.
Import Order.Theory GRing.Theory Num.Theory.

(** Expansion along the first row: meant for few rows. *)
Definition without (n j : nat) (A : dmat) : dmat := mkm n (fun i k => get A i.+1 (bump j k)).
Fixpoint mdet (n : nat) (A : dmat) : dyadic :=
  if n is n'.+1 then
    dsum [seq let x := dmul (get A 0 j) (mdet n' (without n' j A)) in if odd j then dopp x else x | j <- iota 0 n]
  else d1.

(** A root rounded up: a hint, checked where it is used. *)
Definition root_up (p : N) (x : dyadic) : dyadic :=
  Dyadic (Z.add (Z.sqrt (Z.shiftr (Z.shiftl (man x) (Z.of_N (p + p))) (Z.of_N (sc x)))) 2) p.

(** An upper bound on [ln x]: [ln x <= 2 ln r] for [x <= r^2], again and again, and [ln r <= r - 1] at last. *)
Fixpoint log_up (k : nat) (p : N) (x : dyadic) : dyadic :=
  if k is k'.+1 then
    let r := root_up p x in
    if dlt d0 r && dle x (dmul r r) then dmul (dnat 2) (log_up k' p r) else dsub x d1
  else dsub x d1.

(** Leading bits, rounded down: how many is a hint. *)
Definition bits (x : dyadic) : N := Z.to_N (Z.log2 (man x)).
Definition shorten (p : N) (x : dyadic) : dyadic :=
  let s := N.min (N.sub (bits x) p) (sc x) in Dyadic (Z.shiftr (man x) (Z.of_N s)) (N.sub (sc x) s).
Definition short_product (p : N) (s : seq dyadic) : dyadic := foldl (fun x y => shorten p (dmul x y)) d1 s.

(** Upper bounds on [ln 2] and [ln (1/2)], and on [n ln 2] from them. *)
Definition log_two_up : dyadic := log_up 110 400 (dnat 2).
Definition log_half_up : dyadic := log_up 110 400 (dtiny 1).
Definition log_power_up (two half : dyadic) (n : Z) : dyadic :=
  if Z.leb 0 n then dmul (Dyadic n 0) two else dmul (Dyadic (Z.opp n) 0) half.
(** Upper bound on [ln (1 / x)]: with [x] between [2^n] and [2^(n+1)], [- n ln 2 + ln (2^n / x)]. *)
Definition log_inverse_up (k : nat) (p : N) (x : dyadic) : dyadic :=
  let b := bits x in
  dadd (log_power_up log_two_up log_half_up (Z.sub (Z.of_N (sc x)) (Z.of_N b)))
    (log_up k p (quotient_up p (Dyadic (Z.shiftl 1 (Z.of_N b)) 0) (Dyadic (man x) 0))).

(** Upper bound on [ln (x / y)]. *)
Definition log_quotient_up (k : nat) (p : N) (x y : dyadic) : dyadic :=
  let q := quotient_up p x y in
  let a := log_up k p q in
  let b := dsub q d1 in
  if dle b a then b else a.

Local Open Scope ring_scope.

Section Meaning.
Variable F : realFieldType.
Local Notation val := (val F).

Lemma mdetS n A : mdet n.+1 A =
  dsum [seq let x := dmul (get A 0 j) (mdet n (without n j A)) in if odd j then dopp x else x | j <- iota 0 n.+1].
Proof. by []. Qed.

Lemma mdetE n A : val (mdet n A) = \det (mx F n A).
Proof.
elim: n A => [|n IH] A; first by rewrite det_mx00 val1.
rewrite mdetS val_sum_iota (expand_det_row _ 0); apply: eq_bigr => j _.
have -> : cofactor (mx F n.+1 A) 0 j = (-1) ^+ j * \det (mx F n (without n j A)).
  rewrite /cofactor add0n; congr (_ * \det _); apply/matrixP => i k.
  by rewrite !mxE get_mkm.
rewrite -signr_odd -IH mxE; case: (odd j); rewrite ?val_opp val_mul ?expr0 ?expr1 ?mul1r // mulN1r mulrN //.
Qed.

Lemma quotient_upP p x y : 0 < val y -> val x <= val (quotient_up p x y) * val y.
Proof.
move=> y0; have my : Z.lt 0 (man y).
  by move: y0; rewrite /val pmulr_lgt0 ?invr_gt0 ?two_pow_gt0 // /valZ ltr0z; lia.
set A := up x (N.add p (sc y)); set B := up y (sc x).
have B0 : Z.lt 0 B by rewrite /B /up Z.shiftl_mul_pow2; [apply: Z.mul_pos_pos => //; apply: Z.pow_pos_nonneg; lia | lia].
have le : valZ F A <= valZ F (Z.opp (Z.div (Z.opp A) B)) * valZ F B.
  rewrite -valZM valZ_le; apply/Z.leb_le; have := Z.mul_div_le (Z.opp A) B B0; lia.
have eA : val x = valZ F A / (2%:R ^+ N.to_nat p * 2%:R ^+ N.to_nat (sc y) * 2%:R ^+ N.to_nat (sc x)).
  rewrite /A valZ_up N2Nat.inj_add exprD /val.
  move: (two_pow_neq0 F (N.to_nat p)) (two_pow_neq0 F (N.to_nat (sc y))) (two_pow_neq0 F (N.to_nat (sc x))).
  move: (2%:R ^+ N.to_nat p) (2%:R ^+ N.to_nat (sc y)) (2%:R ^+ N.to_nat (sc x)) (valZ F (man x)) => a b c m a0 b0 c0.
  by field; rewrite a0 b0 c0.
have eB : val (quotient_up p x y) * val y = valZ F (Z.opp (Z.div (Z.opp A) B)) * valZ F B /
    (2%:R ^+ N.to_nat p * 2%:R ^+ N.to_nat (sc y) * 2%:R ^+ N.to_nat (sc x)).
  rewrite /B valZ_up /val /=; move: (valZ F (Z.opp _)) => q.
  move: (two_pow_neq0 F (N.to_nat p)) (two_pow_neq0 F (N.to_nat (sc y))) (two_pow_neq0 F (N.to_nat (sc x))).
  move: (2%:R ^+ N.to_nat p) (2%:R ^+ N.to_nat (sc y)) (2%:R ^+ N.to_nat (sc x)) (valZ F (man y)) => a b c m a0 b0 c0.
  by field; rewrite a0 b0 c0.
rewrite eA eB ler_pmul2r // invr_gt0 !mulr_gt0 ?two_pow_gt0 //.
Qed.

Variable ln : F -> F.
Hypothesis lnP : logarithm ln.

Lemma log_upP k p x : 0 < val x -> ln (val x) <= val (log_up k p x).
Proof.
have base y : 0 < val y -> ln (val y) <= val (dsub y d1) by move=> y0; rewrite val_sub val1; apply: ln_tangent.
elim: k x => [|k IH] x x0 /=; first exact: base.
case: ifP => [|_]; last exact: base.
rewrite (val_lt F) (val_le F) val0 val_mul => /andP[r0 le].
apply: le_trans (ln_le lnP x0 le) _; rewrite lnM // val_mul val_nat.
have := IH _ r0; set a := ln _; set b := val _ => h.
by rewrite [X in _ <= X]mulr_natl mulr2n ler_add.
Qed.

Lemma log_quotient_upP k p x y : 0 < val x -> 0 < val y -> ln (val x / val y) <= val (log_quotient_up k p x y).
Proof.
move=> x0 y0; have le := @quotient_upP p x y y0.
have q0 : 0 < val (quotient_up p x y) by rewrite -(pmulr_lgt0 _ y0); apply: lt_le_trans x0 le.
apply: le_trans (ln_le lnP _ (_ : _ <= val (quotient_up p x y))) _; first exact: divr_gt0.
  by rewrite ler_pdivr_mulr.
rewrite /log_quotient_up; case: ifP => _; last exact: log_upP.
by rewrite val_sub val1; apply: ln_tangent.
Qed.

Lemma man_gt0 x : 0 < val x -> Z.lt 0 (man x).
Proof. by rewrite /val pmulr_lgt0 ?invr_gt0 ?two_pow_gt0 // /valZ ltr0z; lia. Qed.

Lemma ln_two_pow n : ln (2%:R ^+ n) = n%:R * ln 2%:R.
Proof.
elim: n => [|n IH]; first by rewrite expr0 (ln1 lnP) mul0r.
by rewrite exprS (lnM lnP) ?two_pow_gt0 ?ltr0n // IH -[n.+1]addn1 natrD mulrDl mul1r addrC.
Qed.

Lemma log_twoP : ln 2%:R <= val log_two_up /\ - ln 2%:R <= val log_half_up.
Proof.
have two k p : ln 2%:R <= val (log_up k p (dnat 2)).
  by rewrite -[X in ln X](val_nat F 2); apply: log_upP; rewrite val_nat ltr0n.
have half k p : - ln 2%:R <= val (log_up k p (dtiny 1)).
  have e : val (dtiny 1) = (2%:R)^-1 by rewrite /val /= (_ : valZ F 1 = 1) // div1r expr1.
  by rewrite -(lnV lnP) ?ltr0n // -e; apply: log_upP; apply: val_tiny_gt0.
by split; [exact: (two 110%N 400%num) | exact: (half 110%N 400%num)].
Qed.

Lemma val_whole z : val (Dyadic z 0) = valZ F z.
Proof. by rewrite /val /= expr0 divr1. Qed.

Lemma log_power_upP two half n : ln 2%:R <= val two -> - ln 2%:R <= val half ->
  valZ F n * ln 2%:R <= val (log_power_up two half n).
Proof.
rewrite /log_power_up => le2 leh; case: ifP => h; rewrite val_mul val_whole.
  by apply: ler_wpmul2l le2; rewrite -[0]/(valZ F 0) valZ_le.
rewrite -[valZ F n]opprK -valZN mulNr -mulrN; apply: ler_wpmul2l leh.
by rewrite -[0]/(valZ F 0) valZ_le; lia.
Qed.

Lemma log_inverse_upP k p x : 0 < val x -> - ln (val x) <= val (log_inverse_up k p x).
Proof.
have [] := log_twoP; rewrite /log_inverse_up; move: log_two_up log_half_up => two half le2 leh x0.
have m0 := man_gt0 x0; rewrite val_add; set b := bits x.
have b0 : val (Dyadic (Z.shiftl 1 (Z.of_N b)) 0) = 2%:R ^+ N.to_nat b.
  by rewrite val_whole -[Z.shiftl _ _]/(up d1 b) valZ_up mul1r.
have v0 : 0 < valZ F (man x) by rewrite /valZ ltr0z; lia.
have y0 : 0 < val (Dyadic (man x) 0) by rewrite val_whole.
have q := quotient_upP p (Dyadic (Z.shiftl 1 (Z.of_N b)) 0) y0; set y := quotient_up _ _ _ in q *.
rewrite b0 val_whole in q; have yy : 2%:R ^+ N.to_nat b / valZ F (man x) <= val y by rewrite ler_pdivr_mulr.
have p0 : 0 < 2%:R ^+ N.to_nat b / valZ F (man x) by rewrite divr_gt0 ?two_pow_gt0.
have h1 := le_trans (ln_le lnP p0 yy) (log_upP k p (lt_le_trans p0 yy)).
have h2 := log_power_upP (Z.sub (Z.of_N (sc x)) (Z.of_N b)) le2 leh.
apply: le_trans (ler_add h2 h1).
have -> : ln (2%:R ^+ N.to_nat b / valZ F (man x)) = (N.to_nat b)%:R * ln 2%:R - ln (valZ F (man x)).
  by rewrite -ln_two_pow -(lnV lnP) // -lnM ?invr_gt0 ?two_pow_gt0.
have -> : ln (val x) = ln (valZ F (man x)) - (N.to_nat (sc x))%:R * ln 2%:R.
  by rewrite -ln_two_pow -(lnV lnP) ?two_pow_gt0 // -lnM ?invr_gt0 ?two_pow_gt0.
have eN n : valZ F (Z.of_N n) = (N.to_nat n)%:R by rewrite -N_nat_Z valZ_nat.
rewrite /Z.sub valZD valZN !eN.
rewrite le_eqVlt; apply/orP; left; apply/eqP; ring.
Qed.

Lemma val_shorten p x : 0 <= val x -> 0 <= val (shorten p x) <= val x.
Proof.
move=> x0; have m0 : Z.le 0 (man x).
  by move: x0; rewrite /val pmulr_lge0 ?invr_gt0 ?two_pow_gt0 // -[0]/(valZ F 0) valZ_le; lia.
rewrite /shorten; set s := N.min _ _; have ls : N.le s (sc x) by rewrite /s; lia.
have two : Z.lt 0 (2 ^ Z.of_N s) by apply: Z.pow_pos_nonneg; lia.
rewrite Z.shiftr_div_pow2; last lia.
set q := Z.div _ _; have q0 : Z.le 0 q by apply: Z.div_pos.
have le : valZ F q * 2%:R ^+ N.to_nat s <= valZ F (man x).
  by rewrite -valZ_pow -valZM valZ_le; have := Z.mul_div_le (man x) _ two; rewrite /q; lia.
rewrite /val /=; apply/andP; split.
  by apply: divr_ge0; [rewrite -[0]/(valZ F 0) valZ_le; lia | apply/ltW/two_pow_gt0].
have -> : N.to_nat (sc x) = (N.to_nat s + N.to_nat (N.sub (sc x) s))%N by lia.
by rewrite exprD invfM mulrA ler_pmul2r ?invr_gt0 ?two_pow_gt0 // ler_pdivl_mulr ?two_pow_gt0.
Qed.

Lemma val_short_product p s : (forall x, x \in s -> 0 <= val x) -> 0 <= val (short_product p s) <= \prod_(x <- s) val x.
Proof.
have gen a : 0 <= val a -> (forall x, x \in s -> 0 <= val x) ->
    0 <= val (foldl (fun x y => shorten p (dmul x y)) a s) <= val a * \prod_(x <- s) val x.
  elim: s a => [|x s IH] a a0 h; first by rewrite big_nil mulr1 a0 lexx.
  have x0 : 0 <= val x by apply: h; rewrite mem_head.
  have /(val_shorten p)/andP[y0 le] : 0 <= val (dmul a x) by rewrite val_mul mulr_ge0.
  have hs y : y \in s -> 0 <= val y by move=> ys; apply: h; rewrite in_cons ys orbT.
  have /andP[z0 le2] := IH _ y0 hs; rewrite z0 big_cons mulrA -val_mul; apply: le_trans le2 _.
  by apply: ler_wpmul2r le; rewrite big_seq; apply: prodr_ge0.
by move=> h; have := gen d1 _ h; rewrite val1 mul1r; apply; apply: ler01.
Qed.

Lemma ln_prod (I : eqType) (s : seq I) (f : I -> F) : (forall i, i \in s -> 0 < f i) ->
  0 < \prod_(i <- s) f i /\ ln (\prod_(i <- s) f i) = \sum_(i <- s) ln (f i).
Proof.
elim: s => [|i s IH] h; first by rewrite !big_nil ltr01 (ln1 lnP).
have i0 : 0 < f i by apply: h; rewrite mem_head.
have [|s0 e] := IH; first by move=> j js; apply: h; rewrite in_cons js orbT.
by rewrite !big_cons mulr_gt0 // lnM // e.
Qed.

(** One logarithm for several determinants. *)
Lemma log_product_upP k p q s : (forall x, x \in s -> 0 < val x) -> dlt d0 (short_product q s) ->
  - (\sum_(x <- s) ln (val x)) <= val (log_inverse_up k p (short_product q s)).
Proof.
move=> h; rewrite (val_lt F) val0 => y0; have [p0 <-] := ln_prod h.
have /andP[_ le] := val_short_product q (fun x xs => ltW (h x xs)).
by apply: le_trans (log_inverse_upP k p y0); rewrite ler_opp2; apply: ln_le.
Qed.
End Meaning.
