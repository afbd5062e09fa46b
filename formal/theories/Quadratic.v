(** Quadratic forms over an ordered field: inverses reverse the Loewner order, and the tangent bounds of trace and
    largest eigenvalue. No square roots, no eigenvalues. *)
From mathcomp Require Import all_ssreflect all_algebra.
From mathcomp.algebra_tactics Require Import ring.
Set Implicit Arguments.
Unset Strict Implicit.
Unset Printing Implicit Defensive.
Import Order.Theory GRing.Theory Num.Theory.
Local Open Scope ring_scope.

Section Quadratic.
Variables (F : realFieldType) (d : nat).
Implicit Types (A B L Y : 'M[F]_d) (v w y z : 'cV[F]_d) (x a : F).

Definition form A v w : F := (v^T *m A *m w) 0 0.
Definition dot v w : F := (v^T *m w) 0 0.
Definition symmetrical A : Prop := A^T = A.
Definition psd A : Prop := forall v, 0 <= form A v v.
Definition pd A : Prop := forall v, v != 0 -> 0 < form A v v.

Lemma formDm A B v w : form (A + B) v w = form A v w + form B v w.
Proof. by rewrite /form mulmxDr mulmxDl mxE. Qed.
Lemma formBm A B v w : form (A - B) v w = form A v w - form B v w.
Proof. by rewrite /form mulmxBr mulmxBl !mxE. Qed.
Lemma formZm x A v w : form (x *: A) v w = x * form A v w.
Proof. by rewrite /form -scalemxAr -scalemxAl mxE. Qed.
Lemma form0m v w : form 0 v w = 0.
Proof. by rewrite /form mulmx0 mul0mx mxE. Qed.
Lemma form_sum (I : Type) (r : seq I) (P : pred I) (G : I -> 'M[F]_d) v w :
  form (\sum_(i <- r | P i) G i) v w = \sum_(i <- r | P i) form (G i) v w.
Proof.
elim: r => [|i r IH]; first by rewrite !big_nil form0m.
by rewrite !big_cons; case: ifP => _; rewrite ?formDm IH.
Qed.
Lemma formBl A v w y : form A (v - w) y = form A v y - form A w y.
Proof. by rewrite /form linearB /= !mulmxBl !mxE. Qed.
Lemma formBr A v w y : form A v (w - y) = form A v w - form A v y.
Proof. by rewrite /form mulmxBr !mxE. Qed.
Lemma formZl A x v w : form A (x *: v) w = x * form A v w.
Proof. by rewrite /form linearZ /= -!scalemxAl mxE. Qed.
Lemma formZr A x v w : form A v (x *: w) = x * form A v w.
Proof. by rewrite /form -scalemxAr mxE. Qed.
Lemma form_scalar x v w : form x%:M v w = x * dot v w.
Proof. by rewrite /form /dot -scalemx1 -scalemxAr mulmx1 -scalemxAl mxE. Qed.
Lemma form_tr A v w : form A^T v w = form A w v.
Proof. by rewrite /form -[in LHS](trmxK w) -[in LHS]trmx_mul -trmx_mul mxE mulmxA. Qed.
Lemma form_mul A v w : form A v w = dot v (A *m w).
Proof. by rewrite /form /dot mulmxA. Qed.
Lemma dotZr x v w : dot v (x *: w) = x * dot v w.
Proof. by rewrite /dot -scalemxAr mxE. Qed.
Lemma dotC v w : dot v w = dot w v.
Proof. by rewrite -[dot v w]mul1r -[dot w v]mul1r -!form_scalar -form_tr tr_scalar_mx. Qed.
Lemma dot_sum v : dot v v = \sum_i v i 0 ^+ 2.
Proof. by rewrite /dot mxE; apply: eq_bigr => i _; rewrite mxE. Qed.
Lemma dot_ge0 v : 0 <= dot v v.
Proof. by rewrite dot_sum; apply: sumr_ge0 => i _; apply: sqr_ge0. Qed.
Lemma dot_gt0 v : v != 0 -> 0 < dot v v.
Proof.
move=> v0; rewrite lt_def dot_ge0 andbT; apply: contra v0 => /eqP; rewrite dot_sum => h.
apply/eqP/colP => i; rewrite mxE; apply/eqP; rewrite -sqrf_eq0.
by rewrite (psumr_eq0P _ h) // => j _; apply: sqr_ge0.
Qed.

Lemma form_col A i : form A (delta_mx i 0) (delta_mx i 0) = A i i.
Proof. by rewrite /form trmx_delta -rowE -colE !mxE. Qed.

Lemma trace_form A : \tr A = \sum_i form A (delta_mx i 0) (delta_mx i 0).
Proof. by apply: eq_bigr => i _; rewrite form_col. Qed.

Lemma psd_trace A : psd A -> 0 <= \tr A.
Proof. by move=> h; rewrite trace_form; apply: sumr_ge0 => i _. Qed.

Lemma psdD A B : psd A -> psd B -> psd (A + B).
Proof. by move=> a b v; rewrite formDm addr_ge0. Qed.
Lemma psdZ x A : 0 <= x -> psd A -> psd (x *: A).
Proof. by move=> x0 a v; rewrite formZm mulr_ge0. Qed.
Lemma psd0 : psd 0.
Proof. by move=> v; rewrite form0m. Qed.
Lemma psd_sum (I : Type) (r : seq I) (P : pred I) (G : I -> 'M[F]_d) :
  (forall i, P i -> psd (G i)) -> psd (\sum_(i <- r | P i) G i).
Proof. by move=> h v; rewrite form_sum; apply: sumr_ge0 => i Pi; apply: h. Qed.
Lemma psd_scalar x : 0 <= x -> psd x%:M.
Proof. by move=> x0 v; rewrite form_scalar mulr_ge0 ?dot_ge0. Qed.
Lemma pd_psd A : pd A -> psd A.
Proof.
move=> h v; have [->|v0] := eqVneq v 0; last exact/ltW/h.
by rewrite /form mulmx0 mxE.
Qed.
Lemma pd_add A B : pd A -> psd B -> pd (A + B).
Proof. by move=> a b v v0; rewrite formDm ltr_paddr ?a. Qed.
Lemma pd_above A B : pd A -> psd (B - A) -> pd B.
Proof. by move=> a b; have := pd_add a b; rewrite addrC subrK. Qed.

Lemma pd_unit A : pd A -> A \in unitmx.
Proof.
move=> h; rewrite -row_free_unit -kermx_eq0; apply/negPn/negP => /rowV0Pn[u /sub_kermxP uA u0].
have ut : u^T != 0 by apply: contra u0 => /eqP eq; rewrite -[u]trmxK eq trmx0.
by have := h _ ut; rewrite /form trmxK uA mul0mx mxE ltxx.
Qed.

Lemma symmetrical_inv A : symmetrical A -> symmetrical (invmx A).
Proof. by move=> s; rewrite /symmetrical trmx_inv s. Qed.

(** [v' L^-1 v >= 2 v'y - y'Ly], from [(L^-1 v - y)' L (L^-1 v - y) >= 0]. *)
Lemma tangent L v y : symmetrical L -> pd L -> 2%:R * dot v y - form L y y <= form (invmx L) v v.
Proof.
move=> s p; have u := pd_unit p; have := pd_psd p (invmx L *m v - y).
have iv : L *m (invmx L *m v) = v by rewrite mulKVmx.
rewrite formBr !formBl; have -> : form L (invmx L *m v) (invmx L *m v) = form (invmx L) v v.
  by rewrite form_mul iv dotC -form_mul.
have -> : form L y (invmx L *m v) = dot v y by rewrite form_mul iv dotC.
have -> : form L (invmx L *m v) y = dot v y by rewrite -form_tr s form_mul iv dotC.
move=> h; rewrite -subr_ge0; apply: le_trans h _.
by rewrite le_eqVlt; apply/orP; left; apply/eqP; ring.
Qed.

(** Inverses reverse the Loewner order. *)
Lemma inverse_antitone A B : symmetrical A -> symmetrical B -> pd A -> psd (B - A) -> psd (invmx A - invmx B).
Proof.
move=> sA sB pA AB v; have pB := pd_above pA AB.
rewrite formBm subr_ge0; apply: le_trans (tangent v (invmx B *m v) sA pA).
have := AB (invmx B *m v); rewrite formBm subr_ge0 => h.
have e : form B (invmx B *m v) (invmx B *m v) = form (invmx B) v v.
  by rewrite form_mul mulKVmx ?pd_unit // dotC -form_mul.
rewrite e in h; rewrite -form_mul ler_subr_addr.
have -> : 2%:R * form (invmx B) v v = form (invmx B) v v + form (invmx B) v v by ring.
by rewrite ler_add2l.
Qed.

(** [tr (L^-1) >= 2 tr Y - tr (Y' L Y)] for any [Y]. *)
Theorem trace_fenchel L Y : symmetrical L -> pd L -> 2%:R * \tr Y - \tr (Y^T *m L *m Y) <= \tr (invmx L).
Proof.
move=> s p; rewrite !trace_form mulr_sumr -sumrB; apply: ler_sum => i _.
apply: le_trans (tangent (delta_mx i 0) (Y *m delta_mx i 0) s p).
by rewrite -form_mul /form trmx_mul !mulmxA.
Qed.

(** It is attained at [Y = L^-1]. *)
Lemma trace_fenchel_tight L : symmetrical L -> pd L ->
  2%:R * \tr (invmx L) - \tr ((invmx L)^T *m L *m invmx L) = \tr (invmx L).
Proof. by move=> s p; rewrite (symmetrical_inv s) mulVmx ?pd_unit // mul1mx; ring. Qed.

Lemma trace_inverse_antitone A B : symmetrical A -> symmetrical B -> pd A -> psd (B - A) ->
  \tr (invmx B) <= \tr (invmx A).
Proof.
move=> sA sB pA AB; rewrite -subr_ge0 -linearB /=; apply: psd_trace; exact: inverse_antitone.
Qed.

(** ** The largest eigenvalue, known by what it is compared with *)
Definition largest_eigenvalue (lmax : 'M[F]_d -> F) : Prop :=
  forall A, symmetrical A -> forall x, (lmax A <= x) <-> psd (x%:M - A).

Variable lmax : 'M[F]_d -> F.
Hypothesis lmaxP : largest_eigenvalue lmax.

(** [lambda_max(L^-1) >= 2t - t^2 v'Lv / v'v]. *)
Theorem largest_eigenvalue_fenchel L v x : symmetrical L -> pd L -> v != 0 ->
  2%:R * x - x ^+ 2 * (form L v v / dot v v) <= lmax (invmx L).
Proof.
move=> s p v0; have vv := dot_gt0 v0; have /lmaxP/(_ v) := lexx (lmax (invmx L)).
move=> /(_ (symmetrical_inv s)); rewrite formBm form_scalar subr_ge0 => h.
have := le_trans (tangent v (x *: v) s p) h.
rewrite dotZr formZl formZr -ler_pdivr_mulr // => h2; apply: le_trans h2.
rewrite le_eqVlt; apply/orP; left; apply/eqP.
by field; rewrite gt_eqF.
Qed.

Lemma largest_eigenvalue_antitone A B : symmetrical A -> symmetrical B -> pd A -> psd (B - A) ->
  lmax (invmx B) <= lmax (invmx A).
Proof.
move=> sA sB pA AB; apply/lmaxP; first exact: symmetrical_inv.
have /lmaxP h := lexx (lmax (invmx A)); move: (h (symmetrical_inv sA)) => {}h.
have := psdD h (inverse_antitone sA sB pA AB); congr psd.
by rewrite addrA subrK.
Qed.
End Quadratic.
