(** Inequalities of single targets: lemmas, which a tree of tangents shows for every set, and their sums. Generic in what a
    target is worth.

    A set takes an element of each robot, or nothing, which has the number after the last element: what scores say of that
    is 0, as of all numbers beyond their end. *)
From mathcomp Require Import all_ssreflect all_algebra.
From Ratt Require Import Extrema Teams Dyadic DyadicMatrix Graph Scores Covers.
Set Implicit Arguments.
Unset Strict Implicit.
Unset Printing Implicit Defensive.
Import Order.Theory GRing.Theory Num.Theory.

(** A leaf is a tangent by number; a branch divides what a set may have of a robot. *)
Inductive lemma_tree :=
| LemmaLeaf of nat
| LemmaBranch of nat & seq (seq nat * lemma_tree).
Record listed_lemma := ListedLemma {
  lemma_target : nat;
  lemma_scores : seq dyadic;
  lemma_constant : dyadic;
  lemma_proof : lemma_tree
}.
(** A target, and a constant and scores that bound what sets are worth for it. *)
Definition target_bound := (nat * tangent)%type.
Definition inequality_of (bounds : seq target_bound) (k : nat) : target_bound := nth (0%N, ([::], d0)) bounds k.

Section Checker.
Variables (w : network) (tangents : seq target_bound).
Let n := size (owners w).

(** An element of each robot, or nothing. *)
Definition all_options : seq (seq nat) := [seq rcons own n | own <- all_plans w].

Section Lemma.
Variables (target : nat) (scores : seq dyadic) (constant : dyadic).
Definition excess (t : tangent) (e : nat) : dyadic := dsub (nth d0 t.1 e) (nth d0 scores e).
Definition leaf_level (t : tangent) (left : seq (seq nat)) : dyadic :=
  dadd t.2 (dsum [seq largest_of (excess t) (nth [::] left i) | i <- iota 0 (robots w)]).
Fixpoint check_lemma_tree (t : lemma_tree) (left : seq (seq nat)) : bool :=
  match t with
  | LemmaLeaf k =>
      let b := inequality_of tangents k in
      [&& (k < size tangents)%N, b.1 == target & dle (leaf_level b.2 left) constant]
  | LemmaBranch i parts =>
      [&& (i < robots w)%N, sort leq (flatten [seq bt.1 | bt <- parts]) == nth [::] left i
        & all (fun bt => let: (block, t') := bt in check_lemma_tree t' (set_nth [::] left i block)) parts]
  end.
End Lemma.

Definition check_lemma (l : listed_lemma) : bool :=
  (size (lemma_scores l) == n) &&
  check_lemma_tree (lemma_target l) (lemma_scores l) (lemma_constant l) (lemma_proof l) all_options.
Definition lemma_bound (l : listed_lemma) : target_bound := (lemma_target l, (lemma_scores l, lemma_constant l)).

(** The sum of some inequalities. *)
Definition row_sum (bounds : seq target_bound) (ks : seq nat) : tangent :=
  (weighed n (fun k => (inequality_of bounds k).2.1) [seq (k, d1) | k <- ks], dsum [seq (inequality_of bounds k).2.2 | k <- ks]).

Local Open Scope ring_scope.
Variable F : realFieldType.
Local Notation val := (val F).
Local Notation robot := 'I_(top_robot w).+1.
Local Notation element := 'I_(top_element w).+1.
Variables (p : {ffun robot -> element}) (G : {set robot}).
Hypotheses (ok : network_ok w) (okp : is_plan (team_of w) p).

(** An inequality holds of what the group's robots chose, where that is worth [x]. *)
Definition holds (b : tangent) (x : F) : Prop :=
  size b.1 = n /\ x <= val b.2 + \sum_(i in G) val (nth d0 b.1 (p i)).

(** What the group has of a robot. *)
Definition option_of (i : robot) : nat := if i \in G then (p i : nat) else n.

Lemma option_scores (s : seq dyadic) : size s = n ->
  \sum_(i : robot) val (nth d0 s (option_of i)) = \sum_(i in G) val (nth d0 s (p i)).
Proof.
move=> sz; rewrite [RHS]big_mkcond; apply: eq_bigr => i _; rewrite /option_of; case: ifP => // _.
by rewrite nth_default ?sz // val0.
Qed.

Section Lemma.
Variables (target : nat) (scores : seq dyadic) (constant : dyadic) (x : F).
Hypothesis sized : size scores = n.
Hypothesis tangents_ok : forall k, (k < size tangents)%N -> (inequality_of tangents k).1 = target ->
  holds (inequality_of tangents k).2 x.

Lemma check_lemma_treeP t left : check_lemma_tree target scores constant t left ->
  (forall i : robot, option_of i \in nth [::] left i) -> x <= val constant + \sum_(i in G) val (nth d0 scores (p i)).
Proof.
move: t left; fix IH 1 => t left; case: t => [k|i parts].
  rewrite [check_lemma_tree _ _ _ _ _]/= => /and3P[kl /eqP et]; rewrite (val_le F) => le inc.
  have [sz bound] := tangents_ok kl et; set b := (inequality_of tangents k).2 in sz bound le *.
  apply: le_trans bound _; rewrite -(option_scores sz) -(option_scores sized) -ler_subl_addr -addrA -sumrB.
  apply: le_trans le; rewrite /leaf_level val_add ler_add2l val_sum_iota; apply: ler_sum => i _.
  by rewrite -val_sub; apply: (largest_ofP F (excess scores b) (inc i)).
rewrite [check_lemma_tree _ _ _ _ _]/= => /and3P[il /eqP cover kids] inc.
have inpi : option_of (robot_of w i) \in flatten [seq bt.1 | bt <- parts].
  by rewrite -(mem_sort leq) cover -{2}(robot_ofK il); apply: inc.
have inc' block : option_of (robot_of w i) \in block -> forall j : robot, option_of j \in nth [::] (set_nth [::] left i block) j.
  move=> pb j; rewrite nth_set_nth /=; case: eqP => [e|_]; last exact: inc.
  by rewrite -e robot_of_val in pb.
clear cover; elim: parts inpi kids => [//|[block t] parts IHp] /=.
rewrite mem_cat => /orP[pb|pin] /andP[h1 h2]; last exact: IHp.
exact: IH h1 (inc' _ pb).
Qed.
End Lemma.

Lemma in_all_options (i : robot) : option_of i \in nth [::] all_options i.
Proof.
rewrite /all_options (nth_map [::]); last by rewrite size_map size_iota ltn_ord.
rewrite mem_rcons in_cons /option_of; case: ifP => _; last by rewrite eqxx.
by rewrite in_all_plans ?orbT.
Qed.

Theorem check_lemmaP l x : check_lemma l -> (forall k, (k < size tangents)%N ->
    (inequality_of tangents k).1 = lemma_target l -> holds (inequality_of tangents k).2 x) ->
  holds (lemma_bound l).2 x.
Proof.
move=> /andP[/eqP sz tree] tan; split=> //; exact: (check_lemma_treeP sz tan tree in_all_options).
Qed.

(** The sum of inequalities bounds the sum of what the targets are worth. *)
Lemma row_sumP (bounds : seq target_bound) (ks : seq nat) (xs : nat -> F) :
  (forall k, k \in ks -> holds (inequality_of bounds k).2 (xs k)) -> holds (row_sum bounds ks) (\sum_(k <- ks) xs k).
Proof.
move=> h; split=> [|/=].
  rewrite /= /weighed; have gen acc : size acc = n -> size (foldl (fun acc kw =>
      axpy kw.2 (inequality_of bounds kw.1).2.1 acc) acc [seq (k, d1) | k <- ks]) = n.
    elim: ks h acc => [|k ks IH] h acc sa //=; apply: IH; first by move=> j js; apply: h; rewrite in_cons js orbT.
    by have [sk _] := h k (mem_head _ _); rewrite size_axpy ?sa ?sk.
  by apply: gen; rewrite size_nseq.
have sizes : {in [seq (k, d1) | k <- ks], forall kw : nat * dyadic, size (inequality_of bounds kw.1).2.1 = n}.
  by move=> _ /mapP[k kin ->]; case: (h k kin).
rewrite val_sum big_map (eq_bigr (fun i => \sum_(k <- ks) val (nth d0 (inequality_of bounds k).2.1 (p i)))); last first.
  move=> i _; rewrite (weighedP F (p i) sizes) big_map; apply: eq_bigr => k _; by rewrite val1 mul1r.
rewrite exchange_big -big_split /= big_seq [X in _ <= X]big_seq; apply: ler_sum => k /h[_]; exact.
Qed.
End Checker.
