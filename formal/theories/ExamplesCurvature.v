(** Curvatures of a small table: what an element adds to any feasible set, by lists, proved to be all there is, and the
    two curvatures from it; tests/formal/test_definitions.py computes them with the Python library. *)
From mathcomp Require Import all_ssreflect all_algebra.
From mathcomp.algebra_tactics Require Import ring.
From Ratt Require Import Extrema Teams Guarantees Planner Sublists ExamplesRatt.
Set Implicit Arguments.
Unset Strict Implicit.
Unset Printing Implicit Defensive.
Import Order.Theory GRing.Theory Num.Theory.

Section Lists.
Variables (n k : nat) (owners : seq nat) (table : seq nat).
Local Notation E := [finType of 'I_k.+1].
Local Notation team := (table_team n k owners).
Local Notation value := (listed_value k table).
Local Notation all_elements := (iota 0 k.+1).
Hypothesis owners_ok : all (fun i => i < n.+1)%N owners.

Definition fraction_value (S : {set E}) : rat := (table_value table S)%:~R.

Definition listed_feasible (s : seq nat) : bool :=
  all (fun x => all (fun y => (nth 0%N owners x == nth 0%N owners y) ==> (x == y)) s) s.
(** An element and what it adds to a feasible set. *)
Definition gains : seq (nat * int) :=
  [seq (x, value (x :: A) - value A)%R |
    A <- parts all_elements, x <- [seq x <- all_elements | (x \notin A) && listed_feasible (x :: A)]].

Lemma mem_all (e : E) : (val e \in all_elements) = true.
Proof. by rewrite mem_iota add0n ltn_ord. Qed.

(** A set and the list of its members. *)
Definition says (A : {set E}) (s : seq nat) : Prop := forall e : E, (val e \in s) = (e \in A).

Lemma says_list (A : {set E}) : says A [seq i <- all_elements | i \in [seq val e | e <- enum A]].
Proof. by move=> e; rewrite mem_filter mem_all andbT (mem_map val_inj) mem_enum. Qed.

Lemma says_value A s : says A s -> {subset s <= all_elements} -> table_value table A = value s.
Proof.
move=> h sub; apply: listed_value_mem => i; apply/mapP/idP => [[e]|is_].
  by rewrite mem_enum -h => es ->.
have ik : (i < k.+1)%N by have := sub _ is_; rewrite mem_iota add0n.
by exists (Ordinal ik); rewrite // mem_enum -h.
Qed.

Lemma says_add A s x : says A s -> says (x |: A) (val x :: s).
Proof. by move=> h e; rewrite in_cons h !inE -val_eqE. Qed.

Lemma same_owner (a b : E) : (owner team a == owner team b) = (nth 0%N owners (val a) == nth 0%N owners (val b)).
Proof. by rewrite -val_eqE !(ownerE owners_ok). Qed.

Lemma says_feasible A s : says A s -> {subset s <= all_elements} -> feasible team A = listed_feasible s.
Proof.
move=> h sub; have at_ i : i \in s -> {e : E | val e = i & e \in A}.
  move=> is_; have ik : (i < k.+1)%N by have := sub _ is_; rewrite mem_iota add0n.
  by exists (Ordinal ik); rewrite // -h.
apply/idP/idP => [/forall_inP f|/allP f].
  apply/allP => x /at_[a <- aA]; apply/allP => y /at_[b <- bA]; have := forall_inP (f a aA) b bA.
  by rewrite same_owner val_eqE.
apply/forall_inP => a aA; apply/forall_inP => b bA.
have as_ : val a \in s by rewrite h.
have bs : val b \in s by rewrite h.
have := allP (f _ as_) _ bs.
by rewrite same_owner val_eqE.
Qed.

Local Open Scope ring_scope.

Lemma gainP (x : E) (A : {set E}) : feasible team (x |: A) -> x \notin A ->
  exists2 y, (val x, y) \in gains & marginal fraction_value x A = y%:~R.
Proof.
move=> fe xA; set s := [seq i <- all_elements | i \in [seq val e | e <- enum A]].
have hs : says A s := says_list A; have sub : {subset s <= all_elements} by move=> i; rewrite mem_filter => /andP[].
have sub' : {subset val x :: s <= all_elements}.
  by move=> i; rewrite in_cons => /orP[/eqP ->|/sub //]; rewrite mem_all.
exists (value (val x :: s) - value s); last first.
  by rewrite /marginal /fraction_value (says_value (says_add x hs)) // (says_value hs) // -rmorphB.
apply/allpairsPdep; exists s, (val x); rewrite filter_parts mem_filter hs xA mem_all andbT /=.
by split=> //; rewrite -(says_feasible (says_add x hs)).
Qed.

Lemma gain_of p : p \in gains -> exists2 x : E, p.1 = val x & exists2 A : {set E},
  feasible team (x |: A) /\ x \notin A & marginal fraction_value x A = p.2%:~R.
Proof.
case/allpairsPdep=> s [i [sp]]; rewrite mem_filter mem_iota add0n => /andP[/andP[is_ fe] ik] ->.
have sub := parts_sub sp; pose x : E := Ordinal (ik : (i < k.+1)%N); exists x => //.
pose A : {set E} := [set e : E | val e \in s]; have hs : says A s by move=> e; rewrite inE.
have sub' : {subset val x :: s <= all_elements}.
  by move=> j; rewrite in_cons => /orP[/eqP ->|/sub //]; rewrite mem_iota add0n.
exists A; first by rewrite (says_feasible (says_add x hs)) // -hs.
by rewrite /marginal /fraction_value (says_value (says_add x hs)) // (says_value hs) // -rmorphB.
Qed.

Lemma single_of (x : E) : fraction_value [set x] = (value [:: val x])%:~R.
Proof.
rewrite /fraction_value (@says_value _ [:: val x]) // => [e|i]; first by rewrite mem_seq1 inE val_eqE.
by rewrite mem_seq1 => /eqP ->; rewrite mem_all.
Qed.

(** Curvature and total curvature are compared with the gains, in whole numbers for a fraction [a / b]. *)
Definition curvature_ok (a b : nat) : bool :=
  all (fun p => (b%:Z - a%:Z) * value [:: p.1] <= b%:Z * p.2) gains.
Definition total_curvature_ok (a b : nat) : bool :=
  all (fun p => all (fun q => (p.1 == q.1) ==> ((b%:Z - a%:Z) * q.2 <= b%:Z * p.2)) gains) gains.

Lemma over_b (a b : nat) (u v : int) : (0 < b)%N ->
  ((1 - a%:R / b%:R) * u%:~R <= v%:~R :> rat) = ((b%:Z - a%:Z) * u <= b%:Z * v).
Proof.
move=> b0; have bp : 0 < b%:R :> rat by rewrite ltr0n.
rewrite -(ler_pmul2l bp) mulrA mulrBr mulr1 mulrCA divff ?gt_eqF // mulr1 -(ler_int rat_numDomainType) !intrM rmorphB /=.
by rewrite -!pmulrn.
Qed.

Lemma curvature_decided a b : (0 < b)%N -> curvature_at_most team fraction_value (a%:R / b%:R) <-> curvature_ok a b.
Proof.
move=> b0; split=> [h|/allP h x A fe xA].
  apply/allP => p /gain_of[x px [A [fe xA] m]]; have := h x A fe xA.
  by rewrite m single_of over_b // px.
have [y yg ->] := gainP fe xA; rewrite single_of over_b //; exact: h yg.
Qed.

Lemma total_curvature_decided a b : (0 < b)%N ->
  total_curvature_at_most team fraction_value (a%:R / b%:R) <-> total_curvature_ok a b.
Proof.
move=> b0; split=> [h|/allP h x A B fA fB xA xB].
  apply/allP => p /gain_of[x px [A [fA xA] mA]]; apply/allP => q /gain_of[y qy [B [fB yB] mB]].
  apply/implyP => /eqP e; have xy : x = y by apply: val_inj; rewrite -px -qy.
  by rewrite -xy in fB yB mB; have := h x A B fA fB xA yB; rewrite mA mB over_b.
have [y yg ->] := gainP fA xA; have [z zg ->] := gainP fB xB; rewrite over_b //.
by have /implyP := allP (h _ yg) _ zg; apply.
Qed.
(** No smaller number does. *)
Lemma curvature_needs kk p : p \in gains -> curvature_at_most team fraction_value kk ->
  (1 - kk) * (value [:: p.1])%:~R <= p.2%:~R.
Proof. by move=> /gain_of[x -> [A [fe xA] <-]] h; rewrite -single_of; apply: h. Qed.

Lemma total_curvature_needs cc p q : p \in gains -> q \in gains -> p.1 = q.1 ->
  total_curvature_at_most team fraction_value cc -> (1 - cc) * q.2%:~R <= p.2%:~R.
Proof.
move=> /gain_of[x px [A [fA xA] <-]] /gain_of[y qy [B [fB yB] <-]] e h.
have xy : x = y by apply: val_inj; rewrite -px -qy.
by rewrite -xy in fB yB *; apply: h.
Qed.
End Lists.

(** One robot with two elements, two with one. Coverage of curvature 1/2, and with a bonus for two elements together,
    which makes the total curvature 3/4; both would be 1 if sets of two elements of one robot counted. *)
Definition covered_owners : seq nat := [:: 0; 0; 1; 2].
Definition covered_table : seq nat := [:: 0; 3; 3; 4; 2; 4; 5; 5; 3; 6; 5; 6; 5; 7; 7; 7].
Definition covered_curvature_is : nat * nat := (1, 2).
Definition bonus_table : seq nat := [:: 0; 3; 3; 4; 2; 4; 5; 5; 3; 6; 5; 6; 7; 9; 9; 9].
Definition bonus_curvature_is : nat * nat := (3, 4).

Local Open Scope ring_scope.
Local Notation team := (table_team 2 3 covered_owners).

Theorem covered_curvature : let phi := fraction_value (k := 3) covered_table in
  let k := covered_curvature_is.1%:R / covered_curvature_is.2%:R in
  curvature_at_most team phi k /\ forall k', curvature_at_most team phi k' -> k <= k'.
Proof.
split=> [|k' h]; first by apply/curvature_decided; vm_compute.
have g : (2%N, 1 : int) \in gains 3 covered_owners covered_table by vm_compute.
have := curvature_needs (isT : all (fun i => i < 3)%N covered_owners) g h.
have -> : listed_value 3 covered_table [:: (2%N, 1 : int).1] = 2 by vm_compute.
move=> le; rewrite -[covered_curvature_is.1]/1%N -[covered_curvature_is.2]/2%N -subr_ge0 (_ : _ - _ = (1 - (1 - k') * 2%:~R) / 2%:R); last by field.
by rewrite divr_ge0 // subr_ge0.
Qed.

Theorem bonus_total_curvature : let phi := fraction_value (k := 3) bonus_table in
  let c := bonus_curvature_is.1%:R / bonus_curvature_is.2%:R in
  total_curvature_at_most team phi c /\ forall c', total_curvature_at_most team phi c' -> c <= c'.
Proof.
split=> [|c' h]; first by apply/total_curvature_decided; vm_compute.
have g : (2%N, 1 : int) \in gains 3 covered_owners bonus_table by vm_compute.
have g' : (2%N, 4 : int) \in gains 3 covered_owners bonus_table by vm_compute.
have le := total_curvature_needs (isT : all (fun i => i < 3)%N covered_owners) g g' erefl h.
rewrite -[bonus_curvature_is.1]/3%N -[bonus_curvature_is.2]/4%N -subr_ge0 (_ : _ - _ = (1 - (1 - c') * 4%:~R) / 4%:R); last by field.
by rewrite divr_ge0 // subr_ge0.
Qed.
