(** Largest and smallest of finitely many numbers, from a given start. *)
From mathcomp Require Import all_ssreflect all_algebra.
Set Implicit Arguments.
Unset Strict Implicit.
Unset Printing Implicit Defensive.
Import Order.Theory GRing.Theory Num.Theory.
Local Open Scope ring_scope.

Section Extrema.
Variables (F : realDomainType) (T : eqType).
Implicit Types (s : seq T) (P : pred T) (f : T -> F) (x y : F).

Lemma bigmax_le s P f x y : x <= y -> (forall i, i \in s -> P i -> f i <= y) ->
  \big[Num.max/x]_(i <- s | P i) f i <= y.
Proof.
move=> xy; elim: s => [|a s IH] h; first by rewrite big_nil.
rewrite big_cons; case: ifP => Pa; last by apply: IH => i si; apply: h; rewrite in_cons si orbT.
rewrite le_maxl h ?mem_head //=; apply: IH => i si; apply: h; by rewrite in_cons si orbT.
Qed.

Lemma le_bigmax s P f x i : i \in s -> P i -> f i <= \big[Num.max/x]_(i <- s | P i) f i.
Proof.
elim: s => [//|a s IH]; rewrite in_cons big_cons => /orP[/eqP <-|si] Pi.
  by rewrite Pi le_maxr lexx.
by case: ifP => _; rewrite ?le_maxr IH ?orbT.
Qed.

Lemma start_le_bigmax s P f x : x <= \big[Num.max/x]_(i <- s | P i) f i.
Proof.
elim: s => [|a s IH]; first by rewrite big_nil.
by rewrite big_cons; case: ifP => _ //; rewrite le_maxr IH orbT.
Qed.

Lemma bigmax_attained s P f x : \big[Num.max/x]_(i <- s | P i) f i = x \/
  exists i, [/\ i \in s, P i & \big[Num.max/x]_(i <- s | P i) f i = f i].
Proof.
elim: s => [|a s IH]; first by left; rewrite big_nil.
rewrite big_cons; case: ifP => Pa; last first.
  case: IH => [->|[i [si Pi ->]]]; first by left.
  by right; exists i; rewrite in_cons si orbT.
case: (leP (f a) (\big[Num.max/x]_(i <- s | P i) f i)) => _.
  case: IH => [->|[i [si Pi ->]]]; first by left.
  by right; exists i; rewrite in_cons si orbT.
by right; exists a; rewrite mem_head.
Qed.

Lemma le_bigmin s P f x y : y <= x -> (forall i, i \in s -> P i -> y <= f i) ->
  y <= \big[Num.min/x]_(i <- s | P i) f i.
Proof.
move=> xy; elim: s => [|a s IH] h; first by rewrite big_nil.
rewrite big_cons; case: ifP => Pa; last by apply: IH => i si; apply: h; rewrite in_cons si orbT.
rewrite le_minr h ?mem_head //=; apply: IH => i si; apply: h; by rewrite in_cons si orbT.
Qed.

Lemma bigmin_le s P f x i : i \in s -> P i -> \big[Num.min/x]_(i <- s | P i) f i <= f i.
Proof.
elim: s => [//|a s IH]; rewrite in_cons big_cons => /orP[/eqP <-|si] Pi.
  by rewrite Pi le_minl lexx.
by case: ifP => _; rewrite ?le_minl IH ?orbT.
Qed.

Lemma bigmin_attained s P f x : \big[Num.min/x]_(i <- s | P i) f i = x \/
  exists i, [/\ i \in s, P i & \big[Num.min/x]_(i <- s | P i) f i = f i].
Proof.
elim: s => [|a s IH]; first by left; rewrite big_nil.
rewrite big_cons; case: ifP => Pa; last first.
  case: IH => [->|[i [si Pi ->]]]; first by left.
  by right; exists i; rewrite in_cons si orbT.
case: (leP (f a) (\big[Num.min/x]_(i <- s | P i) f i)) => _; last first.
  case: IH => [->|[i [si Pi ->]]]; first by left.
  by right; exists i; rewrite in_cons si orbT.
by right; exists a; rewrite mem_head.
Qed.
End Extrema.
