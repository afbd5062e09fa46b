(** The part of each target's state that counts, as data: exact squares, traces and covariances. *)
From Coq Require Import ZArith.
From mathcomp Require Import all_ssreflect all_algebra.
From Ratt Require Import Quadratic Dyadic DyadicMatrix.
Set Implicit Arguments.
Unset Strict Implicit.
Unset Printing Implicit Defensive.
Import Order.Theory GRing.Theory Num.Theory.

(** For each target the entries of a matrix of [d] columns, row by row; none where all of each state counts. *)
Definition outputs_data := option (seq (seq dyadic)).

Section Outputs.
Variables (d : nat) (o : outputs_data).

Definition flat_at (columns : nat) (flat : seq dyadic) (i k : nat) : dyadic := nth d0 flat (i * columns + k).
Definition output_rows (j : nat) : nat := if o is Some cs then size (nth [::] cs j) %/ d else d.
Definition output_entry (j i k : nat) : dyadic :=
  if o is Some cs then flat_at d (nth [::] cs j) i k else if i == k then d1 else d0.
Definition outputs_ok (m : nat) : bool :=
  if o is Some cs then (size cs == m) && all (fun c => (0 < size c) && (d %| size c))%N cs else true.

(** [C'C] for each target; an empty list where there are no outputs. *)
Definition squares : seq (option dmat) :=
  if o is Some cs then
    mkseq (fun j => Some (mkm d (fun i k => dsum [seq dmul (output_entry j r i) (output_entry j r k) | r <- iota 0 (output_rows j)])))
      (size cs)
  else [::].
(** [C P C']. *)
Definition covariance (j : nat) (P : dmat) : dmat :=
  if isSome o then mkm (output_rows j) (fun a b => dsum [seq dsum [seq
    dmul (dmul (output_entry j a i) (get P i k)) (output_entry j b k) | k <- iota 0 d] | i <- iota 0 d])
  else P.

(** A matrix [Y] of [d] rows, one column for each of [C]; symmetric where all of the state counts. *)
Definition touching (j : nat) (flat : seq dyadic) : dmat :=
  if o is None then unpack d flat
  else [seq [seq flat_at (output_rows j) flat i r | r <- iota 0 (output_rows j)] | i <- iota 0 d].
(** [Y Y'] and [tr (C Y)]. *)
Definition outer_product (q : nat) (Y : dmat) : dmat :=
  mkm d (fun i k => dsum [seq dmul (get Y i r) (get Y k r) | r <- iota 0 q]).
Definition touching_trace (j : nat) (Y : dmat) : dyadic :=
  if o is None then mtrace d Y
  else dsum [seq dsum [seq dmul (output_entry j r i) (get Y i r) | i <- iota 0 d] | r <- iota 0 (output_rows j)].
End Outputs.

(** [v' S v], [w S]; [S] is the identity where none is given. *)
Definition length_of (d : nat) (S : option dmat) (v : seq dyadic) : dyadic :=
  if S is Some A then
    dsum [seq dsum [seq dmul (dmul (nth d0 v i) (get A i k)) (nth d0 v k) | k <- iota 0 d] | i <- iota 0 d]
  else dsum [seq dmul (nth d0 v i) (nth d0 v i) | i <- iota 0 d].
Definition weighted_square (d : nat) (w : dyadic) (S : option dmat) : dmat :=
  if S is Some A then mscale d w A else mscalar d w.

Local Open Scope ring_scope.

Section Meaning.
Variables (F : realFieldType) (d : nat) (o : outputs_data).
Local Notation val := (val F).
Local Notation rows := (output_rows d o).

(** The matrix [C] of a target. *)
Definition output_mx (j : nat) : 'M[F]_(rows j, d) := \matrix_(i, k) val (output_entry d o j i k).

Lemma output_mx_none j : o = None -> forall A, mx F _ (covariance d o j A) = part_of (output_mx j) (mx F d A).
Proof.
rewrite /output_mx /output_rows /output_entry /covariance; case: o => [//|_] A.
rewrite (_ : \matrix_(_, _) _ = 1%:M) ?part_of1 //; apply/matrixP => i k; rewrite !mxE -val_eqE /=.
by case: eqP => _; rewrite ?val1 ?val0.
Qed.

Lemma output_mx_id j : o = None -> (output_mx j)^T *m output_mx j = 1%:M.
Proof.
rewrite /output_mx /output_rows /output_entry; case: o => [//|_].
rewrite (_ : \matrix_(_, _) _ = 1%:M) ?trmx1 ?mulmx1 //; apply/matrixP => i k; rewrite !mxE -val_eqE /=.
by case: eqP => _; rewrite ?val1 ?val0.
Qed.

Lemma mx_covariance j P : mx F _ (covariance d o j P) = part_of (output_mx j) (mx F d P).
Proof.
case e : (isSome o); last by apply: output_mx_none; case: (o) e.
rewrite /covariance e mx_mkm; apply/matrixP => a b; rewrite !mxE val_sum_iota.
under [RHS]eq_bigr => k _ do rewrite mxE mulr_suml.
rewrite [RHS]exchange_big; apply: eq_bigr => i _; rewrite val_sum_iota; apply: eq_bigr => k _.
by rewrite !mxE !val_mul.
Qed.

Lemma mx_squares j m : outputs_ok d o m -> (j < m)%N ->
  square_mx F d (nth None (squares d o) j) = (output_mx j)^T *m output_mx j.
Proof.
case e : (isSome o) => ok jm; last first.
  have n : o = None by case: (o) e.
  by rewrite output_mx_id // n nth_nil.
have -> : nth None (squares d o) j = Some (mkm d (fun i k => dsum
    [seq dmul (output_entry d o j r i) (output_entry d o j r k) | r <- iota 0 (output_rows d o j)])).
  by move: ok e jm; rewrite /squares /outputs_ok; case: (o) => [cs|//] /andP[/eqP sz _] _ jm; rewrite nth_mkseq ?sz.
rewrite /= mx_mkm; apply/matrixP => i k; rewrite !mxE val_sum_iota.
by apply: eq_bigr => r _; rewrite !mxE val_mul.
Qed.

Definition touch_mx (j : nat) (Y : dmat) : 'M[F]_(d, rows j) := \matrix_(i, r) val (get Y i r).

Lemma mx_outer j Y : mx F d (outer_product d (rows j) Y) = touch_mx j Y *m (touch_mx j Y)^T.
Proof.
rewrite mx_mkm; apply/matrixP => i k; rewrite !mxE val_sum_iota.
by apply: eq_bigr => r _; rewrite !mxE val_mul.
Qed.

Lemma touching_traceP j Y : val (touching_trace d o j Y) = \tr (output_mx j *m touch_mx j Y).
Proof.
rewrite /touch_mx /output_mx /touching_trace /output_rows /output_entry; case: o => [cs|].
  rewrite val_sum_iota; apply: eq_bigr => r _; rewrite mxE val_sum_iota; apply: eq_bigr => i _.
  by rewrite !mxE val_mul.
rewrite (_ : \matrix_(_, _) val (if _ then _ else _) = 1%:M) ?mul1mx ?mx_trace //.
by apply/matrixP => i k; rewrite !mxE -val_eqE /=; case: eqP => _; rewrite ?val1 ?val0.
Qed.

Lemma length_ofP S (v : seq dyadic) : let V : 'cV[F]_d := \col_i val (nth d0 v i) in
  val (length_of d S v) = form (square_mx F d S) V V.
Proof.
case: S => [A|] V /=; rewrite val_sum_iota.
  rewrite formE; apply: eq_bigr => i _; rewrite val_sum_iota; apply: eq_bigr => k _.
  by rewrite !mxE !val_mul.
by rewrite form_scalar mul1r dot_sum; apply: eq_bigr => i _; rewrite mxE val_mul expr2.
Qed.

Lemma mx_weighted_square w S : mx F d (weighted_square d w S) = val w *: square_mx F d S.
Proof. by case: S => [A|] /=; rewrite ?mx_scale // mx_scalar scalemx1. Qed.
End Meaning.
