(** What the checker accepts is true. *)
From Coq Require Import ZArith.
From mathcomp Require Import all_ssreflect all_algebra.
From mathcomp.algebra_tactics Require Import ring.
From Ratt Require Import Extrema Teams Guarantees Quadratic Criteria Dyadic DyadicMatrix Graph UpperTree LowerTree Forced Checker.
Set Implicit Arguments.
Unset Strict Implicit.
Unset Printing Implicit Defensive.
Import Order.Theory GRing.Theory Num.Theory.
Local Open Scope ring_scope.

Lemma all_someP (T : Type) (s : seq (option T)) r : all_some s = Some r -> s = map Some r.
Proof.
elim: s r => [|[x|] s IH] r //=; first by case=> <-.
by case e: (all_some s) => [r'|] // [<-] /=; rewrite (IH _ e).
Qed.

Lemma all_some_nth (T U : Type) (f : T -> option U) (s : seq T) r x0 y0 i : all_some [seq f x | x <- s] = Some r ->
  size r = size s /\ ((i < size s)%N -> f (nth x0 s i) = Some (nth y0 r i)).
Proof.
move/all_someP => e; have sz : size r = size s by rewrite -(size_map f) e size_map.
split=> // il; have := congr1 (fun q => nth None q i) e.
by rewrite (nth_map x0) // (nth_map y0) ?sz.
Qed.

Lemma rearrange (V : zmodType) (a b x y z : V) : b + x = (a - y) + ((b - a) + ((x + z) + (y - z))).
Proof.
by rewrite [x + z + _]addrACA subrr addr0 [b - a + _]addrACA addrCA [- a + y]addrC -(opprB a y) subrr addr0.
Qed.

Lemma tangent_shape (F : realFieldType) (h a t b x y : F) :
  h - (a * (2%:R * t) - a * b * (x + y)) = h - 2%:R * (a * t) + a * b * x + a * b * y.
Proof. by ring. Qed.

Section Pieces.
Variables (F : realFieldType) (d : nat).
Local Notation val := (val F).
Local Notation mx := (mx F d).

Lemma sub_symmetrical A B : symmetrical (mx A) -> symmetrical (mx B) -> symmetrical (mx (msub d A B)).
Proof. by move=> a b; rewrite mx_sub /symmetrical linearB /= a b. Qed.
Lemma add_symmetrical A B : symmetrical (mx A) -> symmetrical (mx B) -> symmetrical (mx (madd d A B)).
Proof. by move=> a b; rewrite mx_add /symmetrical linearD /= a b. Qed.
Lemma scale_symmetrical x A : symmetrical (mx A) -> symmetrical (mx (mscale d x A)).
Proof. by move=> a; rewrite mx_scale /symmetrical linearZ /= a. Qed.
Lemma scalar_symmetrical x : symmetrical (mx (mscalar d x)).
Proof. by rewrite mx_scalar /symmetrical tr_scalar_mx. Qed.
Lemma near_symmetrical p h : symmetrical (mx (near_inverse d p h)).
Proof. by rewrite /symmetrical mx_mkm; apply/matrixP => i j; rewrite !mxE maxnC minnC. Qed.
Lemma sandwich_symmetrical P Q : symmetrical (mx P) -> symmetrical (mx Q) -> symmetrical (mx (sandwich d P Q)).
Proof. by move=> a b; rewrite /sandwich !mx_mul /symmetrical !trmx_mul a b mulmxA. Qed.

Lemma inverse_boundP ok (shift : dmat -> dyadic -> dmat) P Q : inverse_bound d ok shift P = Some Q ->
  (forall Q e, symmetrical (mx Q) -> symmetrical (mx (shift Q e))) -> ok Q /\ symmetrical (mx Q).
Proof.
rewrite /inverse_bound /some_or /checked => h s; move: h.
by do ?[case: ifP => ?]; case=> // <-; split=> //; do ?apply: s; apply: near_symmetrical.
Qed.

(** [v' (P^-1 - Q) v] is [y' (P - P Q P) y] at [y = P^-1 v]. *)
Lemma sandwich_form (P Q : 'M[F]_d) v : symmetrical P -> P \in unitmx ->
  form (invmx P - Q) v v = form (P - P *m Q *m P) (invmx P *m v) (invmx P *m v).
Proof.
move=> s u; rewrite !formBm; congr (_ - _).
  by rewrite [RHS]form_mul mulKVmx // dotC -form_mul.
by rewrite [RHS]form_mul -!mulmxA mulKVmx // /dot trmx_mul (symmetrical_inv s) !mulmxA mulmxKV // -mulmxA.
Qed.

Lemma inverse_lowP P Q : symmetrical (mx P) -> pd (mx P) -> inverse_low d P = Some Q ->
  symmetrical (mx Q) /\ psd (invmx (mx P) - mx Q).
Proof.
move=> s p /inverse_boundP [|ok sQ]; first by move=> A e sA; apply: sub_symmetrical; last exact: scalar_symmetrical.
split=> // v; rewrite sandwich_form ?pd_unit //.
have sym : symmetrical (mx (msub d P (sandwich d P Q))) by apply: sub_symmetrical => //; apply: sandwich_symmetrical.
by have := is_psdP sym ok; rewrite mx_sub /sandwich !mx_mul; apply.
Qed.

Lemma formN (A : 'M[F]_d) v : form (- A) v v = - form A v v.
Proof. by rewrite -scaleN1r formZm mulN1r. Qed.

Lemma inverse_highP P Q : symmetrical (mx P) -> pd (mx P) -> inverse_high d P = Some Q ->
  symmetrical (mx Q) /\ psd (mx Q - invmx (mx P)).
Proof.
move=> s p /inverse_boundP [|ok sQ]; first by move=> A e sA; apply: add_symmetrical; last exact: scalar_symmetrical.
split=> // v; rewrite -opprB formN sandwich_form ?pd_unit // -formN opprB.
have sym : symmetrical (mx (msub d (sandwich d P Q) P)) by apply: sub_symmetrical => //; apply: sandwich_symmetrical.
by have := is_psdP sym ok; rewrite mx_sub /sandwich !mx_mul; apply.
Qed.

Lemma defectP A x : symmetrical (mx A) -> defect d A = Some x -> 0 <= val x /\ psd (mx A + (val x)%:M).
Proof.
move=> s; rewrite /defect; case: ifP => [h [<-]|_].
  rewrite val0; split=> // v; rewrite formDm form_scalar mul0r addr0; exact: is_psdP.
set l := [seq y <- _ | _]; case e: l => [//|y l'] [<-].
have : y \in l by rewrite e mem_head.
rewrite mem_filter => /andP[/andP[y0 h] _]; rewrite (val_le F) val0 in y0; split=> //.
have := is_psdP (add_symmetrical s (scalar_symmetrical y)) h; by rewrite mx_add mx_scalar.
Qed.
End Pieces.

Section Sound.
Variables (F : realFieldType) (pb : problem) (cl : claim) (pr : proofs).
Local Notation val := (val F).
Local Notation d := (dimension pb).
Local Notation m := (size (priors pb)).
Local Notation w := (net pb).
Local Notation ws := (weights pb).
Local Notation target := 'I_(size (priors pb)).
Local Notation robot := 'I_(top_robot (net pb)).+1.
Local Notation element := 'I_(top_element (net pb)).+1.

(** ** What the data say *)
Definition prior_of (j : target) : 'M[F]_d := mx F d (unpack d (nth [::] (priors pb) j)).
Definition info_of (e : element) (j : target) : 'M[F]_d :=
  mx F d (unpack d (nth [::] (nth [::] (informations pb) e) j)).
Definition weight_of (j : target) : F := val (nth d0 ws j).
Definition plan_of : {ffun robot -> element} := [ffun i : robot => inord (nth 0%N (plan cl) i)].

Variable lmax : 'M[F]_d -> F.
Definition value (S : {set element}) : F :=
  match objective pb with
  | Trace => trace_value prior_of info_of weight_of S
  | MaxEigenvalue => maxeig_value prior_of info_of weight_of lmax S
  end.
Hypothesis lmaxP : objective pb = MaxEigenvalue -> largest_eigenvalue lmax.

Definition penalty (L : target -> 'M[F]_d) : F :=
  match objective pb with Trace => trace_penalty weight_of L | MaxEigenvalue => maxeig_penalty weight_of lmax L end.
Definition base : F :=
  match objective pb with Trace => trace_base prior_of weight_of | MaxEigenvalue => maxeig_base prior_of weight_of lmax end.

Lemma valueE S : value S = base - penalty (posterior prior_of info_of S).
Proof. by rewrite /value /base /penalty; case: (objective pb). Qed.

Hypotheses (net_good : network_ok w) (shapes : shapes_ok pb) (plan_good : plan_ok pb cl) (priors_good : priors_ok pb).
Hypothesis range_good : prior_range_ok pb pr.

Let dim_pos : (0 < d)%N. Proof. by case/and3P: shapes. Qed.
Let targets_pos : (0 < m)%N. Proof. by case/and3P: shapes. Qed.
Let j0 : target := Ordinal targets_pos.
Let weights_size : size ws = m. Proof. by case/and4P: shapes => _ _ _ /andP[/eqP]. Qed.
Let infos_size : size (informations pb) = size (owners w).
Proof. by case/and4P: shapes => _ _ _ /and4P[_ _ /eqP]. Qed.
Let rows_size e : (e < size (owners w))%N -> size (nth [::] (informations pb) e) = m.
Proof.
case/and4P: shapes => _ _ _ /and4P[_ _ /eqP <- /allP h] el.
by have /andP[/eqP] := h _ (mem_nth [::] el).
Qed.

Lemma weight_gt0 j : 0 < weight_of j.
Proof.
case/and4P: shapes => _ _ _ /and3P[_ /allP h _]; have := h (nth d0 ws j).
by rewrite (val_lt F) val0 mem_nth ?weights_size // => /(_ isT).
Qed.
Lemma weight_ge0 j : 0 <= weight_of j. Proof. exact/ltW/weight_gt0. Qed.

Lemma owners_pos : (0 < size (owners w))%N.
Proof. by case/and3P: net_good. Qed.
Lemma element_lt (e : element) : (e < size (owners w))%N.
Proof. by apply: leq_trans (ltn_ord e) _; rewrite /top_element prednK ?owners_pos. Qed.

Lemma nth_prior (j : nat) : (j < m)%N -> nth [::] (prior_matrices pb) j = unpack d (nth [::] (priors pb) j).
Proof. by move=> jm; rewrite (nth_map [::]). Qed.
Lemma nth_info (e j : nat) : (e < size (owners w))%N -> (j < m)%N ->
  nth [::] (nth [::] (info_matrices pb) e) j = unpack d (nth [::] (nth [::] (informations pb) e) j).
Proof. by move=> el jm; rewrite (nth_map [::]) ?infos_size // (nth_map [::]) ?rows_size. Qed.

Lemma prior_good j : symmetrical (prior_of j) /\ pd (prior_of j).
Proof.
have s := unpack_symmetrical F d (nth [::] (priors pb) j); split=> //.
apply/is_pdP => //; rewrite -nth_prior //; have /allP := priors_good; apply.
by apply: mem_nth; rewrite size_map.
Qed.
Lemma info_symmetrical e j : symmetrical (info_of e j).
Proof. exact: unpack_symmetrical. Qed.

Lemma value0 : value set0 = 0.
Proof.
by rewrite /value; case: (objective pb); [apply: trace_value0 | apply: maxeig_value0].
Qed.

Lemma penalty_antitone A B : good A -> (forall j, symmetrical (B j)) -> (forall j, psd (B j - A j)) ->
  penalty B <= penalty A.
Proof.
rewrite /penalty; case e: (objective pb) => gA sB AB; first exact: (trace_penalty_antitone weight_ge0).
exact: (maxeig_penalty_antitone weight_ge0 (lmaxP e)).
Qed.

Lemma penalty_convex (I : eqType) (s : seq I) (A : I -> target -> 'M[F]_d) : s != [::] ->
  (forall i, i \in s -> good (A i)) ->
  penalty (fun j => (size s)%:R^-1 *: \sum_(i <- s) A i j) <= (size s)%:R^-1 * \sum_(i <- s) penalty (A i).
Proof.
rewrite /penalty; case e: (objective pb) => s0 gA; first exact: (trace_penalty_convex weight_ge0).
exact: (maxeig_penalty_convex weight_ge0 (lmaxP e)).
Qed.

Lemma sum_contributed p (G : {set robot}) (f : element -> 'M[F]_d) : is_plan (team_of w) p ->
  \sum_(e in contributed p G) f e = \sum_(i in G) f (p i).
Proof. by move=> okp; rewrite big_imset //= => i j _ _; apply: plan_inj okp i j. Qed.

Lemma posterior_sym S j : symmetrical (posterior prior_of info_of S j).
Proof.
rewrite /symmetrical /posterior linearD /= (symmetrical_inv (proj1 (prior_good j))).
by congr (_ + _); apply: symmetrical_sum => e _; apply: info_symmetrical.
Qed.

Lemma scalar_sum (G : {set robot}) (f : robot -> F) :
  \sum_(i in G) (f i)%:M = (\sum_(i in G) f i)%:M :> 'M[F]_d.
Proof. by apply/matrixP => i k; rewrite summxE mxE -sumrMnl; apply: eq_bigr => e _; rewrite mxE. Qed.
Lemma scalar_sub (x y : F) : (x - y)%:M = x%:M - y%:M :> 'M[F]_d.
Proof. by apply/matrixP => i k; rewrite !mxE mulrnBl. Qed.

(** ** Tables *)
Variables (lows highs : seq dmat) (defects : seq (seq dyadic)).
Hypothesis lowsE : all_some [seq inverse_low d P | P <- prior_matrices pb] = Some lows.
Hypothesis highsE : all_some [seq inverse_high d P | P <- prior_matrices pb] = Some highs.
Hypothesis defectsE : all_some [seq all_some [seq defect d A | A <- row] | row <- info_matrices pb] = Some defects.
Hypothesis room : room_ok pb lows defects.

Lemma lowP (j : target) : symmetrical (mx F d (nth [::] lows j)) /\ psd (invmx (prior_of j) - mx F d (nth [::] lows j)).
Proof.
have [_ h] := all_some_nth [::] [::] j lowsE; rewrite size_map in h; have := h (ltn_ord j); rewrite nth_prior //.
by have [s p] := prior_good j; apply: inverse_lowP.
Qed.
Lemma highP (j : target) : symmetrical (mx F d (nth [::] highs j)) /\ psd (mx F d (nth [::] highs j) - invmx (prior_of j)).
Proof.
have [_ h] := all_some_nth [::] [::] j highsE; rewrite size_map in h; have := h (ltn_ord j); rewrite nth_prior //.
by have [s p] := prior_good j; apply: inverse_highP.
Qed.

Definition delta (e j : nat) : F := val (nth d0 (nth [::] defects e) j).
Lemma deltaP (e : element) (j : target) : 0 <= delta e j /\ psd (info_of e j + (delta e j)%:M).
Proof.
have el := element_lt e; have [_ h] := all_some_nth [::] [::] e defectsE.
rewrite size_map infos_size in h; have {h} h := h el.
have [_ h2] := all_some_nth [::] d0 j h; rewrite (nth_map [::]) ?infos_size // size_map rows_size // in h2.
have := h2 (ltn_ord j); rewrite -(nth_map [::] [::] (fun row => [seq unpack d x | x <- row])) ?infos_size //.
rewrite -[map _ (informations pb)]/(info_matrices pb) nth_info //.
by apply: defectP; apply: unpack_symmetrical.
Qed.

Lemma worst_ge p (G : {set robot}) (j : target) : is_plan (team_of w) p ->
  \sum_(i in G) delta (p i) j <= (robots w).+1%:R * val (worst_defect pb defects j).
Proof.
move=> okp; have le : \sum_(i : robot) delta (p i) j <= val (worst_defect pb defects j).
  rewrite /worst_defect val_sum big_map.
  rewrite (_ : iota 0 (robots w) = index_iota 0 (robots w)); last by rewrite /index_iota subn0.
  rewrite (big_mkord xpredT (fun i => val (largest_of (fun e => nth d0 (nth [::] defects e) j) (nth [::] (all_plans w) i)))).
  apply: ler_sum => i _; apply: (largest_ofP F (fun e => nth d0 (nth [::] defects e) j)).
  exact: in_all_plans.
have ge0 : 0 <= \sum_(i : robot) delta (p i) j by apply: sumr_ge0 => i _; case: (deltaP (p i) j).
apply: le_trans (_ : \sum_(i : robot) delta (p i) j <= _).
  rewrite big_mkcond; apply: ler_sum => i _; case: ifP => // _; by case: (deltaP (p i) j).
have w0 := le_trans ge0 le; apply: le_trans le _; rewrite -[X in X <= _]mul1r.
by apply: ler_wpmul2r; rewrite // ler1n.
Qed.

Lemma posterior_pd p (G : {set robot}) : is_plan (team_of w) p ->
  good (posterior prior_of info_of (contributed p G)).
Proof.
move=> okp j; split; first exact: posterior_sym.
set D := (robots w).+1%:R * val (worst_defect pb defects j).
have pdl : pd (mx F d (nth [::] lows j) - D%:M).
  have /allP/(_ (j : nat)) := room; rewrite mem_iota add0n ltn_ord => /(_ isT).
  have [sl _] := lowP j; have ss := sub_symmetrical sl (scalar_symmetrical F d (dmul (dnat (robots w).+1) (worst_defect pb defects j))).
  by move/(is_pdP ss); rewrite mx_sub mx_scalar val_mul val_nat.
have -> : posterior prior_of info_of (contributed p G) j = (mx F d (nth [::] lows j) - D%:M) +
    ((invmx (prior_of j) - mx F d (nth [::] lows j)) + (\sum_(i in G) (info_of (p i) j + (delta (p i) j)%:M) +
    (D - \sum_(i in G) delta (p i) j)%:M)).
  rewrite /posterior sum_contributed // big_split /= scalar_sum scalar_sub.
  exact: rearrange.
apply: pd_add pdl _; apply: psdD; first by case: (lowP j).
apply: psdD; first by apply: psd_sum => i _; case: (deltaP (p i) j).
by apply: psd_scalar; rewrite subr_ge0; apply: worst_ge.
Qed.

(** ** Linear bounds on groups *)
Lemma mx_nil : mx F d [::] = 0.
Proof. by apply/matrixP => i j; rewrite !mxE /get !nth_nil /= val0. Qed.

Lemma dotsE Ws Is : size Ws = m -> size Is = m ->
  val (dots d Ws Is) = \sum_(j : target) \tr ((mx F d (nth [::] Ws j))^T *m mx F d (nth [::] Is j)).
Proof.
move=> sW sI; rewrite /dots val_sum big_map big_filter.
rewrite (_ : \sum_(x <- zip Ws Is | ~~ nilp x.1) _ = \sum_(x <- zip Ws Is) val (mdot d x.1 x.2)); last first.
  rewrite big_mkcond; apply: eq_bigr => -[W A] _ /=; case: ifP => // /negbFE/nilP ->.
  by rewrite mx_dot mx_nil trmx0 mul0mx mxtrace0.
rewrite (big_nth ([::], [::])) size_zip sW sI minnn big_mkord; apply: eq_bigr => j _.
by rewrite nth_zip ?sW // mx_dot.
Qed.

Lemma info_row_size e : (e < size (owners w))%N -> size (nth [::] (info_matrices pb) e) = m.
Proof. by move=> el; rewrite (nth_map [::]) ?infos_size // size_map rows_size. Qed.

Lemma dots_info Ws (e : element) : size Ws = m ->
  val (dots d Ws (nth [::] (info_matrices pb) e)) = \sum_(j : target) \tr ((mx F d (nth [::] Ws j))^T *m info_of e j).
Proof.
move=> sW; rewrite dotsE ?info_row_size ?element_lt //; apply: eq_bigr => j _.
by rewrite nth_info ?element_lt.
Qed.

Lemma highs_size : size highs = m.
Proof. by have [-> _] := all_some_nth [::] [::] 0 highsE; rewrite size_map. Qed.

Lemma base_high : objective pb = MaxEigenvalue -> base <= val (prior_high pr).
Proof.
move=> e; rewrite /base e; move: range_good; rewrite /prior_range_ok e => /andP[/allP h _].
apply: largest_le => // j; have := h j; rewrite mem_iota add0n ltn_ord nth_prior // => /(_ isT).
have [s _] := prior_good j; have w0 := weight_gt0 j.
have sm : symmetrical (mx F d (msub d (mscalar d (prior_high pr)) (mscale d (nth d0 ws j) (unpack d (nth [::] (priors pb) j))))).
  by apply: sub_symmetrical; [apply: scalar_symmetrical | apply: scale_symmetrical].
move/(is_psdP sm); rewrite mx_sub mx_scalar mx_scale -/(weight_of j) -/(prior_of j) => p.
rewrite mulrC -ler_pdivl_mulr //; apply/(lmaxP e s) => v; have := p v.
rewrite !formBm !form_scalar formZm !subr_ge0 => le.
by rewrite mulrAC ler_pdivl_mulr // [form _ _ _ * _]mulrC.
Qed.

Lemma gradientP pt g : gradient (objective pb) d m ws (prior_matrices pb) highs (prior_high pr) pt = Some g ->
  size g.1 = m /\ forall p (G : {set robot}), is_plan (team_of w) p ->
  value (contributed p G) <= val g.2 + \sum_(i in G) val (dots d g.1 (nth [::] (info_matrices pb) (p i))).
Proof.
rewrite /gradient; case e: (objective pb); case: pt => [ys|j t v] //; case: ifP => // cond [<-] /=.
  rewrite size_mkseq; split=> // p G okp; set Ws := mkseq _ m.
  have sW : size Ws = m by rewrite size_mkseq.
  pose Y (j : target) := mx F d (unpack d (nth [::] ys j)).
  have Ys j : symmetrical (Y j) := unpack_symmetrical F d _.
  have We (j : target) : (mx F d (nth [::] Ws j))^T = weight_of j *: (Y j *m Y j).
    rewrite nth_mkseq // mx_scale mx_mul (nth_map [::]) ?(eqP cond) // -/(Y j).
    by rewrite linearZ /= trmx_mul Ys.
  rewrite val_add dotsE ?highs_size // val_sum_iota.
  rewrite (eq_bigr (fun i => \sum_(j : target) weight_of j * \tr (Y j *m Y j *m info_of (p i) j))); last first.
    move=> i _; rewrite dots_info //; apply: eq_bigr => j _.
    by rewrite We -scalemxAl linearZ.
  rewrite [X in _ <= _ + X]exchange_big /= -!big_split /value e /trace_value /trace_base /trace_penalty -sumrB; apply: ler_sum => j _ /=.
  have [sL pL] := posterior_pd G okp j; have [sP pP] := prior_good j.
  rewrite -!mulr_sumr We -scalemxAl linearZ /= -mulrBr val_mul val_sub val_mul !mx_trace val_nat.
  rewrite nth_prior // (nth_map [::]) ?(eqP cond) // -/(prior_of j) -/(Y j) -!mulrDr.
  apply: ler_wpmul2l; first exact: weight_ge0.
  have := trace_fenchel (Y j) sL pL; rewrite Ys => fen.
  have sand A : \tr (Y j *m A *m Y j) = \tr (Y j *m Y j *m A) by rewrite mxtrace_mulC mulmxA.
  have up : \tr (Y j *m posterior prior_of info_of (contributed p G) j *m Y j) <=
      \tr (Y j *m Y j *m mx F d (nth [::] highs j)) + \sum_(i in G) \tr (Y j *m Y j *m info_of (p i) j).
    rewrite sand /posterior sum_contributed // mulmxDr linearD /= mulmx_sumr raddf_sum ler_add2r -subr_ge0 -linearB /=.
    rewrite -mulmxBr -sand; apply: psd_trace => x; have [_ ph] := highP j.
    have := ph (Y j *m x); rewrite /form trmx_mul Ys !mulmxA //.
  rewrite -[X in _ <= X]addrA -addrA ler_add2l; apply: le_trans (_ : - (2%:R * \tr (Y j) - \tr (Y j *m posterior prior_of info_of (contributed p G) j *m Y j)) <= _); first by rewrite ler_opp2.
  by rewrite opprB addrC ler_add2l.
move/and3P: cond => [jm s0 bt]; set s := dsum _ in s0 bt; set b := quotient_up _ _ _ in bt *.
rewrite size_mkseq; split=> // p G okp; set W := mkm _ _; set Ws := mkseq _ m.
have sW : size Ws = m by rewrite size_mkseq.
pose jt : target := Ordinal jm; pose V : 'cV[F]_d := \col_i val (nth d0 v i).
have VV : dot V V = val s.
  by rewrite dot_sum val_sum_iota; apply: eq_bigr => i _; rewrite mxE val_mul expr2.
rewrite (val_lt F) val0 -VV in s0; rewrite (val_le F) !val_mul -VV in bt.
have V0 : V != 0 by apply: contraTneq s0 => ->; rewrite /dot mulmx0 mxE ltxx.
have mW : mx F d W = (weight_of jt * val b) *: (V *m V^T).
  by rewrite mx_mkm; apply/matrixP => i k; rewrite !mxE !val_mul big_ord1 !mxE.
have one (A : target -> 'M[F]_d) : \sum_(k : target) \tr ((mx F d (nth [::] Ws k))^T *m A k) =
    weight_of jt * val b * form (A jt) V V.
  rewrite (bigD1 jt) //= big1 ?addr0 => [|k ne].
    rewrite nth_mkseq // eqxx mW linearZ /= trmx_mul trmxK -scalemxAl linearZ /=; congr (_ * _).
    by rewrite mxtrace_mulC mulmxA mxtrace_mulC mulmxA /form /mxtrace big_ord1.
  by rewrite nth_mkseq // ifN ?mx_nil ?trmx0 ?mul0mx ?mxtrace0 //.
rewrite val_add val_sub !val_mul val_nat dotsE ?highs_size // one.
rewrite (eq_bigr (fun i => weight_of jt * val b * form (info_of (p i) jt) V V)); last first.
  by move=> i _; rewrite dots_info // one.
have [sL pL] := posterior_pd G okp jt; set L := posterior _ _ _ in sL pL.
have w0 := weight_gt0 jt; have b0 : 0 <= val b.
  by rewrite -(pmulr_lge0 _ s0); apply: le_trans bt; rewrite -expr2 sqr_ge0.
have fen := largest_eigenvalue_fenchel (lmaxP e) (val t) sL pL V0.
have Lb : form (L jt) V V <= form (mx F d (nth [::] highs jt)) V V + \sum_(i in G) form (info_of (p i) jt) V V.
  rewrite /L /posterior sum_contributed // formDm form_sum ler_add2r -subr_ge0 -formBm.
  by have [_ h] := highP jt; apply: h.
have le1 : 2%:R * val t - val b * form (L jt) V V <= lmax (invmx (L jt)).
  apply: le_trans fen; rewrite ler_add2l ler_opp2 mulrA ler_pdivr_mulr // [X in _ <= X]mulrAC.
  by apply: ler_wpmul2r; [apply: (pd_psd pL) | rewrite expr2].
rewrite valueE -/L /penalty e -!mulr_sumr.
have le2 : weight_of jt * lmax (invmx (L jt)) <= maxeig_penalty weight_of lmax L.
  exact: (le_largest (fun k => weight_of k * lmax (invmx (L k)))).
have le3 : weight_of jt * (2%:R * val t) - weight_of jt * val b *
    (form (mx F d (nth [::] highs jt)) V V + \sum_(i in G) form (info_of (p i) jt) V V) <= maxeig_penalty weight_of lmax L.
  apply: le_trans le2; rewrite -mulrA -mulrBr; apply: ler_wpmul2l; first exact: ltW.
  by apply: le_trans le1; rewrite ler_add2l ler_opp2; apply: ler_wpmul2l.
have := ler_sub (base_high e) le3; move=> h; apply: le_trans h _.
by rewrite (tangent_shape (val (prior_high pr)) (weight_of jt) (val t) (val b)) lexx.
Qed.
End Sound.
