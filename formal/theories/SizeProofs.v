(** Lower proofs by sizes of groups: the groups of an attack, and why the largest one is among those checked. *)
From Coq Require Import ZArith.
From mathcomp Require Import all_ssreflect all_algebra.
From mathcomp.zify Require Import zify ssrZ.
From Ratt Require Import Extrema Teams Graph Worth CaseTree Costs AttackGroups GroupProofs Positive Sizes SizeCosts.
Set Implicit Arguments.
Unset Strict Implicit.
Unset Printing Implicit Defensive.
Import Order.Theory GRing.Theory Num.Theory.

(** ** Tables of what several groups cost *)
Lemma ole_trans y x z : ole x y -> ole y z -> ole x z.
Proof. by case: x y z => [x|] [y|] [z|] //=; lia. Qed.

Lemma ole_max x y z : ole x z -> ole y z -> ole (omax x y) z.
Proof. by case: x y z => [x|] [y|] [z|] //=; lia. Qed.

Lemma closed_rowsP least sense blind a rows (gs : seq (nat * nat * Z)) : closed_rows least sense blind a rows ->
  all (fun g => [&& g.1.1 <= a, 0 < g.1.1 + g.1.2 & ole (nth None least (g.1.1 + g.1.2)) (Some g.2)])%N gs ->
  (sumn [seq g.1.1 | g <- gs] <= sense)%N -> (sumn [seq g.1.2 | g <- gs] <= blind)%N ->
  ole (nth None (nth [::] rows (sumn [seq g.1.1 | g <- gs])) (sumn [seq g.1.2 | g <- gs])) (Some (zsum [seq g.2 | g <- gs])).
Proof.
case/and4P=> /eqP sr /allP size_rows zero /allP adds; elim: gs => [|[[a' y] q] gs IH] //= /andP[/and3P[le pos lq] h] ls lb.
have row_size c : (c <= sense)%N -> size (nth [::] rows c) = blind.+1.
  by move=> cs; apply/eqP/size_rows; rewrite mem_nth // sr ltnS.
have lc : (sumn [seq g.1.1 | g <- gs] <= sense)%N by apply: leq_trans ls; apply: leq_addl.
have lx : (sumn [seq g.1.2 | g <- gs] <= blind)%N by apply: leq_trans lb; apply: leq_addl.
have {IH} := IH h lc lx; move: ls lb lc lx; set c := sumn _; set x := sumn _; move: (zsum _) => z ls lb lc lx old.
have ina : a' \in iota 0 a.+1 by rewrite mem_iota add0n ltnS.
have iny : y \in iota 0 blind.+1 by rewrite mem_iota add0n ltnS; apply: leq_trans lb; apply: leq_addr.
have /allP/(_ _ iny) := adds _ ina; rewrite (gtn_eqF pos) /= => /(all_nthP ([::], [::]))/(_ c).
have sz : (c < size (zip (drop a' rows) rows))%N by rewrite size_zip size_drop sr leq_min; lia.
move=> /(_ sz); rewrite nth_zip_cond sz nth_drop /= => /(all_nthP (None, None))/(_ x).
have sy : (x < size (zip (drop y (nth [::] rows (a' + c))) (nth [::] rows c)))%N.
  by rewrite size_zip size_drop !row_size // leq_min; lia.
move=> /(_ sy); rewrite nth_zip_cond sy nth_drop /= => new; apply: (ole_trans new).
by move: old lq; case: (nth None (nth [::] rows c) x) => [?|] //; case: (nth None least _) => [?|] //=; lia.
Qed.

Section Soundness.
Local Open Scope ring_scope.
Variables (w : network) (S : Type) (start : S) (add : S -> nat -> S) (worth : S -> bool).
Variable (average_worth : S -> seq nat -> nat -> bool).
Hypothesis ok : network_ok w.
Local Notation robot := 'I_(top_robot w).+1.
Local Notation element := 'I_(top_element w).+1.
Variables (F : realFieldType) (phi : {set element} -> F) (p : {ffun robot -> element}) (lower : F).
Local Notation below := (fun i => (i < robots w)%N).
Hypotheses (worthP : worth_test start add phi p lower worth) (averageP : average_test start add phi p lower average_worth).
Variables (size_k : nat) (t : size_proof) (a0 : attack [finType of robot]).
Hypotheses (set_worth : forall V : {set robot}, (size_k <= #|V|)%N -> lower <= phi (contributed p V))
  (oka0 : allowed (team_of w) a0) (poor : forall i, ~~ (lower <= phi (contributed p (sees (team_of w) a0 i)))).
Local Notation near := (rows_of w (link_list w)).
Local Notation tied := (rows_of w (kept_links w)).

(** *** The attack that blinds as many robots as it may *)
Lemma more_blinded : exists B : {set robot}, [/\ blinded a0 \subset B, #|B| = spare w & [disjoint B & safe_robots (team_of w)]].
Proof.
pose U := [set i : robot | (i : nat) \notin kept_robots w].
have cU : #|U| = count (fun i => i \notin kept_robots w) (iota 0 (robots w)).
  rewrite -sum1_card -sum1_count big_mkcond [RHS]big_mkcond (_ : iota 0 (robots w) = index_iota 0 (robots w)) ?big_mkord.
    by apply: eq_bigr => i _; rewrite inE.
  by rewrite /index_iota subn0.
have few := blinded_few oka0.
have BU : blinded a0 \subset U.
  apply/subsetP => i iB; rewrite inE; case/and5P: oka0 => _ _ _ dis _; have := disjointFr dis iB; by rewrite inE => ->.
have enough : (spare w - #|blinded a0| <= #|U :\: blinded a0|)%N.
  by rewrite cardsD (setIidPr BU) leq_sub2r // cU geq_minr.
have [X XU cX] := part_of_size enough; exists (blinded a0 :|: X); split; first exact: subsetUl.
  rewrite cardsU cX; have -> : blinded a0 :&: X = set0.
    apply/setP => i; rewrite !inE; apply/negP => /andP[iB /(subsetP XU)]; by rewrite !inE iB.
  by rewrite cards0 subn0 subnKC.
rewrite disjoint_subset; apply/subsetP => i; rewrite inE => /orP[/(subsetP BU)|/(subsetP XU)]; rewrite !inE //.
by case/andP.
Qed.

Variable B : {set robot}.
Hypotheses (B_more : blinded a0 \subset B) (B_size : #|B| = spare w) (B_safe : [disjoint B & safe_robots (team_of w)]).
Let a : attack [finType of robot] := (B, cut a0).
Local Notation e := (linked (team_of w) a).

Lemma oka : allowed (team_of w) a.
Proof.
case/and5P: oka0 => _ c1 c2 _ c3; apply/and5P; split=> //.
by rewrite /= B_size; apply: geq_minl.
Qed.

Local Notation group_of r := (part a r).
Local Notation sees_in r := (sensing_size (group_of r) B).
Local Notation blind_in r := (blinded_size (group_of r) B).
Local Notation cost_of d r := (cost d (group_of r) B).
Local Notation sense := (robots w - spare w)%N.
Local Notation blind := (spare w).

Lemma group_size r : #|group_of r| = (sees_in r + blind_in r)%N.
Proof. by rewrite /sensing_size /blinded_size addnC cardsID. Qed.

Lemma group_links r : (links_left (group_of r) <= cut_budget w)%N.
Proof. exact: (part_links ok oka r). Qed.

Lemma sees_group r : roots e r -> sees (team_of w) a0 r = group_of r :\: blinded a0.
Proof. by move=> rr; rewrite /sees -(part_group a0) -[part a0 _]/(group_of (fingraph.root e r)) (eqP rr). Qed.

Lemma few_sensing r : roots e r -> (sees_in r < size_k)%N.
Proof.
move=> rr; rewrite ltnNge; apply: contra (poor r) => many; rewrite sees_group //; apply: set_worth.
apply: leq_trans many _; apply: subset_leq_card; exact: setDS.
Qed.

(** *** Least costs by size *)
Hypothesis vectors_good : vectors_ok w t.
Local Notation vector j := (nth no_prices (vectors t) j).

Lemma vector_ok j : (j < size (vectors t))%N -> prices_ok w (vector j) /\ blind_price (vector j) = Z0.
Proof.
move=> jl; case/andP: vectors_good => _ /(all_nthP no_prices)/(_ j jl)/andP[h1 /Z.eqb_eq h2]; by split.
Qed.

Definition right_tables (found : seq (seq (option Z))) : Prop := size found = size (vectors t) /\
  forall j r, (j < size (vectors t))%N -> roots e r ->
    ole (nth None (nth [::] found j) #|group_of r|) (Some (cost_of (vector j) r)).

Lemma first_right : right_tables (first_tables w near t).
Proof.
split=> [|j r jl rr]; first by rewrite size_map.
have [pg bf] := vector_ok jl.
have small : (#|group_of r| <= robots w)%N by rewrite -[X in (_ <= X)%N]card_ord max_card.
rewrite (nth_map no_prices) // (nth_map 0%N) ?size_iota ?ltnS // nth_iota ?ltnS // add0n.
exact: (ole_left ok pg bf (group_links r) (cost_by_sizeP ok pg bf (group_links r))).
Qed.

Lemma tables_right fs found last : right_tables found -> tables w near t fs found = Some last -> right_tables last.
Proof.
elim: fs found => [|f fs IH] found right /=; first by case=> <-.
case: ifP => // jl; case er: (raised _ _ _ _ _) => [new|//]; apply: IH.
have [sz ri] := right; split=> [|j r jl' rr]; first by rewrite size_set_nth sz; apply/maxn_idPr; rewrite -sz.
rewrite nth_set_nth /=; case: eqP => [ej|_]; last exact: ri.
have old := ri j r jl' rr; have [pg bf] := vector_ok jl'; move: er; rewrite /raised -ej; case: ifP => // /and3P[fn _ above] [<-].
rewrite nth_set_nth /=; case: eqP => [es|_] //.
have all_true (i : robot) : nth false (nseq (robots w) true) i = (i \in [set: robot]) by rewrite nth_nseq ltn_ord inE.
have all_false (i : robot) : nth false (nseq (robots w) false) i = (i \in (set0 : {set robot})) by rewrite nth_nseq ltn_ord inE.
have none : [disjoint set0 & [set: robot]] by rewrite disjoints_subset sub0set.
have every : group_of r \subset set0 :|: [set: robot] by rewrite set0U subsetT.
have lt : Z.lt (Z.pred (form_least f)) (cost_of (vector j) r).
  have size_f : size (nseq (robots w) false) = robots w by rewrite size_nseq.
  have size_t : size (nseq (robots w) true) = robots w by rewrite size_nseq.
  apply: (is_aboveP B ok pg bf (group_links r) size_f size_t all_false all_true none (sub0set _) every _ above).
  by rewrite cards0 es.
have le : Z.le (form_least f) (cost_of (vector j) r) by move: lt; clear; lia.
rewrite es in old *; apply: ole_max old _.
exact: (ole_left ok pg bf (group_links r) (round_upP ok pg bf (group_links r) le)).
Qed.

(** *** The largest group *)
Lemma sum_blind : (\sum_(r | roots e r) blind_in r = spare w)%N.
Proof.
rewrite -B_size -sum1_card [RHS]big_mkcond -(sum_parts a); apply: eq_bigr => r _.
by rewrite /blinded_size -sum1_card [LHS]big_mkcond [RHS]big_mkcond; apply: eq_bigr => i _; rewrite !inE; case: (_ == r).
Qed.

Lemma sum_sees : (\sum_(r | roots e r) sees_in r = robots w - spare w)%N.
Proof.
have total : (\sum_(r | roots e r) sees_in r + \sum_(r | roots e r) blind_in r = robots w)%N.
  rewrite -big_split /=; under eq_bigr do rewrite -group_size -sum1_card.
  by rewrite (sum_parts a) sum1_card card_ord.
by rewrite -total sum_blind addnK.
Qed.

Section Largest.
Variable r0 : robot.
Hypotheses (root0 : roots e r0) (largest : forall r, roots e r -> (sees_in r <= sees_in r0)%N).
Local Notation rest := [seq r <- enum robot | roots e r && (r != r0)].

Lemma sum_rest (T : Type) (idx : T) (op : Monoid.com_law idx) (f : robot -> T) :
  op (f r0) (\big[op/idx]_(r <- rest) f r) = \big[op/idx]_(r | roots e r) f r.
Proof. by rewrite [RHS](bigD1 r0) //= big_filter big_enum_cond. Qed.

Lemma others_cost j rows : (j < size (vectors t))%N -> forall found, right_tables found ->
  closed_rows (nth [::] found j) sense blind (sees_in r0) rows ->
  ole (nth None (nth [::] rows (sense - sees_in r0)) (blind - blind_in r0))
    (Some (Z.sub (slack w (vector j)) (cost_of (vector j) r0))).
Proof.
move=> jl found [_ right] closed; have [pg bf] := vector_ok jl.
pose gs := [seq (sees_in r, blind_in r, cost_of (vector j) r) | r <- rest].
have s1 : sumn [seq g.1.1 | g <- gs] = (sense - sees_in r0)%N.
  by rewrite /gs -map_comp sumnE big_map -sum_sees -(sum_rest _ (fun r => sees_in r)) /= addKn.
have s2 : sumn [seq g.1.2 | g <- gs] = (blind - blind_in r0)%N.
  by rewrite /gs -map_comp sumnE big_map -sum_blind -(sum_rest _ (fun r => blind_in r)) /= addKn.
have s3 : Z.le (zsum [seq g.2 | g <- gs]) (Z.sub (slack w (vector j)) (cost_of (vector j) r0)).
  rewrite /gs -map_comp zsumE big_map /=; have := all_costs ok oka pg.
  by rewrite -(sum_rest _ (fun r => cost_of (vector j) r)) /=; move: (cost_of _ _) (\sum_(r <- _) _) (slack _ _) => x y z; clear; lia.
have good : all (fun g => [&& g.1.1 <= sees_in r0, 0 < g.1.1 + g.1.2 &
    ole (nth None (nth [::] found j) (g.1.1 + g.1.2)) (Some g.2)])%N gs.
  apply/allP => g /mapP[r]; rewrite mem_filter => /andP[/andP[rr _] _] -> /=; rewrite largest //=.
  rewrite -group_size right // andbT card_gt0; apply/set0Pn; exists r; by rewrite inE; apply: rr.
have := closed_rowsP closed good; rewrite s1 s2 => /(_ (leq_subr _ _) (leq_subr _ _)) h.
by apply: (ole_trans h); apply/Z.leb_le.
Qed.
End Largest.

(** *** The tree of the largest group *)
Variable leasts : seq (seq (option Z)).
Hypothesis right_last : right_tables leasts.
Local Notation other j := (others_of w size_k (nth [::] leasts j)).
Local Notation ks := [seq (x.1, x.2, others_of w size_k x.2) | x <- zip (vectors t) leasts].

Lemma nth_known j : (j < size (vectors t))%N ->
  nth (no_prices, [::], [::]) ks j = (vector j, nth [::] leasts j, other j).
Proof.
move=> jl; have [sz _] := right_last; rewrite (nth_map (no_prices, [::])) ?size_zip ?sz ?minnn // nth_zip ?sz //.
Qed.

Lemma size_known : size ks = size (vectors t).
Proof. by have [sz _] := right_last; rewrite size_map size_zip sz minnn. Qed.

Section Tree.
Variable r0 : robot.
Hypotheses (root0 : roots e r0) (largest : forall r, roots e r -> (sees_in r <= sees_in r0)%N).
Hypothesis closed : all (fun k => others_ok w size_k k.1.2 k.2) ks.
Local Notation x0 := (sees_in r0).
Local Notation y0 := (blind_in r0).

Lemma sees_le : (x0 <= sense)%N.
Proof. by rewrite -sum_sees (bigD1 r0) //= leq_addr. Qed.

Lemma blind_le : (y0 <= blind)%N.
Proof. by rewrite -sum_blind (bigD1 r0) //= leq_addr. Qed.

Lemma in_levels : x0 \in iota 0 (minn size_k sense.+1).
Proof. by rewrite mem_iota add0n /= leq_min few_sensing // ltnS sees_le. Qed.

Lemma limit_above j : (j < size (vectors t))%N -> exists2 l, limit_of w (vector j) (other j) x0 y0 = Some l &
  Z.le (cost_of (vector j) r0) l.
Proof.
move=> jl; have [pg bf] := vector_ok jl.
have rows : closed_rows (nth [::] leasts j) sense blind x0 (nth [::] (other j) x0).
  have /(all_nthP (no_prices, [::], [::]))/(_ j) := closed; rewrite size_known nth_known // => /(_ jl)/allP; apply.
  exact: in_levels.
have := others_cost root0 largest jl right_last rows; rewrite /limit_of.
case: (nth None _ _) => [x|//] /= /Z.leb_le le; have := ole_most B ok pg bf (group_links r0).
case: (most_cost _ _) => [m|_] /=; last by eexists; first by []; move: le; clear; lia.
by move/Z.leb_le => le2; eexists; first by []; move: le le2; clear; lia.
Qed.

Lemma group_possible : (x0, y0) \in largest_groups w size_k ks.
Proof.
rewrite mem_filter; apply/andP; split; last first.
  by apply/allpairsP; exists (x0, y0); rewrite in_levels mem_iota add0n /= ltnS blind_le.
apply/(all_nthP (no_prices, [::], [::])) => j; rewrite size_known => jl; rewrite nth_known //=.
have [l -> le] := limit_above jl; have [_ right] := right_last; have := right j r0 jl root0; rewrite group_size.
by case: (nth None _ _) => [x|//] /= /Z.leb_le le2; apply/Z.leb_le; apply: Z.le_trans le2 le.
Qed.

Lemma case_stands : stands start add (group_of r0) B (size_case w start x0 y0).
Proof.
have case_options i : options_of (size_case w start x0 y0) i =
    if (i < robots w)%N then Options true (i \notin kept_robots w) true else nothing.
  rewrite /options_of -[options _]/(map _ (iota 0 (robots w))).
  case: ltnP => il; first by rewrite (nth_map 0%N) ?size_iota // nth_iota.
  by rewrite nth_default // size_map size_iota.
split; try by split; apply: Z.le_refl.
- by exists [::]; split=> // i; rewrite case_options; case: ifP => //; case: (_ \notin _).
- by rewrite size_map size_iota.
move=> i; rewrite /may_be case_options ltn_ord; case: ifP => // _; case: ifP => //= iB.
by have := disjointFr B_safe iB; rewrite inE => ->.
Qed.

Lemma not_costly k c : stands start add (group_of r0) B c ->
  is_costly w near t (limits w ks x0 y0) (x0 + y0) k c -> False.
Proof.
move=> st; rewrite /is_costly; case: (drop k (diagonals t)) => [//|[j diagonal] _].
case el: (nth None (limits w ks x0 y0) j) => [limit|//] /andP[/andP[jl _] above].
have [l ll le] := limit_above jl; have [pg bf] := vector_ok jl.
have lim : limit = l.
  by move: el; rewrite (nth_map (no_prices, [::], [::])) ?size_known // nth_known //= ll => -[].
have so := stands_size st.
pose In := [set i : robot | inside (options_of c i)]; pose Ot := [set i : robot | ~~ inside (options_of c i) && ~~ gone (options_of c i)].
have insE (i : robot) : nth false [seq inside o | o <- options c] i = (i \in In).
  by rewrite (nth_map nothing) ?so // inE.
have othersE (i : robot) : nth false [seq ~~ inside o && ~~ gone o | o <- options c] i = (i \in Ot).
  by rewrite (nth_map nothing) ?so // inE.
have apart : [disjoint In & Ot].
  by rewrite disjoint_subset; apply/subsetP => i; rewrite !inE => ->.
have In_C : In \subset group_of r0.
  by apply/subsetP => i; rewrite inE; apply: contraLR => iC; apply: (not_inside st iC).
have C_sub : group_of r0 \subset In :|: Ot.
  by apply/subsetP => i iC; rewrite in_setU !in_set (not_gone st iC) andbT; case: (inside _).
have cIn : count_inside c = #|In|.
  by rewrite /count_inside (count_options st) sum_mem; apply: eq_bigr => i _; rewrite inE.
have kE : Z.of_nat #|group_of r0| = Z.add (Z.of_nat #|In|) (Z.sub (Z.of_nat (x0 + y0)) (Z.of_nat (count_inside c))).
  by rewrite group_size cIn; move: (Z.of_nat (x0 + y0)) (Z.of_nat #|In|) => x y; clear; lia.
have s1 : size [seq inside o | o <- options c] = robots w by rewrite size_map.
have s2 : size [seq ~~ inside o && ~~ gone o | o <- options c] = robots w by rewrite size_map.
have lt := is_aboveP B ok pg bf (group_links r0) s1 s2 insE othersE apart In_C C_sub kE above.
by move: lt le; rewrite lim; clear; lia.
Qed.

Lemma no_budget c : stands start add (group_of r0) B c -> ~~ beyond_budgets w near tied c.
Proof.
move=> st; exact: (not_beyond_budgets (group_links r0) (@untied_part _ _ ok oka r0) st (@whole_part _ _ ok r0)).
Qed.

Lemma no_tree tree : ~~ check_group w start add worth average_worth near tied t ks (x0, y0) tree.
Proof.
apply/negP; rewrite /check_group; case h: (check_cases _ _ _ _ _ _ _ _ _ _) => [found|//] _.
have none (c : case S) (o : option unit) : stands start add (group_of r0) B c -> None = Some o ->
  False \/ exists2 g, o = Some g & False by [].
have no_limit (k : nat) (c c' : case S) : stands start add (group_of r0) B c -> None = Some c' -> stands start add (group_of r0) B c' by [].
have sub : group_of r0 :\: B \subset group_of r0 :\: blinded a0 by apply: setDS.
have [le|[//|[g _ []]]] := check_casesP (G := unit_eqType) (fits := fun _ => False) worthP averageP sub no_limit no_budget not_costly none
  h case_stands.
by have := poor r0; rewrite sees_group // le.
Qed.
End Tree.

Lemma some_tree g gs trees : g \in gs -> check_groups w start add worth average_worth near tied t ks gs trees ->
  exists tree, check_group w start add worth average_worth near tied t ks g tree.
Proof.
elim: gs trees => [//|g' gs IH] [//|tree trees]; rewrite in_cons /= => /orP[/eqP->|gin] /andP[h1 h2]; last exact: IH gin h2.
by exists tree.
Qed.

Lemma not_all_groups : all (fun k => others_ok w size_k k.1.2 k.2) ks ->
  ~~ check_groups w start add worth average_worth near tied t ks (largest_groups w size_k ks) (group_trees t).
Proof.
move=> closed; apply/negP => h; pose top := fingraph.root e (ord0 : robot).
have rt : roots e top by apply: roots_root.
have [r0 root0 largest] := arg_maxnP (fun r => sees_in r) rt.
have [tree] := some_tree (group_possible root0 largest closed) h.
by apply/negP; apply: no_tree.
Qed.
End Soundness.

(** ** Every attack leaves a group that is worth the claim *)
Theorem sizesP (w : network) (S : Type) (start : S) (add : S -> nat -> S) (worth : S -> bool)
    (average_worth : S -> seq nat -> nat -> bool) (F : realFieldType)
    (phi : {set 'I_(top_element w).+1} -> F) (p : {ffun 'I_(top_robot w).+1 -> 'I_(top_element w).+1}) (lower : F)
    (a : attack [finType of 'I_(top_robot w).+1]) (l : sets_lemma) (t : size_proof) :
  network_ok w -> worth_test start add phi p lower worth -> average_test start add phi p lower average_worth ->
  allowed (team_of w) a -> check_sets w start add worth average_worth l ->
  check_group_sizes w start add worth average_worth (rows_of w (link_list w)) (rows_of w (kept_links w)) (set_size l) t ->
  (lower <= team_value (team_of w) phi p a)%R.
Proof.
move=> ok worthP averageP oka sets h; apply: contraLR (h) => /poor_groups poor.
have [B [B_more B_size B_safe]] := more_blinded oka.
rewrite /check_group_sizes; apply/negP => /andP[/andP[vectors_good _]].
case e: (tables _ _ _ _ _) => [leasts|//] /andP[closed].
have right := tables_right ok oka B_size B_safe vectors_good (first_right ok oka B_size B_safe vectors_good) e.
have set_worth V := check_setsP worthP averageP (V := V) sets.
exact/negP/(not_all_groups ok worthP averageP set_worth oka poor B_more B_size B_safe vectors_good right closed).
Qed.
