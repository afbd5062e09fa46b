(** What the checker accepts is true. *)
From Coq Require Import ZArith.
From mathcomp Require Import all_ssreflect all_algebra.
From mathcomp.algebra_tactics Require Import ring.
From Ratt Require Import Extrema Teams Guarantees Quadratic Criteria Logdet Submodular Dyadic DyadicMatrix DyadicLog Outputs Graph Worth Scores Covers Lemmas Gains UpperTree LowerTree CaseTree Costs GroupProofs Sizes SizeProofs Forced Checker.
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

Lemma rearrange2 (V : zmodType) (a b x y z t : V) : b + (x + y) = a - (z + t) + x + (b - a) + (y + t + z).
Proof.
rewrite -[y + t + z]addrA [t + z]addrC; move: (z + t) => q; set u := a - q.
rewrite [u + x + _ + _]addrACA; have -> : b - a + q = b - u by rewrite /u opprB addrA addrAC.
by rewrite -[u + x + y]addrA [RHS]addrC [RHS]addrA subrK.
Qed.

Lemma rearrange3 (V : zmodType) (a b e x y z : V) : (a + (e + x)) - ((b - y) + e) = (a - b) + ((x + z) + (y - z)).
Proof.
rewrite [x + z + _]addrACA subrr addr0 opprD opprB addrACA [e + x]addrC addrK [y - b]addrC addrA -addrA.
by rewrite [y + x]addrC.
Qed.

Lemma logdet_shape (F : realFieldType) (p l y q n tr h s : F) : p - y <= q -> l + y <= tr - n -> tr <= h + s ->
  p + l <= q - n + h + s.
Proof.
move=> h1 h2 h3; have := ler_add (ler_add h1 h2) h3; rewrite -subr_ge0 => h4; rewrite -subr_ge0.
by apply: le_trans h4 _; rewrite le_eqVlt; apply/orP; left; apply/eqP; ring.
Qed.

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

Section Telling.
Variables (F : realFieldType) (d : nat).
Local Notation val := (val F).
Local Notation mx := (mx F d).

Lemma is_zeroP x : is_zero x -> val x = 0.
Proof. by rewrite /is_zero => /Z.eqb_eq e; rewrite /Dyadic.val e mul0r. Qed.

Lemma mx_telling A x : mx (telling d A x) = mx A + (val x)%:M.
Proof.
rewrite /telling; set B := if is_zero x then A else _.
have eB : mx B = mx A + (val x)%:M.
  by rewrite /B; case: ifP => [/is_zeroP ->|_]; rewrite ?scalar_mx0 ?addr0 ?mx_add ?mx_scalar // raddf0 addr0.
case: ifP => // /allP zero; rewrite -eB mx_nil; apply/matrixP => i j; rewrite !mxE /get; apply/esym.
case: (ltnP i (size B)) => [iB|ge]; last by rewrite (nth_default [::] ge) nth_nil val0.
have /allP row := zero _ (mem_nth [::] iB); case: (ltnP j (size (nth [::] B i))) => [jB|ge].
  by apply: is_zeroP; apply: row; apply: mem_nth.
by rewrite nth_default ?val0.
Qed.

Lemma lackingP A x : symmetrical (mx A) -> lacking d A = Some x -> psd (mx A + (val x)%:M).
Proof.
move=> s; rewrite /lacking; case: ifP => [h [<-]|_]; last by case: ifP => // _ /(defectP s)[].
by rewrite val0 raddf0 addr0; apply: is_psdP.
Qed.

Lemma each_someE (T U : Type) (f : T -> option U) s : each_some f s = all_some [seq f x | x <- s].
Proof. by elim: s => //= x s ->; case: (f x). Qed.
End Telling.

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
(** What counts of a target: all of its state, or the part that its output says. *)
Definition counted_rows (j : target) : nat := output_rows d (outputs pb) j.
Definition output_of (j : target) : 'M[F]_(counted_rows j, d) := output_mx F d (outputs pb) j.
Definition plan_of : {ffun robot -> element} := [ffun i : robot => inord (nth 0%N (plan cl) i)].

Variables (lmax : forall n, 'M[F]_n -> F) (ln : F -> F).
Definition value (S : {set element}) : F :=
  match objective pb with
  | Trace => trace_value prior_of info_of weight_of output_of S
  | LogDet => logdet_value ln prior_of info_of weight_of S
  | MaxEigenvalue => maxeig_value prior_of info_of weight_of output_of lmax S
  end.
Hypothesis lmaxP : objective pb = MaxEigenvalue -> forall j, largest_eigenvalue (@lmax (counted_rows j)).
Hypothesis lnP : objective pb = LogDet -> logarithm ln.

Definition penalty (L : target -> 'M[F]_d) : F :=
  match objective pb with
  | Trace => trace_penalty weight_of output_of L
  | LogDet => logdet_penalty ln weight_of L
  | MaxEigenvalue => maxeig_penalty weight_of output_of lmax L
  end.
Definition base : F :=
  match objective pb with
  | Trace => trace_base prior_of weight_of output_of
  | LogDet => logdet_base ln prior_of weight_of
  | MaxEigenvalue => maxeig_base prior_of weight_of output_of lmax
  end.

Lemma valueE S : value S = base - penalty (posterior prior_of info_of S).
Proof. by rewrite /value /base /penalty; case: (objective pb). Qed.

Hypotheses (net_good : network_ok w) (shapes : shapes_ok pb) (plan_good : plan_ok pb cl) (priors_good : priors_ok pb).
Hypothesis range_good : prior_range_ok pb pr.

Let dim_pos : (0 < d)%N. Proof. by case/and3P: shapes. Qed.
Let targets_pos : (0 < m)%N. Proof. by case/and3P: shapes. Qed.
Let j0 : target := Ordinal targets_pos.
Let weights_size : size ws = m. Proof. by case/and4P: shapes => _ _ _ /andP[/eqP]. Qed.
Let outputs_good : outputs_ok d (outputs pb) m.
Proof. by case/and4P: shapes => _ _ _ /and4P[_ _ _ /andP[]]. Qed.
Let infos_size : size (informations pb) = size (owners w).
Proof. by case/and4P: shapes => _ _ _ /and4P[_ _ /eqP]. Qed.
Let rows_size e : (e < size (owners w))%N -> size (nth [::] (informations pb) e) = m.
Proof.
case/and4P: shapes => _ _ _ /and4P[_ _ /eqP <- /and3P[_ _ /allP h]] el.
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
rewrite /value; case e: (objective pb); [exact: trace_value0 | | exact: maxeig_value0].
by apply: (logdet_value0 (lnP e)) => j; apply: prior_good.
Qed.

Lemma penalty_antitone A B : good A -> (forall j, symmetrical (B j)) -> (forall j, psd (B j - A j)) ->
  penalty B <= penalty A.
Proof.
rewrite /penalty; case e: (objective pb) => gA sB AB; first exact: (trace_penalty_antitone output_of weight_ge0).
  exact: (logdet_penalty_antitone (lnP e) weight_ge0).
exact: (maxeig_penalty_antitone output_of weight_ge0 (lmaxP e)).
Qed.

Lemma penalty_convex (I : eqType) (s : seq I) (A : I -> target -> 'M[F]_d) : s != [::] ->
  (forall i, i \in s -> good (A i)) ->
  penalty (fun j => (size s)%:R^-1 *: \sum_(i <- s) A i j) <= (size s)%:R^-1 * \sum_(i <- s) penalty (A i).
Proof.
rewrite /penalty; case e: (objective pb) => s0 gA; first exact: (trace_penalty_convex output_of weight_ge0).
  exact: (logdet_penalty_convex (lnP e) weight_ge0).
exact: (maxeig_penalty_convex output_of weight_ge0 (lmaxP e)).
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
  exact: in_all_plans net_good okp.
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

(** ** What counts *)
Let Ss := output_squares pb.
Lemma squareP (j : target) : square_mx F d (nth None Ss j) = (output_of j)^T *m output_of j.
Proof. exact: (mx_squares F outputs_good). Qed.
Lemma trace_squareP (j : target) A : \tr ((square_mx F d (nth None Ss j))^T *m A) = \tr (part_of (output_of j) A).
Proof. by rewrite squareP trmx_mul trmxK trace_part. Qed.

(** ** Linear bounds on groups *)
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

Lemma covarianceP (j : target) : let q := counted_rows j in
  let A := nth [::] (mkseq (fun j => covariance d (outputs pb) j (nth [::] (prior_matrices pb) j)) m) j in
  mx F q A = part_of (output_of j) (prior_of j) /\ forall x,
  symmetrical (mx F q (msub q (mscalar q x) (mscale q (nth d0 ws j) A))).
Proof.
rewrite /= nth_mkseq // nth_prior //; have e := mx_covariance F d (outputs pb) j (unpack d (nth [::] (priors pb) j)).
split=> // x; apply: sub_symmetrical; first exact: scalar_symmetrical.
by apply: scale_symmetrical; rewrite e; apply: symmetrical_part; case: (prior_good j).
Qed.

Lemma base_high : objective pb = MaxEigenvalue -> base <= val (prior_high pr).
Proof.
move=> e; rewrite /base e; move: range_good; rewrite /prior_range_ok e => /andP[/allP h _].
apply: largest_le => // j; have := h j; rewrite mem_iota add0n ltn_ord => /(_ isT).
have [s _] := prior_good j; have w0 := weight_gt0 j; have [eA /(_ (prior_high pr)) sm] := covarianceP j.
move/(is_psdP sm); rewrite mx_sub mx_scalar mx_scale eA -/(weight_of j) => p.
rewrite mulrC -ler_pdivl_mulr //; apply/(lmaxP e (symmetrical_part (output_of j) s)) => v; have := p v.
rewrite !formBm !form_scalar formZm !subr_ge0 => le.
by rewrite mulrAC ler_pdivl_mulr // [form _ _ _ * _]mulrC.
Qed.

(** What a set is worth for one target: its part of the sum; for the largest eigenvalue, what the set would be worth if the
    target's were the largest. *)
Definition target_value (j : target) (S : {set element}) : F :=
  let L := posterior prior_of info_of S j in
  match objective pb with
  | Trace => weight_of j * \tr (counting output_of j (prior_of j)) - weight_of j * \tr (counting output_of j (invmx L))
  | LogDet => weight_of j * ln (\det (prior_of j)) - weight_of j * - ln (\det L)
  | MaxEigenvalue => base - weight_of j * lmax (counting output_of j (invmx L))
  end.

Lemma value_sum S : objective pb <> MaxEigenvalue -> value S = \sum_j target_value j S.
Proof.
rewrite /value /target_value; case: (objective pb) => // _; first by rewrite /trace_value /trace_base /trace_penalty -sumrB.
by rewrite /logdet_value /logdet_base /logdet_penalty -sumrB.
Qed.

Lemma value_le_target j S : objective pb = MaxEigenvalue -> value S <= target_value j S.
Proof.
move=> e; rewrite valueE /penalty /target_value e ler_add2l ler_opp2.
exact: (le_largest (fun k => weight_of k * lmax (counting output_of k (invmx (posterior prior_of info_of S k))))).
Qed.

Lemma all_some_iota (U : Type) (f : nat -> option U) y0 r (j : target) :
  all_some [seq f i | i <- iota 0 m] = Some r -> f j = Some (nth y0 r j).
Proof.
move=> h; have [_ h2] := all_some_nth 0%N y0 j h; rewrite size_iota in h2.
by have := h2 (ltn_ord j); rewrite nth_iota // add0n.
Qed.

Lemma gradient_atP (j : target) t g p (G : {set robot}) :
  gradient_at (objective pb) d ws (outputs pb) Ss (prior_matrices pb) highs (prior_high pr) j t = Some g ->
  is_plan (team_of w) p -> target_value j (contributed p G) <=
    val g.2 + \sum_(i in G) val (mdot d g.1 (nth [::] (nth [::] (info_matrices pb) (p i)) j)).
Proof.
move=> + okp; have [sL pL] := posterior_pd G okp j; set L := posterior _ _ _ j in sL pL.
have info_dot (W : dmat) i : val (mdot d W (nth [::] (nth [::] (info_matrices pb) (p i)) j)) = \tr ((mx F d W)^T *m info_of (p i) j).
  by rewrite mx_dot nth_info ?element_lt.
rewrite /gradient_at /target_value -/L; case e: (objective pb); case: t => [y|t v|base] //.
- move=> [<-] /=; set Z := touching d _ _ _; set W := mscale d _ _.
  pose Y : 'M[F]_(d, counted_rows j) := touch_mx F d (outputs pb) j Z.
  have We : (mx F d W)^T = weight_of j *: (Y *m Y^T) by rewrite mx_scale mx_outer -/Y linearZ /= trmx_mul trmxK.
  rewrite val_add mx_dot (eq_bigr (fun i => weight_of j * \tr (Y *m Y^T *m info_of (p i) j))); last first.
    by move=> i _; rewrite info_dot We -scalemxAl linearZ.
  rewrite -!mulr_sumr We -scalemxAl linearZ /= -mulrBr val_mul val_sub val_mul trace_withP val_nat.
  rewrite touching_traceP nth_prior // trace_squareP -/(prior_of j) -/Y -/(output_of j) -!mulrDr.
  apply: ler_wpmul2l; first exact: weight_ge0.
  have fen := trace_fenchel (output_of j) Y sL pL.
  have sand A : \tr (Y^T *m A *m Y) = \tr (Y *m Y^T *m A) by rewrite mxtrace_mulC mulmxA.
  have up : \tr (Y^T *m L *m Y) <= \tr (Y *m Y^T *m mx F d (nth [::] highs j)) + \sum_(i in G) \tr (Y *m Y^T *m info_of (p i) j).
    rewrite sand /L /posterior sum_contributed // mulmxDr linearD /= mulmx_sumr raddf_sum ler_add2r -subr_ge0 -linearB /=.
    rewrite -mulmxBr -sand; apply: psd_trace => x; have [_ ph] := highP j.
    have := ph (Y *m x); rewrite /form trmx_mul !mulmxA //.
  rewrite /counting -[X in _ <= X]addrA -addrA ler_add2l.
  apply: le_trans (_ : - (2%:R * \tr (output_of j *m Y) - \tr (Y^T *m L *m Y)) <= _); first by rewrite ler_opp2.
  by rewrite opprB addrC ler_add2l.
- cbv zeta; case: ifP => // definite [<-] /=; set W := mscale d _ _; pose Y := mx F d (unpack d y).
  have sY : symmetrical Y := unpack_symmetrical F d _; have pY : pd Y by apply/(is_pdP sY).
  have We : (mx F d W)^T = weight_of j *: Y by rewrite mx_scale linearZ /= sY.
  rewrite val_add mx_dot (eq_bigr (fun i => weight_of j * \tr (Y *m info_of (p i) j))); last first.
    by move=> i _; rewrite info_dot We -scalemxAl linearZ.
  have [sP pP] := prior_good j.
  rewrite -!mulr_sumr We -scalemxAl linearZ /= -mulrBr opprK val_mul val_sub val_nat nth_prior // -!mulrDr.
  apply: ler_wpmul2l; first exact: weight_ge0.
  have fen := logdet_fenchel (lnP e) sL pL sY pY.
  have P0 : 0 < \det (prior_of j) := det_gt0 sP pP; have Y0 : 0 < \det Y := det_gt0 sY pY.
  have := @log_quotient_upP F ln (lnP e) 110 400 (mdet d (unpack d (nth [::] (priors pb) j))) (mdet d (unpack d y)).
  rewrite !mdetE -/(prior_of j) -/Y => /(_ P0 Y0); rewrite (lnM (lnP e)) ?invr_gt0 // (lnV (lnP e) Y0).
  set q := val (log_quotient_up _ _ _ _) => lq.
  have up : \tr (Y *m L) <= \tr (Y *m mx F d (nth [::] highs j)) + \sum_(i in G) \tr (Y *m info_of (p i) j).
    rewrite /L /posterior sum_contributed // mulmxDr linearD /= mulmx_sumr raddf_sum ler_add2r -subr_ge0 -linearB /= -mulmxBr.
    have [sH pH] := highP j; apply: trace_product_ge0 => //.
    by rewrite /symmetrical linearB /= sH (symmetrical_inv sP).
  exact: logdet_shape lq fen up.
cbv zeta; set s := length_of _ _ _; set b := quotient_up _ _ _; case: ifP => // /andP[s0 bt] [<-] /=; set W := mkm _ _.
pose V : 'cV[F]_d := \col_i val (nth d0 v i).
pose U := output_of j *m V; have UU : dot U U = val s.
  by rewrite /s (length_ofP F d) (squareP j) /U /dot /form trmx_mul !mulmxA.
rewrite (val_lt F) val0 -UU in s0; rewrite (val_le F) !val_mul -UU in bt.
have U0 : U != 0 by apply: contraTneq s0 => ->; rewrite /dot mulmx0 mxE ltxx.
have mW : mx F d W = (weight_of j * val b) *: (V *m V^T).
  by rewrite mx_mkm; apply/matrixP => i k; rewrite !mxE !val_mul big_ord1 !mxE.
have one A : \tr ((mx F d W)^T *m A) = weight_of j * val b * form A V V.
  rewrite mW linearZ /= trmx_mul trmxK -scalemxAl linearZ /=; congr (_ * _).
  by rewrite mxtrace_mulC mulmxA mxtrace_mulC mulmxA /form /mxtrace big_ord1.
rewrite val_add val_sub !val_mul val_nat mx_dot one (eq_bigr (fun i => weight_of j * val b * form (info_of (p i) j) V V)); last first.
  by move=> i _; rewrite info_dot one.
have w0 := weight_gt0 j; have b0 : 0 <= val b.
  by rewrite -(pmulr_lge0 _ s0); apply: le_trans bt; rewrite -expr2 sqr_ge0.
have fen := largest_eigenvalue_fenchel (lmaxP e (j:=j)) (val t) sL pL U0.
have Lb : form L V V <= form (mx F d (nth [::] highs j)) V V + \sum_(i in G) form (info_of (p i) j) V V.
  rewrite /L /posterior sum_contributed // formDm form_sum ler_add2r -subr_ge0 -formBm.
  by have [_ h] := highP j; apply: h.
have le1 : 2%:R * val t - val b * form L V V <= lmax (part_of (output_of j) (invmx L)).
  apply: le_trans fen; rewrite ler_add2l ler_opp2 mulrA ler_pdivr_mulr // [X in _ <= X]mulrAC.
  by apply: ler_wpmul2r; [apply: (pd_psd pL) | rewrite expr2].
rewrite -!mulr_sumr.
have le3 : weight_of j * (2%:R * val t) - weight_of j * val b *
    (form (mx F d (nth [::] highs j)) V V + \sum_(i in G) form (info_of (p i) j) V V) <= weight_of j * lmax (part_of (output_of j) (invmx L)).
  rewrite -mulrA -mulrBr; apply: ler_wpmul2l; first exact: ltW.
  by apply: le_trans le1; rewrite ler_add2l ler_opp2; apply: ler_wpmul2l.
have := ler_sub (base_high e) le3; move=> h; apply: le_trans h _.
by rewrite (tangent_shape (val (prior_high pr)) (weight_of j) (val t) (val b)) lexx.
Qed.

Lemma gradientP pt g : gradient (objective pb) d m ws (outputs pb) Ss (prior_matrices pb) highs (prior_high pr) pt = Some g ->
  size g.1 = m /\ forall p (G : {set robot}), is_plan (team_of w) p ->
  value (contributed p G) <= val g.2 + \sum_(i in G) val (dots d g.1 (nth [::] (info_matrices pb) (p i))).
Proof.
rewrite /gradient; case: pt => [ys|j t v]; case: ifP => // /andP[cond kind].
  case eg: (all_some _) => [gs|//] [<-] /=; have [szg _] := all_some_nth 0%N ([::], d0) 0 eg; rewrite size_iota in szg.
  have sW : size [seq h.1 | h <- gs] = m by rewrite size_map.
  split=> // p G okp; rewrite value_sum; last by move=> e; move: kind; rewrite e.
  rewrite val_sum big_map (big_nth ([::], d0)) szg big_mkord.
  rewrite (eq_bigr (fun i => \sum_(j : target) val (mdot d (nth ([::], d0) gs j).1
      (nth [::] (nth [::] (info_matrices pb) (p i)) j)))); last first.
    move=> i _; rewrite dots_info //; apply: eq_bigr => j _.
    by rewrite (nth_map ([::], d0)) ?szg // mx_dot nth_info ?element_lt.
  rewrite [X in _ <= _ + X]exchange_big -big_split /=; apply: ler_sum => j _.
  by apply: (gradient_atP _ (all_some_iota ([::], d0) j eg) okp).
case eg: (gradient_at _ _ _ _ _ _ _ _ _ _) => [h|//] [<-] /=; rewrite size_mkseq; split=> // p G okp.
have e : objective pb = MaxEigenvalue by case: (objective pb) kind.
pose jt : target := Ordinal cond; apply: le_trans (value_le_target jt _ e) _.
apply: le_trans (gradient_atP (j:=jt) G eg okp) _; rewrite ler_add2l le_eqVlt; apply/orP; left; apply/eqP.
apply: eq_bigr => i _; rewrite dots_info ?size_mkseq // (bigD1 jt) //= big1 ?addr0 => [|k ne].
  by rewrite nth_mkseq // eqxx mx_dot nth_info ?element_lt.
by rewrite nth_mkseq // ifN ?mx_nil ?trmx0 ?mul0mx ?mxtrace0 //.
Qed.

(** ** Bounds by gains *)
(** Sums over the targets, weight by weight. *)
Lemma weight_groupsE (f : nat -> F) :
  \sum_(j : target) weight_of j * f j = \sum_(g <- weight_groups ws) val g.1 * \sum_(j <- g.2) f j.
Proof.
rewrite big_map; transitivity (\sum_(v <- undup ws) \sum_(j <- iota 0 m | nth d0 ws j == v) val (nth d0 ws j) * f j).
  rewrite (exchange_big_dep xpredT) //= [in RHS](_ : iota 0 m = index_iota 0 m); last by rewrite /index_iota subn0.
  rewrite [RHS](big_mkord xpredT); apply: eq_bigr => j _; rewrite -big_filter.
  have -> : [seq v <- undup ws | nth d0 ws j == v] = [:: nth d0 ws j].
    rewrite (eq_filter (fun v => eq_sym _ v)) filter_pred1_uniq ?undup_uniq // mem_undup mem_nth // weights_size //.
  by rewrite big_seq1.
apply: eq_bigr => v _; rewrite weights_size mulr_sumr [RHS]big_filter.
by apply: eq_bigr => j /eqP->.
Qed.

Lemma weight_groups_ok x : x \in weight_groups ws -> 0 < val x.1 /\ {in x.2, forall j, (j < m)%N}.
Proof.
move=> /mapP[v]; rewrite mem_undup => /(nthP d0)[j jm <-] ->; rewrite weights_size in jm; split=> [|k] /=.
  exact: (weight_gt0 (Ordinal jm)).
by rewrite mem_filter mem_iota weights_size => /andP[_ /andP[]].
Qed.

Let infos := info_matrices pb.
Let lacks := lacks_of d (owners w) infos.

Lemma lacks_ofP (b e : nat) l : nth None (nth [::] lacks b) e = Some l ->
  [/\ (b < size (owners w))%N, (e < size (owners w))%N
    & forall j : target, psd (info_of (inord b) j - info_of (inord e) j + (val (nth d0 l j))%:M)].
Proof.
set n := size (owners w); have szr : size (zip (owners w) infos) = n by rewrite size_zip size_map infos_size minnn.
rewrite /lacks /lacks_of; case: (ltnP b n) => [bn|ge]; last by rewrite (nth_default [::]) ?size_map ?szr ?nth_nil.
rewrite (nth_map (0%N, [::])) ?szr //; case: (ltnP e n) => [en|ge]; last by rewrite nth_default ?size_map ?szr.
rewrite (nth_map (0%N, [::])) ?szr //; case: ifP => // _; rewrite !nth_zip ?size_map ?infos_size //= each_someE => h.
have of_nat k : (k < n)%N -> ((inord k : element) : nat) = k.
  by move=> kn; rewrite inordK // /top_element prednK ?owners_pos.
split=> // j; have [_ at_] := all_some_nth ([::], [::]) d0 j h.
rewrite size_zip !info_row_size // minnn in at_; have {at_} := at_ (ltn_ord j).
rewrite nth_zip ?info_row_size //= !nth_info // => at_.
rewrite /info_of !of_nat // -mx_sub; apply: lackingP at_.
by apply: sub_symmetrical; apply: unpack_symmetrical.
Qed.

Lemma strongestP es M (e : element) (j : target) :
  strongest d m infos defects (traces_of d infos) lacks es = Some M -> (e : nat) \in es ->
  let R := mx F d (nth [::] M j) in [/\ symmetrical R, psd R & psd (R - info_of e j)].
Proof.
rewrite /strongest; set b := foldl _ _ _; rewrite each_someE; case el : (all_some _) => [ls|//].
case: ifP => // _ [<-] ees; rewrite nth_mkseq //; set more := foldl _ _ _.
have ei : index (e : nat) es \in iota 0 (size es) by rewrite mem_iota index_mem.
have [sz at_] := all_some_nth 0%N [::] (index (e : nat) es) el; rewrite index_mem nth_index // in at_.
have /lacks_ofP[bn _ /(_ j)] := at_ ees; rewrite inord_val => pl.
have nb : ((inord b : element) : nat) = b by rewrite inordK // /top_element prednK ?owners_pos.
rewrite nth_info // mx_telling -nb -/(info_of _ j).
have [d1 d2] := foldl_maxP F (fun l => nth d0 l j) ls (nth d0 (nth [::] defects b) j).
have lm : val (nth d0 (nth [::] ls (index (e : nat) es)) j) <= val more by apply: d2; rewrite mem_nth ?sz ?index_mem.
have [del0 pd] := deltaP (inord b) j; rewrite /delta nb in del0 pd.
have above (A : 'M[F]_d) x : psd (A + x%:M) -> x <= val more -> psd (A + (val more)%:M).
  by move=> pA le; rewrite -[val more](subrK x) addrC raddfD /= -addrA [x%:M + _]addrC; apply: psdD => //; apply: psd_scalar; rewrite subr_ge0.
split; [|exact: above pd d1|by rewrite addrAC; apply: above pl lm].
by rewrite /symmetrical linearD /= tr_scalar_mx info_symmetrical.
Qed.

Lemma mx_told (e : element) (j : target) :
  mx F d (nth [::] (nth [::] (told d infos defects) e) j) = info_of e j + (delta e j)%:M.
Proof.
have [sz at_] := all_some_nth [::] [::] e defectsE; rewrite -/infos in sz at_.
have el : (e < size infos)%N by rewrite size_map infos_size element_lt.
have [szr _] := all_some_nth [::] d0 j (at_ el); rewrite info_row_size ?element_lt // in szr.
rewrite /told (nth_map ([::], [::])) ?size_zip ?sz ?minnn // nth_zip ?sz //=.
rewrite (nth_map ([::], d0)) ?size_zip ?szr ?info_row_size ?element_lt ?minnn // nth_zip ?szr ?info_row_size ?element_lt //=.
by rewrite mx_telling nth_info ?element_lt.
Qed.

Lemma gains_leafP p groups a left g : objective pb = LogDet -> dle d0 (upper cl) -> is_plan (team_of w) p ->
  gains_leaf pb cl highs defects groups a left -> in_case p left -> (g < size (nth [::] groups a))%N ->
  value (contributed p (set_of w (nth [::] (nth [::] groups a) g))) <= val (upper cl).
Proof.
move=> kind u0 okp /allP h inc gl; have {h} := h _ (mem_nth [::] gl); set grp := nth [::] _ g.
set sts := [seq _ | es <- left]; set members := [seq i <- _ | _] => h.
pose c i : nat := p (robot_of w i); pose I i j := info_of (p (robot_of w i)) j.
have sumE j : \sum_(i <- members) I i j = \sum_(i in set_of w grp) info_of (p i) j.
  rewrite big_filter (_ : iota 0 (robots w) = index_iota 0 (robots w)); last by rewrite /index_iota subn0.
  rewrite (big_mkord (fun i => i \in grp) (fun i => I i j)); apply: eq_big => [i|i _]; first by rewrite inE.
  by rewrite /I robot_of_val.
have postE j : posterior prior_of info_of (contributed p (set_of w grp)) j = invmx (prior_of j) + \sum_(i <- members) I i j.
  by rewrite /posterior sum_contributed // sumE.
rewrite /value kind /logdet_value /logdet_penalty /logdet_base -sumrB.
rewrite (eq_bigr (fun j => weight_of j * (ln (\det (prior_of j)) + ln (\det (invmx (prior_of j) + \sum_(i <- members) I i j))))).
  2: by move=> j _; rewrite -mulrBr opprK postE.
apply: (check_group_gainsP (lnP kind) weight_ge0 prior_good highP _ weight_groupsE _ _ _ _ _ h).
- by move=> j; rewrite (nth_map [::]) ?size_map // nth_prior // mdetE.
- by move=> x /weight_groups_ok[x0 lt]; split=> //; apply: ltW.
- move=> x e; rewrite e; have [|x0 _] := @weight_groups_ok x; first by rewrite e mem_head.
  by apply: (product_roomP (lnP kind)) => //; rewrite -(val0 F) -(val_le F).
- move=> i; rewrite mem_filter mem_iota add0n => /andP[_ /andP[_ il]].
  by rewrite -{2}(robot_ofK il); apply: inc.
- move=> i; rewrite mem_filter mem_iota add0n => /andP[_ /andP[_ il]] j.
  have ci : c i \in nth [::] left i by rewrite -{2}(robot_ofK il); apply: inc.
  rewrite /Gains.known; case es : (nth None sts i) => [M|].
    have il' : (i < size left)%N by rewrite ltnNge; apply/negP => ge; rewrite nth_default ?size_map in es.
    rewrite (nth_map [::]) // in es; have [sR pR dR] := strongestP j es ci; split=> //; exact: info_symmetrical.
  have [del0 pI] := deltaP (p (robot_of w i)) j; rewrite mx_told; split=> //; first exact: info_symmetrical.
    by rewrite /symmetrical linearD /= tr_scalar_mx info_symmetrical.
  by rewrite addrAC subrr add0r; apply: psd_scalar.
by move=> j; rewrite -postE; apply: posterior_pd.
Qed.

(** What the scores of a point say, in the words of trees and covers. *)
Lemma tangentP p gs : is_plan (team_of w) p ->
  all_some [seq gradient (objective pb) d m ws (outputs pb) Ss (prior_matrices pb) highs (prior_high pr) pt | pt <- points pr] = Some gs ->
  forall q, (q < size gs)%N -> let t := nth ([::], d0) [seq point_scores d (info_matrices pb) g | g <- gs] q in
  size t.1 = size (owners w) /\
  forall G : {set robot}, value (contributed p G) <= val t.2 + \sum_(i in G) val (nth d0 t.1 (p i)).
Proof.
move=> okp eg q ql; rewrite (nth_map ([::], d0)) //= !size_map infos_size; split=> // G.
have [szg h] := all_some_nth (TracePoint [::]) ([::], d0) q eg; rewrite szg in ql; have [_ bound] := gradientP (h ql).
apply: le_trans (bound p G okp) _; rewrite ler_add2l le_eqVlt; apply/orP; left; apply/eqP.
by apply: eq_bigr => i _; rewrite (nth_map [::]) ?size_map ?infos_size ?element_lt.
Qed.

(** The scores of robots outside of a group are left out. *)
Lemma masked_bound p grp (q : tangent) x : is_plan (team_of w) p -> size q.1 = size (owners w) ->
  x <= val q.2 + \sum_(i in set_of w grp) val (nth d0 q.1 (p i)) ->
  x <= val q.2 + \sum_(i : robot) val (nth d0 (masked (owners w) grp q.1) (p i)).
Proof.
move=> okp sz le; apply: le_trans le _; rewrite ler_add2l le_eqVlt; apply/orP; left; apply/eqP.
rewrite big_mkcond; apply: eq_bigr => i _; rewrite inE (nth_map (0%N, d0)); last by rewrite size_zip sz minnn element_lt.
rewrite nth_zip //=; have -> : nth 0%N (owners w) (p i) = i.
  have := plan_owner i okp => /= /(congr1 (@nat_of_ord _)); rewrite /robot_of inordK //.
  by case/and3P: net_good => _ /allP own _; apply: own; apply: mem_nth; apply: element_lt.
by case: ifP => // _; rewrite val0.
Qed.

(** ** Inequalities of single targets *)
Let all_told := told d (info_matrices pb) defects.
(** A set is worth at most a base set and what each of its other elements gains beside that alone. *)
Lemma base_boundP (j : target) base p (G : {set robot}) : objective pb = LogDet -> is_plan (team_of w) p ->
  holds p G (base_bound d ws (prior_matrices pb) highs (info_matrices pb) all_told j base).2 (target_value j (contributed p G)).
Proof.
move=> e okp; split; first by rewrite /= size_map size_iota size_map infos_size.
rewrite /base_bound; set es := iota 0 _; set row := fun e => nth [::] (nth [::] all_told e) j.
set Kd := foldl _ _ _; set gain := fun e => if _ then d0 else _.
pose S (x : element) := (x : nat) \in base; pose M (x : element) := info_of x j + (delta x j)%:M.
have Ms x : symmetrical (M x) by rewrite /M /symmetrical linearD /= tr_scalar_mx info_symmetrical.
have Mp x : psd (M x) by case: (deltaP x j).
have rowE (x : element) : mx F d (row x) = M x := mx_told x j.
have sz : size (info_matrices pb) = (top_element w).+1 by rewrite size_map infos_size /top_element prednK ?owners_pos.
have KE : mx F d Kd = mx F d (nth [::] highs j) + \sum_(x | S x) M x.
  have gen A s : mx F d (foldl (fun K e => if nilp (row e) then K else madd d K (row e)) A s) =
      mx F d A + \sum_(e <- s) mx F d (row e).
    elim: s A => [|x s IH] A /=; first by rewrite big_nil addr0.
    rewrite IH big_cons; case: nilP => [->|_]; last by rewrite mx_add addrA.
    by rewrite mx_nil add0r.
  rewrite /Kd gen; congr (_ + _); rewrite big_filter /es sz.
  rewrite (_ : iota 0 _ = index_iota 0 (top_element w).+1); last by rewrite /index_iota subn0.
  by rewrite big_mkord; apply: eq_bigr => x _; apply: rowE.
have [sP pP] := prior_good j; have [sH pH] := highP j; have [sL pL] := posterior_pd G okp j.
set L := posterior _ _ _ j in sL pL; set K := mx F d Kd in KE.
have sK : symmetrical K.
  by rewrite KE /symmetrical linearD /= sH; congr (_ + _); apply: symmetrical_sum => x _; apply: Ms.
have pK : pd K by rewrite KE; apply: pd_add; [exact: pd_above (pd_inv sP pP) pH | apply: psd_sum => x _].
have P0 := det_gt0 sP pP; have K0 := det_gt0 sK pK.
pose free := [seq i <- enum G | ~~ S (p i)].
have split : \sum_(i in G) M (p i) = \sum_(i in G | S (p i)) M (p i) + \sum_(i <- free) M (p i).
  by rewrite (bigID (fun i => S (p i))) /= /free big_filter big_enum_cond.
have mono : ln (\det L) <= ln (\det (K + \sum_(i <- free) M (p i))).
  apply: (logdet_mono (lnP e)) => //.
    rewrite /symmetrical linearD /= sK; congr (_ + _); apply: symmetrical_sum => i _; exact: Ms.
  have -> : K + \sum_(i <- free) M (p i) - L = (mx F d (nth [::] highs j) - invmx (prior_of j)) +
      ((\sum_(x | S x) M x - \sum_(i in G | S (p i)) M (p i)) + \sum_(i in G) (M (p i) - info_of (p i) j)).
    rewrite /L /posterior sum_contributed // sumrB split KE; set a := mx F d (nth _ highs j); set q := \sum_(x | S x) _.
    set f := \sum_(i <- free) _; set u := \sum_(i in G | _) _; set t := \sum_(i in G) info_of _ _.
    have -> : q - u + (u + f - t) = q + f - t by rewrite -[u + f - t]addrA [q - u + _]addrA subrK addrA.
    by rewrite opprD -[a + q + f]addrA addrACA.
  apply: psdD => //; apply: psdD.
    have -> : \sum_(i in G | S (p i)) M (p i) = \sum_(x | S x) (if x \in contributed p G then M x else 0).
      rewrite big_mkcondr -(sum_contributed G (fun x => if S x then M x else 0) okp) big_mkcond [RHS]big_mkcond.
      by apply: eq_bigr => x _; case: (x \in _); case: (S x).
    rewrite -sumrB; apply: psd_sum => x _; case: ifP => _; last by rewrite subr0.
    by rewrite subrr => y; rewrite /form mulmx0 mul0mx mxE.
  apply: psd_sum => i _; rewrite /M addrAC subrr add0r; apply: psd_scalar; by case: (deltaP (p i) j).
have gains := logdet_sum_gains (lnP e) sK pK (fun i (_ : i \in free) => conj (Ms (p i)) (Mp (p i))).
rewrite /target_value e -/L mulrN opprK -mulrDr val_mul nth_prior // -/(weight_of j).
have le0 : ln (\det (prior_of j)) + ln (\det K) <=
    val (log_quotient_up 110 400 (dmul (mdet d (unpack d (nth [::] (priors pb) j))) (mdet d Kd)) d1).
  have := @log_quotient_upP F ln (lnP e) 110 400 (dmul (mdet d (unpack d (nth [::] (priors pb) j))) (mdet d Kd)) d1.
  rewrite val_mul !mdetE -/(prior_of j) -/K val1 divr1 (lnM (lnP e)) //; apply; [exact: mulr_gt0 | exact: ltr01].
have each i : val (nth d0 [seq gain x | x <- es] (p i)) =
    weight_of j * (if S (p i) || nilp (row (p i)) then 0 else val (log_quotient_up 110 400 (mdet d (madd d Kd (row (p i)))) (mdet d Kd))).
  rewrite (nth_map 0%N) ?size_iota ?sz ?ltn_ord // nth_iota ?sz ?ltn_ord // add0n /gain -/(S (p i)).
  by case: ifP => _; rewrite ?val0 ?mulr0 // val_mul.
rewrite /= (eq_bigr _ (fun i _ => each i)) -mulr_sumr -mulrDr; apply: ler_wpmul2l; first exact: weight_ge0.
apply: le_trans (_ : ln (\det (prior_of j)) + (ln (\det K) + \sum_(i <- free) (ln (\det (K + M (p i))) - ln (\det K))) <= _).
  by rewrite ler_add2l; apply: le_trans mono gains.
rewrite addrA; apply: ler_add => //; rewrite /free big_filter big_enum_cond /= big_mkcondr; apply: ler_sum => i _.
case Si: (S (p i)) => //=; case: nilP => [nil|_]; first by rewrite -rowE nil mx_nil addr0 subrr.
have KM0 : 0 < \det (K + M (p i)).
  by apply: det_gt0; [rewrite /symmetrical linearD /= sK Ms | apply: pd_add].
have := @log_quotient_upP F ln (lnP e) 110 400 (mdet d (madd d Kd (row (p i)))) (mdet d Kd).
rewrite !mdetE mx_add rowE -/K => /(_ KM0 K0); apply: le_trans.
by rewrite -(lnV (lnP e)) // -lnM ?invr_gt0 //; exact: (lnP e).
Qed.

Section Inequalities.
Variables (p : {ffun robot -> element}) (tangents : seq target_bound).
Let ls := lemma_list (rows_part pr).
Hypothesis okp : is_plan (team_of w) p.
Hypothesis tangentsE : tangent_bounds (objective pb) d m ws (outputs pb) Ss (prior_matrices pb) highs (info_matrices pb)
  (prior_high pr) (if objective pb is LogDet then all_told else [::]) (tangent_list (rows_part pr)) = Some tangents.
Hypothesis lemmas_ok : all (fun l => (lemma_target l < m)%N && check_lemma w tangents l) ls.
Let bounds := tangents ++ [seq lemma_bound l | l <- ls].

Lemma listed_tangentP k (G : {set robot}) : (k < size tangents)%N -> exists2 j : target,
  (inequality_of tangents k).1 = j & holds p G (inequality_of tangents k).2 (target_value j (contributed p G)).
Proof.
have [szt h] := all_some_nth (0%N, MatrixTouch [::]) (0%N, ([::], d0)) k tangentsE; rewrite szt => kl; move: (h kl); rewrite /inequality_of.
case: ifP => // jm; case et: (nth (0%N, MatrixTouch [::]) (tangent_list (rows_part pr)) k).2 => [y|t v|base]; last first.
  case e: (objective pb) => // -[<-]; exists (Ordinal jm) => //; exact: (base_boundP (Ordinal jm) base G e okp).
all: case eg: (gradient_at _ _ _ _ _ _ _ _ _ _) => [g|//] [<-].
all: exists (Ordinal jm) => //; split; first by rewrite /= size_map size_map infos_size.
all: apply: le_trans (gradient_atP (j:=Ordinal jm) G eg okp) _; rewrite ler_add2l le_eqVlt; apply/orP; left; apply/eqP.
all: by apply: eq_bigr => i _ /=; rewrite (nth_map [::]) ?size_map ?infos_size ?element_lt.
Qed.

Lemma inequalityP k (G : {set robot}) : (k < size bounds)%N -> exists2 j : target,
  (inequality_of bounds k).1 = j & holds p G (inequality_of bounds k).2 (target_value j (contributed p G)).
Proof.
rewrite /inequality_of nth_cat size_cat size_map; case: (ltnP k (size tangents)) => [kl _|ge]; first exact: listed_tangentP.
rewrite -ltn_subLR // => kl; set l0 := ListedLemma 0 [::] d0 (LemmaLeaf 0).
rewrite (nth_map l0) //; set l := nth l0 ls _; have /andP[jm good] := (all_nthP l0 lemmas_ok) _ kl.
exists (Ordinal jm) => //; apply: (check_lemmaP net_good okp good) => k' k'l ek.
by have [j ej] := listed_tangentP G k'l; rewrite (_ : j = Ordinal jm) //; apply: ord_inj; rewrite /= -ej ek.
Qed.

Lemma rowP ks (G : {set robot}) : row_ok (objective pb) m bounds ks ->
  holds p G (row_sum w bounds ks) (value (contributed p G)).
Proof.
move=> /andP[/allP inr js].
pose x k := if insub (inequality_of bounds k).1 is Some j then target_value j (contributed p G) else 0.
have hx k : k \in ks -> holds p G (inequality_of bounds k).2 (x k).
  move=> /inr kl; have [j ej] := inequalityP G kl; rewrite /x ej valK.
  by [].
have [sz le] := row_sumP hx; split=> //; apply: le_trans le.
move: js; case e: (objective pb) => [||].
- move=> /eqP js; rewrite value_sum ?e // le_eqVlt; apply/orP; left; apply/eqP.
  rewrite -(big_map (fun k => (inequality_of bounds k).1) xpredT
    (fun j => if insub j is Some j' then target_value j' (contributed p G) else 0)) js.
  rewrite (_ : iota 0 m = index_iota 0 m); last by rewrite /index_iota subn0.
  by rewrite big_mkord; apply: eq_bigr => j _; rewrite valK.
- move=> /eqP js; rewrite value_sum ?e // le_eqVlt; apply/orP; left; apply/eqP.
  rewrite -(big_map (fun k => (inequality_of bounds k).1) xpredT
    (fun j => if insub j is Some j' then target_value j' (contributed p G) else 0)) js.
  rewrite (_ : iota 0 m = index_iota 0 m); last by rewrite /index_iota subn0.
  by rewrite big_mkord; apply: eq_bigr => j _; rewrite valK.
case: ks inr hx {sz} => [//|k [|k' ks]] //= inr hx jm; rewrite big_seq1 /x insubT.
exact: value_le_target.
Qed.

(** ** Values that plans can have *)
Definition sees_target (G : {set robot}) (j : target) : bool := [exists i in G, seen pb j (p i)].

Lemma unseen_value (G : {set robot}) j : objective pb = Trace -> ~~ sees_target G j -> target_value j (contributed p G) = 0.
Proof.
move=> e /existsPn none; rewrite /target_value e /posterior sum_contributed // big1 => [|i iG].
  by rewrite addr0 invmxK subrr.
have := none i; rewrite iG /= negbK => /allP zero; rewrite /info_of -nth_info ?element_lt //.
apply/matrixP => a b; rewrite !mxE /get; set A := nth [::] (nth [::] _ _) j in zero *.
have [al|ge] := ltnP a (size A); last by rewrite [nth [::] A a]nth_default // nth_nil val0.
have /allP row := zero _ (mem_nth [::] al).
have [bl|ge] := ltnP b (size (nth [::] A a)); last by rewrite nth_default // val0.
exact: is_zeroP (row _ (mem_nth d0 bl)).
Qed.

Lemma worth_aloneP (G : {set robot}) (j : target) i x : objective pb = Trace -> i \in G ->
  worth_alone pb lows defects j (p i) = Some x -> val x <= target_value j (contributed p G).
Proof.
move=> e iG; rewrite /worth_alone; set M := madd d _ _; case ey: (trace_inverse_up _ _ _ _) => [y|//] [<-].
have mM : mx F d M = (mx F d (nth [::] lows j) - ((robots w).+1%:R * val (worst_defect pb defects j))%:M) + info_of (p i) j.
  by rewrite mx_add mx_sub mx_scalar val_mul val_nat nth_info ?element_lt.
have [sl pl] := lowP j; have sM : symmetrical (mx F d M).
  by rewrite mM /symmetrical !linearD linearN /= tr_scalar_mx sl info_symmetrical.
have [pM le] := trace_inverse_upP sM ey; have [sL pL] := posterior_pd G okp j.
rewrite /target_value e val_mul val_sub -mulrBr; apply: ler_wpmul2l; first exact: weight_ge0.
rewrite trace_withP trace_squareP nth_prior // -/(prior_of j) -/(output_of j); apply: ler_sub => //.
apply: le_trans le; rewrite trace_squareP; apply: trace_inverse_antitone => //.
set D := _ * _ in mM; rewrite mM /posterior sum_contributed // (big_setD1 i) //=.
rewrite (rearrange3 _ _ _ _ _ (\sum_(k in G :\ i) (delta (p k) j)%:M)); apply: psdD => //.
rewrite -big_split /=; apply: psdD; first by apply: psd_sum => k _; case: (deltaP (p k) j).
rewrite scalar_sum -scalar_sub; apply: psd_scalar; rewrite subr_ge0; exact: worst_ge.
Qed.

Lemma spaced_value top (G : {set robot}) : enough_shown pb cl pr lows defects = Some top ->
  value (contributed p G) <= val top -> value (contributed p G) <= val (upper cl).
Proof.
rewrite /enough_shown; case: (spacing _) => [[count ks]|]; last by move=> [<-].
case e: (objective pb) => //; set pairs := flatten _; case ey: (all_some _) => [ys|//].
set least := dopp _; set most := dmax _ _; case: ifP => // /andP[l0 /allP bounded] [<-]; case: ifP => // cm.
rewrite val_max le_maxr => /orP[//|low]; set S := contributed p G in low *.
rewrite (val_le F) val0 in l0; rewrite (val_le F) val_mul val_nat in cm.
have most0 : 0 <= val most by rewrite val_max val0 le_maxr lexx.
have seen_at j : sees_target G j -> exists2 i, i \in G & seen pb j (p i) by move=> /existsP[i /andP[iG se]]; exists i.
have above j : sees_target G j -> val least <= target_value j S.
  move=> /seen_at[i iG se]; have pin : ((j : nat), (p i : nat)) \in pairs.
    apply/flattenP; exists [seq ((j : nat), e') | e' <- iota 0 (size (owners w)) & seen pb j e'].
      by apply/mapP; exists (j : nat); rewrite // mem_iota add0n ltn_ord.
    by apply/mapP; exists (p i : nat); rewrite // mem_filter se mem_iota add0n element_lt.
  have [szy h] := all_some_nth (0%N, 0%N) d0 (index ((j : nat), (p i : nat)) pairs) ey.
  have := h; rewrite index_mem => /(_ pin); rewrite nth_index //= => {h} h.
  apply: le_trans (worth_aloneP e iG h); rewrite /least val_opp ler_oppl -val_opp.
  by apply: (largest_ofP F (fun i => dopp (nth d0 ys i))); rewrite mem_iota add0n szy index_mem.
have below_most j : sees_target G j -> target_value j S <= val most.
  move=> /seen_at[i iG se]; have := bounded j; rewrite mem_iota add0n ltn_ord => /(_ isT)/implyP h.
  have /h/hasP[k kin /and3P[kl /eqP tj /allP zeros]] : has (seen pb j) (iota 0 (size (owners w))).
    by apply/hasP; exists (p i : nat); rewrite // mem_iota add0n element_lt.
  have kb : (size tangents + k < size bounds)%N by rewrite /bounds size_cat size_map ltn_add2l.
  have [j' ej' [_ le]] := inequalityP G kb.
  have eb : inequality_of bounds (size tangents + k) = lemma_bound (lemma_at pr k).
    rewrite /inequality_of nth_cat ifN ?addKn; last by rewrite -leqNgt leq_addr.
    by rewrite (nth_map (ListedLemma 0 [::] d0 (LemmaLeaf 0))).
  rewrite eb /= tj in ej'; have jj : j = j' by apply: ord_inj.
  rewrite -jj eb /= big1 ?addr0 in le; last first.
    move=> i' _; have [il|ge] := ltnP (p i') (size (lemma_scores (lemma_at pr k))); last by rewrite nth_default // val0.
    exact: is_zeroP (zeros _ (mem_nth d0 il)).
  apply: le_trans le _; rewrite val_max le_maxr; apply/orP; right.
  exact: (largest_ofP F (fun k => lemma_constant (lemma_at pr k)) kin).
pose n := #|[pred j | sees_target G j]|.
have sumE : value S = \sum_(j | sees_target G j) target_value j S.
  rewrite value_sum ?e // (bigID (sees_target G)) /= [X in _ + X]big1 ?addr0 // => j; exact: unseen_value.
have lo : n%:R * val least <= value S.
  rewrite sumE mulr_natl -sumr_const; apply: ler_sum => j; exact: above.
have hi : value S <= n%:R * val most.
  rewrite sumE mulr_natl -sumr_const; apply: ler_sum => j; exact: below_most.
have nc : (n <= count)%N.
  rewrite leqNgt; apply/negP => gt; have := le_trans lo low; rewrite val_sub val_mul val_nat leNgt => /negP[].
  apply: lt_le_trans (_ : count.+1%:R * val least <= _); first by rewrite ltr_subl_addr ltr_addl val_tiny_gt0.
  by apply: ler_wpmul2r; rewrite // ler_nat.
apply: le_trans hi _; apply: le_trans cm; apply: ler_wpmul2r; by rewrite // ler_nat.
Qed.
End Inequalities.

Theorem upper_sound p : check_upper_part pb cl pr lows highs defects -> is_plan (team_of w) p ->
  worst_case (team_of w) value p <= val (upper cl).
Proof.
rewrite /check_upper_part; set groups := [seq seeing_groups w a | a <- listed pr].
case eg : (all_some _) => [gs|//]; case et : (tangent_bounds _ _ _ _ _ _ _ _ _ _ _ _) => [tangents|//].
case es : (enough_shown _ _ _ _ _) => [top|//].
set pts := [seq point_scores _ _ _ | _ <- gs]; set bounds := tangents ++ _.
set cuts := cut_bounds _ _ _ _; set rows := row_bounds _ _ _ _.
set covers := cover_bounds _ _ _ _ => /and5P[lok /allP range /allP cover_range u0 /and3P[lemmas_ok /allP rows_ok tree]] okp.
have at_ := tangentP okp eg; rewrite -/pts in at_.
suff shown : worst_case (team_of w) value p <= val top.
  have [a oka ea] := worst_case_attained (team_of w) value p.
  have [i ei] := team_value_attained (team_of w) value p a (ord0 : robot).
  by rewrite ea ei in shown *; apply: (spaced_value okp et lemmas_ok es shown).
have top_ok : val (upper cl) <= val top.
  move: es; rewrite /enough_shown; case: (spacing _) => [[count ks]|]; last by move=> [<-].
  case: (objective pb) => //; case: (all_some _) => [ys|//]; cbv zeta; case: ifP => // _ [<-]; case: ifP => // _.
  by rewrite val_max le_maxr lexx.
have t0 : dle d0 top by rewrite (val_le F); apply: le_trans top_ok; rewrite -(val_le F).
apply: (upper_treeP net_good value0 lok erefl _ okp _ _ _ _ tree t0) => [|k|k|k|a left g]; rewrite ?size_map; try move=> kl.
- rewrite all_cat; apply/andP; split.
    apply/allP => c /mapP[[[a g] k] cin ->] /=; have /and3P[_ _ kl] := range _ cin.
    by rewrite size_map size_zip (proj1 (at_ _ kl)) minnn.
  apply/allP => c /mapP[[[a g] ks] rin ->] /=; have /and3P[_ _ okr] := rows_ok _ rin.
  by have [/= sz _] := rowP okp et lemmas_ok set0 okr; rewrite size_map size_zip sz minnn.
- rewrite /cut_of nth_cat; case: (ltnP k (size cuts)) => kc.
    rewrite (nth_map (0%N, 0%N, 0%N)); last by rewrite size_map in kc.
    have := range _ (mem_nth (0%N, 0%N, 0%N) _); rewrite size_map in kc; move=> /(_ _ kc).
    case: (nth _ _ k) => [[a g] q] /and3P[al gl ql] /=; have [sz bound] := at_ q ql.
    exact: masked_bound okp sz (bound _).
  rewrite size_cat !size_map in kl; rewrite size_map in kc; have kr : (k - size (cut_list pr) < size (row_list (rows_part pr)))%N.
    by rewrite ltn_subLR.
  rewrite size_map (nth_map (0%N, 0%N, [::])) //; have := rows_ok _ (mem_nth (0%N, 0%N, [::]) kr).
  case: (nth _ _ _) => [[a g] ks] /and3P[al gl okr] /=.
  have [sz le] := rowP okp et lemmas_ok (set_of w (nth [::] (nth [::] groups a) g)) okr.
  exact: masked_bound okp sz le.
- by rewrite /cover_of (nth_map (0%N, [::], [::])) //; case: (nth _ _ k) => [[a out] ks] /=; rewrite size_map size_iota.
- rewrite /cover_of (nth_map (0%N, [::], [::])) //.
  have := cover_range _ (mem_nth (0%N, [::], [::]) kl); case: (nth _ _ k) => [[a elements] ks].
  move=> /and4P[al /nilP sees /eqP sz /allP ksl] /=; rewrite /groups (nth_map ([::], [::])) //.
  apply: (failed_coverP net_good okp) => //; first exact: (allP lok _ (mem_nth _ al)).
  - by rewrite size_map size_iota.
  - by rewrite size_map sz /groups (nth_map ([::], [::])).
  by move=> t /mapP[q /ksl ql ->]; apply: at_.
move: kl; case: ifP => // used inl inc gl; apply: le_trans top_ok; apply: gains_leafP inl inc gl => //; by move: used; rewrite /gains_are_used; case: (objective pb).
Qed.

(** ** The plan's worst case *)
Lemma nth_plan (i : robot) : (plan_of i : nat) = nth 0%N (plan cl) i.
Proof.
case/and3P: plan_good => /eqP sz /allP lt _; rewrite ffunE inordK //.
have := lt (nth 0%N (plan cl) i); rewrite mem_nth ?sz ?ltn_ord // => /(_ isT) h.
by apply: leq_trans h _; rewrite /top_element prednK ?owners_pos.
Qed.

Lemma plan_ofP : is_plan (team_of w) plan_of.
Proof.
apply/forallP => i; rewrite /= nth_plan; apply/eqP/val_inj; rewrite /= /robot_of.
case/and3P: plan_good => _ _ /allP/(_ (i : nat)); rewrite mem_iota add0n ltn_ord => /(_ isT)/eqP ->.
by rewrite inordK.
Qed.

Let rows := [seq nth [::] (info_matrices pb) e | e <- plan cl].
Definition plan_loss (j : nat) : dyadic := dsum [seq nth d0 (nth [::] defects e) j | e <- plan cl].
Let start := mkseq (fun j => msub d (nth [::] lows j) (mscalar d (plan_loss j))) m.
Let add := add_robot d m rows.
Let plan_room := dsub (base_low pb pr) (lower cl).
Local Notation below := (fun i => (i < robots w)%N).
Local Notation info_at i j := (info_of (plan_of (robot_of w i)) j).

Definition fam (s : seq dmat) (j : target) : 'M[F]_d := mx F d (nth [::] s j).
(** What a case knows of target [j] when the robots of the list [T] see together. *)
Definition known (T : seq nat) (j : target) : 'M[F]_d :=
  mx F d (nth [::] lows j) - (val (plan_loss j))%:M + \sum_(i <- T) info_at i j.

Lemma plan_size : size (plan cl) = robots w.
Proof. by case/and3P: plan_good => /eqP. Qed.

Lemma rows_at i (j : target) : (i < robots w)%N -> mx F d (nth [::] (nth [::] rows i) j) = info_at i j.
Proof.
move=> il; have e := nth_plan (robot_of w i); rewrite robot_ofK // in e.
by rewrite (nth_map 0%N) ?plan_size // -e nth_info ?element_lt.
Qed.

Lemma famE T j : all below T -> fam (foldl add start T) j = known T j.
Proof.
elim/last_ind: T => [|T i IH] b.
  by rewrite /fam /known big_nil addr0 nth_mkseq // mx_sub mx_scalar.
move: b; rewrite all_rcons => /andP[il b].
rewrite -cats1 foldl_cat /= /fam nth_mkseq // mx_add rows_at // -/(fam _ j) IH //.
by rewrite /known big_cat big_seq1 /= addrA.
Qed.

Lemma known_symmetrical T j : symmetrical (known T j).
Proof.
rewrite /symmetrical /known linearD linearB /= tr_scalar_mx (proj1 (lowP j)); congr (_ + _).
by apply: symmetrical_sum => i _; apply: info_symmetrical.
Qed.

Lemma plan_lossE j : val (plan_loss j) = \sum_(i : robot) delta (plan_of i) j.
Proof.
rewrite /plan_loss val_sum big_map (big_nth 0%N) plan_size big_mkord; apply: eq_bigr => i _.
by rewrite /delta nth_plan.
Qed.

(** The group's information, compared with what the case knows. *)
Lemma known_below T (G : {set robot}) j : uniq T -> all below T -> (forall i, i \in T -> robot_of w i \in G) ->
  exists2 R, psd R & posterior prior_of info_of (contributed plan_of G) j =
    known T j + (invmx (prior_of j) - mx F d (nth [::] lows j)) + R.
Proof.
move=> uT bT TG; pose S := set_of w T.
have SG : S \subset G by apply/subsetP => i; rewrite inE => /TG; rewrite robot_of_val.
have sumT : \sum_(i <- T) info_at i j = \sum_(i in S) info_of (plan_of i) j.
  rewrite -(big_map (robot_of w) xpredT (fun i => info_of (plan_of i) j)) -[RHS]big_enum /=.
  apply: perm_big; apply: uniq_perm; rewrite ?enum_uniq //.
    rewrite map_inj_in_uniq // => x y xT yT /(congr1 (@nat_of_ord _)); rewrite !robot_ofK //; exact: (allP bT).
  move=> i; rewrite mem_enum inE; apply/mapP/idP => [[x xT ->]|iT]; last by exists (i : nat); rewrite ?robot_of_val.
  by rewrite robot_ofK //; apply: (allP bT).
exists (\sum_(i in G :\: S) (info_of (plan_of i) j + (delta (plan_of i) j)%:M) +
        (\sum_(i | i \notin G :\: S) delta (plan_of i) j)%:M).
  apply: psdD; first by apply: psd_sum => i _; case: (deltaP (plan_of i) j).
  by apply: psd_scalar; apply: sumr_ge0 => i _; case: (deltaP (plan_of i) j).
rewrite /posterior sum_contributed ?plan_ofP // (big_setID S) /= (setIidPr SG) /known sumT plan_lossE.
have -> : (\sum_(i : robot) delta (plan_of i) j)%:M = (\sum_(i | i \notin G :\: S) delta (plan_of i) j)%:M +
    (\sum_(i in G :\: S) delta (plan_of i) j)%:M :> 'M[F]_d.
  rewrite (bigID (fun i => i \in G :\: S)) /= addrC.
  by apply/matrixP => i k; rewrite !mxE mulrnDl.
rewrite big_split /= scalar_sum; exact: rearrange2.
Qed.

Lemma good_above A L : good A -> (forall j, symmetrical (L j)) -> (forall j, exists2 R, psd R & L j = A j + R) ->
  penalty L <= penalty A.
Proof.
by move=> gA sL h; apply: penalty_antitone => // j; have [R pR ->] := h j; rewrite addrC addKr.
Qed.

Lemma base_lowP : val (base_low pb pr) <= base.
Proof.
rewrite /base_low /base; case e: (objective pb).
- rewrite /trace_total val_sum_iota /trace_base; apply: ler_sum => j _.
  by rewrite val_mul trace_withP trace_squareP nth_prior.
- rewrite /logdet_total_low val_opp val_sum_iota /logdet_base -sumrN; apply: ler_sum => j _.
  rewrite val_mul -mulrN; apply: ler_wpmul2l; first exact: weight_ge0.
  have [s p] := prior_good j; have P0 := det_gt0 s p; rewrite nth_prior // ler_oppl -(lnV (lnP e)) // -[_^-1]mul1r.
  rewrite -{1}(val1 F) -(mdetE F d (unpack d _)); apply: log_quotient_upP; rewrite ?val1 ?ltr01 ?mdetE //; exact: lnP.
move: range_good; rewrite /prior_range_ok e => /andP[_ /hasP[j]]; rewrite mem_iota add0n => /andP[_ jm] npd.
pose k : target := Ordinal jm; pose M := part_of (output_of k) (prior_of k).
apply: le_trans (le_largest (fun j => weight_of j * lmax (counting output_of j (prior_of j))) k).
rewrite leNgt; apply: contra npd => lt; rewrite /counting -/M in lt.
have [s _] := prior_good k; have [eA /(_ (prior_low pr)) sm] := covarianceP k.
apply/(is_pdP sm); rewrite mx_sub mx_scalar mx_scale eA -/M => v v0.
have /(lmaxP e (symmetrical_part (output_of k) s))/(_ v) := lexx (lmax M); rewrite !formBm !form_scalar formZm !subr_ge0 => le.
rewrite subr_gt0; apply: (@le_lt_trans _ _ (weight_of k * lmax M * dot v v)).
  rewrite -mulrA; exact: (ler_wpmul2l (weight_ge0 k) le).
by rewrite ltr_pmul2r ?dot_gt0.
Qed.

Lemma enough_value (S : {set element}) : penalty (posterior prior_of info_of S) <= val plan_room ->
  val (lower cl) <= value S.
Proof.
rewrite /plan_room val_sub ler_subr_addr addrC -ler_subr_addr => h; rewrite valueE.
by apply: le_trans h _; rewrite ler_add2r base_lowP.
Qed.

Section Lower.
Let kind := objective pb.

Lemma trace_upP p s y : trace_up d m ws Ss p s = Some y -> (forall j, symmetrical (fam s j)) ->
  good (fam s) /\ trace_penalty weight_of output_of (fam s) <= val y.
Proof.
rewrite /trace_up; case e: (all_some _) => [ys|//] [<-] sym.
have h j := trace_inverse_upP (sym j) (all_some_iota d0 j e).
split=> [j|]; first by split=> //; case: (h j).
rewrite val_sum_iota; apply: ler_sum => j _; rewrite val_mul; apply: ler_wpmul2l; first exact: weight_ge0.
by rewrite /counting -trace_squareP; case: (h j).
Qed.

Let groups := weight_groups ws.

Lemma logdet_upP k p s y : kind = LogDet -> logdet_up d m groups k p s = Some y -> (forall j, symmetrical (fam s j)) ->
  good (fam s) /\ logdet_penalty ln weight_of (fam s) <= val y.
Proof.
move=> e; rewrite /logdet_up; case: ifP => // /allP defs; cbv zeta; case: ifP => // /allP pos [<-] sym.
have pds (j : target) : pd (fam s j) by apply/(is_pdP (sym j)); apply: defs; rewrite mem_iota add0n ltn_ord.
split=> [j|]; first by split.
pose det j := val (mdet d (nth [::] s j)).
have detE (j : target) : det j = \det (fam s j) by rewrite /det mdetE.
have det0 j : (j < m)%N -> 0 < det j.
  by move=> jm; have := det_gt0 (sym (Ordinal jm)) (pds (Ordinal jm)); rewrite -detE.
rewrite /logdet_penalty (eq_bigr (fun j : target => weight_of j * - ln (det j))) => [|j _]; last by rewrite detE.
rewrite (weight_groupsE (fun j => - ln (det j))) val_sum big_map /determinant_products.
rewrite [X in _ <= X]big_map big_seq [X in _ <= X]big_seq; apply: ler_sum => g gin; rewrite val_mul.
have lt j : j \in g.2 -> (j < m)%N.
  by move: gin => /mapP[v _ ->] /=; rewrite mem_filter mem_iota weights_size => /andP[_ /andP[]].
have w0 : 0 <= val g.1.
  move: gin => /mapP[v]; rewrite mem_undup => /(nthP d0)[j jm <-] -> /=.
  by rewrite weights_size in jm; apply: (weight_ge0 (Ordinal jm)).
have le := pos _ (map_f _ gin); rewrite /= in le; apply: ler_wpmul2l w0 _ _ _; rewrite sumrN.
have at_ j : (j < m)%N -> nth d0 [seq mdet d (nth [::] s j) | j <- iota 0 m] j = mdet d (nth [::] s j).
  by move=> jm; rewrite (nth_map 0%N) ?size_iota // nth_iota.
apply: le_trans (log_product_upP (lnP e) k p _ le); rewrite ?big_map.
  rewrite ler_opp2 big_seq [X in _ <= X]big_seq le_eqVlt; apply/orP; left; apply/eqP.
  by apply: eq_bigr => j /lt jm; rewrite at_.
by move=> x /mapP[j /lt jm ->]; rewrite at_ //; apply: det0.
Qed.

Lemma eigen_enoughP x s : eigen_enough d m ws Ss x s -> (forall j, symmetrical (fam s j)) ->
  kind = MaxEigenvalue -> good (fam s) /\ maxeig_penalty weight_of output_of lmax (fam s) <= val x.
Proof.
rewrite /eigen_enough (val_lt F) val0 => /andP[x0 /allP h] sym e.
have each (j : target) : pd (fam s j) /\ psd (val x *: fam s j - weight_of j *: ((output_of j)^T *m output_of j)).
  have := h j; rewrite mem_iota add0n ltn_ord => /(_ isT)/andP[h1 h2]; split; first by apply/(is_pdP (sym j)).
  have sm : symmetrical (mx F d (msub d (mscale d x (nth [::] s j)) (weighted_square d (nth d0 ws j) (nth None Ss j)))).
    apply: sub_symmetrical; first by apply: scale_symmetrical; apply: sym.
    by rewrite mx_weighted_square squareP /symmetrical linearZ /= trmx_mul trmxK.
  by have := is_psdP sm h2; rewrite mx_sub mx_scale mx_weighted_square squareP.
split=> [j|]; first by split=> //; case: (each j).
apply: largest_le => // j; have [pA pB] := each j.
exact: (largest_eigenvalue_below (lmaxP e (j:=j)) (sym j) pA (weight_gt0 j) x0 pB).
Qed.

Lemma penalty_upP x s e y : penalty_up kind d m ws Ss groups x s e = Some y -> (forall j, symmetrical (fam s j)) ->
  good (fam s) /\ penalty (fam s) <= val y.
Proof.
rewrite /penalty_up /penalty -/kind; case ek: kind => h sym; [exact: trace_upP h sym | exact: logdet_upP ek h sym |].
move: h; rewrite /eigen_up; case: ifP => // h [<-]; exact: eigen_enoughP.
Qed.

Lemma withinP x s : penalty_within kind d m ws Ss groups x s -> (forall j, symmetrical (fam s j)) ->
  good (fam s) /\ penalty (fam s) <= val x.
Proof.
rewrite /penalty_within => h sym.
have some : has (fun e => is_at_most (penalty_up kind d m ws Ss groups x s e) x) precisions ->
    good (fam s) /\ penalty (fam s) <= val x.
  move=> /hasP[e _]; rewrite /is_at_most; case eu: (penalty_up _ _ _ _ _ _ _ _) => [y|//]; rewrite (val_le F) => le.
  by have [g hy] := penalty_upP eu sym; split=> //; apply: le_trans hy le.
move: h; case ek: {1}kind => h; [exact: some h | exact: some h |].
by rewrite /penalty -/kind ek; apply: eigen_enoughP.
Qed.

Lemma fam_symmetrical T j : all below T -> symmetrical (fam (foldl add start T) j).
Proof. by move=> b; rewrite famE //; apply: known_symmetrical. Qed.

(** At least the prior's information: worth at least 0. *)
Lemma prior_worth T (G : {set robot}) : uniq T -> all below T -> (forall i, i \in T -> robot_of w i \in G) ->
  (forall j, psd (known T j - mx F d (nth [::] lows j))) -> dle (lower cl) d0 ->
  val (lower cl) <= value (contributed plan_of G).
Proof.
move=> uT bT TG h; rewrite (val_le F) val0 => le; apply: le_trans le _.
have base0 : base = penalty (posterior prior_of info_of (contributed plan_of set0)).
  have := value0; rewrite valueE => /eqP; rewrite subr_eq0 => /eqP ->; by rewrite /contributed imset0.
rewrite valueE base0 subr_ge0; apply: good_above; first exact: (posterior_pd _ plan_ofP).
  by move=> j; apply: posterior_sym.
move=> j; have [R pR ->] := known_below j uT bT TG; exists ((known T j - mx F d (nth [::] lows j)) + R).
  by apply: psdD.
rewrite /posterior /contributed imset0 big_set0 addr0.
by rewrite [known T j + _]addrCA !addrA.
Qed.

Lemma worth_sound :
  worth_test start add value plan_of (val (lower cl)) (worth kind d m ws Ss groups lows (lower cl) plan_room).
Proof.
move=> T uT bT h G TG; case/orP: h => [/andP[le /allP h]|h].
  apply: (prior_worth uT bT TG) le => j; have := h j; rewrite mem_iota add0n ltn_ord => /(_ isT).
  have sm := sub_symmetrical (fam_symmetrical j bT) (proj1 (lowP j)).
  by move/(is_psdP sm); rewrite mx_sub -/(fam _ j) famE.
have [g le] := withinP h (fun j => fam_symmetrical j bT).
apply: enough_value; apply: le_trans le; apply: good_above => // j; first exact: posterior_sym.
have [R pR ->] := known_below j uT bT TG; exists ((invmx (prior_of j) - mx F d (nth [::] lows j)) + R).
  by apply: psdD => //; case: (lowP j).
by rewrite famE // [RHS]addrA.
Qed.

(** The average of the cases, each with one robot's information [r] times. *)
Lemma known_average (T T' : seq nat) r j : size T' = r -> (0 < r)%N ->
  known (T ++ T') j = (size T')%:R^-1 *: \sum_(i <- T') (known T j + r%:R *: info_at i j).
Proof.
move=> sT r0; have rn : (r%:R : F) != 0 by rewrite pnatr_eq0 -lt0n.
rewrite big_split /= sT scalerDr -scaler_sumr scalerA mulVf // scale1r.
rewrite big_const_seq count_predT iter_addr_0 sT -scaler_nat scalerA mulVf // scale1r.
by rewrite /known big_cat addrA.
Qed.

Lemma case_fam T i j r : all below T -> (i < robots w)%N ->
  fam (add_times d m rows r (foldl add start T) i) j = known T j + r%:R *: info_at i j.
Proof.
move=> b il; rewrite /fam nth_mkseq // mx_add mx_scale val_nat rows_at // -/(fam _ j) famE //.
Qed.

Lemma average_sound : average_test start add value plan_of (val (lower cl))
  (average_worth kind d m ws Ss groups lows rows (lower cl) plan_room).
Proof.
move=> T rest r uT bT r0 /andP[/andP[ur lr] h] T' G uTT bT' sub sz TG.
have bTT : all below (T ++ T') by rewrite all_cat bT.
have uT' : uniq T' by move: uTT; rewrite cat_uniq => /and3P[].
pose st := foldl add start T; pose A i := fam (add_times d m rows r st i).
have AE i j : i \in T' -> A i j = known T j + r%:R *: info_at i j.
  by move=> iT; apply: case_fam => //; apply: (allP bT').
have Asym i j : i \in T' -> symmetrical (A i j).
  move=> iT; rewrite AE // /symmetrical linearD linearZ /= known_symmetrical; congr (_ + _ *: _).
  exact: info_symmetrical.
have T'0 : T' != [::] by rewrite -size_eq0 sz -lt0n.
have avg j : known (T ++ T') j = (size T')%:R^-1 *: \sum_(i <- T') A i j.
  rewrite (known_average T j sz r0); congr (_ *: _); rewrite big_seq [RHS]big_seq.
  by apply: eq_bigr => i iT; rewrite AE.
case/orP: h => [/allP h|/hasP[level _]].
  have each i : i \in T' -> as_good_as_prior d m lows (lower cl) (add_times d m rows r st i).
    by move=> /sub iR; apply: h; apply: map_f.
  have le : dle (lower cl) d0.
    by case: (T') T'0 each => [//|i T1] _ each; case/andP: (each i (mem_head _ _)).
  apply: (prior_worth uTT bTT TG) le => j.
  have -> : known (T ++ T') j - mx F d (nth [::] lows j) =
      (size T')%:R^-1 *: \sum_(i <- T') (A i j - mx F d (nth [::] lows j)).
    rewrite avg sumrB scalerBr; congr (_ - _); rewrite big_const_seq count_predT iter_addr_0 -scaler_nat scalerA.
    by rewrite mulVf ?scale1r // pnatr_eq0 size_eq0.
  apply: psdZ; first by rewrite invr_ge0 ler0n.
  rewrite big_seq; apply: psd_sum => i iT; have /andP[_ /allP hj] := each i iT.
  have := hj j; rewrite mem_iota add0n ltn_ord => /(_ isT).
  have sm := sub_symmetrical (Asym i j iT) (proj1 (lowP j)).
  by move/(is_psdP sm); rewrite mx_sub -/(fam _ j).
rewrite /average_within; case e: (all_some _) => [ys|//]; cbv zeta; set tau := nth d0 _ r.-1.
rewrite (val_le F) val_add !val_mul val_nat val_sum big_map => le.
pose y i := val (nth d0 ys (index i rest)).
have szy : size ys = size rest by have [-> _] := all_some_nth [::] d0 0 e; rewrite size_map.
have each i : i \in T' -> good (A i) /\ penalty (A i) <= y i.
  move=> iT; have iR := sub _ iT; have [_ h] := all_some_nth [::] d0 (index i rest) e.
  rewrite size_map index_mem (nth_map 0%N) ?index_mem // nth_index // in h.
  by apply: penalty_upP (h iR) _ => j; apply: Asym.
apply: enough_value; apply: le_trans (_ : penalty (fun j => (size T')%:R^-1 *: \sum_(i <- T') A i j) <= _).
  apply: good_above => [j||j]; last 1 first.
  - have [R pR ->] := known_below j uTT bTT TG.
    exists ((invmx (prior_of j) - mx F d (nth [::] lows j)) + R); last by rewrite avg [RHS]addrA.
    by apply: psdD => //; case: (lowP j).
  - split; first by apply: average_symmetrical => i; apply: Asym.
    by apply: average_pd => // i /each[g _]; case: (g j).
  by move=> j; apply: posterior_sym.
apply: le_trans (penalty_convex T'0 (fun i iT => proj1 (each i iT))) _.
have r0' : 0 < (size T')%:R :> F by rewrite ltr0n sz.
rewrite ler_pdivr_mull // sz; apply: le_trans le.
pose f i := Num.max 0 (y i - val tau).
apply: (@le_trans _ _ (\sum_(i <- T') (f i + val tau))).
  rewrite big_seq [X in _ <= X]big_seq; apply: ler_sum => i /each[_ h]; apply: le_trans h _.
  by rewrite -ler_subl_addr /f le_maxr lexx orbT.
rewrite big_split /= big_const_seq count_predT iter_addr_0 sz mulr_natl ler_add2r.
have -> : \sum_(i <- T') f i = \sum_(i <- rest | i \in T') f i.
  rewrite -[RHS]big_filter; apply: perm_big; apply: uniq_perm; rewrite ?filter_uniq // => i.
  by rewrite mem_filter; case iT: (i \in T') => //=; rewrite (sub _ iT).
apply: (@le_trans _ _ (\sum_(i <- rest) f i)).
  by rewrite big_mkcond; apply: ler_sum => i _; case: ifP => // _; rewrite /f le_maxr lexx.
rewrite (big_nth 0%N) [X in _ <= X](big_nth d0) szy big_mkord [X in _ <= X]big_mkord; apply: ler_sum => k _.
by rewrite /f /y index_uniq // val_max val0 val_sub.
Qed.

Theorem lower_sound : check_lower_part pb cl pr lows defects ->
  forall a, allowed (team_of w) a -> val (lower cl) <= team_value (team_of w) value plan_of a.
Proof.
rewrite /check_lower_part; case: (lower_part pr) => [k t|t|l|l t|l t nodes|l t|//].
- move=> /and3P[full forced h] a oka; have [i ki] := forcedP net_good full oka forced.
  apply: (size_treeP worth_sound average_sound ki h).
- by move=> h a oka; exact: (attack_treeP net_good erefl worth_sound oka h).
- move=> /and3P[full forced h] a oka; have [i ki] := forcedP net_good full oka forced.
  exact: (forced_setP worth_sound average_sound h ki).
- by move=> /andP[sets h] a oka; exact: (dualsP net_good worth_sound average_sound oka sets h).
- by move=> /andP[sets h] a oka; exact: (coverP net_good worth_sound average_sound oka sets h).
by move=> /andP[sets h] a oka; exact: (sizesP net_good worth_sound average_sound oka sets h).
Qed.
End Lower.
End Sound.
