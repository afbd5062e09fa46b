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
End Meaning.
