(** Exact arithmetic of binary fractions [man / 2^sc], and what it means in an ordered field. *)
From Coq Require Import ZArith NArith Nnat.
From mathcomp Require Import all_ssreflect all_algebra.
From mathcomp.zify Require Import zify ssrZ.
From mathcomp.algebra_tactics Require Import ring.
Set Implicit Arguments.
Unset Strict Implicit.
Unset Printing Implicit Defensive.
Import Order.Theory GRing.Theory Num.Theory.

Record dyadic := Dyadic { man : Z; sc : N }.

Lemma dyadicK : cancel (fun x => (man x, Z.of_N (sc x))) (fun q => Dyadic q.1 (Z.to_N q.2)).
Proof. by case=> m k /=; rewrite N2Z.id. Qed.
Canonical dyadic_eqType := EqType dyadic (CanEqMixin dyadicK).

Definition d0 : dyadic := Dyadic 0 0.
Definition d1 : dyadic := Dyadic 1 0.
Definition up (x : dyadic) (k : N) : Z := Z.shiftl (man x) (Z.of_N k).
(** Mantissas of two numbers at their larger scale, combined. *)
Definition aligned (T : Type) (f : Z -> Z -> N -> T) (x y : dyadic) : T :=
  match N.compare (sc x) (sc y) with
  | Eq => f (man x) (man y) (sc x)
  | Lt => f (up x (N.sub (sc y) (sc x))) (man y) (sc y)
  | Gt => f (man x) (up y (N.sub (sc x) (sc y))) (sc x)
  end.
Definition dadd : dyadic -> dyadic -> dyadic := aligned (fun a b k => Dyadic (Z.add a b) k).
Definition dopp (x : dyadic) : dyadic := Dyadic (Z.opp (man x)) (sc x).
Definition dsub (x y : dyadic) : dyadic := dadd x (dopp y).
Definition dmul (x y : dyadic) : dyadic := Dyadic (Z.mul (man x) (man y)) (N.add (sc x) (sc y)).
Definition dle : dyadic -> dyadic -> bool := aligned (fun a b _ => Z.leb a b).
Definition dlt (x y : dyadic) : bool := ~~ dle y x.
Definition dmax (x y : dyadic) : dyadic := if dle x y then y else x.
Definition dnat (n : nat) : dyadic := Dyadic (Z.of_nat n) 0.
Definition dsum (s : seq dyadic) : dyadic := foldl dadd d0 s.
(** [2^-k]. *)
Definition dtiny (k : N) : dyadic := Dyadic 1 k.
(** Quotients rounded up and down to a multiple of [2^-p]: hints, always checked where they are used. *)
Definition quotient_up (p : N) (x y : dyadic) : dyadic :=
  Dyadic (Z.opp (Z.div (Z.opp (up x (N.add p (sc y)))) (up y (sc x)))) p.
Definition quotient_near (p : N) (x y : dyadic) : dyadic :=
  Dyadic (Z.div (Z.add (Z.mul 2 (up x (N.add p (sc y)))) (up y (sc x))) (Z.mul 2 (up y (sc x)))) p.

Local Open Scope ring_scope.

Section Value.
Variable F : realFieldType.

Definition valZ (z : Z) : F := (int_of_Z z)%:~R.
Definition val (x : dyadic) : F := valZ (man x) / 2%:R ^+ N.to_nat (sc x).

Lemma valZD a b : valZ (Z.add a b) = valZ a + valZ b.
Proof. by rewrite /valZ -intrD -rmorphD. Qed.
Lemma valZM a b : valZ (Z.mul a b) = valZ a * valZ b.
Proof. by rewrite /valZ -intrM -rmorphM. Qed.
Lemma valZN a : valZ (Z.opp a) = - valZ a.
Proof. by rewrite /valZ -mulrNz -rmorphN. Qed.
Lemma valZ_nat n : valZ (Z.of_nat n) = n%:R.
Proof. by rewrite /valZ pmulrn; congr (_%:~R); lia. Qed.
Lemma valZ_le (a b : Z) : (valZ a <= valZ b) = Z.leb a b.
Proof. by rewrite /valZ ler_int; apply/idP/idP; lia. Qed.

Lemma valZ_pow k : valZ (2 ^ Z.of_N k) = 2%:R ^+ N.to_nat k.
Proof.
rewrite -(N2Nat.id k) nat_N_Z Nat2N.id; elim: (N.to_nat k) => [|n IH] //.
rewrite exprS -IH Nat2Z.inj_succ Z.pow_succ_r; last lia.
by rewrite valZM.
Qed.

Lemma valZ_up x k : valZ (up x k) = valZ (man x) * 2%:R ^+ N.to_nat k.
Proof. by rewrite /up Z.shiftl_mul_pow2 ?valZM ?valZ_pow //; lia. Qed.

Lemma two_pow_neq0 k : (2%:R ^+ k : F) != 0.
Proof. by rewrite expf_neq0 // pnatr_eq0. Qed.
Lemma two_pow_gt0 k : 0 < (2%:R ^+ k : F).
Proof. by rewrite exprn_gt0 ?ltr0n. Qed.


(** Alignment changes nothing. *)
Lemma alignedP (T : Type) (f : Z -> Z -> N -> T) x y :
  exists a b (k : N), [/\ aligned f x y = f a b k, val x = valZ a / 2%:R ^+ N.to_nat k
    & val y = valZ b / 2%:R ^+ N.to_nat k].
Proof.
have shift (z : dyadic) (k : N) : N.le (sc z) k -> val z = valZ (up z (N.sub k (sc z))) / 2%:R ^+ N.to_nat k.
  move=> le; rewrite valZ_up /val; set a := N.to_nat (N.sub k (sc z)).
  have -> : N.to_nat k = (a + N.to_nat (sc z))%N by rewrite /a; lia.
  by rewrite exprD invfM mulrA mulfK ?two_pow_neq0.
rewrite /aligned; case: N.compare_spec => h.
- by exists (man x), (man y), (sc x); split => //; rewrite /val h.
- by exists (up x (N.sub (sc y) (sc x))), (man y), (sc y); split=> //; apply: shift; lia.
- by exists (man x), (up y (N.sub (sc x) (sc y))), (sc x); split=> //; apply: shift; lia.
Qed.

Lemma val_add x y : val (dadd x y) = val x + val y.
Proof.
rewrite /dadd; have [a [b [k [-> -> ->]]]] := alignedP (fun a b k => Dyadic (Z.add a b) k) x y.
by rewrite /val /= valZD mulrDl.
Qed.
Lemma val_opp x : val (dopp x) = - val x.
Proof. by rewrite /val /= valZN mulNr. Qed.
Lemma val_sub x y : val (dsub x y) = val x - val y.
Proof. by rewrite /dsub val_add val_opp. Qed.
Lemma val_mul x y : val (dmul x y) = val x * val y.
Proof. by rewrite /val /= valZM N2Nat.inj_add exprD invfM mulrACA. Qed.
Lemma val_le x y : dle x y = (val x <= val y).
Proof.
rewrite /dle; have [a [b [k [-> -> ->]]]] := alignedP (fun a b _ => Z.leb a b) x y.
by rewrite ler_pmul2r ?invr_gt0 ?two_pow_gt0 // valZ_le.
Qed.
Lemma val_lt x y : dlt x y = (val x < val y).
Proof. by rewrite /dlt val_le ltNge. Qed.
Lemma val0 : val d0 = 0.
Proof. by rewrite /val /= mul0r. Qed.
Lemma val1 : val d1 = 1.
Proof. by rewrite /val /= divr1. Qed.
Lemma val_max x y : val (dmax x y) = Num.max (val x) (val y).
Proof. by rewrite /dmax val_le; case: leP. Qed.
Lemma val_nat n : val (dnat n) = n%:R.
Proof. by rewrite /val /= expr0 divr1 valZ_nat. Qed.
Lemma val_tiny_gt0 k : 0 < val (dtiny k).
Proof. by rewrite /val /= (_ : valZ 1 = 1) // div1r invr_gt0 two_pow_gt0. Qed.

Lemma val_sum s : val (dsum s) = \sum_(x <- s) val x.
Proof.
have gen y : val (foldl dadd y s) = val y + \sum_(x <- s) val x.
  elim: s y => [|x s IH] y /=; first by rewrite big_nil addr0.
  by rewrite IH val_add big_cons addrA.
by rewrite /dsum gen val0 add0r.
Qed.
End Value.
