(** RATT as a function, ties included, and the proof that its plan is bait or greedy. *)
From mathcomp Require Import all_ssreflect all_algebra.
From Ratt Require Import Extrema Teams Guarantees.
Set Implicit Arguments.
Unset Strict Implicit.
Unset Printing Implicit Defensive.
Import Order.Theory GRing.Theory Num.Theory.
Local Open Scope ring_scope.

Section FirstMax.
Variables (F : realDomainType) (T : eqType).
Implicit Types (f : T -> F) (s : seq T).

(** The first of the list [x :: s] with the largest [f]: only a strictly larger one replaces what was found. *)
Definition first_max f x s : T := foldl (fun b y => if f b < f y then y else b) x s.

Lemma first_max_in f x s : first_max f x s \in x :: s.
Proof.
elim: s x => [|y s IH] x /=; first exact: mem_head.
rewrite /first_max /=; case: ifP => _; first by rewrite in_cons IH orbT.
by have := IH x; rewrite !in_cons => /orP[->|->]; rewrite ?orbT.
Qed.

Lemma first_max_ge f x s : {in x :: s, forall y, f y <= f (first_max f x s)}.
Proof.
have base y s' : f y <= f (first_max f y s').
  elim: s' y => [|z s' IH] y //=; rewrite /first_max /=; case: ifP => h; last exact: IH.
  exact: le_trans (ltW h) (IH z).
elim: s x => [|y s IH] x z; first by rewrite inE => /eqP ->.
rewrite in_cons => /orP[/eqP ->|zs]; first exact: base.
rewrite /first_max /=; case: ifP => h; first exact: IH.
move: zs; rewrite in_cons => /orP[/eqP ->|zs]; last by apply: IH; rewrite in_cons zs orbT.
by apply: le_trans (base x s); rewrite leNgt h.
Qed.
End FirstMax.

Section Ratt.
Variables (F : realDomainType) (R E : finType) (t : team R E) (phi : {set E} -> F).
(** Stands for the element of a robot that has none; of no consequence. *)
Variable default : E.

(** Elements and robots in their order ([enum]: ascending for ordinals). *)
Definition own (i : R) : seq E := [seq x <- enum E | owner t x == i].
Definition alone (x : E) : F := phi [set x].
Definition best (i : R) : E := if own i is x :: s then first_max alone x s else default.

(** Robots by the value of their best element, largest first; the sort is stable, so the lowest robot leads a tie. *)
Definition by_value : seq R := sort (fun i j => alone (best j) <= alone (best i)) (enum R).
Definition bait (alpha : nat) : seq R := take alpha by_value.

(** Standard greedy algorithm: the first of the remaining elements with the largest value beside those chosen; then
    the elements of its robot leave. *)
Fixpoint greedy_picks (fuel : nat) (candidates : seq E) (chosen : {set E}) : seq E :=
  match fuel, candidates with
  | n.+1, x :: s =>
      let y := first_max (fun z => phi (z |: chosen)) x s in
      y :: greedy_picks n [seq z <- x :: s | owner t z != owner t y] (y |: chosen)
  | _, _ => [::]
  end.

Definition ratt_picks (alpha : nat) : seq E :=
  greedy_picks #|R| [seq x <- enum E | owner t x \notin bait alpha] set0.

(** Algorithm 1 of the paper for a given [alpha = alpha_s + alpha_cs]. *)
Definition ratt (alpha : nat) : {ffun R -> E} :=
  [ffun i => if i \in bait alpha then best i else head (best i) [seq x <- ratt_picks alpha | owner t x == i]].

Lemma greedy_picksS n x s A : let y := first_max (fun z => phi (z |: A)) x s in greedy_picks n.+1 (x :: s) A =
  y :: greedy_picks n [seq z <- x :: s | owner t z != owner t y] (y |: A).
Proof. by []. Qed.

Lemma greedy_picks_sub n s A : {subset greedy_picks n s A <= s}.
Proof.
elim: n s A => [|n IH] [|x s] A // y; rewrite greedy_picksS in_cons => /orP[/eqP ->|/IH]; first exact: first_max_in.
by rewrite mem_filter => /andP[].
Qed.

Lemma greedy_picks_uniq n s A : uniq (map (owner t) (greedy_picks n s A)).
Proof.
elim: n s A => [|n IH] [|x s] A //; rewrite greedy_picksS.
set y := first_max _ x s; rewrite map_cons cons_uniq IH andbT.
apply/mapP => -[z /greedy_picks_sub]; rewrite mem_filter => /andP[h _] eq.
by move: h; rewrite eq eqxx.
Qed.

Lemma greedy_picks_max n s A k z : (k < size (greedy_picks n s A))%N ->
  z \in s -> owner t z = owner t (nth default (greedy_picks n s A) k) ->
  phi (z |: (A :|: [set x in take k (greedy_picks n s A)])) <=
  phi (nth default (greedy_picks n s A) k |: (A :|: [set x in take k (greedy_picks n s A)])).
Proof.
elim: n s A k => [|n IH] [|x s] A k //; rewrite greedy_picksS.
set y := first_max _ x s; set rest := greedy_picks n _ _; case: k => [|k] ks zs.
  move=> _; rewrite take0 (_ : [set x in [::]] = set0) ?setU0; last by apply/setP => w; rewrite !inE.
  by apply: (first_max_ge (fun z => phi (z |: A))).
rewrite /= => eq; have k1 : (k < size rest)%N by [].
have zr : z \in [seq z <- x :: s | owner t z != owner t y].
  have := mem_nth default k1; rewrite /rest => /greedy_picks_sub; rewrite !mem_filter => /andP[ny _].
  by rewrite eq ny zs.
have := IH _ _ _ k1 zr eq.
suff -> : A :|: [set w in y :: take k rest] = (y |: A) :|: [set w in take k rest] by [].
by apply/setP => w; rewrite !inE; case: (w == y); rewrite ?orbT ?orbF.
Qed.

Lemma greedy_picks_all n s A : (#|[set i in map (owner t) s]| <= n)%N ->
  {in s, forall z, owner t z \in map (owner t) (greedy_picks n s A)}.
Proof.
elim: n s A => [|n IH] [|x s] A //.
  rewrite leqn0 cards_eq0 => /eqP/setP/(_ (owner t x)); rewrite inE map_cons mem_head in_set0 //.
rewrite greedy_picksS; set y := first_max _ x s => card z zs.
rewrite map_cons in_cons; case: eqP => // /eqP ne; rewrite orFb.
apply: IH; last by rewrite mem_filter ne zs.
rewrite -ltnS; apply: leq_trans card; apply: proper_card.
have yin : y \in x :: s by apply: first_max_in.
apply/properP; split.
  apply/subsetP => i; rewrite !in_set => /mapP[w]; rewrite mem_filter => /andP[_ ws] ->.
  exact: map_f.
exists (owner t y); rewrite in_set; first exact: map_f.
by apply/mapP => -[w]; rewrite mem_filter => /andP[/eqP ne' _] /esym.
Qed.

Lemma filter_one (T U : eqType) (f : T -> U) (s : seq T) x : uniq (map f s) -> x \in s ->
  [seq z <- s | f z == f x] = [:: x].
Proof.
elim: s => [//|y s IH] /= /andP[ny us]; rewrite in_cons => /orP[/eqP ->|xs].
  rewrite eqxx (_ : [seq z <- s | f z == f y] = [::]) //.
  apply/eqP; rewrite -(negbK (_ == _)) -has_filter; apply/hasP => -[z zs /eqP eq].
  by move: ny; rewrite -eq map_f.
rewrite IH //; case: eqP => // eq; by move: ny; rewrite eq map_f.
Qed.

Hypothesis every_robot_owns : forall i, exists x, owner t x = i.

Lemma own_best i : best i \in own i.
Proof.
have [x ox] := every_robot_owns i; have : x \in own i by rewrite mem_filter ox eqxx mem_enum.
by rewrite /best; case: (own i) => // y s _; apply: first_max_in.
Qed.

Lemma owner_best i : owner t (best i) = i.
Proof. by have := own_best i; rewrite mem_filter => /andP[/eqP]. Qed.

Lemma best_max x : alone x <= alone (best (owner t x)).
Proof.
have : x \in own (owner t x) by rewrite mem_filter eqxx mem_enum.
by rewrite /best; case: (own (owner t x)) => // y s xs; apply: first_max_ge.
Qed.

Theorem ratt_bait_or_greedy alpha : bait_or_greedy t phi (ratt alpha) (map (owner t) (ratt_picks alpha)).
Proof.
set picks := ratt_picks alpha; set g := map _ _.
have ug : uniq g := greedy_picks_uniq _ _ _.
have uy y : y \in picks -> ratt alpha (owner t y) = y.
  move=> yp; rewrite ffunE; have := yp; rewrite /picks => /greedy_picks_sub.
  rewrite mem_filter => /andP[/negbTE -> _]; by rewrite filter_one.
have nog i : i \notin g -> ratt alpha i = best i.
  move=> ig; rewrite ffunE; case: ifP => // /negbT nb; case/negP: ig.
  have [x ox] := every_robot_owns i; rewrite -ox; apply: greedy_picks_all; first exact: max_card.
  by rewrite mem_filter ox nb mem_enum.
split=> //.
- apply/forallP => i; case: (boolP (i \in g)) => ig; last by rewrite nog ?owner_best.
  by case/mapP: ig => y yp ->; rewrite uy.
- by move=> i x ig ox; rewrite nog // -ox; apply: best_max.
move=> i x ig ox; set k := index i g.
have kp : (k < size picks)%N by rewrite -(size_map (owner t) picks) index_mem.
have own_nth : owner t (nth default picks k) = i.
  by rewrite -(nth_map default i (owner t)) ?nth_index.
have eqb : before (ratt alpha) g i = set0 :|: [set y in take k picks].
  rewrite set0U; apply/setP => y; rewrite inE /before -/k /contributed /g -map_take.
  apply/imsetP/idP => [[j]|yt].
    by rewrite inE => /mapP[z zt ->] ->; rewrite uy // (mem_take zt).
  by exists (owner t y); rewrite ?inE ?map_f // uy // (mem_take yt).
have ui : ratt alpha i = nth default picks k by rewrite -{1}own_nth uy ?mem_nth.
rewrite eqb ui; apply: greedy_picks_max => //; last by rewrite own_nth.
rewrite mem_filter mem_enum andbT ox.
case/mapP: ig => y; rewrite /picks => /greedy_picks_sub; by rewrite mem_filter => /andP[h _] ->.
Qed.

(** RATT's guarantees, with RATT the function. *)
Theorem ratt_submodular k alpha : R -> k <= 1 -> normalised phi -> submodular t phi -> curvature_at_most t phi k ->
  (1 - k) * optimum t phi <= worst_case t phi (ratt alpha).
Proof. by move=> i k1 n0 sub curv; apply: submodular_guarantee i k1 n0 sub curv (ratt_bait_or_greedy alpha). Qed.

Theorem ratt_non_decreasing c alpha : R -> c <= 1 -> normalised phi -> total_curvature_at_most t phi c ->
  (1 - c) ^+ 2 * optimum t phi <= worst_case t phi (ratt alpha).
Proof. by move=> i c1 n0 curv; apply: non_decreasing_guarantee i c1 n0 curv (ratt_bait_or_greedy alpha). Qed.
End Ratt.
