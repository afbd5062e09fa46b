(** RATT at work: its plan is computed here by lists, proved to be the function's, and recomputed with the Python library
    from the same tables by tests/formal/test_definitions.py. Ties are part of the tables. *)
From mathcomp Require Import all_ssreflect all_algebra.
From Ratt Require Import Extrema Teams Guarantees Planner.
Set Implicit Arguments.
Unset Strict Implicit.
Unset Printing Implicit Defensive.
Import Order.Theory GRing.Theory Num.Theory.

Section Lists.
(** Robots below [n.+1], elements below [k.+1], who owns them, and the values of all sets by their bit masks. *)
Variables (n k : nat) (owners : seq nat) (table : seq nat).
Local Notation R := [finType of 'I_n.+1].
Local Notation E := [finType of 'I_k.+1].

Definition mask (s : seq nat) : nat := foldr (fun x m => 2 ^ x + m)%N 0%N s.
Definition listed_value (s : seq nat) : int := Posz (nth 0%N table (mask [seq x <- iota 0 k.+1 | x \in s])).
Definition table_team : team R E := Team (fun e : E => inord (nth 0%N owners e)) set0 0 0 set0 set0.
Definition table_value (S : {set E}) : int := listed_value [seq val e | e <- enum S].

Definition listed_own (i : nat) : seq nat := [seq e <- iota 0 k.+1 | nth 0%N owners e == i].
Definition listed_best (i : nat) : nat :=
  if listed_own i is x :: s then first_max (fun e => listed_value [:: e]) x s else 0%N.
Definition listed_order : seq nat :=
  sort (fun i j => (listed_value [:: listed_best j] <= listed_value [:: listed_best i])%R) (iota 0 n.+1).
Fixpoint listed_greedy (fuel : nat) (candidates chosen : seq nat) : seq nat :=
  match fuel, candidates with
  | l.+1, x :: s =>
      let y := first_max (fun z => listed_value (z :: chosen)) x s in
      y :: listed_greedy l [seq z <- x :: s | nth 0%N owners z != nth 0%N owners y] (y :: chosen)
  | _, _ => [::]
  end.
Definition listed_ratt (alpha : nat) : seq nat :=
  let b := take alpha listed_order in
  let picks := listed_greedy n.+1 [seq e <- iota 0 k.+1 | nth 0%N owners e \notin b] [::] in
  [seq if i \in b then listed_best i else head (listed_best i) [seq e <- picks | nth 0%N owners e == i] | i <- iota 0 n.+1].

Hypothesis owners_ok : all (fun i => i < n.+1)%N owners.
Hypothesis every : all (fun i => listed_own i != [::]) (iota 0 n.+1).

Lemma listed_value_mem s s' : s =i s' -> listed_value s = listed_value s'.
Proof. by move=> e; rewrite /listed_value; congr (Posz (nth _ _ (mask _))); apply: eq_filter. Qed.

Lemma table_valueE (s : seq E) : table_value [set x in s] = listed_value [seq val e | e <- s].
Proof.
apply: listed_value_mem => x; apply/mapP/mapP => -[e es ->]; exists e => //; by move: es; rewrite mem_enum inE.
Qed.

Lemma ownerE (e : E) : val (owner table_team e) = nth 0%N owners e.
Proof.
rewrite /= inordK //; have [le|lt] := leqP (size owners) e; first by rewrite nth_default.
exact: (allP owners_ok) (mem_nth 0%N lt).
Qed.
Lemma owner_eq (e : E) (i : R) : (owner table_team e == i) = (nth 0%N owners e == i).
Proof. by rewrite -val_eqE ownerE. Qed.

Lemma map_first_max (f : E -> int) (f' : nat -> int) x s : (forall e, f e = f' (val e)) ->
  val (first_max f x s) = first_max f' (val x) [seq val e | e <- s].
Proof. by move=> h; elim: s x => [//|y s IH] x; rewrite /first_max /= !h; case: ifP => _; apply: IH. Qed.

Lemma map_own i : [seq val e | e <- own table_team i] = listed_own i.
Proof.
rewrite /own /listed_own -val_enum_ord [RHS]filter_map; congr [seq _ | _ <- _]; apply: eq_filter => e; exact: owner_eq.
Qed.

Lemma alone_value e : alone table_value e = listed_value [:: val e].
Proof.
rewrite /alone (_ : [set e] = [set x in [:: e]]) ?table_valueE //.
by apply/setP => x; rewrite !inE.
Qed.

Lemma map_best default i : val (best table_team table_value default i) = listed_best i.
Proof.
rewrite /best /listed_best -map_own; case e: (own _ _) => [|x s] /=.
  by have := allP every i; rewrite mem_iota add0n ltn_ord -map_own e => /(_ isT).
by apply: map_first_max => y; apply: alone_value.
Qed.

Lemma map_by_value default : [seq val i | i <- by_value table_team table_value default] = listed_order.
Proof.
rewrite /by_value /listed_order -val_enum_ord; apply: map_sort => i j /=.
by rewrite !alone_value !map_best.
Qed.

Lemma listed_greedyS l x s chosen : listed_greedy l.+1 (x :: s) chosen =
  let y := first_max (fun z => listed_value (z :: chosen)) x s in
  y :: listed_greedy l [seq z <- x :: s | nth 0%N owners z != nth 0%N owners y] (y :: chosen).
Proof. by []. Qed.

Lemma map_greedy fuel s (chosen : seq E) (A : {set E}) : A = [set x in chosen] ->
  [seq val e | e <- greedy_picks table_team table_value fuel s A] =
  listed_greedy fuel [seq val e | e <- s] [seq val e | e <- chosen].
Proof.
elim: fuel s chosen A => [|l IH] [|x s] chosen A e //; rewrite greedy_picksS; cbv zeta.
set y := first_max _ x s; have ey : val y = first_max (fun z => listed_value (z :: [seq val e | e <- chosen])) (val x)
    [seq val e | e <- s].
  apply: map_first_max => z; rewrite e -(table_valueE (z :: chosen)); congr table_value.
  by apply/setP => w; rewrite !inE.
rewrite map_cons [in RHS]map_cons listed_greedyS; cbv zeta; rewrite -ey; congr (_ :: _).
rewrite (IH _ (y :: chosen)); last by rewrite e; apply/setP => w; rewrite !inE.
congr listed_greedy; rewrite -[val x :: _]/[seq val e | e <- x :: s].
rewrite [RHS]filter_map; congr [seq _ | _ <- _]; apply: eq_filter => z /=.
by rewrite -[inord _]/(owner table_team z) owner_eq ownerE.
Qed.

(** The lists compute the function. *)
Theorem listed_rattE default alpha :
  [seq val (ratt table_team table_value default alpha i) | i <- enum R] = listed_ratt alpha.
Proof.
rewrite /listed_ratt -(map_by_value default) -map_take -/(bait _ _ _ alpha); set b := bait _ _ _ _.
have -> : [seq e <- iota 0 k.+1 | nth 0%N owners e \notin [seq val i | i <- b]] =
    [seq val e | e <- [seq x <- enum E | owner table_team x \notin b]].
  rewrite -val_enum_ord [LHS]filter_map; congr [seq _ | _ <- _]; apply: eq_filter => e /=.
  by rewrite -[inord _]/(owner table_team e) -ownerE (mem_map val_inj).
rewrite -(@map_greedy n.+1 _ [::] set0); last by apply/setP => x; rewrite !inE.
set picks := greedy_picks _ _ _ _ _.
have pE : ratt_picks table_team table_value default alpha = picks by rewrite /ratt_picks card_ord.
move: pE; clearbody picks => pE; rewrite -val_enum_ord -[RHS]map_comp; apply: eq_map => i; rewrite ffunE -/b.
rewrite -[RHS]/(if val i \in [seq val j | j <- b] then listed_best i else
  head (listed_best i) [seq e <- [seq val e | e <- picks] | nth 0%N owners e == i]).
rewrite (mem_map val_inj); case: ifP => _; first exact: map_best.
rewrite pE filter_map (eq_filter (a2 := fun e => owner table_team e == i)); last by move=> e; rewrite [LHS]/= owner_eq.
by case: [seq x <- picks | _] => [|x s] //; apply: map_best.
Qed.
End Lists.

(** ** Weighted coverage with ties: which element, which robot and what greedy adds all matter *)
Definition ties_owners : seq nat := [:: 0; 1; 1; 2; 2].
Definition ties_table : seq nat :=
  [:: 0; 6; 6; 7; 6; 6; 7; 7; 1; 7; 6; 7; 7; 7; 7; 7; 1; 6; 7; 7; 6; 6; 7; 7; 2; 7; 7; 7; 7; 7; 7; 7].
Definition ties_alpha : nat := 1.
Definition ties_plan : seq nat := [:: 0; 1; 4].

Theorem ties_ratt default : [seq val (ratt (table_team 2 4 ties_owners) (table_value ties_table) default ties_alpha i)
  | i <- enum [finType of 'I_3]] = ties_plan.
Proof. by rewrite listed_rattE; vm_compute. Qed.

Definition pairs_owners : seq nat := [:: 0; 0; 1; 1; 2].
Definition pairs_table : seq nat :=
  [:: 0; 0; 2; 2; 0; 0; 2; 2; 1; 1; 3; 3; 1; 1; 3; 3; 2; 2; 4; 4; 2; 2; 4; 4; 2; 2; 4; 4; 2; 2; 4; 4].
Definition pairs_alpha : nat := 1.
Definition pairs_plan : seq nat := [:: 1; 2; 4].

Theorem pairs_ratt default : [seq val (ratt (table_team 2 4 pairs_owners) (table_value pairs_table) default pairs_alpha i)
  | i <- enum [finType of 'I_3]] = pairs_plan.
Proof. by rewrite listed_rattE; vm_compute. Qed.
