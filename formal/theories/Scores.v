(** Rows of scores, one for each element: weighted sums, the largest of some, and the plans that a case holds. *)
From mathcomp Require Import all_ssreflect all_algebra.
From Ratt Require Import Extrema Teams Dyadic Graph.
Set Implicit Arguments.
Unset Strict Implicit.
Unset Printing Implicit Defensive.
Import Order.Theory GRing.Theory Num.Theory.

Fixpoint axpy (w : dyadic) (s acc : seq dyadic) : seq dyadic :=
  match s, acc with
  | x :: s', y :: acc' => dadd (dmul w x) y :: axpy w s' acc'
  | _, _ => [::]
  end.

(** The weighted sum of rows of [n] scores, which are named by their numbers. *)
Definition weighed (n : nat) (row : nat -> seq dyadic) (used : seq (nat * dyadic)) : seq dyadic :=
  foldl (fun acc kw => axpy kw.2 (row kw.1) acc) (nseq n d0) used.

Definition largest_of (f : nat -> dyadic) (s : seq nat) : dyadic :=
  if s is e :: s' then foldl (fun m x => dmax m (f x)) (f e) s' else d0.

(** The elements of each robot. *)
Definition all_plans (w : network) : seq (seq nat) :=
  [seq [seq e <- iota 0 (size (owners w)) | nth 0%N (owners w) e == i] | i <- iota 0 (robots w)].

Local Open Scope ring_scope.

Section Scores.
Variable F : realFieldType.
Local Notation val := (val F).

Lemma size_axpy a s acc : size s = size acc -> size (axpy a s acc) = size acc.
Proof. by elim: s acc => [|x s IH] [|y acc] //= [/IH ->]. Qed.

Lemma nth_axpy a s acc k : size s = size acc ->
  val (nth d0 (axpy a s acc) k) = val a * val (nth d0 s k) + val (nth d0 acc k).
Proof.
elim: s acc k => [|x s IH] [|y acc] [|k] //=; rewrite ?val0 ?mulr0 ?addr0 //.
  by rewrite val_add val_mul.
by case=> /IH.
Qed.

Lemma weighedP n row used k : {in used, forall kw, size (row kw.1) = n} ->
  val (nth d0 (weighed n row used) k) = \sum_(kw <- used) val kw.2 * val (nth d0 (row kw.1) k).
Proof.
rewrite /weighed => sizes.
have gen acc : size acc = n -> val (nth d0 (foldl (fun acc kw => axpy kw.2 (row kw.1) acc) acc used) k) =
    val (nth d0 acc k) + \sum_(kw <- used) val kw.2 * val (nth d0 (row kw.1) k).
  elim: used acc sizes => [|kw used IH] acc sizes sz; first by rewrite big_nil addr0.
  have ss : size (row kw.1) = size acc by rewrite sz sizes ?mem_head.
  rewrite [foldl _ _ _]/= IH ?size_axpy // => [|x xu]; last by apply: sizes; rewrite in_cons xu orbT.
  by rewrite nth_axpy // big_cons addrCA addrA.
by rewrite gen ?size_nseq // nth_nseq if_same val0 add0r.
Qed.

Lemma foldl_maxP (T : eqType) (f : T -> dyadic) s m : val m <= val (foldl (fun m x => dmax m (f x)) m s) /\
  {in s, forall y, val (f y) <= val (foldl (fun m x => dmax m (f x)) m s)}.
Proof.
elim: s m => [|y s IH] m /=; first by split.
have [h1 h2] := IH (dmax m (f y)); rewrite val_max in h1; split.
  by apply: le_trans h1; rewrite le_maxr lexx.
by move=> z; rewrite in_cons => /orP[/eqP->|/h2 //]; apply: le_trans h1; rewrite le_maxr lexx orbT.
Qed.

Lemma largest_ofP f s e : e \in s -> val (f e) <= val (largest_of f s).
Proof.
case: s => [//|x s]; rewrite /largest_of; have [h1 h2] := foldl_maxP f s (f x).
by rewrite in_cons => /orP[/eqP->|/h2].
Qed.
End Scores.

Lemma in_all_plans w p (i : 'I_(top_robot w).+1) : network_ok w -> is_plan (team_of w) p ->
  (p i : nat) \in nth [::] (all_plans w) i.
Proof.
move=> ok okp; rewrite /all_plans (nth_map 0%N) ?size_iota ?ltn_ord // nth_iota ?ltn_ord // add0n mem_filter mem_iota add0n.
have pos_n : (0 < size (owners w))%N by case/and3P: ok.
have ps : (p i < size (owners w))%N by apply: leq_trans (ltn_ord (p i)) _; rewrite /top_element prednK.
rewrite ps /= andbT; have := plan_owner i okp => /= /(congr1 (@nat_of_ord _)); rewrite /robot_of inordK => [->//|].
by case/and3P: ok => _ /allP own _; apply: own; apply: mem_nth.
Qed.

(** The plan takes one of the elements that a case leaves to each robot. *)
Definition in_case (w : network) (p : {ffun 'I_(top_robot w).+1 -> 'I_(top_element w).+1}) (left : seq (seq nat)) : Prop :=
  forall i, (p i : nat) \in nth [::] left i.
