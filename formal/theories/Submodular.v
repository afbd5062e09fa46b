(** Log-det is submodular, over any ordered field with a logarithm: a semidefinite matrix is a sum of squares [c v v'], and
    the determinant takes them in one by one. *)
From mathcomp Require Import all_ssreflect all_algebra.
From mathcomp.algebra_tactics Require Import ring.
From Ratt Require Import Extrema Teams Guarantees Quadratic Criteria Logdet.
Set Implicit Arguments.
Unset Strict Implicit.
Unset Printing Implicit Defensive.
Import Order.Theory GRing.Theory Num.Theory.
Local Open Scope ring_scope.

Section Squares.
Variable F : realFieldType.

Lemma det_square n (A : 'M[F]_n) c v : A \in unitmx ->
  \det (A + c *: (v *m v^T)) = (1 + c * form (invmx A) v v) * \det A.
Proof.
move=> u; pose M := block_mx (1%:M : 'M_1) (- c *: v^T) v A.
have -> : \det (A + c *: (v *m v^T)) = \det M.
  have -> : M = block_mx 1%:M 0 v (A + c *: (v *m v^T)) *m block_mx 1%:M (- c *: v^T) 0 1%:M.
    rewrite mulmx_block !mulmx1 !mul1mx !mul0mx !mulmx0 !addr0; congr block_mx.
    by rewrite -scalemxAr scaleNr addrC addrK.
  by rewrite det_mulmx det_lblock det_ublock !det1 !mulr1 mul1r.
have -> : M = block_mx (1 + c * form (invmx A) v v)%:M (- c *: v^T) 0 A *m block_mx 1%:M 0 (invmx A *m v) 1%:M.
  rewrite mulmx_block !mulmx1 !mul0mx !mulmx0 !add0r; congr block_mx; last by rewrite mulKVmx.
  rewrite -scalemxAl mulmxA [v^T *m _ *m v]mx11_scalar -/(form _ _ _) scale_scalar_mx -raddfD /=.
  by congr _%:M; ring.
by rewrite det_mulmx det_ublock det_lblock !det1 !mulr1 det_scalar1.
Qed.

Section Lift.
Variable n : nat.
Implicit Types (X : 'M[F]_(1 + n)) (Y : 'M[F]_n).
Definition lift_mx Y : 'M[F]_(1 + n) := block_mx 0 0 0 Y.

Lemma corner_ge0 X : symmetrical X -> psd X -> 0 <= corner X.
Proof.
move=> s p; have := p (stack 1 0); rewrite form_stack // /dot /form !mulmx0 mxE !mulr0 !addr0 expr1n mulr1 //.
Qed.

Lemma side0 X : symmetrical X -> psd X -> corner X = 0 -> side X = 0.
Proof.
move=> s p c0; apply/eqP/negPn/negP => /dot_gt0 d0; set f := form (rest X) (side X) (side X).
have := p (stack (- (f + 1) / (2%:R * dot (side X) (side X))) (side X)); rewrite form_stack // c0 mul0r add0r -/f.
have -> : 2%:R * (- (f + 1) / (2%:R * dot (side X) (side X))) * dot (side X) (side X) + f = - 1.
  by field; rewrite gt_eqF.
by rewrite oppr_ge0 ler10.
Qed.

Lemma rest_psd X : symmetrical X -> psd X -> psd (rest X).
Proof. by move=> s p y; have := p (stack 0 y); rewrite form_stack // expr0n /= mulr0 mulr0 mul0r !add0r. Qed.

Lemma complement_psd X : symmetrical X -> psd X -> 0 < corner X -> psd (complement X).
Proof.
move=> s p c0 y; have := p (stack (- ((corner X)^-1 * dot (side X) y)) y); rewrite form_stack //.
rewrite /complement formBm formZm form_square; congr (_ <= _).
by field; rewrite gt_eqF.
Qed.

Lemma lift_square Y c u : lift_mx (Y + c *: (u *m u^T)) = lift_mx Y + c *: (stack 0 u *m (stack 0 u)^T).
Proof.
rewrite /lift_mx /stack tr_col_mx mul_col_row scale_block_mx add_block_mx raddf0 trmx0 !mul0mx mulmx0 !scaler0.
by rewrite !addr0.
Qed.

Lemma corner_square X : symmetrical X -> corner X != 0 ->
  X = lift_mx (complement X) +
    corner X *: (stack 1 ((corner X)^-1 *: side X) *m (stack 1 ((corner X)^-1 *: side X))^T).
Proof.
move=> s c0; rewrite {1}(blocks s) /lift_mx /stack tr_col_mx mul_col_row scale_block_mx add_block_mx tr_scalar_mx.
rewrite !add0r !mul1mx mulmx1 scale_scalar_mx mulr1 linearZ /= !scalerA divff // !scale1r; congr block_mx.
by rewrite -scalemxAl -scalemxAr !scalerA divff // mul1r /complement subrK.
Qed.
End Lift.

(** What holds for 0, and for a matrix with a square more, holds for all semidefinite matrices. *)
Lemma psd_ind n (P : 'M[F]_n -> Prop) : P 0 -> (forall X c (v : 'cV[F]_n), 0 <= c -> P X -> P (X + c *: (v *m v^T))) ->
  forall X, symmetrical X -> psd X -> P X.
Proof.
elim: n P => [|n IH] P P0 step X s p; first by rewrite (flatmx0 X) -(flatmx0 0).
have s' : symmetrical (X : 'M_(1 + n)) := s; have p' : psd (X : 'M_(1 + n)) := p.
have lifted (Y : 'M_n) : symmetrical Y -> psd Y -> P (lift_mx Y).
  apply: (IH (fun Y => P (lift_mx Y))) => [|{}Y c u c0 PY]; first by rewrite /lift_mx block_mx0.
  by rewrite lift_square; apply: step.
have [c0|c0] := eqVneq (corner (X : 'M_(1 + n))) 0.
  have e : (X : 'M_(1 + n)) = lift_mx (rest (X : 'M_(1 + n))).
    by rewrite [LHS](blocks s') c0 (side0 s' p' c0) trmx0 raddf0.
  by rewrite -[X]/(X : 'M_(1 + n)) e; apply: lifted; [apply: rest_symmetrical | apply: rest_psd].
have c1 : 0 < corner (X : 'M_(1 + n)) by rewrite lt_def c0 corner_ge0.
rewrite -[X]/(X : 'M_(1 + n)) (corner_square s' c0); apply: step; first exact: ltW.
by apply: lifted; [apply: complement_symmetrical | apply: complement_psd].
Qed.

Lemma square_symmetrical n c (v : 'cV[F]_n) : symmetrical (c *: (v *m v^T)).
Proof. by rewrite /symmetrical linearZ /= trmx_mul trmxK. Qed.
Lemma square_psd n c (v : 'cV[F]_n) : 0 <= c -> psd (c *: (v *m v^T)).
Proof. by move=> c0 y; rewrite formZm form_square mulr_ge0 ?sqr_ge0. Qed.

(** Beside a larger matrix the determinant grows by no larger a factor. *)
Lemma det_gains_diminish n (A B X : 'M[F]_n) : symmetrical A -> symmetrical B -> pd A -> psd (B - A) ->
  symmetrical X -> psd X -> \det (B + X) * \det A <= \det (A + X) * \det B.
Proof.
move=> sA sB pA AB sX pX; have pB := pd_above pA AB.
suff [_ []] : symmetrical X /\ psd X /\ \det (B + X) * \det A <= \det (A + X) * \det B by [].
move: X sX pX; apply: psd_ind => [|X c v c0 [sX [pX IH]]].
  by split; [exact: trmx0 | split; [exact: psd0 | rewrite !addr0 mulrC]].
have sS (M : 'M[F]_n) : symmetrical M -> symmetrical (M + X) by move=> sM; rewrite /symmetrical linearD /= sM sX.
have sXs : symmetrical (X + c *: (v *m v^T)).
  by rewrite /symmetrical linearD /= sX (square_symmetrical c v).
split=> //; split; first by apply: psdD => //; apply: square_psd.
have pAX := pd_add pA pX; have pBX := pd_add pB pX.
rewrite !addrA !det_square ?pd_unit // -!mulrA.
have inv0 : 0 <= 1 + c * form (invmx (A + X)) v v.
  by apply: addr_ge0 => //; apply: mulr_ge0 => //; apply: (pd_psd (pd_inv _ pAX)); apply: sS.
apply: le_trans (_ : (1 + c * form (invmx (A + X)) v v) * (\det (B + X) * \det A) <= _); last exact: ler_wpmul2l.
apply: ler_wpmul2r; first by apply: mulr_ge0; apply/ltW/det_gt0 => //; apply: sS.
rewrite ler_add2l; apply: ler_wpmul2l => //; rewrite -subr_ge0 -formBm.
by apply: inverse_antitone; [exact: sS | exact: sS | | rewrite opprD addrACA subrr addr0].
Qed.
End Squares.


Section Gains.
Variables (F : realFieldType) (ln : F -> F).
Hypothesis lnP : logarithm ln.

Lemma logdet_gains_diminish n (A B X : 'M[F]_n) : symmetrical A -> symmetrical B -> pd A -> psd (B - A) ->
  symmetrical X -> psd X -> ln (\det (B + X)) - ln (\det B) <= ln (\det (A + X)) - ln (\det A).
Proof.
move=> sA sB pA AB sX pX; have pB := pd_above pA AB.
have D0 (M : 'M[F]_n) : symmetrical M -> pd M -> 0 < \det M /\ 0 < \det (M + X).
  by move=> sM pM; split; apply: det_gt0 => //; [rewrite /symmetrical linearD /= sM sX | apply: pd_add].
have [a0 ax0] := D0 _ sA pA; have [b0 bx0] := D0 _ sB pB.
rewrite ler_subl_addr addrAC ler_subr_addr -!(lnM lnP) //; apply: (ln_le lnP); first exact: mulr_gt0.
exact: det_gains_diminish.
Qed.

(** Several together gain no more than each alone. *)
Lemma logdet_sum_gains n (I : eqType) (s : seq I) (A : 'M[F]_n) (X : I -> 'M[F]_n) : symmetrical A -> pd A ->
  (forall i, i \in s -> symmetrical (X i) /\ psd (X i)) ->
  ln (\det (A + \sum_(i <- s) X i)) <= ln (\det A) + \sum_(i <- s) (ln (\det (A + X i)) - ln (\det A)).
Proof.
move=> sA pA; elim: s => [|i s IH] h; first by rewrite !big_nil !addr0.
have [sXi pXi] := h i (mem_head _ _).
have hs k : k \in s -> symmetrical (X k) /\ psd (X k) by move=> ks; apply: h; rewrite in_cons ks orbT.
have sS : symmetrical (\sum_(k <- s) X k).
  by rewrite big_seq; apply: symmetrical_sum => k /hs[].
have pS : psd (\sum_(k <- s) X k) by rewrite big_seq; apply: psd_sum => k /hs[].
have sB : symmetrical (A + \sum_(k <- s) X k) by rewrite /symmetrical linearD /= sA sS.
rewrite !big_cons [X i + _]addrC addrA [X in _ <= X]addrCA -ler_subl_addr.
apply: le_trans (ler_sub (lexx _) (IH hs)) _.
by apply: logdet_gains_diminish => //; rewrite addrAC subrr add0r.
Qed.

(** ** The criterion *)
Variables (d : nat) (T R E : finType) (t : team R E).
Variables (prior : T -> 'M[F]_d) (info : E -> T -> 'M[F]_d) (weight : T -> F).
Hypothesis prior_good : forall j, symmetrical (prior j) /\ pd (prior j).
Hypothesis weight_ge0 : forall j, 0 <= weight j.
Hypothesis info_good : forall e j, symmetrical (info e j) /\ psd (info e j).

Lemma posterior_add (S : {set E}) x j : x \notin S ->
  posterior prior info (x |: S) j = posterior prior info S j + info x j.
Proof. by move=> xS; rewrite /posterior big_setU1 //= [info x j + _]addrC addrA. Qed.

Theorem logdet_value_submodular : submodular t (logdet_value ln prior info weight).
Proof.
move=> x A B _ xB AB; have xA : x \notin A by apply: contra xB => /(subsetP AB).
have gain (S : {set E}) : x \notin S -> marginal (logdet_value ln prior info weight) x S = \sum_j weight j *
    (ln (\det (posterior prior info S j + info x j)) - ln (\det (posterior prior info S j))).
  move=> xS; rewrite /marginal /logdet_value /logdet_penalty opprB addrC addrA subrK -sumrB; apply: eq_bigr => j _.
  by rewrite posterior_add // -mulrBr opprK addrC.
rewrite !gain //; apply: ler_sum => j _; apply: ler_wpmul2l => //; have [sX pX] := info_good x j.
have [sA pA] := posterior_good prior_good info_good A j; have [sB _] := posterior_good prior_good info_good B j.
by apply: logdet_gains_diminish => //; apply: (posterior_mono prior info_good).
Qed.
End Gains.
