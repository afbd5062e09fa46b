(** Whether a symmetric matrix of integers is positive definite, by elimination with exact divisions. *)
From Coq Require Import ZArith.
From mathcomp Require Import all_ssreflect all_algebra.
From mathcomp.zify Require Import zify ssrZ.
From mathcomp.algebra_tactics Require Import ring.
From Ratt Require Import Quadratic Dyadic DyadicMatrix.
Set Implicit Arguments.
Unset Strict Implicit.
Unset Printing Implicit Defensive.
Import Order.Theory GRing.Theory Num.Theory.

Definition zmat := seq (seq Z).
Definition entry_at (A : zmat) (i j : nat) : Z := nth Z0 (nth [::] A i) j.

(** What elimination leaves below the first row, and the same divided by the pivot before, if that is exact. *)
Fixpoint eliminate (p y : Z) (top row : seq Z) : seq Z :=
  match top, row with
  | r :: top', x :: row' => Z.sub (Z.mul p x) (Z.mul y r) :: eliminate p y top' row'
  | _, _ => [::]
  end.
Definition below_first (A : zmat) : zmat :=
  match A with
  | (p :: top) :: rows => [seq if row is y :: row' then eliminate p y top row' else [::] | row <- rows]
  | _ => [::]
  end.
Definition divided (q : Z) (A : zmat) : zmat :=
  let B := [seq [seq Z.div x q | x <- row] | row <- A] in
  if (Z.ltb Z0 q) && ([seq [seq Z.mul q x | x <- row] | row <- B] == A) then B else A.
Fixpoint positive (n : nat) (A : zmat) (q : Z) : bool :=
  if n is n'.+1 then
    let p := entry_at A 0 0 in Z.ltb Z0 p && positive n' (divided q (below_first A)) p
  else true.

Definition square_of (n : nat) (A : zmat) : bool := (size A == n) && all (fun row => size row == n) A.
Definition zquad (n : nat) (A : zmat) (z : nat -> Z) : Z :=
  (\sum_(i < n) \sum_(j < n) Z.mul (Z.mul (z i) (entry_at A i j)) (z j))%R.

Local Open Scope ring_scope.

Section Meaning.
Variable F : realFieldType.

Definition zmx (n : nat) (A : zmat) : 'M[F]_n := \matrix_(i, j) valZ F (entry_at A i j).

Lemma nth_eliminate p y n top row j : size top = n -> size row = n -> (j < n)%N ->
  nth Z0 (eliminate p y top row) j = Z.sub (Z.mul p (nth Z0 row j)) (Z.mul y (nth Z0 top j)).
Proof.
elim: n top row j => [//|n IH] [|r top] [|x row] [|j] //= [st] [sr] jn; exact: IH.
Qed.

Lemma size_eliminate p y top row : size top = size row -> size (eliminate p y top row) = size row.
Proof. by elim: top row => [|r top IH] [|x row] //= [/IH ->]. Qed.

Lemma below_firstP n A : square_of n.+1 A -> square_of n (below_first A) /\
  zmx n (below_first A) = schur_mx (zmx n.+1 A).
Proof.
case: A => [|[|p top] rows] /andP[/eqP sr] //= /andP[/eqP st /allP all_rows].
case: sr st => sr [st].
have row_size i : (i < n)%N -> size (nth [::] rows i) = n.+1 by move=> il; apply/eqP/all_rows; rewrite mem_nth ?sr.
split.
  rewrite /square_of /below_first size_map sr eqxx /=; apply/allP => row' /mapP[row /all_rows/eqP].
  by case: row => [//|y row] [sz] ->; rewrite size_eliminate ?sz ?st.
apply/matrixP => i j; rewrite !mxE /entry_at /below_first (nth_map [::]) ?sr //.
have := row_size i (ltn_ord i); case e: (nth [::] rows i) => [//|y row] [sz].
rewrite (nth_eliminate _ _ st sz) // -!valZM -[_ - _]/(_ + - _) -valZN -valZD; congr (valZ _ _).
by rewrite /= e /=; lia.
Qed.

Lemma valZ_lt0 a : (0 < valZ F a) = Z.ltb Z0 a.
Proof. by rewrite ltNge -[0](_ : valZ F Z0 = 0) // valZ_le; apply/idP/idP; lia. Qed.

Lemma dividedP n q A : square_of n A -> square_of n (divided q A) /\
  exists2 c : F, 0 < c & zmx n A = c *: zmx n (divided q A).
Proof.
move=> sA; rewrite /divided; set B := [seq [seq Z.div x q | x <- row] | row <- A].
case: ifP => [/andP[q0 /eqP e]|_]; last by split=> //; exists 1; rewrite ?ltr01 ?scale1r.
have sB : square_of n B.
  case/andP: sA => /eqP sz /allP h; rewrite /square_of size_map sz eqxx /=; apply/allP => r /mapP[row /h/eqP e' ->].
  by rewrite size_map e'.
split=> //; exists (valZ F q); first by rewrite valZ_lt0.
case/andP: sB => /eqP szB /allP hB; apply/matrixP => i j; rewrite !mxE -valZM; congr (valZ _ _).
have sr : size (nth [::] B i) = n by apply/eqP/hB; rewrite mem_nth ?szB.
by rewrite /entry_at -[in LHS]e (nth_map [::]) ?szB // (nth_map Z0) ?sr.
Qed.

Lemma positiveP n A q : square_of n A -> symmetrical (zmx n A) -> positive n A q -> pd (zmx n A).
Proof.
elim: n A q => [|n IH] A q sA symA /=; first by move=> _ v; rewrite (_ : v = 0) ?eqxx //; apply/colP => -[].
move=> /andP[p0 h]; have [sS eS] := below_firstP sA.
have [sD [c c0 eD]] := dividedP q sS; set D := divided _ _ in sD eD h.
have symS : symmetrical (c *: zmx n D) by rewrite -eD eS; apply: symmetrical_schur.
have symD : symmetrical (zmx n D).
  have cn : c != 0 by rewrite gt_eqF.
  by apply: (scalerI cn); rewrite -[RHS]symS linearZ.
have pdD := IH D _ sD symD h; apply: pd_schur => //; first by rewrite mxE valZ_lt0.
by rewrite -eS eD => v v0; rewrite formZm mulr_gt0 // pdD.
Qed.
End Meaning.

(** A form that is positive at all points but 0 is so at points of integers. *)
Theorem zquad_gt0 n A q (z : nat -> Z) : square_of n A -> (forall i j, (i < n)%N -> (j < n)%N -> entry_at A i j = entry_at A j i) ->
  positive n A q -> (exists2 i, (i < n)%N & z i <> Z0) -> Z.lt Z0 (zquad n A z).
Proof.
move=> sA symA h [i il zi]; pose F := [realFieldType of rat].
have sym : symmetrical (zmx F n A) by apply/matrixP => a b; rewrite !mxE symA.
pose v : 'cV[F]_n := \col_a valZ F (z a).
have v0 : v != 0.
  apply/eqP => /colP/(_ (Ordinal il)); rewrite !mxE => /= e; apply: zi.
  have := valZ_lt0 F (z i); have := valZ_lt0 F (Z.opp (z i)); rewrite valZN e oppr0 ltxx; lia.
have := positiveP sA sym h v0; rewrite formE.
have -> : \sum_a \sum_b v a 0 * zmx F n A a b * v b 0 = valZ F (zquad n A z).
  have sum (I : finType) (f : I -> Z) : valZ F (\sum_a f a) = \sum_a valZ F (f a).
    by elim/big_rec2: _ => // a x y _ <-; rewrite -valZD.
  by rewrite /zquad sum; apply: eq_bigr => a _; rewrite sum; apply: eq_bigr => b _; rewrite !mxE !valZM.
by rewrite valZ_lt0; lia.
Qed.
