(** The pattern-free guarantees: [1 - k] and [(1 - c)^2], for any graph, budgets and attacks. *)
From mathcomp Require Import all_ssreflect all_algebra.
From Ratt Require Import Extrema Teams.
Set Implicit Arguments.
Unset Strict Implicit.
Unset Printing Implicit Defensive.
Import Order.Theory GRing.Theory Num.Theory.
Local Open Scope ring_scope.

Section Classes.
Variables (F : realDomainType) (R E : finType) (t : team R E) (phi : {set E} -> F).
Implicit Types (A B : {set E}) (x y : E).

(** Feasible sets hold at most one element per robot; curvatures are over feasible sets. *)
Definition feasible A : bool := [forall x in A, forall y in A, (owner t x == owner t y) ==> (x == y)].
Definition marginal x A : F := phi (x |: A) - phi A.

Definition normalised : Prop := phi set0 = 0.
Definition non_decreasing : Prop := forall A B, feasible B -> A \subset B -> phi A <= phi B.
Definition submodular : Prop := forall x A B, feasible (x |: B) -> x \notin B -> A \subset B ->
  marginal x B <= marginal x A.
(** The smallest share of its own value that an element adds to a feasible set is at least [1 - k]. *)
Definition curvature_at_most (k : F) : Prop := forall x A, feasible (x |: A) -> x \notin A ->
  (1 - k) * phi [set x] <= marginal x A.
(** Any two marginals of an element differ at most by the factor [1 - c]. *)
Definition total_curvature_at_most (c : F) : Prop := forall x A B, feasible (x |: A) -> feasible (x |: B) ->
  x \notin A -> x \notin B -> (1 - c) * marginal x B <= marginal x A.

(** Bait or greedy: the robots of [g], in this order, chose greedily beside those before them; every other robot took
    an element of largest individual value. *)
Definition before (u : {ffun R -> E}) (g : seq R) (i : R) : {set E} := contributed u [set j in take (index i g) g].
Definition bait_or_greedy (u : {ffun R -> E}) (g : seq R) : Prop :=
  [/\ is_plan t u, uniq g,
      forall i x, i \notin g -> owner t x = i -> phi [set x] <= phi [set u i]
    & forall i x, i \in g -> owner t x = i -> phi (x |: before u g i) <= phi (u i |: before u g i)].
End Classes.

Section Proofs.
Variables (F : realDomainType) (R E : finType) (t : team R E) (phi : {set E} -> F).
Implicit Types (A B : {set E}) (x y : E) (S : {set R}).

Lemma sub_feasible A B : A \subset B -> feasible t B -> feasible t A.
Proof.
move=> /subsetP AB /forall_inP h; apply/forall_inP => x xA; apply/forall_inP => y yA.
by apply: (forall_inP (h x (AB x xA))); apply: AB.
Qed.

Lemma plan_feasible p S : is_plan t p -> feasible t (contributed p S).
Proof.
move=> okp; apply/forall_inP => x /imsetP[i _ ->]; apply/forall_inP => y /imsetP[j _ ->].
by rewrite !(plan_owner _ okp); apply/implyP => /eqP ->.
Qed.

(** One element of a robot outside of [S] beside a plan's elements on [S]. *)
Lemma extend_feasible p S x : is_plan t p -> owner t x \notin S -> feasible t (x |: contributed p S).
Proof.
move=> okp xS; apply/forall_inP => y; rewrite in_setU1 => yin; apply/forall_inP => z; rewrite in_setU1 => zin.
apply/implyP => /eqP eq.
case/orP: yin => [/eqP ey|/imsetP[i iS ey]]; case/orP: zin => [/eqP ez|/imsetP[j jS ez]].
- by rewrite ey ez.
- by move: xS; rewrite -ey eq ez (plan_owner _ okp) jS.
- by move: xS; rewrite -ez -eq ey (plan_owner _ okp) iS.
- by move: eq; rewrite ey ez !(plan_owner _ okp) => ->.
Qed.

Lemma extend_notin p S x : is_plan t p -> owner t x \notin S -> x \notin contributed p S.
Proof. by move=> okp; apply: contra => /imsetP[i iS ->]; rewrite (plan_owner _ okp). Qed.

Lemma contributedU1 (p : {ffun R -> E}) i S : contributed p (i |: S) = p i |: contributed p S.
Proof. by rewrite /contributed imsetU1. Qed.

(** Adding the robots of a list one by one: if each adds at least the share [s] of what it adds in the other plan, the
    sums compare in the same way. *)
Lemma add_one_by_one (s : F) (u o : {ffun R -> E}) (r : seq R) S :
  s * phi (contributed o S) <= phi (contributed u S) -> uniq r -> {in r, forall i, i \notin S} ->
  (forall i (T : {set R}), i \in r -> i \notin T -> S \subset T -> [set j in take (index i r) r] \subset T ->
    T \subset S :|: [set j in take (index i r) r] ->
    s * marginal phi (o i) (contributed o T) <= marginal phi (u i) (contributed u T)) ->
  s * phi (contributed o (S :|: [set i in r])) <= phi (contributed u (S :|: [set i in r])).
Proof.
move=> base; elim/last_ind: r => [|r i IH] ur rS step.
  by rewrite (_ : [set _ in [::]] = set0) ?setU0 //; apply/setP => j; rewrite !inE.
move: ur; rewrite rcons_uniq => /andP[ir ur].
have eqS : S :|: [set j in rcons r i] = i |: (S :|: [set j in r]).
  by apply/setP => j; rewrite !inE mem_rcons in_cons; case: (j == i); rewrite ?orbT.
have prev : s * phi (contributed o (S :|: [set j in r])) <= phi (contributed u (S :|: [set j in r])).
  apply: IH => // [j jr|j T jr jT ST sub sup]; first by apply: rS; rewrite mem_rcons in_cons jr orbT.
  have tk : take (index j (rcons r i)) (rcons r i) = take (index j r) r.
    by rewrite -cats1 index_cat jr takel_cat // index_size.
  by apply: step; rewrite ?tk // mem_rcons in_cons jr orbT.
have tki : take (index i (rcons r i)) (rcons r i) = r.
  by rewrite -cats1 index_cat (negbTE ir) /= eqxx addn0 take_size_cat.
have inot : i \notin S :|: [set j in r].
  by rewrite !inE negb_or ir andbT rS // mem_rcons mem_head.
have := step i (S :|: [set j in r]); rewrite tki mem_rcons mem_head subsetUl subsetUr fintype.subxx => /(_ isT inot isT isT isT).
rewrite /marginal -!contributedU1 -eqS mulrBr => last.
have := ler_add prev last; by rewrite addrCA subrr addr0 addrCA subrr addr0.
Qed.

Lemma take_index_notin (g : seq R) i : i \notin take (index i g) g.
Proof.
case: (boolP (i \in g)) => ig; last by apply: contra ig => /mem_take.
by rewrite in_take // ltnn.
Qed.

(** The shape of both proofs: greedy robots first, in their order, then the others in any order. *)
Lemma greedy_then_bait (s : F) u o g S : normalised phi -> bait_or_greedy t phi u g -> is_plan t o ->
  (forall i (T : {set R}), i \in g -> i \notin T -> contributed u T \subset before u g i ->
     s * marginal phi (o i) (contributed o T) <= marginal phi (u i) (contributed u T)) ->
  (forall i (T : {set R}), i \notin g -> i \notin T ->
     s * marginal phi (o i) (contributed o T) <= marginal phi (u i) (contributed u T)) ->
  s * phi (contributed o S) <= phi (contributed u S).
Proof.
move=> n0 [okp ug _ _] oko hg hb.
set r := [seq i <- g | i \in S].
have gr : s * phi (contributed o (set0 :|: [set i in r])) <= phi (contributed u (set0 :|: [set i in r])).
  apply: add_one_by_one; rewrite ?filter_uniq //.
  - by rewrite /contributed !imset0 n0 mulr0.
  - by move=> i _; rewrite in_set0.
  move=> i T ir iT _ _; rewrite set0U => sup; apply: hg => //; first by move: ir; rewrite mem_filter => /andP[].
  apply/subsetP => x /imsetP[j jT ->]; apply: imset_f; rewrite inE.
  have := subsetP sup _ jT; rewrite inE => jt.
  have ig : i \in g by move: ir; rewrite mem_filter => /andP[].
  have iS : i \in S by move: ir; rewrite mem_filter => /andP[].
  have eqr : take (index i r) r = [seq i <- take (index i g) g | i \in S].
    have nin : i \notin [seq j <- take (index i g) g | j \in S].
      by rewrite mem_filter (negbTE (take_index_notin g i)) andbF.
    have -> : r = [seq j <- take (index i g) g | j \in S] ++ i :: [seq j <- drop (index i g).+1 g | j \in S].
      rewrite /r -{1}(cat_take_drop (index i g) g) filter_cat (drop_nth i) ?index_mem // nth_index //=.
      by rewrite iS.
    by rewrite index_cat (negbTE nin) /= eqxx addn0 take_size_cat.
  by move: jt; rewrite eqr mem_filter => /andP[].
set b := [seq i <- enum S | i \notin g].
have eqS : S = [set i in r] :|: [set i in b].
  apply/setP => i; rewrite in_setU !in_set 2!mem_filter mem_enum; case: (i \in S); rewrite ?andbF //= andbT.
  by rewrite orbN.
rewrite set0U in gr; rewrite eqS; apply: add_one_by_one; rewrite 1?filter_uniq ?enum_uniq //.
  by move=> i; rewrite mem_filter => /andP[/negbTE ig _]; rewrite in_set mem_filter ig andbF.
by move=> i T; rewrite mem_filter => /andP[ig _] iT _ _ _; apply: hb.
Qed.

Section Submodular.
Variable k : F.
Hypotheses (k1 : k <= 1) (n0 : normalised phi) (mono : non_decreasing t phi).
Hypotheses (sub : submodular t phi) (curv : curvature_at_most t phi k).

(** In every set of robots a bait-or-greedy plan has at least [1 - k] of what any plan has there. *)
Theorem submodular_share u g o S : bait_or_greedy t phi u g -> is_plan t o ->
  (1 - k) * phi (contributed o S) <= phi (contributed u S).
Proof.
move=> bg oko; have [okp ug bait greedy] := bg; have k0 : 0 <= 1 - k by rewrite subr_ge0.
have alone i (T : {set R}) : i \notin T -> marginal phi (o i) (contributed o T) <= phi [set o i].
  move=> iT; apply: le_trans (_ : marginal phi (o i) set0 <= _); last by rewrite /marginal setU0 n0 subr0.
  by apply: sub; rewrite ?sub0set ?extend_notin ?extend_feasible ?(plan_owner _ oko).
apply: (@greedy_then_bait _ u o g) => // i T ig iT.
  move=> inb; have nb := take_index_notin g i.
  apply: le_trans (_ : (1 - k) * phi [set o i] <= _); first by apply: ler_wpmul2l => //; apply: alone.
  apply: le_trans (_ : marginal phi (o i) (before u g i) <= _).
    by apply: curv; rewrite ?extend_notin ?extend_feasible ?(plan_owner _ oko) ?inE.
  apply: le_trans (_ : marginal phi (u i) (before u g i) <= _).
    by rewrite /marginal ler_add2r; apply: greedy => //; rewrite (plan_owner _ oko).
  by apply: sub; rewrite ?extend_notin ?extend_feasible ?(plan_owner _ okp) ?inE.
apply: le_trans (_ : (1 - k) * phi [set u i] <= _).
  apply: ler_wpmul2l => //; apply: le_trans (alone i T iT) _.
  by apply: bait => //; rewrite (plan_owner _ oko).
by apply: curv; rewrite ?extend_notin ?extend_feasible ?(plan_owner _ okp).
Qed.
End Submodular.

Section NonDecreasing.
Variable c : F.
Hypotheses (c1 : c <= 1) (n0 : normalised phi) (curv : total_curvature_at_most t phi c).

(** Whatever the others are, a robot's element adds at least [(1 - c)^2] of what any other of its elements adds. *)
Lemma non_decreasing_step u g o i (T : {set R}) : bait_or_greedy t phi u g -> is_plan t o -> i \notin T ->
  (1 - c) ^+ 2 * marginal phi (o i) (contributed o T) <= marginal phi (u i) (contributed u T).
Proof.
move=> bg oko iT; have [okp ug bait greedy] := bg; have c0 : 0 <= 1 - c by rewrite subr_ge0.
rewrite expr2 -mulrA; case: (boolP (i \in g)) => ig.
  have nb := take_index_notin g i.
  apply: le_trans (_ : (1 - c) * marginal phi (o i) (before u g i) <= _).
    apply: ler_wpmul2l => //; apply: curv; rewrite ?/before ?extend_notin ?extend_feasible ?(plan_owner _ oko) //.
      by rewrite in_set.
    by rewrite in_set.
  apply: le_trans (_ : (1 - c) * marginal phi (u i) (before u g i) <= _).
    by apply: ler_wpmul2l => //; rewrite /marginal ler_add2r; apply: greedy => //; rewrite (plan_owner _ oko).
  by apply: curv; rewrite ?extend_notin ?extend_feasible ?(plan_owner _ okp) ?inE.
apply: le_trans (_ : (1 - c) * marginal phi (o i) set0 <= _).
  apply: ler_wpmul2l => //; apply: curv; rewrite ?in_set0 // ?extend_notin ?extend_feasible ?(plan_owner _ oko) //.
  by apply: sub_feasible (extend_feasible oko (_ : owner t (o i) \notin T));
     rewrite ?(plan_owner _ oko) // setUS ?sub0set.
apply: le_trans (_ : (1 - c) * marginal phi (u i) set0 <= _).
  apply: ler_wpmul2l => //; rewrite /marginal !setU0 ler_add2r.
  by apply: bait => //; rewrite (plan_owner _ oko).
apply: curv; rewrite ?in_set0 // ?extend_notin ?extend_feasible ?(plan_owner _ okp) //.
by apply: sub_feasible (extend_feasible okp (_ : owner t (u i) \notin T));
   rewrite ?(plan_owner _ okp) // setUS ?sub0set.
Qed.

Theorem non_decreasing_share u g o S : bait_or_greedy t phi u g -> is_plan t o ->
  (1 - c) ^+ 2 * phi (contributed o S) <= phi (contributed u S).
Proof.
by move=> bg oko; apply: (@greedy_then_bait _ u o g) => // i T _ iT *; apply: non_decreasing_step bg oko iT.
Qed.
End NonDecreasing.

(** ** After the worst attack *)
Theorem submodular_guarantee k u g : R -> k <= 1 -> normalised phi -> submodular t phi -> curvature_at_most t phi k ->
  bait_or_greedy t phi u g -> (1 - k) * optimum t phi <= worst_case t phi u.
Proof.
move=> i0 k1 n0 sub curv bg; have [okp _ _ _] := bg.
have [[o oko <-] _] := optimumP phi okp.
by apply: share_of_worst_case; rewrite ?subr_ge0 // => S; apply: submodular_share bg oko.
Qed.

Theorem non_decreasing_guarantee c u g : R -> c <= 1 -> normalised phi -> total_curvature_at_most t phi c ->
  bait_or_greedy t phi u g -> (1 - c) ^+ 2 * optimum t phi <= worst_case t phi u.
Proof.
move=> i0 c1 n0 curv bg; have [okp _ _ _] := bg.
have [[o oko <-] _] := optimumP phi okp.
by apply: share_of_worst_case; rewrite ?sqr_ge0 // => S; apply: non_decreasing_share bg oko.
Qed.
End Proofs.
