(** Small dense matrices of binary fractions: exact tests of definiteness, checked inverses. *)
From Coq Require Import ZArith.
From mathcomp Require Import all_ssreflect all_algebra.
From mathcomp.algebra_tactics Require Import ring.
From Ratt Require Import Quadratic Dyadic.
Set Implicit Arguments.
Unset Strict Implicit.
Unset Printing Implicit Defensive.
Import Order.Theory GRing.Theory Num.Theory.

Definition dmat := seq (seq dyadic).
Definition mkm (d : nat) (f : nat -> nat -> dyadic) : dmat := [seq [seq f i j | j <- iota 0 d] | i <- iota 0 d].
Definition get (A : dmat) (i j : nat) : dyadic := nth d0 (nth [::] A i) j.

Section Operations.
Variable d : nat.
Definition madd (A B : dmat) : dmat := mkm d (fun i j => dadd (get A i j) (get B i j)).
Definition msub (A B : dmat) : dmat := mkm d (fun i j => dsub (get A i j) (get B i j)).
Definition mscale (x : dyadic) (A : dmat) : dmat := mkm d (fun i j => dmul x (get A i j)).
Definition mscalar (x : dyadic) : dmat := mkm d (fun i j => if i == j then x else d0).
Definition mmul (A B : dmat) : dmat :=
  mkm d (fun i j => dsum [seq dmul (get A i k) (get B k j) | k <- iota 0 d]).
Definition mtrace (A : dmat) : dyadic := dsum [seq get A i i | i <- iota 0 d].
(** [tr (A' B)]. *)
Definition mdot (A B : dmat) : dyadic :=
  dsum [seq dsum [seq dmul (get A i j) (get B i j) | j <- iota 0 d] | i <- iota 0 d].
Definition meq (A B : dmat) : bool :=
  all (fun i => all (fun j => dle (get A i j) (get B i j) && dle (get B i j) (get A i j)) (iota 0 d)) (iota 0 d).
(** A symmetric matrix from its lower triangle, row by row. *)
Definition unpack (flat : seq dyadic) : dmat :=
  mkm d (fun i j => let a := maxn i j in nth d0 flat ((a * a.+1)./2 + minn i j)).
End Operations.

Definition is_zero (x : dyadic) : bool := Z.eqb (man x) 0.

(** Fraction-free elimination. *)
Definition schur (n : nat) (A : dmat) : dmat :=
  mkm n (fun i j => dsub (dmul (get A 0 0) (get A i.+1 j.+1)) (dmul (get A i.+1 0) (get A 0 j.+1))).
Definition minor (n : nat) (A : dmat) : dmat := mkm n (fun i j => get A i.+1 j.+1).
Fixpoint is_pd (n : nat) (A : dmat) : bool :=
  if n is n'.+1 then dlt d0 (get A 0 0) && is_pd n' (schur n' A) else true.
Fixpoint is_psd (n : nat) (A : dmat) : bool :=
  if n is n'.+1 then
    if dlt d0 (get A 0 0) then is_psd n' (schur n' A)
    else [&& dle d0 (get A 0 0), all (fun i => is_zero (get A i.+1 0) && is_zero (get A 0 i.+1)) (iota 0 n')
         & is_psd n' (minor n' A)]
  else true.

(** Hint: [(W, D)] with [A W = D I]; closed for two rows, else by Faddeev and LeVerrier. *)
Fixpoint leverrier (d : nat) (A M : dmat) (k todo : nat) : dmat * dyadic :=
  let AM := mmul d A M in
  let t := mtrace d AM in
  let c := quotient_near (sc t + 16) (dopp t) (dnat k) in
  if todo is n.+1 then leverrier d A (madd d AM (mscalar d c)) k.+1 n else (M, dopp c).
Definition inverse_hint (d : nat) (A : dmat) : dmat * dyadic :=
  if d == 2%N then
    let a := get A 0 0 in let b := get A 0 1 in let c := get A 1 0 in let e := get A 1 1 in
    ([:: [:: e; dopp b]; [:: dopp c; a]], dsub (dmul a e) (dmul b c))
  else let (M, D) := leverrier d A (mscalar d d1) 1 d.-1 in
    if dlt d0 D then (M, D) else (mscale d (dopp d1) M, dopp D).
Definition inverse_ok (d : nat) (A : dmat) (h : dmat * dyadic) : bool :=
  dlt d0 h.2 && meq d (mmul d A h.1) (mscalar d h.2).

(** [tr (S' A)], where [S] is the identity if none is given. *)
Definition trace_with (d : nat) (S : option dmat) (A : dmat) : dyadic := if S is Some B then mdot d B A else mtrace d A.
(** An upper bound on [tr (S' A^-1)] for a positive definite matrix. *)
Definition trace_inverse_up (p : N) (d : nat) (S : option dmat) (A : dmat) : option dyadic :=
  let h := inverse_hint d A in
  let t := trace_with d S h.1 in
  let q := quotient_up p t h.2 in
  if [&& is_pd d A, inverse_ok d A h & dle t (dmul q h.2)] then Some q else None.

Local Open Scope ring_scope.

Section Meaning.
Variable F : realFieldType.
Local Notation val := (val F).

Definition mx (d : nat) (A : dmat) : 'M[F]_d := \matrix_(i, j) val (get A i j).

Lemma get_mkm d f i j : (i < d)%N -> (j < d)%N -> get (mkm d f) i j = f i j.
Proof.
move=> id jd; rewrite /get /mkm (nth_map 0%N) ?size_iota // nth_iota // add0n.
by rewrite (nth_map 0%N) ?size_iota // nth_iota.
Qed.

Lemma mx_mkm d f : mx d (mkm d f) = \matrix_(i, j) val (f i j).
Proof. by apply/matrixP => i j; rewrite !mxE get_mkm. Qed.

Lemma mx_nil d : mx d [::] = 0.
Proof. by apply/matrixP => i j; rewrite !mxE /get !nth_nil /= val0. Qed.
Lemma mx_add d A B : mx d (madd d A B) = mx d A + mx d B.
Proof. by rewrite mx_mkm; apply/matrixP => i j; rewrite !mxE val_add. Qed.
Lemma mx_sub d A B : mx d (msub d A B) = mx d A - mx d B.
Proof. by rewrite mx_mkm; apply/matrixP => i j; rewrite !mxE val_sub. Qed.
Lemma mx_scale d x A : mx d (mscale d x A) = val x *: mx d A.
Proof. by rewrite mx_mkm; apply/matrixP => i j; rewrite !mxE val_mul. Qed.
Lemma mx_scalar d x : mx d (mscalar d x) = (val x)%:M.
Proof.
rewrite mx_mkm; apply/matrixP => i j; rewrite !mxE -val_eqE /=.
by case: eqP => _; rewrite ?mulr1n ?mulr0n ?val0.
Qed.
Lemma val_sum_iota d (f : nat -> dyadic) : val (dsum [seq f i | i <- iota 0 d]) = \sum_(i < d) val (f i).
Proof. by rewrite val_sum big_map -(big_mkord xpredT (fun i => val (f i))) /index_iota subn0. Qed.
Lemma mx_mul d A B : mx d (mmul d A B) = mx d A *m mx d B.
Proof.
rewrite mx_mkm; apply/matrixP => i j; rewrite !mxE val_sum_iota.
by apply: eq_bigr => k _; rewrite !mxE val_mul.
Qed.
Lemma mx_trace d A : val (mtrace d A) = \tr (mx d A).
Proof. by rewrite val_sum_iota; apply: eq_bigr => i _; rewrite mxE. Qed.
Lemma mx_dot d A B : val (mdot d A B) = \tr ((mx d A)^T *m mx d B).
Proof.
rewrite val_sum_iota (_ : \tr _ = \sum_i \sum_j mx d A j i * mx d B j i); last first.
  by apply: eq_bigr => i _; rewrite mxE; apply: eq_bigr => j _; rewrite !mxE.
rewrite exchange_big; apply: eq_bigr => i _; rewrite val_sum_iota.
by apply: eq_bigr => j _; rewrite !mxE val_mul.
Qed.
Lemma mx_eq d A B : meq d A B -> mx d A = mx d B.
Proof.
move=> /allP h; apply/matrixP => i j; rewrite !mxE.
have io (k : 'I_d) : (k : nat) \in iota 0 d by rewrite mem_iota add0n ltn_ord.
have /allP hi := h _ (io i); have := hi _ (io j); rewrite !(val_le F) => le; exact: le_anti.
Qed.

Lemma unpack_symmetrical d flat : symmetrical (mx d (unpack d flat)).
Proof. by rewrite /symmetrical mx_mkm; apply/matrixP => i j; rewrite !mxE maxnC minnC. Qed.

(** ** Elimination decides definiteness *)
Lemma formE n (M : 'M[F]_n) v w : form M v w = \sum_i \sum_j v i 0 * M i j * w j 0.
Proof.
rewrite /form mxE exchange_big /=; apply: eq_bigr => j _; rewrite mxE mulr_suml.
by apply: eq_bigr => i _; rewrite !mxE.
Qed.

Definition schur_mx n (M : 'M[F]_n.+1) : 'M[F]_n :=
  \matrix_(i, j) (M 0 0 * M (lift 0 i) (lift 0 j) - M (lift 0 i) 0 * M 0 (lift 0 j)).
Definition tail n (v : 'cV[F]_n.+1) : 'cV[F]_n := \col_i v (lift 0 i) 0.
Definition cons_col n (x : F) (y : 'cV[F]_n) : 'cV[F]_n.+1 :=
  \col_i (if unlift 0 i is Some j then y j 0 else x).

Lemma tail_cons n x (y : 'cV[F]_n) : tail (cons_col x y) = y.
Proof. by apply/colP => i; rewrite !mxE liftK. Qed.
Lemma head_cons n x (y : 'cV[F]_n) : cons_col x y 0 0 = x.
Proof. by rewrite mxE unlift_none. Qed.

Lemma schur_form n (M : 'M[F]_n.+1) v : symmetrical M ->
  M 0 0 * form M v v = (M 0 0 * v 0 0 + \sum_i M (lift 0 i) 0 * tail v i 0) ^+ 2 + form (schur_mx M) (tail v) (tail v).
Proof.
move=> sM; set b := \sum_i _; set c := \sum_i \sum_j tail v i 0 * M (lift 0 i) (lift 0 j) * tail v j 0.
have row : \sum_j M 0 (lift 0 j) * tail v j 0 = b.
  by apply: eq_bigr => j _; congr (_ * _); rewrite -[in LHS]sM mxE.
have -> : form M v v = v 0 0 * M 0 0 * v 0 0 + v 0 0 * b + b * v 0 0 + c.
  have e1 : \sum_(j < n) v 0 0 * M 0 (lift 0 j) * v (lift 0 j) 0 = v 0 0 * b.
    by rewrite -row mulr_sumr; apply: eq_bigr => j _; rewrite !mxE mulrA.
  have e2 : \sum_(i < n) \sum_j v (lift 0 i) 0 * M (lift 0 i) j * v j 0 = b * v 0 0 + c.
    rewrite /b mulr_suml -big_split; apply: eq_bigr => i _; rewrite big_ord_recl; congr (_ + _).
      by rewrite [tail v i 0]mxE [_ * v (lift 0 i) 0]mulrC.
    by apply: eq_bigr => j _; rewrite !mxE.
  by rewrite formE big_ord_recl big_ord_recl e1 e2 addrA.
have -> : form (schur_mx M) (tail v) (tail v) = M 0 0 * c - b * b.
  rewrite formE /c mulr_sumr -{2}row /b mulr_suml -sumrB; apply: eq_bigr => i _.
  rewrite mulr_sumr mulr_sumr -sumrB; apply: eq_bigr => j _; rewrite !mxE; ring.
ring.
Qed.

Lemma pd_schur n (M : 'M[F]_n.+1) : symmetrical M -> 0 < M 0 0 -> pd (schur_mx M) -> pd M.
Proof.
move=> sM a0 pS v v0; rewrite -(pmulr_rgt0 _ a0) schur_form //.
have [y0|y0] := eqVneq (tail v) 0; last by rewrite ltr_paddl ?sqr_ge0 ?pS.
have x0 : v 0 0 != 0.
  apply: contra v0 => /eqP x0; apply/eqP/colP => i; rewrite mxE.
  case: (unliftP 0 i) => [j ->|-> //]; by have /colP/(_ j) := y0; rewrite !mxE.
have f0 : form (schur_mx M) 0 0 = 0 by rewrite /form mulmx0 mxE.
rewrite y0 f0 addr0 big1 => [|i _]; last by rewrite mxE mulr0.
by rewrite addr0 lt_def sqr_ge0 andbT sqrf_eq0 mulf_eq0 negb_or x0 andbT gt_eqF.
Qed.

Lemma schur_pd n (M : 'M[F]_n.+1) : symmetrical M -> pd M -> 0 < M 0 0 /\ pd (schur_mx M).
Proof.
move=> sM pM; have a0 : 0 < M 0 0.
  rewrite -form_col; apply: pM; apply/eqP => /colP/(_ 0); rewrite !mxE eqxx => /eqP.
  by rewrite oner_eq0.
split=> // y y0; set b := \sum_i M (lift 0 i) 0 * y i 0.
have := pM (cons_col (- (b / M 0 0)) y); rewrite -(pmulr_rgt0 _ a0) schur_form // tail_cons head_cons -/b.
rewrite mulrN mulrCA divff ?gt_eqF // mulr1 addNr expr0n /= add0r; apply.
by apply: contra y0 => /eqP h; rewrite -(tail_cons (- (b / M 0 0)) y) h; apply/eqP/colP => i; rewrite !mxE.
Qed.

Lemma psd_schur n (M : 'M[F]_n.+1) : symmetrical M -> 0 < M 0 0 -> psd (schur_mx M) -> psd M.
Proof. by move=> sM a0 pS v; rewrite -(pmulr_rge0 _ a0) schur_form // addr_ge0 ?sqr_ge0. Qed.

Lemma mx_schur n A : mx n (schur n A) = schur_mx (mx n.+1 A).
Proof. by rewrite mx_mkm; apply/matrixP => i j; rewrite !mxE val_sub !val_mul. Qed.

Lemma symmetrical_schur n (M : 'M[F]_n.+1) : symmetrical M -> symmetrical (schur_mx M).
Proof.
move=> sM; have e i j : M i j = M j i by rewrite -[in LHS]sM mxE.
by apply/matrixP => i j; rewrite !mxE (e (lift 0 j) (lift 0 i)) (e _ 0) (e 0 (lift 0 i)) mulrC [X in _ - X]mulrC mulrC.
Qed.

Lemma is_pdP n A : symmetrical (mx n A) -> (is_pd n A <-> pd (mx n A)).
Proof.
elim: n A => [|n IH] A sA /=.
  by split=> // _ v; rewrite (_ : v = 0) ?eqxx //; apply/colP => -[].
have sS := symmetrical_schur sA; rewrite -mx_schur in sS.
rewrite (val_lt F) val0; split=> [/andP[a0 /(IH _ sS)]|/(schur_pd sA)[a0]].
  by rewrite mx_schur => h; apply: pd_schur; rewrite ?mxE.
by rewrite mxE in a0; rewrite a0 -mx_schur => /(IH _ sS) ->.
Qed.

Lemma is_psdP n A : symmetrical (mx n A) -> is_psd n A -> psd (mx n A).
Proof.
elim: n A => [|n IH] A sA /=.
  by move=> _ v; rewrite (_ : v = 0) /form ?mulmx0 ?mxE //; apply/colP => -[].
have sS := symmetrical_schur sA; rewrite -mx_schur in sS.
rewrite (val_lt F) val0; case: ifP => [a0 /(IH _ sS)|a0].
  by rewrite mx_schur => h; apply: psd_schur; rewrite ?mxE.
rewrite (val_le F) val0 => /and3P[a1 /allP zero h] v.
have a00 : val (get A 0 0) = 0 by apply: le_anti; rewrite a1 leNgt a0.
have z (i : 'I_n) : mx n.+1 A (lift 0 i) 0 = 0 /\ mx n.+1 A 0 (lift 0 i) = 0.
  have /zero/andP[/Z.eqb_spec h1 /Z.eqb_spec h2] : (i : nat) \in iota 0 n by rewrite mem_iota add0n ltn_ord.
  by rewrite !mxE /= /val h1 h2 !mul0r.
have eqm : mx n (minor n A) = \matrix_(i, j) mx n.+1 A (lift 0 i) (lift 0 j).
  by rewrite mx_mkm; apply/matrixP => i j; rewrite !mxE.
have sm : symmetrical (mx n (minor n A)).
  have e i j : mx n.+1 A i j = mx n.+1 A j i by rewrite -[in LHS]sA mxE.
  by rewrite eqm; apply/matrixP => i j; rewrite [LHS]mxE [LHS]mxE [RHS]mxE; apply: e.
suff -> : form (mx n.+1 A) v v = form (mx n (minor n A)) (tail v) (tail v) by apply: IH.
rewrite [LHS]formE big_ord_recl big1 => [|j _]; last first.
  case: (unliftP 0 j) => [k ->|->]; first by rewrite (z k).2 mulr0 mul0r.
  by rewrite [mx _ _ _ _]mxE a00 mulr0 mul0r.
rewrite add0r eqm formE; apply: eq_bigr => i _; rewrite big_ord_recl (z i).1 mulr0 mul0r add0r.
by apply: eq_bigr => j _; rewrite !mxE.
Qed.

(** ** Checked inverses *)
Lemma inverse_okP d A h : inverse_ok d A h -> 0 < val h.2 /\ invmx (mx d A) = (val h.2)^-1 *: mx d h.1.
Proof.
rewrite /inverse_ok (val_lt F) val0 => /andP[D0 /mx_eq]; rewrite mx_mul mx_scalar => eq; split=> //.
have e1 : mx d A *m ((val h.2)^-1 *: mx d h.1) = 1%:M.
  by rewrite -scalemxAr eq -scalemx1 scalerA mulVf ?gt_eqF // scale1r.
have [u _] := mulmx1_unit e1.
by rewrite -[RHS]mul1mx -(mulVmx u) -mulmxA e1 mulmx1.
Qed.

Definition square_mx (d : nat) (S : option dmat) : 'M[F]_d := if S is Some B then mx d B else 1%:M.
Lemma trace_withP d S A : val (trace_with d S A) = \tr ((square_mx d S)^T *m mx d A).
Proof. by case: S => [B|]; rewrite /trace_with /= ?mx_dot // mx_trace trmx1 mul1mx. Qed.

Lemma trace_inverse_upP p d S A q : symmetrical (mx d A) -> trace_inverse_up p d S A = Some q ->
  pd (mx d A) /\ \tr ((square_mx d S)^T *m invmx (mx d A)) <= val q.
Proof.
rewrite /trace_inverse_up; set h := inverse_hint d A => sA; case: ifP => // /and3P[/(is_pdP sA) pA ok le] []<-.
have [D0 ->] := inverse_okP ok; split=> //.
by rewrite -scalemxAr linearZ /= mulrC ler_pdivr_mulr // -trace_withP -val_mul -val_le.
Qed.
End Meaning.
