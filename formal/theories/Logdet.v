(** Log-determinants over an ordered field with a logarithm: the Fenchel bound, monotonicity, concavity, the criterion.
    No eigenvalues, no roots: induction over the size, by Schur complements. *)
From mathcomp Require Import all_ssreflect all_algebra.
From mathcomp.algebra_tactics Require Import ring.
From Ratt Require Import Extrema Teams Guarantees Quadratic Criteria.
Set Implicit Arguments.
Unset Strict Implicit.
Unset Printing Implicit Defensive.
Import Order.Theory GRing.Theory Num.Theory.
Local Open Scope ring_scope.

Section Blocks.
Variables (F : realFieldType) (n : nat).
Implicit Types (M B : 'M[F]_(1 + n)) (x : F) (y : 'cV[F]_n).

Definition corner M : F := ulsubmx M 0 0.
Definition side M : 'cV[F]_n := dlsubmx M.
Definition rest M : 'M[F]_n := drsubmx M.
Definition complement M : 'M[F]_n := rest M - (corner M)^-1 *: (side M *m (side M)^T).
Definition stack x y : 'cV[F]_(1 + n) := col_mx x%:M y.

Lemma blocks M : symmetrical M -> M = block_mx (corner M)%:M (side M)^T (side M) (rest M).
Proof.
move=> s; rewrite -[LHS]submxK /corner -mx11_scalar; congr block_mx.
by rewrite /side trmx_dlsub s.
Qed.

Lemma form_stack M x y : symmetrical M ->
  form M (stack x y) (stack x y) = corner M * x ^+ 2 + 2%:R * x * dot (side M) y + form (rest M) y y.
Proof.
move=> s; rewrite {1}(blocks s) /form /stack tr_col_mx mul_row_block mul_row_col tr_scalar_mx.
rewrite !mulmxDl -scalar_mxM -scalar_mxM mul_mx_scalar !mul_scalar_mx -scalemxAl.
have e : (y^T *m side M) 0 0 = dot (side M) y by rewrite dotC.
have e2 : \sum_j ((side M)^T) 0 j * y j 0 = dot (side M) y by rewrite /dot mxE.
have e3 : \sum_j (y^T *m rest M) 0 j * y j 0 = form (rest M) y y by rewrite /form mxE.
rewrite !mxE eqxx mulr1n; move: e; rewrite mxE => ->; rewrite e2 e3; ring.
Qed.

Lemma stack_neq0 x y : (x != 0) || (y != 0) -> stack x y != 0.
Proof.
apply: contraTneq => /(congr1 (fun v : 'cV[F]_(1 + n) => (usubmx v, dsubmx v))).
rewrite /stack col_mxKu col_mxKd !linear0 => -[/matrixP/(_ 0 0) h ->].
by move: h; rewrite !mxE eqxx mulr1n => ->; rewrite !eqxx.
Qed.

Lemma form_square (b y : 'cV[F]_n) : form (b *m b^T) y y = dot b y ^+ 2.
Proof.
rewrite /form mulmxA -mulmxA mxE big_ord1 -/(dot _ _) expr2; congr (_ * _).
by rewrite dotC.
Qed.

Section Definite.
Variable M : 'M[F]_(1 + n).
Hypotheses (s : symmetrical M) (p : pd M).

Lemma rest_symmetrical : symmetrical (rest M).
Proof. by rewrite /symmetrical /rest trmx_drsub s. Qed.
Lemma complement_symmetrical : symmetrical (complement M).
Proof. by rewrite /symmetrical /complement linearB linearZ /= trmx_mul trmxK rest_symmetrical. Qed.
Lemma corner_gt0 : 0 < corner M.
Proof.
have := p (@stack_neq0 1 0 _); rewrite oner_eq0 => /(_ isT).
by rewrite form_stack // /dot /form !mulmx0 mxE !mulr0 !addr0 expr1n mulr1.
Qed.
Lemma rest_pd : pd (rest M).
Proof.
move=> y y0; have := p (@stack_neq0 0 y _); rewrite y0 orbT => /(_ isT).
by rewrite form_stack // expr0n /= mulr0 mulr0 mul0r !add0r.
Qed.
Lemma complement_pd : pd (complement M).
Proof.
move=> y y0; have := p (@stack_neq0 (- ((corner M)^-1 * dot (side M) y)) y _); rewrite y0 orbT => /(_ isT).
rewrite form_stack // /complement formBm formZm form_square; congr (_ < _).
by field; rewrite gt_eqF // corner_gt0.
Qed.
(** What is left of the corner beside the rest. *)
Definition corner_left : F := corner M - form (invmx (rest M)) (side M) (side M).
Lemma corner_left_gt0 : 0 < corner_left.
Proof.
have := p (@stack_neq0 1 (- (invmx (rest M) *m side M)) _); rewrite oner_eq0 => /(_ isT).
rewrite form_stack // expr1n !mulr1 /corner_left; congr (_ < _).
have u := pd_unit rest_pd.
have -> : form (rest M) (- (invmx (rest M) *m side M)) (- (invmx (rest M) *m side M)) =
    form (invmx (rest M)) (side M) (side M).
  rewrite -scaleN1r formZl formZr mulrA mulrNN !mul1r form_mul mulKVmx // dotC -form_mul //.
by rewrite -scaleN1r dotZr -form_mul; ring.
Qed.

Lemma det_complement : \det M = corner M * \det (complement M).
Proof.
have c0 : corner M != 0 by rewrite gt_eqF // corner_gt0.
rewrite {1}(blocks s); have -> : block_mx (corner M)%:M (side M)^T (side M) (rest M) =
    block_mx (corner M)%:M 0 (side M) (complement M) *m block_mx 1%:M ((corner M)^-1 *: (side M)^T) 0 1%:M.
  rewrite mulmx_block !mulmx1 !mul0mx !mulmx0 !addr0 mul_scalar_mx scalerA divff // scale1r; congr block_mx.
  by rewrite -scalemxAr addrC subrK.
by rewrite det_mulmx det_lblock det_ublock !det1 !mulr1 det_scalar1.
Qed.

Lemma det_rest : \det M = corner_left * \det (rest M).
Proof.
have u := pd_unit rest_pd; rewrite {1}(blocks s).
have -> : block_mx (corner M)%:M (side M)^T (side M) (rest M) =
    block_mx corner_left%:M (side M)^T 0 (rest M) *m block_mx 1%:M 0 (invmx (rest M) *m side M) 1%:M.
  rewrite mulmx_block !mulmx1 !mul0mx !mulmx0 !add0r; congr block_mx; last by rewrite mulKVmx.
  rewrite /corner_left mulmxA [X in _ = _ + X]mx11_scalar -/(form _ _ _).
  by rewrite -raddfD /= subrK.
by rewrite det_mulmx det_lblock det_ublock !det1 !mulr1 det_scalar1.
Qed.
End Definite.

Lemma trace_blocks M B : symmetrical M -> symmetrical B ->
  \tr (M *m B) = corner M * corner B + 2%:R * dot (side M) (side B) + \tr (rest M *m rest B).
Proof.
move=> s r; rewrite {1}(blocks s) {1}(blocks r) mulmx_block mxtrace_block !linearD /=.
rewrite -scalar_mxM mxtrace_scalar mulr1n [X in _ + (X + _)]mxtrace_mulC.
have e (b c : 'cV[F]_n) : \tr (b^T *m c) = dot b c by rewrite /mxtrace big_ord1.
by rewrite !e [dot (side B) _]dotC; ring.
Qed.

Lemma trace_complement B (S : 'M[F]_n) :
  \tr (S *m rest B) = \tr (S *m complement B) + (corner B)^-1 * form S (side B) (side B).
Proof.
rewrite /complement mulmxBr linearB /= -scalemxAr linearZ /= mulmxA [X in _ - _ * X]mxtrace_mulC mulmxA.
by rewrite /mxtrace big_ord1 -/(form _ _ _) subrK.
Qed.
End Blocks.

Lemma pd_inv (F : realFieldType) n (A : 'M[F]_n) : symmetrical A -> pd A -> pd (invmx A).
Proof.
move=> s p v v0; have u := pd_unit p.
have -> : form (invmx A) v v = form A (invmx A *m v) (invmx A *m v).
  by rewrite [RHS]form_mul mulKVmx // dotC -form_mul.
by apply: p; apply: contra v0 => /eqP h; rewrite -(mulKVmx u v) h mulmx0.
Qed.

Lemma det_gt0 (F : realFieldType) n (A : 'M[F]_n) : symmetrical A -> pd A -> 0 < \det A.
Proof.
elim: n A => [|n IH] A s p; first by rewrite det_mx00 ltr01.
have s' : symmetrical (A : 'M_(1 + n)) := s; rewrite (det_complement s') // mulr_gt0 //; first exact: corner_gt0.
by apply: IH; [apply: complement_symmetrical | apply: complement_pd].
Qed.

(** The trace of a product of semidefinite matrices, one of them definite, is not negative. *)
Lemma trace_product_ge0 (F : realFieldType) n (A B : 'M[F]_n) : symmetrical A -> pd A -> symmetrical B -> psd B ->
  0 <= \tr (A *m B).
Proof.
elim: n A B => [|n IH] A B s p r q; first by rewrite /mxtrace big_ord0.
have s' : symmetrical (A : 'M_(1 + n)) := s; have r' : symmetrical (B : 'M_(1 + n)) := r.
have p' : pd (A : 'M_(1 + n)) := p; have q' : psd (B : 'M_(1 + n)) := q.
have c0 := corner_gt0 s' p'; rewrite -[A]/(A : 'M_(1 + n)) (trace_blocks s' r') [X in _ + X]mxtrace_mulC trace_complement.
have h1 : 0 <= form (B : 'M_(1 + n)) (stack (corner A) (side (A : 'M_(1 + n)))) (stack (corner A) (side (A : 'M_(1 + n)))).
  exact: q'.
rewrite form_stack // in h1.
have h2 : 0 <= \tr (complement (A : 'M_(1 + n)) *m rest (B : 'M_(1 + n))).
  apply: IH; [exact: complement_symmetrical | exact: complement_pd | exact: rest_symmetrical |].
  move=> y; have := q' (stack 0 y); rewrite form_stack // expr0n /= mulr0 mulr0 mul0r !add0r //.
rewrite mxtrace_mulC in h2; rewrite -(pmulr_rge0 _ c0).
apply: le_trans (addr_ge0 h1 (mulr_ge0 (ltW c0) h2)) _; rewrite le_eqVlt; apply/orP; left; apply/eqP.
by rewrite [dot (side B) _]dotC; field; rewrite gt_eqF.
Qed.

Section Logarithm.
Variables (F : realFieldType) (ln : F -> F).

(** What is asked of a logarithm: products become sums, and it lies below its tangent at 1. Over the real numbers that is
    the natural logarithm and nothing else. *)
Definition logarithm : Prop :=
  (forall x y, 0 < x -> 0 < y -> ln (x * y) = ln x + ln y) /\ (forall x, 0 < x -> ln x <= x - 1).
Hypothesis lnP : logarithm.

Lemma lnM x y : 0 < x -> 0 < y -> ln (x * y) = ln x + ln y. Proof. exact: (proj1 lnP). Qed.
Lemma ln_tangent x : 0 < x -> ln x <= x - 1. Proof. exact: (proj2 lnP). Qed.
Lemma ln1 : ln 1 = 0.
Proof. by apply: (addrI (ln 1)); rewrite -lnM ?ltr01 // mulr1 addr0. Qed.
Lemma lnV x : 0 < x -> ln x^-1 = - ln x.
Proof. by move=> x0; apply: (addrI (ln x)); rewrite -lnM ?invr_gt0 // divff ?gt_eqF // ln1 subrr. Qed.
Lemma ln_le x y : 0 < x -> x <= y -> ln x <= ln y.
Proof.
move=> x0 xy; have y0 := lt_le_trans x0 xy; rewrite -subr_le0 -lnV // -lnM ?invr_gt0 //.
apply: le_trans (ln_tangent (divr_gt0 x0 y0)) _.
by rewrite subr_le0 ler_pdivr_mulr // mul1r.
Qed.

(** [ln det L + ln det Y <= tr (Y L) - d]. *)
Theorem logdet_fenchel n (L Y : 'M[F]_n) : symmetrical L -> pd L -> symmetrical Y -> pd Y ->
  ln (\det L) + ln (\det Y) <= \tr (Y *m L) - n%:R.
Proof.
elim: n L Y => [|n IH] L Y sL pL sY pY; first by rewrite !det_mx00 ln1 /mxtrace big_ord0 addr0 subrr.
have sL' : symmetrical (L : 'M_(1 + n)) := sL; have sY' : symmetrical (Y : 'M_(1 + n)) := sY.
have pL' : pd (L : 'M_(1 + n)) := pL; have pY' : pd (Y : 'M_(1 + n)) := pY.
have c0 := corner_gt0 sL' pL'; have l0 := corner_left_gt0 sY' pY'.
have sS := complement_symmetrical sL'; have pS := complement_pd sL' pL'.
have sR := rest_symmetrical sY'; have pR := rest_pd sY' pY'.
rewrite (det_complement sL' pL') (det_rest sY' pY') !lnM ?det_gt0 //.
have h1 := IH _ _ sS pS sR pR; have h2 := ln_tangent (mulr_gt0 c0 l0); rewrite lnM // in h2.
rewrite -[\tr _]/(\tr ((Y : 'M_(1 + n)) *m (L : 'M_(1 + n)))) (trace_blocks sY' sL') trace_complement.
have := tangent (side (Y : 'M_(1 + n))) (- (corner (L : 'M_(1 + n)))^-1 *: side (L : 'M_(1 + n))) sR pR.
rewrite dotZr formZl formZr => h3; have {h3} := ler_wpmul2l (ltW c0) h3.
move: h1 h2; rewrite /corner_left.
set a := corner _; set b := dot _ _; set f := form (rest _) _ _; set e := form (invmx _) _ _; set p := corner _.
set tr := \tr _; move=> h1 h2 h3; have ea : a * (2%:R * (- a^-1 * b) - - a^-1 * (- a^-1 * f)) = - (2%:R * b) - a^-1 * f.
  by field; rewrite gt_eqF.
rewrite ea in h3; rewrite addrACA; apply: le_trans (ler_add h2 h1) _.
rewrite -subr_ge0 [n.+1%:R]mulrS; have -> : p * a + 2%:R * b + (tr + a^-1 * f) - (1 + n%:R) - (a * (p - e) - 1 + (tr - n%:R)) =
    a * e - (- (2%:R * b) - a^-1 * f) by ring.
by rewrite subr_ge0.
Qed.


(** It is attained at [Y = L^-1]. *)
Lemma logdet_fenchel_tight n (L : 'M[F]_n) : symmetrical L -> pd L ->
  ln (\det L) + ln (\det (invmx L)) = \tr (invmx L *m L) - n%:R.
Proof. by move=> s p; rewrite mulVmx ?pd_unit // mxtrace1 det_inv lnV ?det_gt0 // !subrr. Qed.

Lemma logdet_mono n (A B : 'M[F]_n) : symmetrical A -> symmetrical B -> pd A -> psd (B - A) ->
  ln (\det A) <= ln (\det B).
Proof.
move=> sA sB pA AB; have pB := pd_above pA AB.
have := logdet_fenchel sA pA (symmetrical_inv sB) (pd_inv sB pB).
rewrite det_inv lnV ?det_gt0 // => h; rewrite -subr_le0; apply: le_trans h _.
have : 0 <= \tr (invmx B *m (B - A)).
  apply: trace_product_ge0 => //; [exact: symmetrical_inv | exact: pd_inv |].
  by rewrite /symmetrical linearB /= sA sB.
by rewrite mulmxBr linearB /= mulVmx ?pd_unit // mxtrace1 subr_ge0 subr_le0.
Qed.

Lemma logdet_concave n (I : eqType) (s : seq I) (A : I -> 'M[F]_n) : s != [::] ->
  (forall i, i \in s -> symmetrical (A i) /\ pd (A i)) ->
  \sum_(i <- s) ln (\det (A i)) / (size s)%:R <= ln (\det ((size s)%:R^-1 *: \sum_(i <- s) A i)).
Proof.
move=> s0 h; set M := _ *: _; have r0 : 0 < (size s)%:R :> F by rewrite ltr0n lt0n size_eq0.
have sM : symmetrical M by apply: average_symmetrical => i /h[].
have pM : pd M by apply: average_pd => // i /h[].
rewrite -mulr_suml ler_pdivr_mulr //; apply: le_trans (_ : \sum_(i <- s) (\tr (invmx M *m A i) - n%:R + ln (\det M)) <= _).
  rewrite big_seq [X in _ <= X]big_seq; apply: ler_sum => i /h[si pi].
  have := logdet_fenchel si pi (symmetrical_inv sM) (pd_inv sM pM).
  by rewrite det_inv lnV ?det_gt0 // ler_subl_addr.
rewrite big_split sumrB /= -raddf_sum -mulmx_sumr.
have -> : \sum_(i <- s) A i = (size s)%:R *: M by rewrite scalerA mulfV ?gt_eqF // scale1r.
rewrite -scalemxAr /= linearZ /= mulVmx; last exact: pd_unit.
rewrite mxtrace1 !big_const_seq count_predT !iter_addr_0.
by rewrite mulr_natl subrr add0r mulr_natr.
Qed.

(** ** The criterion *)
Section Criterion.
Variables (d : nat) (T E : finType).
Variables (prior : T -> 'M[F]_d) (info : E -> T -> 'M[F]_d) (weight : T -> F).
Local Notation posterior := (posterior prior info).

Definition logdet_penalty (L : T -> 'M[F]_d) : F := \sum_j weight j * - ln (\det (L j)).
Definition logdet_base : F := \sum_j weight j * ln (\det (prior j)).
(** [phi(S) = sum_j w_j (ln det P_j + ln det L_j(S))]. *)
Definition logdet_value (S : {set E}) : F := logdet_base - logdet_penalty (posterior S).

Hypothesis prior_good : forall j, symmetrical (prior j) /\ pd (prior j).

Lemma logdet_value0 : logdet_value set0 = 0.
Proof.
rewrite /logdet_value /logdet_penalty /logdet_base -sumrB big1 // => j _.
have [s p] := prior_good j.
by rewrite /posterior big_set0 addr0 det_inv lnV ?det_gt0 // opprK subrr.
Qed.

Hypothesis weight_ge0 : forall j, 0 <= weight j.

Lemma logdet_penalty_antitone (A B : T -> 'M[F]_d) : good A -> (forall j, symmetrical (B j)) ->
  (forall j, psd (B j - A j)) -> logdet_penalty B <= logdet_penalty A.
Proof.
move=> gA sB AB; apply: ler_sum => j _; apply: ler_wpmul2l => //; rewrite ler_opp2; have [sA pA] := gA j.
exact: logdet_mono.
Qed.

Lemma logdet_penalty_convex (I : eqType) (s : seq I) (A : I -> T -> 'M[F]_d) : s != [::] ->
  (forall i, i \in s -> good (A i)) ->
  logdet_penalty (fun j => (size s)%:R^-1 *: \sum_(i <- s) A i j) <= (size s)%:R^-1 * \sum_(i <- s) logdet_penalty (A i).
Proof.
move=> s0 h; rewrite /logdet_penalty exchange_big mulr_sumr; apply: ler_sum => j _ /=.
rewrite -mulr_sumr mulrCA; apply: ler_wpmul2l => //; rewrite sumrN mulrN ler_opp2 mulrC mulr_suml.
by apply: logdet_concave => // i /h; apply.
Qed.

Hypothesis info_good : forall e j, symmetrical (info e j) /\ psd (info e j).

Theorem logdet_value_mono (S S' : {set E}) : S \subset S' -> logdet_value S <= logdet_value S'.
Proof.
move=> sub; rewrite ler_sub //; apply: logdet_penalty_antitone.
- exact: posterior_good.
- by move=> j; apply: posterior_symmetrical.
by move=> j; apply: posterior_mono.
Qed.
End Criterion.
End Logarithm.
