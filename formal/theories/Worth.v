(** What the lower end's trees need of the value: two tests by which lists of robots are worth the claim. *)
From mathcomp Require Import all_ssreflect all_algebra.
From Ratt Require Import Extrema Teams Graph.
Set Implicit Arguments.
Unset Strict Implicit.
Unset Printing Implicit Defensive.
Import Order.Theory GRing.Theory Num.Theory.
Local Open Scope ring_scope.

Section Worth.
Variables (w : network) (S : Type) (start : S) (add : S -> nat -> S).
Local Notation robot := 'I_(top_robot w).+1.
Local Notation element := 'I_(top_element w).+1.
Variables (F : realFieldType) (phi : {set element} -> F) (p : {ffun robot -> element}) (lower : F).
Local Notation below := (fun i => (i < robots w)%N).

(** Robots that pass are worth the claim, and so is any set that has them. *)
Definition worth_test (worth : S -> bool) : Prop := forall T, uniq T -> all below T -> worth (foldl add start T) ->
  forall G : {set robot}, (forall i, i \in T -> robot_of w i \in G) -> lower <= phi (contributed p G).
(** If robots pass with [r] of a list, then any [r] of it that are added to them are enough. *)
Definition average_test (average_worth : S -> seq nat -> nat -> bool) : Prop :=
  forall T rest r, uniq T -> all below T -> (0 < r)%N -> average_worth (foldl add start T) rest r ->
  forall (T' : seq nat) (G : {set robot}), uniq (T ++ T') -> all below T' -> {subset T' <= rest} -> size T' = r ->
  (forall i, i \in T ++ T' -> robot_of w i \in G) -> lower <= phi (contributed p G).
End Worth.
