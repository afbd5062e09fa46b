(** Quadratic forms over an ordered field: inverses reverse the Loewner order, and the tangent bounds of trace and
    largest eigenvalue, of the whole state or of a part of it. No square roots, no eigenvalues. *)
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

(** ** The largest eigenvalue, known by what it is compared with *)
Definition largest_eigenvalue (lmax : 'M[F]_d -> F) : Prop :=
  forall A, symmetrical A -> forall x, (lmax A <= x) <-> psd (x%:M - A).
End Quadratic.

(** ** A part [C x] of a state [x] *)
Section Part.
Variables (F : realFieldType) (d q : nat) (C : 'M[F]_(q, d)).
Implicit Types (A B L : 'M[F]_d) (Y : 'M[F]_(d, q)) (v : 'cV[F]_d).

(** The covariance of [C x] where [A] is that of [x]. *)
Definition part_of A : 'M[F]_q := C *m A *m C^T.

Lemma form_part A u w : form (part_of A) u w = form A (C^T *m u) (C^T *m w).
Proof. by rewrite /form /part_of trmx_mul trmxK !mulmxA. Qed.

Lemma symmetrical_part A : symmetrical A -> symmetrical (part_of A).
Proof. by move=> s; rewrite /symmetrical /part_of !trmx_mul trmxK s mulmxA. Qed.

Lemma psd_part A : psd A -> psd (part_of A).
Proof. by move=> h u; rewrite form_part. Qed.

Lemma part_ofB A B : part_of (A - B) = part_of A - part_of B.
Proof. by rewrite /part_of mulmxBr mulmxBl. Qed.

Lemma trace_part A : \tr (part_of A) = \tr (C^T *m C *m A).
Proof. by rewrite /part_of mxtrace_mulC mulmxA. Qed.

(** [tr (C L^-1 C') >= 2 tr (C Y) - tr (Y' L Y)] for any [Y]. *)
Theorem trace_fenchel L Y : symmetrical L -> pd L ->
  2%:R * \tr (C *m Y) - \tr (Y^T *m L *m Y) <= \tr (part_of (invmx L)).
Proof.
move=> s p; rewrite !trace_form mulr_sumr -sumrB; apply: ler_sum => i _; rewrite form_part.
apply: le_trans (tangent (C^T *m delta_mx i 0) (Y *m delta_mx i 0) s p).
by rewrite /dot /form !trmx_mul trmxK !mulmxA.
Qed.

(** It is attained at [Y = L^-1 C']. *)
Lemma trace_fenchel_tight L : symmetrical L -> pd L -> let Y := invmx L *m C^T in
  2%:R * \tr (C *m Y) - \tr (Y^T *m L *m Y) = \tr (part_of (invmx L)).
Proof.
move=> s p Y; rewrite /Y trmx_mul trmxK (symmetrical_inv s) -!mulmxA mulKVmx ?pd_unit // /part_of mulmxA.
by rewrite mulr_natl mulr2n addrK.
Qed.

Lemma trace_inverse_antitone A B : symmetrical A -> symmetrical B -> pd A -> psd (B - A) ->
  \tr (part_of (invmx B)) <= \tr (part_of (invmx A)).
Proof.
move=> sA sB pA AB; rewrite -subr_ge0 -linearB /= -part_ofB; apply/psd_trace/psd_part; exact: inverse_antitone.
Qed.

Variable lmax : 'M[F]_q -> F.
Hypothesis lmaxP : largest_eigenvalue lmax.

Lemma le_largest_eigenvalue A u : symmetrical A -> form A (C^T *m u) (C^T *m u) <= lmax (part_of A) * dot u u.
Proof.
move=> s; have /lmaxP/(_ u) := lexx (lmax (part_of A)).
by move=> /(_ (symmetrical_part s)); rewrite formBm form_scalar subr_ge0 form_part.
Qed.

(** [lambda_max (C L^-1 C') >= 2t - t^2 v'Lv / |Cv|^2]. *)
Theorem largest_eigenvalue_fenchel L v x : symmetrical L -> pd L -> C *m v != 0 ->
  2%:R * x - x ^+ 2 * (form L v v / dot (C *m v) (C *m v)) <= lmax (part_of (invmx L)).
Proof.
move=> s p v0; have vv := dot_gt0 v0.
have := le_trans (tangent (C^T *m (C *m v)) (x *: v) s p) (le_largest_eigenvalue (C *m v) (symmetrical_inv s)).
have -> : dot (C^T *m (C *m v)) (x *: v) = x * dot (C *m v) (C *m v).
  by rewrite dotZr /dot !trmx_mul trmxK !mulmxA.
rewrite formZl formZr -ler_pdivr_mulr // => h; apply: le_trans h.
rewrite le_eqVlt; apply/orP; left; apply/eqP.
by field; rewrite gt_eqF.
Qed.

Lemma largest_eigenvalue_antitone A B : symmetrical A -> symmetrical B -> pd A -> psd (B - A) ->
  lmax (part_of (invmx B)) <= lmax (part_of (invmx A)).
Proof.
move=> sA sB pA AB; apply/lmaxP; first exact/symmetrical_part/symmetrical_inv.
have /lmaxP h := lexx (lmax (part_of (invmx A))); move: (h (symmetrical_part (symmetrical_inv sA))) => {}h.
have := psdD h (psd_part (inverse_antitone sA sB pA AB)); congr psd.
by rewrite part_ofB addrA subrK.
Qed.

(** With [L > 0] and [a > 0]: [lambda_max (C L^-1 C') <= x / w] where [x L - w C'C >= 0]. *)
Lemma largest_eigenvalue_below L w x : symmetrical L -> pd L -> 0 < w -> 0 < x ->
  psd (x *: L - w *: (C^T *m C)) -> w * lmax (part_of (invmx L)) <= x.
Proof.
move=> s p w0 x0 h; rewrite mulrC -ler_pdivl_mulr //; apply/lmaxP; first exact/symmetrical_part/symmetrical_inv.
move=> u; rewrite formBm form_scalar form_part subr_ge0; set z := C^T *m u; set y := invmx L *m z.
have Ly : L *m y = z by rewrite mulKVmx ?pd_unit.
have zy : form (invmx L) z z = dot z y by rewrite form_mul.
have fL : form L y y = dot z y by rewrite form_mul Ly dotC.
have cy v : form (C^T *m C) v v = dot (C *m v) (C *m v) by rewrite /form /dot trmx_mul !mulmxA.
have uy v : dot z v = dot u (C *m v) by rewrite /dot trmx_mul trmxK mulmxA.
have := h y; rewrite formBm !formZm fL cy subr_ge0 => hy.
(* [0 <= |w C y - x u|^2 = w^2 |Cy|^2 - 2 w x u'Cy + x^2 |u|^2]. *)
have := dot_ge0 (w *: (C *m y) - x *: u); rewrite -[dot _ _]mul1r -form_scalar.
rewrite formBr !formBl !formZl !formZr !form_scalar !mul1r [dot (C *m y) u]dotC -uy => sq.
rewrite zy mulrAC ler_pdivl_mulr // -(ler_pmul2r x0) -subr_ge0; apply: le_trans sq _.
have {}hy := ler_wpmul2l (ltW w0) hy; rewrite -subr_ge0 in hy; rewrite -subr_ge0; apply: le_trans hy _.
by rewrite le_eqVlt; apply/orP; left; apply/eqP; ring.
Qed.
End Part.

(** The whole state counts. *)
Lemma part_of1 (F : realFieldType) d (A : 'M[F]_d) : part_of 1%:M A = A.
Proof. by rewrite /part_of mul1mx trmx1 mulmx1. Qed.
