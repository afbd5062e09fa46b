(** All sublists of a list, in its order. *)
From mathcomp Require Import all_ssreflect.
Set Implicit Arguments.
Unset Strict Implicit.
Unset Printing Implicit Defensive.

Fixpoint parts (T : Type) (s : seq T) : seq (seq T) :=
  if s is x :: s' then parts s' ++ [seq x :: r | r <- parts s'] else [:: [::]].

Lemma filter_parts (T : eqType) (P : pred T) s : [seq x <- s | P x] \in parts s.
Proof.
elim: s => [//|x s IH] /=; rewrite mem_cat; case: (P x); last by rewrite IH.
by rewrite (map_f (cons x) IH) orbT.
Qed.

Lemma parts_sub (T : eqType) (s r : seq T) : r \in parts s -> {subset r <= s}.
Proof.
elim: s r => [|x s IH] r /=; first by rewrite inE => /eqP ->.
rewrite mem_cat => /orP[/IH h y /h ys|/mapP[r' /IH h ->] y]; first by rewrite in_cons ys orbT.
by rewrite !in_cons => /orP[->//|/h ->]; rewrite orbT.
Qed.
