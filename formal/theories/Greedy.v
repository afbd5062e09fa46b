(** What greedily chosen elements keep by themselves: [1 / (1 + k)] of any other choice for a submodular function of
    curvature [k], [1 - c] for total curvature [c]; all sets in the proofs hold one element per robot. *)
From mathcomp Require Import all_ssreflect all_algebra.
From mathcomp.algebra_tactics Require Import ring.
From Ratt Require Import Extrema Teams Guarantees.
Set Implicit Arguments.
Unset Strict Implicit.
Unset Printing Implicit Defensive.
Import Order.Theory GRing.Theory Num.Theory.
Local Open Scope ring_scope.

Section Greedy.
Variables (F : realFieldType) (R E : finType) (t : team R E) (phi : {set E} -> F) (u o : {ffun R -> E}) (g : seq R).
Hypotheses (n0 : normalised phi) (bg : bait_or_greedy t phi u g) (oko : is_plan t o).
Local Notation part p r := (contributed p [set i in r]).

Let plan_u : is_plan t u. Proof. by case: bg. Qed.
Let uniq_g : uniq g. Proof. by case: bg. Qed.
Let greedy i : i \in g -> phi (o i |: before u g i) <= phi (u i |: before u g i).
Proof. by move=> ig; case: bg => _ _ _; apply; rewrite ?(plan_owner _ oko). Qed.

(** The first [j] robots' elements from [u], the others' from [o]. *)
Definition mixed (j : nat) : {ffun R -> E} := [ffun i => if i \in take j g then u i else o i].

Lemma mixed_plan j : is_plan t (mixed j).
Proof. by apply/forallP => i; rewrite ffunE; case: ifP => _; rewrite plan_owner. Qed.

Theorem greedy_submodular k : k <= 1 -> submodular t phi -> curvature_at_most t phi k ->
  phi (part o g) <= (1 + k) * phi (part u g).
Proof.
move=> k1 sub curv; have k0 : 0 <= 1 - k by rewrite subr_ge0.
have step j : (j <= size g)%N -> phi (part o g) <= phi (part (mixed j) g) + k * phi (part u (take j g)).
  elim: j => [|j IH] jg.
    rewrite take0 (_ : part u [::] = set0) ?n0 ?mulr0 ?addr0; last first.
      by rewrite /contributed (_ : [set _ in _] = set0) ?imset0 //; apply/setP => i; rewrite !inE.
    by rewrite (_ : mixed 0 = o) //; apply/ffunP => i; rewrite ffunE take0.
  apply: le_trans (IH (ltnW jg)) _.
  have [i0 _] : exists i : R, i \in g by case: (g) jg => // i s _; exists i; rewrite mem_head.
  set i := nth i0 g j; have ig : i \in g by apply: mem_nth.
  have ji : index i g = j by rewrite index_uniq.
  pose T := [set x in g] :\ i.
  have iT : i \notin T by rewrite !inE eqxx.
  have gT : [set x in g] = i |: T by rewrite setD1K // inE.
  have tk : take j.+1 g = rcons (take j g) i by rewrite -take_nth.
  have nit : i \notin take j g by rewrite -ji take_index_notin.
  have mT : contributed (mixed j.+1) T = contributed (mixed j) T.
    apply: eq_in_imset => x; rewrite !inE => /andP[xi _]; rewrite !ffunE tk mem_rcons in_cons (negbTE xi) //.
  have mj : mixed j i = o i by rewrite ffunE (negbTE nit).
  have mj1 : mixed j.+1 i = u i by rewrite ffunE tk mem_rcons mem_head.
  have bE : before u g i = part u (take j g) by rewrite /before ji.
  have uE : part u (take j.+1 g) = u i |: before u g i.
    rewrite bE -contributedU1; congr (contributed u _); apply/setP => x; rewrite !inE tk mem_rcons in_cons //.
  have sub_b : before u g i \subset contributed (mixed j) T.
    apply/subsetP => x; rewrite bE => /imsetP[y]; rewrite inE => yt ->; apply/imsetP; exists y; last by rewrite ffunE yt.
    rewrite !inE (mem_take yt) andbT; apply: contraNneq nit => <-; exact: yt.
  have inb : i \notin [set x in take (index i g) g] by rewrite inE take_index_notin.
  have fo : owner t (o i) \notin T by rewrite plan_owner.
  have fu : owner t (u i) \notin T by rewrite plan_owner.
  have m1 : marginal phi (o i) (contributed (mixed j) T) <= marginal phi (o i) (before u g i).
    by apply: sub sub_b; [apply: extend_feasible fo | apply: extend_notin fo]; apply: mixed_plan.
  have m2 : marginal phi (o i) (before u g i) <= marginal phi (u i) (before u g i) by rewrite /marginal ler_add2r greedy.
  have m3 : (1 - k) * marginal phi (u i) (before u g i) <= marginal phi (u i) (contributed (mixed j) T).
    apply: le_trans (_ : (1 - k) * phi [set u i] <= _).
      apply: ler_wpmul2l => //; apply: le_trans (_ : marginal phi (u i) set0 <= _); last by rewrite /marginal setU0 n0 subr0.
      have fb : owner t (u i) \notin [set x in take (index i g) g] by rewrite plan_owner.
      by apply: sub (sub0set _); [apply: extend_feasible fb | apply: extend_notin fb].
    by apply: curv; [apply: extend_feasible fu | apply: extend_notin fu]; apply: mixed_plan.
  rewrite gT !contributedU1 mj mj1 mT uE -bE.
  move: (le_trans m1 m2) m3; rewrite /marginal; set a := phi (o i |: _); set b := phi (contributed _ T).
  set c := phi (u i |: contributed _ T); set p := phi (u i |: before u g i); set q := phi (before u g i) => h1 h2.
  rewrite -subr_ge0 (_ : _ - _ = (p - q - (a - b)) + (c - b - (1 - k) * (p - q))); last by ring.
  by rewrite addr_ge0 // subr_ge0.
have := step (size g) (leqnn _); rewrite take_size mulrDl mul1r; congr (_ <= phi _ + _).
by apply: eq_in_imset => i; rewrite inE ffunE take_size => ->.
Qed.

Theorem greedy_total_curvature c : c <= 1 -> total_curvature_at_most t phi c ->
  (1 - c) * phi (part o g) <= phi (part u g).
Proof.
move=> c1 curv; have := @add_one_by_one _ _ _ phi (1 - c) u o g set0; rewrite set0U; apply=> //.
- by rewrite /contributed !imset0 n0 mulr0.
- by move=> i _; rewrite in_set0.
move=> i T ig iT _ low high; have eT : T = [set j in take (index i g) g].
  by apply/eqP; rewrite eqEsubset low andbT; move: high; rewrite set0U.
apply: le_trans (_ : marginal phi (o i) (contributed u T) <= _).
  have fo : owner t (o i) \notin T by rewrite plan_owner.
  by apply: curv; by [apply: extend_feasible fo | apply: extend_notin fo].
by rewrite /marginal ler_add2r eT; apply: greedy.
Qed.
End Greedy.
