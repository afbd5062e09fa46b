(** The trace and the largest-eigenvalue criterion over an ordered field, of states or of a part of each: normalised,
    non-decreasing, and how their penalties behave. *)
From mathcomp Require Import all_ssreflect all_algebra.
From mathcomp.algebra_tactics Require Import ring.
From Ratt Require Import Extrema Teams Guarantees Quadratic.
Set Implicit Arguments.
Unset Strict Implicit.
Unset Printing Implicit Defensive.
Import Order.Theory GRing.Theory Num.Theory.
Local Open Scope ring_scope.

Section Largest.
Variables (F : realDomainType) (T : finType).
(** The largest of a family; [0] for an empty one. *)
Definition largest (f : T -> F) : F :=
  if [pick j : T] is Some j0 then \big[Num.max/f j0]_(j <- enum T) f j else 0.

Lemma le_largest f j : f j <= largest f.
Proof.
rewrite /largest; case: pickP => [j0 _|/(_ j)//].
by apply: (@le_bigmax F _ (enum T) xpredT f); rewrite ?mem_enum.
Qed.

Lemma largest_le f x : T -> (forall j, f j <= x) -> largest f <= x.
Proof.
move=> j1 h; rewrite /largest; case: pickP => [j0 _|/(_ j1)//].
by apply: bigmax_le.
Qed.

Lemma eq_largest f g : f =1 g -> largest f = largest g.
Proof. by move=> h; rewrite /largest; case: pickP => // j _; rewrite h; apply: eq_bigr => i _. Qed.
End Largest.

Section Convex.
Variables (F : realFieldType) (d : nat) (I : eqType).

(** The inverse is convex in the Loewner order: here for the plain average of a list. *)
Lemma inverse_convex (s : seq I) (A : I -> 'M[F]_d) v : s != [::] ->
  (forall i, i \in s -> symmetrical (A i) /\ pd (A i)) ->
  form (invmx ((size s)%:R^-1 *: \sum_(i <- s) A i)) v v <= (size s)%:R^-1 * \sum_(i <- s) form (invmx (A i)) v v.
Proof.
move=> s0 h; set r := (size s)%:R : F; set M := r^-1 *: _.
have r0 : 0 < r by rewrite ltr0n lt0n size_eq0.
have pS : pd (\sum_(i <- s) A i).
  case: s s0 h {r M r0} => [//|i s] _ h; rewrite big_cons.
  apply: pd_add; first by case: (h i (mem_head _ _)).
  rewrite big_seq; apply: psd_sum => j js; apply: pd_psd; by case: (h j); rewrite // in_cons js orbT.
have pM : pd M by move=> y y0; rewrite formZm pmulr_rgt0 ?invr_gt0 // pS.
rewrite ler_pdivl_mull //; set y := invmx M *m v.
have My : M *m y = v by rewrite mulKVmx ?pd_unit.
have fM : form M y y = dot v y by rewrite form_mul My dotC.
rewrite form_mul -/y; apply: le_trans (_ : \sum_(i <- s) (2%:R * dot v y - form (A i) y y) <= _); last first.
  rewrite big_seq [X in _ <= X]big_seq; apply: ler_sum => i /h[si pi]; exact: tangent.
rewrite sumrB -form_sum (_ : \sum_(i <- s) A i = r *: M); last by rewrite scalerA mulfV ?gt_eqF // scale1r.
rewrite formZm fM big_const_seq count_predT iter_addr_0 -mulr_natr -/r.
by rewrite le_eqVlt; apply/orP; left; apply/eqP; ring.
Qed.

Lemma average_pd (s : seq I) (A : I -> 'M[F]_d) : s != [::] -> (forall i, i \in s -> pd (A i)) ->
  pd ((size s)%:R^-1 *: \sum_(i <- s) A i).
Proof.
move=> s0 h y y0; rewrite formZm pmulr_rgt0 ?invr_gt0 ?ltr0n ?lt0n ?size_eq0 //.
case: s s0 h => [//|i s] _ h; rewrite big_cons; apply: pd_add y0; first exact/h/mem_head.
by rewrite big_seq; apply: psd_sum => j js; apply/pd_psd/h; rewrite in_cons js orbT.
Qed.

Lemma average_symmetrical (s : seq I) (A : I -> 'M[F]_d) x : (forall i, i \in s -> symmetrical (A i)) ->
  symmetrical (x *: \sum_(i <- s) A i).
Proof.
move=> h; rewrite /symmetrical linearZ /=; congr (_ *: _); elim: s h => [|i s IH] h; first by rewrite big_nil trmx0.
by rewrite big_cons linearD /= (h i (mem_head _ _)) IH // => j js; apply: h; rewrite in_cons js orbT.
Qed.
End Convex.

Section Criteria.
Variables (F : realFieldType) (d : nat) (T E : finType).
Variables (prior : T -> 'M[F]_d) (info : E -> T -> 'M[F]_d) (weight : T -> F).
(** What counts of target [j] is [C_j x_j]; where all of the state does, [C_j] is the identity. *)
Variables (rows : T -> nat) (output : forall j, 'M[F]_(rows j, d)).

(** Information about target [j] after the measurements of a set of elements. *)
Definition posterior (S : {set E}) (j : T) : 'M[F]_d := invmx (prior j) + \sum_(e in S) info e j.

(** The covariance [C_j A C_j'] of what counts, where that of the state is [A]. *)
Definition counting (j : T) (A : 'M[F]_d) : 'M[F]_(rows j) := part_of (output j) A.

Definition trace_penalty (L : T -> 'M[F]_d) : F := \sum_j weight j * \tr (counting j (invmx (L j))).
Definition trace_base : F := \sum_j weight j * \tr (counting j (prior j)).
(** [phi(S) = sum_j w_j (tr C_j P_j C_j' - tr C_j L_j(S)^-1 C_j')]. *)
Definition trace_value (S : {set E}) : F := trace_base - trace_penalty (posterior S).

Variable lmax : forall n, 'M[F]_n -> F.
Definition maxeig_penalty (L : T -> 'M[F]_d) : F := largest (fun j => weight j * lmax (counting j (invmx (L j)))).
Definition maxeig_base : F := largest (fun j => weight j * lmax (counting j (prior j))).
(** [phi(S) = max_j w_j lambda_max(C_j P_j C_j') - max_j w_j lambda_max(C_j L_j(S)^-1 C_j')]. *)
Definition maxeig_value (S : {set E}) : F := maxeig_base - maxeig_penalty (posterior S).

Hypothesis weight_ge0 : forall j, 0 <= weight j.
Implicit Types A B : T -> 'M[F]_d.

Lemma posterior0 j : invmx (posterior set0 j) = prior j.
Proof. by rewrite /posterior big_set0 addr0 invmxK. Qed.

Lemma trace_value0 : trace_value set0 = 0.
Proof.
by rewrite /trace_value /trace_penalty /trace_base -sumrB big1 // => j _; rewrite posterior0 subrr.
Qed.

Lemma maxeig_value0 : maxeig_value set0 = 0.
Proof.
rewrite /maxeig_value /maxeig_penalty /maxeig_base /largest; case: pickP => [j _|_]; last by rewrite subrr.
by apply/eqP; rewrite posterior0 subr_eq0; apply/eqP; apply: eq_bigr => i _; rewrite posterior0.
Qed.

Definition good A : Prop := forall j, symmetrical (A j) /\ pd (A j).

Lemma trace_penalty_antitone A B : good A -> (forall j, symmetrical (B j)) -> (forall j, psd (B j - A j)) ->
  trace_penalty B <= trace_penalty A.
Proof.
move=> gA sB AB; apply: ler_sum => j _; apply: ler_wpmul2l => //; have [sA pA] := gA j.
exact: trace_inverse_antitone.
Qed.

Lemma trace_penalty_convex (I : eqType) (s : seq I) (A : I -> T -> 'M[F]_d) : s != [::] ->
  (forall i, i \in s -> good (A i)) ->
  trace_penalty (fun j => (size s)%:R^-1 *: \sum_(i <- s) A i j) <= (size s)%:R^-1 * \sum_(i <- s) trace_penalty (A i).
Proof.
move=> s0 h; rewrite /trace_penalty exchange_big mulr_sumr; apply: ler_sum => j _ /=.
rewrite -mulr_sumr mulrCA; apply: ler_wpmul2l => //; rewrite trace_form.
rewrite (eq_bigr (fun i => \sum_k form (counting j (invmx (A i j))) (delta_mx k 0) (delta_mx k 0))); last by move=> i _; rewrite trace_form.
rewrite exchange_big mulr_sumr; apply: ler_sum => k _; rewrite form_part.
under [X in _ * X]eq_bigr do rewrite form_part.
by apply: inverse_convex => // i /h; exact.
Qed.

Hypothesis lmaxP : forall j, largest_eigenvalue (@lmax (rows j)).

Lemma maxeig_penalty_antitone (j0 : T) A B : good A -> (forall j, symmetrical (B j)) -> (forall j, psd (B j - A j)) ->
  maxeig_penalty B <= maxeig_penalty A.
Proof.
move=> gA sB AB; apply: largest_le => // j; have [sA pA] := gA j.
apply: le_trans (le_largest (fun j => weight j * lmax (counting j (invmx (A j)))) j).
by apply: ler_wpmul2l => //; apply: largest_eigenvalue_antitone.
Qed.

Lemma maxeig_penalty_convex (j0 : T) (I : eqType) (s : seq I) (A : I -> T -> 'M[F]_d) : s != [::] ->
  (forall i, i \in s -> good (A i)) ->
  maxeig_penalty (fun j => (size s)%:R^-1 *: \sum_(i <- s) A i j) <= (size s)%:R^-1 * \sum_(i <- s) maxeig_penalty (A i).
Proof.
move=> s0 h; apply: largest_le => // j; set r := (size s)%:R^-1.
have r0 : 0 <= r by rewrite invr_ge0 ler0n.
apply: le_trans (_ : weight j * (r * \sum_(i <- s) lmax (counting j (invmx (A i j)))) <= _).
  apply: ler_wpmul2l => //; apply/lmaxP.
    by apply/symmetrical_part/symmetrical_inv/average_symmetrical => i /h/(_ j)[].
  move=> v; rewrite formBm form_scalar subr_ge0 form_part; apply: le_trans (inverse_convex _ s0 _) _.
    by move=> i /h; apply.
  rewrite -/r -mulrA; apply: ler_wpmul2l => //; rewrite mulr_suml big_seq [X in _ <= X]big_seq.
  by apply: ler_sum => i /h/(_ j)[si _]; apply/le_largest_eigenvalue/symmetrical_inv.
rewrite mulrCA; apply: ler_wpmul2l => //; rewrite mulr_sumr; apply: ler_sum => i _.
exact: (le_largest (fun j => weight j * lmax (counting j (invmx (A i j))))).
Qed.

(** ** Both criteria are normalised and non-decreasing *)
Hypothesis prior_good : forall j, symmetrical (prior j) /\ pd (prior j).
Hypothesis info_good : forall e j, symmetrical (info e j) /\ psd (info e j).

Lemma prior_inverse_pd j : pd (invmx (prior j)).
Proof.
have [s p] := prior_good j; have u := pd_unit p; move=> v v0.
have e : form (invmx (prior j)) v v = form (prior j) (invmx (prior j) *m v) (invmx (prior j) *m v).
  by rewrite [RHS]form_mul mulKVmx // dotC -form_mul.
rewrite e; apply: p; apply: contra v0 => /eqP h.
by rewrite -(mulKVmx u v) h mulmx0.
Qed.

Lemma symmetrical_sum (I : Type) (r : seq I) (P : pred I) (G : I -> 'M[F]_d) :
  (forall i, P i -> symmetrical (G i)) -> symmetrical (\sum_(i <- r | P i) G i).
Proof. by move=> h; rewrite /symmetrical linear_sum; apply: eq_bigr => i Pi; apply: h. Qed.

Lemma posterior_symmetrical S j : symmetrical (posterior S j).
Proof.
rewrite /symmetrical /posterior linearD /= (symmetrical_inv (proj1 (prior_good j))).
by congr (_ + _); apply: symmetrical_sum => e _; case: (info_good e j).
Qed.

Lemma posterior_good S : good (posterior S).
Proof.
move=> j; split; first exact: posterior_symmetrical.
by apply: pd_add (prior_inverse_pd j) _; apply: psd_sum => e _; case: (info_good e j).
Qed.

Lemma posterior_mono (S S' : {set E}) j : S \subset S' -> psd (posterior S' j - posterior S j).
Proof.
move=> sub; rewrite /posterior opprD addrACA subrr add0r (big_setID S) /= (setIidPr sub) addrAC subrr add0r.
by apply: psd_sum => e _; case: (info_good e j).
Qed.

Theorem trace_value_mono (S S' : {set E}) : S \subset S' -> trace_value S <= trace_value S'.
Proof.
move=> sub; rewrite ler_sub //; apply: trace_penalty_antitone; first exact: posterior_good.
  by move=> j; apply: posterior_symmetrical.
by move=> j; apply: posterior_mono.
Qed.

Theorem maxeig_value_mono (S S' : {set E}) : S \subset S' -> maxeig_value S <= maxeig_value S'.
Proof.
move=> sub; rewrite ler_sub //; case: (pickP (@predT T)) => [j0 _|no].
  apply: maxeig_penalty_antitone => //; first exact: posterior_good.
    by move=> j; apply: posterior_symmetrical.
  by move=> j; apply: posterior_mono.
by rewrite /maxeig_penalty /largest; case: pickP => // j; have := no j.
Qed.
End Criteria.

(** ** Where all of each state counts *)
Section Whole.
Variables (F : realFieldType) (d : nat) (T E : finType).
Variables (prior : T -> 'M[F]_d) (info : E -> T -> 'M[F]_d) (weight : T -> F) (lmax : forall n, 'M[F]_n -> F).
Implicit Type S : {set E}.
Let whole (j : T) : 'M[F]_d := 1%:M.

Lemma trace_value_whole S : trace_value prior info weight whole S =
  \sum_j weight j * (\tr (prior j) - \tr (invmx (posterior prior info S j))).
Proof.
by rewrite /trace_value /trace_base /trace_penalty -sumrB; apply: eq_bigr => j _; rewrite -mulrBr /counting !part_of1.
Qed.

Lemma maxeig_value_whole S : maxeig_value prior info weight whole lmax S =
  largest (fun j => weight j * lmax (prior j)) - largest (fun j => weight j * lmax (invmx (posterior prior info S j))).
Proof. by congr (_ - _); apply: eq_largest => j; rewrite /counting part_of1. Qed.
End Whole.
